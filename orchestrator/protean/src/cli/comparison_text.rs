//! Comparisons of histories as text.

use diff::{Comparison, TopicComparison};
use recorder::time_text;

/// Maximum number of lines of a list in the text.
const MAX_LINES: usize = 12;

/// Returns the lines of a comparison with a difference: its tick, its causes and effects, and the topics that differ.
pub fn difference_lines(heading: &str, comparison: &Comparison) -> Vec<String> {
    let Some(first) = &comparison.first else {
        return Vec::new();
    };
    let mut lines = vec![format!(
        "{heading:<10} DIFFERENT from tick {} on ({} s)",
        first.tick(),
        time_text(first.time_s)
    )];
    list(&mut lines, "cause", &first.causes, ToString::to_string);
    list(&mut lines, "effects", &first.effects, ToString::to_string);
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
pub fn list<T>(lines: &mut Vec<String>, heading: &str, items: &[T], line: impl Fn(&T) -> String) {
    for (at, item) in items.iter().take(MAX_LINES).enumerate() {
        let heading = if at == 0 { heading } else { "" };
        lines.push(format!("{heading:<10} {}", line(item)));
    }
    if items.len() > MAX_LINES {
        let others = items.len() - MAX_LINES;
        lines.push(format!("{:<10} and {others} others (--json lists all)", ""));
    }
}
