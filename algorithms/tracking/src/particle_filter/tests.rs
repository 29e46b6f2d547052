use geometry::blur::BlurredMap;
use geometry::grid::{Grid, GridFrame};
use geometry::math;
use proptest::prelude::*;
use rand::SeedableRng;

use super::*;
use crate::params::{HeadingModel, PerceptionParams, SensorParams};
use crate::sighting::sense;
use crate::space::tests::room;

mod published;
mod steps;

const DT: f64 = 0.05;
const LIMITS: MotionLimits = MotionLimits {
    v_max: 0.5,
    v_reverse_max: 0.05,
    omega_max: 1.0,
};

fn rng(seed: u64) -> ChaCha8Rng {
    ChaCha8Rng::seed_from_u64(seed)
}

fn drive(pose: Pose2, v: f64, omega: f64, dt: f64) -> Pose2 {
    let middle = pose.theta + 0.5 * omega * dt;
    let (sin, cos) = math::sincos(middle);
    Pose2::new(
        pose.x + v * dt * cos,
        pose.y + v * dt * sin,
        pose.theta + omega * dt,
    )
}

fn distance(belief: &Belief, truth: Pose2) -> f64 {
    (belief.mean.position() - truth.position()).norm()
}

fn watch_from(space: &Space, observers: &[Pose2]) -> Watch {
    let mut watch = Watch::new(&SensorParams::default());
    watch.set(space.field(), observers);
    watch
}

fn seen_at(pose: Pose2, sigma: f64) -> Sighting {
    let m = Measurement {
        position: pose.position(),
        sigma,
        heading: None,
    };
    Sighting {
        visibility: 0.9,
        observer: Some(0),
        measurement: Some(m),
    }
}

#[test]
fn the_belief_moves_on_along_the_heading_and_stops_at_walls() {
    let space = Space::new(&room());
    let mut pose = Pose2::new(-3.0, 2.0, 0.0);
    let params = FilterParams::default();
    let mut filter = ParticleFilter::new(&params, LIMITS, Some(pose), &space, rng(8));
    let watch = watch_from(&space, &[Pose2::new(-3.0, 2.5, 0.0)]);
    for _ in 0..60 {
        pose = drive(pose, 0.45, 0.0, DT);
        filter.update(&space, &watch, &seen_at(pose, 0.0), DT);
    }
    let now = filter.mean_after(&space, 0.0);
    assert!((now - pose.position()).norm() < 1e-5);
    assert_eq!(now, filter.mean_after(&space, f64::NAN));
    let ahead = drive(pose, 0.45, 0.0, 2.0).position();
    let predicted = filter.mean_after(&space, 2.0);
    assert!((predicted - ahead).norm() < 0.15, "{predicted} {ahead}");
    // The room ends at x = 4: no hypothesis drives further.
    let stopped = filter.mean_after(&space, 60.0);
    assert!(stopped.x < 4.0 && space.is_valid(stopped), "{stopped}");
    let later = filter.mean_after(&space, 90.0);
    assert!((later - stopped).norm() < 0.1, "{later} {stopped}");
}

#[test]
fn exact_sightings_set_the_position_and_reveal_the_heading() {
    let space = Space::new(&room());
    let watch = watch_from(&space, &[]);
    for (seed, start, omega) in [
        (1, Pose2::new(-3.0, 2.0, 0.0), 0.0),
        (2, Pose2::new(2.0, -2.0, 2.0), 0.3),
    ] {
        // The filter starts with the opposite heading.
        let wrong = Pose2::new(start.x, start.y, start.theta + 3.0);
        let params = FilterParams::default();
        let mut filter = ParticleFilter::new(&params, LIMITS, Some(wrong), &space, rng(seed));
        let mut truth = start;
        let mut late = 0.0_f64;
        for tick in 0..160 {
            truth = drive(truth, 0.4, omega, DT);
            filter.update(&space, &watch, &seen_at(truth, 0.0), DT);
            let belief = filter.belief();
            assert!(distance(&belief, truth) < 1e-6);
            assert!(belief.seen && belief.unseen_for == 0.0);
            if tick >= 100 {
                late += math::angle_difference(belief.mean.theta, truth.theta).abs() / 60.0;
            }
        }
        assert!(late < 0.35, "mean heading error {late}");
    }
}

#[test]
fn a_noisily_seen_target_is_tracked_better_than_it_is_measured() {
    let space = Space::new(&room());
    let watch = watch_from(&space, &[]);
    let mut noise = rng(9);
    let (mut errors, mut raw) = (0.0, 0.0);
    for seed in 0..4 {
        let mut truth = Pose2::new(-3.0, 2.0, 0.0);
        let mut filter = ParticleFilter::new(
            &FilterParams::default(),
            LIMITS,
            Some(truth),
            &space,
            rng(seed),
        );
        for _ in 0..240 {
            truth = drive(truth, 0.4, if truth.x > 2.4 { -0.8 } else { 0.0 }, DT);
            let (nx, ny) = crate::sighting::gaussian_pair(&mut noise);
            let measured = Pose2::new(truth.x + 0.2 * nx, truth.y + 0.2 * ny, 0.0);
            filter.update(&space, &watch, &seen_at(measured, 0.2), DT);
            errors += distance(&filter.belief(), truth);
            raw += (measured.position() - truth.position()).norm();
        }
        assert_eq!(filter.rebuilt(), 0);
    }
    assert!(errors < 0.5 * raw, "{errors} against {raw}");
}

/// The target drives behind the block. The belief keeps mass near it, clears the visible space, and
/// finds it again.
#[test]
fn scattered_hypotheses_catch_up_with_an_opponent_at_full_speed() {
    const SIGMA: f64 = 0.05;
    let space = Space::new(&room());
    let watch = watch_from(&space, &[Pose2::new(2.4, 2.7, 0.0)]);
    // Mean lag over the second half of 2 s (m), and the share of these ticks with the truth within two deviations of it.
    let lag = |scatter: f64| {
        let params = FilterParams {
            scatter,
            ..FilterParams::default()
        };
        let (mut sum, mut within) = (0.0, 0);
        for seed in 0..20 {
            let mut truth = Pose2::new(-2.9, 2.7, 0.0);
            let behind = Pose2::new(-3.05, 2.7, 0.0);
            let mut filter = ParticleFilter::new(&params, LIMITS, Some(behind), &space, rng(seed));
            let mut noise = rng(100 + seed);
            for tick in 0..40 {
                truth = drive(truth, LIMITS.v_max, 0.0, DT);
                let (dx, dy) = crate::sighting::gaussian_pair(&mut noise);
                let seen = Pose2::new(truth.x + SIGMA * dx, truth.y + SIGMA * dy, 0.0);
                filter.update(&space, &watch, &seen_at(seen, SIGMA), DT);
                if tick >= 20 {
                    let belief = filter.belief();
                    let off = truth.x - belief.mean.x;
                    sum += off / 400.0;
                    within += usize::from(off.abs() < 2.0 * belief.covariance_xx.sqrt());
                }
            }
        }
        (sum, within as f64 / 400.0)
    };
    let (lag_without, within_without) = lag(0.0);
    let (lag_with, within_with) = lag(0.3);
    assert!(
        lag_without > 0.015 && within_without < 0.8,
        "{lag_without} m, {within_without}"
    );
    assert!(
        lag_with < 0.5 * lag_without,
        "{lag_with} m, {lag_without} m"
    );
    assert!(
        within_with > within_without + 0.1,
        "{within_with}, {within_without}"
    );
}

#[test]
fn the_belief_keeps_an_occluded_target_and_finds_it_again() {
    let space = Space::new(&room());
    let sensor = SensorParams::default();
    let observer = Pose2::new(3.0, 2.2, 0.0);
    let watch = watch_from(&space, &[observer]);
    let params = FilterParams {
        particles: 2000,
        ..FilterParams::default()
    };
    let mut truth = Pose2::new(-0.6, -2.0, core::f64::consts::PI);
    let mut filter = ParticleFilter::new(&params, LIMITS, Some(truth), &space, rng(5));
    let mut noise = rng(6);
    for tick in 0..400 {
        let turn = if (40..120).contains(&tick) { -0.4 } else { 0.0 };
        let v = if tick < 120 { 0.25 } else { 0.35 };
        truth = drive(truth, v, turn, DT);
        if truth.y > 2.0 {
            truth = Pose2::new(truth.x, 2.0, 0.0);
        }
        let sighting = sense(&sensor, &space, &watch, truth, &mut noise);
        filter.update(&space, &watch, &sighting, DT);
        let belief = filter.belief();
        if belief.unseen_for > 1.0 {
            let near = filter
                .particles()
                .filter(|p| math::hypot(f64::from(p.x) - truth.x, f64::from(p.y) - truth.y) < 0.75)
                .map(|p| p.weight)
                .sum::<f32>();
            // The target drives at half its maximum speed: most hypotheses, which drive at full
            // speed, are elsewhere.
            assert!(near > 0.01, "{near} near the target at tick {tick}");
        }
        if belief.unseen_for > 3.0 {
            assert!(belief.position_std() > 0.1);
            let in_view = filter
                .particles()
                .filter(|p| {
                    let at = Point2::new(f64::from(p.x), f64::from(p.y));
                    space.field().visibility(observer.position(), at) > 0.5
                })
                .count();
            assert!(in_view < 200, "{in_view} of 2000 particles in plain view");
        }
    }
    let belief = filter.belief();
    assert!(
        belief.seen && distance(&belief, truth) < 0.3,
        "{belief:?} {truth:?}"
    );
}

#[test]
fn without_weight_a_sighting_rebuilds_the_belief_around_it() {
    let space = Space::new(&room());
    let watch = watch_from(&space, &[]);
    let start = Pose2::new(-3.0, -2.0, 0.0);
    let mut filter = ParticleFilter::new(
        &FilterParams::default(),
        LIMITS,
        Some(start),
        &space,
        rng(1),
    );
    let elsewhere = Pose2::new(3.0, 2.0, 0.0);
    filter.update(&space, &watch, &seen_at(elsewhere, 0.1), DT);
    assert_eq!(filter.rebuilt(), 1);
    let belief = filter.belief();
    assert!(distance(&belief, elsewhere) < 0.05);
    assert!(
        (0.05..0.25).contains(&belief.position_std()),
        "{}",
        belief.position_std()
    );
    assert!(belief.heading_spread > 0.8, "headings start over");
}

#[test]
fn without_weight_and_sighting_the_reachable_free_space_is_taken() {
    // The target hides in a dead end, which is then closed by a wall.
    let space = Space::new(&room());
    let no_observers = watch_from(&space, &[]);
    let start = Pose2::new(-3.0, 0.0, 0.0);
    let mut free = Grid {
        frame: *space.frame(),
        cells: vec![true; space.frame().len()],
    };
    for (i, cell) in free.cells.iter_mut().enumerate() {
        let p = space.point_in(i as u32, 0.5, 0.5);
        *cell = space.is_valid(p) && !((-3.4..-2.6).contains(&p.x) && (-0.4..0.4).contains(&p.y));
    }
    let changed = Space::new(&BlurredMap::new(&free, 0.15).unwrap());
    // So few that none leaves by a jump.
    let params = FilterParams {
        particles: 20,
        ..FilterParams::default()
    };
    let mut walled = ParticleFilter::new(&params, LIMITS, Some(start), &space, rng(1));
    walled.update(&changed, &no_observers, &Sighting::default(), DT);
    assert_eq!(walled.rebuilt(), 1);
    let reach = 0.5 + 0.5 * DT + 0.05;
    for p in walled.particles() {
        let at = Point2::new(f64::from(p.x), f64::from(p.y));
        assert!(changed.is_valid(at), "{at}");
        assert!((at - start.position()).norm() <= reach, "{at}");
    }
    assert!(walled.belief().position_std() > 0.2);
}

#[test]
fn maps_without_any_free_cell_are_accepted() {
    let frame = GridFrame {
        width: 5,
        height: 5,
        resolution: 0.1,
        origin: Point2::new(0.0, 0.0),
    };
    let map = BlurredMap::new(&Grid::filled(frame, false), 0.1).unwrap();
    let space = Space::new(&map);
    let watch = watch_from(&space, &[Pose2::new(0.2, 0.2, 0.0)]);
    let mut filter = ParticleFilter::new(&FilterParams::default(), LIMITS, None, &space, rng(1));
    for _ in 0..5 {
        filter.update(&space, &watch, &Sighting::default(), DT);
        let belief = filter.belief();
        assert!(belief.mean.is_finite() && belief.effective_sample_size > 0.0);
    }
    assert_eq!(filter.rebuilt(), 5);
}

#[test]
fn the_exit_is_tracked_through() {
    let space = Space::new(&room());
    let watch = watch_from(&space, &[]);
    let mut truth = Pose2::new(3.0, 0.0, 0.0);
    let mut filter = ParticleFilter::new(
        &FilterParams::default(),
        LIMITS,
        Some(truth),
        &space,
        rng(2),
    );
    for _ in 0..38 {
        truth = drive(truth, 0.5, 0.0, DT);
        filter.update(&space, &watch, &seen_at(truth, 0.05), DT);
    }
    assert!(truth.x > 3.9, "in the gap of the wall");
    assert_eq!(filter.rebuilt(), 0);
    assert!(distance(&filter.belief(), truth) < 0.05);
}

#[test]
fn the_same_seed_gives_the_same_bits_and_another_seed_does_not() {
    let run = |seed| {
        let space = Space::new(&room());
        let watch = watch_from(&space, &[Pose2::new(3.0, 2.2, 0.0)]);
        let mut filter =
            ParticleFilter::new(&FilterParams::default(), LIMITS, None, &space, rng(seed));
        for tick in 0..30 {
            let sighting = if tick % 3 == 0 {
                seen_at(Pose2::new(-2.0, 0.5, 0.0), 0.1)
            } else {
                Sighting::default()
            };
            filter.update(&space, &watch, &sighting, DT);
        }
        filter
            .particles()
            .flat_map(|p| [p.x, p.y, p.theta, p.weight].map(f32::to_bits))
            .collect::<Vec<_>>()
    };
    assert_eq!(run(1), run(1));
    assert_ne!(run(1), run(2));
}

#[test]
fn a_measured_heading_weighs_across_the_wrap() {
    let space = Space::new(&room());
    let watch = watch_from(&space, &[]);
    let truth = Pose2::new(-2.4, 0.0, 3.13);
    let mut filter = ParticleFilter::new(&FilterParams::default(), LIMITS, None, &space, rng(5));
    let m = Measurement {
        position: truth.position(),
        sigma: 0.3,
        heading: Some((-3.13, 0.2)),
    };
    for _ in 0..20 {
        let sighting = Sighting {
            visibility: 0.8,
            observer: Some(0),
            measurement: Some(m),
        };
        filter.update(&space, &watch, &sighting, DT);
    }
    let belief = filter.belief();
    let error = math::angle_difference(belief.mean.theta, -3.13).abs();
    assert!(error < 0.2 && belief.heading_spread < 0.05, "{belief:?}");
}

#[test]
fn the_papers_preset_tracks_with_thirty_particles() {
    let space = Space::new(&room());
    let params = PerceptionParams::paper();
    let mut watch = Watch::new(&params.sensor);
    let mut truth = Pose2::new(-3.0, 2.0, 0.0);
    let mut filter = ParticleFilter::new(&params.filter, LIMITS, Some(truth), &space, rng(7));
    let mut noise = rng(8);
    assert_eq!(params.sensor.heading, HeadingModel::Exact);
    for _ in 0..100 {
        truth = drive(truth, 0.4, 0.0, DT);
        watch.set(space.field(), &[Pose2::new(3.0, 2.5, 0.0)]);
        let sighting = sense(&params.sensor, &space, &watch, truth, &mut noise);
        filter.update(&space, &watch, &sighting, DT);
    }
    assert_eq!(filter.len(), 30);
    assert!(distance(&filter.belief(), truth) < 0.2);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    /// Any measurement leaves a valid belief.
    #[test]
    fn any_measurement_leaves_a_valid_belief(
        x in -1e3..1e3_f64, y in prop_oneof![-3.0..3.0_f64, -1e12..1e12_f64],
        sigma in prop_oneof![Just(0.0), 1e-6..10.0_f64],
        heading in proptest::option::of((-10.0..10.0_f64, 0.0..2.0_f64)),
        dt in 1e-4..100.0_f64,
    ) {
        let space = Space::new(&room());
        let watch = watch_from(&space, &[Pose2::new(3.0, 2.2, 0.0), Pose2::new(f64::NAN, 0.0, 0.0)]);
        let mut filter =
            ParticleFilter::new(&FilterParams::default(), LIMITS, None, &space, rng(1));
        let m = Measurement { position: Point2::new(x, y), sigma, heading };
        let seen = Sighting { visibility: 0.5, observer: Some(0), measurement: Some(m) };
        for sighting in [Sighting::default(), seen, Sighting::default(), seen] {
            filter.update(&space, &watch, &sighting, dt);
            let belief = filter.belief();
            prop_assert!(belief.mean.is_finite());
            prop_assert!(belief.covariance_xx >= 0.0 && belief.covariance_yy >= 0.0);
            let total: f64 = filter.particles().map(|p| f64::from(p.weight)).sum();
            prop_assert!((total - 1.0).abs() < 1e-3);
        }
    }
}
