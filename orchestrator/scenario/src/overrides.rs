//! `--set key=value`: overrides of values of a scenario from the command line.

use config::{
    Code, Diagnostic, Diagnostics, Entry, FieldPath, Node, Origin, SourceKind, Sources, Step,
    Table, Value, list_choices, nearest, parse_string, parse_value,
};
use toml_parser::lexer::TokenKind;

/// Applies one `key=value` to the tree of a scenario.
///
/// The key is a dotted path (`run.seed`, `rules.exits[0].circle.radius`). An element of an array of
/// tables is selected by its index or by its `name` (`robots.police_1.limits.v_max`; a process without a
/// name by its `kind`). The index `[+]` appends an element to an array. The value is TOML; a value that is
/// neither TOML nor similar to it is text, so that `run.mode=real_time` needs no quotes. Errors name the
/// argument by `label` (`--set`).
///
/// Returns the path of the changed value, with elements by their index; `None` if no value changed.
pub fn apply(
    root: &mut Node,
    sources: &mut Sources,
    label: &str,
    argument: &str,
    problems: &mut Diagnostics,
) -> Option<FieldPath> {
    let argument = argument.trim_end();
    let source = sources.add(SourceKind::Override, label, argument);
    match read(sources, source, argument) {
        Err(found) => {
            found.iter().for_each(|p| problems.push(p.clone()));
            None
        }
        Ok((steps, value)) => match assign(root, sources, &steps, value) {
            Ok(path) => Some(path),
            Err(problem) => {
                problems.push(*problem);
                None
            }
        },
    }
}

/// Returns the value at a key in the form that [`apply`] accepts; `None` if it has no value.
pub fn find<'a>(root: &'a Node, key: &str) -> Option<&'a Node> {
    let steps = key_steps(0, key)?;
    steps.iter().try_fold(root, |node, KeyStep { step, .. }| {
        match (&node.value, step) {
            (Value::Table(table), Step::Key(key)) => table.get(key),
            (Value::Array(list), step) => list.get(element(list, step)?),
            _ => None,
        }
    })
}

/// Index for `[+]`; greater than any length of an array.
const APPEND: usize = usize::MAX;

/// One step of the key with its position in the argument.
struct KeyStep {
    step: Step,
    origin: Origin,
}

fn read(
    sources: &Sources,
    source: usize,
    argument: &str,
) -> Result<(Vec<KeyStep>, Node), Diagnostics> {
    let whole = Origin::Text {
        source,
        start: 0,
        end: argument.len(),
    };
    let refuse = |message: &str, expected: &str, origin: Origin| {
        Diagnostic::new(Code::Override, message)
            .at(sources.place(origin))
            .value(format!("{argument:?}"))
            .expected(expected)
    };
    let form = "key=value, for example robots.police_1.limits.v_max=0.5";
    let Some(equals) = key_end(argument) else {
        return Err(refuse("override without `=`", form, whole).into());
    };
    let steps = key_steps(source, argument.get(..equals).unwrap_or_default()).ok_or_else(|| {
        let origin = Origin::Text {
            source,
            start: 0,
            end: equals,
        };
        refuse("override with a key that cannot be read", form, origin)
    })?;
    let text = argument.get(equals + 1..).unwrap_or_default().trim_start();
    let start = argument.len() - text.len();
    if text.is_empty() {
        let origin = Origin::Text {
            source,
            start: equals,
            end: equals + 1,
        };
        return Err(refuse(
            "override without a value",
            "a value; empty text is \"\"",
            origin,
        )
        .into());
    }
    let node = match parse_value(sources, source, start) {
        Ok(node) => node,
        Err(found) if is_word(text) && found.iter().all(|p| p.code == Code::Syntax) => Node {
            value: Value::Str(text.to_owned()),
            origin: Origin::Text {
                source,
                start,
                end: argument.len(),
            },
        },
        Err(found) => return Err(found),
    };
    Ok((steps, node))
}

/// Returns `true` for text without quotes: one line that does not start like another TOML value.
fn is_word(text: &str) -> bool {
    let starts_plain = !text.starts_with(['"', '\'', '[', '{', '#']);
    starts_plain && !text.contains(['\n', '\r', '"', '#']) && !text.contains(char::is_control)
}

/// Returns the position of the first `=` outside quotes.
fn key_end(argument: &str) -> Option<usize> {
    let mut quote = None;
    for (i, c) in argument.char_indices() {
        match (quote, c) {
            (None, '=') => return Some(i),
            (None, '"' | '\'') => quote = Some(c),
            (Some(q), c) if q == c => quote = None,
            _ => {}
        }
    }
    None
}

/// Returns the steps of a dotted key with quoted parts and `[index]`es; `None` if it is invalid.
fn key_steps(source: usize, key: &str) -> Option<Vec<KeyStep>> {
    #[derive(PartialEq)]
    enum Want {
        Part,
        Separator,
        Index,
        Close,
    }
    let lead = key.len() - key.trim_start().len();
    let text = key.trim();
    let mut steps = Vec::new();
    let mut want = Want::Part;
    for token in toml_parser::Source::new(text).lex() {
        let span = token.span();
        let origin = Origin::Text {
            source,
            start: lead + span.start(),
            end: lead + span.end(),
        };
        let part = text.get(span.start()..span.end()).unwrap_or_default();
        want = match (want, token.kind()) {
            (w, TokenKind::Eof) => {
                let complete = w == Want::Separator && !steps.is_empty() && steps.len() <= 16;
                return complete.then_some(steps);
            }
            (Want::Part, TokenKind::Atom) => {
                steps.push(KeyStep {
                    step: Step::Key(part.to_owned()),
                    origin,
                });
                Want::Separator
            }
            (Want::Part, TokenKind::BasicString | TokenKind::LiteralString) => {
                steps.push(KeyStep {
                    step: Step::Key(parse_string(part)?),
                    origin,
                });
                Want::Separator
            }
            (Want::Separator, TokenKind::Dot) => Want::Part,
            (Want::Separator, TokenKind::LeftSquareBracket) if !steps.is_empty() => Want::Index,
            (Want::Index, TokenKind::Atom) => {
                let index = if part == "+" {
                    APPEND
                } else {
                    part.parse().ok()?
                };
                steps.push(KeyStep {
                    step: Step::Index(index),
                    origin,
                });
                Want::Close
            }
            (Want::Close, TokenKind::RightSquareBracket) => Want::Separator,
            _ => return None,
        };
    }
    None
}

fn assign(
    root: &mut Node,
    sources: &Sources,
    steps: &[KeyStep],
    value: Node,
) -> Result<FieldPath, Box<Diagnostic>> {
    let mut node = root;
    let mut path = FieldPath::default();
    for (i, KeyStep { step, origin }) in steps.iter().enumerate() {
        let last = i + 1 == steps.len();
        let problem = |code, message: String, path: &FieldPath| {
            Diagnostic::new(code, message)
                .at(sources.place(*origin))
                .field(path.step(step.clone()))
        };
        if !matches!(node.value, Value::Table(_) | Value::Array(_)) {
            let message = format!(
                "`{path}` is {}: there is nothing inside it",
                node.type_name()
            );
            let found = node.render_short();
            return Err(Box::new(
                problem(Code::Override, message, &path).value(found),
            ));
        }
        node = match (&mut node.value, step) {
            (Value::Table(table), Step::Key(key)) => {
                path = path.then(key);
                if last {
                    table.set(key, *origin, value);
                    return Ok(path);
                }
                let appends =
                    matches!(steps.get(i + 1), Some(next) if next.step == Step::Index(APPEND));
                if appends && table.get(key).is_none() {
                    let empty = Node {
                        value: Value::Array(Vec::new()),
                        origin: *origin,
                    };
                    table.set(key, *origin, empty);
                }
                child(table, key, *origin)
            }
            (Value::Array(list), Step::Index(APPEND)) if last => {
                list.push(value);
                return Ok(path.step(Step::Index(list.len() - 1)));
            }
            (Value::Array(list), step) => {
                let word = step_text(step);
                let names: Vec<String> = list
                    .iter()
                    .filter_map(Node::label)
                    .map(str::to_owned)
                    .collect();
                let count = list.len();
                let index = element(list, step).filter(|&i| i < count);
                let Some(element) = index.and_then(|i| list.get_mut(i)) else {
                    let message = format!("`{path}` has no element `{word}`");
                    let range = match count {
                        0 => "nothing: the array is empty".to_owned(),
                        n => format!("an index from 0 to {}", n - 1),
                    };
                    let expected = match names.as_slice() {
                        [] => range,
                        names => format!("{}, or {range}", list_choices(names)),
                    };
                    let mut p = problem(Code::UnknownName, message, &path).expected(expected);
                    if let Some(near) = nearest(&word, names.iter().map(String::as_str)) {
                        p = p.help(format!("did you mean `{near}`?"));
                    }
                    return Err(Box::new(p));
                };
                path = path.step(element.element_step(index.unwrap_or_default()));
                if last {
                    *element = value;
                    return Ok(path);
                }
                element
            }
            _ => {
                let message = format!("`{path}` is a table, not an array");
                return Err(Box::new(
                    problem(Code::Override, message, &path).expected("a key"),
                ));
            }
        };
    }
    // The key has at least one step, and the last one returns.
    Ok(path)
}

fn step_text(step: &Step) -> String {
    match step {
        Step::Key(key) | Step::Named(_, key) => key.clone(),
        Step::Index(APPEND) => "+".to_owned(),
        Step::Index(index) => index.to_string(),
    }
}

/// Returns the table's value for a key; inserts an empty table if it is absent.
fn child<'a>(table: &'a mut Table, key: &str, origin: Origin) -> &'a mut Node {
    let index = table
        .entries
        .iter()
        .position(|e| e.key == key)
        .unwrap_or_else(|| {
            let node = Node::empty_table(origin);
            table.entries.push(Entry {
                key: key.to_owned(),
                origin,
                node,
            });
            table.entries.len() - 1
        });
    &mut table.entries[index].node
}

/// Returns the index of the element that a step selects by name or number.
fn element(list: &[Node], step: &Step) -> Option<usize> {
    match step {
        Step::Index(index) | Step::Named(index, _) => Some(*index),
        Step::Key(key) => list
            .iter()
            .position(|n| n.label() == Some(key))
            .or_else(|| key.parse().ok()),
    }
}

#[cfg(test)]
mod tests;
