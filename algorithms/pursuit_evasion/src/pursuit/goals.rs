//! Goals of pursuers, made from the information on their target.

use std::collections::BTreeMap;

use avoidance::potential_field::Goal;
use geometry::math;
use geometry::pose::Pose2;
use nalgebra::Point2;
use parameters::Fidelity;
use planner_view::map::PlannerMap;
use planner_view::view::{BeliefView, View};

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
                    into.extend(taken.filter_map(planner_view::view::ParticleView::usable));
                    if into.is_empty() {
                        into.extend(mean(belief));
                    }
                }
                BeliefGoals::Mean => into.extend(mean(belief)),
                BeliefGoals::Mode => into.extend(mode(belief).or_else(|| mean(belief))),
            }
        }
    }
}

/// Returns the most probable position of a target, as one pose.
pub fn estimate(view: &View<'_>, target: usize, knowledge: Knowledge) -> Option<Pose2> {
    match knowledge {
        Knowledge::Exact => view.robot(target).map(|robot| robot.pose),
        Knowledge::Belief => {
            let belief = view.belief(target)?;
            mode(belief).or_else(|| mean(belief)).map(|(pose, _)| pose)
        }
    }
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

/// Returns the goal for a hypothesis: a point ahead of it by a share of the distance to it (m), on
/// this side of the first obstacle. The published program's goal may lie inside a block or beyond
/// the arena's wall.
pub fn look_ahead(
    map: &PlannerMap,
    pose: &Pose2,
    distance: f64,
    room: f64,
    fidelity: Fidelity,
) -> Point2<f64> {
    let from = pose.position();
    let ahead = pose.forward() * (LOOK_AHEAD_RATIO * distance).min(MAX_LOOK_AHEAD);
    let to = from + ahead;
    let length = ahead.norm();
    if fidelity.is_published() || length <= 0.0 {
        return to;
    }
    from + ahead * (map.free_run(from, to, room) / length)
}

/// Writes the look-ahead goals of a set of hypotheses to `into` (cleared first).
pub fn goals(
    map: &PlannerMap,
    hypotheses: &[Hypothesis],
    distance_to: impl Fn(Point2<f64>) -> f64,
    room: f64,
    fidelity: Fidelity,
    into: &mut Vec<Goal>,
) {
    into.clear();
    into.extend(hypotheses.iter().map(|(pose, weight)| {
        let distance = distance_to(pose.position());
        Goal {
            at: look_ahead(map, pose, distance, room, fidelity),
            weight: *weight,
        }
    }));
}

fn mean(belief: &BeliefView<'_>) -> Option<Hypothesis> {
    belief.mean.is_finite().then_some((belief.mean, 1.0))
}

/// Returns the mean pose of the square metre with the highest weight; of several, the one with the
/// lowest coordinates.
fn mode(belief: &BeliefView<'_>) -> Option<Hypothesis> {
    let hypotheses = || {
        let particles = belief.particles.iter();
        let usable = particles.filter_map(planner_view::view::ParticleView::usable);
        let cell = |value: f64| (value / MODE_CELL).floor() as i64;
        usable.map(move |(pose, weight)| ((cell(pose.x), cell(pose.y)), pose, weight))
    };
    let mut weights: BTreeMap<(i64, i64), f64> = BTreeMap::new();
    for (cell, _, weight) in hypotheses() {
        *weights.entry(cell).or_default() += weight;
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
        let (sin, cos) = math::sincos(pose.theta);
        x += weight * pose.x;
        y += weight * pose.y;
        sin_sum += weight * sin;
        cos_sum += weight * cos;
    }
    let mean = Pose2::new(x / total, y / total, math::atan2(sin_sum, cos_sum));
    mean.is_finite().then_some((mean, 1.0))
}

#[cfg(test)]
mod tests {
    use planner_view::view::ParticleView;

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
        assert!((at.x - 5.3).abs() < 1e-5 && (at.theta - 0.5).abs() < 1e-6);
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
            let at = estimate(&view, 3, Knowledge::Belief).unwrap().position();
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
}
