//! Contents of a chart.

/// A chart: curves over one quantity.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Chart {
    /// Heading.
    pub title: String,
    /// Conditions of the measurement, such as the number of games; one or two lines.
    pub subtitle: String,
    /// Label of the horizontal axis, with its unit.
    pub x_label: String,
    /// Category names of the values 0, 1, 2 … of the horizontal axis; empty for numbers.
    pub x_names: Vec<String>,
    /// Scale of the horizontal axis.
    pub x_scale: Scale,
    /// `true` for curves without marks, for curves of many points.
    pub lines_only: bool,
    /// Label of the vertical axis, with its unit.
    pub y_label: String,
    /// Scale of the vertical axis; always linear for shares.
    pub y_scale: Scale,
    /// Unit of the vertical axis.
    pub unit: Unit,
    /// The curves, in the order of the legend.
    pub series: Vec<Series>,
    /// Legend of the hollow marks; ignored without reference points.
    pub reference: String,
    /// Legend of the bars at the points; empty for `95 % interval`.
    pub interval: String,
}

/// Scale of an axis.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Scale {
    /// Linear.
    #[default]
    Linear,
    /// Logarithmic; values that are not positive are left out.
    Logarithmic,
}

impl Scale {
    /// Returns the coordinate of a value on the axis.
    pub(super) fn place(self, value: f64) -> f64 {
        match self {
            Self::Linear => value,
            Self::Logarithmic => geometry::math::ln(value) / core::f64::consts::LN_10,
        }
    }

    /// Returns `true` if the axis can show the value.
    fn has(self, value: f64) -> bool {
        self == Self::Linear || value >= MIN_LOG_VALUE
    }
}

/// Format of values.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Unit {
    /// Shares of 0 to 1, written in per cent.
    #[default]
    Share,
    /// Plain numbers.
    Number,
}

/// One curve.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Series {
    /// Name in the legend.
    pub name: String,
    /// Points, joined in the order of x. Values that are not finite or exceed 10¹⁰⁰ are left out.
    pub points: Vec<Point>,
    /// Published points for comparison, drawn as hollow marks and not joined.
    pub reference: Vec<Point>,
}

/// Minimum value on a logarithmic axis.
const MIN_LOG_VALUE: f64 = 1e-100;
/// Maximum magnitude of a value.
const MAX_VALUE: f64 = 1e100;

/// One point of a curve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point {
    /// Value on the horizontal axis: a number, or an index of [`Chart::x_names`].
    pub x: f64,
    /// Value on the vertical axis; a share is 0 to 1.
    pub y: f64,
    /// Bounds of its interval, if it has one.
    pub interval: Option<(f64, f64)>,
}

impl Point {
    /// Returns `true` if its values are finite and within the range of the axes.
    pub(super) fn can_be_drawn(&self, chart: &Chart) -> bool {
        let (low, high) = self.interval.unwrap_or((self.y, self.y));
        [self.x, self.y, low, high]
            .iter()
            .all(|v| v.abs() <= MAX_VALUE)
            && chart.x_scale.has(self.x)
            && [self.y, low, high].iter().all(|v| chart.y_scale.has(*v))
    }

    /// Returns the lowest and the highest value of the point and its interval.
    pub(super) fn reach(&self) -> (f64, f64) {
        match self.interval {
            Some((low, high)) => (low.min(self.y), high.max(self.y)),
            None => (self.y, self.y),
        }
    }
}

impl Chart {
    /// Returns all points that can be drawn, reference points included.
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

    /// Returns `true` if the chart has reference points.
    pub(super) fn has_reference(&self) -> bool {
        self.series.iter().any(|s| !s.reference.is_empty())
    }
}

impl Unit {
    /// Formats a value: `63.5 %`, `12.25`.
    pub(super) fn text(self, value: f64) -> String {
        match self {
            Self::Share => format!("{:.1} %", 100.0 * value),
            Self::Number => number(value),
        }
    }
}

/// Formats a number with at most four decimals, without trailing zeros.
pub(super) fn number(value: f64) -> String {
    let text = format!("{value:.4}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" {
        "0".to_owned()
    } else {
        text.to_owned()
    }
}
