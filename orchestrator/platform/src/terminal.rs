//! What is written to a terminal cannot steer it.
//!
//! Titles of scenarios, topics of logs and the last words of processes may come from a stranger, and
//! a terminal obeys what it is told between the lines: it moves the cursor over what was said before,
//! changes its title, fills the clipboard. Characters that do such things are shown by their numbers.
//!
//! The program writes to stderr by the [`eprintln!`](crate::eprintln) of this crate, which a file that
//! needs it imports by name.

use std::borrow::Cow;

/// Whether a terminal takes a character for more than a letter: control characters but the end of a
/// line and tabulators, and those that change the direction of writing.
fn steers(c: char) -> bool {
    (c.is_control() && c != '\n' && c != '\t')
        || matches!(c, '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

/// The text with every character that would steer a terminal as `\u001b`. JSON and TOML read that as
/// the character that it stands for.
#[must_use]
pub fn harmless(text: &str) -> Cow<'_, str> {
    if !text.contains(steers) {
        return Cow::Borrowed(text);
    }
    let mut shown = String::with_capacity(text.len() + 16);
    for c in text.chars() {
        if steers(c) {
            shown.push_str(&format!("\\u{:04x}", u32::from(c)));
        } else {
            shown.push(c);
        }
    }
    Cow::Owned(shown)
}

/// As the standard library's, of text that cannot steer a terminal. A stderr that is gone is no
/// reason to stop.
#[macro_export]
macro_rules! eprintln {
    ($($word:tt)*) => {{
        use std::io::Write as _;
        let text = format!($($word)*);
        let _ = writeln!(
            std::io::stderr().lock(),
            "{}",
            $crate::terminal::harmless(&text)
        );
    }};
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn what_steers_a_terminal_is_shown_by_its_number() {
        for (text, shown) in [
            ("title\u{1b}]0;x\u{7}", "title\\u001b]0;x\\u0007"),
            ("\u{9b}31m", "\\u009b31m"),
            ("over\rwritten\u{8}", "over\\u000dwritten\\u0008"),
            ("abc\u{202e}txt", "abc\\u202etxt"),
            ("line\n\ttab — naïve ✓", "line\n\ttab — naïve ✓"),
        ] {
            assert_eq!(harmless(text), shown);
        }
        assert!(matches!(harmless("plain"), Cow::Borrowed(_)));
    }

    proptest! {
        #[test]
        fn nothing_that_steers_gets_through_and_json_still_says_the_same(text in any::<String>()) {
            let shown = harmless(&text);
            prop_assert!(!shown.contains(steers));
            let json = serde_json::to_string(&text).unwrap();
            let read: String = serde_json::from_str(&harmless(&json)).unwrap();
            prop_assert_eq!(read, text);
        }
    }
}
