//! Outcomes in groups (cluster samples).

use super::interval::Interval;
use super::wilson::wilson_at;

/// Outcomes in groups, such as the escapes among the evaders of each game.
///
/// Members of one group may depend on each other; groups are independent. The sample keeps integer sums, so
/// that the order of groups and of merges does not matter.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Sample {
    groups: u64,
    hits: u64,
    members: u64,
    hits_squared: u64,
    hits_by_members: u64,
    members_squared: u64,
}

impl Sample {
    /// Adds a group. A group without members changes nothing; more hits than members count as `members`.
    pub fn add(&mut self, hits: u32, members: u32) {
        if members == 0 {
            return;
        }
        let (y, m) = (u64::from(hits.min(members)), u64::from(members));
        *self = self.with(&Self {
            groups: 1,
            hits: y,
            members: m,
            hits_squared: y * y,
            hits_by_members: y * m,
            members_squared: m * m,
        });
    }

    /// Returns the union of both samples.
    #[must_use]
    pub fn with(&self, other: &Self) -> Self {
        Self {
            groups: self.groups.saturating_add(other.groups),
            hits: self.hits.saturating_add(other.hits),
            members: self.members.saturating_add(other.members),
            hits_squared: self.hits_squared.saturating_add(other.hits_squared),
            hits_by_members: self.hits_by_members.saturating_add(other.hits_by_members),
            members_squared: self.members_squared.saturating_add(other.members_squared),
        }
    }

    /// Returns the number of hits (escaped evaders).
    pub fn hits(&self) -> u64 {
        self.hits
    }

    /// Returns the number of members of all groups (evaders).
    pub fn members(&self) -> u64 {
        self.members
    }

    /// Returns the share of hits among all members, 0 to 1; `None` without members.
    pub fn share(&self) -> Option<f64> {
        (self.members > 0).then(|| self.hits as f64 / self.members as f64)
    }

    /// Returns the effective sample size, at most [`members`](Self::members): the members divided by the
    /// design effect, the ratio of the variance of the share between groups (linearised ratio estimator) to
    /// that of independent outcomes.
    ///
    /// If all outcomes are equal, their dependence cannot be estimated; then each group counts as one
    /// outcome.
    ///
    /// Source: W. G. Cochran, *Sampling Techniques*, §9A.1, §11.8; J. N. K. Rao and A. J. Scott, *A
    /// simple method for the analysis of clustered binary data*, Biometrics 48 (1992); the bound by
    /// the members: E. L. Korn and B. I. Graubard, Surv. Methodol. 24 (1998).
    pub fn effective_size(&self) -> f64 {
        let Some(share) = self.share() else {
            return 0.0;
        };
        let members = self.members as f64;
        // Each group counts as one outcome, weighted by its members (Kish).
        let wholly_dependent = members * members / self.members_squared as f64;
        let independent = share * (1.0 - share);
        if independent <= 0.0 || self.groups < 2 {
            return wholly_dependent;
        }
        let squares = self.hits_squared as f64 - 2.0 * share * self.hits_by_members as f64
            + share * share * self.members_squared as f64;
        let groups = self.groups as f64;
        let between = squares.max(0.0) / members * groups / (groups - 1.0);
        let design_effect = between / independent;
        members / design_effect.max(1.0)
    }

    /// Returns the interval of the share, `z` standard errors to either side: Wilson's with the [effective
    /// size](Self::effective_size).
    ///
    /// Source: C. Franco et al., *Comparative study of confidence intervals for proportions in
    /// complex sample surveys*, J. Surv. Stat. Methodol. 7 (2019).
    pub fn interval(&self, z: f64) -> Interval {
        wilson_at(self.share().unwrap_or(0.5), self.effective_size(), z)
    }
}

impl FromIterator<(u32, u32)> for Sample {
    /// Collects groups given as (hits, members).
    fn from_iter<T: IntoIterator<Item = (u32, u32)>>(groups: T) -> Self {
        let mut sample = Self::default();
        for (hits, members) in groups {
            sample.add(hits, members);
        }
        sample
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::super::{Z95, wilson};
    use super::*;

    #[test]
    fn equal_members_of_a_group_count_once() {
        // Both evaders of a game always have the same outcome: as many outcomes as games (less the loss of
        // one degree of freedom).
        let sample: Sample = (0..100)
            .map(|i| if i < 30 { (2, 2) } else { (0, 2) })
            .collect();
        assert!((sample.effective_size() - 99.0).abs() < 1e-9, "{sample:?}");
        let games = wilson(30, 100);
        assert!((sample.interval(Z95).low - games.low).abs() < 0.001);
    }

    #[test]
    fn the_effective_size_is_at_most_the_members() {
        // One of two evaders escapes in every game: the share does not vary between games.
        let sample: Sample = (0..50).map(|_| (1, 2)).collect();
        assert_eq!(sample.effective_size(), 100.0);
        assert_eq!(sample.interval(Z95), wilson(50, 100));
    }

    #[test]
    fn equal_outcomes_count_by_games() {
        let sample: Sample = (0..40).map(|_| (0, 2)).collect();
        assert_eq!(sample.effective_size(), 40.0);
        assert_eq!(sample.interval(Z95), wilson(0, 40));
        let one: Sample = [(1, 2)].into_iter().collect();
        assert_eq!(one.effective_size(), 1.0);
    }

    #[test]
    fn games_without_evaders_do_not_count() {
        let sample: Sample = [(0, 0), (5, 0)].into_iter().collect();
        assert_eq!(sample, Sample::default());
        assert_eq!((sample.share(), sample.effective_size()), (None, 0.0));
        assert_eq!(sample.interval(Z95), Interval::UNIT);
        let sample: Sample = [(7, 2)].into_iter().collect();
        assert_eq!((sample.hits(), sample.members(), sample.groups), (2, 2, 1));
    }

    fn groups() -> impl Strategy<Value = Vec<(u32, u32)>> {
        let group = (1_u32..6).prop_flat_map(|m| (0..=m, Just(m)));
        prop::collection::vec(group, 1..60)
    }

    proptest! {
        #[test]
        fn order_and_division_do_not_matter(groups in groups(), cut in 0_usize..60) {
            let whole: Sample = groups.iter().copied().collect();
            let (a, b) = groups.split_at(cut.min(groups.len()));
            let parts: [Sample; 2] = [a, b].map(|part| part.iter().rev().copied().collect());
            prop_assert_eq!(parts[1].with(&parts[0]), whole);
        }

        #[test]
        fn the_interval_contains_the_share_and_is_never_too_narrow(groups in groups()) {
            let sample: Sample = groups.into_iter().collect();
            let (interval, naive) = (sample.interval(Z95), wilson(sample.hits(), sample.members()));
            prop_assert!(interval.contains(sample.share().unwrap()));
            prop_assert!(interval.width() >= naive.width() - 1e-12);
            prop_assert!(sample.effective_size() > 0.0);
            prop_assert!(sample.effective_size() <= sample.members() as f64);
        }
    }
}
