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

/// Formats choices as "one of `a`, `b`, `c`", each once and at most twelve.
pub fn list_choices<S: AsRef<str>>(choices: &[S]) -> String {
    const MAX: usize = 12;
    let mut names: Vec<String> = Vec::new();
    for choice in choices {
        let name = format!("`{}`", choice.as_ref());
        if !names.contains(&name) {
            names.push(name);
        }
    }
    match names.as_slice() {
        [] => "nothing".to_owned(),
        [only] => only.clone(),
        _ if names.len() > MAX => {
            let shown: Vec<&str> = names.iter().map(String::as_str).take(MAX).collect();
            format!("one of {} … ({} in all)", shown.join(", "), names.len())
        }
        _ => format!("one of {}", names.join(", ")),
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
    fn choices_are_listed_with_their_number_if_there_are_many() {
        assert_eq!(list_choices::<&str>(&[]), "nothing");
        assert_eq!(list_choices(&["a"]), "`a`");
        assert_eq!(list_choices(&["a", "b", "c", "a"]), "one of `a`, `b`, `c`");
        let many: Vec<String> = (0..20).map(|i| i.to_string()).collect();
        assert!(list_choices(&many).ends_with("(20 in all)"));
    }
}
