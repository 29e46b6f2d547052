//! Placement of labels.

/// Distances between a label and its object (px), the preferred first.
const GAPS: [f64; 3] = [3.0, 10.0, 20.0];

/// A rectangle on the page (px).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Area {
    pub(super) left: f64,
    pub(super) top: f64,
    pub(super) right: f64,
    pub(super) bottom: f64,
}

impl Area {
    /// Returns the square around a point.
    pub(super) fn around(center: [f64; 2], half: f64) -> Self {
        Self {
            left: center[0] - half,
            top: center[1] - half,
            right: center[0] + half,
            bottom: center[1] + half,
        }
    }

    fn overlaps(&self, other: &Self) -> bool {
        self.left < other.right
            && other.left < self.right
            && self.top < other.bottom
            && other.top < self.bottom
    }

    fn contains(&self, p: [f64; 2]) -> bool {
        p[0] > self.left && p[0] < self.right && p[1] > self.top && p[1] < self.bottom
    }

    fn holds(&self, other: &Self) -> bool {
        self.left <= other.left
            && self.top <= other.top
            && self.right >= other.right
            && self.bottom >= other.bottom
    }
}

/// Areas and points of the map that are already in use.
#[derive(Debug)]
pub struct Labels {
    within: Area,
    /// Areas that no label may cover.
    taken: Vec<Area>,
    /// Points that labels avoid if possible.
    drawn: Vec<[f64; 2]>,
}

impl Labels {
    /// Returns an empty map in this part of the page.
    pub(super) fn new(within: Area) -> Self {
        Self {
            within,
            taken: Vec::new(),
            drawn: Vec::new(),
        }
    }

    /// Reserves an area: no label covers it.
    pub(super) fn reserve(&mut self, area: Area) {
        self.taken.push(area);
    }

    /// Marks a point that labels avoid if possible.
    pub(super) fn avoid(&mut self, point: [f64; 2]) {
        self.drawn.push(point);
    }

    /// Finds room for a text of this size beside an object of this radius (px): the position that
    /// covers the fewest points, near ones first. `None` if there is no free position.
    pub(super) fn place(&mut self, at: [f64; 2], radius: f64, size: [f64; 2]) -> Option<Area> {
        let [w, h] = [size[0] / 2.0, size[1] / 2.0];
        let mut best: Option<(usize, Area)> = None;
        for (ring, gap) in GAPS.into_iter().enumerate() {
            let side = radius + gap;
            // Diagonally a label may be nearer: the corner of the square is empty.
            let slant = side * 0.7;
            let centers = [
                [side + w, 0.0],
                [-side - w, 0.0],
                [0.0, -side - h],
                [0.0, side + h],
                [slant + w, -slant - h],
                [-slant - w, -slant - h],
                [slant + w, slant + h],
                [-slant - w, slant + h],
            ];
            for (turn, [dx, dy]) in centers.into_iter().enumerate() {
                let area = Area {
                    left: at[0] + dx - w,
                    top: at[1] + dy - h,
                    right: at[0] + dx + w,
                    bottom: at[1] + dy + h,
                };
                if !self.within.holds(&area) || self.taken.iter().any(|t| t.overlaps(&area)) {
                    continue;
                }
                let hidden = self.drawn.iter().filter(|&&p| area.contains(p)).count();
                let cost = 4 * hidden + 6 * ring + turn;
                if best.is_none_or(|(least, _)| cost < least) {
                    best = Some((cost, area));
                }
            }
        }
        let (_, area) = best?;
        self.taken.push(area);
        Some(area)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PAGE: Area = Area {
        left: 0.0,
        top: 0.0,
        right: 200.0,
        bottom: 200.0,
    };

    #[test]
    fn names_neither_overlap_nor_leave_the_map() {
        let mut labels = Labels::new(PAGE);
        let placed: Vec<_> = (0..30)
            .filter_map(|_| labels.place([100.0, 190.0], 5.0, [40.0, 12.0]))
            .collect();
        assert!(placed.len() >= 4);
        for (i, a) in placed.iter().enumerate() {
            assert!(PAGE.holds(a));
            assert!(placed[..i].iter().all(|b| !a.overlaps(b)));
        }
    }

    #[test]
    fn a_name_avoids_drawn_points() {
        let mut labels = Labels::new(PAGE);
        for i in 0..20 {
            labels.avoid([100.0 + f64::from(i) * 4.0, 100.0]);
        }
        let area = labels.place([100.0, 100.0], 5.0, [40.0, 12.0]).unwrap();
        assert!(area.right < 100.0, "{area:?}");
    }

    #[test]
    fn a_name_without_room_is_left_out() {
        let mut labels = Labels::new(PAGE);
        assert_eq!(labels.place([100.0, 100.0], 5.0, [400.0, 12.0]), None);
    }
}
