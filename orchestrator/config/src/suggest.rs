//! Suggestions for misspelt words.

/// Returns the candidate most similar to `word`, if it is similar enough.
pub fn nearest<'a>(word: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let lower = word.to_lowercase();
    let mut best: Option<(f64, &str)> = None;
    for candidate in candidates {
        let other = candidate.to_lowercase();
        let mut score = strsim::jaro_winkler(&lower, &other);
        // A prefix or a part of the right word is a likely abbreviation ("braitenberg").
        if lower.len() >= 3 && (other.contains(&lower) || lower.contains(&other)) {
            score = score.max(0.9);
        }
        // One slip of the fingers in a short word ("rnu").
        if lower.len() >= 3 && strsim::osa_distance(&lower, &other) == 1 {
            score = score.max(0.85);
        }
        if score > best.map_or(0.0, |b| b.0) {
            best = Some((score, candidate));
        }
    }
    best.filter(|b| b.0 >= 0.75).map(|b| b.1)
}

/// Formats choices as "`a`, `b` or `c`", at most twelve.
pub fn list_choices<S: AsRef<str>>(choices: &[S]) -> String {
    const MAX: usize = 12;
    let mut shown: Vec<String> = choices
        .iter()
        .take(MAX)
        .map(|c| format!("`{}`", c.as_ref()))
        .collect();
    if choices.len() > MAX {
        return format!("{} … ({} in all)", shown.join(", "), choices.len());
    }
    match shown.pop() {
        None => "nothing".to_owned(),
        Some(last) if shown.is_empty() => last,
        Some(last) => format!("{} or {last}", shown.join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_similar_words_are_suggested() {
        let kinds = [
            "perception",
            "pursuer",
            "evader_braitenberg",
            "evader_potential",
        ];
        assert_eq!(nearest("persuer", kinds), Some("pursuer"));
        assert_eq!(nearest("braitenberg", kinds), Some("evader_braitenberg"));
        assert_eq!(nearest("Perception", kinds), Some("perception"));
        assert_eq!(nearest("rnu", ["list", "run", "new"]), Some("run"));
        assert_eq!(nearest("zzz", kinds), None);
        assert_eq!(nearest("", kinds), None);
    }

    #[test]
    fn choices_are_listed_as_a_sentence() {
        assert_eq!(list_choices::<&str>(&[]), "nothing");
        assert_eq!(list_choices(&["a"]), "`a`");
        assert_eq!(list_choices(&["a", "b", "c"]), "`a`, `b` or `c`");
        let many: Vec<String> = (0..20).map(|i| i.to_string()).collect();
        assert!(list_choices(&many).ends_with("(20 in all)"));
    }
}
