//! Seeds of episodes.

/// Returns the seed of an episode of an instance, below 2^63.
pub fn episode_seed(seed: u64, instance: usize, episode: u64) -> u64 {
    use rand::Rng as _;
    let (instance, episode) = (instance.to_string(), episode.to_string());
    runtime::seed::stream(seed, "environment", &instance, &episode).next_u64() >> 1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn seeds_of_episodes_differ_by_every_part() {
        let first = episode_seed(1, 0, 0);
        assert_eq!(first, episode_seed(1, 0, 0));
        for other in [(2, 0, 0), (1, 1, 0), (1, 0, 1), (1, 0, 10), (1, 10, 0)] {
            assert_ne!(first, episode_seed(other.0, other.1, other.2));
        }
    }
}
