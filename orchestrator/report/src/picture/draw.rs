//! Drawing of the picture.

use std::collections::BTreeMap;

use draw::canvas::{Canvas, Num, Style, bold_width};
use draw::palette;
use geometry::math;
use geometry::region::Region;
use geometry::shape::Shape;
use recorder::time_text;

use super::bands::{BANDS, Bands, bands};
use super::draw_layers;
use super::draw_task;
use super::labels::{Area, Labels};
use super::layout::Layout;
use super::legend::{Legend, scale_bar};
use super::signs::{HALO, MARK, Sign, disc, sign};
use super::trace::{Mark, RunTrace};
use crate::run_model::corners;

/// Minimum radius of a robot on the page (px): smaller robots are enlarged.
const MIN_DISC: f64 = 8.0;
/// Maximum number of dots of all beliefs together.
const MAX_DOTS: usize = 2000;
/// Font size of names (px).
const NAME_SIZE: f64 = 14.0;
/// Distance between the mean of a belief and its robot (px) below which the belief has no label.
const NAMED_BELIEF: f64 = 45.0;

/// Draws a run as an SVG document. The same trace gives the same document.
///
/// The document has at most about 400 kB, whatever the length of the run: trails, particles, trees
/// and cells are simplified to the visible detail.
///
/// ```no_run
/// use std::path::Path;
///
/// use mcap_log::ReadProgress;
/// use report::picture::{RunTrace, draw};
///
/// let log = Path::new("logs/chase-1.mcap");
/// let (trace, _condition) = RunTrace::read(log, None, &mut ReadProgress::default())?;
/// std::fs::write("chase.svg", draw(&trace))?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn draw(trace: &RunTrace) -> String {
    let legend = Legend::from_trace(trace);
    let layout = Layout::new(
        trace.static_scene.min,
        trace.static_scene.max,
        legend.height(),
    );
    let (title, caption) = words(trace);
    let mut canvas = Canvas::new(layout.width, layout.height, &title, &caption);
    heading(&mut canvas, &layout, &title, &caption);
    let mut picture = Picture {
        labels: Labels::new(layout.map),
        discs: trace
            .robots
            .iter()
            .map(|robot| (robot.radius * layout.scale).max(MIN_DISC))
            .collect(),
        trace,
        layout,
    };
    let bands = bands(trace, layout.scale);
    picture.static_scene(&mut canvas);
    draw_layers::dominance(&mut canvas, &layout, trace);
    draw_task::below(&mut canvas, &layout, trace);
    draw_layers::plans(&mut canvas, &layout, trace);
    picture.trails(&mut canvas, &bands);
    draw_task::waypoints(&mut canvas, &layout, trace);
    picture.beliefs(&mut canvas);
    picture.robots(&mut canvas);
    picture.names(&mut canvas);
    legend.draw(&mut canvas, layout.legend, layout.map.top);
    let bar = layout.map.top + (layout.map.bottom - layout.map.top).max(legend.height());
    scale_bar(
        &mut canvas,
        layout.legend,
        bar - 8.0,
        layout.scale,
        picture.enlarged(),
    );
    canvas.finish()
}

/// Returns title and caption.
fn words(trace: &RunTrace) -> (String, String) {
    let title = if trace.title.is_empty() {
        &trace.scenario
    } else {
        &trace.title
    };
    let seed = if trace.seed.is_empty() {
        String::new()
    } else {
        format!(", seed {}", trace.seed)
    };
    let when = if trace.is_before_run() {
        "before it runs".to_owned()
    } else if trace.time_s < trace.end_s {
        format!(
            "after {} s of {} s simulated",
            time_text(trace.time_s),
            time_text(trace.end_s),
        )
    } else {
        format!("at its end, after {} s simulated", time_text(trace.end_s))
    };
    (
        title.clone(),
        format!("scenario {}{seed}: {when}", trace.scenario),
    )
}

fn heading(canvas: &mut Canvas, layout: &Layout, title: &str, caption: &str) {
    canvas.add(format_args!(
        "<rect x=\"0\" y=\"0\" width=\"{}\" height=\"{}\" rx=\"10\" fill=\"{}\"/>\n",
        Num(layout.width),
        Num(layout.height),
        palette::PAPER
    ));
    let [x, y] = Layout::title();
    let style = Style {
        size: 25.0,
        color: palette::INK,
        bold: true,
        anchor: "start",
        halo: false,
    };
    canvas.label(x, y, &style, title);
    let style = Style {
        size: 15.0,
        color: palette::FAINT_INK,
        bold: false,
        ..style
    };
    canvas.label(x, y + 25.0, &style, caption);
}

/// A picture during drawing.
struct Picture<'a> {
    trace: &'a RunTrace,
    layout: Layout,
    labels: Labels,
    /// Radii of the robots' discs on the page (px).
    discs: Vec<f64>,
}

impl Picture<'_> {
    /// Returns the largest factor by which a robot is enlarged.
    fn enlarged(&self) -> f64 {
        let factor = |(disc, radius): (&f64, f64)| disc / (radius * self.layout.scale).max(1e-9);
        let radii = self.trace.robots.iter().map(|robot| robot.radius);
        self.discs.iter().zip(radii).map(factor).fold(1.0, f64::max)
    }

    fn static_scene(&mut self, canvas: &mut Canvas) {
        let Area {
            left,
            top,
            right,
            bottom,
        } = self.layout.map;
        canvas.add(format_args!(
            "<clipPath id=\"map\"><rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\"/></clipPath>\n\
             <g clip-path=\"url(#map)\">\n",
            Num(left),
            Num(top),
            Num(right - left),
            Num(bottom - top)
        ));
        if let Some(cells) = &self.trace.static_scene.cells {
            canvas.add(format_args!("<path fill=\"{}\" d=\"", palette::WALL));
            for [min, max] in cells.rectangles() {
                self.layout
                    .outline(canvas, &[min, [max[0], min[1]], max, [min[0], max[1]]]);
            }
            canvas.add(format_args!("\"/>\n"));
        }
        for (came, fill, edge) in [
            (false, palette::WALL, palette::EDGE),
            (true, palette::OBSTACLE, palette::OBSTACLE),
        ] {
            let shapes = || {
                let obstacles = self.trace.static_scene.obstacles.values();
                obstacles.filter(move |o| o.came == came).map(|o| &o.shape)
            };
            if shapes().next().is_none() {
                continue;
            }
            // All outlines first, so that overlapping obstacles look like one.
            for paint in [
                format!(
                    "class=\"obstacle-edges\" fill=\"none\" stroke=\"{edge}\" stroke-width=\"2\""
                ),
                format!("class=\"obstacles\" fill=\"{fill}\""),
            ] {
                canvas.add(format_args!("<g {paint}>\n<path d=\""));
                shapes().for_each(|shape| self.layout.outline(canvas, &corners(shape)));
                canvas.add(format_args!("\"/>\n"));
                for shape in shapes() {
                    if let Shape::Circle { center, radius } = shape {
                        self.layout.circle(canvas, *center, *radius);
                    }
                }
                canvas.add(format_args!("</g>\n"));
            }
        }
        canvas.add(format_args!(
            "<g class=\"exits\" fill=\"{c}\" fill-opacity=\"0.18\" stroke=\"{c}\" stroke-width=\"2\" \
             stroke-dasharray=\"5 4\">\n",
            c = palette::EXIT
        ));
        for exit in &self.trace.static_scene.exits {
            self.layout.region(canvas, exit);
        }
        canvas.add(format_args!(
            "</g>\n</g>\n<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" fill=\"none\" \
             stroke=\"{}\"/>\n",
            Num(left),
            Num(top),
            Num(right - left),
            Num(bottom - top),
            palette::EDGE
        ));
    }

    fn trails(&mut self, canvas: &mut Canvas, bands: &[Bands]) {
        canvas.add(format_args!(
            "<g class=\"trails\" fill=\"none\" stroke-linejoin=\"round\" stroke-linecap=\"butt\">\n"
        ));
        for (robot, bands) in bands.iter().enumerate() {
            let color = self.trace.color(robot);
            for (band, (_, width, opacity)) in bands.iter().zip(BANDS) {
                if band.len() < 2 {
                    continue;
                }
                canvas.add(format_args!("<path d=\""));
                let points = band.iter().map(|point| [point.x, point.y]);
                points
                    .clone()
                    .for_each(|point| self.labels.avoid(self.layout.at(point)));
                self.layout.line(canvas, points);
                canvas.add(format_args!(
                    "\" stroke=\"{color}\" stroke-width=\"{width}\" stroke-opacity=\"{opacity}\"/>\n"
                ));
            }
        }
        canvas.add(format_args!("</g>\n"));
        for (robot, bands) in bands.iter().enumerate() {
            if let Some(start) = bands.iter().flatten().next() {
                let at = self.layout.at([start.x, start.y]);
                sign(canvas, Sign::Start, at, self.trace.color(robot));
            }
        }
    }

    fn beliefs(&mut self, canvas: &mut Canvas) {
        let all: usize = self.trace.beliefs.iter().map(|b| b.particles.len()).sum();
        let step = all.div_ceil(MAX_DOTS).max(1);
        canvas.add(format_args!(
            "<g class=\"beliefs\" fill=\"none\" stroke=\"{}\" stroke-width=\"4.4\" \
             stroke-opacity=\"0.75\" stroke-linecap=\"round\">\n",
            palette::BELIEF
        ));
        for belief in &self.trace.beliefs {
            canvas.add(format_args!("<path d=\""));
            for particle in belief.particles.iter().step_by(step) {
                let [x, y] = self.layout.at(particle.map(f64::from));
                canvas.add(format_args!("M{} {}h0", Num(x), Num(y)));
                self.labels.avoid([x, y]);
            }
            canvas.add(format_args!("\"/>\n"));
        }
        canvas.add(format_args!("</g>\n"));
    }

    fn robots(&mut self, canvas: &mut Canvas) {
        for (i, (robot, &radius)) in self.trace.robots.iter().zip(&self.discs).enumerate() {
            let at = self.layout.at([robot.pose.x, robot.pose.y]);
            let color = self.trace.color(i);
            canvas.add(format_args!("<g class=\"robot\">\n"));
            disc(canvas, at, radius, robot.pose.theta, color, robot.active);
            canvas.add(format_args!("</g>\n"));
            self.labels.reserve(Area::around(at, radius + 2.0));
        }
        for verdict in &self.trace.verdicts {
            let robot = self.trace.robots.get(verdict.robot);
            if let Some((robot, radius)) = robot.zip(self.discs.get(verdict.robot)) {
                let at = self.layout.at([robot.pose.x, robot.pose.y]);
                draw_layers::verdict_sign(canvas, at, radius + 6.0, verdict.is_possible);
                self.labels.reserve(Area::around(at, radius + 8.0));
            }
        }
        for mark in &self.trace.marks {
            let at = self.layout.at(mark.at);
            sign(canvas, Sign::Mark(mark.kind), at, HALO);
            self.labels.reserve(Area::around(at, MARK + 1.0));
        }
    }

    fn names(&mut self, canvas: &mut Canvas) {
        for exit in &self.trace.static_scene.exits {
            let center = exit.center();
            let at = self.layout.at([center.x, center.y]);
            let radius = match exit {
                Region::Circle { radius, .. } => *radius,
                Region::Rectangle { half_extents, .. } => half_extents[0].min(half_extents[1]),
            };
            self.name(
                canvas,
                at,
                radius * self.layout.scale,
                "exit",
                palette::EXIT,
            );
        }
        let outcomes: BTreeMap<usize, &Mark> = self
            .trace
            .marks
            .iter()
            .map(|mark| (mark.robot, mark))
            .collect();
        for (i, robot) in self.trace.robots.iter().enumerate() {
            let color = palette::role(robot.role);
            let radius = self.discs.get(i).copied().unwrap_or(MIN_DISC);
            let (at, text) = match outcomes.get(&i) {
                Some(mark) => {
                    let words = mark.kind.words();
                    (
                        mark.at,
                        format!("{} {words}, {} s", robot.name, time_text(mark.time_s)),
                    )
                }
                None => ([robot.pose.x, robot.pose.y], robot.name.clone()),
            };
            self.name(canvas, self.layout.at(at), radius, &text, color);
        }
        for belief in &self.trace.beliefs {
            let Some(robot) = self.trace.robots.get(belief.robot) else {
                continue;
            };
            let (mean, real) = (
                self.layout.at(belief.mean),
                self.layout.at([robot.pose.x, robot.pose.y]),
            );
            if math::hypot(mean[0] - real[0], mean[1] - real[1]) >= NAMED_BELIEF {
                let text = format!("{}?", robot.name);
                self.name(canvas, mean, 4.0, &text, palette::BELIEF_INK);
            }
        }
    }

    fn name(
        &mut self,
        canvas: &mut Canvas,
        at: [f64; 2],
        radius: f64,
        text: &str,
        color: &'static str,
    ) {
        let size = [bold_width(text, NAME_SIZE) + 6.0, NAME_SIZE + 4.0];
        if let Some(area) = self.labels.place(at, radius, size) {
            let style = Style {
                size: NAME_SIZE,
                color,
                bold: true,
                anchor: "middle",
                halo: true,
            };
            let middle = f64::midpoint(area.left, area.right);
            canvas.label(middle, area.bottom - 5.0, &style, text);
        }
    }
}
