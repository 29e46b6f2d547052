use chaotic_maps::{Key, KeyKind};
use geometry::pose::Pose2;
use rand::SeedableRng as _;

use super::*;
use crate::awg::{Awg, AwgParams, Preset};
use crate::danger::DangerZones;
use crate::forecast::Forecast;

const TICK_S: f64 = 0.25;
const RULE: DetectionRule = DetectionRule {
    distance: 1.0,
    sight: 0.0,
};
const SCHEDULE: Schedule = Schedule {
    duration_s: 12.0,
    first_s: 400.0,
    pause_s: 5.0,
    window_s: 60.0,
};

fn square() -> Contour {
    let corners = [[0.0, 0.0], [10.0, 0.0], [10.0, 10.0], [0.0, 10.0]];
    Contour::closed(&corners.map(Point2::from)).unwrap()
}

fn rng() -> ChaCha8Rng {
    ChaCha8Rng::seed_from_u64(5)
}

/// Lengths along the square at which the guards are at a time.
type Guards = fn(f64) -> Vec<f64>;

/// Begin and place of each attack of an adversary in 2000 s on guards at these lengths, and whether it is detected.
fn attacks(method: Method, guards: Guards) -> Vec<(f64, usize, bool)> {
    let contour = square();
    let places = places_along(&contour, 1.0);
    let at = |length: f64| contour.at(length.rem_euclid(40.0) / 40.0).unwrap();
    let seen = |time_s: f64| {
        let guards: Vec<Point2<f64>> = guards(time_s).into_iter().map(at).collect();
        guarded(&places, &guards, RULE, |_, _| true)
    };
    let mut visits = Visits::new(places.len());
    let mut adversary = Adversary::new(method, SCHEDULE, rng());
    let mut attacks = Vec::new();
    for tick in 0..8000 {
        let time_s = f64::from(tick) * TICK_S;
        visits.observe(time_s, &seen(time_s));
        if let Some(place) = adversary.step(time_s, &visits, |_, _| None) {
            let lasts = (0..=48).map(|tick| time_s + f64::from(tick) * TICK_S);
            let is_detected = lasts.into_iter().any(|t| seen(t)[place]);
            attacks.push((time_s, place, is_detected));
        }
    }
    attacks
}

fn detected(attacks: &[(f64, usize, bool)]) -> f64 {
    attacks
        .iter()
        .filter(|(.., is_detected)| *is_detected)
        .count() as f64
        / attacks.len() as f64
}

/// Two guards a quarter of a lap apart: intervals of about 8 and 28 s take turns.
fn uneven(time_s: f64) -> Vec<f64> {
    vec![time_s, time_s + 10.0]
}

/// One guard that goes there and back on a half of the square: visits of its ends are 38 s apart.
fn pendulum(time_s: f64) -> Vec<f64> {
    vec![20.0 - ((time_s % 40.0) - 20.0).abs()]
}

#[test]
fn places_divide_a_contour_evenly() {
    let places = places_along(&square(), 1.5);
    assert_eq!(places.len(), 27);
    assert!((places[1] - Point2::new(40.0 / 27.0, 0.0)).norm() < 1e-12);
    let open = Contour::open(&[Point2::origin(), Point2::new(4.0, 0.0)]).unwrap();
    let places = places_along(&open, 1.0);
    assert_eq!((places.len(), places[4]), (5, Point2::new(4.0, 0.0)));
}

#[test]
fn a_random_adversary_is_detected_as_often_as_places_are_guarded() {
    let found = attacks(Method::Random, uneven);
    // Of the 40 s of a lap, the attack of 12 s meets a visit in all but 28 - 12 + 1 s or so.
    assert!((0.4..0.8).contains(&detected(&found)), "{found:?}");
    assert!(found.iter().all(|(begin, ..)| *begin >= SCHEDULE.first_s));
    let pauses = found.windows(2).map(|pair| pair[1].0 - pair[0].0);
    for pause in pauses {
        assert!((17.0..=77.5).contains(&pause), "{pause}");
    }
}

#[test]
fn history_shows_the_long_interval_of_two() {
    let found = attacks(Method::History, uneven);
    // Just after a visit, every second interval is long. Later than the short one, only the long one remains.
    assert!(found.len() > 20 && detected(&found) == 0.0, "{found:?}");
}

#[test]
fn statistics_show_places_with_long_and_even_intervals() {
    let found = attacks(Method::Statistical, pendulum);
    assert!(found.len() > 20 && detected(&found) == 0.0, "{found:?}");
    // At the ends of the way the intervals are all alike.
    let is_end = |place: usize| place <= 1 || (19..=21).contains(&place) || place == 39;
    assert!(
        found.iter().all(|(_, place, _)| is_end(*place)),
        "{found:?}"
    );
}

#[test]
fn without_visits_an_adversary_attacks_at_the_end_of_its_window() {
    for method in [Method::History, Method::Statistical] {
        let found = attacks(method, |_| Vec::new());
        assert_eq!(found[0].0, 460.0, "{method:?}");
        assert_eq!(detected(&found), 0.0);
    }
}

#[test]
fn a_best_response_is_where_the_guards_method_seldom_leads() {
    let contour = square();
    let places = places_along(&contour, 1.0);
    let params = AwgParams {
        t_max: 80.0,
        alpha: 0.5,
        mode: Preset::Default.mode(),
    };
    let awg = Awg::new(&contour, &DangerZones::default(), params).unwrap();
    let own = BestResponse {
        awg: awg.clone(),
        samples: 8,
    };
    let guard = Pose2::new(5.0, 0.0, 0.0);
    let schedule = Schedule {
        duration_s: 30.0,
        window_s: 20.0,
        ..SCHEDULE
    };
    let plan = own
        .plan(
            &[guard],
            &places,
            (&schedule, RULE),
            |_, _| true,
            &mut rng(),
        )
        .unwrap();
    // The guard drives 20 m in the first 40 s: a place that it has left is safe at once.
    assert_eq!(plan.delay_s, 0.0);
    let key = Key::from_seed(KeyKind::Keyed, 77).source().unwrap();
    let forecast = Forecast::new(awg, key);
    let clock_s = own.awg.nearest_s(guard.position(), 0.0);
    for tick in 0..120 {
        let at = forecast
            .at_time(clock_s + f64::from(tick) * TICK_S)
            .unwrap()
            .point;
        assert!((at - places[plan.place]).norm() > RULE.distance);
    }
    assert_eq!(
        own.plan(&[], &places, (&schedule, RULE), |_, _| true, &mut rng()),
        None
    );
}

#[test]
fn a_best_response_is_chosen_again_where_a_guard_is_at_its_time() {
    let mut visits = Visits::new(2);
    let mut adversary = Adversary::new(Method::BestResponse, SCHEDULE, rng());
    let mut windows = Vec::new();
    let mut step = |time_s: f64, guarded: [bool; 2], place, delay_s| {
        visits.observe(time_s, &guarded);
        adversary.step(time_s, &visits, |_, window_s| {
            windows.push(window_s);
            Some(Plan { place, delay_s })
        })
    };
    assert_eq!(step(400.0, [false, false], 0, 5.0), None);
    assert_eq!(step(402.0, [true, false], 1, 0.0), None);
    assert_eq!(step(405.0, [true, false], 0, 7.0), None);
    assert_eq!(step(412.0, [false, true], 1, 9.0), Some(0));
    // At the end of its window it attacks in any case.
    assert_eq!(step(429.0, [true, true], 1, 60.0), None);
    assert_eq!(step(489.0, [true, true], 1, 60.0), Some(1));
    assert_eq!(windows, [60.0, 55.0, 60.0, 0.0]);
}
