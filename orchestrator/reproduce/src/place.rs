//! The experiments of a page, each with one slot for its results.

use std::path::{Path, PathBuf};

/// Failure to assign results to a page.
#[derive(Debug, thiserror::Error)]
pub enum PlaceError {
    /// The experiment is not one of the page.
    #[error(
        "{} contains the results of the experiment `{name}`; expected one of {expected}",
        path.display()
    )]
    Unknown {
        /// The directory.
        path: PathBuf,
        /// Name of its experiment.
        name: String,
        /// The experiments of the page.
        expected: String,
    },
    /// The experiment occurs twice.
    #[error("{} contains the experiment `{name}` again; expected each experiment once", path.display())]
    Twice {
        /// The directory.
        path: PathBuf,
        /// Name of its experiment.
        name: String,
    },
}

/// Returns the slot of a page for the results of an experiment.
///
/// # Errors
/// [`PlaceError`] if there is no slot of this name, or it is not empty.
pub fn empty_place<'a, T, const N: usize>(
    places: [(&str, &'a mut Option<T>); N],
    path: &Path,
    name: &str,
) -> Result<&'a mut Option<T>, PlaceError> {
    let names = places.each_ref().map(|(name, _)| *name);
    match places.into_iter().find(|(known, _)| *known == name) {
        None => Err(PlaceError::Unknown {
            path: path.to_owned(),
            name: name.to_owned(),
            expected: names.join(", "),
        }),
        Some((_, Some(_))) => Err(PlaceError::Twice {
            path: path.to_owned(),
            name: name.to_owned(),
        }),
        Some((_, empty)) => Ok(empty),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_experiment_of_a_page_is_accepted_once_and_others_are_refused() {
        let (mut a, mut b) = (Some(1), None);
        let path = Path::new("out");
        let mut take = |name| {
            *empty_place([("a", &mut a), ("b", &mut b)], path, name)? = Some(2);
            Ok::<_, PlaceError>(())
        };
        take("b").unwrap();
        for (name, expected) in [
            ("a", "out contains the experiment `a` again"),
            ("b", "out contains the experiment `b` again"),
            ("c", "experiment `c`; expected one of a, b"),
        ] {
            let error = take(name).unwrap_err().to_string();
            assert!(error.contains(expected), "{error}");
        }
        assert_eq!((a, b), (Some(1), Some(2)));
    }
}
