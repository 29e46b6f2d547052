//! Topic patterns of the command line.

use crate::LogReadError;

/// Selection of topics by patterns: `world/state`, or with `*` for any characters, `/*/odom`.
#[derive(Debug, Clone, Default)]
pub struct Topics {
    /// Topics to include; empty for all.
    pub only: Vec<String>,
    /// Topics to exclude.
    pub without: Vec<String>,
}

impl Topics {
    /// Returns `true` if the topic is selected.
    pub fn take(&self, topic: &str) -> bool {
        let any = |patterns: &[String]| patterns.iter().any(|pattern| fits(pattern, topic));
        (self.only.is_empty() || any(&self.only)) && !any(&self.without)
    }

    /// Returns `true` if a pattern is the full name of the topic.
    pub fn names(&self, topic: &str) -> bool {
        self.only.iter().any(|pattern| pattern == topic)
    }

    /// Returns `true` if no pattern selects topics.
    pub fn is_unlimited(&self) -> bool {
        self.only.is_empty()
    }

    /// Checks that every pattern matches a topic.
    ///
    /// # Errors
    /// A pattern matches no topic: [`LogReadError`].
    pub fn check<'a>(
        &self,
        known: &(impl Iterator<Item = &'a str> + Clone),
    ) -> Result<(), LogReadError> {
        for (option, patterns) in [("--topics", &self.only), ("--exclude", &self.without)] {
            for pattern in patterns {
                if !known.clone().any(|topic| fits(pattern, topic)) {
                    let mut names: Vec<&str> = known.clone().collect();
                    names.sort_unstable();
                    names.dedup();
                    return Err(LogReadError::Topic {
                        option,
                        wanted: pattern.clone(),
                        known: if names.is_empty() {
                            "none".to_owned()
                        } else {
                            names.join(", ")
                        },
                    });
                }
            }
        }
        Ok(())
    }
}

/// Returns `true` if a name matches a pattern in which `*` stands for any characters.
fn fits(pattern: &str, name: &str) -> bool {
    let mut parts = pattern.split('*');
    let Some(mut rest) = parts.next().and_then(|first| name.strip_prefix(first)) else {
        return false;
    };
    let mut parts = parts.peekable();
    if parts.peek().is_none() {
        return rest.is_empty();
    }
    while let Some(part) = parts.next() {
        if parts.peek().is_none() {
            return rest.ends_with(part);
        }
        match rest.find(part) {
            Some(at) => rest = rest.get(at + part.len()..).unwrap_or_default(),
            None => return false,
        }
    }
    true
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_star_matches_any_characters() {
        for (pattern, name, expected) in [
            ("world/state", "world/state", true),
            ("world/state", "world/states", false),
            ("world", "world/state", false),
            ("/*/odom", "/police_1/odom", true),
            ("/*", "world/state", false),
            ("*", "", true),
            ("*/state", "world/state", true),
            ("w*d/*e", "world/state", true),
            ("w*x*e", "world/state", false),
            ("a*a", "a", false),
        ] {
            assert_eq!(fits(pattern, name), expected, "{pattern} {name}");
        }
    }
}
