//! Layout of the page.

use draw::canvas::{Canvas, Num};
use geometry::region::Region;

use super::labels::Area;
use crate::run_model::rectangle;

/// Maximum width and height of the map on the page (px).
const MAX_SIDE_PX: f64 = 760.0;
/// Minimum width and height of the map on the page (px).
const MIN_SIDE_PX: f64 = 60.0;
/// Empty border of the page (px).
const MARGIN: f64 = 28.0;
/// Height of the title above the map (px).
const HEADER: f64 = 62.0;
/// Space between map and legend (px).
const GUTTER: f64 = 28.0;
/// Width of the legend (px).
pub const LEGEND: f64 = 258.0;

/// The layout: a title, the map below it, the legend to its right.
#[derive(Debug, Clone, Copy)]
pub struct Layout {
    /// Width of the page (px).
    pub(super) width: f64,
    /// Height of the page (px).
    pub(super) height: f64,
    /// Area of the map.
    pub(super) map: Area,
    /// Left edge of the legend (px).
    pub(super) legend: f64,
    /// Pixels per metre.
    pub(super) scale: f64,
    min: [f64; 2],
    max: [f64; 2],
}

impl Layout {
    /// Returns the layout for a world with these corners (m) and a legend of this height (px).
    pub(super) fn new(min: [f64; 2], max: [f64; 2], legend_height: f64) -> Self {
        let min = min.map(|m| if m.is_finite() { m } else { 0.0 });
        let size = [0, 1].map(|i| {
            let size = max[i] - min[i];
            if size > 1e-6 && size.is_finite() {
                size
            } else {
                1.0
            }
        });
        let scale = MAX_SIDE_PX / size[0].max(size[1]);
        let [w, h] = size.map(|s| (s * scale).max(MIN_SIDE_PX));
        let map = Area {
            left: MARGIN,
            top: MARGIN + HEADER,
            right: MARGIN + w,
            bottom: MARGIN + HEADER + h,
        };
        Self {
            width: map.right + GUTTER + LEGEND + MARGIN,
            height: map.top + h.max(legend_height) + MARGIN,
            map,
            legend: map.right + GUTTER,
            scale,
            min,
            max: [min[0] + size[0], min[1] + size[1]],
        }
    }

    /// Returns the left edge of the title and its first base line (px).
    pub(super) const fn title() -> [f64; 2] {
        [MARGIN, MARGIN + 22.0]
    }

    /// Converts a point of the world (m) to the page (px): y points up in the world and down on the
    /// page. Points outside the map are moved to its border.
    pub(super) fn at(&self, p: [f64; 2]) -> [f64; 2] {
        let [x, y] = [0, 1].map(|i| p[i].clamp(self.min[i], self.max[i]));
        self.unclamped([x, y])
    }

    /// Converts a point of the world (m) to the page (px), also outside the map: for shapes that are
    /// clipped to it.
    fn unclamped(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        [
            self.map.left + (x - self.min[0]) * self.scale,
            self.map.top + (self.max[1] - y) * self.scale,
        ]
    }

    /// Writes the path commands of a line through these points (m).
    pub(super) fn line(&self, canvas: &mut Canvas, points: impl IntoIterator<Item = [f64; 2]>) {
        for (i, point) in points.into_iter().enumerate() {
            let [x, y] = self.at(point);
            let command = if i == 0 { 'M' } else { 'L' };
            canvas.add(format_args!("{command}{} {}", Num(x), Num(y)));
        }
    }

    /// Writes the path commands of a closed line through these points (m), to be clipped.
    pub(super) fn outline(&self, canvas: &mut Canvas, points: &[[f64; 2]]) {
        for (i, &point) in points.iter().enumerate() {
            let [x, y] = self.unclamped(point);
            let command = if i == 0 { 'M' } else { 'L' };
            canvas.add(format_args!("{command}{} {}", Num(x), Num(y)));
        }
        if !points.is_empty() {
            canvas.add(format_args!("Z"));
        }
    }

    /// Draws a region, to be clipped.
    pub(super) fn region(&self, canvas: &mut Canvas, region: &Region) {
        match *region {
            Region::Circle { center, radius } => self.circle(canvas, center, radius),
            Region::Rectangle {
                center,
                half_extents,
                angle,
            } => {
                canvas.add(format_args!("<path d=\""));
                self.outline(canvas, &rectangle(center, half_extents, angle));
                canvas.add(format_args!("\"/>\n"));
            }
        }
    }

    /// Draws a circle (m), to be clipped.
    pub(super) fn circle(&self, canvas: &mut Canvas, center: [f64; 2], radius: f64) {
        let [x, y] = self.unclamped(center);
        canvas.add(format_args!(
            "<circle cx=\"{}\" cy=\"{}\" r=\"{}\"/>\n",
            Num(x),
            Num(y),
            Num(radius * self.scale)
        ));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn y_is_up_and_the_map_keeps_its_proportions() {
        let layout = Layout::new([-1.0, -2.0], [3.0, 0.0], 100.0);
        let [left, bottom] = layout.at([-1.0, -2.0]);
        let [right, top] = layout.at([3.0, 0.0]);
        assert!(left < right && top < bottom);
        assert!(((right - left) / (bottom - top) - 2.0).abs() < 1e-9);
        assert_eq!([left, top], [layout.map.left, layout.map.top]);
        assert_eq!(layout.at([9.0, 9.0]), [right, top]);
    }

    #[test]
    fn a_world_without_extent_still_has_a_page() {
        for (min, max) in [
            ([0.0; 2], [0.0; 2]),
            ([1.0; 2], [0.0; 2]),
            ([0.0; 2], [f64::NAN; 2]),
            ([f64::NAN; 2], [1.0; 2]),
        ] {
            let layout = Layout::new(min, max, 100.0);
            assert!(layout.width.is_finite() && layout.height.is_finite());
            assert!(layout.at([5.0, 5.0]).iter().all(|c| c.is_finite()));
        }
    }
}
