//! Tables 3 and 4: local pursuit against motion camouflage.

use draw::figures::{Chart, Point, Series, Unit};
use statistics::quantile;
use statistics::wilson;

use super::evidence::Study;
use super::published::{TABLE_3, TABLE_4_FIRST, TABLE_4_SECOND, Test};
use crate::claim::Verdict;
use crate::statistics::fisher_exact;
use crate::template::Values;
use crate::words::{p_value, share, shares};

/// Relative difference of times, by the smaller one, below which they are equal.
const SAME: f64 = 1e-4;
/// Relative difference of times, by the smaller one, from which it matters in practice.
const NOTABLE: f64 = 1e-2;
/// Values of the experiment's parameter, their titles, and the published tests.
const HORIZONS: [(&str, &str, &[Test]); 3] = [
    ("only", "one horizon, 5 obstacles (Table 3)", &TABLE_3),
    (
        "first",
        "first planning, 3 obstacles (Table 4)",
        &TABLE_4_FIRST,
    ),
    (
        "second",
        "second planning, 2 more (Table 4)",
        &TABLE_4_SECOND,
    ),
];
/// Pairs of cases, the names of their slots, and their names in the chart.
pub(super) const PAIRS: [(&str, &str, &str, &str); 2] = [
    ("lp", "vmc", "recommended", "As recommended here"),
    (
        "lp_paper",
        "vmc_paper",
        "as_published",
        "8 control points, degree 4, 15 nodes, nothing to fall back on",
    ),
];

/// Problems that both methods solved, with their times.
#[derive(Debug, Clone, Default, PartialEq)]
struct Duel {
    /// Problems with a solution.
    solvable: u64,
    /// Number of these that LP, and VMC, solved.
    solved: [u64; 2],
    /// Driving times (s) of problems that both solved: LP, VMC.
    times: Vec<[f64; 2]>,
    /// CPU times: LP, VMC.
    cpu: Vec<[f64; 2]>,
}

impl Duel {
    fn published(tests: &[Test]) -> Self {
        Self {
            solvable: tests.len() as u64,
            solved: [tests.len() as u64; 2],
            times: tests.iter().map(|t| t.time).collect(),
            cpu: tests.iter().map(|t| t.cpu).collect(),
        }
    }

    fn of(study: &Study, (lp, vmc): (&str, &str), horizon: &str) -> Option<Self> {
        let (lp, vmc) = (study.cell(lp, horizon)?, study.cell(vmc, horizon)?);
        let mut duel = Self::default();
        for (seed, a) in lp {
            let Some(b) = vmc.get(seed) else { continue };
            if a.unsolvable || b.unsolvable {
                continue;
            }
            duel.solvable += 1;
            duel.solved[0] += u64::from(a.time.is_some());
            duel.solved[1] += u64::from(b.time.is_some());
            if let (Some(s), Some(t)) = (a.time, b.time) {
                duel.times.push([s, t]);
                if let (Some(s), Some(t)) = (a.cpu_ms, b.cpu_ms) {
                    duel.cpu.push([s, t]);
                }
            }
        }
        Some(duel)
    }

    /// Returns VMC's time less LP's, relative to the smaller one, ascending.
    fn differences(&self) -> Vec<f64> {
        let differences = self.times.iter().map(|[a, b]| (b - a) / a.min(*b));
        let mut differences: Vec<f64> = differences.collect();
        differences.sort_by(f64::total_cmp);
        differences
    }

    /// Counts pairs in which LP's plan is shorter, of those that differ.
    fn shorter(&self) -> (u64, u64) {
        let differ = self.differences().into_iter().filter(|d| d.abs() > SAME);
        differ.fold((0, 0), |(hits, of), d| (hits + u64::from(d > 0.0), of + 1))
    }

    /// Counts pairs whose times differ by more than [`NOTABLE`].
    fn notable(&self) -> (u64, u64) {
        let hits = self
            .differences()
            .iter()
            .filter(|d| d.abs() > NOTABLE)
            .count();
        (hits as u64, self.times.len() as u64)
    }

    /// Counts pairs in which LP needs less CPU time.
    fn quicker(&self) -> (u64, u64) {
        let hits = self.cpu.iter().filter(|[a, b]| a < b).count();
        (hits as u64, self.cpu.len() as u64)
    }
}

fn median(values: impl Iterator<Item = f64>) -> Option<f64> {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    quantile(&values, 0.5)
}

fn number(value: Option<f64>, digits: usize) -> String {
    value.map_or_else(|| "–".to_owned(), |v| format!("{v:.digits$}"))
}

fn count((hits, of): (u64, u64)) -> String {
    if of == 0 {
        return "–".to_owned();
    }
    format!("{hits}/{of} ({})", shares(wilson(hits, of)))
}

/// Sets the tables and findings of the page.
pub(super) fn set(study: &Study, values: &mut Values) {
    for (lp, vmc, slot, _) in PAIRS {
        values.set(format!("{slot}.table"), table(study, (lp, vmc)));
        let found = observations(study, (lp, vmc));
        let lines = found.iter().map(Observation::line).collect::<String>();
        values.set(format!("{slot}.findings"), lines);
    }
}

fn table(study: &Study, pair: (&str, &str)) -> String {
    let mut text = String::new();
    for (horizon, title, tests) in HORIZONS {
        text += &line(&format!("{title}, published"), &Duel::published(tests), "s");
        match Duel::of(study, pair, horizon) {
            Some(duel) => text += &line(&format!("{title}, **ours**"), &duel, "ms"),
            None => text += &format!("| {title}, **ours** | no results | | | | | | | |\n"),
        }
    }
    text
}

fn line(title: &str, duel: &Duel, unit: &str) -> String {
    let of = |pairs: &[[f64; 2]], digits: usize| {
        let (a, b) = (
            median(pairs.iter().map(|p| p[0])),
            median(pairs.iter().map(|p| p[1])),
        );
        format!("{}, {}", number(a, digits), number(b, digits))
    };
    let mut sizes: Vec<f64> = duel.differences().iter().map(|d| d.abs()).collect();
    sizes.sort_by(f64::total_cmp);
    let size = |share: f64| {
        quantile(&sizes, share).map_or_else(|| "–".to_owned(), |v| format!("{:.3} %", 100.0 * v))
    };
    format!(
        "| {title} | {}, {} of {} | {} | {} | {} | {}, {} | {} | {} {unit} | {} |\n",
        duel.solved[0],
        duel.solved[1],
        duel.solvable,
        of(&duel.times, 2),
        count(duel.shorter()),
        count(duel.notable()),
        size(0.5),
        size(1.0),
        count(duel.quicker()),
        of(&duel.cpu, 2),
        number(median(duel.cpu.iter().map(|[a, b]| b / a)), 2),
    )
}

/// An observation of the report, on all horizons together.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Observation {
    /// Key.
    pub key: &'static str,
    /// Statement.
    pub claim: &'static str,
    /// Our counts: hits, pairs.
    pub ours: (u64, u64),
    /// The published counts.
    pub published: (u64, u64),
    /// Verdict.
    pub verdict: Verdict,
    /// Text of the verdict.
    words: String,
    /// p-value of the comparison of both counts, where it decides.
    p: Option<f64>,
    /// `true` if CPU times are compared.
    pub timed: bool,
}

impl Observation {
    fn line(&self) -> String {
        let (hits, of) = self.published;
        let published = if let Some(p) = self.p {
            format!("published {hits}/{of}; {}", p_value(p))
        } else {
            let value = share(hits as f64 / of.max(1) as f64);
            format!("published {value}, {hits}/{of}")
        };
        let ours = count(self.ours);
        format!(
            "- {}: {} (ours {ours}; {published}).\n",
            self.claim, self.words
        )
    }
}

/// Tests the report's observations.
pub(super) fn observations(study: &Study, pair: (&str, &str)) -> Vec<Observation> {
    let mut ours = Duel::default();
    let mut theirs = Duel::default();
    for (horizon, _, tests) in HORIZONS {
        if let Some(duel) = Duel::of(study, pair, horizon) {
            ours.times.extend(duel.times);
            ours.cpu.extend(duel.cpu);
        }
        let published = Duel::published(tests);
        theirs.times.extend(published.times);
        theirs.cpu.extend(published.cpu);
    }
    let shorter = {
        let (mine, published) = (ours.shorter(), theirs.shorter());
        // Very few pairs that differ are an answer, too.
        let pairs = ours.times.len() as u64;
        let rarely = 20 * mine.1 < pairs;
        let (verdict, words) = if rarely {
            let same = pairs - mine.1;
            let words =
                format!("**contradicted**: {same} of {pairs} pairs are the same within 0.01 %");
            (Verdict::Refuted, words)
        } else {
            more_often(mine)
        };
        Observation {
            key: "shorter",
            claim: "LP's plans are shorter more often than VMC's",
            ours: mine,
            published,
            verdict,
            words,
            p: None,
            timed: false,
        }
    };
    let quicker = {
        let (mine, published) = (ours.quicker(), theirs.quicker());
        let (verdict, words) = more_often(mine);
        Observation {
            key: "quicker",
            claim: "LP needs less CPU time more often than VMC",
            ours: mine,
            published,
            verdict,
            words,
            p: None,
            timed: true,
        }
    };
    let mut found = vec![shorter, quicker];
    let (a, b) = (ours.notable(), theirs.notable());
    if a.1 > 0 {
        let p = fisher_exact(a, b);
        let (verdict, words) = if p < 0.05 {
            (Verdict::Refuted, "**contradicted**")
        } else {
            (Verdict::Undecided, "not contradicted")
        };
        found.push(Observation {
            key: "notable",
            claim: "Which method is chosen makes a difference of more than 1 % of the time in most tests",
            ours: a,
            published: b,
            verdict,
            words: words.to_owned(),
            p: Some(p),
            timed: false,
        });
    }
    found
}

/// Decides whether hits are more often than not.
fn more_often((hits, of): (u64, u64)) -> (Verdict, String) {
    if of == 0 {
        return (Verdict::NoData, "no data".to_owned());
    }
    let verdict = Verdict::above(wilson(hits, of), 0.5);
    let words = match verdict {
        Verdict::Confirmed => "confirmed",
        Verdict::Refuted => "**contradicted**",
        Verdict::Undecided | Verdict::NoData => "not decided",
    };
    (verdict, words.to_owned())
}

/// Returns the chart of Tables 3 and 4: VMC's CPU time relative to LP's.
pub(super) fn chart(study: &Study) -> Chart {
    let spread = |duel: &Duel| {
        let mut ratios: Vec<f64> = duel.cpu.iter().map(|[a, b]| b / a).collect();
        ratios.sort_by(f64::total_cmp);
        let at = |share| quantile(&ratios, share);
        Some((at(0.5)?, (at(0.05)?, at(0.95)?)))
    };
    let point = |x: f64, duel: &Duel| {
        let (y, interval) = spread(duel)?;
        Some(Point {
            x,
            y,
            interval: Some(interval),
        })
    };
    let places = || (0..).map(f64::from).zip(HORIZONS);
    let series = PAIRS.map(|(lp, vmc, _, title)| Series {
        name: title.to_owned(),
        points: places()
            .filter_map(|(x, (horizon, _, _))| point(x, &Duel::of(study, (lp, vmc), horizon)?))
            .collect(),
        reference: places()
            .filter(|_| lp == "lp")
            .filter_map(|(x, (_, _, tests))| point(x, &Duel::published(tests)))
            .collect(),
    });
    Chart {
        title: "CPU time of VMC by that of LP, the same problem".to_owned(),
        subtitle: format!(
            "Median of the problems that both methods solved; bars from the 5th to the 95th percentile. Seeds \
             {}.",
            study.seeds
        ),
        x_label: "planning".to_owned(),
        x_names: ["one horizon", "first", "second"].map(str::to_owned).into(),
        y_label: "VMC's CPU time by LP's".to_owned(),
        unit: Unit::Number,
        series: series.into(),
        reference: "published (6, 4 and 4 tests)".to_owned(),
        ..Chart::default()
    }
}
