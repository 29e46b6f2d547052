//! Names of topics on the command line.

use crate::LogReadError;

/// Which topics are wanted: `world/state`, or with `*` for any letters, `/viewer/*`.
#[derive(Debug, Clone, Default)]
pub struct Topics {
    /// If not empty, only these.
    pub only: Vec<String>,
    /// Without these.
    pub without: Vec<String>,
}

impl Topics {
    /// Whether a topic is wanted.
    pub fn take(&self, topic: &str) -> bool {
        let any = |patterns: &[String]| patterns.iter().any(|pattern| fits(pattern, topic));
        (self.only.is_empty() || any(&self.only)) && !any(&self.without)
    }

    /// Whether a topic is asked for by its whole name.
    pub fn names(&self, topic: &str) -> bool {
        self.only.iter().any(|pattern| pattern == topic)
    }

    /// Every name must be that of a topic.
    ///
    /// # Errors
    /// A name is not that of a topic: [`LogReadError`].
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

/// Whether a name fits a pattern in which `*` stands for any letters.
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
    fn a_star_stands_for_any_letters() {
        for (pattern, name, expected) in [
            ("world/state", "world/state", true),
            ("world/state", "world/states", false),
            ("world", "world/state", false),
            ("/viewer/*", "/viewer/particles/a", true),
            ("/viewer/*", "world/state", false),
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
