//! Dominance in the open, where the solution is known, and in the city.

use std::sync::LazyLock;

use geometry::region::Region;
use nalgebra::Point2;
use navigation::dominance::{Arena, Cell, Dominance, DominanceParams, Owner, Runner, Verdict};
use planner_view::map::PlannerMap;
use proptest::prelude::*;
use testing::{EXIT, RADIUS, open_ground};

const POLICE: [(f64, f64); 4] = [(7.5, 4.5), (7.5, 1.5), (7.5, -1.5), (7.5, -4.5)];

static CITY: LazyLock<(PlannerMap, Arena)> = LazyLock::new(|| {
    let map = testing::Arena::city().map();
    let exit = Region::Circle {
        center: [EXIT.x, EXIT.y],
        radius: 0.5,
    };
    let arena = Arena::new(&map, &DominanceParams::default(), RADIUS, &[exit], 0.3);
    (map, arena)
});

static OPEN: LazyLock<(PlannerMap, Arena)> = LazyLock::new(|| {
    let map = open_ground();
    let exits = [(9.0, 0.0), (-9.0, 0.0)].map(|(x, y)| Region::Rectangle {
        center: [x, y],
        half_extents: [0.5, 1.0],
        angle: 0.0,
    });
    let arena = Arena::new(&map, &DominanceParams::default(), RADIUS, &exits, 0.3);
    (map, arena)
});

fn runner(x: f64, y: f64, speed: f64) -> Runner {
    Runner {
        at: Point2::new(x, y),
        speed,
        reach: 0.0,
    }
}

fn assess(
    place: &(PlannerMap, Arena),
    police: &[Runner],
    evaders: &[Runner],
    reach: f64,
) -> (Vec<Verdict>, Dominance) {
    let mut dominance = Dominance::default();
    let reaching = |runner: &Runner| Runner { reach, ..*runner };
    let police: Vec<Runner> = police.iter().map(reaching).collect();
    let verdicts = dominance
        .assess(&place.0, &place.1, &police, evaders)
        .to_vec();
    (verdicts, dominance)
}

/// Share of the nodes at which the safe set differs from the true set, relative to the true set.
fn wrong_share(dominance: &Dominance, arena: &Arena, truth: impl Fn(Point2<f64>) -> bool) -> f64 {
    let (mut inside, mut wrong) = (0.0, 0.0);
    for node in 0..arena.lattice().len() {
        let expected = truth(arena.lattice().point(node).unwrap());
        let found = dominance.safe(0).unwrap().time(node).is_finite();
        inside += f64::from(u8::from(expected));
        wrong += f64::from(u8::from(expected != found));
    }
    wrong / inside
}

#[test]
fn in_the_open_a_slower_evader_dominates_the_inside_of_apollonius_circle() {
    let (evader, pursuer) = (runner(-1.03, 0.4, 0.3), runner(2.17, -0.7, 0.6));
    let (verdicts, dominance) = assess(&OPEN, &[pursuer], &[evader], 0.0);
    // The points whose distances have the ratio of the speeds: centre e + (e − p)·k²/(1 − k²),
    // radius
    // |e − p|·k/(1 − k²), k = 1/2.
    let k = 0.5_f64;
    let offset = evader.at - pursuer.at;
    let center = evader.at + offset * (k * k / (1.0 - k * k));
    let radius = offset.norm() * k / (1.0 - k * k);
    let wrong = wrong_share(&dominance, &OPEN.1, |p| (p - center).norm() < radius);
    assert!(wrong < 0.01, "{wrong}");
    let circle = core::f64::consts::PI * radius * radius / 400.0;
    assert!((verdicts[0].area_share / circle - 1.0).abs() < 0.02);
    assert!(!verdicts[0].escape_possible);
}

#[test]
fn in_the_open_equal_speeds_part_the_plane_in_halves() {
    let (evader, pursuer) = (runner(-1.03, 0.4, 0.5), runner(2.17, -0.7, 0.5));
    let (_, dominance) = assess(&OPEN, &[pursuer], &[evader], 0.0);
    let nearer = |p: Point2<f64>| (p - evader.at).norm() < (p - pursuer.at).norm();
    assert!(wrong_share(&dominance, &OPEN.1, nearer) < 0.01);
}

#[test]
fn the_capture_radius_is_a_head_start_of_the_pursuers() {
    let (evader, pursuer) = (runner(-1.03, 0.4, 0.3), runner(2.17, -0.7, 0.5));
    let (_, dominance) = assess(&OPEN, &[pursuer], &[evader], 0.3);
    let first = |p: Point2<f64>| {
        (p - evader.at).norm() / 0.3 < ((p - pursuer.at).norm() - 0.3).max(0.0) / 0.5
    };
    assert!(wrong_share(&dominance, &OPEN.1, first) < 0.02);
}

#[test]
fn a_faster_evader_does_not_get_through_a_pursuer() {
    // Behind the pursuer it would be first by a straight line, but the line passes through the
    // pursuer.
    let (evader, pursuer) = (runner(-3.0, 0.0, 0.5), runner(0.0, 0.0, 0.3));
    let (verdicts, mut dominance) = assess(&OPEN, &[pursuer], &[evader], 0.3);
    let behind = OPEN.1.lattice().node_at(Point2::new(8.0, 0.05)).unwrap();
    let safe = dominance.safe(0).unwrap();
    let straight = 11.0 / 0.5;
    // Either it goes around the pursuer and is later, or it does not arrive in time.
    assert!(f64::from(safe.time(behind)) > 1.02 * straight);
    assert!(verdicts[0].escape_possible && verdicts[0].exit == Some(1));
    let mut cells = Vec::new();
    dominance.cells(&OPEN.0, &OPEN.1, &[evader], &mut cells);
    assert_eq!(cells.len(), OPEN.1.lattice().frame().len());
    let counts = [Owner::Neither, Owner::Police, Owner::Evader]
        .map(|owner| cells.iter().filter(|cell| cell.owner == owner).count());
    assert!(
        counts[0] == 0 && counts[1] > 100 && counts[2] > 1000,
        "{counts:?}"
    );
    for cell in &cells {
        match cell.owner {
            Owner::Evader | Owner::CutOff => assert!(cell.margin > 0.0),
            Owner::Police => assert!(cell.margin <= 0.0),
            Owner::Neither => {}
        }
    }
}

#[test]
fn mirror_images_have_equal_verdicts() {
    let evaders = [runner(-4.5, 7.5, 0.45), runner(-4.5, -7.5, 0.45)];
    let police = POLICE.map(|(x, y)| runner(x, y, 0.3));
    let (verdicts, _) = assess(&CITY, &police, &evaders, 0.3);
    let (a, b) = (verdicts[0], verdicts[1]);
    assert_eq!(a.escape_possible, b.escape_possible);
    assert!(
        (a.margin - b.margin).abs() < 0.3,
        "{} {}",
        a.margin,
        b.margin
    );
    assert!((a.area_share - b.area_share).abs() < 0.005);
}

#[test]
fn in_the_city_pursuers_decide_by_how_far_they_are_from_the_exit() {
    let evader = [runner(4.5, 0.0, 0.45)];
    let verdict = |police: &[Runner]| assess(&CITY, police, &evader, 0.3).0[0];
    // The escape path is about 5 m long: 11 s.
    let alone = verdict(&[]);
    assert!(alone.escape_possible && alone.margin == f64::INFINITY);
    assert!(
        (alone.time - 11.4).abs() < 0.5 && alone.area_share > 0.99,
        "{alone:?}"
    );
    let guard = verdict(&[runner(8.5, 0.0, 0.3)]);
    assert!(!guard.escape_possible && guard.time == f64::INFINITY);
    assert!(guard.margin < -5.0 && guard.exit == Some(0), "{guard:?}");
    let far = verdict(&[runner(7.5, 6.0, 0.3)]);
    assert!(far.escape_possible && far.margin > 5.0, "{far:?}");
    let caught = assess(&CITY, &[runner(4.5, 0.2, 0.3)], &evader, 0.3).0[0];
    assert!(!caught.escape_possible && caught.area_share == 0.0);
}

/// Captures are by the distance in a straight line, also around a corner or through a thin wall.
#[test]
fn a_pursuer_behind_a_wall_is_as_near_as_the_straight_line() {
    let mut arena = testing::Arena::city();
    arena.rectangles = vec![
        (-10.0, 10.0, -10.0, -4.0),
        (-10.0, 10.0, 4.0, 10.0),
        (-8.0, 8.0, -0.02, 0.02),
    ];
    let map = arena.map();
    let arena = Arena::new(&map, &DominanceParams::default(), RADIUS, &[], 0.3);
    let mut dominance = Dominance::default();
    let pursuer = Runner {
        reach: 0.3,
        ..runner(0.0, -2.0, 0.3)
    };
    dominance.pursue(&map, &arena, &[pursuer]);
    // The pursuer comes to the wall within 6 s; the path around the wall takes it 55 s.
    let beyond = dominance.stopped_from(&arena, Point2::new(0.0, 0.12), RADIUS);
    assert!((4.0..6.1).contains(&beyond), "{beyond}");
    let farther = dominance.stopped_from(&arena, Point2::new(0.0, 1.0), RADIUS);
    assert!(farther > 45.0, "{farther}");
}

/// A lower bound, and no worse than half a second in the open.
#[test]
fn no_pursuer_stops_a_robot_earlier_than_the_bound() {
    let pursuer = Runner {
        reach: 0.3,
        ..runner(2.17, -0.7, 0.3)
    };
    let mut dominance = Dominance::default();
    dominance.pursue(&OPEN.0, &OPEN.1, &[pursuer]);
    for step in 0..400 {
        let (x, y) = (
            f64::from(step % 20) * 0.83 - 8.0,
            f64::from(step / 20) * 0.77 - 8.0,
        );
        let p = Point2::new(x, y);
        let truth = (((p - pursuer.at).norm() - 0.3) / 0.3).max(0.0);
        let bound = dominance.stopped_from(&OPEN.1, p, RADIUS);
        assert!(
            bound <= truth && bound > 0.98 * truth - 0.5,
            "{p} {bound} {truth}"
        );
    }
    assert_eq!(
        dominance.stopped_from(&OPEN.1, Point2::new(99.0, 0.0), RADIUS),
        0.0
    );
}

#[test]
fn without_an_exit_there_is_no_escape() {
    let arena = Arena::new(&CITY.0, &DominanceParams::default(), RADIUS, &[], 0.3);
    let mut dominance = Dominance::default();
    let verdict = dominance.assess(&CITY.0, &arena, &[], &[runner(1.5, 1.5, 0.5)])[0];
    assert!(!verdict.escape_possible && verdict.exit.is_none());
    assert_eq!(verdict.margin, f64::NEG_INFINITY);
    assert!(verdict.area_share > 0.99);
}

#[test]
fn unreachable_cells_have_no_owner() {
    let mut dominance = Dominance::default();
    dominance.assess(&CITY.0, &CITY.1, &[], &[]);
    let mut cells = Vec::new();
    dominance.cells(&CITY.0, &CITY.1, &[], &mut cells);
    assert!(cells.iter().all(|cell| *cell == Cell::default()));
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn a_faster_evader_and_slower_pursuers_never_dominate_less(
        evader in (-7.0_f64..7.0, -7.9_f64..7.9),
        police in prop::collection::vec((-7.9_f64..7.9, -7.9_f64..7.9), 1..4),
        speed in 0.1_f64..1.0,
        factor in 1.05_f64..2.0,
        slow_police in any::<bool>(),
    ) {
        let verdict = |own: f64, others: f64| {
            let police: Vec<Runner> = police.iter().map(|&(x, y)| runner(x, y, others)).collect();
            assess(&CITY, &police, &[runner(evader.0, evader.1, own)], 0.3).0[0]
        };
        let before = verdict(speed, 0.3);
        let after = if slow_police { verdict(speed, 0.3 / factor) } else { verdict(speed * factor, 0.3) };
        // Rounding at the rim of the set may cost a few cells.
        prop_assert!(after.area_share >= before.area_share - 0.003, "{before:?} {after:?}");
        prop_assert!(after.escape_possible || !before.escape_possible || before.margin < 0.5);
    }

    #[test]
    fn any_input_gives_finite_and_reproducible_verdicts(
        numbers in prop::collection::vec(prop::num::f64::ANY, 12),
    ) {
        let runners: Vec<Runner> = numbers
            .chunks_exact(3)
            .map(|n| runner(n[0], n[1], n[2]))
            .chain([runner(1.5, 1.5, 0.3)])
            .collect();
        let (once, _) = assess(&CITY, &runners, &runners, numbers[0]);
        let (again, _) = assess(&CITY, &runners, &runners, numbers[0]);
        for (a, b) in once.iter().zip(&again) {
            prop_assert!(!a.margin.is_nan() && !a.time.is_nan() && a.area_share.is_finite());
            prop_assert_eq!(a.margin.to_bits(), b.margin.to_bits());
        }
    }
}
