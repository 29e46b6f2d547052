//! The numbers and words of the report, as claims.

use statistics::wilson;

use super::evidence::{Evidence, SENSITIVITY, Study, VERSUS};
use super::published::RUNS;
use super::sensitivity::{CASES, Change, Count, changed, counted, published, share};
use super::versus::{Observation, PAIRS, observations};
use crate::claim::{Claim, Finding, Measured, Paper, Published, Unit};
use crate::words::p_value;

const COUNTS: &str = "Refuted if Fisher's exact test of ours against the published count, by Holm's method, has \
                      p < 0.05; confirmed if not, and our 95 % interval (Wilson) lies within ±2 points of the \
                      published share.";
const CHANGES: &str = "Change of the share of failed plans on the same seeds, with its 95 % interval. It matters if \
    McNemar's exact test, by Holm's method, has p < 0.05, and hardly matters if the interval lies within ±2 points.";
const OBSERVATIONS: &str = "Confirmed if the 95 % interval (Wilson) of our share lies above one half, refuted if below or \
    if less than 5 % of the pairs differ.";
const NOTABLE: &str =
    "Refuted if Fisher's exact test of our share against the published one has p < 0.05.";

/// Returns all claims.
pub fn list(evidence: &Evidence) -> Vec<Claim> {
    let none = Study::default();
    let study = evidence.sensitivity.as_ref().unwrap_or(&none);
    let mut claims = Vec::new();
    for (case, title) in CASES
        .into_iter()
        .filter(|(case, _)| case.starts_with("vmc"))
    {
        claims.extend(
            counted(study, case)
                .iter()
                .filter_map(|count| of_count(case, title, count)),
        );
    }
    for (case, title) in CASES {
        claims.extend(
            changed(study, case)
                .iter()
                .map(|change| of_change(case, title, change)),
        );
    }
    if claims.iter().all(|claim| claim.ours.n == 0) {
        claims = vec![missing(
            "table2",
            "Table 2: sensitivity to the parameters",
            SENSITIVITY,
        )];
    }
    match &evidence.versus {
        Some(study) => claims.extend(PAIRS.iter().flat_map(|&(lp, vmc, slot, title)| {
            let found = observations(study, (lp, vmc));
            found
                .into_iter()
                .map(move |found| of_observation(slot, title, &found))
        })),
        None => claims.push(missing(
            "tables34",
            "Tables 3 and 4: LP against VMC",
            VERSUS,
        )),
    }
    claims
}

fn missing(id: &str, claim: &str, experiment: &str) -> Claim {
    let finding = Finding::missing(&format!("experiment {experiment}"));
    let published = Published::text("–");
    Claim::number((Paper::VmcLp, id), claim, published, COUNTS, finding)
}

fn of_count(case: &str, title: &str, count: &Count) -> Option<Claim> {
    let (_, first) = count.group.first()?;
    let settings = count
        .group
        .iter()
        .map(|(row, setting)| format!("{} {}", row.parameter, setting.title));
    let settings: Vec<String> = settings.collect();
    let (failed, of) = published(&count.group);
    let finding = match count.ours {
        None => Finding::missing(&format!("settings {}", settings.join(", "))),
        Some(((failed, of), p)) => Finding {
            verdict: count.verdict(),
            ours: counted_share((failed, of), "plans"),
            numbers: vec![p_value(p)],
        },
    };
    // Settings that are one set of runs here, with different published counts.
    let pooled = if of > RUNS { ", together" } else { "" };
    let published = Published {
        text: format!("{failed}/{of}{pooled}"),
        value: Some(share((failed, of))),
    };
    let id = format!("table2.{case}.{}", first.name);
    let claim = format!("Table 2: failed plans, {title}; {}", settings.join(", "));
    Some(Claim::number(
        (Paper::VmcLp, &id),
        claim,
        published,
        COUNTS,
        finding,
    ))
}

fn of_change(case: &str, title: &str, change: &Change) -> Claim {
    let (verdict, words) = change.verdict();
    let seeds = (change.seeds, "seeds");
    let parameter = change.row.parameter;
    let finding = Finding {
        verdict,
        ours: Measured::number(change.ours.value, change.interval, Unit::Points, seeds),
        numbers: vec![format!(
            "{}, {}",
            words.replace("**", ""),
            p_value(change.p)
        )],
    };
    let published = Published {
        text: format!(
            "{}, {}",
            change.row.word(),
            Unit::Points.value(change.published)
        ),
        value: Some(change.published),
    };
    let id = format!("table2.{case}.{}.change", parameter.replace(' ', "_"));
    let claim = format!("Table 2: sensitivity to {parameter}, {title}");
    Claim::number((Paper::VmcLp, &id), claim, published, CHANGES, finding)
}

fn of_observation(slot: &str, title: &str, found: &Observation) -> Claim {
    let (hits, of) = found.published;
    let published = Published {
        text: format!("{hits}/{of}"),
        value: Some(share((hits, of))),
    };
    let finding = Finding {
        verdict: found.verdict,
        ours: counted_share(found.ours, "pairs of plans"),
        numbers: Vec::new(),
    };
    let rule = if found.key == "notable" {
        NOTABLE
    } else {
        OBSERVATIONS
    };
    let id = format!("tables34.{slot}.{}", found.key);
    let claim = format!("Tables 3 and 4: {}. {title}", found.claim);
    Claim {
        timed: found.timed,
        ..Claim::number((Paper::VmcLp, &id), claim, published, rule, finding)
    }
}

/// Returns a count as a share with Wilson's interval.
fn counted_share((hits, of): (u64, u64), what: &'static str) -> Measured {
    if of == 0 {
        return Measured::none();
    }
    Measured {
        text: format!("{hits}/{of}"),
        ..Measured::number(share((hits, of)), wilson(hits, of), Unit::Share, (of, what))
    }
}
