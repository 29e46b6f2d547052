//! Table 2: sensitivity of the methods to their parameters.

use draw::figures::{Chart, Point, Series, Unit};
use statistics::{Interval, Z95, wilson};

use super::evidence::Study;
use super::published::{RUNS, Sensitivity, Setting, TABLE_2};
use crate::statistics::{Difference, fisher_exact, holm};
use crate::template::Values;
use crate::words::{p_value, point_range, points, shares};

/// Cases of the experiment, and their names on the page.
const CASES: [(&str, &str); 4] = [
    ("vmc", "VMC, obstacles seen everywhere"),
    ("vmc_nodes", "VMC, at the nodes only"),
    ("lp", "LP, obstacles seen everywhere"),
    ("lp_nodes", "LP, at the nodes only"),
];
/// Largest difference of shares that does not matter.
const SMALL: f64 = 0.02;

fn share((hits, of): (u64, u64)) -> f64 {
    hits as f64 / of.max(1) as f64
}

/// Our count compared with the published one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Against {
    Fewer,
    More,
    Agrees,
}

impl Against {
    fn of(ours: (u64, u64), published: (u64, u64), p: f64) -> Self {
        if p >= 0.05 {
            Self::Agrees
        } else if share(ours) < share(published) {
            Self::Fewer
        } else {
            Self::More
        }
    }

    fn words(self) -> &'static str {
        match self {
            Self::Fewer => "**contradicts**: fewer fail here",
            Self::More => "**contradicts**: more fail here",
            Self::Agrees => "does not contradict",
        }
    }
}

/// Sets the tables of the page.
pub(super) fn set(study: &Study, values: &mut Values) {
    for case in ["vmc", "vmc_nodes"] {
        values.set(format!("{case}.counts"), counts(study, case));
    }
    values.set("overview", overview(study));
    for (case, _) in CASES {
        values.set(format!("{case}.changes"), changes(study, case));
    }
}

fn settings() -> impl Iterator<Item = (&'static Sensitivity, &'static Setting)> {
    TABLE_2
        .iter()
        .flat_map(|row| row.settings.iter().map(move |setting| (row, setting)))
}

/// Settings that are one and the same set of runs here.
type Group = Vec<(&'static Sensitivity, &'static Setting)>;

/// Returns the settings of the table, each set of runs once.
fn groups(study: &Study) -> Vec<Group> {
    let mut groups: Vec<Group> = Vec::new();
    for (row, setting) in settings() {
        let same = |group: &&mut Group| {
            let first = group.first();
            first.is_some_and(|(_, first)| study.are_same_runs(first.name, setting.name))
        };
        match groups.iter_mut().find(same) {
            Some(group) => group.push((row, setting)),
            None => groups.push(vec![(row, setting)]),
        }
    }
    groups
}

/// Returns the published failures and runs of a group. Equal counts may be one set of runs as well and count
/// once.
fn published(group: &Group) -> (u64, u64) {
    let mut counts: Vec<u64> = group.iter().map(|(_, setting)| setting.failed).collect();
    counts.sort_unstable();
    counts.dedup();
    (counts.iter().sum(), RUNS * counts.len() as u64)
}

/// Returns the first cells of a row: parameters, settings and published counts.
fn title(group: &Group) -> String {
    let lines = |of: fn(&(&'static Sensitivity, &'static Setting)) -> String| {
        let lines: Vec<String> = group.iter().map(of).collect();
        lines.join("<br>")
    };
    format!(
        "| {} | {} | {} |",
        lines(|(row, _)| row.parameter.to_owned()),
        lines(|(_, setting)| setting.title.to_owned()),
        lines(|(_, setting)| format!("{}/{RUNS}", setting.failed)),
    )
}

/// Returns our counts of a case beside the published ones.
fn counts(study: &Study, case: &str) -> String {
    let ours = |group: &Group| study.failures(case, group.first()?.1.name);
    let groups = groups(study);
    let tested: Vec<_> = groups.iter().filter_map(|g| Some((g, ours(g)?))).collect();
    let p: Vec<f64> = tested
        .iter()
        .map(|(group, ours)| fisher_exact(*ours, published(group)))
        .collect();
    let mut p = holm(&p).into_iter();
    let mut text = String::new();
    for group in &groups {
        text += &title(group);
        let Some((ours, p)) = ours(group).and_then(|ours| Some((ours, p.next()?))) else {
            text += " – | – | no results | |\n";
            continue;
        };
        text += &format!(
            " {}/{} | {} | {} | {} |\n",
            ours.0,
            ours.1,
            shares(wilson(ours.0, ours.1)),
            Against::of(ours, published(group), p).words(),
            p_value(p),
        );
    }
    text
}

/// Returns a table with a column for every case.
fn overview(study: &Study) -> String {
    let mut text = String::new();
    for group in groups(study) {
        let Some((_, setting)) = group.first() else {
            continue;
        };
        text += &title(&group);
        for (case, _) in CASES {
            let applies = case.starts_with("vmc") || group.iter().any(|(row, _)| row.of_lp);
            text += &match study.failures(case, setting.name).filter(|_| applies) {
                Some((failed, of)) => {
                    format!(" {failed}/{of} ({}) |", shares(wilson(failed, of)))
                }
                None => " – |".to_owned(),
            };
        }
        text += &format!(" {} |\n", study.unsolvable(setting.name));
    }
    text
}

/// Tests if changing a parameter changes the chance to fail, on the same seeds.
fn changes(study: &Study, case: &str) -> String {
    let rows: Vec<_> = TABLE_2
        .iter()
        .filter(|row| row.of_lp || case.starts_with("vmc"))
        .filter_map(|row| {
            let failed = |setting: Setting| study.failed_seeds(case, setting.name);
            let [before, after] = row.settings;
            let change = Difference::of(&failed(after)?, &failed(before)?)?;
            Some((row, change))
        })
        .collect();
    let p: Vec<f64> = rows.iter().map(|(_, change)| change.p_value).collect();
    let mut text = String::new();
    for ((row, change), p) in rows.iter().zip(holm(&p)) {
        let [first, second] = row.settings.map(|s| s.failed as f64 / RUNS as f64);
        let interval = change.interval(Z95);
        let [second_alone, first_alone] = change.larger;
        text += &format!(
            "| {} | {} | {} | {} | {} | {first_alone}, {second_alone} | {} | {} |\n",
            row.parameter,
            if row.sensitive {
                "sensitive"
            } else {
                "less sensitive"
            },
            points(second - first),
            points(change.value),
            point_range(interval),
            verdict(row, second - first, (change.value, interval), p),
            p_value(p),
        );
    }
    text
}

/// Compares a change with the published word for it.
fn verdict(
    row: &Sensitivity,
    published: f64,
    (change, interval): (f64, Interval),
    p: f64,
) -> &'static str {
    let small = interval.is_within(&Interval {
        low: -SMALL,
        high: SMALL,
    });
    let shown = p < 0.05;
    match (row.sensitive, small, shown) {
        (true, true, _) => "**contradicts**: it hardly matters here",
        (true, false, true) if change.signum() == published.signum() => "confirmed",
        (true, false, true) => "**contradicts**: the other way round here",
        (false, true, _) => "confirmed: it hardly matters",
        (false, false, true) => "**contradicts**: it matters here",
        (_, false, false) => "not decided",
    }
}

/// Returns the chart of Table 2.
pub(super) fn chart(study: &Study) -> Chart {
    let series = CASES.map(|(case, title)| {
        let points = settings().zip(0..).filter_map(|((row, setting), x)| {
            let applies = row.of_lp || case.starts_with("vmc");
            let (failed, of) = study.failures(case, setting.name).filter(|_| applies)?;
            let interval = wilson(failed, of);
            Some(Point {
                x: f64::from(x),
                y: share((failed, of)),
                interval: Some((interval.low, interval.high)),
            })
        });
        let reference = settings()
            .zip(0..)
            .filter(|_| case == "vmc")
            .map(|((_, setting), x)| {
                let interval = wilson(setting.failed, RUNS);
                Point {
                    x: f64::from(x),
                    y: share((setting.failed, RUNS)),
                    interval: Some((interval.low, interval.high)),
                }
            });
        Series {
            name: title.to_owned(),
            points: points.collect(),
            reference: reference.collect(),
        }
    });
    Chart {
        title: "Failed plans by setting".to_owned(),
        subtitle: format!(
            "Problems with a solution for which a method, with exactly this parametrisation, finds no plan \
             that passes the check. Seeds {}.",
            study.seeds
        ),
        x_label: "setting".to_owned(),
        x_names: settings().map(|(_, s)| s.short.to_owned()).collect(),
        y_label: "failed".to_owned(),
        unit: Unit::Share,
        series: series.into(),
        reference: "published, VMC, 500 runs each (failure is not defined)".to_owned(),
        ..Chart::default()
    }
}
