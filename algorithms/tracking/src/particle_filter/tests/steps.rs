//! The single steps: motion, jumps, weights.

use geometry::math;

use geometry::blur::BlurredMap;
use geometry::grid::{Grid, GridFrame};

use super::super::*;
use super::{DT, LIMITS, distance, drive, rng, seen_at, watch_from};
use crate::space::tests::room;
use parameters::Fidelity;

/// Spread and clearing after three seconds out of sight, at 10, 20 and 80 Hz.
#[test]
fn the_belief_does_not_depend_on_the_tick_rate() {
    let space = Space::new(&room());
    let hidden_watch = watch_from(&space, &[]);
    let looking = watch_from(&space, &[Pose2::new(-3.0, 2.75, 0.0)]);
    let run = |rate: usize, watch: &Watch, start: Pose2, seconds: f64, seed: u64| {
        let params = FilterParams {
            particles: 20_000,
            ..FilterParams::default()
        };
        let mut filter = ParticleFilter::new(&params, LIMITS, Some(start), &space, rng(seed));
        for _ in 0..(seconds * rate as f64) as usize {
            filter.update(&space, watch, &Sighting::default(), 1.0 / rate as f64);
        }
        filter.belief()
    };
    let start = Pose2::new(-2.4, 0.0, 1.0);
    let beliefs = [10, 20, 80].map(|rate| run(rate, &hidden_watch, start, 3.0, 11));
    for b in beliefs {
        let reference = beliefs[1];
        let ratio = b.position_std() / reference.position_std();
        assert!((ratio - 1.0).abs() < 0.05, "spread ratio {ratio}");
        assert!((b.mean.position() - reference.mean.position()).norm() < 0.05);
        assert!((b.heading_spread - reference.heading_spread).abs() < 0.05);
    }
    // Half in view of an observer with low visibility: the factor 1 − V acts per second.
    let start = Pose2::new(1.2, 1.5, 0.0);
    let means = [10, 20, 80].map(|rate| {
        let sum = (0..6).map(|seed| run(rate, &looking, start, 2.0, seed).mean.position().coords);
        sum.sum::<nalgebra::Vector2<f64>>() / 6.0
    });
    for mean in means {
        // One run varies by 0.06 m.
        assert!((mean - means[1]).norm() < 0.08, "{means:?}");
    }
}

#[test]
fn hypotheses_stay_within_the_targets_limits() {
    let space = Space::new(&room());
    let watch = watch_from(&space, &[]);
    for fidelity in [Fidelity::Ours, Fidelity::Published] {
        for dt in [0.01, 0.05, 5.0] {
            let params = FilterParams {
                fidelity,
                ..FilterParams::default()
            };
            let mut filter = ParticleFilter::new(&params, LIMITS, None, &space, rng(3));
            for _ in 0..40 {
                let n = filter.len();
                let (motion, before) = (Motion::new(&params, LIMITS, dt), filter.particles.clone());
                let noise: Vec<u8> = (0..4 * n).map(|i| (i * 37 + i / 256) as u8).collect();
                motion.apply(filter.particles.stretch(0..n), &noise);
                let p = &filter.particles;
                for i in 0..n {
                    let step = math::hypot(
                        f64::from(p.x[i] - before.x[i]),
                        f64::from(p.y[i] - before.y[i]),
                    );
                    let turn = f64::from(crate::fast::wrap(p.heading[i] - before.heading[i]));
                    assert!(step <= 0.5 * dt + 1e-5, "{step}");
                    assert!(dt > 1.0 || turn.abs() <= 1.0 * dt + 1e-5, "{turn}");
                    assert!(p.heading[i].abs() <= core::f32::consts::PI + 1e-5);
                    let forwards = f64::from(p.v[i]) >= 0.0;
                    assert!(forwards || step <= 0.05 * dt + 1e-5, "backwards by {step}");
                }
                filter.update(&space, &watch, &Sighting::default(), dt);
            }
        }
    }
}

/// 0.25 per second over 2 s: 39 % have jumped. A hypothesis that cannot move shows the jumps.
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
            ..FilterParams::default()
        };
        let mut filter = ParticleFilter::new(&params, still, Some(start), &space, rng(4));
        for _ in 0..2 * rate {
            filter.update(&space, &watch, &Sighting::default(), 1.0 / f64::from(rate));
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
    let unseen = UnseenLikelihood {
        space: &space,
        watch: &watch,
        exponent: 1.0,
    };
    unseen.weigh(&filter.particles.stretch(0..n), &mut weights);
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

/// A street of 12 m × 1 m along x with its left end at x = 0.
fn street() -> Space {
    let frame = GridFrame {
        width: 280,
        height: 60,
        resolution: 0.05,
        origin: nalgebra::Point2::new(-1.0, -1.5),
    };
    let mut free = Grid::filled(frame, false);
    for row in 0..frame.height {
        for col in 0..frame.width {
            let p = frame.center(col, row);
            free.cells[frame.index(col, row)] = p.y.abs() < 0.5 && (0.0..12.0).contains(&p.x);
        }
    }
    Space::new(&BlurredMap::new(&free, 0.1).unwrap())
}

#[test]
fn an_opponent_that_drives_on_unseen_stays_within_the_belief() {
    let space = street();
    let watch = watch_from(&space, &[]);
    // For a robot that can turn on the spot, free random walks of the turning rate would circle in
    // place.
    let agile = MotionLimits {
        v_max: 0.45,
        v_reverse_max: 0.22,
        omega_max: 2.84,
    };
    // Mean error, deviation and distance of the nearest hypothesis after ten seconds.
    let lose = |params: &FilterParams, seed| {
        let start = Pose2::new(1.0, 0.0, 0.0);
        let mut filter = ParticleFilter::new(params, agile, Some(start), &space, rng(seed));
        let mut truth = start;
        for tick in 0..240 {
            truth = drive(truth, 0.45, 0.0, DT);
            let sighting = if tick < 40 {
                seen_at(truth, 0.02)
            } else {
                Sighting::default()
            };
            filter.update(&space, &watch, &sighting, DT);
        }
        let belief = filter.belief();
        let nearest = filter
            .particles()
            .map(|p| math::hypot(f64::from(p.x) - truth.x, f64::from(p.y) - truth.y))
            .fold(f64::INFINITY, f64::min);
        (distance(&belief, truth), belief.position_std(), nearest)
    };
    let free_walk = FilterParams {
        cruise_rate: 0.0,
        straighten_rate: 0.0,
        turn_at_walls: false,
        ..FilterParams::default()
    };
    for seed in 0..4 {
        let (error, deviation, nearest) = lose(&FilterParams::default(), seed);
        assert!(
            error < 3.0 * deviation,
            "{seed}: {error} against {deviation}"
        );
        assert!(nearest < 0.75, "{seed}: {nearest}");
        let (error_free, ..) = lose(&free_walk, seed);
        assert!(
            error < 0.8 * error_free,
            "{seed}: {error} against {error_free}"
        );
    }
}
