//! Five readings from a range scan of any geometry.

use core::f64::consts::{FRAC_PI_2, FRAC_PI_4};

use geometry::math;
use planner_view::view::ScanView;

/// Lower bound of ranges (m): the vehicle divides by them.
const MIN_RANGE: f64 = 1.0e-3;

/// Reading of each cone (m); `None` where the scan has no usable beam.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Cones {
    /// Straight ahead.
    pub front: Option<f64>,
    /// At +45°.
    pub front_left: Option<f64>,
    /// At −45°.
    pub front_right: Option<f64>,
    /// At +90°.
    pub left: Option<f64>,
    /// At −90°.
    pub right: Option<f64>,
}

/// Reads the cones of a scan.
///
/// A cone is `width` (rad) wide; its reading is the given percentile (in [0, 1], with linear
/// interpolation between beams) of its beams' ranges. If a scan is so coarse that no beam lies in a
/// cone, the reading is that of the beam next to the cone's axis, within one beam spacing.
///
/// Following REP-117, +∞ (nothing in reach) reads as the longest range, −∞ (too close) as the
/// shortest; NaN beams do not count. `scratch` is working memory.
pub fn read(scan: &ScanView<'_>, width: f64, percentile: f64, scratch: &mut Vec<f64>) -> Cones {
    let usable = scan.angle_min.is_finite()
        && scan.angle_increment.is_finite()
        && scan.range_max.is_finite()
        && scan.range_max > 0.0;
    if !usable {
        return Cones::default();
    }
    let mut cone = |axis: f64| reading(scan, axis, width, percentile, scratch);
    Cones {
        front: cone(0.0),
        front_left: cone(FRAC_PI_4),
        front_right: cone(-FRAC_PI_4),
        left: cone(FRAC_PI_2),
        right: cone(-FRAC_PI_2),
    }
}

fn reading(
    scan: &ScanView<'_>,
    axis: f64,
    width: f64,
    percentile: f64,
    scratch: &mut Vec<f64>,
) -> Option<f64> {
    scratch.clear();
    let mut nearest: Option<(f64, f64)> = None;
    // Tolerates rounding errors of beam angles on the cone's edge.
    let half = 0.5 * width + 1e-6;
    for (beam, &range) in scan.ranges.iter().enumerate() {
        let Some(range) = usable(range, scan) else {
            continue;
        };
        let angle = scan.angle_min + scan.angle_increment * beam as f64;
        let off = math::angle_difference(angle, axis).abs();
        if off <= half {
            scratch.push(range);
        }
        if nearest.is_none_or(|(best, _)| off < best) {
            nearest = Some((off, range));
        }
    }
    if scratch.is_empty() {
        let (off, range) = nearest?;
        return (off < scan.angle_increment.abs()).then_some(range);
    }
    scratch.sort_unstable_by(f64::total_cmp);
    let last = scratch.len() - 1;
    let place = percentile.clamp(0.0, 1.0) * last as f64;
    let (low, high) = (place.floor() as usize, place.ceil() as usize);
    let (low, high, share) = (scratch.get(low)?, scratch.get(high)?, place - place.floor());
    Some(low + (high - low) * share)
}

fn usable(range: f32, scan: &ScanView<'_>) -> Option<f64> {
    // `max` and `min` clamp both infinities but ignore NaN, hence the test.
    (!range.is_nan()).then(|| {
        let shortest = if scan.range_min.is_finite() {
            scan.range_min
        } else {
            0.0
        };
        f64::from(range)
            .max(shortest)
            .max(MIN_RANGE)
            .min(scan.range_max)
    })
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn scan(ranges: &[f32], angle_min: f64, angle_increment: f64) -> ScanView<'_> {
        ScanView {
            angle_min,
            angle_increment,
            range_min: 0.12,
            range_max: 3.5,
            ranges,
        }
    }

    fn read_all(scan: &ScanView<'_>) -> Cones {
        read(scan, 10.0_f64.to_radians(), 0.1, &mut Vec::new())
    }

    #[test]
    fn each_cone_reads_its_own_direction_whatever_the_first_beam() {
        let degree = 1.0_f64.to_radians();
        for first in [0_i32, -180, 90] {
            let ranges: Vec<f32> = (0..360)
                .map(|i| match (first + i).rem_euclid(360) {
                    0..=20 | 340..=359 => 1.0,
                    21..=70 => 1.5,
                    71..=110 => 2.0,
                    250..=289 => 2.5,
                    290..=339 => 3.0,
                    _ => 0.2,
                })
                .collect();
            let cones = read_all(&scan(&ranges, f64::from(first) * degree, degree));
            assert_eq!(
                [
                    cones.front,
                    cones.front_left,
                    cones.left,
                    cones.right,
                    cones.front_right
                ],
                [Some(1.0), Some(1.5), Some(2.0), Some(2.5), Some(3.0)]
            );
        }
    }

    #[test]
    fn a_cone_reads_the_percentile_of_its_beams() {
        let mut ranges = vec![3.0_f32; 360];
        // The cone has 11 beams, so its 10th percentile is its second shortest.
        ranges[2] = 0.5;
        let degree = 1.0_f64.to_radians();
        assert_eq!(read_all(&scan(&ranges, 0.0, degree)).front, Some(3.0));
        ranges[358] = 0.7;
        assert!((read_all(&scan(&ranges, 0.0, degree)).front.unwrap() - 0.7).abs() < 1e-6);
    }

    #[test]
    fn infinite_beams_are_open_or_too_close_and_nan_beams_do_not_count() {
        let degree = 1.0_f64.to_radians();
        assert_eq!(
            read_all(&scan(&[f32::INFINITY; 360], 0.0, degree)).left,
            Some(3.5)
        );
        assert_eq!(
            read_all(&scan(&[f32::NEG_INFINITY; 360], 0.0, degree)).left,
            Some(0.12)
        );
        assert_eq!(
            read_all(&scan(&[f32::NAN; 360], 0.0, degree)),
            Cones::default()
        );
        assert_eq!(read_all(&scan(&[], 0.0, degree)), Cones::default());
        assert_eq!(
            read_all(&scan(&[1.0; 360], f64::NAN, degree)),
            Cones::default()
        );
    }

    #[test]
    fn a_coarse_scan_is_read_at_the_nearest_beam_and_a_narrow_one_has_no_sides() {
        // Eight beams, none within 5° of an axis.
        let eighth = 45.0_f64.to_radians();
        let ranges = [1.0, 2.0, 3.0, 0.5, 0.5, 0.5, 3.0, 2.5];
        let cones = read_all(&scan(&ranges, 0.15, eighth));
        assert_eq!((cones.front, cones.front_left), (Some(1.0), Some(2.0)));
        // 60° ahead only.
        let degree = 1.0_f64.to_radians();
        let cones = read_all(&scan(&[2.0; 61], -30.0 * degree, degree));
        assert_eq!(cones.front, Some(2.0));
        assert_eq!(
            (cones.left, cones.right, cones.front_left),
            (None, None, None)
        );
    }

    proptest! {
        #[test]
        fn readings_are_finite_and_positive_for_any_scan(
            ranges in prop::collection::vec(prop::num::f32::ANY, 0..50),
            angle_min in prop::num::f64::ANY,
            angle_increment in prop::num::f64::ANY,
            range_min in prop::num::f64::ANY,
            range_max in prop::num::f64::ANY,
        ) {
            let scan = ScanView { angle_min, angle_increment, range_min, range_max, ranges: &ranges };
            let cones = read_all(&scan);
            for reading in [cones.front, cones.front_left, cones.front_right, cones.left, cones.right] {
                prop_assert!(reading.is_none_or(|r| r.is_finite() && r > 0.0), "{:?}", reading);
            }
        }
    }
}
