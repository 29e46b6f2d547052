//! The published program's traits.

use geometry::math;

use super::super::*;
use super::{DT, LIMITS, rng, watch_from};
use crate::params::PerceptionParams;
use crate::space::tests::room;

/// A sighting with the exact heading, as in the preset.
fn seen(x: f64, y: f64, sigma: f64, heading: f64) -> Sighting {
    Sighting {
        visibility: 0.9,
        observer: Some(0),
        measurement: Some(Measurement {
            position: Point2::new(x, y),
            sigma,
            heading: Some((heading, 0.0)),
        }),
    }
}

fn filter(space: &Space, start: Option<Pose2>) -> ParticleFilter {
    ParticleFilter::new(
        &PerceptionParams::paper().filter,
        LIMITS,
        start,
        space,
        rng(3),
    )
}

fn headings(filter: &ParticleFilter) -> Vec<f32> {
    filter.particles().map(|p| p.theta).collect()
}

#[test]
fn with_the_papers_preset_a_noisy_sighting_does_not_give_every_particle_the_true_heading() {
    let space = Space::new(&room());
    let watch = watch_from(&space, &[]);
    let mut filter = filter(&space, None);
    filter.update(&space, &watch, &seen(-2.0, 0.0, 0.5, 1.0), DT);
    let after = headings(&filter);
    assert!(after.iter().all(|&theta| (theta - 1.0).abs() > 1e-6));
    assert!(after.iter().any(|theta| *theta != after[0]), "{after:?}");
    // An exact one does.
    filter.update(&space, &watch, &seen(-2.0, 0.0, 0.005, 1.0), DT);
    assert_eq!(headings(&filter), [1.0; 30]);
    for p in filter.particles() {
        assert_eq!((p.x, p.y), (-2.0, 0.0));
    }
}

#[test]
fn noisy_sightings_weigh_by_position_and_the_inverse_of_the_heading_error() {
    let space = Space::new(&room());
    let mut particles = Cloud::default();
    particles.resize(4);
    particles.x.copy_from_slice(&[-2.0, -2.3, -2.0, 0.0]);
    particles.heading.copy_from_slice(&[1.0, 1.0, -3.0, 1.0]);
    let weights = |sigma, x| {
        let mut weights = [0.5; 4];
        let m = seen(x, 0.0, sigma, 3.0).measurement.unwrap();
        published::weigh(&space, &particles, &m, &mut weights);
        weights
    };
    let [first, beside, wrapped, inside] = weights(0.2, -2.0);
    // The third has the smallest error: 2π − 6 across the wrap. The fourth is in the block.
    let error = core::f64::consts::TAU - 6.0;
    assert_eq!((wrapped, inside), (1.0, 0.0));
    assert!((f64::from(first) - (1.0 + error) / 3.0).abs() < 1e-6);
    let gauss = math::exp(-0.3 * 0.3 / (2.0 * 0.2 * 0.2));
    assert!((f64::from(beside / first) - gauss).abs() < 1e-5);
    // Twenty standard deviations away the nearest particle still counts, fifty away none does.
    assert_eq!(weights(0.1, -4.3)[1], 1.0);
    assert_eq!(weights(0.03, -4.3), [0.0; 4]);
    // An exact sighting weighs all possible particles alike.
    assert_eq!(weights(0.005, 3.0), [1.0, 1.0, 1.0, 0.0]);
}

#[test]
fn without_weight_all_particles_of_the_papers_preset_become_the_first() {
    let space = Space::new(&room());
    let watch = watch_from(&space, &[]);
    let mut filter = filter(&space, None);
    // Too far away for every particle.
    filter.update(&space, &watch, &seen(1e3, 0.0, 0.1, 0.0), DT);
    let xs: Vec<f32> = filter.particles().map(|p| p.x).collect();
    assert!(xs.iter().all(|&x| x == xs[0]), "{xs:?}");
    assert_eq!(filter.rebuilt(), 0);
    assert_eq!(filter.belief().effective_sample_size, 1.0);
}

#[test]
fn hypotheses_of_the_papers_preset_crawl_at_a_fifth_of_the_speed() {
    let params = PerceptionParams::paper().filter;
    let fast = MotionLimits {
        omega_max: 2.84,
        ..LIMITS
    };
    let limits = params.narrowed(fast);
    assert_eq!(limits.v_max, 0.1);
    assert!((limits.v_reverse_max - 0.01).abs() < 1e-12);
    assert_eq!(limits.omega_max, 0.5);
    assert_eq!(FilterParams::default().narrowed(fast), fast);
}
