use geometry::pose::{Pose2, Twist2};
use nalgebra::Point2;
use proptest::prelude::*;
use robot::team::Role;

use super::*;
use crate::awg::{AwgParams, Preset};
use crate::contour::Contour;
use crate::danger::DangerZones;

const DT: f64 = 0.5;

/// A square of 10 m, driven in 100 s a lap; open: three of its sides.
fn square(is_closed: bool) -> Awg {
    let corners = [[0.0, 0.0], [10.0, 0.0], [10.0, 10.0], [0.0, 10.0]].map(Point2::from);
    let contour = if is_closed {
        Contour::closed(&corners).unwrap()
    } else {
        Contour::open(&corners).unwrap()
    };
    let params = AwgParams {
        t_max: 100.0,
        alpha: 0.5,
        mode: Preset::Default.mode(),
    };
    Awg::new(&contour, &DangerZones::default(), params).unwrap()
}

/// Robots that stand where they are put.
struct Robots {
    awg: Awg,
    views: Vec<RobotView>,
    time_s: f64,
}

impl Robots {
    fn new(awg: Awg, count: usize) -> Self {
        let view = |index| RobotView {
            index,
            team: Role::Neutral.into(),
            active: true,
            present: true,
            pose: Pose2::new(5.0, 5.0, 0.0),
            twist: Twist2::STOP,
            radius: 0.2,
            v_max: 1.0,
        };
        Self {
            awg,
            views: (0..count).map(view).collect(),
            time_s: 0.0,
        }
    }

    fn team(&self, start: Start) -> Team {
        let indices: Vec<u32> = (0..self.views.len() as u32).collect();
        Team::new(&indices, start, None).unwrap()
    }

    /// Puts a robot at a place of the round (s).
    fn put(&mut self, robot: usize, clock_s: f64) {
        let (_, place) = self.awg.place_at(clock_s).unwrap();
        let (at, along) = (place.point(), place.leg.stretch.segment.along);
        self.views[robot].pose = Pose2::new(at.x, at.y, geometry::math::atan2(along.y, along.x));
    }

    fn observe(&mut self, team: &mut Team) {
        let view = View {
            time_s: self.time_s,
            dt: DT,
            me: 0,
            robots: &self.views,
            beliefs: &[],
            exits: &[],
            scan: None,
        };
        team.observe(&self.awg, &view);
        self.time_s += DT;
    }

    /// Observes for a time, with all robots but the `failed` ones at their places.
    fn follow(&mut self, team: &mut Team, seconds: f64, failed: &[usize]) {
        let until = self.time_s + seconds;
        while self.time_s < until {
            for robot in 0..self.views.len() {
                if !failed.contains(&robot) && !team.members.is_empty() {
                    self.put(robot, team.members[robot].clock_s);
                }
            }
            self.observe(team);
        }
    }
}

/// Returns the times between the places of the robots that take part, around the round (s).
fn gaps(team: &Team, awg: &Awg) -> Vec<f64> {
    let taking_part = team.members.iter().filter(|m| m.takes_part);
    let mut clocks: Vec<f64> = taking_part.map(|m| m.clock_s).collect();
    clocks.sort_by(f64::total_cmp);
    let mut gaps: Vec<f64> = clocks.windows(2).map(|pair| pair[1] - pair[0]).collect();
    gaps.push(clocks[0] + awg.round_s() - clocks[clocks.len() - 1]);
    gaps
}

fn assert_even(team: &Team, awg: &Awg) {
    let part_s = awg.round_s() / team.taking_part() as f64;
    for gap in gaps(team, awg) {
        assert!((gap - part_s).abs() < 1e-6, "{gap} {part_s}");
    }
}

#[test]
fn places_on_the_clock_are_those_of_an_unprotected_patrol() {
    for is_closed in [true, false] {
        let awg = square(is_closed);
        for tenth in 0..(10.0 * awg.round_s()) as u32 {
            let clock_s = f64::from(tenth) / 10.0;
            let (_, place) = awg.place_at(clock_s).unwrap();
            let along = place.leg.stretch.segment.along;
            let heading = geometry::math::atan2(along.y, along.x);
            let found = awg.nearest_s(awg.nominal_at(clock_s), heading);
            assert!((found - clock_s).abs() < 1e-6, "{found} {clock_s}");
        }
    }
}

#[test]
fn a_robot_alone_and_a_convoy_are_no_team() {
    assert!(Team::new(&[3], Start::Spread, None).is_none());
    assert!(Team::new(&[], Start::Nearest, None).is_none());
    assert!(Team::new(&[0, 1], Start::Waypoint(0), None).is_none());
}

#[test]
fn the_clock_begins_when_all_are_at_their_places() {
    let mut robots = Robots::new(square(true), 4);
    let mut team = robots.team(Start::Spread);
    for robot in 0..3 {
        robots.put(robot, 25.0 * robot as f64);
    }
    robots.observe(&mut team);
    robots.observe(&mut team);
    assert!(team.waits);
    let clocks: Vec<f64> = team.members.iter().map(|m| m.clock_s).collect();
    let part_s = robots.awg.round_s() / 4.0;
    assert_eq!(clocks, [0.0, part_s, 2.0 * part_s, 3.0 * part_s]);
    robots.put(3, 3.0 * part_s);
    robots.observe(&mut team);
    robots.observe(&mut team);
    assert!(!team.waits);
    assert_eq!(team.members[0].clock_s, DT);
}

#[test]
fn a_robot_that_drives_around_on_one_spot_is_replaced() {
    let mut robots = Robots::new(square(true), 3);
    let mut team = robots.team(Start::Spread);
    robots.follow(&mut team, 60.0, &[]);
    let (began_s, x) = (robots.time_s, robots.views[1].pose.x);
    let mut side = 0.5;
    while team.taking_part() == 3 {
        side = -side;
        robots.views[1].pose.x = x + side;
        robots.follow(&mut team, DT, &[1]);
        assert!(robots.time_s - began_s < 100.0, "within a round");
    }
    assert!(!team.members[1].takes_part);
    assert_even(&team, &robots.awg);
}

#[test]
fn a_robot_that_stands_is_replaced_and_counts_again_when_it_moves() {
    let mut robots = Robots::new(square(true), 3);
    let mut team = robots.team(Start::Spread);
    robots.follow(&mut team, 60.0, &[]);
    let began_s = robots.time_s;
    while team.taking_part() == 3 {
        robots.follow(&mut team, DT, &[1]);
        assert!(
            robots.time_s - began_s < 100.0 / 3.0,
            "within the way to the next"
        );
    }
    assert!(!team.members[1].takes_part);
    assert_even(&team, &robots.awg);
    robots.follow(&mut team, 30.0, &[1]);
    assert_eq!(team.taking_part(), 2);
    // It is put back somewhere else.
    robots.put(1, 71.0);
    robots.follow(&mut team, DT, &[1]);
    assert_eq!(team.taking_part(), 3);
    assert_even(&team, &robots.awg);
}

#[test]
fn a_robot_out_of_play_is_replaced_at_once() {
    let mut robots = Robots::new(square(true), 5);
    let mut team = robots.team(Start::Nearest);
    robots.follow(&mut team, 10.0, &[]);
    robots.views[2].active = false;
    robots.follow(&mut team, DT, &[]);
    assert_eq!(team.taking_part(), 4);
    assert_even(&team, &robots.awg);
    robots.views[2].active = true;
    robots.follow(&mut team, DT, &[]);
    assert_eq!(team.taking_part(), 5);
    assert_even(&team, &robots.awg);
}

#[test]
fn the_clock_waits_for_a_robot_that_wanders_for_a_round_at_most() {
    let mut robots = Robots::new(square(true), 2);
    let mut team = robots.team(Start::Spread);
    robots.put(0, 0.0);
    let mut waited = 0.0;
    for step in 0..1000 {
        robots.views[1].pose.x = if step % 2 == 0 { -3.0 } else { 4.0 };
        robots.observe(&mut team);
        if !team.waits {
            break;
        }
        waited += DT;
    }
    assert!(
        (waited - robots.awg.round_s()).abs() <= 2.0 * DT,
        "{waited}"
    );
    assert_eq!(team.taking_part(), 2);
}

#[test]
fn an_early_robot_waits_and_a_late_one_does_not() {
    let mut robots = Robots::new(square(true), 2);
    let mut team = robots.team(Start::Spread);
    robots.put(0, 0.0);
    robots.observe(&mut team);
    assert_eq!(team.begin(0), 0.0);
    robots.observe(&mut team);
    let own = robots.views[0];
    let waypoint = |number, point| Waypoint {
        number,
        lap: 0,
        kind: planner_view::waypoint::WaypointKind::Inserted,
        point,
    };
    let awg = &robots.awg;
    assert!(team.holds(awg, &own, &waypoint(2, Point2::new(0.8, 0.0)), 1.0));
    assert!(!team.holds(awg, &own, &waypoint(2, Point2::new(3.0, 0.0)), 1.0));
    assert!(!team.holds(awg, &own, &waypoint(0, Point2::new(0.8, 0.0)), 1.0));
    // One that is away never waits, whatever its waypoint.
    let mut away = robots.views[1];
    away.pose = Pose2::new(0.0, 0.0, 0.0);
    assert!(!team.holds(awg, &away, &waypoint(99, Point2::new(0.8, 0.0)), 1.0));
}

proptest! {
    /// Wherever the robots are, a new division is even, keeps their order and moves no place back.
    #[test]
    fn a_division_is_even_and_only_forward(
        clocks in proptest::collection::vec(0.0_f64..100.0, 2..12),
    ) {
        let robots = Robots::new(square(true), clocks.len());
        let mut team = robots.team(Start::Spread);
        team.members = clocks
            .iter()
            .map(|&clock_s| Member { clock_s, takes_part: true, is_away: false, stay: Stay::default() })
            .collect();
        team.spread(&robots.awg);
        assert_even(&team, &robots.awg);
        let round_s = robots.awg.round_s();
        let shifts: Vec<f64> = team
            .members
            .iter()
            .zip(&clocks)
            .map(|(member, before)| (member.clock_s - before + 1e-6).rem_euclid(round_s))
            .collect();
        let part_s = round_s / clocks.len() as f64;
        prop_assert!(shifts.iter().any(|&shift| shift < 2e-6), "one keeps its place");
        prop_assert!(shifts.iter().all(|&shift| shift <= round_s - part_s + 2e-6), "{shifts:?}");
    }
}
