//! Shares of the recorded outcomes against the time of branching, as a picture.

use core::fmt::Write as _;

use draw::canvas::{Canvas, Style};
use draw::palette;

use crate::decided::{DecidedReport, Decision};

// Size of the area of a curve, and its left and upper margin (px).
const WIDTH: f64 = 640.0;
const HEIGHT: f64 = 120.0;
const LEFT: f64 = 56.0;
const TOP: f64 = 48.0;
/// Distance from one curve to the next (px).
const ROW: f64 = HEIGHT + 64.0;

/// Draws one curve per robot with an outcome: the share of that outcome with its 95 % interval, the threshold, the bracket of
/// the decision, and the outcome itself.
pub fn curve_svg(report: &DecidedReport) -> String {
    let rows = report.decisions.len().max(1) as f64;
    let title = format!(
        "{} (seed {}): when it was decided",
        report.scenario, report.seed
    );
    let about = "Share of continuations with the recorded outcome against the time of branching";
    let (width, height) = (LEFT + WIDTH + 24.0, TOP + rows * ROW);
    let mut canvas = Canvas::new(width, height, &title, about);
    canvas.add(format_args!(
        "<rect width=\"100%\" height=\"100%\" fill=\"{}\"/>\n",
        palette::PAPER
    ));
    canvas.label(LEFT, 20.0, &style(14.0, "start"), &title);
    for (decision, row) in report.decisions.iter().zip(0..) {
        draw_curve(&mut canvas, report, decision, TOP + f64::from(row) * ROW);
    }
    canvas.finish()
}

fn style(size: f64, anchor: &'static str) -> Style {
    Style {
        size,
        color: palette::INK,
        bold: false,
        anchor,
        halo: false,
    }
}

fn draw_curve(canvas: &mut Canvas, report: &DecidedReport, decision: &Decision, top: f64) {
    let times = report.moments.iter().map(|moment| moment.time_s);
    let end = times.fold(decision.time_s, f64::max).max(1e-9);
    let (x, y) = (
        |t: f64| LEFT + WIDTH * t / end,
        |share: f64| top + HEIGHT * (1.0 - share),
    );
    let name = format!("{}: {}", decision.robot, decision.outcome.replace('_', " "));
    canvas.label(LEFT, top - 8.0, &style(12.0, "start"), &name);
    if let Some([low, high]) = decision.between_s {
        let (left, width) = (x(low), (x(high) - x(low)).max(1.0));
        let colour = palette::WALL;
        canvas.add(format_args!(
            "<rect x=\"{left:.1}\" y=\"{top}\" width=\"{width:.1}\" height=\"{HEIGHT}\" fill=\"{colour}\"/>\n"
        ));
    }
    let (mut line, mut upper, mut lower) = (String::new(), String::new(), Vec::new());
    for moment in report
        .moments
        .iter()
        .filter(|moment| moment.time_s <= decision.time_s)
    {
        let robot = moment
            .robots
            .iter()
            .find(|robot| robot.robot == decision.robot);
        let mut outcomes = robot.iter().flat_map(|robot| &robot.outcomes);
        let share = outcomes.find(|share| share.outcome == decision.outcome);
        let none = statistics::wilson(0, moment.continuations);
        let (share, interval) = share.map_or((0.0, none), |s| (s.share, s.interval));
        let x = x(moment.time_s);
        // Writing to a String cannot fail.
        let _ = write!(line, "{x:.1},{:.1} ", y(share));
        let _ = write!(upper, "{x:.1},{:.1} ", y(interval.high));
        lower.push(format!("{x:.1},{:.1}", y(interval.low)));
    }
    lower.reverse();
    let (lower, colour) = (lower.join(" "), palette::PURSUER);
    canvas.add(format_args!(
        "<polygon points=\"{upper}{lower}\" fill=\"{colour}\" fill-opacity=\"0.2\"/>\n\
         <polyline points=\"{line}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"2\"/>\n"
    ));
    let (from, to) = (LEFT, LEFT + WIDTH);
    for (share, colour, text) in [
        (0.0, palette::EDGE, "0".to_owned()),
        (
            report.threshold,
            palette::EVADER,
            report.threshold.to_string(),
        ),
        (1.0, palette::EDGE, "1".to_owned()),
    ] {
        let y = y(share);
        canvas.add(format_args!(
            "<path d=\"M{from} {y:.1}H{to}\" stroke=\"{colour}\" stroke-width=\"1\"/>\n"
        ));
        canvas.label(LEFT - 8.0, y + 4.0, &style(10.0, "end"), &text);
    }
    let at = x(decision.time_s);
    canvas.add(format_args!(
        "<path d=\"M{at:.1} {top}v{HEIGHT}\" stroke=\"{}\" stroke-dasharray=\"4 3\"/>\n",
        palette::INK
    ));
    for (time, anchor) in [(0.0, "start"), (decision.time_s, "end")] {
        let text = format!("{} s", recorder::time_text(time));
        canvas.label(x(time), top + HEIGHT + 16.0, &style(10.0, anchor), &text);
    }
}
