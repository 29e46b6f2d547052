//! Whether what was held grew: from mission to mission, and while a process ran.
//!
//! The same missions come again and again, so that what a process of one holds can be compared with
//! what it held the last times. The first quarter of the time is for warming up, and missions that
//! failed do not count. Of the rest, the quartiles of the first half are held against those of the
//! second: something grew if all three rose. What only comes more often on a busy machine (a pool with
//! a thread more, say) moves one or two of them. And the medians must differ by more than missions do: a few of
//! them whose memory goes up and down tell nothing.
//!
//! Of processes that ran for long ([`LONG`]), memory in the last quarter of a life is held against that in the
//! second and in the third of the same life. Growth goes on: what takes a step once and is level before and
//! after (a map that changed has been built anew, and what that took was freed but not given back) has not
//! grown. It did if it went on in three lives of four.

use std::collections::BTreeMap;

use serde::Serialize;

use super::mission::{Mission, ORCHESTRATOR};
use crate::planning::summary::quantile;
use crate::statistics::Spread;

/// Missions after warming up from which on growth can be told.
const ENOUGH: usize = 8;

/// Times that a process was looked at, twenty times a second, from which on growth while it ran can be
/// told: 10 s. Lives have their warming up too (what an optimiser holds rises with the largest plan so far),
/// and missions without a clock are over within a few seconds.
pub const LONG: usize = 200;

/// Share of growth over the soak that passes for flat.
pub const FLAT: f64 = 0.01;

/// Bytes of growth over the soak that pass for flat: a few pages of memory come and go with the
/// moment at which one looks.
pub const PAGES: f64 = 65_536.0;

/// Memory from mission to mission.
pub const MEMORY: &str = "memory";
/// Memory while a process runs.
pub const IN_FLIGHT: &str = "memory in flight";
/// Open descriptors from mission to mission.
pub const DESCRIPTORS: &str = "descriptors";
/// Pieces of shared memory from mission to mission.
pub const SEGMENTS: &str = "segments";

/// What became of a quantity over the soak.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Growth {
    /// Whose: `scenario/process`, or `orchestrator`.
    pub who: String,
    /// What: [`MEMORY`], [`IN_FLIGHT`], [`DESCRIPTORS`] or [`SEGMENTS`].
    pub what: &'static str,
    /// Missions that it is told from.
    pub missions: usize,
    /// Median of the first half, or of the second quarters of lives [bytes, or a number].
    pub first: f64,
    /// Median of the second half, or of the last quarters.
    pub last: f64,
    /// Growth from the end of the warming up to the end, by the first median.
    pub share: f64,
    /// Whether that is more than chance makes of it.
    pub grew: bool,
}

/// What became of everything in a row of missions.
pub fn of(missions: &[Mission]) -> Vec<Growth> {
    let mut series: BTreeMap<(String, &'static str), Vec<(f64, f64)>> = BTreeMap::new();
    let mut lives: BTreeMap<String, Vec<[u64; 3]>> = BTreeMap::new();
    for mission in missions.iter().filter(|m| m.failure.is_none()) {
        let at = mission.begun_s + mission.lasted_s;
        let mut add = |who: String, what, value: u64| {
            series
                .entry((who, what))
                .or_default()
                .push((at, value as f64));
        };
        for (name, held) in &mission.processes {
            let who = if name == ORCHESTRATOR {
                name.clone()
            } else {
                format!("{}/{name}", mission.scenario)
            };
            if let Some(parts) = held.quarters_bytes.filter(|_| held.samples >= LONG) {
                lives.entry(who.clone()).or_default().push(parts);
            }
            add(who.clone(), MEMORY, held.memory_bytes);
            add(who, DESCRIPTORS, held.descriptors);
        }
        add(mission.scenario.clone(), SEGMENTS, mission.segments);
    }
    let end = missions.last().map_or(0.0, |m| m.begun_s + m.lasted_s);
    let in_flight = lives.into_iter().filter_map(|(who, l)| in_flight(who, &l));
    series
        .into_iter()
        .filter_map(|((who, what), values)| growth(who, what, &values, end))
        .chain(in_flight)
        .collect()
}

/// Of the lives of one process, each with its memory in the last three quarters [bytes].
fn in_flight(who: String, lives: &[[u64; 3]]) -> Option<Growth> {
    if lives.len() < ENOUGH {
        return None;
    }
    let values = |index: usize| lives.iter().map(move |life| life[index] as f64);
    let (first, last) = (middle(values(0))?, middle(values(2))?);
    let share = (last - first) / first.max(1.0);
    Some(Growth {
        who,
        what: IN_FLIGHT,
        missions: lives.len(),
        first,
        last,
        share,
        grew: lives.iter().filter(|life| goes_on(life)).count() * 4 >= lives.len() * 3,
    })
}

/// Whether memory rose over a life by more than chance makes of it, and by its share (at least a third) in each
/// of the two steps.
fn goes_on([second, third, last]: &[u64; 3]) -> bool {
    let too_much = PAGES.max(FLAT * *second as f64);
    let rise = |from: u64, to: u64| to as f64 - from as f64;
    rise(*second, *last) > too_much
        && rise(*second, *third) > too_much / 3.0
        && rise(*third, *last) > too_much / 3.0
}

/// The median.
fn middle(values: impl Iterator<Item = f64>) -> Option<f64> {
    Spread::of(values).map(|s| s.median)
}

fn quartiles(values: impl Iterator<Item = f64>) -> [f64; 3] {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    [0.25, 0.5, 0.75].map(|share| quantile(&values, share).unwrap_or(0.0))
}

/// Whether all three quartiles of bytes rose by more than chance makes of it, when the rise is taken
/// `stretch` times.
fn all_rose(
    early: impl Iterator<Item = f64>,
    late: impl Iterator<Item = f64>,
    stretch: f64,
) -> bool {
    let mut pairs = quartiles(early).into_iter().zip(quartiles(late));
    pairs.all(|(early, late)| {
        let change = (late - early) * stretch;
        change > PAGES && change > FLAT * early
    })
}

/// How far the median may be off with so many values: medians whose notches do not overlap differ
/// (R. `McGill`, J. Tukey and W. Larsen, "Variations of box plots", 1978: 1.57 interquartile ranges by the root of the number).
fn notch(values: impl Iterator<Item = f64> + Clone) -> f64 {
    let number = values.clone().count().max(1) as f64;
    let [lower, _, upper] = quartiles(values);
    1.57 * (upper - lower) / number.sqrt()
}

/// The values of a series.
fn of_series(half: &[(f64, f64)]) -> impl Iterator<Item = f64> + Clone {
    half.iter().map(|v| v.1)
}

/// Of one series of (time [s], value) that rises in time; `None` if there is too little of it.
fn growth(who: String, what: &'static str, values: &[(f64, f64)], end: f64) -> Option<Growth> {
    let warm: Vec<(f64, f64)> = values
        .iter()
        .copied()
        .filter(|(at, _)| *at >= 0.25 * end)
        .collect();
    if warm.len() < ENOUGH {
        return None;
    }
    let (early, late) = warm.split_at(warm.len() / 2);
    let times = |half: &[(f64, f64)]| middle(half.iter().map(|v| v.0));
    let (first, last) = (middle(of_series(early))?, middle(of_series(late))?);
    let apart = times(late)? - times(early)?;
    // The medians are half of the time apart; growth is told for all of it.
    let stretch = if apart > 0.0 { 0.75 * end / apart } else { 1.0 };
    let change = (last - first) * stretch;
    let share = change / first.max(1.0);
    let grew = match what {
        MEMORY => {
            all_rose(of_series(early), of_series(late), stretch)
                && last - first > notch(of_series(early)) + notch(of_series(late))
        }
        // Counts are whole: one more is more.
        _ => quartiles(of_series(early))
            .into_iter()
            .zip(quartiles(of_series(late)))
            .all(|(early, late)| late > early),
    };
    Some(Growth {
        who,
        what,
        missions: warm.len(),
        first,
        last,
        share,
        grew,
    })
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::soak::mission::Use;

    fn series(value: impl Fn(f64) -> f64) -> Vec<(f64, f64)> {
        (0..100)
            .map(|i| (f64::from(i), value(f64::from(i))))
            .collect()
    }

    fn judged(what: &'static str, value: impl Fn(f64) -> f64) -> Growth {
        growth("x".into(), what, &series(value), 99.0).unwrap()
    }

    #[test]
    fn warming_up_is_no_growth() {
        let warm = judged(MEMORY, |t| if t < 20.0 { 1e6 * t } else { 2e7 });
        assert!(!warm.grew && warm.share == 0.0, "{warm:?}");
    }

    #[test]
    fn a_leak_is_told_with_its_size() {
        // 2 % of 10 MB from the end of the warming up to the end.
        let leak = judged(MEMORY, |t| 1e7 * (1.0 + 0.02 * (t - 25.0) / 75.0));
        assert!(leak.grew, "{leak:?}");
        assert!((leak.share - 0.02).abs() < 0.002, "{leak:?}");
    }

    #[test]
    fn few_missions_whose_memory_goes_up_and_down_tell_nothing() {
        let values = [5.35, 5.75, 5.21, 5.43, 5.73, 5.53, 5.85, 5.58];
        let of = |leak: f64| {
            let at = |(i, v): (u32, &f64)| (f64::from(50 + i), (v + leak * f64::from(i)) * 1e6);
            let values: Vec<(f64, f64)> = (0..).zip(&values).map(at).collect();
            growth("x".into(), MEMORY, &values, 60.0).unwrap()
        };
        let level = of(0.0);
        assert!(!level.grew && level.share > FLAT, "{level:?}");
        assert!(of(0.2).grew);
    }

    #[test]
    fn one_descriptor_more_is_a_leak_and_a_page_of_memory_is_not() {
        assert!(judged(DESCRIPTORS, |t| if t < 60.0 { 20.0 } else { 21.0 }).grew);
        assert!(!judged(MEMORY, |t| 1e5 + if t < 60.0 { 0.0 } else { 4096.0 }).grew);
    }

    #[test]
    fn a_process_that_grows_while_it_runs_is_told() {
        let lives = |a: [u64; 3], b: [u64; 3]| in_flight("x".into(), &[a, b].repeat(ENOUGH / 2));
        let grows = lives(
            [1_000_000, 1_050_000, 1_100_000],
            [1_000_000, 1_040_000, 1_080_000],
        );
        let grows = grows.unwrap();
        assert!(grows.grew && (grows.share - 0.09).abs() < 1e-9, "{grows:?}");
        let level = lives([900_000; 3], [1_000_000, 1_000_000, 1_001_000]);
        assert!(!level.unwrap().grew);
        // A step and no more, whether early or late.
        for step in [
            [1_000_000, 1_100_000, 1_100_000],
            [1_000_000, 1_000_000, 1_100_000],
        ] {
            assert!(!lives(step, step).unwrap().grew);
        }
        // In every other life only, though the medians of all rose.
        let some = [[1_000_000, 1_050_000, 1_100_000], [1_020_000; 3]];
        assert!(!lives(some[0], some[1]).unwrap().grew);
        // Lives that differ, one from the other, by more than any of them grew.
        let leaks = |base: u64| [base, base + 50_000, base + 100_000];
        assert!(lives(leaks(1_000_000), leaks(2_000_000)).unwrap().grew);
        assert!(in_flight("x".into(), &[]).is_none());
    }

    #[test]
    fn of_short_lives_nothing_is_said() {
        let missions = |samples: usize| -> Vec<Mission> {
            let held = Use {
                samples,
                memory_bytes: 1_100_000,
                descriptors: 30,
                quarters_bytes: Some([1_000_000, 1_050_000, 1_100_000]),
            };
            let mission = |number: u32| Mission {
                scenario: "chase".into(),
                seed: 1,
                begun_s: f64::from(number),
                lasted_s: 1.0,
                processes: BTreeMap::from([("pursuer".to_owned(), held.clone())]),
                segments: 9,
                leftovers: Vec::new(),
                failure: None,
            };
            (0..20).map(mission).collect()
        };
        let in_flight = |samples| {
            let growth = of(&missions(samples));
            growth.into_iter().find(|g| g.what == IN_FLIGHT)
        };
        assert_eq!(in_flight(LONG - 1), None);
        assert!(in_flight(LONG).unwrap().grew);
    }

    #[test]
    fn of_a_few_missions_nothing_is_said() {
        assert!(growth("x".into(), MEMORY, &series(|_| 1.0)[..7], 1.0).is_none());
    }

    proptest! {
        #[test]
        fn what_is_level_is_never_called_growth(level in 1e4..1e9_f64, outliers in prop::collection::vec(0_usize..100, 0..10)) {
            let mut values = series(|_| level);
            for index in outliers {
                values[index].1 *= 3.0;
            }
            // Fewer than a quarter of the values of either half are outliers.
            prop_assert!(!growth("x".into(), MEMORY, &values, 99.0).unwrap().grew);
        }
    }
}
