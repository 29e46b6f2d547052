//! Drawing of the geometry of the robots' tasks.

use draw::canvas::{Canvas, Num};
use draw::palette;
use geometry::shape::Shape;

use super::bands::ages;
use super::layout::Layout;
use super::trace::RunTrace;
use crate::run_model::corners;

/// Opacity of swept ground.
pub const SWEPT_OPACITY: f64 = 0.45;
/// Style of a contour: a thin dark line.
pub const CONTOUR: &str =
    "fill=\"none\" stroke=\"#1f2430\" stroke-width=\"1.6\" stroke-linejoin=\"round\"";
/// Style of a danger zone: vermilion.
pub const ZONE: &str = "fill=\"#d55e00\" fill-opacity=\"0.12\" stroke=\"#d55e00\" \
                               stroke-width=\"1.5\" stroke-dasharray=\"2 3\"";
/// Style of a robot's goal: blue-green, dotted.
pub const GOAL: &str = "fill=\"#009e73\" fill-opacity=\"0.12\" stroke=\"#009e73\" \
                               stroke-width=\"2\" stroke-dasharray=\"2 3\"";
/// Style of a rectangle of the free space.
pub const RECTANGLE: &str =
    "fill=\"none\" stroke=\"#5b6472\" stroke-width=\"1\" stroke-dasharray=\"5 3\"";

/// Width of the line of a patrol's places (px).
const PLACE_WIDTH: f64 = 7.0;

/// Half the size of a waypoint among few and among many (px), and the number that is many.
const SIZES: [f64; 2] = [3.5, 2.2];
const MANY: usize = 300;

/// Draws swept ground, danger zones, rectangles, goals and contours, below the trails.
pub fn below(canvas: &mut Canvas, layout: &Layout, trace: &RunTrace) {
    let task = &trace.task;
    swept(canvas, layout, trace);
    canvas.add(format_args!(
        "<g class=\"danger-zones\" clip-path=\"url(#map)\" {ZONE}>\n"
    ));
    for zone in &task.danger_zones {
        if let Shape::Circle { center, radius } = zone {
            layout.circle(canvas, *center, *radius);
        } else {
            canvas.add(format_args!("<path d=\""));
            layout.outline(canvas, &corners(zone));
            canvas.add(format_args!("\"/>\n"));
        }
    }
    canvas.add(format_args!(
        "</g>\n<g class=\"rectangles\" clip-path=\"url(#map)\" {RECTANGLE}>\n"
    ));
    for &[min, max] in &task.rectangles {
        canvas.add(format_args!("<path d=\""));
        layout.outline(canvas, &[min, [max[0], min[1]], max, [min[0], max[1]]]);
        canvas.add(format_args!("\"/>\n"));
    }
    canvas.add(format_args!(
        "</g>\n<g class=\"goals\" clip-path=\"url(#map)\" {GOAL}>\n"
    ));
    task.goals
        .iter()
        .for_each(|goal| layout.region(canvas, goal));
    canvas.add(format_args!("</g>\n"));
    places(canvas, layout, trace);
    canvas.add(format_args!("<g class=\"contours\" {CONTOUR}>\n"));
    for contour in &task.contours {
        canvas.add(format_args!("<path d=\""));
        layout.line(canvas, contour.iter().copied());
        canvas.add(format_args!("\"/>\n"));
    }
    canvas.add(format_args!("</g>\n"));
}

/// Draws the ground that discs have swept: lines as wide as the discs, in the colours of the time since then. Later
/// visits cover earlier ones.
fn swept(canvas: &mut Canvas, layout: &Layout, trace: &RunTrace) {
    canvas.add(format_args!(
        "<g class=\"swept\" clip-path=\"url(#map)\" fill=\"none\" stroke-linejoin=\"round\" \
         stroke-linecap=\"round\" opacity=\"{SWEPT_OPACITY}\">\n"
    ));
    let all = ages(trace, layout.scale);
    for (age, color) in palette::IDLENESS.iter().rev().enumerate() {
        for (robot, ages) in trace.robots.iter().zip(&all) {
            let (Some(radius), Some(line)) = (robot.sweeps, ages.get(age)) else {
                continue;
            };
            if line.len() < 2 {
                continue;
            }
            canvas.add(format_args!("<path d=\""));
            layout.line(canvas, line.iter().map(|point| [point.x, point.y]));
            canvas.add(format_args!(
                "\" stroke=\"{color}\" stroke-width=\"{}\"/>\n",
                Num(2.0 * radius * layout.scale)
            ));
        }
    }
    canvas.add(format_args!("</g>\n"));
}

/// Draws the places of patrols as lines in the colours of their idleness, the longest first.
fn places(canvas: &mut Canvas, layout: &Layout, trace: &RunTrace) {
    if trace.task.places.is_empty() {
        return;
    }
    let bounds = palette::idleness_bounds(trace.time_s);
    canvas.add(format_args!(
        "<g class=\"places\" fill=\"none\" stroke-linecap=\"round\" stroke-width=\"{PLACE_WIDTH}\">\n"
    ));
    for (shade, color) in palette::IDLENESS.iter().enumerate().rev() {
        canvas.add(format_args!("<path stroke=\"{color}\" d=\""));
        let mut end = None;
        for place in &trace.task.places {
            if bounds
                .iter()
                .filter(|bound| place.idle_s >= **bound)
                .count()
                != shade
            {
                continue;
            }
            // Successive places are one line.
            if end.replace(place.ends[1]) == Some(place.ends[0]) {
                let [x, y] = layout.at(place.ends[1]);
                canvas.add(format_args!("L{} {}", Num(x), Num(y)));
            } else {
                layout.line(canvas, place.ends);
            }
        }
        canvas.add(format_args!("\"/>\n"));
    }
    canvas.add(format_args!("</g>\n"));
}

/// Draws the waypoints that have ended, over the trails.
pub fn waypoints(canvas: &mut Canvas, layout: &Layout, trace: &RunTrace) {
    let all = &trace.task.waypoints;
    let half = SIZES[usize::from(all.len() > MANY)];
    canvas.add(format_args!("<g class=\"waypoints\">\n"));
    for is_reached in [true, false] {
        let places = all.iter().filter(|w| w.is_reached == is_reached);
        let places = places.map(|w| layout.at(w.at));
        waypoint_signs(canvas, places, is_reached, half);
    }
    canvas.add(format_args!("</g>\n"));
}

/// Draws waypoints at these places (px): squares if they were reached, else crosses; `half` is half
/// their size (px).
pub fn waypoint_signs(
    canvas: &mut Canvas,
    places: impl IntoIterator<Item = [f64; 2]>,
    is_reached: bool,
    half: f64,
) {
    canvas.add(format_args!("<path fill=\"none\" d=\""));
    for [x, y] in places {
        if is_reached {
            canvas.add(format_args!("M{} {}h0", Num(x), Num(y)));
        } else {
            let (left, right) = (Num(x - half), Num(x + half));
            let (top, bottom) = (Num(y - half), Num(y + half));
            canvas.add(format_args!(
                "M{left} {top}L{right} {bottom}M{left} {bottom}L{right} {top}"
            ));
        }
    }
    let (color, width, cap) = if is_reached {
        (palette::PURSUER, 2.0 * half, "square")
    } else {
        (palette::EVADER, 1.8, "butt")
    };
    canvas.add(format_args!(
        "\" stroke=\"{color}\" stroke-width=\"{}\" stroke-linecap=\"{cap}\"/>\n",
        Num(width)
    ));
}
