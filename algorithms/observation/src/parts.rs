//! Contents of an observation.

use core::fmt;
use core::str::FromStr;

use crate::error::LayoutError;

/// Maximum number of exits in an observation: the nearest ones.
pub const MAX_EXITS: usize = 4;

/// Contents of an observation: the own state, goal and exits, and these parts.
///
/// ```
/// use observation::parts::Parts;
///
/// let parts: Parts = "state+scan".parse()?;
/// assert!(parts.state && parts.scan && !parts.belief);
/// assert_eq!(parts.to_string(), "state+scan");
/// # Ok::<(), observation::error::LayoutError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[expect(
    clippy::struct_excessive_bools,
    reason = "each part is there or not, independently"
)]
pub struct Parts {
    /// True poses of all other robots, and lines of sight to opponents.
    pub state: bool,
    /// The own range scan.
    pub scan: bool,
    /// The beliefs about opponents.
    pub belief: bool,
    /// Shortest paths to the exits and to opponents.
    pub path: bool,
    /// The action of the potential-field evader.
    pub potential: bool,
}

impl FromStr for Parts {
    type Err = LayoutError;

    fn from_str(text: &str) -> Result<Self, LayoutError> {
        let mut parts = Self::default();
        for name in text.split('+') {
            let part = match name {
                "state" => &mut parts.state,
                "scan" => &mut parts.scan,
                "belief" => &mut parts.belief,
                "path" => &mut parts.path,
                "potential" => &mut parts.potential,
                _ => {
                    let given = text.to_owned();
                    return Err(LayoutError::Parts { given });
                }
            };
            *part = true;
        }
        Ok(parts)
    }
}

impl fmt::Display for Parts {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let named = [
            (self.state, "state"),
            (self.scan, "scan"),
            (self.belief, "belief"),
            (self.path, "path"),
            (self.potential, "potential"),
        ];
        let mut separator = "";
        for (_, name) in named.into_iter().filter(|(given, _)| *given) {
            write!(f, "{separator}{name}")?;
            separator = "+";
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unknown_names_are_refused_with_what_is_known() {
        for text in ["", "lidar", "state+", "State"] {
            let error = text.parse::<Parts>().unwrap_err().to_string();
            assert!(error.contains("state+scan"), "{error}");
        }
    }
}
