use std::collections::BTreeMap;

use super::evidence::{Plan, Study};
use super::*;

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
fn without_results_the_page_says_so() {
    let page = page(&Evidence::default());
    assert_eq!(
        page.text
            .matches("*No results of this experiment.*")
            .count(),
        2
    );
    assert!(page.images.is_empty());
    assert!(page.text.starts_with(crate::chase_page::MARK));
}

#[test]
fn counts_are_set_beside_the_published_ones() {
    let mut study = Study::default();
    let mut put = |value: &str, failed| {
        let key = ("vmc".to_owned(), value.to_owned());
        study.cells.insert(key, plans(500, failed, 39.0, 2.0));
    };
    put("radius_5_15", 3);
    put("radius_20_30", 4);
    put("obstacles_1_10", 3);
    put("obstacles_30_40", 60);
    let evidence = Evidence {
        sensitivity: Some(study),
        versus: None,
    };
    let page = page(&evidence);
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
fn methods_are_set_beside_each_other_where_both_have_a_plan() {
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
    let text = page(&evidence).text;
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
    // The published tables by themselves.
    assert!(
        text.contains("(Table 3), published | 6, 6 of 6 | 33.13, 34.07 | 5/6 "),
        "{text}"
    );
}
