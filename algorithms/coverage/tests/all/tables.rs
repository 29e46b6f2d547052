//! Coverage of the Chebyshev paper's three workplaces by exact keys: figures from an independent
//! implementation (rates to ± 2 cells, integers exactly).

use chaotic_maps::{AnySource, ChebP, Emission, Source};
use coverage::decomposition::Decomposition;
use coverage::plan::{CoveragePlan, PlanSpec, map};
use coverage::tour::{Iterations, Route};
use coverage::transit::Transit;
use coverage::workplace::Workplace;
use geometry::shape::{Aabb, Convex};
use metrics::coverage::{Figures, Meter, Rate};
use nalgebra::Point2;

use Emission::{Arcsine, Raw};

/// Distance between points of the path (m).
const STEP: f64 = 0.125;

fn key(emission: Emission) -> AnySource {
    let key = ChebP::new(123_456_789_012_345_678, 987_654_321_098_765_432, emission);
    AnySource::ChebP(key.unwrap())
}

fn workplace(obstacles: &[[f64; 4]]) -> Workplace {
    let rectangle = |&[x0, y0, x1, y1]: &[f64; 4]| Aabb {
        min: Point2::new(x0, y0),
        max: Point2::new(x1, y1),
    };
    let parts: Vec<Convex> = obstacles.iter().map(rectangle).map(Convex::Box).collect();
    Workplace::from_parts(rectangle(&[0.0, 0.0, 10.0, 10.0]), 0.1, &parts, 0.1).unwrap()
}

fn within_two_cells(rate: Rate, expected: f64) {
    let cells = rate.covered as f64 - expected * rate.coverable as f64;
    assert!(
        cells.abs() <= 2.0,
        "{rate:?} is {cells} cells off {expected}"
    );
}

fn relative(found: f64, expected: f64) {
    assert!(
        (found / expected - 1.0).abs() < 1e-6,
        "{found} for {expected}"
    );
}

#[test]
fn the_open_workplace_is_covered_as_known() {
    let workplace = workplace(&[]);
    // Length (m); goals at 0.5 m; path at 0.1, 0.25 and 0.5 m; disc.
    let rows = [
        (
            Arcsine,
            1_134.100_6,
            [0.3775, 0.5443, 0.8187, 0.9275, 0.7856],
        ),
        (Raw, 1_380.904_2, [0.3275, 0.6555, 0.9375, 0.9825, 0.9041]),
    ];
    for (emission, length, rates) in rows {
        let mut meter = Meter::new(&workplace.domain().unwrap(), STEP).unwrap();
        let mut source = key(emission);
        for _ in 0..200 {
            meter.goal(map(source.next_symmetric(), &workplace.inner()));
        }
        let f = meter.figures();
        relative(f.length, length);
        let found = [f.goals[2], f.path[0], f.path[1], f.path[2], f.disc];
        for (rate, expected) in found.into_iter().zip(rates) {
            within_two_cells(rate, expected);
        }
    }
}

/// Drives a route from (1, 8) with waiting transits; asserts that every leg stays clear of the
/// obstacles.
fn drive(
    workplace: &Workplace,
    decomposition: Decomposition,
    spec: &PlanSpec,
    emission: Emission,
) -> (u64, Figures) {
    let start = Point2::new(1.0, 8.0);
    let mut plan = CoveragePlan::new(decomposition, start, spec, key(emission)).unwrap();
    let mut meter = Meter::new(&workplace.domain().unwrap(), STEP).unwrap();
    meter.goal(start);
    let (mut goals, mut last) = (0, start);
    while let Some(goal) = plan.step() {
        assert_eq!(goal.waypoint.number, goals);
        let within = goal.within.unwrap();
        let p = goal.waypoint.point;
        assert!(within.contains(last) && within.contains(p));
        meter.goal(p);
        last = p;
        goals += 1;
    }
    assert_eq!(plan.lap(), spec.loops);
    assert_eq!(
        plan.dwell().goals() + plan.tour().iterations() * u64::from(spec.loops),
        goals
    );
    (goals, meter.figures())
}

/// Loops, sub-goals, length (m); goals at 0.5 m, path at 0.25 and 0.5 m, disc.
type Row = (Emission, u32, u64, f64, [f64; 4]);

fn check(
    workplace: &Workplace,
    decomposition: &Decomposition,
    route: &[usize],
    by: &[u32],
    rows: &[Row],
) {
    for &(emission, loops, goals, length, rates) in rows {
        let spec = PlanSpec {
            route: Route::Cycle(route.to_vec()),
            iterations: Iterations::By(by.to_vec()),
            transit: Transit::Wait { cap: 100_000 },
            loops,
        };
        let (driven, f) = drive(workplace, decomposition.clone(), &spec, emission);
        assert_eq!(driven, goals);
        relative(f.length, length);
        let found = [f.goals[2], f.path[1], f.path[2], f.disc];
        for (rate, expected) in found.into_iter().zip(rates) {
            within_two_cells(rate, expected);
        }
    }
}

#[test]
fn case_1_is_covered_as_known() {
    let workplace = workplace(&[[2.5, 2.5, 7.5, 7.5]]);
    let decomposition = Decomposition::new(&workplace).unwrap();
    let check = |by: &[u32], rows: &[Row]| {
        check(&workplace, &decomposition, &[0, 3, 1, 2], by, rows);
    };
    check(
        &[50; 4],
        &[
            (Arcsine, 1, 214, 623.8074, [0.4867, 0.7258, 0.9000, 0.7020]),
            (Raw, 1, 214, 756.6031, [0.4600, 0.8717, 0.9633, 0.8355]),
            (Arcsine, 10, 2139, 5890.5017, [0.9933, 0.98, 1.0, 0.9855]),
            (Raw, 10, 2131, 7139.1245, [0.9733, 1.0, 1.0, 0.9997]),
        ],
    );
    check(
        &[67, 67, 33, 33],
        &[(Arcsine, 1, 228, 728.0818, [0.5233, 0.7733, 0.92, 0.7454])],
    );
    check(
        &[50, 50, 25, 25],
        &[(Arcsine, 1, 159, 553.6770, [0.4167, 0.7075, 0.9033, 0.6722])],
    );
}

#[test]
fn case_2_is_covered_as_known() {
    let workplace = workplace(&[[0.0, 3.5, 3.0, 6.5], [7.0, 3.5, 10.0, 6.5]]);
    // The bridge by which the loop returns from the lower to the upper rectangle (the paper's T_BDF).
    let back = Aabb {
        min: Point2::new(3.1, 0.1),
        max: Point2::new(6.9, 9.9),
    };
    let decomposition = Decomposition::new(&workplace).unwrap();
    let decomposition = decomposition.with_bridge(&workplace, [0, 1], back).unwrap();
    check(
        &workplace,
        &decomposition,
        &[1, 2, 0],
        &[90, 90, 30],
        &[
            (Arcsine, 1, 219, 830.2915, [0.5030, 0.7782, 0.9268, 0.7445]),
            (Raw, 1, 219, 1007.7163, [0.4512, 0.9177, 0.9970, 0.8729]),
            (Arcsine, 10, 2198, 7337.5089, [1.0, 0.9817, 1.0, 0.9835]),
            (Raw, 10, 2229, 9236.2675, [0.9817, 1.0, 1.0, 1.0]),
        ],
    );
}

#[test]
fn the_papers_floating_point_orbit_covers_about_as_much_everywhere() {
    // After 21 steps the orbit depends on the last bit of cosine and arc cosine. With the GNU C
    // library the lengths and disc rates are the second pair; these are this library's.
    let rows = [
        (Arcsine, 200, 935.902_7, (1_007.396_2, 0.7294)),
        (Arcsine, 2000, 10_168.008_1, (10_126.401_1, 0.9776)),
        (Raw, 200, 1_152.954_4, (1_239.973_7, 0.8913)),
        (Raw, 2000, 12_474.006_4, (12_425.847_3, 0.9997)),
    ];
    let workplace = workplace(&[]);
    for (emission, goals, length, (their_length, their_disc)) in rows {
        let mut source = chaotic_maps::ChebF64::new(0.1, 0.2, emission).unwrap();
        let mut meter = Meter::new(&workplace.domain().unwrap(), STEP).unwrap();
        for _ in 0..goals {
            meter.goal(map(source.next_symmetric(), &workplace.inner()));
        }
        relative(meter.length(), length);
        assert!((meter.length() / their_length - 1.0).abs() < 0.08);
        assert!((meter.disc().rate() - their_disc).abs() < 0.035);
    }
}
