//! Words against each other, against known values, and against the bound.

use core::f64::consts::{FRAC_PI_2, PI};

use geometry::math;
use geometry::pose::Pose2;
use nalgebra::Point2;
use proptest::prelude::*;

use crate::words::{Word, dubins, forwards, reeds_shepp, to_place};
use crate::{Heading, Motion, Speeds, least_time};

type Words = fn(&Pose2, &Pose2, f64) -> Vec<Word>;

fn shortest(words: Vec<Word>) -> f64 {
    let costs = words.into_iter().map(|word| word.cost());
    costs.fold(f64::INFINITY, f64::min)
}

fn of_dubins(from: &Pose2, to: &Pose2) -> f64 {
    shortest(dubins(from, to, 1.0))
}

fn of_reeds_shepp(from: &Pose2, to: &Pose2) -> f64 {
    shortest(reeds_shepp(from, to, 1.0))
}

fn near(a: f64, b: f64) -> bool {
    (a - b).abs() < 1e-6
}

#[test]
fn known_words_have_their_lengths() {
    let start = Pose2::default();
    let to = |x: f64, y: f64, theta: f64| Pose2::new(x, y, theta);
    assert!(near(of_dubins(&start, &to(4.0, 0.0, 0.0)), 4.0));
    // A half circle.
    assert!(near(of_dubins(&start, &to(0.0, 2.0, PI)), PI));
    // Circles 5 apart with the line between them: L S R.
    let (line, turn) = (21.0_f64.sqrt(), math::atan2(2.0, 21.0_f64.sqrt()));
    assert!(near(
        of_dubins(&start, &to(5.0, 2.0, 0.0)),
        line + 2.0 * turn
    ));
    // About-turns on the spot: arcs of π/3, 5π/3, π/3; with cusps three of π/3.
    let about = to(0.0, 0.0, PI);
    assert!(near(of_dubins(&start, &about), 7.0 * PI / 3.0));
    assert!(near(of_reeds_shepp(&start, &about), PI));
    assert!(near(of_reeds_shepp(&start, &to(-3.0, 0.0, 0.0)), 3.0));
    // A quarter turn on the spot: L⁺R⁻L⁺ with a middle arc of 2 asin(√2/4).
    let quarter = to(0.0, 0.0, FRAC_PI_2);
    assert!(near(of_reeds_shepp(&start, &quarter), FRAC_PI_2));
    assert_eq!(of_dubins(&start, &start), 0.0);
}

#[test]
fn a_heading_tells_how_far_the_robot_has_turned() {
    let start = Pose2::new(0.0, 0.0, 3.0);
    let turned = Motion::Turn(1.5).end(&start);
    assert_eq!(turned.theta, 4.5);
    let drive = Motion::Drive {
        length: 3.0,
        kappa: 1.0,
    };
    assert_eq!(drive.end(&turned).theta, 7.5);
}

#[test]
fn a_free_heading_costs_no_more_than_any_prescribed_one() {
    let start = Pose2::new(0.3, -0.2, 0.5);
    for (x, y) in [(2.0, 1.0), (0.5, 0.4), (-1.0, 0.2), (0.3, 0.8)] {
        for words in [dubins, forwards, reeds_shepp] {
            let free = shortest(to_place(&start, Point2::new(x, y), 1.0, words));
            for i in 0..100 {
                let theta = 0.0628 * f64::from(i);
                let prescribed = shortest(words(&start, &Pose2::new(x, y, theta), 1.0));
                assert!(
                    free < prescribed + 2e-2,
                    "{x} {y} {theta}: {free} {prescribed}"
                );
            }
        }
    }
}

#[test]
fn a_heading_at_the_goal_does_not_lower_the_bound() {
    let a = Pose2::new(3.966_013, 1.631_639, 1.143_270);
    let b = Pose2::new(1.380_047, 0.381_681, -2.463_101);
    let speeds = Speeds {
        v: 2.677_536,
        omega: 0.697_391,
        reverse: false,
    };
    let bound = |heading| least_time(&speeds, &a, b.position(), heading);
    let (free, at) = (bound(Heading::Free), bound(Heading::At(b.theta)));
    assert!(free <= at, "{free} {at}");
}

fn pose() -> impl Strategy<Value = Pose2> {
    (-5.0..5.0f64, -5.0..5.0f64, -4.0..4.0f64).prop_map(|(x, y, theta)| Pose2::new(x, y, theta))
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 500, ..ProptestConfig::default() })]

    #[test]
    fn words_end_at_the_goal_and_neither_cusps_nor_turns_on_the_spot_cost(a in pose(), b in pose()) {
        let (along, both) = (of_dubins(&a, &b), of_reeds_shepp(&a, &b));
        let line = (b.position() - a.position()).norm();
        prop_assert!(line <= both + 1e-9 && both <= along + 1e-9 && along.is_finite());
        // A word that turns on the spot is no faster than one that reverses instead.
        let spinning = shortest(forwards(&a, &b, 1.0));
        prop_assert!(both <= spinning + 1e-9 && spinning <= along);
        for word in reeds_shepp(&a, &b, 1.0).into_iter().chain(forwards(&a, &b, 1.0)) {
            let end = word.end(&a);
            prop_assert!((end.position() - b.position()).norm() < 1e-6);
            prop_assert!(math::angle_difference(end.theta, b.theta).abs() < 1e-6);
        }
    }

    #[test]
    fn lengths_keep_the_symmetries(a in pose(), b in pose(), by in pose()) {
        let turned = |p: &Pose2, turn: f64| Pose2::new(p.x, p.y, p.theta + turn);
        let mirrored = |p: &Pose2| Pose2::new(p.x, -p.y, -p.theta);
        let back = of_reeds_shepp(&a, &b);
        // There and back; the robot turned around; the mirror image.
        prop_assert!(near(back, of_reeds_shepp(&b, &a)));
        prop_assert!(near(back, of_reeds_shepp(&turned(&a, PI), &turned(&b, PI))));
        prop_assert!(near(back, of_reeds_shepp(&mirrored(&a), &mirrored(&b))));
        let forwards = of_dubins(&a, &b);
        prop_assert!(near(forwards, of_dubins(&turned(&b, PI), &turned(&a, PI))));
        prop_assert!(near(forwards, of_dubins(&mirrored(&a), &mirrored(&b))));
        // No detour is shorter: a word that was missing would make one.
        prop_assert!(back <= of_reeds_shepp(&a, &by) + of_reeds_shepp(&by, &b) + 1e-6);
        prop_assert!(forwards <= of_dubins(&a, &by) + of_dubins(&by, &b) + 1e-6);
    }

    #[test]
    fn no_detour_over_a_near_pose_is_shorter(a in pose(), b in pose(), part in 0.0..1.0f64, by in pose()) {
        // Between the two, where a missing word shows.
        let by = Pose2::new(
            a.x + part * (b.x - a.x) + 0.1 * by.x,
            a.y + part * (b.y - a.y) + 0.1 * by.y,
            by.theta,
        );
        let back = of_reeds_shepp(&a, &b);
        prop_assert!(back <= of_reeds_shepp(&a, &by) + of_reeds_shepp(&by, &b) + 1e-6);
    }

    #[test]
    fn no_word_is_faster_than_the_bound(a in pose(), b in pose(), v in 0.1..3.0f64, omega in 0.1..3.0f64) {
        for (reverse, words) in [(false, forwards as Words), (true, reeds_shepp)] {
            let speeds = Speeds { v, omega, reverse };
            let radius = v / omega;
            let time = shortest(words(&a, &b, radius)) / v;
            let bound = least_time(&speeds, &a, b.position(), Heading::At(b.theta));
            prop_assert!(bound <= time + 1e-9, "{bound} {time}");
            if reverse {
                prop_assert!(bound > time - 1e-6, "{bound} {time}");
            }
            let free = least_time(&speeds, &a, b.position(), Heading::Free);
            let to_place = shortest(to_place(&a, b.position(), radius, words)) / v;
            prop_assert!(free <= bound + 1e-9 && free <= to_place + 1e-9, "{free} {bound} {to_place}");
        }
    }

    #[test]
    fn far_from_the_goal_the_bound_is_the_time(a in pose(), angle in -3.1..3.1f64, theta in -4.0..4.0f64) {
        // Far enough for quarter circles at both ends, on either side.
        let b = Pose2::new(a.x + 5.0 * math::cos(angle), a.y + 5.0 * math::sin(angle), theta);
        let speeds = Speeds { v: 1.0, omega: 1.0, reverse: false };
        // About-turns to either side are nearly as fast, and neither bounds the other.
        let around = [a.theta, theta].map(|theta| math::angle_difference(theta, angle).abs());
        let most = if around.iter().all(|turn| *turn < 2.4) { 1e-4 } else { 0.2 };
        let bound = least_time(&speeds, &a, b.position(), Heading::At(theta));
        let time = shortest(forwards(&a, &b, 1.0));
        prop_assert!(bound > time - most, "{bound} {time}");
        // With a goal beside the robot, so are driving ahead and backwards.
        for (reverse, words, most) in [(false, forwards as Words, most), (true, reeds_shepp, 0.2)] {
            let speeds = Speeds { reverse, ..speeds };
            let free = least_time(&speeds, &a, b.position(), Heading::Free);
            let to_place = shortest(to_place(&a, b.position(), 1.0, words));
            prop_assert!(free > to_place - most, "{reverse}: {free} {to_place}");
        }
    }
}
