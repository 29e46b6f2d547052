//! Validation of the problem and the samples before the check.

use nalgebra::{Point2, Vector2};

use crate::contract::{Contract, Obstacle};
use crate::findings::Findings;
use crate::sample::Sample;
use crate::violation::Violation;

/// Maximum magnitude of a number (m, rad, s and their quotients). With all numbers below it, no
/// product in this crate overflows.
const MAX_NUMBER: f64 = 1e9;

/// Minimum area of a polygon (m²): a square of a micrometre.
const MIN_AREA: f64 = 1e-12;

/// Sine of the turn to the right that rounding may cause at a corner of a convex polygon.
const FLAT: f64 = 1e-9;

fn usable(value: f64) -> bool {
    value.abs() <= MAX_NUMBER
}

/// Records the first error of the contract, and the first of the samples.
pub fn check(contract: &Contract, samples: &[Sample], findings: &mut Findings) {
    if let Some(fault) = contract_fault(contract) {
        findings.fault(fault);
    }
    if samples.is_empty() {
        findings.fault(Violation::Empty);
    }
    for (index, sample) in samples.iter().enumerate() {
        if let Some(&(what, value)) = sample.fields().iter().find(|(_, value)| !usable(*value)) {
            findings.fault(Violation::NotFinite { index, what, value });
            break;
        }
    }
}

fn contract_fault(contract: &Contract) -> Option<Violation> {
    let wheel = contract.wheel;
    let number = |what, value: Option<f64>| {
        let ok = value.is_none_or(usable);
        fault(ok, what, value.unwrap_or(0.0), "a finite number")
    };
    let positive = |what, value: Option<f64>| {
        let ok = value.is_none_or(|value| value > 0.0 && usable(value));
        fault(ok, what, value.unwrap_or(0.0), "a finite number above 0")
    };
    None.or_else(|| number("start x", Some(contract.start[0])))
        .or_else(|| number("start y", Some(contract.start[1])))
        .or_else(|| number("start heading", Some(contract.start[2])))
        .or_else(|| number("start_speed", contract.start_speed))
        .or_else(|| number("start_turn_rate", contract.start_turn_rate))
        .or_else(|| number("goal x", Some(contract.goal[0])))
        .or_else(|| number("goal y", Some(contract.goal[1])))
        .or_else(|| number("goal_heading", contract.goal_heading))
        .or_else(|| number("goal_speed", contract.goal_speed))
        .or_else(|| positive("v_max", Some(contract.v_max)))
        .or_else(|| {
            let v_min = contract.v_min;
            let ok = v_min <= 0.0 && usable(v_min);
            fault(ok, "v_min", v_min, "a finite number of at most 0")
        })
        .or_else(|| positive("omega_max", Some(contract.omega_max)))
        .or_else(|| positive("wheel.speed", wheel.map(|wheel| wheel.speed)))
        .or_else(|| positive("wheel.separation", wheel.map(|wheel| wheel.separation)))
        .or_else(|| positive("acceleration_max", contract.acceleration_max))
        .or_else(|| {
            positive(
                "angular_acceleration_max",
                contract.angular_acceleration_max,
            )
        })
        .or_else(|| not_negative("clearance", contract.clearance))
        .or_else(|| contract.bounds.and_then(bounds_fault))
        .or_else(|| contract.obstacles.iter().find_map(obstacle_fault))
}

fn fault(ok: bool, what: &'static str, value: f64, expected: &'static str) -> Option<Violation> {
    (!ok).then_some(Violation::Contract {
        what,
        value,
        expected,
    })
}

fn not_negative(what: &'static str, value: f64) -> Option<Violation> {
    let ok = value >= 0.0 && usable(value);
    fault(ok, what, value, "a finite number of at least 0")
}

fn bounds_fault([x_min, y_min, x_max, y_max]: [f64; 4]) -> Option<Violation> {
    let side = |what, low: f64, high: f64| {
        let ok = usable(low) && usable(high) && low < high;
        fault(ok, what, high - low, "a finite length above 0")
    };
    side("width of the bounds", x_min, x_max).or_else(|| side("height of the bounds", y_min, y_max))
}

fn obstacle_fault(obstacle: &Obstacle) -> Option<Violation> {
    match obstacle {
        Obstacle::Disc { center, radius } => center
            .iter()
            .find_map(|&value| fault(usable(value), "centre of a disc", value, "finite"))
            .or_else(|| not_negative("radius of a disc", *radius)),
        Obstacle::Polygon { vertices } => polygon_fault(vertices),
    }
}

/// A polygon is accepted if it has an area, turns left (or not at all) at every corner, and makes
/// one full turn.
fn polygon_fault(vertices: &[Point2<f64>]) -> Option<Violation> {
    let count = vertices.len();
    if count < 3 {
        let what = "number of a polygon's vertices";
        return fault(false, what, count as f64, "at least 3");
    }
    let odd = vertices
        .iter()
        .flat_map(|v| v.iter())
        .find(|v| !usable(**v));
    if let Some(&value) = odd {
        return fault(false, "vertex of a polygon", value, "finite");
    }
    let origin = vertices[0];
    let area = (1..count - 1)
        .map(|k| (vertices[k] - origin).perp(&(vertices[k + 1] - origin)) / 2.0)
        .sum::<f64>();
    let edges: Vec<Vector2<f64>> = (0..count)
        .map(|k| vertices[(k + 1) % count] - vertices[k])
        .filter(|edge| edge.norm() > 0.0)
        .collect();
    let mut turning = 0.0;
    let mut sharpest_right = 0.0_f64;
    for (k, edge) in edges.iter().enumerate() {
        let next = edges[(k + 1) % edges.len()];
        let (cross, dot) = (edge.perp(&next), edge.dot(&next));
        turning += libm::atan2(cross, dot);
        sharpest_right = sharpest_right.min(cross / (edge.norm() * next.norm()));
    }
    let once = (turning - core::f64::consts::TAU).abs() < 0.1;
    fault(
        area > MIN_AREA,
        "signed area of a polygon",
        area,
        "above 0 (counter-clockwise)",
    )
    .or_else(|| {
        let what = "sine of the sharpest turn of a polygon";
        fault(
            sharpest_right >= -FLAT,
            what,
            sharpest_right,
            "to the left (convex)",
        )
    })
    .or_else(|| {
        fault(
            once,
            "turn of a polygon (rad)",
            turning,
            "one full turn (convex)",
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn polygon(corners: &[[f64; 2]]) -> Option<Violation> {
        let vertices: Vec<_> = corners.iter().map(|&[x, y]| Point2::new(x, y)).collect();
        polygon_fault(&vertices)
    }

    #[test]
    fn convex_counter_clockwise_polygons_are_accepted() {
        assert_eq!(polygon(&[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]), None);
        // A repeated corner and one in the middle of an edge are accepted.
        let square = [
            [0.0, 0.0],
            [0.5, 0.0],
            [1.0, 0.0],
            [1.0, 0.0],
            [1.0, 1.0],
            [0.0, 1.0],
        ];
        assert_eq!(polygon(&square), None);
    }

    #[test]
    fn polygons_that_bound_no_convex_area_are_refused() {
        assert!(polygon(&[[0.0, 0.0], [1.0, 0.0]]).is_some());
        assert!(polygon(&[[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]]).is_some());
        assert!(polygon(&[[1.0, 1.0]; 5]).is_some());
        assert!(polygon(&[[0.0, 0.0], [0.0, 1.0], [1.0, 0.0]]).is_some());
        assert!(polygon(&[[0.0, 0.0], [1.0, 0.0], [f64::NAN, 1.0]]).is_some());
        let dart = [[0.0, 0.0], [1.0, 0.0], [0.2, 0.2], [0.0, 1.0]];
        assert!(polygon(&dart).is_some());
        // A pentagram turns left everywhere, but makes two full turns.
        let star: Vec<[f64; 2]> = (0..5)
            .map(|k| libm::sincos(f64::from(2 * k) * core::f64::consts::TAU / 5.0))
            .map(|(sin, cos)| [cos, sin])
            .collect();
        assert!(polygon(&star).is_some());
    }

    #[test]
    fn the_speed_backwards_is_a_finite_number_of_at_most_zero() {
        let fault = |v_min: f64| {
            contract_fault(&Contract {
                v_min,
                ..Contract::new([0.0; 3], [1.0, 0.0], 0.2, 2.0)
            })
        };
        assert!([0.0, -0.1, -5.0].map(fault).iter().all(Option::is_none));
        let broken = [0.1, f64::NAN, f64::NEG_INFINITY].map(fault);
        assert!(broken.iter().all(Option::is_some));
    }

    #[test]
    fn limits_must_be_above_zero() {
        let sound = Contract::new([0.0; 3], [1.0, 0.0], 0.2, 2.0);
        assert_eq!(contract_fault(&sound), None);
        for value in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            let mut broken = vec![sound.clone(); 4];
            broken[0].v_max = value;
            broken[1].omega_max = value;
            broken[2].acceleration_max = Some(value);
            broken[3].angular_acceleration_max = Some(value);
            assert!(
                broken
                    .iter()
                    .all(|contract| contract_fault(contract).is_some())
            );
        }
    }
}
