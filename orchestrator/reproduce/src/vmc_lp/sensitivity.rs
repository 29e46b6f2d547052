//! Table 2: sensitivity of the methods to their parameters.

use draw::figures::{Chart, Point, Series, Unit};
use statistics::{Interval, Z95, wilson};

use super::evidence::Study;
use super::published::{RUNS, Sensitivity, Setting, TABLE_2};
use crate::claim::Verdict;
use crate::statistics::{Difference, fisher_exact, holm};
use crate::template::Values;
use crate::words::{p_value, point_range, points, shares};

/// Cases of the experiment, and their names on the page.
pub(super) const CASES: [(&str, &str); 4] = [
    ("vmc", "VMC, obstacles seen everywhere"),
    ("vmc_nodes", "VMC, at the nodes only"),
    ("lp", "LP, obstacles seen everywhere"),
    ("lp_nodes", "LP, at the nodes only"),
];
/// Largest difference of shares that does not matter.
const SMALL: f64 = 0.02;

pub(super) fn share((hits, of): (u64, u64)) -> f64 {
    hits as f64 / of.max(1) as f64
}

/// Our count compared with the published one.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Count {
    /// The settings, one set of runs here.
    pub group: Group,
    /// Our failures and runs, with the p-value of Fisher's exact test; `None` without results.
    pub ours: Option<((u64, u64), f64)>,
}

impl Count {
    /// Returns the verdict: refuted by the test; confirmed if not, and our interval hardly leaves the published
    /// share.
    pub(super) fn verdict(&self) -> Verdict {
        let published = share(published(&self.group));
        let close = Interval {
            low: published - SMALL,
            high: published + SMALL,
        };
        match self.ours {
            None => Verdict::NoData,
            Some((_, p)) if p < 0.05 => Verdict::Refuted,
            Some(((failed, of), _)) if wilson(failed, of).is_within(&close) => Verdict::Confirmed,
            Some(_) => Verdict::Undecided,
        }
    }

    fn words(&self) -> &'static str {
        match self.ours {
            None => "no results",
            Some((_, p)) if p >= 0.05 => "does not contradict",
            Some((ours, _)) if share(ours) < share(published(&self.group)) => {
                "**contradicts**: fewer fail here"
            }
            Some(_) => "**contradicts**: more fail here",
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
pub(super) type Group = Vec<(&'static Sensitivity, &'static Setting)>;

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
pub(super) fn published(group: &Group) -> (u64, u64) {
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

/// Compares our counts of a case with the published ones; p-values by Holm's method.
pub(super) fn counted(study: &Study, case: &str) -> Vec<Count> {
    let ours = |group: &Group| study.failures(case, group.first()?.1.name);
    let found: Vec<_> = groups(study)
        .into_iter()
        .map(|group| (ours(&group), group))
        .collect();
    let tested = found
        .iter()
        .filter_map(|(ours, group)| Some(((*ours)?, group)));
    let p: Vec<f64> = tested
        .map(|(ours, group)| fisher_exact(ours, published(group)))
        .collect();
    let mut p = holm(&p).into_iter();
    let count = |(ours, group): (Option<(u64, u64)>, Group)| Count {
        ours: ours.and_then(|ours| Some((ours, p.next()?))),
        group,
    };
    found.into_iter().map(count).collect()
}

/// Returns our counts of a case beside the published ones.
fn counts(study: &Study, case: &str) -> String {
    let mut text = String::new();
    for count in counted(study, case) {
        text += &title(&count.group);
        let words = count.words();
        text += &match count.ours {
            None => format!(" – | – | {words} | |\n"),
            Some(((failed, of), p)) => format!(
                " {failed}/{of} | {} | {words} | {} |\n",
                shares(wilson(failed, of)),
                p_value(p),
            ),
        };
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

/// The effect of changing a parameter on the chance to fail, on the same seeds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Change {
    /// The parameter.
    pub row: &'static Sensitivity,
    /// Published change of the share of failed runs.
    pub published: f64,
    /// Our change.
    pub ours: Difference,
    /// Its 95 % interval.
    pub interval: Interval,
    /// Number of seeds with a solution under both settings.
    pub seeds: u64,
    /// p-value by Holm's method.
    pub p: f64,
}

/// Tests if changing a parameter changes the chance to fail.
pub(super) fn changed(study: &Study, case: &str) -> Vec<Change> {
    let rows = TABLE_2
        .iter()
        .filter(|row| row.of_lp || case.starts_with("vmc"));
    let mut changes: Vec<Change> = rows
        .filter_map(|row| {
            let failed = |setting: Setting| study.failed_seeds(case, setting.name);
            let [before, after] = row.settings;
            let (before, after) = (failed(before)?, failed(after)?);
            let ours = Difference::of(&after, &before)?;
            let [first, second] = row.settings.map(|s| s.failed as f64 / RUNS as f64);
            Some(Change {
                row,
                published: second - first,
                ours,
                interval: ours.interval(Z95),
                seeds: before
                    .keys()
                    .filter(|seed| after.contains_key(seed))
                    .count() as u64,
                p: ours.p_value,
            })
        })
        .collect();
    let raw: Vec<f64> = changes.iter().map(|change| change.p).collect();
    for (change, p) in changes.iter_mut().zip(holm(&raw)) {
        change.p = p;
    }
    changes
}

/// Returns the rows of the table of changes.
fn changes(study: &Study, case: &str) -> String {
    let mut text = String::new();
    for change in changed(study, case) {
        let [second_alone, first_alone] = change.ours.larger;
        text += &format!(
            "| {} | {} | {} | {} | {} | {first_alone}, {second_alone} | {} | {} |\n",
            change.row.parameter,
            change.row.word(),
            points(change.published),
            points(change.ours.value),
            point_range(change.interval),
            change.verdict().1,
            p_value(change.p),
        );
    }
    text
}

impl Change {
    /// Compares a change with the published word for it; returns the verdict and its text.
    pub(super) fn verdict(&self) -> (Verdict, &'static str) {
        use Verdict::{Confirmed, Refuted, Undecided};
        let small = self.interval.is_within(&Interval {
            low: -SMALL,
            high: SMALL,
        });
        let shown = self.p < 0.05;
        let same_sign = self.ours.value.signum() == self.published.signum();
        match (self.row.sensitive, small, shown) {
            (true, true, _) => (Refuted, "**contradicts**: it hardly matters here"),
            (true, false, true) if same_sign => (Confirmed, "confirmed"),
            (true, false, true) => (Refuted, "**contradicts**: the other way round here"),
            (false, true, _) => (Confirmed, "confirmed: it hardly matters"),
            (false, false, true) => (Refuted, "**contradicts**: it matters here"),
            (_, false, false) => (Undecided, "not decided"),
        }
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
