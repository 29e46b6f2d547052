//! Comparisons of histories as text.

use diff::{Comparison, Difference, TopicComparison};
use recorder::time_text;

/// Maximum number of lines of a list in the text.
const MAX_LINES: usize = 12;

/// Returns the lines of a comparison with a difference: its tick, its causes and effects, and the topics that differ.
pub(super) fn difference_lines(heading: &str, comparison: &Comparison) -> Vec<String> {
    let Some(first) = &comparison.first else {
        return Vec::new();
    };
    let mut lines = vec![format!(
        "{heading:<10} DIFFERENT from tick {} on ({} s)",
        first.tick(),
        time_text(first.time_s)
    )];
    list(&mut lines, "cause", &first.causes, difference_line);
    list(&mut lines, "effects", &first.effects, difference_line);
    let topics: Vec<_> = comparison
        .topics
        .iter()
        .filter_map(|(name, topic)| Some((name, topic, topic.first_tick?)))
        .collect();
    list(&mut lines, "topics", &topics, |(name, topic, tick)| {
        let TopicComparison {
            different, equal, ..
        } = topic;
        let all = different + equal;
        format!("{name}: {different} of {all} messages differ, from tick {tick} on")
    });
    lines
}

/// Adds a list with a heading, shortened.
pub(super) fn list<T>(
    lines: &mut Vec<String>,
    heading: &str,
    items: &[T],
    line: impl Fn(&T) -> String,
) {
    for (at, item) in items.iter().take(MAX_LINES).enumerate() {
        let heading = if at == 0 { heading } else { "" };
        lines.push(format!("{heading:<10} {}", line(item)));
    }
    if items.len() > MAX_LINES {
        let others = items.len() - MAX_LINES;
        lines.push(format!("{:<10} and {others} others (--json lists all)", ""));
    }
}

fn difference_line(change: &Difference) -> String {
    let Difference {
        process,
        topic,
        field,
        a,
        b,
        ..
    } = change;
    let of = change
        .robot
        .as_ref()
        .map_or_else(String::new, |robot| format!(" of {robot}"));
    let field = if field.is_empty() {
        ""
    } else {
        &format!(" {field}{of}:")
    };
    format!("{process}, {topic}:{field} {} → {}", or_none(a), or_none(b))
}

/// Returns a value, or `none` for an empty one.
pub(super) fn or_none(value: &str) -> String {
    if value.is_empty() {
        "none".to_owned()
    } else {
        value.to_owned()
    }
}
