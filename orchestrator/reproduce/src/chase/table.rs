//! The tables of all cells of a study.

use statistics::{Z95, wilson};

use super::evidence::{Study, same};
use super::published::{Published, find};
use crate::words::{in_table, p_value, percent, ratio, share, shares};

/// Returns a table with a row for every speed and a column for every method: the chance with its interval by
/// game. The first row has the number of games per cell.
pub(super) fn by_speed(study: &Study) -> String {
    let mut speeds: Vec<f64> = study.cells.iter().map(|c| c.ratio).collect();
    speeds.sort_by(f64::total_cmp);
    speeds.dedup_by(|a, b| same(*a, *b));
    let mut text = "| |".to_owned();
    for method in &study.methods {
        text += &format!(" {} |", in_table(&method.title));
    }
    text += &format!("\n|---|{}\n", "---|".repeat(study.methods.len()));
    text += "| games |";
    for method in &study.methods {
        text += &format!(" {} |", games(study, &method.name));
    }
    text += "\n";
    for speed in speeds {
        text += &format!("| {} |", ratio(speed));
        for method in &study.methods {
            let cell = study.cell(&method.name, speed);
            let chance = cell.and_then(|cell| {
                let interval = cell.escapes().interval(Z95);
                Some(percent(cell.escapes().share()?, interval))
            });
            text += &format!(" {} |", chance.unwrap_or_else(|| "–".to_owned()));
        }
        text += "\n";
    }
    text
}

/// Returns the number of games per cell of a method, failed ones apart.
fn games(study: &Study, method: &str) -> String {
    let cells = || study.cells.iter().filter(|c| c.method == method);
    let counts = || cells().map(|c| c.escapes().groups());
    let played = match (counts().min(), counts().max()) {
        (Some(least), Some(most)) if least < most => format!("{least} to {most}"),
        (least, _) => least.unwrap_or(0).to_string(),
    };
    match cells().map(|c| c.failed).sum::<u64>() {
        0 => played,
        failed => format!("{played} (+ {failed} failed)"),
    }
}

/// Returns a row for every cell: our chance with both intervals, the published value, and the test
/// if our interval contains it.
pub(super) fn cells(study: &Study, published: &[Published]) -> String {
    let mut text = String::new();
    for cell in &study.cells {
        let sample = cell.escapes();
        let by_game = sample.interval(Z95);
        let theirs = find(published, &cell.method, cell.ratio);
        let (value, inside, alike) = match theirs {
            Some(v) if sample.members() > 0 => {
                let inside = if by_game.contains(v.share()) {
                    "yes"
                } else {
                    "no"
                };
                (share(v.share()), inside, p_value(v.alike(&sample)))
            }
            Some(v) => (share(v.share()), "–", "–".to_owned()),
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
