use std::collections::BTreeMap;

use super::evidence::{Plan, Study};
use super::*;
use crate::claim::Verdict::{Confirmed, NoData, Refuted};

fn plans(count: u64, failed: u64, time: f64, cpu_ms: f64) -> BTreeMap<u64, Plan> {
    (0..count)
        .map(|seed| {
            let plan = Plan {
                unsolvable: false,
                time: (seed >= failed).then_some(time),
                cpu_ms: Some(cpu_ms),
            };
            (seed, plan)
        })
        .collect()
}

#[test]
fn without_results_the_page_has_a_note() {
    let page = page(&Evidence::default()).unwrap();
    assert_eq!(
        page.text
            .matches("*No results of this experiment.*")
            .count(),
        2
    );
    assert!(page.images.is_empty());
}

#[test]
fn counts_are_compared_with_the_published_ones() {
    let mut study = Study::default();
    let mut put = |value: &str, failed, time| {
        let key = ("vmc".to_owned(), value.to_owned());
        study.cells.insert(key, plans(500, failed, time, 2.0));
    };
    put("radius_5_15", 3, 39.0);
    put("radius_20_30", 4, 39.0);
    put("obstacles_1_10", 3, 38.0);
    put("obstacles_30_40", 60, 38.0);
    let evidence = Evidence {
        sensitivity: Some(study),
        versus: None,
    };
    let page = page(&evidence).unwrap();
    let line = |start: &str| {
        let mut lines = page.text.lines();
        lines.find(|l| l.starts_with(start)).unwrap().to_owned()
    };
    assert!(line("| radius | 5 … 15 px | 6/500 | 3/500 |").contains("does not contradict"));
    assert!(line("| radius | 20 … 30 px | 125/500 | 4/500 |").contains("fewer fail here"));
    assert!(line("| radius | sensitive | +23.8 | +0.2 |").contains("hardly matters"));
    assert!(line("| obstacles | sensitive | +9.8 | +11.4 |").contains("confirmed"));
    assert!(line("| nodes | 10 | 20/500 | – |").contains("no results"));
    assert_eq!(page.images.len(), 1);
}

#[test]
fn settings_of_one_set_of_runs_are_counted_once() {
    let mut study = Study::default();
    for (value, failed, time) in [
        ("degree_4", 15, 39.0),
        ("nodes_15", 15, 39.0),
        ("radius_5_15", 15, 39.0),
        ("degree_6", 5, 38.0),
    ] {
        let key = ("vmc".to_owned(), value.to_owned());
        study.cells.insert(key, plans(500, failed, time, 2.0));
    }
    let evidence = Evidence {
        sensitivity: Some(study),
        versus: None,
    };
    let text = page(&evidence).unwrap().text;
    // 15 of 500 against 2 of 500 and 6 of 500 (twice): Fisher's test of 15/500 and 8/1000 gives 0.00266, Holm's
    // correction over two tests, 15/500 and 5/500, doubles it.
    let row =
        "| degree<br>nodes<br>radius | 4<br>15<br>5 … 15 px | 2/500<br>6/500<br>6/500 | 15/500 |";
    let row = text.lines().find(|l| l.starts_with(row)).unwrap();
    assert!(row.ends_with("more fail here | p = 0.0053 |"), "{row}");
    assert!(!text.contains("| nodes | 15 | 6/500 | 15/500"), "{text}");
    // 10 seeds fail with degree 4 alone: 2 / 2¹⁰ by McNemar's exact test.
    let row = "| degree | less sensitive | +0.6 | −2.0 | ";
    let row = text.lines().find(|l| l.starts_with(row)).unwrap();
    assert!(
        row.contains("| 10, 0 |") && row.ends_with("p = 0.0020 |"),
        "{row}"
    );
}

#[test]
fn methods_are_compared_where_both_have_a_plan() {
    let mut study = Study::default();
    for horizon in ["only", "first", "second"] {
        for (case, failed, time, cpu) in [("lp", 10, 30.0, 1.0), ("vmc", 0, 30.03, 3.0)] {
            let key = (case.to_owned(), horizon.to_owned());
            study.cells.insert(key, plans(100, failed, time, cpu));
        }
    }
    let evidence = Evidence {
        sensitivity: None,
        versus: Some(study),
    };
    let text = page(&evidence).unwrap().text;
    assert!(
        text.contains("| 90, 100 of 100 | 30.00, 30.03 | 90/90 "),
        "{text}"
    );
    assert!(
        text.contains("shorter more often than VMC's: confirmed (ours 270/270"),
        "{text}"
    );
    assert!(
        text.contains("of the time in most tests: **contradicted** (ours 0/270"),
        "{text}"
    );
    // The published tables alone.
    assert!(
        text.contains("(Table 3), published | 6, 6 of 6 | 33.13, 34.07 | 5/6 "),
        "{text}"
    );
}

/// Synthetic results of both experiments: every setting, method and horizon of the page.
fn made_up() -> Evidence {
    let of = |seed: u64, failed: u64, time: f64, cpu_ms: f64| Plan {
        unsolvable: seed.is_multiple_of(97),
        time: (seed % 100 >= failed).then_some(time + 0.01 * (seed % 7) as f64),
        cpu_ms: Some(cpu_ms + 0.1 * (seed % 5) as f64),
    };
    let study = || Study {
        program: "0.1.0".to_owned(),
        seeds: "1..200".to_owned(),
        ..Study::default()
    };
    let cell = |failed, time, cpu_ms| {
        let plans = (1..=200).map(|seed| (seed, of(seed, failed, time, cpu_ms)));
        plans.collect::<BTreeMap<_, _>>()
    };
    let mut sensitivity = study();
    let settings = super::published::TABLE_2
        .iter()
        .flat_map(|row| row.settings);
    for (index, setting) in (0..).zip(settings) {
        for (case, more) in [("vmc", 0), ("vmc_nodes", 9), ("lp", 1), ("lp_nodes", 20)] {
            let key = (case.to_owned(), setting.name.to_owned());
            let failed = index * 5 % 13 + more;
            sensitivity.cells.insert(key, cell(failed, 39.0, 2.0));
        }
    }
    let mut versus = study();
    for (index, horizon) in (0_u32..).map(f64::from).zip(["only", "first", "second"]) {
        for (case, failed, time, cpu_ms) in [
            ("lp", 0, 30.0, 1.0),
            ("vmc", 2, 30.001 + 0.1 * index, 3.0),
            ("lp_paper", 1, 30.02, 1.0 + index),
            ("vmc_paper", 4, 29.9, 1.5),
        ] {
            let key = (case.to_owned(), horizon.to_owned());
            versus.cells.insert(key, cell(failed, time, cpu_ms));
        }
    }
    Evidence {
        sensitivity: Some(sensitivity),
        versus: Some(versus),
    }
}

#[test]
fn the_page_is_what_it_was() {
    let page = page(&made_up()).unwrap();
    assert_eq!(page.text, include_str!("expected.md"));
}

#[test]
fn counts_changes_and_observations_are_claims() {
    let mut study = Study::default();
    let mut put = |case: &str, value: &str, failed, time| {
        let key = (case.to_owned(), value.to_owned());
        study.cells.insert(key, plans(500, failed, time, 2.0));
    };
    put("vmc", "radius_5_15", 3, 39.0);
    put("vmc", "radius_20_30", 4, 38.0);
    let mut versus = Study::default();
    for (case, time) in [("lp", 30.0), ("vmc", 31.0)] {
        let key = (case.to_owned(), "only".to_owned());
        versus.cells.insert(key, plans(20, 0, time, time));
    }
    let evidence = Evidence {
        sensitivity: Some(study),
        versus: Some(versus),
    };
    let claims = list(&evidence);
    let claim = |id: &str| {
        claims
            .iter()
            .find(|c| c.id == format!("vmc-lp.{id}"))
            .unwrap()
    };
    for (id, expected) in [
        ("table2.vmc.radius_5_15", Confirmed),
        ("table2.vmc.radius_20_30", Refuted),
        ("table2.vmc.degree_6", NoData),
        ("table2.vmc.radius.change", Refuted),
        ("tables34.recommended.shorter", Confirmed),
        ("tables34.recommended.quicker", Confirmed),
        ("tables34.as_published.quicker", NoData),
    ] {
        assert_eq!(claim(id).verdict, expected, "{:?}", claim(id));
    }
    let small = claim("table2.vmc.radius_5_15");
    assert_eq!(small.published.text, "6/500");
    assert_eq!((small.ours.text.as_str(), small.ours.n), ("3/500", 500));
    assert!(
        claims
            .iter()
            .filter(|claim| claim.timed)
            .all(|c| c.id.ends_with("quicker"))
    );
    assert_eq!(list(&Evidence::default()).len(), 2);
}
