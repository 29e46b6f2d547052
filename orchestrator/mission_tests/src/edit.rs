//! Changes of the text of a test file, which keep its comments and layout.

use std::collections::BTreeMap;
use std::ops::Range;

use config::{Diagnostics, Entry, Node, Origin, SourceKind, Sources, parse_document, write_value};

/// A test file and changes of its text.
pub struct Document {
    text: String,
    pub root: Node,
    edits: Edits,
}

/// Ranges of a text (bytes) and what replaces them.
type Edits = Vec<(Range<usize>, String)>;

impl Document {
    /// Parses a test file; `None` if it is no TOML.
    pub fn parse(text: String) -> Option<Self> {
        let mut sources = Sources::default();
        let source = sources.add(SourceKind::File, "", &text);
        let root = parse_document(&sources, source, &mut Diagnostics::default())?;
        Some(Self {
            text,
            root,
            edits: Vec::new(),
        })
    }

    /// Returns the expectations of the file, or of one of its `[[test]]`.
    pub fn expect(&mut self, block: Option<usize>) -> Option<Edit<'_>> {
        let table = match block {
            None => &self.root,
            Some(index) => self.root.get("test")?.as_array()?.get(index)?,
        };
        Some(Edit {
            text: &self.text,
            expect: table.get("expect")?,
            edits: &mut self.edits,
        })
    }

    /// Returns the text with all changes; `None` without any.
    pub fn edited(mut self) -> Option<String> {
        // From the end, so that the places before stay.
        self.edits
            .sort_by_key(|(range, _)| (range.start, range.end));
        for (range, new) in self.edits.iter().rev() {
            self.text.replace_range(range.clone(), new);
        }
        (!self.edits.is_empty()).then_some(self.text)
    }
}

/// Changes of the expectations of a test.
pub struct Edit<'a> {
    text: &'a str,
    expect: &'a Node,
    edits: &'a mut Edits,
}

impl Edit<'_> {
    /// Writes the digest of a seed; a reason becomes a comment behind it, in place of an earlier one.
    pub fn digest(&mut self, seed: u64, new: &str, reason: &str) -> Option<()> {
        let digest = self.expect.get("digest")?;
        let value = digest.get(&seed.to_string()).unwrap_or(digest);
        let new = write_value(&Node::implied_str(new));
        self.edits.push((range(value.origin)?, new));
        if !reason.is_empty() {
            // Within braces there is no room for a comment.
            let mut holders = [self.expect, digest].into_iter();
            let holder = holders.find(|node| self.is_inline(node)).unwrap_or(value);
            self.comment(range(holder.origin)?.end, reason);
        }
        Some(())
    }

    /// Writes a reason at the end of the line of a place; other comments stay.
    fn comment(&mut self, place: usize, reason: &str) {
        let rest = self.text.get(place..).unwrap_or_default();
        let rest = rest.lines().next().unwrap_or_default();
        let old = rest.trim();
        if !old.is_empty() && !old.starts_with('#') {
            return;
        }
        let own = old.trim_start_matches('#').split("was ").next();
        let own = own.unwrap_or_default().trim().trim_end_matches(';');
        let separator = if own.is_empty() { "" } else { "; " };
        let line = place..place + rest.len();
        // Of digests on one line, the last reason.
        let is_other = |(range, _): &(Range<usize>, _)| *range != line;
        self.edits.retain(is_other);
        self.edits
            .push((line, format!(" # {own}{separator}{reason}")));
    }

    /// Returns the expected outcomes of the robots.
    pub fn expected(&self) -> BTreeMap<&str, &str> {
        let outcomes = self.expect.get("outcome").and_then(Node::as_table);
        let entries = outcomes.into_iter().flat_map(|table| &table.entries);
        entries
            .filter_map(|entry| Some((entry.key.as_str(), entry.node.as_str()?)))
            .collect()
    }

    /// Writes the outcomes of the robots.
    pub fn outcomes(&mut self, found: &BTreeMap<&str, &str>) -> Option<()> {
        let mut new = Node::empty_table(Origin::Implied);
        for (robot, outcome) in found {
            let outcome = Node::implied_str(outcome);
            new.as_table_mut()?.set(robot, Origin::Implied, outcome);
        }
        let old = self.expect.get("outcome");
        let entries = old
            .and_then(Node::as_table)
            .map_or(&[][..], |table| &table.entries);
        if found.keys().eq(self.expected().keys()) {
            for entry in entries {
                let outcome = write_value(new.get(&entry.key)?);
                self.edits.push((range(entry.node.origin)?, outcome));
            }
            return Some(());
        }
        if let Some(old) = old.filter(|old| self.is_inline(old)) {
            self.edits.push((range(old.origin)?, write_value(&new)));
            return Some(());
        }
        // `[expect.outcome]` and `outcome.ROBOT = …` become one line before `outcome_only`.
        let header = old.and_then(|old| range(old.origin));
        if let Some(header) = header.filter(|header| self.begins(header, '[')) {
            self.remove(header.start, header.end);
        }
        for entry in entries {
            self.remove(self.start(entry)?, range(entry.node.origin)?.end);
        }
        let only = self.expect.as_table()?.entry("outcome_only")?;
        let (start, key) = (self.start(only)?, range(only.origin)?);
        let before = self.text.get(start..key.start)?;
        let separator = if self.is_line(start) { '\n' } else { ',' };
        let line = format!("{before}outcome = {}{separator}", write_value(&new));
        self.edits.push((start..start, line));
        Some(())
    }

    /// Removes a part with what separates it from the next one.
    fn remove(&mut self, start: usize, end: usize) {
        let rest = self.text.get(end..).unwrap_or_default();
        let separator = if self.is_line(start) {
            rest.find('\n').map_or(rest.len(), |at| at + 1)
        } else {
            // Behind the last one is a brace, which stays.
            let at = rest.find([',', '}']).unwrap_or_default();
            at + usize::from(rest[at..].starts_with(','))
        };
        self.edits.push((start..end + separator, String::new()));
    }

    /// Returns the beginning of the line of a key, or of its part of an inline table.
    fn start(&self, entry: &Entry) -> Option<usize> {
        let before = self.text.get(..range(entry.origin)?.start)?;
        Some(before.rfind(['\n', '{', ',']).map_or(0, |last| last + 1))
    }

    fn is_line(&self, start: usize) -> bool {
        start == 0 || self.text[..start].ends_with('\n')
    }

    fn is_inline(&self, node: &Node) -> bool {
        range(node.origin).is_some_and(|range| self.begins(&range, '{'))
    }

    fn begins(&self, range: &Range<usize>, character: char) -> bool {
        let text = self.text.get(range.clone());
        text.is_some_and(|text| text.starts_with(character))
    }
}

/// Returns the range of a value in its text (bytes).
fn range(origin: Origin) -> Option<Range<usize>> {
    match origin {
        Origin::Text { start, end, .. } => Some(start..end),
        Origin::Implied => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn edited(text: &str, change: impl FnOnce(&mut Edit<'_>) -> Option<()>) -> String {
        let block = text.contains("test").then_some(1);
        let mut document = Document::parse(text.to_owned()).unwrap();
        change(&mut document.expect(block).unwrap()).unwrap();
        let edited = document.edited().unwrap();
        assert!(Document::parse(edited.clone()).is_some(), "{edited}");
        edited
    }

    #[test]
    fn digests_and_reasons_are_written_in_place() {
        for (old, new) in [
            (
                "[expect]\r\ndigest = \"a\"\r\nticks = 1 # one",
                "[expect]\r\ndigest = \"new\" # why\r\nticks = 1 # one",
            ),
            (
                "expect.digest = 'a'  # mine; was b; c\n",
                "expect.digest = \"new\" # mine; why\n",
            ),
            (
                "expect = { digest = { 6 = \"a\", 7 = \"b\" } } # was c\n",
                "expect = { digest = { 6 = \"a\", 7 = \"new\" } } # why\n",
            ),
            (
                "[expect]\ndigest.6 = \"a\"\ndigest.7 = \"b\" # mine\n",
                "[expect]\ndigest.6 = \"a\"\ndigest.7 = \"new\" # mine; why\n",
            ),
            (
                "[[test]]\n[[test]]\n[test.expect.digest]\n7 = \"\"\n",
                "[[test]]\n[[test]]\n[test.expect.digest]\n7 = \"new\" # why\n",
            ),
            (
                "test = [1, { expect = { digest = \"a\" }, seed = 7 }]\n",
                "test = [1, { expect = { digest = \"new\" }, seed = 7 }]\n",
            ),
        ] {
            assert_eq!(edited(old, |edit| edit.digest(7, "new", "why")), new);
        }
        let two = "expect.digest = { 6 = \"a\", 7 = \"b\" } # mine";
        let both = edited(two, |edit| {
            edit.digest(6, "new", "first")?;
            edit.digest(7, "newer", "second")
        });
        let expected = "expect.digest = { 6 = \"new\", 7 = \"newer\" } # mine; second";
        assert_eq!(both, expected);
    }

    #[test]
    fn outcomes_are_written_in_every_layout() {
        let found = BTreeMap::from([("a", "caught"), ("b c", "escaped")]);
        let table = "{ a = \"caught\", \"b c\" = \"escaped\" }";
        for (old, new) in [
            (
                "[expect]\n  outcome_only = true # no digests\n",
                format!("[expect]\n  outcome = {table}\n  outcome_only = true # no digests\n"),
            ),
            (
                "expect.outcome_only = true",
                format!("expect.outcome = {table}\nexpect.outcome_only = true"),
            ),
            (
                "expect = { outcome_only = true, ticks = 1 }",
                format!("expect = {{ outcome = {table}, outcome_only = true, ticks = 1 }}"),
            ),
            (
                "test = [1, { expect.outcome_only = true }]",
                format!("test = [1, {{ expect.outcome = {table}, expect.outcome_only = true }}]"),
            ),
            (
                "[expect]\noutcome_only = true\noutcome = { d = \"caught\" } # mine\n",
                format!("[expect]\noutcome_only = true\noutcome = {table} # mine\n"),
            ),
            (
                "[expect]\noutcome_only = true\n[expect.outcome]\n\"b c\" = '' # mine\na = \"\"\n",
                "[expect]\noutcome_only = true\n[expect.outcome]\n\"b c\" = \"escaped\" # mine\na = \"caught\"\n".to_owned(),
            ),
            (
                "[expect]\noutcome_only = true\n\n[expect.outcome] # old\nb = \"caught\" # x, y\n",
                format!("[expect]\noutcome = {table}\noutcome_only = true\n\n"),
            ),
            (
                "[expect]\noutcome.b = \"caught\"\nticks = 1\noutcome.d = \"caught\"\noutcome_only = true\n",
                format!("[expect]\nticks = 1\noutcome = {table}\noutcome_only = true\n"),
            ),
            (
                "expect = { outcome_only = true, outcome.d = \"caught\" }",
                format!("expect = {{ outcome = {table}, outcome_only = true,}}"),
            ),
        ] {
            assert_eq!(edited(old, |edit| edit.outcomes(&found)), new);
        }
    }
}
