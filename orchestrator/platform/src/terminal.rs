//! Output to a terminal without control characters.
//!
//! Titles of scenarios, topics of logs and output of processes are untrusted input. Control characters in
//! them could move the cursor, overwrite earlier output, change the title or fill the clipboard. They are
//! therefore written as escapes.
//!
//! Code that writes to stderr imports the [`eprintln!`](crate::eprintln) macro of this crate by name.

use std::borrow::Cow;
use std::collections::BTreeMap;

use anstream::stream::RawStream;
use anstream::{AutoStream, ColorChoice};

/// Returns `true` if a character controls the terminal: control characters except line feed and tabulator,
/// and characters that change the writing direction.
fn is_control(c: char) -> bool {
    (c.is_control() && c != '\n' && c != '\t')
        || matches!(c, '\u{61c}' | '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

/// Escapes every character that controls a terminal, as `\u001b`. JSON and TOML read the escape as the
/// character.
#[must_use]
pub fn escape_controls(text: &str) -> Cow<'_, str> {
    if !text.contains(is_control) {
        return Cow::Borrowed(text);
    }
    let mut shown = String::with_capacity(text.len() + 16);
    for c in text.chars() {
        if is_control(c) {
            shown.push_str(&format!("\\u{:04x}", u32::from(c)));
        } else {
            shown.push(c);
        }
    }
    Cow::Owned(shown)
}

/// Returns `true` if output to the stream is coloured: on a terminal, unless `NO_COLOR` is set; elsewhere only with
/// `CLICOLOR_FORCE`.
pub fn is_coloured(stream: &impl RawStream) -> bool {
    AutoStream::choice(stream) != ColorChoice::Never
}

/// Words that output shows in colour.
#[derive(Debug, Clone, Default)]
pub struct Colours(BTreeMap<String, u8>);

impl FromIterator<(String, u8)> for Colours {
    /// Collects words, each with its colour of the 256 that terminals have.
    fn from_iter<T: IntoIterator<Item = (String, u8)>>(words: T) -> Self {
        Self(words.into_iter().collect())
    }
}

impl Colours {
    /// Returns a text with its control characters escaped and the words coloured.
    #[must_use]
    pub fn paint<'a>(&self, text: &'a str) -> Cow<'a, str> {
        let plain = escape_controls(text);
        if self.0.is_empty() {
            return plain;
        }
        let is_in_word = |c: char| c.is_alphanumeric() || c == '_' || c == '-';
        let mut painted = String::with_capacity(2 * plain.len());
        for part in plain.split_inclusive(|c| !is_in_word(c)) {
            let word = part.trim_end_matches(|c| !is_in_word(c));
            match self.0.get(word) {
                Some(colour) => {
                    let rest = part.strip_prefix(word).unwrap_or_default();
                    painted += &format!("\u{1b}[38;5;{colour}m{word}\u{1b}[0m{rest}");
                }
                None => painted += part,
            }
        }
        Cow::Owned(painted)
    }
}

/// Prints to stderr as the standard macro does, with control characters escaped. Ignores a closed stderr.
#[macro_export]
macro_rules! eprintln {
    ($($word:tt)*) => {{
        use std::io::Write as _;
        let text = format!($($word)*);
        let _ = writeln!(
            std::io::stderr().lock(),
            "{}",
            $crate::terminal::escape_controls(&text)
        );
    }};
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn control_characters_are_escaped() {
        for (text, shown) in [
            ("title\u{1b}]0;x\u{7}", "title\\u001b]0;x\\u0007"),
            ("\u{9b}31m", "\\u009b31m"),
            ("over\rwritten\u{8}", "over\\u000dwritten\\u0008"),
            ("abc\u{202e}txt", "abc\\u202etxt"),
            ("\u{61c}\u{200e}\u{200f}", "\\u061c\\u200e\\u200f"),
            ("\u{202a}\u{2066}\u{2069}", "\\u202a\\u2066\\u2069"),
            ("line\n\ttab — naïve ✓", "line\n\ttab — naïve ✓"),
        ] {
            assert_eq!(escape_controls(text), shown);
        }
        assert!(matches!(escape_controls("plain"), Cow::Borrowed(_)));
    }

    #[test]
    fn whole_words_are_coloured_and_nothing_else() {
        let colours = Colours::from_iter([("evader_1".to_owned(), 166)]);
        let painted = colours.paint("evader_1 (evader_1)\tlogs/evader_1-2.mcap evader_10\u{7}");
        let word = "\u{1b}[38;5;166mevader_1\u{1b}[0m";
        let rest = "\tlogs/evader_1-2.mcap evader_10\\u0007";
        assert_eq!(painted, format!("{word} ({word}){rest}"));
        assert_eq!(Colours::default().paint("evader_1"), "evader_1");
    }

    proptest! {
        #[test]
        fn no_control_character_remains_and_json_is_equivalent(text in any::<String>()) {
            let shown = escape_controls(&text);
            prop_assert!(!shown.contains(is_control));
            let json = serde_json::to_string(&text).unwrap();
            let read: String = serde_json::from_str(&escape_controls(&json)).unwrap();
            prop_assert_eq!(read, text);
        }
    }
}
