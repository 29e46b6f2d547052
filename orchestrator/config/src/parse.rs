//! Parser of TOML texts into [`Node`]s.

use toml::Spanned;
use toml::de::{DeTable, DeValue};
use toml_parser::lexer::TokenKind;

use super::diagnostic::{Code, Diagnostic, Diagnostics};
use super::node::{Entry, Node, Table, Value};
use super::source::{Origin, Sources};

/// Maximum number of dots in one key: every dot is a level of nesting, and trees are walked by recursion.
const MAX_KEY_DOTS: usize = 16;
/// Maximum number of tokens of a text, without white space and comments: the parser takes a few hundred bytes
/// for each. A map of 65 536 obstacles is below the maximum, as is one of a million runs of cells.
const MAX_TOKENS: usize = 2_200_000;
/// Maximum number of reported syntax errors: finding the place of each takes a pass through the text.
const MAX_ERRORS: usize = 100;
/// Maximum nesting of tables and arrays.
const MAX_DEPTH: usize = 64;

/// Parses one of the texts as a TOML document. Reports all syntax errors; returns the valid part (`None` if
/// the text is unusable).
pub fn parse_document(
    sources: &Sources,
    source: usize,
    problems: &mut Diagnostics,
) -> Option<Node> {
    let text = sources.text(source)?;
    check_amount(sources, source, text, problems)?;
    let (root, errors) = DeTable::parse_recoverable(text);
    let broken = !errors.is_empty();
    report(sources, source, 0, &errors, problems);
    if broken {
        return None;
    }
    let converter = Converter {
        sources,
        source,
        offset: 0,
    };
    let span = 0..0;
    Some(converter.table(root.get_ref(), &span, 0, problems))
}

/// Parses a text from `offset` on as one TOML value.
///
/// # Errors
/// The message of the first syntax error.
pub fn parse_value(sources: &Sources, source: usize, offset: usize) -> Result<Node, Diagnostics> {
    let mut problems = Diagnostics::default();
    let text = sources
        .text(source)
        .and_then(|t| t.get(offset..))
        .unwrap_or_default();
    if check_amount(sources, source, text, &mut problems).is_some() {
        let (value, errors) = DeValue::parse_recoverable(text);
        report(sources, source, offset, &errors, &mut problems);
        if problems.is_empty() {
            let converter = Converter {
                sources,
                source,
                offset,
            };
            if let Some(node) = converter.value(&value, 0, &mut problems) {
                return problems.into_result(node);
            }
        }
    }
    if problems.is_empty() {
        problems.push(Diagnostic::new(Code::Syntax, "not a TOML value"));
    }
    Err(problems)
}

/// Returns the value of a quoted TOML string; `None` if it is not one.
pub fn parse_string(quoted: &str) -> Option<String> {
    DeValue::parse(quoted)
        .ok()?
        .get_ref()
        .as_str()
        .map(str::to_owned)
}

fn report(
    sources: &Sources,
    source: usize,
    offset: usize,
    errors: &[toml::de::Error],
    problems: &mut Diagnostics,
) {
    for error in errors.iter().take(MAX_ERRORS) {
        let span = error.span().unwrap_or(0..0);
        let origin = Origin::Text {
            source,
            start: span.start + offset,
            end: span.end + offset,
        };
        let (message, expected) = split_expectation(error.message());
        let mut problem = Diagnostic::new(Code::Syntax, format!("not valid TOML: {message}"))
            .at(sources.place(origin));
        if let Some(expected) = expected {
            problem = problem.expected(expected);
        }
        problems.push(problem);
    }
}

/// Splits a message of the parser at ", expected …".
fn split_expectation(message: &str) -> (&str, Option<&str>) {
    match message.split_once(", expected ") {
        Some((what, expected)) => (what, Some(expected)),
        None => (message, None),
    }
}

/// Refuses keys with too many dots and texts with too many tokens before the parser builds a tree.
fn check_amount(
    sources: &Sources,
    source: usize,
    text: &str,
    problems: &mut Diagnostics,
) -> Option<()> {
    let (mut dots, mut tokens) = (0, 0);
    for token in toml_parser::Source::new(text).lex() {
        match token.kind() {
            TokenKind::Dot => dots += 1,
            TokenKind::Whitespace
            | TokenKind::Atom
            | TokenKind::BasicString
            | TokenKind::LiteralString
            | TokenKind::MlBasicString
            | TokenKind::MlLiteralString => {}
            _ => dots = 0,
        }
        tokens += usize::from(!matches!(
            token.kind(),
            TokenKind::Whitespace | TokenKind::Comment | TokenKind::Newline
        ));
        let (message, expected) = if dots > MAX_KEY_DOTS {
            let expected = format!("at most {MAX_KEY_DOTS} dots in a key");
            ("key with too many dots", expected)
        } else if tokens > MAX_TOKENS {
            let expected = format!("at most {MAX_TOKENS} tokens in a text");
            ("too many tokens in one text", expected)
        } else {
            continue;
        };
        let span = token.span();
        let origin = Origin::Text {
            source,
            start: span.start(),
            end: span.end(),
        };
        problems.push(
            Diagnostic::new(Code::Limit, message)
                .at(sources.place(origin))
                .expected(expected),
        );
        return None;
    }
    Some(())
}

struct Converter<'a> {
    sources: &'a Sources,
    source: usize,
    /// Position of the parsed text inside the source (bytes).
    offset: usize,
}

impl Converter<'_> {
    fn origin(&self, span: &std::ops::Range<usize>) -> Origin {
        Origin::Text {
            source: self.source,
            start: span.start + self.offset,
            end: span.end + self.offset,
        }
    }

    fn refuse(
        &self,
        code: Code,
        message: &str,
        expected: &str,
        span: &std::ops::Range<usize>,
        problems: &mut Diagnostics,
    ) {
        let text = self.sources.text(self.source).unwrap_or_default();
        let range = span.start + self.offset..span.end + self.offset;
        let value: String = text
            .get(range)
            .unwrap_or_default()
            .chars()
            .take(60)
            .collect();
        problems.push(
            Diagnostic::new(code, message)
                .at(self.sources.place(self.origin(span)))
                .value(value)
                .expected(expected),
        );
    }

    fn value(
        &self,
        value: &Spanned<DeValue<'_>>,
        depth: usize,
        problems: &mut Diagnostics,
    ) -> Option<Node> {
        let span = value.span();
        if depth > MAX_DEPTH {
            let expected = format!("at most {MAX_DEPTH} levels");
            self.refuse(Code::Limit, "nested too deeply", &expected, &span, problems);
            return None;
        }
        let converted = match value.get_ref() {
            DeValue::String(text) => Value::Str(text.to_string()),
            DeValue::Boolean(v) => Value::Bool(*v),
            DeValue::Datetime(v) => Value::Datetime(v.to_string()),
            DeValue::Integer(v) => {
                let Ok(v) = i64::from_str_radix(v.as_str(), v.radix()) else {
                    let expected = format!("{} to {}", i64::MIN, i64::MAX);
                    let message = "whole number out of range";
                    self.refuse(Code::OutOfRange, message, &expected, &span, problems);
                    return None;
                };
                Value::Int(v)
            }
            DeValue::Float(v) => {
                let parsed = v.as_str().parse::<f64>().ok();
                let finite_text = !v.as_str().contains("inf");
                match parsed {
                    Some(v) if !(v.is_infinite() && finite_text) => Value::Float(v),
                    _ => {
                        let message = "number out of range";
                        let expected = "a number below 1.8e308";
                        self.refuse(Code::OutOfRange, message, expected, &span, problems);
                        return None;
                    }
                }
            }
            DeValue::Array(list) => Value::Array(
                list.iter()
                    .filter_map(|v| self.value(v, depth + 1, problems))
                    .collect(),
            ),
            DeValue::Table(table) => return Some(self.table(table, &span, depth, problems)),
        };
        Some(Node {
            value: converted,
            origin: self.origin(&span),
        })
    }

    fn table(
        &self,
        table: &DeTable<'_>,
        span: &std::ops::Range<usize>,
        depth: usize,
        problems: &mut Diagnostics,
    ) -> Node {
        let mut entries = Vec::with_capacity(table.len());
        for (key, value) in table {
            if let Some(node) = self.value(value, depth + 1, problems) {
                let origin = self.origin(&key.span());
                entries.push(Entry {
                    key: key.get_ref().to_string(),
                    origin,
                    node,
                });
            }
        }
        // The parser may sort keys; sorting by position restores the order of the text.
        entries.sort_by_key(|e| match e.origin {
            Origin::Text { start, .. } => start,
            Origin::Implied => 0,
        });
        Node {
            value: Value::Table(Table { entries }),
            origin: self.origin(span),
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::super::source::SourceKind;
    use super::*;

    fn parse(text: &str) -> Result<Node, Diagnostics> {
        let mut sources = Sources::default();
        let id = sources.add(SourceKind::File, "t.toml", text);
        let mut problems = Diagnostics::default();
        let node = parse_document(&sources, id, &mut problems);
        problems.into_result(())?;
        Ok(node.expect("a tree when there is no problem"))
    }

    #[test]
    fn order_and_places_of_the_text_are_kept() {
        let node = parse("z = 1\na = 2\n[[m]]\nx = 0x10\n[[m]]\nx = -1.5\n").unwrap();
        let keys: Vec<_> = node
            .as_table()
            .unwrap()
            .entries
            .iter()
            .map(|e| e.key.as_str())
            .collect();
        assert_eq!(keys, ["z", "a", "m"]);
        let second = &node.get("m").unwrap().as_array().unwrap()[1];
        assert_eq!(second.get("x").unwrap().value, Value::Float(-1.5));
        assert!(
            matches!(second.origin, Origin::Text { start: 27, .. }),
            "{:?}",
            second.origin
        );
    }

    #[test]
    fn every_syntax_error_is_reported_with_its_line() {
        let problems = parse("a = \nb = 2\nc = [1, \n").unwrap_err();
        let lines: Vec<_> = problems
            .iter()
            .map(|d| d.place.as_ref().unwrap().line)
            .collect();
        assert!(lines.contains(&1), "{problems}");
        assert!(problems.len() >= 2, "{problems}");
        assert!(problems.to_string().contains("t.toml:1:"), "{problems}");
    }

    #[test]
    fn numbers_that_do_not_fit_are_refused() {
        let problems = parse("a = 99999999999999999999\nb = 1e999\n").unwrap_err();
        let text = problems.to_string();
        assert!(text.contains("whole number out of range"), "{text}");
        assert!(text.contains("t.toml:2:5"), "{text}");
    }

    #[test]
    fn nesting_is_limited_before_the_stack_overflows() {
        let dots = format!("{}a = 1", "a.".repeat(100_000));
        assert!(
            parse(&dots)
                .unwrap_err()
                .to_string()
                .contains("at most 16 dots")
        );
        let quoted = format!("{}a = 1", "\"=\".".repeat(100_000));
        assert!(
            parse(&quoted)
                .unwrap_err()
                .to_string()
                .contains("at most 16 dots")
        );
        assert!(parse(&format!("a = {}", "[".repeat(100_000))).is_err());
        let table = "{a = ".repeat(70) + "1" + &"}".repeat(70);
        assert!(
            parse(&format!("a = {table}"))
                .unwrap_err()
                .to_string()
                .contains("64 levels")
        );
    }

    proptest! {
        #[test]
        fn arbitrary_text_never_panics(text in ".{0,200}") {
            let _ = parse(&text);
        }

        #[test]
        fn arbitrary_toml_like_text_never_panics(
            parts in prop::collection::vec(prop::sample::select(vec![
                "a", "=", "[", "]", "{", "}", "\n", ".", "\"", "'", "1", "-", "e9", ",", "[[", "]]",
                "true", "inf", "0x", "#", " ", "\"\"\"", "é", "1979-05-27", "\\", "\r",
            ]), 0..60)
        ) {
            let _ = parse(&parts.concat());
        }
    }
}
