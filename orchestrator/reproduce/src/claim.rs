//! Published statements and numbers, and what our results say about them, as data.

use serde::{Serialize, Serializer};
use statistics::{Interval, Mean};

use crate::statistics::prediction_95;
use crate::words::{decimals, point_range, points, ratio, ratio_range, share, shares};

/// One of the papers, by its key.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Paper {
    /// The chasing game.
    Chase,
    /// Patrols with the cat map.
    Patrol,
    /// Coverage with the Chebyshev map.
    Coverage,
    /// Motion camouflage and local pursuit.
    VmcLp,
}

impl Paper {
    /// All papers, in the order of reports.
    pub const ALL: [Self; 4] = [Self::Chase, Self::Patrol, Self::Coverage, Self::VmcLp];

    /// Returns the key.
    pub fn key(self) -> &'static str {
        match self {
            Self::Chase => "chase",
            Self::Patrol => "patrol",
            Self::Coverage => "coverage",
            Self::VmcLp => "vmc-lp",
        }
    }

    /// Returns the title.
    pub fn title(self) -> &'static str {
        match self {
            Self::Chase => "Multi-robot navigation in the context of a chasing game",
            Self::Patrol => "Cat-map patrol paper",
            Self::Coverage => "Chebyshev coverage paper",
            Self::VmcLp => "Report on virtual motion camouflage and local pursuit",
        }
    }
}

/// Verdict on a claim.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// The claim is true.
    Confirmed,
    /// The claim is false.
    Refuted,
    /// The results do not decide.
    Undecided,
    /// There are no results for a decision.
    NoData,
}

impl Verdict {
    /// All verdicts, in the order of reports.
    pub const ALL: [Self; 4] = [
        Self::Confirmed,
        Self::Refuted,
        Self::Undecided,
        Self::NoData,
    ];

    /// Returns the plain word.
    pub fn word(self) -> &'static str {
        match self {
            Self::Confirmed => "confirmed",
            Self::Refuted => "refuted",
            Self::Undecided => "undecided",
            Self::NoData => "no data",
        }
    }

    /// Returns the text of the pages.
    pub fn markdown(self) -> &'static str {
        match self {
            Self::Confirmed => "**confirmed**",
            Self::Refuted => "**refuted**",
            Self::Undecided | Self::NoData => self.word(),
        }
    }

    /// Decides a claim that a share or number lies on one side of a limit.
    pub fn above(interval: Interval, limit: f64) -> Self {
        if interval.low > limit {
            Self::Confirmed
        } else if interval.high < limit {
            Self::Refuted
        } else {
            Self::Undecided
        }
    }
}

/// Unit of a number and of its interval.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Unit {
    /// A share, 0 to 1; text in percent.
    Share,
    /// A difference of shares, −1 to 1; text in points.
    Points,
    /// A speed relative to the Police.
    Speed,
    /// A number with its unit, written with this many decimals.
    Number(usize, &'static str),
}

impl Unit {
    /// Returns the name in machine-readable reports; empty for plain numbers.
    pub fn name(self) -> &'static str {
        match self {
            Self::Share => "share",
            Self::Points => "difference of shares",
            Self::Speed => "speed of the Police",
            Self::Number(_, unit) => unit,
        }
    }

    /// Formats a value.
    pub fn value(self, value: f64) -> String {
        match self {
            Self::Share => share(value),
            Self::Points => format!("{} points", points(value)),
            Self::Speed => ratio(value),
            Self::Number(digits, unit) => {
                let number = decimals(value, digits);
                format!("{number} {unit}").trim_end().to_owned()
            }
        }
    }

    /// Formats an interval.
    pub fn interval(self, interval: Interval) -> String {
        match self {
            Self::Share => shares(interval),
            Self::Points => point_range(interval),
            Self::Speed => ratio_range(interval),
            Self::Number(..) if !interval.width().is_finite() => "open".to_owned(),
            Self::Number(digits, _) => {
                let number = |value| decimals(value, digits);
                format!("{} … {}", number(interval.low), number(interval.high))
            }
        }
    }
}

impl Serialize for Unit {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.name())
    }
}

/// A published statement or number.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Published {
    /// The number, or the word for it.
    pub text: String,
    /// The number, if it is one.
    pub value: Option<f64>,
}

impl Published {
    /// Returns a published number.
    pub fn number(value: f64, unit: Unit) -> Self {
        Self {
            text: unit.value(value),
            value: Some(value),
        }
    }

    /// Returns a published statement.
    pub fn text(text: impl Into<String>) -> Self {
        Self {
            text: text.into(),
            value: None,
        }
    }
}

/// Result of ours for a claim.
#[derive(Debug, Clone, PartialEq)]
pub struct Measured {
    /// The number, or the text for it.
    pub text: String,
    /// The number, if it is one.
    pub value: Option<f64>,
    /// The interval that decides, mostly of 95 %; the rule of the claim says of what.
    pub interval: Option<Interval>,
    /// Unit of number and interval.
    pub unit: Unit,
    /// Number of observations.
    pub n: u64,
    /// Plural of the observed things.
    pub of: &'static str,
}

impl Measured {
    /// Returns a number with its interval.
    pub fn number(
        value: f64,
        interval: Interval,
        unit: Unit,
        (n, of): (u64, &'static str),
    ) -> Self {
        Self {
            text: unit.value(value),
            value: Some(value),
            interval: Some(interval),
            unit,
            n,
            of,
        }
    }

    /// Returns a number without an interval: it is computed, not sampled.
    pub fn computed(value: f64, unit: Unit) -> Self {
        Self {
            text: unit.value(value),
            value: Some(value),
            interval: None,
            unit,
            n: 1,
            of: "computation",
        }
    }

    /// Returns the mark of a missing number.
    pub fn none() -> Self {
        Self {
            text: "–".to_owned(),
            value: None,
            interval: None,
            unit: Unit::Number(0, ""),
            n: 0,
            of: "results",
        }
    }

    /// Formats the interval; `–` without one.
    pub fn interval_text(&self) -> String {
        let text = self.interval.map(|interval| self.unit.interval(interval));
        text.unwrap_or_else(|| "–".to_owned())
    }
}

impl Serialize for Measured {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        use serde::ser::SerializeMap as _;
        let mut map = serializer.serialize_map(None)?;
        map.serialize_entry("text", &self.text)?;
        map.serialize_entry("value", &self.value)?;
        map.serialize_entry("unit", &self.unit)?;
        // An open end is null.
        let ends = self.interval.map(|interval| [interval.low, interval.high]);
        map.serialize_entry("interval", &ends)?;
        map.serialize_entry("interval_text", &self.interval_text())?;
        map.serialize_entry("n", &self.n)?;
        map.serialize_entry("of", self.of)?;
        map.end()
    }
}

/// A claim with its verdict.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Claim {
    /// The paper.
    pub paper: Paper,
    /// Key of the claim, unique among all.
    pub id: String,
    /// Statement, with its place in the paper.
    pub claim: String,
    /// The published statement or number.
    pub published: Published,
    /// The number of ours that decides.
    pub ours: Measured,
    /// Verdict by the rule.
    pub verdict: Verdict,
    /// Rule of the verdict, and meaning of the interval.
    pub rule: &'static str,
    /// Further numbers, a line each.
    pub details: Vec<String>,
    /// `true` if it compares times of this machine, which differ between runs.
    pub timed: bool,
}

/// A verdict, the number that it rests on, and further numbers.
#[derive(Debug, Clone, PartialEq)]
pub struct Finding {
    /// The verdict.
    pub verdict: Verdict,
    /// The number that decides.
    pub ours: Measured,
    /// The numbers, a line each.
    pub numbers: Vec<String>,
}

impl Finding {
    /// Returns a finding without data.
    pub fn missing(what: &str) -> Self {
        Self {
            verdict: Verdict::NoData,
            ours: Measured::none(),
            numbers: vec![format!("There are no results for this: {what}.")],
        }
    }
}

/// Rule of [`Finding::one_run`].
pub const ONE_RUN: &str = "The published value is one run under one key: refuted if it lies outside our 95 % \
                           prediction interval for one more run, confirmed if inside that of five runs or more.";
/// Minimum number of runs that confirm a value.
const MIN_RUNS: usize = 5;
/// Rule of [`Finding::exact`].
pub const EXACT: &str = "Computed: confirmed if it rounds to the published digits, refuted if not.";

impl Finding {
    /// Compares a published value of one run with several runs of ours.
    pub fn one_run(published: f64, values: &[f64], unit: Unit, of: &'static str) -> Self {
        let Some(mean) = Mean::of(values) else {
            return Self::missing("a value of a run");
        };
        let interval = prediction_95(&mean);
        let verdict = match (interval.contains(published), mean.count >= MIN_RUNS) {
            (false, _) => Verdict::Refuted,
            (true, true) => Verdict::Confirmed,
            (true, false) => Verdict::Undecided,
        };
        Self {
            verdict,
            ours: Measured::number(mean.value, interval, unit, (mean.count as u64, of)),
            numbers: Vec::new(),
        }
    }

    /// Compares a published value with a computed one, at the digits of its unit.
    pub fn exact(published: f64, ours: f64, unit: Unit) -> Self {
        let same = unit.value(published) == unit.value(ours);
        Self {
            verdict: if same {
                Verdict::Confirmed
            } else {
                Verdict::Refuted
            },
            ours: Measured::computed(ours, unit),
            numbers: Vec::new(),
        }
    }
}

impl Claim {
    /// Returns a claim about a published number.
    pub fn number(
        (paper, id): (Paper, &str),
        claim: impl Into<String>,
        published: Published,
        rule: &'static str,
        finding: Finding,
    ) -> Self {
        Self {
            paper,
            id: format!("{}.{id}", paper.key()),
            claim: claim.into(),
            published,
            ours: finding.ours,
            verdict: finding.verdict,
            rule,
            details: finding.numbers,
            timed: false,
        }
    }
}
