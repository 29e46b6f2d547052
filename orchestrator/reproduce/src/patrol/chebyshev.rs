//! The numbers of the Chebyshev coverage paper, as claims.

use core::f64::consts::FRAC_2_PI;

use chaotic_maps::Emission;
use geometry::math::{acos, asin, cos, ln, sin};
use metrics::sequence::lyapunov_from_pairs;
use rand::RngExt as _;
use runtime::seed::stream;
use statistics::Mean;
use sweep::Row;

use super::coverage::at;
use super::evidence::{COVERAGE, Cell, Evidence};
use super::sequences::{LENGTHS, TABLE_1, exact_under};
use crate::claim::{Claim, EXACT, Finding, Measured, ONE_RUN, Paper, Published, Unit, Verdict};

/// Number of keys of the exact map.
const KEYS: u64 = 200;
/// Way at which the covered part is compared (m).
const WAY: f64 = 1000.0;
const FALLS: &str = "Mean change under the same keys with its 95 % interval: confirmed if it lies below 0, refuted if it \
    rules out half of the published change.";
const LOWERS: &str = "Mean change under the same keys with its 95 % interval: confirmed if it lies below 0, refuted if \
    above. The value depends on the distribution of the coordinates only, and says nothing about randomness.";
const COVERS: &str = "Mean difference of missions with the same seeds, with its 95 % interval: confirmed if it lies on \
    the claimed side of 0, refuted if on the other.";

/// Returns all claims.
pub fn list(evidence: &Evidence) -> Vec<Claim> {
    let mut claims = exponents();
    claims.extend(differences());
    claims.extend(covered(evidence));
    claims
}

fn claim(
    id: &str,
    text: String,
    published: Published,
    rule: &'static str,
    finding: Finding,
) -> Claim {
    Claim::number((Paper::Coverage, id), text, published, rule, finding)
}

/// Returns the claims about Lyapunov exponents. The transform is a change of coordinates, which keeps the exponent.
fn exponents() -> Vec<Claim> {
    let unit = Unit::Number(4, "");
    let raw = |x: f64| cos(6.0 * acos(x.clamp(-1.0, 1.0)));
    let transformed = |u: f64| FRAC_2_PI * asin(raw(sin(u / FRAC_2_PI)));
    let along = |map: &dyn Fn(f64) -> f64, start| lyapunov_from_pairs(map, start, 1e-7, 10_000);
    let orbits = [along(&raw, 0.1), along(&transformed, FRAC_2_PI * asin(0.1))];
    let rows = [
        (
            "lyapunov",
            "Lyapunov exponent of the Chebyshev map, k = 6",
            1.7918,
        ),
        (
            "lyapunov_arcsine",
            "The same after the arcsine transform",
            3.2147,
        ),
    ];
    let claims = rows
        .into_iter()
        .zip(orbits)
        .map(|((id, text, published), orbit)| {
            let mut finding = Finding::exact(published, ln(6.0), unit);
            finding.numbers = vec![format!("Along an orbit: {}", unit.value(orbit))];
            let published = Published::number(published, unit);
            claim(id, text.to_owned(), published, EXACT, finding)
        });
    claims.collect()
}

/// Returns the mean differences of the sequences of an emission under every key, for both lengths.
fn under_keys(emission: Emission) -> [Vec<f64>; 2] {
    let keys = (1..=KEYS).map(|seed| {
        let mut random = stream(seed, "reproduce", "", "chebyshev");
        [random.random::<u64>() >> 1, random.random::<u64>() >> 1]
    });
    let keys: Vec<[u64; 2]> = keys.collect();
    LENGTHS.map(|n| {
        let values = keys.iter().filter_map(|key| exact_under(*key, emission, n));
        values.collect()
    })
}

/// Returns the claims about the mean difference v(xy) (Table 1).
fn differences() -> Vec<Claim> {
    let unit = Unit::Number(4, "");
    let mut claims = Vec::new();
    let mut longest = Vec::new();
    for (name, emission, published, _) in TABLE_1 {
        let id = format!("{emission:?}").to_lowercase();
        let values = under_keys(emission);
        for ((n, published), values) in LENGTHS.into_iter().zip(published).zip(&values) {
            let text = format!("Table 1: v(xy), {name}, n = {n}");
            let finding = Finding::one_run(published, values, unit, "keys");
            let published = Published::number(published, unit);
            claims.push(claim(
                &format!("v.{id}.{n}"),
                text,
                published,
                ONE_RUN,
                finding,
            ));
        }
        let [short, long] = values;
        let [first, second] = published;
        let text = format!("Table 1: v(xy) falls with n, {name}");
        let finding = change(&long, &short, (second - first) / 2.0);
        let change = Published::number(second - first, unit);
        claims.push(claim(
            &format!("v.{id}.falls"),
            text,
            change,
            FALLS,
            finding,
        ));
        longest.push((long, second));
    }
    if let [(raw, theirs), (transformed, less)] = longest.as_slice() {
        let finding = change(transformed, raw, 0.0);
        let text = "Table 1: the transform lowers v(xy), n = 10000".to_owned();
        let change = Published::number(less - theirs, unit);
        claims.push(claim("v.lower", text, change, LOWERS, finding));
    }
    claims
}

/// Tests if values are smaller than others under the same keys; refuted if the change exceeds `limit`.
fn change(values: &[f64], others: &[f64], limit: f64) -> Finding {
    let changes: Vec<f64> = values.iter().zip(others).map(|(a, b)| a - b).collect();
    let Some(mean) = Mean::of(&changes) else {
        return Finding::missing("sequences");
    };
    let interval = mean.interval();
    let verdict = if interval.high < 0.0 {
        Verdict::Confirmed
    } else if interval.low > limit {
        Verdict::Refuted
    } else {
        Verdict::Undecided
    };
    Finding {
        verdict,
        ours: Measured::number(
            mean.value,
            interval,
            Unit::Number(4, ""),
            (mean.count as u64, "keys"),
        ),
        numbers: Vec::new(),
    }
}

/// Returns the claims about the arcsine transform and coverage (conclusion 4).
fn covered(evidence: &Evidence) -> [Claim; 2] {
    let unevenness = |row: &Row| Some(row.coverage.as_ref()?.unevenness);
    [
        claim(
            "covers_more",
            format!("Conclusion 4: the transform covers more, after {WAY} m"),
            Published::text("more"),
            COVERS,
            better(evidence, Unit::Points, |row| at(row, WAY)),
        ),
        claim(
            "more_even",
            "Conclusion 4: the transform covers more evenly (fall of the unevenness)".to_owned(),
            Published::text("more evenly"),
            COVERS,
            better(evidence, Unit::Number(2, ""), |row| Some(-unevenness(row)?)),
        ),
    ]
}

/// Tests if a value is larger with the transform, seed by seed.
fn better(evidence: &Evidence, unit: Unit, value: impl Fn(&Row) -> Option<f64>) -> Finding {
    let cell = |case: &str| -> Option<&Cell> {
        let study = evidence.coverage.as_ref()?;
        study.cells.iter().find(|cell| cell.case == case)
    };
    let (Some(with), Some(without)) = (cell("chebyshev_arcsine"), cell("chebyshev_raw")) else {
        return Finding::missing(&format!("experiment {COVERAGE}"));
    };
    let gains = with.rows.iter().filter_map(|(seed, a)| {
        let b = without.rows.get(seed)?;
        Some(value(a)? - value(b)?)
    });
    let Some(mean) = Mean::of(&gains.collect::<Vec<_>>()) else {
        return Finding::missing("missions of both emissions");
    };
    let interval = mean.interval();
    Finding {
        verdict: Verdict::above(interval, 0.0),
        ours: Measured::number(mean.value, interval, unit, (mean.count as u64, "missions")),
        numbers: Vec::new(),
    }
}
