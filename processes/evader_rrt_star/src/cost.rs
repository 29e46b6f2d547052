//! Costs of the edges of the tree.

use nalgebra::Point2;

use crate::motion::{Leg, Link};
use crate::params::{Algorithm, CostKind, CostParams};

/// Distance of a pursuer at which the danger is 1 (m).
const SCALE: f64 = 4.0;

/// Time after which a pursuer is assumed not to come nearer (s).
const HORIZON_S: f64 = 5.0;

/// Distance between two samples along an edge (m).
const STEP: f64 = 0.5;

/// Maximum number of samples of the time-aware cost along one edge.
const MAX_LOOKS: f64 = 32.0;

/// Pursuer, as input of the cost.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pursuer {
    /// Position (m).
    pub at: Point2<f64>,
    /// Its highest speed (m/s).
    pub v_max: f64,
}

/// Cost of edges in one situation.
///
/// Every edge costs at least its length, which makes the path's remaining length an admissible
/// heuristic.
#[derive(Debug, Clone, PartialEq)]
pub struct CostModel {
    params: CostParams,
    /// Minimum distance of pursuers in the cost (m): nearer ones count as this far.
    closest: f64,
    /// Speed of the evader (m/s).
    own_speed: f64,
    pursuers: Vec<Pursuer>,
    /// Highest speed of all pursuers if it is the same (m/s).
    one_speed: Option<f64>,
}

impl CostModel {
    /// Returns the costs for an evader with this search and speed (m/s) without pursuers.
    pub fn new(params: CostParams, algorithm: Algorithm, own_speed: f64) -> Self {
        Self {
            params,
            closest: algorithm.closest(),
            own_speed: own_speed.max(1e-3),
            pursuers: Vec::new(),
            one_speed: None,
        }
    }

    /// Sets the pursuers; non-finite ones are ignored.
    pub fn set_pursuers(&mut self, pursuers: impl Iterator<Item = Pursuer>) {
        self.pursuers.clear();
        if self.params.kind != CostKind::Length {
            self.pursuers.extend(pursuers.filter(|p| {
                p.at.x.is_finite() && p.at.y.is_finite() && p.v_max.is_finite() && p.v_max >= 0.0
            }));
        }
        self.one_speed = self
            .pursuers
            .first()
            .map(|first| first.v_max)
            .filter(|&v_max| self.pursuers.iter().all(|p| p.v_max == v_max));
    }

    /// Returns `true` if an edge's cost depends on nothing but the edge.
    pub fn is_static(&self) -> bool {
        self.params.kind != CostKind::TimeAware || self.pursuers.is_empty()
    }

    /// Returns the cost (m) of this link from one point to another, after a path of length `before`
    /// (m). It is at least the link's length.
    pub fn edge(&self, from: Point2<f64>, to: Point2<f64>, link: &Link, before: f64) -> f64 {
        if self.pursuers.is_empty() {
            return link.length;
        }
        match self.params.kind {
            CostKind::Length => link.length,
            CostKind::Paper => {
                let nearest = self
                    .pursuers
                    .iter()
                    .map(|p| link.distance_to(from, to, p.at))
                    .fold(f64::INFINITY, f64::min);
                link.length + self.danger(nearest)
            }
            CostKind::TimeAware => link.length + self.danger_along(from, to, link, before),
        }
    }

    fn danger(&self, margin: f64) -> f64 {
        let ratio = SCALE / margin.max(self.closest);
        ratio * ratio * ratio
    }

    /// Returns the distance (m) from a point to the nearest place that a pursuer can reach in
    /// `reach` seconds; negative within.
    fn margin(&self, at: Point2<f64>, reach: f64) -> f64 {
        if let Some(v_max) = self.one_speed {
            // One root for all: it is the greatest cost of planning, and grows with its argument.
            let mut least = f64::INFINITY;
            for pursuer in &self.pursuers {
                let squared = (at - pursuer.at).norm_squared();
                if squared < least {
                    least = squared;
                }
            }
            return least.sqrt() - reach * v_max;
        }
        self.pursuers
            .iter()
            .map(|p| (at - p.at).norm() - reach * p.v_max)
            .fold(f64::INFINITY, f64::min)
    }

    fn danger_along(&self, from: Point2<f64>, to: Point2<f64>, link: &Link, before: f64) -> f64 {
        let looks = looks(link.length / STEP);
        let share = 1.0 / looks;
        let (chord, bulge) = (to - from, bulge(from, to, link));
        let mut sum = 0.0;
        for look in 0..looks as u32 {
            // The midpoint rule.
            let t = (f64::from(look) + 0.5) * share;
            let at = from + chord * t + bulge * (4.0 * t * (1.0 - t));
            let seconds = ((before + t * link.length) / self.own_speed).min(HORIZON_S);
            let reach = self.params.reach * seconds;
            sum += self.danger(self.margin(at, reach));
        }
        self.params.weight * sum * share * link.length
    }
}

/// Returns the number of samples along a path of this many steps: rounded up, from 1 to
/// [`MAX_LOOKS`]. (`ceil` is a call on the oldest x86-64.)
fn looks(steps: f64) -> f64 {
    let whole = f64::from(steps as u32);
    let up = if whole < steps { whole + 1.0 } else { whole };
    up.clamp(1.0, MAX_LOOKS)
}

/// From the middle of the chord to the middle of the path; an arc is near enough to the parabola
/// through its middle for a danger that varies over metres.
fn bulge(from: Point2<f64>, to: Point2<f64>, link: &Link) -> nalgebra::Vector2<f64> {
    match &link.leg {
        Leg::Line => nalgebra::Vector2::zeros(),
        Leg::Arc(arc) => {
            let (sin, cos) = geometry::math::sincos(arc.start + 0.5 * arc.sweep);
            let middle = arc.center + nalgebra::Vector2::new(cos, sin) * arc.radius;
            middle - nalgebra::center(&from, &to)
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn model(params: CostParams, pursuers: &[(f64, f64)]) -> CostModel {
        let algorithm = match params.kind {
            CostKind::Paper => Algorithm::Published,
            _ => Algorithm::Improved,
        };
        let mut model = CostModel::new(params, algorithm, 0.45);
        model.set_pursuers(pursuers.iter().map(|&(x, y)| Pursuer {
            at: Point2::new(x, y),
            v_max: 0.3,
        }));
        model
    }

    fn line(model: &CostModel, from: Point2<f64>, to: Point2<f64>, before: f64) -> f64 {
        model.edge(from, to, &Link::line((to - from).norm()), before)
    }

    #[test]
    fn the_papers_cost_has_the_papers_values() {
        let (from, to) = (Point2::new(4.5, 1.5), Point2::new(7.5, 0.5));
        for (pursuers, cost) in [
            (&[(7.5, 1.5)][..], 78.120),
            (&[(4.5, 4.5)], 5.5326),
            (&[(4.5, 4.5), (7.5, 1.5)], 78.120),
            (&[], 3.1623),
        ] {
            let found = line(&model(CostParams::paper(), pursuers), from, to, 0.0);
            assert!((found - cost).abs() < 6e-4, "{pursuers:?}: {found}");
        }
    }

    #[test]
    fn the_time_aware_cost_rises_with_the_time_of_arrival_up_to_the_horizon() {
        let model = model(CostParams::default(), &[(4.0, 0.0)]);
        let at = |before| line(&model, Point2::new(0.0, 0.0), Point2::new(0.0, 0.2), before);
        assert!(
            at(0.0) < at(0.5) && at(0.5) < at(2.0),
            "{} {}",
            at(0.0),
            at(0.5)
        );
        assert_eq!(at(100.0), at(200.0));
    }

    #[test]
    fn a_pursuer_that_stays_makes_the_same_danger_at_all_times() {
        let params = CostParams {
            reach: 0.0,
            ..CostParams::default()
        };
        let model = model(params, &[(4.0, 0.0)]);
        let cost = line(&model, Point2::new(0.0, 0.0), Point2::new(0.0, 1e-3), 7.0);
        // Danger 1 at 4 m: a metre of path costs a metre more.
        assert!((cost - 2e-3).abs() < 1e-8, "{cost}");
    }

    proptest! {
        #[test]
        fn pursuers_of_one_speed_count_as_each_of_them_does(
            places in prop::collection::vec((-9.0..9.0f64, -9.0..9.0f64), 1..6),
            (x, y) in (-9.0..9.0f64, -9.0..9.0f64),
            reach in 0.0..20.0f64,
        ) {
            let model = model(CostParams::default(), &places);
            prop_assert!(model.one_speed.is_some());
            let each = CostModel { one_speed: None, ..model.clone() };
            let at = Point2::new(x, y);
            prop_assert_eq!(model.margin(at, reach).to_bits(), each.margin(at, reach).to_bits());
        }

        #[test]
        fn looks_are_steps_rounded_up(steps in prop_oneof![0.0..100.0f64, (0..99u32).prop_map(f64::from)]) {
            prop_assert_eq!(looks(steps), steps.ceil().clamp(1.0, MAX_LOOKS));
        }
    }

    #[test]
    fn pursuers_of_different_speeds_are_told_apart() {
        let mut model = model(CostParams::default(), &[]);
        let pursuers = [(1.0, 0.1), (2.0, 0.3)];
        model.set_pursuers(pursuers.into_iter().map(|(x, v_max)| Pursuer {
            at: Point2::new(x, 0.0),
            v_max,
        }));
        // The further one is nearer after ten seconds: 2 − 3 against 1 − 1 metres.
        assert_eq!(model.margin(Point2::origin(), 10.0), -1.0);
    }

    #[test]
    fn nan_pursuers_are_ignored() {
        let model = model(
            CostParams::paper(),
            &[(f64::NAN, 0.0), (f64::INFINITY, 1.0)],
        );
        assert!(model.pursuers.is_empty());
    }

    proptest! {
        #[test]
        fn an_edge_costs_at_least_its_length_and_a_finite_number(
            a in (-9.0..9.0, -9.0..9.0),
            b in (-9.0..9.0, -9.0..9.0),
            pursuers in prop::collection::vec((-9.0..9.0, -9.0..9.0), 0..5),
            before in 0.0..40.0,
            paper in any::<bool>(),
        ) {
            let params = if paper { CostParams::paper() } else { CostParams::default() };
            let (from, to) = (Point2::new(a.0, a.1), Point2::new(b.0, b.1));
            let cost = line(&model(params, &pursuers), from, to, before);
            prop_assert!(cost.is_finite() && cost >= (to - from).norm());
        }

        #[test]
        fn cutting_an_edge_changes_its_time_aware_cost_by_the_quadrature_alone(
            b in (-3.0..3.0, -3.0..3.0),
            cut in 0.1..0.9,
            pursuer in (-9.0..9.0, 4.5..9.0),
        ) {
            let model = model(CostParams::default(), &[pursuer]);
            let (from, to) = (Point2::origin(), Point2::new(b.0, b.1));
            let middle = from + (to - from) * cut;
            let whole = line(&model, from, to, 1.0);
            let parts = line(&model, from, middle, 1.0)
                + line(&model, middle, to, 1.0 + (middle - from).norm());
            prop_assert!((whole - parts).abs() < 2e-2 * whole, "{} {}", whole, parts);
        }
    }
}
