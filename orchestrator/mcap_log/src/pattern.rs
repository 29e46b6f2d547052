//! Topic patterns of the command line.

use ipc_types::topics::fits;

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
                            "a log with topics".to_owned()
                        } else {
                            format!("one of {}", names.join(", "))
                        },
                    });
                }
            }
        }
        Ok(())
    }
}
