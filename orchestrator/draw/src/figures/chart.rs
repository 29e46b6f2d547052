//! What is to be seen in a chart.

/// A chart: curves over one quantity.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Chart {
    /// Heading.
    pub title: String,
    /// What else is to be said at once: conditions, numbers of games. One line or two.
    pub subtitle: String,
    /// Text along the horizontal axis, with its unit.
    pub x_label: String,
    /// Names of the places 0, 1, 2 … on the horizontal axis, if what stands there are not numbers.
    pub x_names: Vec<String>,
    /// How the horizontal axis is divided.
    pub x_scale: Scale,
    /// Whether points have no marks: curves of so many points that lines say it all.
    pub lines_only: bool,
    /// Text along the vertical axis, with its unit.
    pub y_label: String,
    /// How the vertical axis is divided; shares are always in equal steps.
    pub y_scale: Scale,
    /// How the vertical axis is divided.
    pub unit: Unit,
    /// The curves, in the order of the legend.
    pub series: Vec<Series>,
    /// What the hollow marks are; nothing is said if there are none.
    pub reference: String,
    /// What the bars at the points are; 95 % intervals if nothing is said.
    pub interval: String,
}

/// How an axis is divided.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Scale {
    /// Equal steps.
    #[default]
    Linear,
    /// Powers of ten; what is not positive has no place there.
    Logarithmic,
}

impl Scale {
    /// Where a value lies.
    pub(super) fn place(self, value: f64) -> f64 {
        match self {
            Self::Linear => value,
            Self::Logarithmic => geometry::math::ln(value) / core::f64::consts::LN_10,
        }
    }

    /// Whether a value has a place.
    fn has(self, value: f64) -> bool {
        self == Self::Linear || value >= MIN_LOG_VALUE
    }
}

/// How values are shown.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Unit {
    /// Shares of 0 to 1, written as per cent.
    #[default]
    Share,
    /// Any numbers.
    Number,
}

/// One curve.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Series {
    /// Its name in the legend.
    pub name: String,
    /// Its points; they are joined in the order of their x. What is not finite, or beyond 10¹⁰⁰,
    /// is left out.
    pub points: Vec<Point>,
    /// Points of others for comparison, drawn hollow and not joined.
    pub reference: Vec<Point>,
}

/// Smallest number that is drawn on a logarithmic axis.
const MIN_LOG_VALUE: f64 = 1e-100;
/// Largest number that is drawn.
const MAX_VALUE: f64 = 1e100;

/// One point of a curve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point {
    /// On the horizontal axis: a number, or an index of [`Chart::x_names`].
    pub x: f64,
    /// On the vertical axis; a share is 0 to 1.
    pub y: f64,
    /// The ends of its interval, if it has one.
    pub interval: Option<(f64, f64)>,
}

impl Point {
    /// Whether it can be drawn: its numbers are finite, and not so large that sums of them are not.
    pub(super) fn can_be_drawn(&self, chart: &Chart) -> bool {
        let (low, high) = self.interval.unwrap_or((self.y, self.y));
        [self.x, self.y, low, high]
            .iter()
            .all(|v| v.abs() <= MAX_VALUE)
            && chart.x_scale.has(self.x)
            && [self.y, low, high].iter().all(|v| chart.y_scale.has(*v))
    }

    /// The lowest and highest value that belong to it.
    pub(super) fn reach(&self) -> (f64, f64) {
        match self.interval {
            Some((low, high)) => (low.min(self.y), high.max(self.y)),
            None => (self.y, self.y),
        }
    }
}

impl Chart {
    /// All points that can be drawn, those for comparison included.
    pub(super) fn points(&self) -> impl Iterator<Item = &Point> {
        let of = |s| {
            let s: &Series = s;
            s.points.iter().chain(&s.reference)
        };
        self.series
            .iter()
            .flat_map(of)
            .filter(|p| p.can_be_drawn(self))
    }

    /// Whether anything is compared with.
    pub(super) fn has_reference(&self) -> bool {
        self.series.iter().any(|s| !s.reference.is_empty())
    }
}

impl Unit {
    /// A value in words: `63.5 %`, `12.25`.
    pub(super) fn text(self, value: f64) -> String {
        match self {
            Self::Share => format!("{:.1} %", 100.0 * value),
            Self::Number => number(value),
        }
    }
}

/// A number with at most four digits after the point, without zeros at its end.
pub(super) fn number(value: f64) -> String {
    let text = format!("{value:.4}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" {
        "0".to_owned()
    } else {
        text.to_owned()
    }
}
