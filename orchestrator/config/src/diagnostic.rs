//! Problems of a scenario with their places, and their text.

use std::fmt;

use serde::Serialize;
use thiserror::Error;

/// Kind of problem that a [`Diagnostic`] reports.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Code {
    /// The text is not TOML.
    Syntax,
    /// A key that does not exist.
    UnknownKey,
    /// A required key is missing.
    MissingKey,
    /// A value of the wrong type.
    WrongType,
    /// A value of the right type that is out of range.
    OutOfRange,
    /// A name (of a robot, process kind, preset, obstacle …) that does not exist.
    UnknownName,
    /// A duplicate name.
    Duplicate,
    /// An impossible position.
    Geometry,
    /// A part that another part requires is missing or duplicated.
    Requirement,
    /// A file that cannot or must not be read.
    File,
    /// A limit is exceeded.
    Limit,
    /// An invalid `--set` argument.
    Override,
}

/// A position in a text, with its line.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Place {
    /// Name of the file, or `--set …` for an override.
    pub file: String,
    /// `true` if the text is a `--set` argument.
    pub is_override: bool,
    /// Line, from 1.
    pub line: usize,
    /// Column in characters, from 1.
    pub column: usize,
    /// Number of marked characters, within the line.
    pub length: usize,
    /// The line, shortened if long.
    pub snippet: String,
    /// Column in characters, from 0, within `snippet`.
    pub marker: usize,
}

/// One problem: message, place, value, expectation and help.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Error)]
#[error("{}", self.render())]
pub struct Diagnostic {
    /// Kind of the problem.
    pub code: Code,
    /// Description of the problem in one sentence.
    pub message: String,
    /// Place in a text, if there is one.
    pub place: Option<Place>,
    /// Dotted path of the field as `--set` takes it; empty for the whole file.
    pub field: String,
    /// The invalid value as written.
    pub value: Option<String>,
    /// Description of the allowed values.
    pub expected: Option<String>,
    /// Suggested correction.
    pub help: Option<String>,
}

impl Diagnostic {
    /// Creates a problem without a place.
    pub fn new(code: Code, message: impl Into<String>) -> Self {
        Self {
            code,
            message: message.into(),
            place: None,
            field: String::new(),
            value: None,
            expected: None,
            help: None,
        }
    }

    /// Sets the place.
    #[must_use]
    pub fn at(mut self, place: Option<Place>) -> Self {
        self.place = place;
        self
    }

    /// Sets the dotted path of the field.
    #[must_use]
    pub fn field(mut self, field: impl fmt::Display) -> Self {
        self.field = field.to_string();
        self
    }

    /// Sets the invalid value.
    #[must_use]
    pub fn value(mut self, value: impl fmt::Display) -> Self {
        self.value = Some(value.to_string());
        self
    }

    /// Sets the description of the allowed values.
    #[must_use]
    pub fn expected(mut self, expected: impl Into<String>) -> Self {
        self.expected = Some(expected.into());
        self
    }

    /// Sets the suggested correction.
    #[must_use]
    pub fn help(mut self, help: impl Into<String>) -> Self {
        self.help = Some(help.into());
        self
    }

    fn render(&self) -> String {
        use fmt::Write;
        let mut out = format!("error: {}", self.message);
        let at = if self.field.is_empty() {
            String::new()
        } else {
            format!(" ({})", self.field)
        };
        let gutter;
        if let Some(p) = &self.place {
            let number = p.line.to_string();
            gutter = " ".repeat(number.len());
            // Writing to a String cannot fail.
            let _ = if p.is_override {
                write!(out, "\n{gutter}--> {}{at}", p.file)
            } else {
                write!(out, "\n{gutter}--> {}:{}:{}{at}", p.file, p.line, p.column)
            };
            let marker = " ".repeat(p.marker) + &"^".repeat(p.length);
            let _ = write!(
                out,
                "\n{gutter} |\n{number} | {}\n{gutter} | {marker}",
                p.snippet
            );
        } else {
            gutter = " ".to_owned();
            if !self.field.is_empty() {
                let _ = write!(out, "\n{gutter}--> {}", self.field);
            }
        }
        let notes = [
            ("value", &self.value),
            ("expected", &self.expected),
            ("help", &self.help),
        ];
        for (label, text) in notes {
            if let Some(text) = text {
                let _ = write!(out, "\n{gutter} = {label}: {text}");
            }
        }
        out
    }
}

/// Maximum number of problems that are kept; one broken line can cause many.
const MAX_SHOWN: usize = 40;

/// All problems found in a scenario, in the order of the text.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Error)]
#[error("{}", self.render())]
pub struct Diagnostics {
    list: Vec<Diagnostic>,
    dropped: usize,
}

impl Diagnostics {
    /// Adds a problem, unless an equal one is listed, or the same one at the same place of a file: robots inherit values,
    /// and with them their faults. Problems beyond the maximum are only counted.
    pub fn push(&mut self, problem: Diagnostic) {
        let is_in_file = problem.place.as_ref().is_some_and(|p| !p.is_override);
        let is_same = |listed: &Diagnostic| {
            *listed == problem
                || is_in_file
                    && listed.place == problem.place
                    && listed.message == problem.message
                    && listed.value == problem.value
        };
        if self.list.iter().any(is_same) {
            return;
        }
        if self.list.len() >= MAX_SHOWN {
            self.dropped += 1;
        } else {
            self.list.push(problem);
        }
    }

    /// Returns `true` without problems.
    pub fn is_empty(&self) -> bool {
        self.list.is_empty()
    }

    /// Returns the number of problems, including those not kept.
    pub fn len(&self) -> usize {
        self.list.len() + self.dropped
    }

    /// Returns the kept problems.
    pub fn iter(&self) -> impl Iterator<Item = &Diagnostic> {
        self.list.iter()
    }

    /// Returns `value` without problems, else the problems sorted by place.
    ///
    /// # Errors
    /// The problems.
    pub fn into_result<T>(self, value: T) -> Result<T, Self> {
        if self.is_empty() {
            Ok(value)
        } else {
            Err(self.sorted())
        }
    }

    /// Adds a problem if there is none, for a failure without a reported cause.
    pub fn push_if_empty(&mut self, problem: impl FnOnce() -> Diagnostic) {
        if self.is_empty() {
            self.push(problem());
        }
    }

    /// Sorts the problems by their place in the text.
    #[must_use]
    pub fn sorted(mut self) -> Self {
        // Order: problems of files by line, of overrides, without a place.
        self.list.sort_by_key(|d| match &d.place {
            Some(p) if !p.is_override => (0, p.line, p.column),
            Some(p) => (1, p.line, p.column),
            None => (2, 0, 0),
        });
        self
    }

    fn render(&self) -> String {
        let mut parts: Vec<String> = self.list.iter().map(ToString::to_string).collect();
        if self.dropped > 0 {
            parts.push(format!("… and {} more problems", self.dropped));
        }
        parts.join("\n\n")
    }
}

impl From<Diagnostic> for Diagnostics {
    fn from(problem: Diagnostic) -> Self {
        Self {
            list: vec![problem],
            dropped: 0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn place() -> Place {
        Place {
            file: "chase.toml".into(),
            is_override: false,
            line: 12,
            column: 5,
            length: 3,
            snippet: "v = abc".into(),
            marker: 4,
        }
    }

    #[test]
    fn a_problem_shows_file_line_field_value_and_expectation() {
        let d = Diagnostic::new(Code::WrongType, "not a number")
            .at(Some(place()))
            .field("robots.a.v")
            .value("abc")
            .expected("a number")
            .help("write 0.3");
        let want = "error: not a number\n  --> chase.toml:12:5 (robots.a.v)\n   |\n12 | v = abc\n   |     ^^^\n   \
                    = value: abc\n   = expected: a number\n   = help: write 0.3";
        assert_eq!(d.to_string(), want);
    }

    #[test]
    fn an_override_is_shown_instead_of_a_line() {
        let p = Place {
            file: "--set".into(),
            is_override: true,
            ..place()
        };
        let text = Diagnostic::new(Code::WrongType, "bad")
            .at(Some(p))
            .field("a.b")
            .to_string();
        assert!(text.contains("--> --set (a.b)"), "{text}");
        assert!(!text.contains(":12:5"), "{text}");
    }

    #[test]
    fn a_fault_that_robots_inherit_is_reported_once() {
        let fault = |field: &str, value: &str| {
            let fault = Diagnostic::new(Code::UnknownKey, "unknown key `vmax`");
            fault.at(Some(place())).field(field).value(value)
        };
        let mut all = Diagnostics::default();
        for field in ["teams.police.limits.vmax", "robots.guard.limits.vmax"] {
            all.push(fault(field, "0.2"));
        }
        assert_eq!(all.len(), 1);
        all.push(fault("robots.guard.limits.vmax", "0.3"));
        assert_eq!(all.len(), 2);
    }

    #[test]
    fn problems_are_sorted_by_line_deduplicated_and_capped() {
        let mut all = Diagnostics::default();
        for i in (0..100).rev() {
            let p = Place {
                line: i + 1,
                ..place()
            };
            all.push(Diagnostic::new(Code::Syntax, "x").at(Some(p.clone())));
            all.push(Diagnostic::new(Code::Syntax, "x").at(Some(p)));
        }
        assert_eq!(all.len(), 160);
        let err = all.into_result(()).unwrap_err();
        let lines: Vec<_> = err.iter().map(|d| d.place.as_ref().unwrap().line).collect();
        assert!(lines.is_sorted());
        assert!(err.to_string().contains("more problems"));
    }
}
