//! Dotted paths of fields, as shown in errors and taken by `--set`.

use std::fmt;

/// One step of a [`FieldPath`].
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Step {
    /// A key of a table.
    Key(String),
    /// An element of an array, from 0.
    Index(usize),
    /// An element of an array of tables, named by its `name`; the index serves look-ups.
    Named(usize, String),
}

/// Path of a value in the tree of tables and arrays.
///
/// Its text is `robots.police_1.limits.v_max`; elements without a name are shown by index, `events[0]`.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct FieldPath(pub Vec<Step>);

impl FieldPath {
    /// Creates the path of a top-level key.
    pub fn key(key: &str) -> Self {
        Self(vec![Step::Key(key.to_owned())])
    }

    /// Parses a dotted field such as `exits[0].circle.radius`; invalid text becomes a single key.
    pub fn parse(field: &str) -> Self {
        let mut steps = Vec::new();
        for part in field.split('.') {
            let (key, mut rest) = part.split_at(part.find('[').unwrap_or(part.len()));
            steps.push(Step::Key(key.to_owned()));
            while let Some((index, after)) = rest.strip_prefix('[').and_then(|r| r.split_once(']'))
            {
                let Ok(index) = index.parse() else {
                    return Self::key(field);
                };
                steps.push(Step::Index(index));
                rest = after;
            }
            if !rest.is_empty() || key.is_empty() {
                return Self::key(field);
            }
        }
        Self(steps)
    }

    /// Returns this path extended by a key.
    #[must_use]
    pub fn then(&self, key: &str) -> Self {
        self.step(Step::Key(key.to_owned()))
    }

    /// Returns this path extended by a step.
    #[must_use]
    pub fn step(&self, step: Step) -> Self {
        let mut steps = self.0.clone();
        steps.push(step);
        Self(steps)
    }

    /// Returns this path followed by another.
    #[must_use]
    pub fn join(&self, rest: &Self) -> Self {
        Self(self.0.iter().chain(&rest.0).cloned().collect())
    }
}

impl fmt::Display for FieldPath {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, step) in self.0.iter().enumerate() {
            match step {
                Step::Index(index) => write!(f, "[{index}]")?,
                Step::Key(key) | Step::Named(_, key) => {
                    if i > 0 {
                        f.write_str(".")?;
                    }
                    if is_bare(key) {
                        f.write_str(key)?;
                    } else {
                        write!(f, "{key:?}")?;
                    }
                }
            }
        }
        Ok(())
    }
}

/// Returns `true` if TOML allows the key without quotes.
pub fn is_bare(key: &str) -> bool {
    !key.is_empty()
        && key
            .bytes()
            .all(|b| b.is_ascii_alphanumeric() || b == b'_' || b == b'-')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_read_like_overrides() {
        let path = FieldPath::key("robots")
            .step(Step::Named(0, "police_1".into()))
            .then("limits")
            .then("odd key");
        assert_eq!(path.to_string(), "robots.police_1.limits.\"odd key\"");
        let path = FieldPath::key("events").step(Step::Index(2)).then("time_s");
        assert_eq!(path.to_string(), "events[2].time_s");
    }

    #[test]
    fn fields_are_read_back_as_they_are_shown() {
        for field in [
            "a",
            "limits.v_max",
            "exits[0].circle.center[1]",
            "m[1][2].x",
        ] {
            assert_eq!(FieldPath::parse(field).to_string(), field);
        }
        assert_eq!(FieldPath::parse("exits[0].circle").0.len(), 3);
        for odd in ["", "a..b", "a[x]", "[0]", "a[0"] {
            assert_eq!(FieldPath::parse(odd), FieldPath::key(odd));
        }
    }
}
