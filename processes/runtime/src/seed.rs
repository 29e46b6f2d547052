//! Random streams: one per (seed of the run, process, robot, purpose), independent of each other
//! and of the order of their creation.

use rand::SeedableRng as _;
use rand_chacha::ChaCha8Rng;

/// Returns the random stream of a purpose.
///
/// `process` and `robot` are names of the scenario, not indices, so that adding a robot does not
/// change what the others draw.
///
/// ```
/// use rand::Rng as _;
/// use runtime::seed::stream;
///
/// let mut noise = stream(1, "perception", "walle", "noise");
/// let mut same = stream(1, "perception", "walle", "noise");
/// let mut other = stream(1, "perception", "walle", "motion");
/// let first = noise.next_u64();
/// assert_eq!(first, same.next_u64());
/// assert_ne!(first, other.next_u64());
/// ```
pub fn stream(run_seed: u64, process: &str, robot: &str, purpose: &str) -> ChaCha8Rng {
    let mut hasher = blake3::Hasher::new_derive_key("protean 2026 random streams");
    hasher.update(&run_seed.to_le_bytes());
    for part in [process, robot, purpose] {
        // The length separates ("ab", "c") from ("a", "bc").
        hasher.update(&(part.len() as u64).to_le_bytes());
        hasher.update(part.as_bytes());
    }
    ChaCha8Rng::from_seed(*hasher.finalize().as_bytes())
}

#[cfg(test)]
mod tests {
    use rand::Rng as _;

    use super::*;

    #[test]
    fn streams_depend_on_every_part_and_on_nothing_else() {
        let first =
            |seed, process, robot, purpose| stream(seed, process, robot, purpose).next_u64();
        let reference = first(1, "perception", "baddie_1", "noise");
        assert_eq!(reference, first(1, "perception", "baddie_1", "noise"));
        for other in [
            first(2, "perception", "baddie_1", "noise"),
            first(1, "perceptio", "nbaddie_1", "noise"),
            first(1, "perception", "baddie_2", "noise"),
            first(1, "perception", "baddie_1", "motion"),
        ] {
            assert_ne!(reference, other);
        }
    }
}
