use core::f64::consts::{PI, TAU};

use expect_test::expect;
use serde::Deserialize;

use super::*;
use crate::{above, at_least, between, each, unit};

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
struct Sample {
    /// After `alpha` in the alphabet, before it in the declaration.
    #[schemars(transform = at_least(0).unit("m"))]
    zeta: f64,
    #[schemars(transform = between(0, 1))]
    alpha: f64,
    #[schemars(transform = above(0).below(10).unit("m/s"))]
    half_open: f64,
    free: f64,
    #[schemars(transform = at_least(1))]
    count: u64,
    #[schemars(transform = above(0).unit("rad"))]
    cap: Option<f64>,
    #[schemars(length(min = 1, max = 3), transform = each(above(0).unit("s")))]
    times_s: Vec<f64>,
    corner: [f64; 2],
    inner: Inner,
    shape: Shape,
}

#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
struct Inner {
    #[schemars(transform = at_least(2))]
    low: u32,
    high: u32,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "snake_case")]
enum Shape {
    Disc {
        #[schemars(transform = above(0).unit("m"))]
        size: f64,
    },
    Square {
        #[schemars(transform = above(1).unit("m"))]
        size: f64,
    },
    Named(Name),
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
struct Name {
    #[schemars(transform = at_least(7))]
    number: i32,
}

impl Default for Sample {
    fn default() -> Self {
        Self {
            zeta: 0.0,
            alpha: 1.0,
            half_open: 5.0,
            free: -3.5,
            count: 1,
            cap: None,
            times_s: vec![1.0],
            corner: [0.0, -1.0],
            inner: Inner { low: 2, high: 3 },
            shape: Shape::Disc { size: 1.0 },
        }
    }
}

impl Parameters for Sample {
    fn check_relations(&self) -> Result<(), ParamsError> {
        let Inner { low, high } = self.inner;
        crate::require(low < high, "inner.high", &high, "more than `inner.low`")
    }
}

fn message(change: impl FnOnce(&mut Sample)) -> String {
    let mut sample = Sample::default();
    check(&sample).unwrap();
    change(&mut sample);
    check(&sample).unwrap_err().to_string()
}

#[test]
fn a_value_out_of_range_is_named_with_range_and_unit() {
    let errors = [
        message(|s| s.zeta = -0.5),
        message(|s| s.alpha = 1.5),
        message(|s| s.half_open = 10.0),
        message(|s| s.count = 0),
        message(|s| s.cap = Some(0.0)),
        message(|s| s.times_s = vec![1.0, 0.0]),
        message(|s| s.times_s.clear()),
        message(|s| s.inner.low = 1),
        message(|s| s.shape = Shape::Square { size: 0.5 }),
        message(|s| s.shape = Shape::Named(Name { number: 6 })),
    ];
    expect![[r#"
        `zeta` is -0.5: expected a finite number of at least 0 (m)
        `alpha` is 1.5: expected a number between 0 and 1
        `half_open` is 10: expected a number above 0 and below 10 (m/s)
        `count` is 0: expected a whole number of at least 1
        `cap` is 0: expected a finite number above 0 (rad)
        `times_s[1]` is 0: expected a finite number above 0 (s)
        `times_s` is a list of 0: expected 1 to 3 values
        `inner.low` is 1: expected a whole number of at least 2
        `shape.size` is 0.5: expected a finite number above 1 (m)
        `shape.number` is 6: expected a whole number of at least 7"#]]
    .assert_eq(&errors.join("\n"));
}

#[test]
fn a_number_that_is_not_finite_is_refused_with_or_without_a_range() {
    let errors = [
        message(|s| s.free = f64::NAN),
        message(|s| s.corner[1] = f64::INFINITY),
        message(|s| s.alpha = f64::NAN),
    ];
    expect![[r#"
        `free` is NaN: expected a finite number
        `corner[1]` is inf: expected a finite number
        `alpha` is NaN: expected a number between 0 and 1"#]]
    .assert_eq(&errors.join("\n"));
}

#[test]
fn the_first_field_declared_is_reported_and_relations_come_last() {
    let all = |s: &mut Sample| {
        s.alpha = -1.0;
        s.zeta = -1.0;
        s.inner.high = 0;
    };
    let errors = [message(all), message(|s| s.inner.high = 2)];
    expect![[r#"
        `zeta` is -1: expected a finite number of at least 0 (m)
        `inner.high` is 2: expected more than `inner.low`"#]]
    .assert_eq(&errors.join("\n"));
}

#[test]
fn every_field_out_of_range_is_found() {
    let sample = Sample {
        zeta: -1.0,
        half_open: 10.0,
        times_s: vec![0.0, 1.0, -2.0],
        inner: Inner { low: 1, high: 0 },
        ..Sample::default()
    };
    let fields: Vec<String> = faults(&sample).into_iter().map(|e| e.field).collect();
    let want = ["zeta", "half_open", "times_s[0]", "times_s[2]", "inner.low"];
    assert_eq!(fields, want);
}

#[test]
fn a_whole_number_is_compared_exactly() {
    #[derive(Debug, Default, Serialize, Deserialize, JsonSchema)]
    struct Large {
        #[schemars(transform = at_least(0).at_most(u64::MAX - 1))]
        n: u64,
    }
    impl Parameters for Large {}
    check(&Large { n: u64::MAX - 1 }).unwrap();
    assert!(check(&Large { n: u64::MAX }).is_err());
}

#[derive(Debug, Clone, Default, Serialize, Deserialize, JsonSchema)]
#[serde(default)]
struct Angles {
    #[schemars(transform = unit("rad"))]
    direction: f64,
    #[schemars(transform = above(0).unit("rad"))]
    deviation: Option<f64>,
    #[schemars(transform = between(-1, 1000).unit("rad"))]
    declared: f64,
    #[schemars(transform = each(at_least(0).unit("rad/s")))]
    rates: Vec<f64>,
    #[schemars(transform = at_least(0).unit("m"))]
    length: f64,
}

impl Parameters for Angles {}

#[test]
fn angles_without_a_declared_maximum_have_a_usual_one() {
    let usual = Angles {
        direction: -TAU,
        deviation: Some(PI),
        declared: 900.0,
        rates: vec![20.0, 0.0],
        length: 1e9,
    };
    assert_eq!(unusual(&usual), []);
    let degrees = Angles {
        direction: -90.0,
        deviation: Some(5.0),
        rates: vec![1.0, 45.0],
        ..usual
    };
    let found: Vec<String> = unusual(&degrees).iter().map(ToString::to_string).collect();
    let expected = [
        "`direction` is -90 rad, usually at most 2π; -90° are -1.571 rad",
        "`deviation` is 5 rad, usually at most π; 5° are 0.087 rad",
        "`rates[1]` is 45 rad/s, usually at most 20; 45° are 0.785 rad",
    ];
    assert_eq!(found, expected);
}
