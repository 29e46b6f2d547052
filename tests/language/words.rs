//! The words of a line: those of text, and the parts of names.

/// A word in lower case.
#[derive(Debug)]
pub struct Word<'a> {
    pub text: String,
    /// The identifier that it is a part of.
    pub identifier: &'a str,
    /// Nothing but a blank or `_` stands between it and the word before.
    pub follows: bool,
}

/// Splits a line into words: at blanks, signs, `_` and capitals (`MaxSpeed`, `max_speed`, `MAX_SPEED`).
pub fn words(line: &str) -> Vec<Word<'_>> {
    let mut words = Vec::new();
    let mut end = None;
    for (at, identifier) in identifiers(line) {
        let mut from = 0;
        let bytes = identifier.as_bytes();
        for to in 1..=bytes.len() {
            let ends = to == bytes.len() || bytes[to] == b'_' || begins_part(bytes, to);
            if !ends {
                continue;
            }
            let part = identifier[from..to].trim_start_matches('_');
            if !part.is_empty() {
                let begin = at + to - part.len();
                words.push(Word {
                    text: part.to_ascii_lowercase(),
                    identifier,
                    follows: end.is_some_and(|end: usize| {
                        line[end..begin].chars().all(|c| c == ' ' || c == '_')
                    }),
                });
                end = Some(at + to);
            }
            from = to;
        }
    }
    words
}

/// The names of the items that a line of Rust declares.
pub fn items(line: &str) -> impl Iterator<Item = &str> {
    const KEYWORDS: &[&str] = &[
        "struct", "enum", "union", "trait", "type", "fn", "mod", "const", "static",
    ];
    let code = if line.trim_start().starts_with("//") {
        ""
    } else {
        line
    };
    let mut before = "";
    identifiers(code).filter_map(move |(_, identifier)| {
        let declared = KEYWORDS.contains(&before);
        before = identifier;
        declared.then_some(identifier)
    })
}

/// A capital after a small letter, or before one.
fn begins_part(name: &[u8], at: usize) -> bool {
    name[at].is_ascii_uppercase()
        && (!name[at - 1].is_ascii_uppercase()
            || name.get(at + 1).is_some_and(u8::is_ascii_lowercase))
}

/// The runs of ASCII letters, digits and `_`, with their places.
fn identifiers(line: &str) -> impl Iterator<Item = (usize, &str)> {
    let is_part = |c: char| c.is_ascii_alphanumeric() || c == '_';
    line.split(move |c| !is_part(c))
        .filter(|run| !run.is_empty())
        .map(|run| (run.as_ptr() as usize - line.as_ptr() as usize, run))
}
