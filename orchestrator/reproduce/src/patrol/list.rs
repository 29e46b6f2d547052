//! The numbers of the cat-map patrol paper, as claims.

use metrics::path::PathMetrics;
use metrics::sequence::lyapunov_from_jacobians;

use super::evidence::{ALPHA, Cell, Evidence, SQUARE, laps};
use super::keys::{Laps, LapsError};
use crate::claim::{Claim, EXACT, Finding, Measured, ONE_RUN, Paper, Published, Unit, Verdict};

/// Rule of the numbers of fictive obstacles.
const RECONSTRUCTION: &str = "Undecided: the method of fictive obstacles is a reconstruction, since its own paper was not \
    available.";

/// A published number that the laps under many keys give.
type OfLaps = (
    &'static str,
    &'static str,
    f64,
    Unit,
    fn(&PathMetrics) -> f64,
);

const METRES: Unit = Unit::Number(4, "m");
const RADIANS: Unit = Unit::Number(4, "rad");
const RATE: Unit = Unit::Number(4, "/s");

/// Case 1: an octagon in 120 s, a zig-zag of 1.7 m.
const CASE_1: [OfLaps; 6] = [
    (
        "speed",
        "§5.1: speed needed",
        0.9651,
        Unit::Number(4, "m/s"),
        |m| m.speed_first,
    ),
    (
        "length",
        "§5.1: length of a lap (speed times 120 s)",
        115.8,
        Unit::Number(1, "m"),
        |m| m.length_first,
    ),
    ("mae", "§5.1: MAE", 0.9352, METRES, |m| m.mae_time),
    (
        "maa",
        "§5.1: mean absolute angle between turns",
        0.7815,
        RADIANS,
        |m| m.turns_first.maa,
    ),
    (
        "maa_folded",
        "§5.1: mean angle, folded to acute ones",
        0.7815,
        RADIANS,
        |m| m.turns_first.maa_fold,
    ),
    (
        "andc",
        "§5.1: changes of direction per second",
        0.4024,
        RATE,
        |m| m.andc,
    ),
];
/// Case 2: a square at the speed of case 1, a zig-zag of 1.3 m.
#[expect(clippy::approx_constant, reason = "published digits")]
const CASE_2: [OfLaps; 4] = [
    ("mae", "§5.2: MAE", 0.7120, METRES, |m| m.mae_time),
    (
        "maa",
        "§5.2: mean absolute angle between turns",
        0.7854,
        RADIANS,
        |m| m.turns_first.maa,
    ),
    (
        "maa_folded",
        "§5.2: mean angle, folded to acute ones",
        0.7854,
        RADIANS,
        |m| m.turns_first.maa_fold,
    ),
    (
        "andc",
        "§5.2: changes of direction per second",
        0.4024,
        RATE,
        |m| m.andc,
    ),
];
/// Time of a lap of the square, 40 m, at the speed along the octagon (s).
const T_MAX_2: &str = "t_max=99.411";

/// Returns all claims.
///
/// # Errors
/// [`LapsError`].
pub fn list(evidence: &Evidence) -> Result<Vec<Claim>, LapsError> {
    let octagon = Laps::of("patrol_octagon", &["alpha=1.7"])?;
    let square = Laps::of("patrol_square", &["alpha=1.3", T_MAX_2])?;
    let matrix = [[1.0, 1.0], [1.0, 2.0]];
    let exponent = lyapunov_from_jacobians(std::iter::repeat_n(matrix, 100_000));
    let plain = Unit::Number(4, "");
    let mut claims = vec![
        exact(
            "lyapunov",
            "Lyapunov exponent of the cat map",
            0.9624,
            exponent,
            plain,
        ),
        exact(
            "v",
            "Speed along the octagon in 120 s",
            0.4024,
            octagon.v,
            Unit::Number(4, "m/s"),
        ),
    ];
    claims.extend(CASE_1.iter().map(|of| of_laps("case1", of, &octagon)));
    claims.push(driven(evidence));
    claims.extend(CASE_2.iter().map(|of| of_laps("case2", of, &square)));
    claims.extend(fictive(evidence));
    Ok(claims)
}

fn exact(id: &str, claim: &str, published: f64, ours: f64, unit: Unit) -> Claim {
    let finding = Finding::exact(published, ours, unit);
    let published = Published::number(published, unit);
    Claim::number((Paper::Patrol, id), claim, published, EXACT, finding)
}

fn of_laps(case: &str, &(id, claim, published, unit, metric): &OfLaps, laps: &Laps) -> Claim {
    let finding = Finding::one_run(published, &laps.values(metric), unit, "keys");
    let published = Published::number(published, unit);
    let id = format!("{case}.{id}");
    Claim::number((Paper::Patrol, &id), claim, published, ONE_RUN, finding)
}

/// Returns the missions of a case with a value of its parameter.
fn cell<'a>(cells: &'a [Cell], case: &str, value: &str) -> Option<&'a Cell> {
    cells.iter().find(|c| c.case == case && c.value == value)
}

/// Returns the claim about the distance from the octagon that the simulated robot drives.
fn driven(evidence: &Evidence) -> Claim {
    let published = 0.9352;
    let study = evidence.alpha.as_ref();
    let found = study.and_then(|study| cell(&study.cells, "paper_fit", "1.7"));
    let finding = match found {
        Some(cell) => {
            let driven = |row| Some(laps(row, true)?.mae_m);
            let values: Vec<f64> = cell.rows.values().filter_map(driven).collect();
            Finding::one_run(published, &values, METRES, "missions")
        }
        None => Finding::missing(&format!("experiment {ALPHA}")),
    };
    let text = "§5.1: MAE, of the path that the simulated robot drives";
    let published = Published::number(published, METRES);
    let id = (Paper::Patrol, "case1.mae_driven");
    Claim::number(id, text, published, ONE_RUN, finding)
}

/// Returns the claims about fictive obstacles.
fn fictive(evidence: &Evidence) -> Vec<Claim> {
    let study = evidence.square.as_ref();
    let found = study.and_then(|study| cell(&study.cells, "fto", "none"));
    let row = found.and_then(|cell| cell.rows.values().next());
    let lap = row.and_then(|row| laps(row, true));
    let lap_s = row.and_then(|row| {
        row.robots
            .iter()
            .find_map(|r| r.waypoints.as_ref()?.longest_lap_s)
    });
    let turns = lap.and_then(|lap| Some(lap.turns / lap_s?));
    let claim = |id: &str, text: &str, published: f64, unit: Unit, ours: Option<f64>| {
        let finding = match ours {
            Some(ours) => Finding {
                verdict: Verdict::Undecided,
                // Nothing is random: one run is all.
                ours: Measured {
                    of: "mission",
                    ..Measured::computed(ours, unit)
                },
                numbers: Vec::new(),
            },
            None => Finding::missing(&format!("experiment {SQUARE}")),
        };
        let published = Published::number(published, unit);
        let id = format!("fto.{id}");
        Claim::number(
            (Paper::Patrol, &id),
            text,
            published,
            RECONSTRUCTION,
            finding,
        )
    };
    let of = "§5.2, fictive obstacles:";
    vec![
        claim(
            "mae",
            &format!("{of} MAE"),
            1.5769,
            METRES,
            lap.map(|l| l.mae_m),
        ),
        claim(
            "maa",
            &format!("{of} mean absolute angle"),
            0.3681,
            RADIANS,
            lap.map(|l| l.maa),
        ),
        claim(
            "andc",
            &format!("{of} changes of direction per second"),
            0.4024,
            RATE,
            turns,
        ),
    ]
}
