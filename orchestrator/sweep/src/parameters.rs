//! `[parameters.NAME]`: the columns of an experiment and the scenario keys that they change.

use config::{Code, FieldPath, Node, Place, Value as TomlValue, suggest};
use config::{render_float, write_value};

use super::assignments::{self, Assignment};
use super::cell::Value;
use super::reader::Reader;
use super::spec::ParameterSpec;
use scenario::Draft;

/// A parameter that is varied.
#[derive(Debug, Clone)]
pub struct Parameter {
    /// Name of its column.
    pub name: String,
    /// Title, with the unit.
    pub title: String,
    effect: Effect,
}

#[derive(Debug, Clone)]
enum Effect {
    /// The value, times a factor, is the value of this key.
    Key {
        key: String,
        place: Option<Place>,
        scale: Option<Scale>,
    },
    /// The value names a set of overrides.
    Levels(Vec<(String, Vec<Assignment>)>),
}

#[derive(Debug, Clone)]
enum Scale {
    Number(f64),
    /// A key of the scenario whose value is the factor, and the location of that name.
    Key(String, String),
}

/// Reads all parameters; `is_taken` tells the names of other columns of the results.
pub fn read(reader: &mut Reader, is_taken: fn(&str) -> bool) -> Vec<Parameter> {
    let tables = reader.table("parameters");
    tables
        .into_iter()
        .filter_map(|(name, path, node)| {
            if !is_column(&name) || is_taken(&name) {
                reader.refuse(
                    &path,
                    Code::OutOfRange,
                    &format!("`{name}` cannot be the name of a column"),
                    "1 to 48 of a-z, A-Z, 0-9, `_`, `-`, and not the name of another column of the results",
                );
            }
            read_one(reader, name, &path, &node)
        })
        .collect()
}

fn read_one(reader: &mut Reader, name: String, path: &FieldPath, node: &Node) -> Option<Parameter> {
    let spec: ParameterSpec = reader.read(node, path)?;
    let effect = match (node.get("set"), node.get("levels")) {
        (Some(set), None) => Effect::Key {
            key: key(reader, &path.then("set"), set)?,
            place: reader.sources.place(set.origin),
            scale: match node.get("scale") {
                Some(scale) => Some(read_scale(reader, &path.then("scale"), scale)?),
                None => None,
            },
        },
        (None, Some(table)) => {
            if node.get("scale").is_some() {
                reader.refuse(
                    &path.then("scale"),
                    Code::Requirement,
                    "levels cannot be scaled",
                    "`scale` beside `set` only",
                );
            }
            Effect::Levels(levels(reader, &path.then("levels"), table)?)
        }
        (set, _) => {
            let message = if set.is_some() {
                format!("parameter `{name}` has both `set` and `levels`")
            } else {
                format!("parameter `{name}` changes nothing")
            };
            reader.refuse(
                path,
                Code::Requirement,
                &message,
                "`set` (the key that takes the value), or `levels` (named tables of overrides)",
            );
            return None;
        }
    };
    Some(Parameter {
        title: spec.title.unwrap_or_else(|| name.replace('_', " ")),
        name,
        effect,
    })
}

/// Returns `true` if a column can have this name.
fn is_column(name: &str) -> bool {
    let plain = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
    (1..=48).contains(&name.len()) && name.chars().all(plain)
}

fn key(reader: &mut Reader, path: &FieldPath, node: &Node) -> Option<String> {
    let key = node.as_str().map(str::to_owned);
    if key.is_none() {
        let expected = "a key of the scenario as `--set` takes it, for example \"teams.evader.limits.v_max\"; `levels` for several";
        reader.wrong_type(path, node, expected);
    }
    key
}

fn read_scale(reader: &mut Reader, path: &FieldPath, node: &Node) -> Option<Scale> {
    match &node.value {
        TomlValue::Float(v) if v.is_finite() => Some(Scale::Number(*v)),
        TomlValue::Int(v) => Some(Scale::Number(*v as f64)),
        TomlValue::Str(key) => Some(Scale::Key(key.clone(), reader.line_of(node))),
        _ => {
            reader.wrong_type(
                path,
                node,
                "a number, or the key of a number in the scenario",
            );
            None
        }
    }
}

fn levels(
    reader: &mut Reader,
    path: &FieldPath,
    node: &Node,
) -> Option<Vec<(String, Vec<Assignment>)>> {
    let Some(table) = node.as_table().filter(|t| !t.entries.is_empty()) else {
        reader.wrong_type(
            path,
            node,
            "a table with a table of overrides for every level",
        );
        return None;
    };
    let entries = table.entries.iter();
    Some(
        entries
            .map(|e| {
                let found = assignments::read(reader, &path.then(&e.key), &e.node);
                (e.key.clone(), found)
            })
            .collect(),
    )
}

impl Parameter {
    /// Checks that the parameter can have a value; reports problems at the location of the value.
    pub fn check(&self, reader: &mut Reader, path: &FieldPath, node: &Node) -> Option<Value> {
        let Some(value) = Value::from_node(node) else {
            reader.wrong_type(path, node, "a finite number, text, true or false");
            return None;
        };
        match &self.effect {
            Effect::Key { scale: Some(_), .. } if value.number().is_none() => {
                let expected = format!("a number, for `{}` is scaled", self.name);
                reader.wrong_type(path, node, &expected);
                None
            }
            Effect::Key { .. } => Some(value),
            Effect::Levels(levels) => {
                let names: Vec<&str> = levels.iter().map(|l| l.0.as_str()).collect();
                let word = value.to_string();
                if names.contains(&word.as_str()) {
                    return Some(value);
                }
                let message = format!("`{}` has no level `{word}`", self.name);
                let problem = reader.problem(path, Code::UnknownName, message);
                reader.problems.push(suggest(problem, &word, &names, ""));
                None
            }
        }
    }

    /// Returns the overrides of a value, in a scenario with its case's overrides applied; `draft`
    /// is `None` if there is no scenario that could contain a factor.
    ///
    /// # Errors
    /// The missing factor, and the location of its name.
    pub fn assignments(
        &self,
        value: &Value,
        node: &Node,
        reader: &Reader,
        draft: Option<&Draft<'_>>,
    ) -> Result<Vec<Assignment>, ScaleError> {
        match &self.effect {
            Effect::Levels(levels) => {
                let word = value.to_string();
                let level = levels.iter().find(|l| l.0 == word);
                Ok(level.map(|l| l.1.clone()).unwrap_or_default())
            }
            Effect::Key { key, place, scale } => {
                let text = match (scale, value.number()) {
                    (Some(scale), Some(number)) => {
                        render_float(rounded(number * scale.factor(draft)?))
                    }
                    _ => write_value(node),
                };
                Ok(vec![Assignment {
                    argument: format!("{key}={text}"),
                    label: reader.line_of(node),
                    key_place: place.clone(),
                }])
            }
        }
    }
}

/// A missing factor.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ScaleError {
    /// Key that must contain it.
    pub key: String,
    /// Actual value.
    pub found: String,
    /// Location of its name.
    pub label: String,
}

impl Scale {
    fn factor(&self, draft: Option<&Draft<'_>>) -> Result<f64, ScaleError> {
        match self {
            Self::Number(factor) => Ok(*factor),
            Self::Key(key, label) => {
                let node = draft.and_then(|draft| draft.find(key));
                match node.map(|n| &n.value) {
                    Some(TomlValue::Float(v)) if v.is_finite() => Ok(*v),
                    Some(TomlValue::Int(v)) => Ok(*v as f64),
                    _ => Err(ScaleError {
                        key: key.clone(),
                        found: node.map_or_else(|| "nothing".to_owned(), Node::render_short),
                        label: label.clone(),
                    }),
                }
            }
        }
    }
}

/// Rounded to twelve digits, so that 1.5 × 0.3 is 0.45 and not 0.44999999999999996.
fn rounded(v: f64) -> f64 {
    format!("{v:.11e}").parse().unwrap_or(v)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn products_are_rounded() {
        assert_eq!(rounded(1.5 * 0.3), 0.45);
        assert_eq!(rounded(0.8 * 0.3), 0.24);
        assert_eq!(rounded(-1e-9 / 3.0), -3.333_333_333_33e-10);
        assert_eq!(rounded(0.0), 0.0);
    }
}
