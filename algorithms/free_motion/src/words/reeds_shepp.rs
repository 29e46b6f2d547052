//! Words of robots that also drive backwards.

use geometry::math;
use geometry::pose::Pose2;

use super::formulas::{lrl, lrlr_inner, lrlr_outer, lrsl, lrslr, lrsr, lsl, lsr};
use super::{Word, leads_to, relative};

/// The Reeds–Shepp words from one pose to another for a turning radius (m).
pub fn reeds_shepp(from: &Pose2, to: &Pose2, radius: f64) -> Vec<Word> {
    let [x, y, phi] = relative(from, to, radius);
    let mut words = Vec::new();
    // Driving in the other direction along the mirror image, and turning to the other side.
    for (flip, mirror) in [(1.0, 1.0), (-1.0, 1.0), (1.0, -1.0), (-1.0, -1.0)] {
        let (x, y, phi) = (flip * x, mirror * y, flip * mirror * phi);
        let (sin, cos) = math::sincos(phi);
        // From the goal to the start.
        let (bx, by) = (x * cos + y * sin, x * sin - y * cos);
        let ahead = [
            Some(lsl(x, y, phi)),
            lsr(x, y, phi),
            lrl(x, y, phi),
            lrlr_outer(x, y, phi),
            lrlr_inner(x, y, phi),
            lrsl(x, y, phi),
            lrsr(x, y, phi),
            lrslr(x, y, phi),
        ];
        let back = [lrl(bx, by, phi), lrsl(bx, by, phi), lrsr(bx, by, phi)];
        let back = back.into_iter().flatten().map(|mut pieces| {
            pieces.reverse();
            pieces
        });
        for mut pieces in ahead.into_iter().flatten().chain(back) {
            for (turn, length) in &mut pieces {
                *turn *= mirror;
                *length *= flip;
            }
            words.push(Word::from_pieces(pieces, radius));
        }
    }
    words.retain(|word| leads_to(word, from, to));
    words
}
