//! Layers drawn over the robots: beliefs, plans, trees, scans, predictions, verdicts; dominance regions; visits of
//! places.

use ipc_types::consumer::{Consumer, LoggedMessage};
use ipc_types::messages::observer::Prediction;
use ipc_types::messages::perception::{BeliefHeader, Particle};
use ipc_types::messages::referee::Verdict;
use ipc_types::messages::robot::{PlanPoint, ScanHeader, TreeEdge};
use ipc_types::topics::{Belief, Dominance, Plan, Predictions, Scan, TopicId, Tree, Verdicts};

use super::regions::Regions;
use super::thinning::ThinnedSeries;
use crate::picture::layers::is_aimed;
use crate::run_model::LoggedRun;
use scenario::spec::MAX_ROBOTS;

const SECOND: u64 = 1_000_000_000;
/// Minimum time between two beliefs about a robot, and between two trees of a robot (ns).
const BELIEF_INTERVAL: u64 = SECOND / 2;
/// Minimum time between two plans, scans or predictions of a robot (ns).
const PLAN_INTERVAL: u64 = SECOND / 4;
/// Maximum number of particles of a belief, and of all beliefs.
const PARTICLES: usize = 250;
const ALL_PARTICLES: usize = 640_000;
/// Maximum number of points of a plan, and of all plans.
const POINTS: usize = 120;
const ALL_POINTS: usize = 200_000;
/// Maximum number of edges of a tree, and of all trees.
const EDGES: usize = 500;
const ALL_EDGES: usize = 160_000;
/// Maximum number of beams of a scan, and of all scans.
const BEAMS: usize = 90;
const ALL_BEAMS: usize = 300_000;
/// Maximum number of predictions that are stored.
const ALL_PREDICTIONS: usize = 150_000;
/// Maximum number of verdicts that are stored.
const ALL_VERDICTS: usize = 60_000;
/// Maximum number of different horizons of predictions.
const HORIZONS: usize = 16;
/// Maximum number of visits of places of patrols that are stored.
const ALL_VISITS: usize = 200_000;
/// Factor of a patrol in the keys of its places.
pub const PLACES: u32 = 1 << 16;

/// A belief about a robot.
#[derive(Debug, Clone, PartialEq)]
pub struct Cloud {
    /// Mean of the particles, x and y (m).
    pub(super) mean: [f64; 2],
    /// Points that represent equal shares of the belief, x and y (m).
    pub(super) points: Vec<[f32; 2]>,
}

/// A planned path.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Path {
    /// Its points, x and y (m).
    pub(super) points: Vec<[f64; 2]>,
    /// `true` if the last point is what the robot heads for in the end, not a part of the path.
    pub(super) has_aim: bool,
}

/// An edge of a search tree.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Edge {
    /// Both end points, x and y (m).
    pub(super) ends: [[f32; 2]; 2],
    /// `true` if the edge belongs to the chosen path.
    pub(super) on_path: bool,
}

/// A range scan.
#[derive(Debug, Clone, PartialEq)]
pub struct Beams {
    /// Bearing of the first beam and angle between two (rad).
    pub(super) first: f64,
    pub(super) step: f64,
    /// Ranges (m); a beam without a hit has the maximum range.
    pub(super) ranges: Vec<f32>,
}

/// The predicted position of a robot, by one method.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MethodPrediction {
    pub(super) method: u8,
    /// Index of the horizon in [`Layers::horizons_s`].
    pub(super) horizon: u8,
    /// Position, x and y (m); infinite if the method has no prediction.
    pub(super) at: [f64; 2],
}

/// All layers, by robot.
#[derive(Debug, Clone)]
pub struct Layers {
    pub(super) beliefs: ThinnedSeries<Cloud>,
    pub(super) plans: ThinnedSeries<Path>,
    pub(super) trees: ThinnedSeries<Vec<Edge>>,
    pub(super) scans: ThinnedSeries<Beams>,
    pub(super) predictions: ThinnedSeries<Vec<MethodPrediction>>,
    pub(super) verdicts: ThinnedSeries<Verdict>,
    pub(super) regions: Regions,
    /// Visits by patrol and place.
    pub(super) visits: ThinnedSeries<()>,
    /// The horizons of predictions (s).
    pub(super) horizons_s: Vec<f64>,
}

impl Default for Layers {
    fn default() -> Self {
        Self {
            beliefs: ThinnedSeries::new(BELIEF_INTERVAL, ALL_PARTICLES, |cloud| {
                cloud.points.len() + 8
            }),
            plans: ThinnedSeries::new(PLAN_INTERVAL, ALL_POINTS, |path| path.points.len() + 2),
            trees: ThinnedSeries::new(BELIEF_INTERVAL, ALL_EDGES, |edges| edges.len() + 2),
            scans: ThinnedSeries::new(PLAN_INTERVAL, ALL_BEAMS, |beams| beams.ranges.len() + 4),
            predictions: ThinnedSeries::new(PLAN_INTERVAL, ALL_PREDICTIONS, |all| all.len() + 2),
            verdicts: ThinnedSeries::new(PLAN_INTERVAL, ALL_VERDICTS, |_| 1),
            regions: Regions::default(),
            visits: ThinnedSeries::new(SECOND, ALL_VISITS, |()| 1),
            horizons_s: Vec::new(),
        }
    }
}

impl Consumer<LoggedRun> for Layers {
    fn topics(&self) -> &[TopicId] {
        &[
            TopicId::Belief,
            TopicId::Plan,
            TopicId::Tree,
            TopicId::Scan,
            TopicId::Predictions,
            TopicId::Verdicts,
            TopicId::Dominance,
            TopicId::WorldState,
        ]
    }

    fn message(&mut self, message: &LoggedMessage<'_>, run: &mut LoggedRun) {
        let time_ns = message.time_ns;
        let is_known = |robot: u32| (robot as usize) < MAX_ROBOTS;
        if let Some((header, particles)) = run.decode::<Belief>(message)
            && is_known(header.robot)
        {
            self.belief(time_ns, &header, &particles);
        }
        if let Some((header, points)) = run.decode::<Plan>(message)
            && is_known(header.robot)
        {
            self.plan(time_ns, header.robot, &points);
        }
        if let Some((header, edges)) = run.decode::<Tree>(message)
            && is_known(header.robot)
        {
            self.tree(time_ns, header.robot, &edges);
        }
        if let Some((header, ranges)) = run.decode::<Scan>(message)
            && is_known(header.robot)
        {
            self.scan(time_ns, &header, &ranges);
        }
        if let Some((_, predictions)) = run.decode::<Predictions>(message) {
            self.predictions(time_ns, &predictions);
        }
        if let Some((_, verdicts)) = run.decode::<Verdicts>(message) {
            for verdict in verdicts.iter().filter(|verdict| is_known(verdict.robot)) {
                self.verdicts.push(time_ns, verdict.robot, *verdict);
            }
        }
        if let Some((header, cells)) = run.decode::<Dominance>(message) {
            self.regions.push(time_ns, &header, &cells);
        }
        if message.topic == TopicId::WorldState {
            for (patrol, measurement) in (0..).zip(&run.patrols) {
                for (place, figures) in (0..PLACES).zip(measurement.places().of_each()) {
                    if figures.visits > 0 && figures.idle_s == 0.0 {
                        self.visits.push(time_ns, patrol * PLACES + place, ());
                    }
                }
            }
        }
    }
}

impl Layers {
    fn belief(&mut self, time_ns: u64, header: &BeliefHeader, particles: &[Particle]) {
        let cloud = Cloud {
            mean: [header.mean_x, header.mean_y],
            points: shares(particles, PARTICLES),
        };
        self.beliefs.push(time_ns, header.robot, cloud);
    }

    fn plan(&mut self, time_ns: u64, robot: u32, points: &[PlanPoint]) {
        let has_aim = is_aimed(points);
        let points = spread(points, POINTS)
            .map(|p| [p.x, p.y])
            .filter(|p| p.iter().all(|c| c.is_finite()))
            .collect();
        self.plans.push(time_ns, robot, Path { points, has_aim });
    }

    fn tree(&mut self, time_ns: u64, robot: u32, edges: &[TreeEdge]) {
        // All edges of the chosen path; other edges up to the maximum number.
        let (path, others): (Vec<&TreeEdge>, Vec<&TreeEdge>) =
            edges.iter().partition(|edge| edge.on_path != 0);
        let room = EDGES.saturating_sub(path.len());
        let edges = spread(&others, room)
            .chain(path.iter().take(EDGES))
            .map(|edge| Edge {
                ends: [[edge.from_x, edge.from_y], [edge.to_x, edge.to_y]],
                on_path: edge.on_path != 0,
            })
            .filter(|edge| edge.ends.iter().flatten().all(|c| c.is_finite()))
            .collect();
        self.trees.push(time_ns, robot, edges);
    }

    fn scan(&mut self, time_ns: u64, header: &ScanHeader, ranges: &[f32]) {
        let every = ranges.len().div_ceil(BEAMS).max(1);
        let far = header.range_max as f32;
        let near = header.range_min as f32;
        let beams = Beams {
            first: header.angle_min,
            step: header.angle_increment * every as f64,
            ranges: ranges
                .iter()
                .step_by(every)
                .map(|&range| {
                    if range.is_nan() {
                        near
                    } else {
                        // Beyond the maximum range is +∞, below the minimum −∞ (REP-117).
                        range.max(near).min(far)
                    }
                })
                .collect(),
        };
        self.scans.push(time_ns, header.robot, beams);
    }

    fn predictions(&mut self, time_ns: u64, predictions: &[Prediction]) {
        let mut by_robot: std::collections::BTreeMap<u32, Vec<MethodPrediction>> =
            std::collections::BTreeMap::new();
        for prediction in predictions {
            if (prediction.robot as usize) >= MAX_ROBOTS {
                continue;
            }
            let known = self
                .horizons_s
                .iter()
                .position(|h| h.to_bits() == prediction.horizon_s.to_bits());
            let horizon = match known {
                Some(known) => known,
                None if self.horizons_s.len() < HORIZONS && prediction.horizon_s.is_finite() => {
                    self.horizons_s.push(prediction.horizon_s);
                    self.horizons_s.len() - 1
                }
                None => continue,
            };
            by_robot
                .entry(prediction.robot)
                .or_default()
                .push(MethodPrediction {
                    method: prediction.method,
                    horizon: horizon as u8,
                    at: [prediction.x, prediction.y],
                });
        }
        for (robot, all) in by_robot {
            self.predictions.push(time_ns, robot, all);
        }
    }
}

/// Returns at most `most` items, evenly spaced, the last one included.
fn spread<T>(all: &[T], most: usize) -> impl Iterator<Item = &T> {
    let count = all.len().min(most);
    (1..=count).filter_map(move |i| all.get((i * all.len()).div_ceil(count) - 1))
}

/// Returns at most `most` points that represent equal shares of the weights, in order.
fn shares(particles: &[Particle], most: usize) -> Vec<[f32; 2]> {
    let weight = |p: &Particle| {
        let sound = p.weight.is_finite() && p.weight > 0.0 && p.x.is_finite() && p.y.is_finite();
        if sound { f64::from(p.weight) } else { 0.0 }
    };
    let total: f64 = particles.iter().map(weight).sum();
    let count = particles.len().min(most);
    if total <= 0.0 || count == 0 {
        return Vec::new();
    }
    let mut picked = Vec::with_capacity(count);
    let mut sum = 0.0;
    for particle in particles {
        sum += weight(particle);
        // Midpoints of equal parts of the sum.
        while picked.len() < count && (picked.len() as f64 + 0.5) / count as f64 * total < sum {
            picked.push([particle.x, particle.y]);
        }
    }
    picked
}

#[cfg(test)]
mod tests {
    use super::*;

    fn particle(x: f32, weight: f32) -> Particle {
        Particle {
            x,
            weight,
            ..Particle::default()
        }
    }

    #[test]
    fn points_represent_equal_shares_of_a_belief() {
        let mut particles: Vec<Particle> = (0..1000).map(|_| particle(1.0, 0.0005)).collect();
        particles.push(particle(2.0, 0.5));
        particles.push(particle(3.0, f32::NAN));
        let points = shares(&particles, 100);
        assert_eq!(points.len(), 100);
        assert_eq!(points.iter().filter(|p| p[0] == 2.0).count(), 50);
        assert!(points.iter().all(|p| p[0] < 3.0));
        assert!(shares(&[particle(1.0, 0.0)], 10).is_empty());
        assert!(shares(&[], 10).is_empty());
    }

    #[test]
    fn a_long_plan_keeps_its_end() {
        let all: Vec<u32> = (0..1001).collect();
        let some: Vec<u32> = spread(&all, 100).copied().collect();
        assert_eq!(some.len(), 100);
        assert_eq!(some.last(), Some(&1000));
        assert_eq!(spread(&all[..3], 100).count(), 3);
        assert_eq!(spread(&all, 0).count(), 0);
    }

    #[test]
    fn the_path_of_a_tree_stays_whole() {
        let edges: Vec<TreeEdge> = (0..5000)
            .map(|i| TreeEdge {
                on_path: u32::from(i % 100 == 0),
                ..TreeEdge::default()
            })
            .collect();
        let mut layers = Layers::default();
        layers.tree(0, 3, &edges);
        let trees = layers.trees.finish();
        assert_eq!(trees[0].key, 3);
        assert_eq!(trees[0].item.len(), EDGES);
        assert_eq!(trees[0].item.iter().filter(|e| e.on_path).count(), 50);
    }

    #[test]
    fn beams_without_a_hit_have_the_maximum_range() {
        let header = ScanHeader {
            range_min: 0.1,
            range_max: 3.5,
            angle_increment: 0.01,
            ..ScanHeader::default()
        };
        let mut ranges = vec![1.0_f32; 180];
        ranges[0] = f32::INFINITY;
        ranges[2] = f32::NEG_INFINITY;
        let mut layers = Layers::default();
        layers.scan(0, &header, &ranges);
        let beams = &layers.scans.finish()[0].item;
        assert_eq!(beams.ranges.len(), 90);
        assert!((beams.step - 0.02).abs() < 1e-12);
        assert_eq!(beams.ranges[..3], [3.5, 0.1, 1.0]);
    }
}
