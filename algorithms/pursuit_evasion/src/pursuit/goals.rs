//! Goals of pursuers, made from the information on their target.

use avoidance::potential_field::Goal;
use geometry::math;
use geometry::pose::Pose2;
use nalgebra::{Point2, Vector2};
use parameters::Fidelity;
use planner_view::map::{PlannerMap, whole_below};
use planner_view::view::{BeliefView, ParticleView, View};

use super::params::{BeliefGoals, Knowledge};

/// Distance of a goal ahead of the target, along its heading, as a fraction of the range to it.
const LOOK_AHEAD_RATIO: f64 = 0.7;

/// Longest distance ahead (m).
const MAX_LOOK_AHEAD: f64 = 5.0;

/// Side of the squares that count hypotheses to find the heaviest cluster (m).
const MODE_CELL: f64 = 1.0;

/// A hypothesis of a target's pose with its weight (> 0).
pub type Hypothesis = (Pose2, f64);

/// Writes the possible positions of a target to `into` (cleared first).
///
/// It is empty if nothing usable is known of the target. It contains at most `max_particles` evenly
/// spaced hypotheses of a belief.
pub fn hypotheses(
    view: &View<'_>,
    target: usize,
    knowledge: Knowledge,
    belief_goals: BeliefGoals,
    max_particles: usize,
    into: &mut Vec<Hypothesis>,
) {
    into.clear();
    match knowledge {
        Knowledge::Exact => into.extend(view.robot(target).map(|robot| (robot.pose, 1.0))),
        Knowledge::Belief => {
            let Some(belief) = view.belief(target) else {
                return;
            };
            match belief_goals {
                BeliefGoals::Particles => {
                    let stride = belief.particles.len().div_ceil(max_particles.max(1)).max(1);
                    let taken = belief.particles.iter().step_by(stride);
                    into.extend(taken.filter_map(ParticleView::usable));
                    if into.is_empty() {
                        into.extend(mean(belief));
                    }
                }
                BeliefGoals::Mean => into.extend(mean(belief)),
                BeliefGoals::Mode => into.extend(mode(belief, true).or_else(|| mean(belief))),
            }
        }
    }
}

/// Returns the most probable position of a target (m).
pub fn estimate(view: &View<'_>, target: usize, knowledge: Knowledge) -> Option<Point2<f64>> {
    let pose = match knowledge {
        Knowledge::Exact => view.robot(target)?.pose,
        Knowledge::Belief => {
            let belief = view.belief(target)?;
            mode(belief, false).or_else(|| mean(belief))?.0
        }
    };
    Some(pose.position())
}

/// Returns `true` if there is an [`estimate`] of a target's position, without computing it.
pub fn is_known(view: &View<'_>, target: usize, knowledge: Knowledge) -> bool {
    match knowledge {
        Knowledge::Exact => view.robot(target).is_some(),
        Knowledge::Belief => view.belief(target).is_some_and(|belief| {
            let mut particles = belief.particles.iter();
            particles.any(|particle| particle.usable().is_some()) || belief.mean.is_finite()
        }),
    }
}

/// Returns `false` if the [`estimate`] of a belief is certainly farther than `range` (m) from a place, without computing it.
pub fn may_be_within(belief: &BeliefView<'_>, here: Point2<f64>, range: f64) -> bool {
    let near = |x: f64, y: f64, range: f64| {
        let distance = (Point2::new(x, y) - here).norm();
        distance.is_nan() || distance <= range
    };
    // A mode lies in the square of one of its hypotheses.
    let reach = range + 1.5 * MODE_CELL;
    let mut particles = belief.particles.iter();
    particles.any(|particle| near(particle.x.into(), particle.y.into(), reach))
        || near(belief.mean.x, belief.mean.y, range)
}

/// Writes the goals of a set of hypotheses to `into` (cleared first): each a point ahead of its hypothesis by a
/// share of the distance to it (m), on this side of the first obstacle. The published program's goals may lie inside a
/// block or beyond the arena's wall.
pub fn goals(
    map: &PlannerMap,
    hypotheses: &[Hypothesis],
    distance_to: impl Fn(Point2<f64>) -> f64,
    room: f64,
    fidelity: Fidelity,
    into: &mut Vec<Goal>,
) {
    into.clear();
    let ahead = |(pose, _): &Hypothesis| {
        let distance = LOOK_AHEAD_RATIO * distance_to(pose.position());
        pose.forward() * distance.min(MAX_LOOK_AHEAD)
    };
    let goal = |(pose, weight): &Hypothesis, ahead: Vector2<f64>| Goal {
        at: pose.position() + ahead,
        weight: *weight,
    };
    if fidelity.is_published() {
        into.extend(hypotheses.iter().map(|one| goal(one, ahead(one))));
        return;
    }
    let line = |(pose, _): &Hypothesis, ahead| (pose.position(), pose.position() + ahead);
    let mut add = |one: &Hypothesis, ahead: Vector2<f64>, run: f64| {
        let length = ahead.norm();
        let share = if length <= 0.0 { 1.0 } else { run / length };
        into.push(goal(one, ahead * share));
    };
    let (fours, rest) = hypotheses.as_chunks::<4>();
    for four in fours {
        let aheads = four.each_ref().map(ahead);
        let runs = map.free_runs::<4>(core::array::from_fn(|i| line(&four[i], aheads[i])), room);
        for ((one, ahead), run) in four.iter().zip(aheads).zip(runs) {
            add(one, ahead, run);
        }
    }
    for one in rest {
        let ahead = ahead(one);
        let (from, to) = line(one, ahead);
        add(one, ahead, map.free_run(from, to, room));
    }
}

fn mean(belief: &BeliefView<'_>) -> Option<Hypothesis> {
    belief.mean.is_finite().then_some((belief.mean, 1.0))
}

/// Returns the mean pose of the square metre with the highest weight; of several, the one with the
/// lowest coordinates. Its heading costs most, and is 0 unless `headed`.
fn mode(belief: &BeliefView<'_>, headed: bool) -> Option<Hypothesis> {
    let hypotheses = || {
        let usable = belief.particles.iter().filter_map(ParticleView::usable);
        let cell = |value: f64| whole_below(value / MODE_CELL);
        usable.map(move |(pose, weight)| ((cell(pose.x), cell(pose.y)), pose, weight))
    };
    // Ascending by square. Most hypotheses lie in the square of the one before, an heir of the same particle: a map
    // takes three times as long.
    let mut weights: Vec<((i64, i64), f64)> = Vec::new();
    let mut at = 0;
    for (cell, _, weight) in hypotheses() {
        if weights.get(at).is_none_or(|(last, _)| *last != cell) {
            let found = weights.binary_search_by_key(&cell, |(known, _)| *known);
            at = found.unwrap_or_else(|place| {
                weights.insert(place, (cell, 0.0));
                place
            });
        }
        weights[at].1 += weight;
    }
    let mut best: Option<((i64, i64), f64)> = None;
    for (cell, weight) in weights {
        if best.is_none_or(|(_, found)| weight > found) {
            best = Some((cell, weight));
        }
    }
    let (best, total) = best?;
    let [mut x, mut y, mut sin_sum, mut cos_sum] = [0.0; 4];
    for (_, pose, weight) in hypotheses().filter(|(cell, ..)| *cell == best) {
        x += weight * pose.x;
        y += weight * pose.y;
        if headed {
            let (sin, cos) = math::sincos(pose.theta);
            sin_sum += weight * sin;
            cos_sum += weight * cos;
        }
    }
    let mean = Pose2::new(x / total, y / total, math::atan2(sin_sum, cos_sum));
    mean.is_finite().then_some((mean, 1.0))
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use proptest::prelude::*;

    use super::*;

    fn particle(x: f32, y: f32, weight: f32) -> ParticleView {
        ParticleView {
            x,
            y,
            theta: 0.5,
            weight,
        }
    }

    fn view<'a>(beliefs: &'a [BeliefView<'a>]) -> View<'a> {
        View {
            time_s: 0.0,
            dt: 0.05,
            me: 0,
            robots: &[],
            beliefs,
            exits: &[],
            scan: None,
        }
    }

    fn belief(particles: &[ParticleView]) -> BeliefView<'_> {
        let mean = Pose2::new(1.0, 2.0, 0.0);
        BeliefView {
            robot: 3,
            particles,
            mean,
            position_std: 1.0,
            seen: false,
        }
    }

    #[test]
    fn the_mode_lies_in_the_heaviest_cluster_and_the_mean_between_them() {
        let particles = [
            particle(5.2, 5.2, 0.3),
            particle(5.4, 5.4, 0.3),
            particle(-5.5, -5.5, 0.4),
        ];
        let beliefs = [belief(&particles)];
        let at = estimate(&view(&beliefs), 3, Knowledge::Belief).unwrap();
        let (pose, _) = mode(&beliefs[0], true).unwrap();
        assert_eq!(at, pose.position());
        assert!((at.x - 5.3).abs() < 1e-5 && (pose.theta - 0.5).abs() < 1e-6);
        assert!(estimate(&view(&beliefs), 4, Knowledge::Belief).is_none());
    }

    #[test]
    fn a_target_that_cannot_be_near_is_far_and_one_with_an_estimate_is_known() {
        let nothing = [particle(f32::NAN, 0.0, 1.0)];
        let spread: Vec<_> = (0..40)
            .map(|i| particle(0.3 * i as f32, (i % 7) as f32, (i % 3) as f32))
            .collect();
        for particles in [&nothing[..], &spread[..], &[]] {
            let beliefs = [belief(particles)];
            let view = view(&beliefs);
            let at = estimate(&view, 3, Knowledge::Belief).unwrap();
            assert!(is_known(&view, 3, Knowledge::Belief));
            let mut far = 0;
            for i in 0..400 {
                let here = Point2::new(f64::from(i % 20), f64::from(i / 20));
                if !may_be_within(&beliefs[0], here, 1.0) {
                    far += 1;
                    assert!((at - here).norm() > 1.0, "{here}");
                }
            }
            assert!(far > 0 || particles.len() == 1, "{far}");
        }
        assert!(!is_known(&view(&[]), 3, Knowledge::Belief));
    }

    #[test]
    fn a_belief_without_usable_particles_falls_back_to_its_mean() {
        let particles = [particle(f32::NAN, 0.0, 1.0), particle(1.0, 1.0, -1.0)];
        let beliefs = [belief(&particles)];
        let mut found = Vec::new();
        for goals in [BeliefGoals::Particles, BeliefGoals::Mode, BeliefGoals::Mean] {
            hypotheses(&view(&beliefs), 3, Knowledge::Belief, goals, 10, &mut found);
            assert_eq!(found, [(Pose2::new(1.0, 2.0, 0.0), 1.0)]);
        }
    }

    #[test]
    fn no_more_particles_are_taken_than_wanted() {
        let particles: Vec<_> = (0..1000).map(|i| particle(i as f32, 0.0, 0.001)).collect();
        let beliefs = [belief(&particles)];
        let mut found = Vec::new();
        let goals = BeliefGoals::Particles;
        hypotheses(&view(&beliefs), 3, Knowledge::Belief, goals, 30, &mut found);
        assert!((25..=30).contains(&found.len()));
        assert!(found.last().unwrap().0.x > 950.0);
        hypotheses(
            &view(&beliefs),
            3,
            Knowledge::Belief,
            goals,
            usize::MAX,
            &mut found,
        );
        assert_eq!(found.len(), 1000);
    }

    /// As [`mode`] by its definition.
    fn defined_mode(belief: &BeliefView<'_>) -> Option<Hypothesis> {
        let cell = |pose: Pose2| (pose.x.floor() as i64, pose.y.floor() as i64);
        let usable = || belief.particles.iter().filter_map(ParticleView::usable);
        let mut weights = BTreeMap::new();
        for (pose, weight) in usable() {
            *weights.entry(cell(pose)).or_insert(0.0) += weight;
        }
        let most = weights.values().copied().reduce(f64::max)?;
        let (&best, _) = weights.iter().find(|(_, weight)| **weight == most)?;
        let mut sums = [0.0; 4];
        for (pose, weight) in usable().filter(|(pose, _)| cell(*pose) == best) {
            let (sin, cos) = math::sincos(pose.theta);
            for (sum, value) in sums.iter_mut().zip([pose.x, pose.y, sin, cos]) {
                *sum += weight * value;
            }
        }
        let [x, y, sin, cos] = sums;
        let theta = math::atan2(sin, cos);
        Some((Pose2::new(x / most, y / most, theta), 1.0))
    }

    proptest! {
        #[test]
        fn a_mode_is_the_defined_one(
            particles in proptest::collection::vec(
                (-2.5_f32..2.5, -2.5_f32..2.5, -3.0_f32..3.0, prop_oneof![Just(0.25_f32), -0.1_f32..1.0]),
                0..40,
            ),
            far in any::<f32>(),
        ) {
            let of = |&(x, y, theta, weight): &(f32, f32, f32, f32)| ParticleView { x, y, theta, weight };
            let mut particles: Vec<_> = particles.iter().map(of).collect();
            particles.push(particle(far, 1.0, 0.3));
            let belief = belief(&particles);
            prop_assert_eq!(mode(&belief, true), defined_mode(&belief));
            let place = |found: Option<Hypothesis>| found.map(|(pose, _)| pose.position());
            prop_assert_eq!(place(mode(&belief, false)), place(defined_mode(&belief)));
        }
    }
}
