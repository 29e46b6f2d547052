//! The rules of `docs/glossary.md`, from its tables.

use std::path::Path;

use super::words::{Word, items, words};

/// The words to avoid, and where they may stand.
pub struct Glossary {
    rules: Vec<Rule>,
    /// Identifiers that are part of an interface, each with the folders or files of it.
    contracts: Vec<(String, Vec<String>)>,
}

/// An entry of the column *Not*.
pub struct Rule {
    text: String,
    pattern: Pattern,
}

enum Pattern {
    /// Words in this order; the last may be longer.
    Words(Vec<String>, bool),
    /// The name of an item, or its beginning.
    Item(String, bool),
}

impl Glossary {
    /// Reads the tables.
    ///
    /// # Errors
    /// The line without the columns of its table.
    pub fn parse(text: &str) -> Result<Self, String> {
        let mut glossary = Self {
            rules: Vec::new(),
            contracts: Vec::new(),
        };
        let mut columns = 0;
        for line in text.lines() {
            let cells: Vec<&str> = line.split('|').map(str::trim).collect();
            match cells[..] {
                ["", "Term", "Meaning", "Not", "Source", ""] => columns = 4,
                ["", "Word", "In", "Reason", ""] => columns = 3,
                ["", first, ..] if first.starts_with('-') => {}
                ["", _, _, not, _, ""] if columns == 4 => {
                    glossary.rules.extend(quoted(not).map(Rule::new));
                }
                ["", word, place, _, ""] if columns == 3 => {
                    let places: Vec<String> = quoted(place).map(str::to_owned).collect();
                    (glossary.contracts)
                        .extend(quoted(word).map(|word| (word.to_owned(), places.clone())));
                }
                ["", _, ..] => return Err(format!("not a row of the table: {line}")),
                _ => columns = 0,
            }
        }
        Ok(glossary)
    }

    /// The rules that a text may break: a file contains the words of a few of them.
    pub fn rules_for(&self, text: &str) -> Vec<&Rule> {
        let lower = text.to_ascii_lowercase();
        let is_in = |rule: &&Rule| match &rule.pattern {
            Pattern::Words(wanted, _) => wanted.iter().all(|word| lower.contains(word.as_str())),
            Pattern::Item(name, _) => text.contains(name.as_str()),
        };
        self.rules.iter().filter(is_in).collect()
    }

    /// Those of the rules that a line of a file breaks, once for each finding.
    pub fn find<'a>(&self, rules: &[&'a Rule], file: &str, line: &str) -> Vec<&'a str> {
        if rules.is_empty() {
            return Vec::new();
        }
        let words = words(line);
        let items: Vec<&str> = if Path::new(file).extension().is_some_and(|e| e == "rs") {
            items(line).collect()
        } else {
            Vec::new()
        };
        let mut found = Vec::new();
        for rule in rules {
            let count = match &rule.pattern {
                Pattern::Words(wanted, longer) => (0..words.len())
                    .filter_map(|at| words.get(at..at + wanted.len()))
                    .filter(|part| fits(part, wanted, *longer) && !self.allows(file, part))
                    .count(),
                Pattern::Item(name, false) => items.iter().filter(|item| *item == name).count(),
                Pattern::Item(name, true) => {
                    items.iter().filter(|item| item.starts_with(name)).count()
                }
            };
            found.extend(std::iter::repeat_n(rule.text.as_str(), count));
        }
        found
    }

    /// Says if the identifier of these words is part of an interface.
    fn allows(&self, file: &str, part: &[Word<'_>]) -> bool {
        let text: Vec<&str> = part.iter().map(|part| part.identifier).collect();
        let text = text.join(" ");
        self.contracts.iter().any(|(word, places)| {
            (part.iter().all(|part| part.identifier == word) || *word == text)
                && places.iter().any(|place| file.starts_with(place))
        })
    }
}

impl Rule {
    fn new(text: &str) -> Self {
        let pattern = if text.contains('_') || text.contains(char::is_uppercase) {
            Pattern::Item(text.to_owned(), text.ends_with('_'))
        } else {
            let (stem, longer) = text
                .strip_suffix('*')
                .map_or((text, false), |stem| (stem, true));
            Pattern::Words(stem.split(' ').map(str::to_owned).collect(), longer)
        };
        Self {
            text: text.to_owned(),
            pattern,
        }
    }
}

fn fits(words: &[Word<'_>], wanted: &[String], longer: bool) -> bool {
    let last = wanted.len() - 1;
    words
        .iter()
        .zip(wanted)
        .enumerate()
        .all(|(i, (word, wanted))| {
            (i == 0 || word.follows)
                && (word.text == *wanted || longer && i == last && word.text.starts_with(wanted))
        })
}

/// The texts between backticks.
fn quoted(cell: &str) -> impl Iterator<Item = &str> {
    cell.split('`').skip(1).step_by(2)
}
