//! Properties of the families of curves for all variables.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use curves::bspline_basis::Basis;
use curves::lgl_nodes::Lgl;
use curves::{Camouflage, Curve, Ends, Pursuit, Row, Spline};
use geometry::math;
use nalgebra::{DMatrix, Vector2};
use proptest::prelude::*;

const RATE: f64 = curves::PURSUIT_RATE;

fn unit(angle: f64) -> Vector2<f64> {
    Vector2::new(math::cos(angle), math::sin(angle))
}

fn ends() -> impl Strategy<Value = Ends> {
    (
        (-1.0..1.0, -1.0..1.0, 6.0..9.0, -3.0..3.0),
        proptest::option::of(-3.0..3.0),
        proptest::option::of(-3.0..3.0),
    )
        .prop_map(|((x, y, gx, gy), start, goal)| Ends {
            start: Vector2::new(x, y),
            goal: Vector2::new(gx, gy),
            start_heading: start.map(unit),
            goal_heading: goal.map(unit),
        })
}

fn families(ends: Ends) -> Vec<Box<dyn Curve>> {
    let basis = |degree| Basis::new(degree, &[0.05, 0.2, 0.35, 0.5, 0.7, 0.9]);
    let camouflage = Camouflage::new(15, Vector2::new(-20.0, -20.0), ends.start);
    vec![
        Box::new(Spline::new(basis(3), ends, None).unwrap()),
        Box::new(Spline::new(basis(4), ends, camouflage).unwrap()),
        Box::new(Pursuit::new(basis(2), ends).unwrap()),
        Box::new(Pursuit::new(basis(4), ends).unwrap()),
    ]
}

/// Variables of magnitude about 1, with positive speeds at the ends.
fn variables(curve: &dyn Curve, numbers: &[f64]) -> Vec<f64> {
    let mut z: Vec<f64> = (0..curve.variables())
        .map(|i| numbers[i % numbers.len()])
        .collect();
    for var in [curve.start_speed(), curve.goal_speed()]
        .into_iter()
        .flatten()
    {
        z[var] = 1.0 + z[var].abs();
    }
    z
}

proptest! {
    #[test]
    fn curves_begin_and_end_as_they_must(
        ends in ends(),
        numbers in proptest::collection::vec(-2.0..2.0, 40),
    ) {
        for curve in families(ends) {
            let z = variables(curve.as_ref(), &numbers);
            let trace = curve.trace(&z);
            for (at, place, heading) in [
                (0.0, ends.start, ends.start_heading),
                (1.0, ends.goal, ends.goal_heading),
            ] {
                let [r, velocity, _] = trace(at);
                prop_assert!((r - place).norm() < 1e-8, "{r} {place}");
                if let Some(heading) = heading {
                    prop_assert!((velocity.normalize() - heading).norm() < 1e-7);
                }
            }
        }
    }

    #[test]
    fn rows_are_what_the_curve_does(
        ends in ends(),
        numbers in proptest::collection::vec(-2.0..2.0, 40),
        at in 0.0..1.0,
    ) {
        for curve in families(ends) {
            let z = variables(curve.as_ref(), &numbers);
            let exact = curve.trace(&z)(at);
            let mut row = Row::default();
            for (order, exact) in exact.iter().enumerate().take(2) {
                curve.row(at, order, &z, &mut row);
                let scale = 1.0 + exact.norm();
                prop_assert!((row.value - exact).norm() < 1e-7 * scale, "{} {exact}", row.value);
                // Each derivative is the limit of a difference.
                for var in 0..z.len() {
                    let h = 1e-6;
                    let mut moved = [z.clone(), z.clone()];
                    moved[0][var] -= h;
                    moved[1][var] += h;
                    let [low, high] = moved.map(|z| curve.trace(&z)(at)[order]);
                    let found = (high - low) / (2.0 * h);
                    let expected: Vector2<f64> = row
                        .terms
                        .iter()
                        .filter(|(v, _)| *v == var)
                        .map(|(_, term)| *term)
                        .sum();
                    prop_assert!((found - expected).norm() < 1e-5 * scale, "{order} {var} {found} {expected}");
                }
            }
        }
    }

    #[test]
    fn pursuit_heads_for_its_prey(
        ends in ends(),
        numbers in proptest::collection::vec(-2.0..2.0, 40),
        at in 0.001..0.999,
    ) {
        let basis = Basis::new(2, &[0.05, 0.2, 0.35, 0.5, 0.7, 0.9]);
        let curve = Pursuit::new(basis.clone(), ends).unwrap();
        let z = variables(&curve, &numbers);
        let [r, velocity, acceleration] = curve.trace(&z)(at);
        let prey = curve.prey(&z);
        let values = basis.values(basis.span(at), at, 1);
        let place = |order: usize| -> Vector2<f64> {
            (0..3).map(|i| prey[values.first + i] * values.by_order[order][i]).sum()
        };
        // Eq. 2, and Eq. 3 with a constant ν.
        let scale = 1.0 + place(0).norm() + r.norm();
        prop_assert!((velocity - (place(0) - r) * RATE).norm() < 1e-6 * RATE * scale);
        prop_assert!((acceleration - (place(1) - velocity) * RATE).norm() < 1e-6 * RATE * RATE * scale);
    }

    #[test]
    fn pursuit_is_what_collocation_tends_to(
        ends in ends(),
        numbers in proptest::collection::vec(-2.0..2.0, 40),
    ) {
        // Eq. 6 at 61 Legendre–Gauss–Lobatto nodes, the first one replaced by the initial position:
        // (D' + ν I) ζ = ν ζₚ with D' = 2 D.
        let basis = Basis::new(4, &[]);
        let curve = Pursuit::new(basis.clone(), ends).unwrap();
        let z = variables(&curve, &numbers);
        let prey = curve.prey(&z);
        let lgl = Lgl::new(60);
        let mut system = lgl.differentiation() * 2.0;
        let n = lgl.nodes.len();
        let mut right = DMatrix::zeros(n, 2);
        for (i, x) in lgl.nodes.iter().enumerate() {
            system[(i, i)] += RATE;
            let values = basis.values(0, 0.5 * (x + 1.0), 0);
            let place: Vector2<f64> = (0..5).map(|k| prey[k] * values.by_order[0][k]).sum();
            right.set_row(i, &(place * RATE).transpose());
        }
        system.row_mut(0).fill(0.0);
        system[(0, 0)] = 1.0;
        right.set_row(0, &ends.start.transpose());
        let collocated = system.lu().solve(&right).unwrap();
        let trace = curve.trace(&z);
        for (i, x) in lgl.nodes.iter().enumerate() {
            let exact = trace(0.5 * (x + 1.0))[0];
            let found = Vector2::new(collocated[(i, 0)], collocated[(i, 1)]);
            prop_assert!((exact - found).norm() < 1e-6, "{exact} {found}");
        }
    }

    #[test]
    fn camouflage_stays_between_prey_and_reference(
        ends in ends(),
        numbers in proptest::collection::vec(-2.0..2.0, 40),
        at in 0.0..1.0,
    ) {
        let reference = Vector2::new(-20.0, -20.0);
        let basis = Basis::even(4, 9);
        let camouflage = Camouflage::new(15, reference, ends.start);
        let hidden = Spline::new(basis.clone(), ends, camouflage).unwrap();
        let z = variables(&hidden, &numbers);
        let nu = hidden.path_control(&z);
        prop_assert_eq!(nu.len(), 16);
        prop_assert_eq!((nu[0], nu[15]), (1.0, 1.0));
        // Eq. 16 with Eq. 19 and the interpolant of ν.
        let prey = hidden.prey_points(&z);
        let values = basis.values(basis.span(at), at, 0);
        let place: Vector2<f64> =
            (0..5).map(|i| prey[values.first + i] * values.by_order[0][i]).sum();
        let weights = Lgl::new(15).values(2.0 * at - 1.0);
        let control: f64 = weights.iter().zip(&nu).map(|(w, n)| w * n).sum();
        let want = reference + (place - reference) * control;
        prop_assert!((hidden.trace(&z)(at)[0] - want).norm() < 1e-9 * (1.0 + want.norm()));
        // With ν = 1 everywhere the path is the prey's.
        let mut plain = z.clone();
        let count = plain.len();
        plain[count - 14..].fill(0.0);
        let alone = hidden.path_control(&plain);
        prop_assert!(alone.iter().all(|nu| *nu == 1.0));
    }
}
