//! Who chases whom, agreed without a word.
//!
//! All pursuers see the same state of the world and the same beliefs in the same tick, and solve
//! the same problem with the same deterministic algorithm; each then reads its own line of the
//! common solution. No message is needed, and none can be lost. A pursuer that joins late (after a
//! restart) knows nothing of earlier targets, so that it may disagree with its colleagues by up to
//! the cost of a switch until the next change of the teams.

use guidance::map::PlannerMap;
use guidance::navigation::Wayfinder;
use guidance::view::{RobotView, View};
use nalgebra::Point2;
use pathfinding::kuhn_munkres::kuhn_munkres_min;
use pathfinding::matrix::Matrix;
use sim_backend::team::Team;

use crate::goals::estimate;
use crate::params::{AssignmentMethod, AssignmentParams};

/// The cost of the impossible [ms], about three hours.
const NEVER_MS: i64 = 10_000_000;

/// Added to the cost of a place beyond an evader's fair share [ms], so that all fair shares are
/// filled first; above any sum of interception times of a full team.
const SURPLUS_MS: i64 = NEVER_MS * 1024;

/// Most pursuers and evaders that are matched with each other; more take the nearest.
const MAX_MATCHED: usize = 256;

/// First slot of the way-finder that the assignment may use (below are the pursuer's own).
pub const FIRST_SLOT: usize = 1;

/// Keeps the targets between ticks.
#[derive(Debug, Clone)]
pub struct Assigner {
    params: AssignmentParams,
    /// Target of each pursuer at the last assignment, as (pursuer, evader), in view order.
    targets: Vec<(usize, usize)>,
    /// Who took part in the last assignment, and in which period it was.
    solved_for: Option<(Vec<usize>, Vec<usize>, i64)>,
    way: Vec<(Point2<f64>, f64)>,
}

impl Assigner {
    /// An assigner without targets.
    pub fn new(params: AssignmentParams) -> Self {
        Self {
            params,
            targets: Vec::new(),
            solved_for: None,
            way: Vec::new(),
        }
    }

    /// The robot that `view.me` chases in this tick, if any.
    ///
    /// `finder` must have been prepared for the map.
    pub fn target(
        &mut self,
        map: &PlannerMap,
        finder: &mut Wayfinder,
        view: &View<'_>,
    ) -> Option<usize> {
        // A time of NaN gives no targets either.
        if view.time_s.is_nan() || view.time_s < self.params.delay_s {
            self.targets.clear();
            self.solved_for = None;
            return None;
        }
        match self.params.method {
            AssignmentMethod::NearestSticky => self.nearest_sticky(view),
            AssignmentMethod::Interception => self.interception(map, finder, view),
        }
    }

    fn nearest_sticky(&mut self, view: &View<'_>) -> Option<usize> {
        let kept = self
            .kept(view.me)
            .filter(|&kept| view.active(Team::Evader).any(|evader| evader.index == kept));
        let target = kept.or_else(|| self.nearest(view));
        self.targets.clear();
        self.targets.extend(target.map(|target| (view.me, target)));
        target
    }

    /// The evader nearest to this robot as the crow flies, the lower index of two.
    fn nearest(&self, view: &View<'_>) -> Option<usize> {
        let here = view.own()?.pose.position();
        let mut best: Option<(f64, usize)> = None;
        for evader in view.active(Team::Evader) {
            let Some(pose) = estimate(view, evader.index, self.params.knowledge) else {
                continue;
            };
            let distance = (pose.position() - here).norm();
            let found = (distance, evader.index);
            if best.is_none_or(|best| found < best) {
                best = Some(found);
            }
        }
        best.map(|(_, index)| index)
    }

    fn interception(
        &mut self,
        map: &PlannerMap,
        finder: &mut Wayfinder,
        view: &View<'_>,
    ) -> Option<usize> {
        let pursuers: Vec<&RobotView> = view.active(Team::Police).take(MAX_MATCHED).collect();
        let evaders: Vec<(&RobotView, Point2<f64>)> = view
            .active(Team::Evader)
            .filter_map(|evader| {
                let pose = estimate(view, evader.index, self.params.knowledge)?;
                Some((evader, pose.position()))
            })
            .take(MAX_MATCHED)
            .collect();
        let period = (view.time_s / self.params.period_s).floor() as i64;
        let teams = (
            pursuers.iter().map(|robot| robot.index).collect::<Vec<_>>(),
            evaders
                .iter()
                .map(|(robot, _)| robot.index)
                .collect::<Vec<_>>(),
            period,
        );
        if self.solved_for.as_ref() != Some(&teams) {
            let costs = self.costs(map, finder, view, &pursuers, &evaders);
            self.targets = balanced(&costs, pursuers.len(), evaders.len())
                .into_iter()
                .map(|(row, column)| (teams.0[row], teams.1[column]))
                .collect();
            self.solved_for = Some(teams);
        }
        self.kept(view.me)
    }

    fn kept(&self, pursuer: usize) -> Option<usize> {
        self.targets
            .iter()
            .find(|(who, _)| *who == pursuer)
            .map(|(_, target)| *target)
    }

    /// Predicted interception times [ms], pursuer by pursuer, less what a switch would cost.
    fn costs(
        &mut self,
        map: &PlannerMap,
        finder: &mut Wayfinder,
        view: &View<'_>,
        pursuers: &[&RobotView],
        evaders: &[(&RobotView, Point2<f64>)],
    ) -> Vec<i64> {
        let mut ways = Vec::with_capacity(evaders.len());
        for (column, (evader, at)) in evaders.iter().enumerate() {
            let slot = FIRST_SLOT + pursuers.len() + column;
            self.way.clear();
            if let Some(routes) = finder.lengths(map, slot, *at, view.usable_exits()) {
                let nearest = view
                    .usable_exits()
                    .filter_map(|exit| Some((routes.distance_to(exit)?, exit)))
                    .min_by(|a, b| a.0.total_cmp(&b.0));
                if let Some((_, exit)) = nearest {
                    routes.way_to(exit, &mut self.way);
                }
            }
            ways.push(escape(&self.way, *at, evader.v_max));
        }
        let mut costs = Vec::with_capacity(pursuers.len() * evaders.len());
        for (row, pursuer) in pursuers.iter().enumerate() {
            let here = pursuer.pose.position();
            let places = ways.iter().flatten().map(|&(place, _)| place);
            let routes = finder.lengths(map, FIRST_SLOT + row, here, places);
            let time_to = |to: Point2<f64>| {
                let distance = routes
                    .and_then(|routes| routes.distance_to(to))
                    .unwrap_or((to - here).norm());
                distance / pursuer.v_max
            };
            for ((evader, _), way) in evaders.iter().zip(&ways) {
                let kept = self
                    .kept(pursuer.index)
                    .is_none_or(|kept| kept == evader.index);
                let switch = if kept { 0.0 } else { self.params.switch_cost_s };
                costs.push(milliseconds(interception_time(way, time_to) + switch));
            }
        }
        costs
    }
}

/// An evader's predicted escape: places [m] with the time it is there [s]; the last place for good.
fn escape(way: &[(Point2<f64>, f64)], at: Point2<f64>, v_max: f64) -> Vec<(Point2<f64>, f64)> {
    // An evader that cannot move, or has nowhere to go, stays.
    if way.is_empty() || v_max < 1e-3 {
        return vec![(at, f64::INFINITY)];
    }
    way.iter()
        .map(|&(place, length)| (place, length / v_max))
        .collect()
}

/// When a pursuer first reaches a place of an escape before the evader has passed it [s]; if it
/// comes too late everywhere, when it reaches the last place.
fn interception_time(escape: &[(Point2<f64>, f64)], time_to: impl Fn(Point2<f64>) -> f64) -> f64 {
    let mut arrival = f64::INFINITY;
    for &(place, passed) in escape {
        arrival = time_to(place);
        if arrival <= passed {
            return if passed.is_finite() { passed } else { arrival };
        }
    }
    arrival
}

fn milliseconds(seconds: f64) -> i64 {
    let ms = (seconds * 1000.0).round();
    // NaN and infinity: never.
    if ms >= 0.0 && ms < NEVER_MS as f64 {
        ms as i64
    } else {
        NEVER_MS
    }
}

/// Matches every row (pursuer) with a column (evader) at the least sum of costs [ms].
///
/// With n rows and m columns every column gets at least ⌊n/m⌋ rows and at most one more; with fewer
/// rows than columns, every row its own column. `costs` holds n · m values in 0 ..= 10⁷, row by
/// row. Integer costs and a fixed order make the solution the same everywhere; of several optimal
/// solutions one is picked by the algorithm's fixed order.
pub fn balanced(costs: &[i64], rows: usize, columns: usize) -> Vec<(usize, usize)> {
    if rows == 0 || columns == 0 || costs.len() != rows * columns {
        return Vec::new();
    }
    let share = rows / columns;
    let surplus = usize::from(!rows.is_multiple_of(columns));
    let seats = columns * (share + surplus);
    let mut weights = Vec::with_capacity(rows * seats);
    for row in costs.chunks_exact(columns) {
        // Seat number s is the (s / columns)-th place at evader s % columns.
        weights.extend((0..seats).map(|seat| {
            let beyond = share > 0 && seat / columns >= share;
            row[seat % columns] + if beyond { SURPLUS_MS } else { 0 }
        }));
    }
    let Ok(weights) = Matrix::from_vec(rows, seats, weights) else {
        return Vec::new();
    };
    let (_, chosen) = kuhn_munkres_min(&weights);
    chosen
        .into_iter()
        .enumerate()
        .map(|(row, seat)| (row, seat % columns))
        .collect()
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn load(matches: &[(usize, usize)], columns: usize) -> Vec<usize> {
        (0..columns)
            .map(|c| matches.iter().filter(|(_, to)| *to == c).count())
            .collect()
    }

    #[test]
    fn everybody_nearest_to_one_evader_is_still_split_fairly() {
        let costs = [10, 500, 20, 500, 30, 500, 40, 500];
        let matches = balanced(&costs, 4, 2);
        assert_eq!(load(&matches, 2), [2, 2]);
        // Ties: all pay the same for evader 1, so the two cheapest on evader 0 stay there.
        assert_eq!(matches, [(0, 0), (1, 0), (2, 1), (3, 1)]);
    }

    #[test]
    fn the_odd_one_out_goes_where_it_costs_least() {
        let costs = [10, 900, 10, 900, 10, 900];
        assert_eq!(load(&balanced(&costs, 3, 2), 2), [2, 1]);
    }

    #[test]
    fn fewer_pursuers_than_evaders_take_one_each() {
        let costs = [5, 1, 9, 4, 1, 9];
        let matches = balanced(&costs, 2, 3);
        assert_eq!(matches.len(), 2);
        assert_ne!(matches[0].1, matches[1].1);
        assert_eq!(
            matches.iter().map(|&(r, c)| costs[r * 3 + c]).sum::<i64>(),
            5
        );
    }

    #[test]
    fn nobody_and_nothing_to_chase_gives_nothing() {
        assert!(balanced(&[], 0, 2).is_empty());
        assert!(balanced(&[], 2, 0).is_empty());
        assert!(balanced(&[1, 2, 3], 2, 2).is_empty());
    }

    #[test]
    fn interception_is_where_the_pursuer_is_first_in_time() {
        // The evader runs along x at 1 m/s; the pursuer waits at x = 5 and moves at 0.5 m/s.
        let escape: Vec<_> = (0..=10)
            .map(|i| (Point2::new(f64::from(i), 0.0), f64::from(i)))
            .collect();
        let time = interception_time(&escape, |p| (p.x - 5.0).abs() / 0.5);
        assert_eq!(time, 4.0);
        // Too slow to be anywhere in time: when it would be at the exit.
        let time = interception_time(&escape, |p| 100.0 + p.x);
        assert_eq!(time, 110.0);
    }

    #[test]
    fn impossible_times_are_never() {
        assert_eq!(milliseconds(f64::NAN), NEVER_MS);
        assert_eq!(milliseconds(f64::INFINITY), NEVER_MS);
        assert_eq!(milliseconds(1.2345), 1235);
    }

    proptest! {
        #[test]
        fn shares_are_fair_and_no_exchange_of_two_is_cheaper(
            rows in 1_usize..7,
            columns in 1_usize..5,
            seed in prop::collection::vec(0_i64..=NEVER_MS, 35),
        ) {
            let costs: Vec<_> = (0..rows * columns).map(|i| seed[i % seed.len()]).collect();
            let matches = balanced(&costs, rows, columns);
            prop_assert_eq!(matches.len(), rows);
            prop_assert_eq!(&matches, &balanced(&costs, rows, columns));
            for count in load(&matches, columns) {
                prop_assert!(count >= rows / columns && count <= rows.div_ceil(columns));
            }
            let cost = |row: usize, column: usize| costs[row * columns + column];
            for &(a, ca) in &matches {
                for &(b, cb) in &matches {
                    prop_assert!(cost(a, ca) + cost(b, cb) <= cost(a, cb) + cost(b, ca));
                }
            }
        }
    }
}
