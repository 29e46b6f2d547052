//! Properties for all keys.

use proptest::prelude::*;

use super::*;

fn key() -> impl Strategy<Value = Key> {
    any::<u64>().prop_map(|seed| Key::from_seed(chaotic_maps::KeyKind::Keyed, seed))
}

/// Coordinates of additional waypoints relative to their nominal position, in units of α: along the
/// segment and to its left.
fn offsets(mode: Mode, segment: usize, laps: u32) -> Vec<(f64, f64)> {
    let awg = awg(&octagon(), 120.0, 1.7, mode);
    let mut generator = catp();
    let mut waypoints = Vec::new();
    let mut found = Vec::new();
    for lap in 0..laps {
        waypoints.clear();
        awg.lap_into(lap, &mut generator, &mut waypoints);
        let leg = &awg.legs(lap)[segment];
        let along = leg.stretch.segment.along;
        let own = &waypoints[leg.waypoints_before as usize..];
        found.extend(own.iter().zip(1..=leg.inserted).map(|(w, j)| {
            let offset = (w.point - leg.nominal(j, awg.v())) / 1.7;
            (offset.dot(&along), along.perp(&offset))
        }));
    }
    found
}

#[test]
fn the_zig_zag_is_symmetric_about_every_segment_in_both_frames() {
    for frame in [Frame::Atan2, Frame::Atan] {
        let rounding = Rounding::Floor;
        for segment in 0..8 {
            let found = offsets(Mode { rounding, frame }, segment, 500);
            let mean = found.iter().map(|o| o.1).sum::<f64>() / found.len() as f64;
            assert!(mean.abs() < 0.02, "{frame:?}, segment {segment}: {mean}");
            assert!(found.iter().all(|o| o.1.abs() <= 0.5 + 1e-9));
        }
    }
}

#[test]
fn waypoints_lead_with_atan2_and_lag_with_atan_on_segments_towards_smaller_x() {
    for segment in 0..8 {
        let rounding = Rounding::Floor;
        let lead = |frame| {
            let found = offsets(Mode { rounding, frame }, segment, 200);
            let low = found.iter().map(|o| o.0).fold(f64::INFINITY, f64::min);
            let high = found.iter().map(|o| o.0).fold(f64::NEG_INFINITY, f64::max);
            (
                low,
                high,
                found.iter().map(|o| o.0).sum::<f64>() / found.len() as f64,
            )
        };
        let (low, high, mean) = lead(Frame::Atan2);
        assert!(low >= -1e-9 && high < 1.0 && (mean - 0.5).abs() < 0.03);
        // Segments 1, 7 and 8 of the octagon.
        let sign = if matches!(segment, 0 | 6 | 7) {
            -1.0
        } else {
            1.0
        };
        let (_, _, mean) = lead(Frame::Atan);
        assert!(
            (mean * sign - 0.5).abs() < 0.03,
            "segment {segment}: {mean}"
        );
    }
}

proptest! {
    #[test]
    fn every_lap_visits_the_route_in_order_and_stays_in_its_band(
        key in key(),
        alpha in 0.01..4.0,
        t_max in 20.0..400.0,
    ) {
        let awg = awg(&octagon(), t_max, alpha, Mode::default());
        let mut generator = key.source().unwrap();
        for lap in 0..3 {
            let mut waypoints = Vec::new();
            awg.lap_into(lap, &mut generator, &mut waypoints);
            prop_assert_eq!(waypoints.len() as u64, awg.waypoints_per_lap());
            let route: Vec<_> = waypoints
                .iter()
                .filter(|w| w.kind == WaypointKind::Route)
                .map(|w| w.point)
                .collect();
            let contour = octagon();
            prop_assert_eq!(&route[..], &contour.points()[1..]);
            for leg in awg.legs(lap) {
                let own = &waypoints[leg.waypoints_before as usize..];
                for w in own.iter().take(leg.inserted as usize) {
                    let from = w.point - leg.stretch.segment.from;
                    let side = leg.stretch.segment.along.perp(&from);
                    prop_assert!(side.abs() <= 0.5 * alpha + 1e-9);
                }
            }
        }
    }

    #[test]
    fn a_contour_turned_by_any_angle_has_the_zig_zag_turned_with_it(
        key in key(),
        angle in -3.0..3.0_f64,
    ) {
        let (sin, cos) = (geometry::math::sin(angle), geometry::math::cos(angle));
        let turn = |p: &Point2<f64>| Point2::new(cos * p.x - sin * p.y, sin * p.x + cos * p.y);
        let turned: Vec<_> = octagon().points().iter().map(turn).collect();
        // The last corner again, not the first one rotated once more.
        let turned = Contour::closed(&turned).unwrap();
        let here = awg(&octagon(), 120.0, 1.7, Mode::default());
        let there = awg(&turned, 120.0, 1.7, Mode::default());
        let mut generator = key.source().unwrap();
        let path = here.lap_track(0, &mut generator.clone());
        let other = there.lap_track(0, &mut generator);
        for (p, q) in path.points().iter().zip(other.points()) {
            prop_assert!((turn(p) - q).norm() < 1e-9);
        }
    }
}
