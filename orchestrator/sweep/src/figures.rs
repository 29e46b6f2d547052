//! The figures of an experiment, drawn from its results: `figures/NAME.svg`.
//!
//! All inputs are in the directory of the results: the rows, the experiment file with its
//! `[[figures]]` (without any: one of the main outcome), and the published points for comparison, which [`keep_published`] copies there.

use std::collections::BTreeMap;
use std::path::{Component, Path, PathBuf};

use draw::figures::{Chart, Point, Series, draw};
use platform::atomic_file::save;
use serde::Deserialize;

use super::cell::Value;
use super::error::SweepError;
use super::manifest::ManifestCell;
use super::metrics::Metric;
use super::results::Results;
use super::row::Row;
use super::spec::FigureSpec;

/// Folder of the figures.
const FOLDER: &str = "figures";

/// The parts of an experiment file that figures use.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(default)]
struct Shown {
    cases: Vec<Titled>,
    parameters: BTreeMap<String, Titled>,
    figures: Option<Vec<FigureSpec>>,
}

impl Shown {
    /// Returns the figures; without the key, [`default_figure`].
    fn figures(&self, results: &Results) -> Vec<FigureSpec> {
        let default = || default_figure(results).into_iter().collect();
        self.figures.clone().unwrap_or_else(default)
    }
}

#[derive(Debug, Clone, Default, Deserialize)]
#[serde(default)]
struct Titled {
    name: String,
    title: Option<String>,
}

/// A row of a file of published points.
#[derive(Debug, Clone, Deserialize)]
struct Published {
    series: String,
    x: f64,
    y: f64,
    low: Option<f64>,
    high: Option<f64>,
}

/// Copies the files of published points that an experiment's figures name from the folder of the
/// experiment to its results.
///
/// # Errors
/// [`SweepError::Io`]; [`SweepError::Figure`] if a path leads out of the folder.
pub fn keep_published(folder: &Path, results: &Results) -> Result<(), SweepError> {
    for figure in shown(results)?.figures(results) {
        let Some(compare) = figure.compare else {
            continue;
        };
        let plain = |c: Component<'_>| matches!(c, Component::Normal(_) | Component::CurDir);
        if !Path::new(&compare).components().all(plain) {
            return Err(SweepError::Figure {
                name: figure.name,
                reason: format!(
                    "`compare` is {compare:?}: expected a path below the experiment's folder"
                ),
            });
        }
        let (from, to) = (folder.join(&compare), results.directory().join(&compare));
        let bytes = std::fs::read(&from)
            .map_err(SweepError::io(&from, "cannot read the published points"))?;
        put(&bytes, &to)?;
    }
    Ok(())
}

/// Draws all figures of an experiment; returns the files written.
///
/// # Errors
/// [`SweepError::Io`], [`SweepError::Figure`], [`SweepError::Damaged`].
pub fn write(results: &Results) -> Result<Vec<PathBuf>, SweepError> {
    let mut written = Vec::new();
    for (name, chart) in charts(results)? {
        let path = results.directory().join(FOLDER).join(format!("{name}.svg"));
        put(draw(&chart).svg().as_bytes(), &path)?;
        written.push(path);
    }
    Ok(written)
}

/// Returns all figures of an experiment as charts, with their names.
///
/// # Errors
/// As [`fn@write`].
pub fn charts(results: &Results) -> Result<Vec<(String, Chart)>, SweepError> {
    let shown = shown(results)?;
    let figures = shown.figures(results);
    figures
        .iter()
        .map(|figure| {
            let published = match &figure.compare {
                Some(compare) => read_published(&results.directory().join(compare))?,
                None => Vec::new(),
            };
            Ok((
                figure.name.clone(),
                chart(figure, results, &shown, &published),
            ))
        })
        .collect()
}

/// Returns the figure of an experiment without the key `figures`: the main outcome over the first parameter with
/// several values; `None` without such a parameter.
fn default_figure(results: &Results) -> Option<FigureSpec> {
    let manifest = results.manifest();
    let varies = |axis: &usize| {
        let mut values = manifest.cells.iter().map(|cell| cell.values.get(*axis));
        let first = values.next();
        values.any(|value| Some(value) != first)
    };
    let axis = (0..manifest.parameters.len()).find(varies)?;
    let rows: Vec<&Row> = results.rows().map(|(_, row)| row).collect();
    let outcomes = [
        Metric::EscapeChance,
        Metric::Coverage,
        Metric::LapLength,
        Metric::GameTime,
    ];
    let metric = outcomes
        .into_iter()
        .find(|metric| metric.measure(&rows).is_some())?;
    Some(FigureSpec {
        name: "outcome".to_owned(),
        title: String::new(),
        x: manifest.parameters.get(axis)?.clone(),
        metric,
        compare: None,
    })
}

fn put(bytes: &[u8], path: &Path) -> Result<(), SweepError> {
    save(bytes, path).map_err(|error| SweepError::Io {
        path: error.path,
        what: "cannot write",
        source: error.source,
    })
}

fn shown(results: &Results) -> Result<Shown, SweepError> {
    let text = results.experiment()?;
    toml::from_str(&text).map_err(|error| SweepError::Damaged {
        path: results.directory().join("experiment.toml"),
        line: error.span().map_or(1, |span| {
            text.get(..span.start)
                .map_or(1, |before| before.matches('\n').count() + 1)
        }),
        what: "not the experiment file of these results".to_owned(),
        found: error.message().to_owned(),
        expected: "the copy that `protean sweep` wrote",
    })
}

fn read_published(path: &Path) -> Result<Vec<Published>, SweepError> {
    let bytes =
        std::fs::read(path).map_err(SweepError::io(path, "cannot read the published points"))?;
    let rows: Result<Vec<Published>, csv::Error> = csv::Reader::from_reader(bytes.as_slice())
        .deserialize()
        .collect();
    rows.map_err(|error| SweepError::Damaged {
        path: path.to_owned(),
        line: error.position().map_or(1, |p| p.line() as usize),
        what: "not a table of points".to_owned(),
        found: error.to_string(),
        expected: "the columns series, x, y, and optionally low and high, with numbers",
    })
}

/// Draws one figure.
fn chart(figure: &FigureSpec, results: &Results, shown: &Shown, published: &[Published]) -> Chart {
    let manifest = results.manifest();
    let axis = manifest.parameters.iter().position(|p| *p == figure.x);
    let mut rows: Vec<Vec<&Row>> = vec![Vec::new(); manifest.cells.len()];
    for (mission, row) in results.rows().filter(|(_, row)| !row.is_failed()) {
        if let Some(of_cell) = rows.get_mut(mission.cell) {
            of_cell.push(row);
        }
    }
    let x_of = |cell: &ManifestCell| axis.and_then(|axis| cell.values.get(axis)).cloned();
    let places = Places::of(manifest.cells.iter().filter_map(x_of));
    let mut series: Vec<(Vec<String>, Series)> = Vec::new();
    for (cell, rows) in manifest.cells.iter().zip(&rows) {
        let (key, name) = curve(figure, shown, &manifest.parameters, cell);
        let index = series
            .iter()
            .position(|(k, _)| *k == key)
            .unwrap_or_else(|| {
                let reference = published
                    .iter()
                    .filter(|p| key.contains(&p.series) || p.series == name);
                let reference = reference.map(|p| Point {
                    x: p.x,
                    y: p.y,
                    interval: p.low.zip(p.high),
                });
                let reference = reference.collect();
                series.push((
                    key.clone(),
                    Series {
                        name: name.clone(),
                        points: Vec::new(),
                        reference,
                    },
                ));
                series.len() - 1
            });
        let at = x_of(cell).and_then(|value| places.place(&value));
        if let (Some(x), Some((y, interval)), Some((_, curve))) =
            (at, figure.metric.measure(rows), series.get_mut(index))
        {
            curve.points.push(Point { x, y, interval });
        }
    }
    let title = |name: &str| {
        let parameter = shown.parameters.get(name);
        let title = parameter.and_then(|p| p.title.clone());
        title.unwrap_or_else(|| name.replace('_', " "))
    };
    Chart {
        title: match (&*figure.title, &*manifest.title) {
            // An experiment without a title: its name stands below.
            ("", name) if name == manifest.experiment => {
                format!("{} by {}", figure.metric.label(), title(&figure.x))
            }
            ("", title) | (title, _) => title.to_owned(),
        },
        subtitle: format!("{}: {}", manifest.experiment, games(&rows)),
        x_label: title(&figure.x),
        x_names: places.names(),
        y_label: figure.metric.label().to_owned(),
        unit: figure.metric.unit(),
        series: series.into_iter().map(|(_, series)| series).collect(),
        reference: "published".to_owned(),
        ..Chart::default()
    }
}

/// Returns the curve of a cell: its key, and its name. Every case has a curve; each value of a
/// parameter that is not on the axis has its own curve.
fn curve(
    figure: &FigureSpec,
    shown: &Shown,
    parameters: &[String],
    cell: &ManifestCell,
) -> (Vec<String>, String) {
    let case = shown.cases.iter().find(|c| c.name == cell.case);
    let case_title = case
        .and_then(|c| c.title.clone())
        .unwrap_or_else(|| cell.case.replace('_', " "));
    let mut key = vec![cell.case.clone()];
    let mut name = vec![case_title];
    for (parameter, value) in parameters.iter().zip(&cell.values) {
        if *parameter != figure.x {
            key.push(value.to_string());
            name.push(format!("{} {value}", parameter.replace('_', " ")));
        }
    }
    (key, name.join(", "))
}

/// Returns the number of games of the cells, as text.
fn games(rows: &[Vec<&Row>]) -> String {
    let counts = || rows.iter().map(Vec::len);
    match (counts().min(), counts().max()) {
        (Some(least), Some(most)) if least == most => format!("{most} games per point"),
        (Some(least), Some(most)) => format!("{least} to {most} games per point"),
        _ => "no games".to_owned(),
    }
}

/// Positions of values on the horizontal axis: numbers at their value, other values in order.
enum Places {
    Numbers,
    Names(Vec<String>),
}

impl Places {
    fn of(values: impl Iterator<Item = Value>) -> Self {
        let values: Vec<Value> = values.collect();
        if values.iter().all(|v| v.number().is_some()) {
            return Self::Numbers;
        }
        let mut names: Vec<String> = Vec::new();
        for value in values {
            let name = value.to_string();
            if !names.contains(&name) {
                names.push(name);
            }
        }
        Self::Names(names)
    }

    fn place(&self, value: &Value) -> Option<f64> {
        match self {
            Self::Numbers => value.number(),
            Self::Names(names) => {
                let name = value.to_string();
                names.iter().position(|n| *n == name).map(|i| i as f64)
            }
        }
    }

    fn names(self) -> Vec<String> {
        match self {
            Self::Numbers => Vec::new(),
            Self::Names(names) => names,
        }
    }
}
