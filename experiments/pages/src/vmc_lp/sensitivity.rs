//! Table 2: sensitivity of the methods to their parameters.

use draw::figures::{Chart, Point, Series, Unit};
use statistics::{Interval, wilson};

use super::evidence::Study;
use super::published::{RUNS, Sensitivity, Setting, TABLE_2};
use crate::statistics::{fisher_exact, holm, newcombe};
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
    fn of(ours: (u64, u64), published: u64, p: f64) -> Self {
        if p >= 0.05 {
            Self::Agrees
        } else if share(ours) < share((published, RUNS)) {
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

/// Returns our counts of a case beside the published ones.
fn counts(study: &Study, case: &str) -> String {
    let ours: Vec<Option<(u64, u64)>> = settings()
        .map(|(_, setting)| study.failures(case, setting.name))
        .collect();
    let p: Vec<f64> = settings()
        .zip(&ours)
        .map(|((_, setting), ours)| {
            ours.map_or(1.0, |ours| fisher_exact(ours, (setting.failed, RUNS)))
        })
        .collect();
    let p = holm(&p);
    let mut text = String::new();
    for (((row, setting), ours), p) in settings().zip(&ours).zip(p) {
        let Some(ours) = *ours else {
            text += &format!(
                "| {} | {} | {}/{RUNS} | – | – | no results | |\n",
                row.parameter, setting.title, setting.failed
            );
            continue;
        };
        text += &format!(
            "| {} | {} | {}/{RUNS} | {}/{} | {} | {} | {} |\n",
            row.parameter,
            setting.title,
            setting.failed,
            ours.0,
            ours.1,
            shares(wilson(ours.0, ours.1)),
            Against::of(ours, setting.failed, p).words(),
            p_value(p),
        );
    }
    text
}

/// Returns a table with a column for every case.
fn overview(study: &Study) -> String {
    let mut text = String::new();
    for (row, setting) in settings() {
        text += &format!(
            "| {} | {} | {}/{RUNS} |",
            row.parameter, setting.title, setting.failed
        );
        for (case, _) in CASES {
            let applies = row.of_lp || case.starts_with("vmc");
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

/// Tests if changing a parameter changes the chance to fail.
fn changes(study: &Study, case: &str) -> String {
    let rows: Vec<_> = TABLE_2
        .iter()
        .filter(|row| row.of_lp || case.starts_with("vmc"))
        .filter_map(|row| {
            let [a, b] = row.settings;
            let (a, b) = (study.failures(case, a.name)?, study.failures(case, b.name)?);
            Some((row, a, b))
        })
        .collect();
    let p: Vec<f64> = rows.iter().map(|(_, a, b)| fisher_exact(*a, *b)).collect();
    let mut text = String::new();
    for ((row, a, b), p) in rows.iter().zip(holm(&p)) {
        let [first, second] = row.settings.map(|s| s.failed as f64 / RUNS as f64);
        let interval = newcombe((share(*a), wilson(a.0, a.1)), (share(*b), wilson(b.0, b.1)));
        // The change from the first setting to the second.
        let change = Interval {
            low: -interval.high,
            high: -interval.low,
        };
        text += &format!(
            "| {} | {} | {} | {} | {} | {} | {} |\n",
            row.parameter,
            if row.sensitive {
                "sensitive"
            } else {
                "less sensitive"
            },
            points(second - first),
            points(share(*b) - share(*a)),
            point_range(change),
            verdict(row, second - first, (share(*b) - share(*a), change), p),
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
