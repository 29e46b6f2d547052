use proptest::prelude::*;
use rand::SeedableRng;
use sim_backend::blur::BlurredMap;
use sim_backend::grid::{Grid, GridFrame};
use sim_backend::math;

use super::*;
use crate::params::{AdaptiveSize, HeadingModel, PerceptionParams, SensorParams};
use crate::sighting::sense;
use crate::space::tests::room;

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
fn exact_sightings_are_taken_over_and_teach_the_heading() {
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
            filter.update(&space, &watch, &seen_at(truth, 0.0), None, DT);
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
            filter.update(&space, &watch, &seen_at(measured, 0.2), None, DT);
            errors += distance(&filter.belief(), truth);
            raw += (measured.position() - truth.position()).norm();
        }
        assert_eq!(filter.rebuilt(), 0);
    }
    assert!(errors < 0.5 * raw, "{errors} against {raw}");
}

/// The target drives behind the block. The belief keeps mass near it, leaves what is in view, and
/// finds it again.
#[test]
fn an_occluded_target_is_kept_in_mind_and_found_again() {
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
    let mut spread_when_seen = 0.0;
    for tick in 0..400 {
        let turn = if (40..120).contains(&tick) { -0.4 } else { 0.0 };
        let v = if tick < 120 { 0.25 } else { 0.35 };
        truth = drive(truth, v, turn, DT);
        if truth.y > 2.0 {
            truth = Pose2::new(truth.x, 2.0, 0.0);
        }
        let sighting = sense(&sensor, &space, &watch, truth, &mut noise);
        filter.update(&space, &watch, &sighting, None, DT);
        let belief = filter.belief();
        if belief.unseen_for > 1.0 {
            let near = filter
                .particles()
                .filter(|p| math::hypot(f64::from(p.x) - truth.x, f64::from(p.y) - truth.y) < 0.75)
                .map(|p| p.weight)
                .sum::<f32>();
            assert!(near > 0.02, "{near} near the target at tick {tick}");
        }
        if belief.unseen_for > 3.0 {
            assert!(belief.position_std() > 2.0 * spread_when_seen);
            let in_view = filter
                .particles()
                .filter(|p| {
                    let at = Point2::new(f64::from(p.x), f64::from(p.y));
                    space.field().visibility(observer.position(), at) > 0.5
                })
                .count();
            assert!(in_view < 200, "{in_view} of 2000 particles in plain view");
        }
        if tick == 10 {
            spread_when_seen = 0.05;
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
    filter.update(&space, &watch, &seen_at(elsewhere, 0.1), None, DT);
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
    // The target hides in a dead end that is then walled up.
    let space = Space::new(&room());
    let nobody = watch_from(&space, &[]);
    let start = Pose2::new(-3.0, 0.0, 0.0);
    let mut filter = ParticleFilter::new(
        &FilterParams::default(),
        LIMITS,
        Some(start),
        &space,
        rng(1),
    );
    for _ in 0..10 {
        filter.update(&space, &nobody, &Sighting::default(), None, DT);
    }
    let mut free = Grid {
        frame: *space.frame(),
        cells: vec![true; space.frame().len()],
    };
    for (i, cell) in free.cells.iter_mut().enumerate() {
        let p = space.point_in(i as u32, 0.5, 0.5);
        *cell = space.is_valid(p) && !((-3.4..-2.6).contains(&p.x) && (-0.4..0.4).contains(&p.y));
    }
    let changed = Space::new(&BlurredMap::new(&free, 0.15).unwrap());
    // No particle may have escaped by a jump.
    let params = FilterParams {
        teleport_rate: 0.0,
        ..FilterParams::default()
    };
    let mut walled = ParticleFilter::new(&params, LIMITS, Some(start), &space, rng(1));
    for _ in 0..10 {
        walled.update(&space, &nobody, &Sighting::default(), None, DT);
    }
    walled.update(&changed, &nobody, &Sighting::default(), None, DT);
    assert_eq!(walled.rebuilt(), 1);
    let reach = 0.5 + 0.5 * 11.0 * DT + 0.05;
    for p in walled.particles() {
        let at = Point2::new(f64::from(p.x), f64::from(p.y));
        assert!(changed.is_valid(at), "{at}");
        assert!((at - start.position()).norm() <= reach, "{at}");
    }
    assert!(walled.belief().position_std() > 0.2);
}

#[test]
fn maps_without_any_free_cell_do_no_harm() {
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
        filter.update(&space, &watch, &Sighting::default(), None, DT);
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
        filter.update(&space, &watch, &seen_at(truth, 0.05), None, DT);
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
            filter.update(&space, &watch, &sighting, None, DT);
        }
        filter
            .particles()
            .flat_map(|p| [p.x, p.y, p.theta, p.weight].map(f32::to_bits))
            .collect::<Vec<_>>()
    };
    assert_eq!(run(1), run(1));
    assert_ne!(run(1), run(2));
}

/// Spread and clearing after three seconds out of sight, at 10, 20 and 80 Hz.
#[test]
fn the_belief_does_not_depend_on_the_tick_rate() {
    let space = Space::new(&room());
    let hidden_watch = watch_from(&space, &[]);
    let looking = watch_from(&space, &[Pose2::new(-3.0, 2.75, 0.0)]);
    let run = |rate: usize, watch: &Watch, start: Pose2, seconds: f64| {
        let params = FilterParams {
            particles: 20_000,
            ..FilterParams::default()
        };
        let mut filter = ParticleFilter::new(&params, LIMITS, Some(start), &space, rng(11));
        for _ in 0..(seconds * rate as f64) as usize {
            filter.update(&space, watch, &Sighting::default(), None, 1.0 / rate as f64);
        }
        filter.belief()
    };
    let start = Pose2::new(-2.4, 0.0, 1.0);
    let beliefs = [10, 20, 80].map(|rate| run(rate, &hidden_watch, start, 3.0));
    for b in beliefs {
        let reference = beliefs[1];
        let ratio = b.position_std() / reference.position_std();
        assert!((ratio - 1.0).abs() < 0.05, "spread ratio {ratio}");
        assert!((b.mean.position() - reference.mean.position()).norm() < 0.05);
        assert!((b.heading_spread - reference.heading_spread).abs() < 0.05);
    }
    // Half in view of an observer whose view is dim: the factor 1 − V acts per second.
    let start = Pose2::new(1.2, 1.5, 0.0);
    let beliefs = [10, 20, 80].map(|rate| run(rate, &looking, start, 2.0));
    for b in beliefs {
        let shift = (b.mean.position() - beliefs[1].mean.position()).norm();
        assert!(shift < 0.12, "{shift}");
    }
}

#[test]
fn hypotheses_stay_within_the_targets_limits() {
    let space = Space::new(&room());
    let watch = watch_from(&space, &[]);
    for reflect in [true, false] {
        for dt in [0.01, 0.05, 5.0] {
            let params = FilterParams {
                reflect,
                ..FilterParams::default()
            };
            let mut filter = ParticleFilter::new(&params, LIMITS, None, &space, rng(3));
            for _ in 0..40 {
                filter.update(&space, &watch, &Sighting::default(), None, dt);
                let p = &filter.particles;
                assert!(p.v.iter().all(|v| (-0.05..=0.5).contains(v)));
                assert!(p.omega.iter().all(|w| (-1.0..=1.0).contains(w)));
                assert!(p.heading.iter().all(|h| h.abs() <= 3.141_6));
            }
        }
    }
}

/// 0.25 per second over 2 s: 39 % have jumped. A hypothesis that cannot move shows it.
#[test]
fn teleports_come_at_their_rate() {
    let space = Space::new(&room());
    let watch = watch_from(&space, &[]);
    let still = MotionLimits {
        v_max: 0.0,
        v_reverse_max: 0.0,
        omega_max: 0.0,
    };
    let start = Pose2::new(-2.4, 0.0, 0.0);
    for rate in [5, 20, 100] {
        let params = FilterParams {
            particles: 20_000,
            teleport_distance: 0.3,
            ..FilterParams::default()
        };
        let mut filter = ParticleFilter::new(&params, still, Some(start), &space, rng(4));
        for _ in 0..2 * rate {
            filter.update(
                &space,
                &watch,
                &Sighting::default(),
                None,
                1.0 / f64::from(rate),
            );
        }
        let moved = filter.particles().filter(|p| p.x != -2.4).count();
        let share = moved as f64 / 20_000.0;
        assert!(
            (share - (1.0 - math::exp(-0.5))).abs() < 0.015,
            "{share} at {rate} Hz"
        );
    }
}

#[test]
fn unseen_weights_are_one_minus_the_best_visibility() {
    let space = Space::new(&room());
    let observers = [
        Pose2::new(3.0, 2.2, 0.0),
        Pose2::new(-3.0, -2.2, 0.0),
        Pose2::new(2.0, -1.5, 0.0),
    ];
    let watch = watch_from(&space, &observers);
    let mut filter = ParticleFilter::new(&FilterParams::default(), LIMITS, None, &space, rng(8));
    // Some in walls and outside.
    filter.particles.x[0] = 0.0;
    filter.particles.y[0] = 0.0;
    filter.particles.x[1] = 50.0;
    filter.particles.x[2] = f32::NAN;
    let n = filter.len();
    let mut weights = vec![0.5; n];
    let unseen = Unseen {
        space: &space,
        watch: &watch,
        exponent: 1.0,
    };
    let mut places = vec![0; n];
    unseen.weigh(
        &filter.particles.stretch(0..n),
        &mut weights,
        None,
        &mut places,
    );
    assert_eq!(weights[..3], [0.0; 3]);
    for (p, &w) in filter.particles().zip(&weights) {
        let at = Point2::new(f64::from(p.x), f64::from(p.y));
        let best = observers
            .iter()
            .map(|o| space.field().visibility(o.position(), at))
            .fold(0.0, f64::max);
        let expected = if space.is_valid(at) {
            0.5 * (1.0 - best)
        } else {
            0.0
        };
        assert!(
            (f64::from(w) - expected).abs() < 1e-6,
            "{w} against {expected} at {at}"
        );
    }
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
        filter.update(&space, &watch, &sighting, None, DT);
    }
    let belief = filter.belief();
    let error = math::angle_difference(belief.mean.theta, -3.13).abs();
    assert!(error < 0.1 && belief.heading_spread < 0.05, "{belief:?}");
}

#[test]
fn the_sample_size_follows_the_spread() {
    let space = Space::new(&room());
    let watch = watch_from(&space, &[]);
    let adaptive = AdaptiveSize {
        least: 100,
        most: 5000,
        ..AdaptiveSize::default()
    };
    let params = FilterParams {
        adaptive: Some(adaptive),
        ..FilterParams::default()
    };
    let truth = Pose2::new(-2.4, 0.0, 0.0);
    let mut filter = ParticleFilter::new(&params, LIMITS, Some(truth), &space, rng(6));
    for _ in 0..40 {
        filter.update(&space, &watch, &seen_at(truth, 0.02), None, DT);
    }
    let known = filter.len();
    for _ in 0..200 {
        filter.update(&space, &watch, &Sighting::default(), None, DT);
    }
    let lost = filter.len();
    for _ in 0..40 {
        filter.update(&space, &watch, &seen_at(truth, 0.02), None, DT);
    }
    let found = filter.len();
    assert!(
        lost > 3 * known && found < lost / 3,
        "{known} {lost} {found}"
    );
    assert!((100..=5000).contains(&lost));
    let total: f32 = filter.particles().map(|p| p.weight).sum();
    assert!((total - 1.0).abs() < 1e-3);
}

#[test]
fn weights_persist_until_the_effective_sample_size_is_low() {
    let space = Space::new(&room());
    let watch = watch_from(&space, &[]);
    let params = FilterParams {
        resample_below: 0.5,
        ..FilterParams::default()
    };
    let truth = Pose2::new(-2.4, 0.0, 0.0);
    let mut filter = ParticleFilter::new(&params, LIMITS, Some(truth), &space, rng(6));
    let (mut kept, mut resampled) = (0, 0);
    for _ in 0..100 {
        filter.update(&space, &watch, &seen_at(truth, 0.15), None, DT);
        let first = filter.particles().next().unwrap().weight;
        if filter.particles().all(|p| p.weight == first) {
            resampled += 1;
        } else {
            kept += 1;
            assert!(filter.belief().effective_sample_size >= 0.5 * filter.len() as f64);
        }
        let total: f32 = filter.particles().map(|p| p.weight).sum();
        assert!((total - 1.0).abs() < 1e-3, "{total}");
    }
    assert!(kept > 20 && resampled > 3, "{kept} {resampled}");
    assert!(distance(&filter.belief(), truth) < 0.1);
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
        filter.update(&space, &watch, &sighting, None, DT);
    }
    assert_eq!(filter.len(), 30);
    assert!(distance(&filter.belief(), truth) < 0.2);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    /// Whatever is reported, the belief stays a belief.
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
            filter.update(&space, &watch, &sighting, None, dt);
            let belief = filter.belief();
            prop_assert!(belief.mean.is_finite());
            prop_assert!(belief.covariance_xx >= 0.0 && belief.covariance_yy >= 0.0);
            let total: f64 = filter.particles().map(|p| f64::from(p.weight)).sum();
            prop_assert!((total - 1.0).abs() < 1e-3);
        }
    }
}
