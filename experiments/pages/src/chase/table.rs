//! The table of all cells of a study.

use statistics::{Z95, wilson};

use super::evidence::Study;
use super::published::{GAMES, Published, find};
use crate::statistics::fisher_exact;
use crate::words::{in_table, p_value, ratio, share, shares};

/// Returns a row for every cell: our chance with both intervals, the published value, and the test
/// if our interval contains it.
pub(super) fn cells(study: &Study, published: &[Published]) -> String {
    let mut text = String::new();
    for cell in &study.cells {
        let sample = &cell.escapes;
        let by_game = sample.interval(Z95);
        let theirs = find(published, &cell.method, cell.ratio);
        let (value, inside, alike) = match theirs {
            Some(v) if sample.members() > 0 => {
                let value = v.escaped as f64 / GAMES as f64;
                // The effective size is a number of independent outcomes.
                let size = sample.effective_size().round();
                let hits = (size * sample.share().unwrap_or(0.0)).round();
                let p = fisher_exact((hits as u64, size as u64), (v.escaped, GAMES));
                let inside = if by_game.contains(value) { "yes" } else { "no" };
                (share(value), inside, p_value(p))
            }
            Some(v) => (share(v.escaped as f64 / GAMES as f64), "–", "–".to_owned()),
            None => ("–".to_owned(), "–", "–".to_owned()),
        };
        let failed = match cell.failed {
            0 => String::new(),
            n => format!(" (+ {n} failed)"),
        };
        let chance = sample.share().map_or_else(|| "–".to_owned(), share);
        text += &format!(
            "| {} | {} | {}{failed} | {} / {} | {chance} | {} | {} | {} | {} | {value} | {inside} | \
             {alike} |\n",
            in_table(study.title(&cell.method)),
            ratio(cell.ratio),
            sample.groups(),
            sample.hits(),
            sample.members(),
            shares(wilson(sample.hits(), sample.members())),
            shares(by_game),
            cell.caught,
            cell.held_out,
        );
    }
    text
}
