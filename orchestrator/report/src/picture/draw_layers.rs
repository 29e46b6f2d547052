//! Drawing of plans, search trees and dominance regions on the map.

use draw::canvas::{Canvas, Num};
use draw::palette;

use super::layout::Layout;
use super::trace::RunTrace;
use crate::run_model::Cells;

/// Maximum number of edges of all trees together.
const MAX_EDGES: usize = 2500;
/// Maximum number of points of all plans together, without their ends.
const MAX_POINTS: usize = 2000;
/// Maximum number of rectangles of the cells of one team.
const MAX_RECTANGLES: usize = 500;

/// Draws the dominance regions, below all robots.
pub fn dominance(canvas: &mut Canvas, layout: &Layout, trace: &RunTrace) {
    let Some(dominance) = &trace.dominance else {
        return;
    };
    canvas.add(format_args!(
        "<g class=\"dominance\" clip-path=\"url(#map)\" stroke=\"none\">\n"
    ));
    for (cells, color, opacity) in [
        (&dominance.police, palette::PURSUER, 0.16),
        (&dominance.evader, palette::EVADER, 0.22),
        (&dominance.cut_off, palette::OBSTACLE, 0.16),
    ] {
        fill(canvas, layout, cells, color, opacity);
    }
    canvas.add(format_args!("</g>\n"));
}

fn fill(canvas: &mut Canvas, layout: &Layout, cells: &Cells, color: &str, opacity: f64) {
    canvas.add(format_args!(
        "<path fill=\"{color}\" fill-opacity=\"{opacity}\" d=\""
    ));
    for [min, max] in cells.at_most(MAX_RECTANGLES) {
        let ([left, bottom], [right, top]) = (layout.at(min), layout.at(max));
        let (left, bottom) = (Num(left), Num(bottom));
        let (right, top) = (Num(right), Num(top));
        canvas.add(format_args!(
            "M{left} {bottom}L{right} {bottom}L{right} {top}L{left} {top}Z"
        ));
    }
    canvas.add(format_args!("\"/>\n"));
}

/// Draws the trees, and the plans over them.
pub fn plans(canvas: &mut Canvas, layout: &Layout, trace: &RunTrace) {
    let edges: usize = trace.trees.iter().map(|tree| tree.edges.len()).sum();
    let step = edges.div_ceil(MAX_EDGES).max(1);
    canvas.add(format_args!(
        "<g class=\"trees\" clip-path=\"url(#map)\" fill=\"none\" stroke-width=\"0.7\" \
         stroke-opacity=\"0.45\">\n"
    ));
    for tree in &trace.trees {
        canvas.add(format_args!(
            "<path stroke=\"{}\" d=\"",
            trace.color(tree.robot)
        ));
        for [from, to] in tree.edges.iter().step_by(step) {
            let [x, y] = layout.at(from.map(f64::from));
            canvas.add(format_args!("M{} {}", Num(x), Num(y)));
            let [x, y] = layout.at(to.map(f64::from));
            canvas.add(format_args!("L{} {}", Num(x), Num(y)));
        }
        canvas.add(format_args!("\"/>\n"));
    }
    canvas.add(format_args!(
        "</g>\n<g class=\"plans\" clip-path=\"url(#map)\" fill=\"none\" stroke-width=\"1.8\" \
         stroke-dasharray=\"6 4\">\n"
    ));
    let points: usize = trace.plans.iter().map(|plan| plan.points.len()).sum();
    let step = points.div_ceil(MAX_POINTS).max(1);
    for plan in &trace.plans {
        canvas.add(format_args!(
            "<path stroke=\"{}\" d=\"",
            trace.color(plan.robot)
        ));
        let inner = plan.points.len().saturating_sub(1);
        let shown = plan.points.iter().take(inner).step_by(step);
        for (i, point) in shown.chain(plan.points.last()).enumerate() {
            let [x, y] = layout.at(point.map(f64::from));
            let command = if i == 0 { 'M' } else { 'L' };
            canvas.add(format_args!("{command}{} {}", Num(x), Num(y)));
        }
        canvas.add(format_args!("\"/>\n"));
    }
    canvas.add(format_args!(
        "</g>\n<g class=\"aims\" clip-path=\"url(#map)\" fill=\"none\" stroke-width=\"1.8\">\n"
    ));
    for plan in &trace.plans {
        if let Some(aim) = plan.aim {
            aim_sign(
                canvas,
                layout.at(aim.map(f64::from)),
                trace.color(plan.robot),
            );
        }
    }
    canvas.add(format_args!("</g>\n"));
}

/// Draws a ring at what a robot heads for (px).
pub fn aim_sign(canvas: &mut Canvas, [x, y]: [f64; 2], color: &str) {
    for radius in [6.0, 1.0] {
        canvas.add(format_args!(
            "<circle cx=\"{}\" cy=\"{}\" r=\"{radius}\" stroke=\"{color}\"/>\n",
            Num(x),
            Num(y)
        ));
    }
}

/// Draws a ring of this radius around an evader (px): whether it can escape.
pub fn verdict_sign(canvas: &mut Canvas, [x, y]: [f64; 2], radius: f64, is_possible: bool) {
    let (color, dashes) = if is_possible {
        (palette::EXIT, "")
    } else {
        (palette::PURSUER, " stroke-dasharray=\"4 3\"")
    };
    canvas.add(format_args!(
        "<circle class=\"verdict\" cx=\"{}\" cy=\"{}\" r=\"{}\" fill=\"none\" stroke=\"{color}\" \
         stroke-width=\"2.5\"{dashes}/>\n",
        Num(x),
        Num(y),
        Num(radius)
    ));
}
