//! A soak in a table for people.

use super::SoakReport;
use super::growth::{Growth, IN_FLIGHT, MEMORY};
use super::mission::ORCHESTRATOR;
use crate::mission::report::table;

/// Lines of the table beside the orchestrator's and those of what grew.
const LINES: usize = 8;

/// What a person wants to know.
pub fn text(report: &SoakReport) -> String {
    let mut text = format!(
        "{} missions in {:.1} min: {} failed, {} things left behind\n",
        report.missions.len(),
        report.lasted_s / 60.0,
        report.failures,
        report.leftovers,
    );
    for mission in report.missions.iter().filter(|m| m.failure.is_some()) {
        let why = mission.failure.as_deref().unwrap_or_default();
        text += &format!("  {} seed {}: {why}\n", mission.scenario, mission.seed);
    }
    for mission in report.missions.iter().filter(|m| !m.leftovers.is_empty()) {
        let left = mission.leftovers.join(", ");
        text += &format!("  {} seed {} left {left}\n", mission.scenario, mission.seed);
    }
    if report.growth.is_empty() {
        return text + "too few missions to tell growth\n";
    }
    let grew = report.growth.iter().filter(|g| g.grew).count();
    text += &format!(
        "{} quantities watched, {grew} grew after warming up; the largest changes:\n",
        report.growth.len()
    );
    let mut table = table(&[
        "what",
        "missions",
        "first half",
        "second half",
        "growth",
        "",
    ]);
    for growth in worth_showing(&report.growth) {
        let value = |v: f64| match growth.what {
            MEMORY | IN_FLIGHT => format!("{:.2} MiB", v / 1_048_576.0),
            _ => format!("{v:.0}"),
        };
        table.add_row([
            format!("{} {}", growth.who, growth.what),
            growth.missions.to_string(),
            value(growth.first),
            value(growth.last),
            format!("{:+.2} %", 100.0 * growth.share),
            if growth.grew { "GREW" } else { "" }.to_owned(),
        ]);
    }
    text + &table.to_string() + "\n"
}

/// The orchestrator's, all that grew, and the largest of the rest.
fn worth_showing(growth: &[Growth]) -> Vec<&Growth> {
    let mut sorted: Vec<&Growth> = growth.iter().collect();
    let rank = |g: &Growth| (g.who != ORCHESTRATOR, !g.grew);
    sorted.sort_by(|a, b| {
        rank(a)
            .cmp(&rank(b))
            .then(b.share.total_cmp(&a.share))
            .then(a.who.cmp(&b.who))
    });
    let must = sorted
        .iter()
        .filter(|g| g.who == ORCHESTRATOR || g.grew)
        .count();
    sorted.truncate(must + LINES);
    sorted
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::super::mission::{Mission, Use};
    use super::*;

    fn mission(number: u32, memory: u64) -> Mission {
        let held = Use {
            samples: 3,
            memory_bytes: memory,
            descriptors: 30,
            quarters_bytes: None,
        };
        Mission {
            scenario: "chase".into(),
            seed: 1,
            begun_s: f64::from(number),
            lasted_s: 1.0,
            processes: BTreeMap::from([
                (ORCHESTRATOR.to_owned(), held.clone()),
                ("police, 1".to_owned(), held),
            ]),
            segments: 40,
            leftovers: Vec::new(),
            failure: None,
        }
    }

    fn report(memory: impl Fn(u32) -> u64) -> SoakReport {
        let missions: Vec<Mission> = (0..40).map(|n| mission(n, memory(n))).collect();
        SoakReport::of(missions, 40.0, false)
    }

    #[test]
    fn what_grew_is_named() {
        let level = report(|_| 10_000_000);
        assert!(level.is_flat());
        assert!(text(&level).contains(" 0 grew"), "{}", text(&level));
        let leak = report(|n| 10_000_000 + 100_000 * u64::from(n));
        assert!(!leak.is_flat());
        assert!(text(&leak).contains("GREW"), "{}", text(&leak));
    }
}
