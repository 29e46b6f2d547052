//! Symbols on the map and in the legend.

use draw::canvas::{Canvas, Num};
use draw::palette;
use geometry::math;

use super::trace::MarkKind;

/// Half the size of a mark (px).
pub const MARK: f64 = 7.0;
/// Colour of the rim of symbols that lie on trails.
pub const HALO: &str = "#ffffff";

/// Draws a robot: a disc with a nose.
pub fn disc(canvas: &mut Canvas, at: [f64; 2], radius: f64, theta: f64, color: &str, active: bool) {
    let (sin, cos) = math::sincos(theta);
    // The page's y axis points down.
    let point = |along: f64, across: f64| {
        let x = at[0] + radius * (along * cos - across * sin);
        let y = at[1] - radius * (along * sin + across * cos);
        (Num(x), Num(y))
    };
    let (tip, left, right) = (point(2.0, 0.0), point(0.3, 0.9), point(0.3, -0.9));
    let shape = format!(
        "<path d=\"M{} {}L{} {}L{} {}Z\"/><circle cx=\"{}\" cy=\"{}\" r=\"{}\"/>",
        tip.0,
        tip.1,
        left.0,
        left.1,
        right.0,
        right.1,
        Num(at[0]),
        Num(at[1]),
        Num(radius)
    );
    let pale = palette::out_of_play(color);
    // A rim around both shapes, and both shapes over it in one colour.
    canvas.add(format_args!(
        "<g fill=\"{HALO}\" stroke=\"{HALO}\" stroke-width=\"3.5\" stroke-linejoin=\"round\">{shape}</g>\n\
         <g fill=\"{}\">{shape}</g>\n",
        if active { color } else { &pale },
    ));
}

/// A symbol on the map.
#[derive(Debug, Clone, Copy)]
pub enum Sign {
    /// Start of a robot.
    Start,
    /// Place of an event.
    Mark(MarkKind),
}

/// Draws a symbol; `color` is that of a start or of the rim of a mark.
pub fn sign(canvas: &mut Canvas, sign: Sign, at: [f64; 2], color: &str) {
    let [x, y] = at;
    match sign {
        Sign::Start => canvas.add(format_args!(
            "<circle cx=\"{}\" cy=\"{}\" r=\"4.5\" fill=\"{}\" stroke=\"{color}\" \
             stroke-width=\"2\"/>\n",
            Num(x),
            Num(y),
            palette::PAPER
        )),
        Sign::Mark(MarkKind::Captured) => {
            let (a, b) = (MARK - 1.0, 1.0 - MARK);
            let lines = format!(
                "M{} {}L{} {}M{} {}L{} {}",
                Num(x + b),
                Num(y + b),
                Num(x + a),
                Num(y + a),
                Num(x + b),
                Num(y + a),
                Num(x + a),
                Num(y + b),
            );
            canvas.add(format_args!(
                "<g fill=\"none\" stroke-linecap=\"round\">\
                 <path d=\"{lines}\" stroke=\"{color}\" stroke-width=\"6.5\"/>\
                 <path d=\"{lines}\" stroke=\"{}\" stroke-width=\"3.5\"/></g>\n",
                palette::INK
            ));
        }
        Sign::Mark(MarkKind::Escaped | MarkKind::GoalReached) => canvas.add(format_args!(
            "<path d=\"M{} {}L{} {}L{} {}L{} {}Z\" fill=\"{}\" stroke=\"{color}\" \
             stroke-width=\"2\" stroke-linejoin=\"round\"/>\n",
            Num(x),
            Num(y - MARK),
            Num(x + MARK),
            Num(y),
            Num(x),
            Num(y + MARK),
            Num(x - MARK),
            Num(y),
            palette::EXIT
        )),
    }
}
