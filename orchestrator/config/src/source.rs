//! Texts of a scenario (file, map, overrides) and positions in them.

use super::diagnostic::Place;

/// Kind of a text; it determines how positions in it are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SourceKind {
    /// A file: positions are `name:line:column`.
    File,
    /// One `--set key=value` argument: positions are the argument itself.
    Override,
}

/// Place of a value.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Origin {
    /// No text: a default or a preset.
    #[default]
    Implied,
    /// A range of bytes of one of the [`Sources`].
    Text {
        /// Index of the text.
        source: usize,
        /// First byte.
        start: usize,
        /// One past the last byte.
        end: usize,
    },
}

#[derive(Debug, Clone)]
struct Source {
    kind: SourceKind,
    name: String,
    text: String,
}

/// All texts that a scenario was read from.
#[derive(Debug, Clone, Default)]
pub struct Sources {
    list: Vec<Source>,
}

/// Maximum length of a snippet (characters); longer lines are cut around the position.
const SNIPPET_WIDTH: usize = 110;

impl Sources {
    /// Adds a text; returns its index in [`Origin::Text`].
    pub fn add(&mut self, kind: SourceKind, name: &str, text: &str) -> usize {
        self.list.push(Source {
            kind,
            name: name.to_owned(),
            text: text.to_owned(),
        });
        self.list.len() - 1
    }

    /// Returns the text with this index.
    pub fn text(&self, source: usize) -> Option<&str> {
        self.list.get(source).map(|s| s.text.as_str())
    }

    /// Returns line, column and text of the line of an origin; `None` for [`Origin::Implied`].
    pub fn place(&self, origin: Origin) -> Option<Place> {
        let Origin::Text { source, start, end } = origin else {
            return None;
        };
        let Source { kind, name, text } = self.list.get(source)?;
        let start = floor_boundary(text, start);
        let end = floor_boundary(text, end.max(start));
        let line_start = text[..start].rfind('\n').map_or(0, |i| i + 1);
        let line_end = text[start..].find('\n').map_or(text.len(), |i| start + i);
        let line = text[..start].bytes().filter(|&b| b == b'\n').count() + 1;
        let column = text[line_start..start].chars().count() + 1;
        let length = text[start..end.min(line_end)].chars().count().max(1);
        let (snippet, marker) = cut(&text[line_start..line_end], column - 1);
        Some(Place {
            file: name.clone(),
            is_override: *kind == SourceKind::Override,
            line,
            column,
            length: length.min(snippet.chars().count().saturating_sub(marker).max(1)),
            snippet,
            marker,
        })
    }
}

/// Returns the last character boundary of `text` at or before `index`.
fn floor_boundary(text: &str, index: usize) -> usize {
    let mut index = index.min(text.len());
    while !text.is_char_boundary(index) {
        index -= 1;
    }
    index
}

/// Returns the line, or the part of a long line around a column (from 0), and the column within it.
fn cut(line: &str, column: usize) -> (String, usize) {
    let line = line.trim_end_matches('\r');
    if line.chars().count() <= SNIPPET_WIDTH {
        return (line.replace('\t', " "), column);
    }
    let skip = column.saturating_sub(SNIPPET_WIDTH / 2);
    let part: String = line.chars().skip(skip).take(SNIPPET_WIDTH).collect();
    let lead = if skip > 0 { "…" } else { "" };
    (
        format!("{lead}{part}…").replace('\t', " "),
        column - skip + lead.chars().count(),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_count_lines_and_characters_from_one() {
        let mut sources = Sources::default();
        let id = sources.add(SourceKind::File, "a.toml", "x = 1\nñame = 22\n");
        let start = "x = 1\nñame = ".len();
        let place = sources
            .place(Origin::Text {
                source: id,
                start,
                end: start + 2,
            })
            .unwrap();
        assert_eq!((place.line, place.column, place.length), (2, 8, 2));
        assert_eq!(place.snippet, "ñame = 22");
    }

    #[test]
    fn positions_beyond_the_text_or_inside_a_character_are_clamped() {
        let mut sources = Sources::default();
        let id = sources.add(SourceKind::File, "a.toml", "ñ");
        for start in 0..5 {
            assert!(
                sources
                    .place(Origin::Text {
                        source: id,
                        start,
                        end: 99
                    })
                    .is_some()
            );
        }
        assert!(
            sources
                .place(Origin::Text {
                    source: 7,
                    start: 0,
                    end: 1
                })
                .is_none()
        );
        assert!(sources.place(Origin::Implied).is_none());
    }

    #[test]
    fn a_long_line_is_cut_around_the_position() {
        let mut sources = Sources::default();
        let text = format!("{}BAD{}", "a".repeat(500), "b".repeat(500));
        let id = sources.add(SourceKind::File, "a.toml", &text);
        let place = sources
            .place(Origin::Text {
                source: id,
                start: 500,
                end: 503,
            })
            .unwrap();
        assert_eq!(place.column, 501);
        assert!(place.snippet.chars().count() < 120);
        let marked: String = place.snippet.chars().skip(place.marker).take(3).collect();
        assert_eq!(marked, "BAD");
    }
}
