use super::*;
use crate::claim::{Finding, Measured, ONE_RUN, Published, Unit};
use statistics::Interval;

fn claims() -> Vec<Claim> {
    let unit = Unit::Number(2, "m");
    let finding = Finding::one_run(2.0, &[1.0, 1.5, 1.5, 1.5, 2.0], unit, "keys");
    let published = Published::number(2.0, unit);
    let number = Claim::number(
        (Paper::Patrol, "a|b"),
        "a | <b>",
        published,
        ONE_RUN,
        finding,
    );
    let open = Measured {
        text: "above 1.2×".to_owned(),
        value: None,
        interval: Some(Interval {
            low: 1.2,
            high: f64::INFINITY,
        }),
        unit: Unit::Speed,
        n: 3,
        of: "games",
    };
    let finding = Finding {
        verdict: Verdict::Refuted,
        ours: open,
        numbers: vec!["p < 0.0001".to_owned()],
    };
    let timed = Claim {
        timed: true,
        ..Claim::number(
            (Paper::Chase, "c"),
            "quick",
            Published::text("often"),
            "a rule",
            finding,
        )
    };
    vec![number, timed]
}

fn report() -> Report {
    let claims = claims();
    Report {
        program: "0.0.0",
        papers: [Paper::Patrol, Paper::Chase]
            .map(|paper| summary(paper, &claims))
            .into(),
        experiments: vec![Ran {
            name: "patrol_alpha".to_owned(),
            seeds: "1..3".to_owned(),
            missions: 6,
            failed: 1,
        }],
        claims,
        pages: Vec::new(),
    }
}

#[test]
fn the_table_has_a_row_for_every_claim() {
    let text = markdown::text(&report());
    for row in [
        "| patrol | a \\| <b> | 2.00 m | 1.50 m | 0.42 … 2.58 | 5 keys | **confirmed** |",
        "| chase | quick † | often | above 1.2× | above 1.2× | 3 games | **refuted** |",
        "| patrol | Cat-map patrol paper | 1 | 0 | 0 | 0 |",
        "| `patrol_alpha` | 1..3 | 6 | 1 |",
        "- From `chase.c` on: a rule",
    ] {
        assert!(text.lines().any(|line| line == row), "{row}\n{text}");
    }
}

#[test]
fn the_same_numbers_are_data() {
    let json = report().json().unwrap();
    let [number, timed] = [&json["claims"][0], &json["claims"][1]];
    assert_eq!(number["paper"], "patrol");
    assert_eq!(number["id"], "patrol.a|b");
    assert_eq!(number["published"]["value"], 2.0);
    assert_eq!(number["ours"]["unit"], "m");
    assert_eq!(number["verdict"], "confirmed");
    let low = number["ours"]["interval"][0].as_f64().unwrap();
    // s = √0.125, t with 4 degrees of freedom 2.77645: 1.5 − 2.77645 s √(1 + 1/5).
    assert!((low - (1.5 - 1.075_313)).abs() < 1e-5, "{low}");
    assert_eq!(timed["ours"]["interval"][1], serde_json::Value::Null);
    assert_eq!(timed["timed"], true);
    assert_eq!(json["papers"][1]["verdicts"]["refuted"], 1);
}

#[test]
fn the_page_escapes_texts() {
    let page = html::text(&report());
    assert!(
        page.contains("a | &lt;b&gt;") && !page.contains("<b>"),
        "{page}"
    );
    assert!(page.contains("<li>p &lt; 0.0001</li>"), "{page}");
    assert!(
        page.ends_with("</html>\n") && !page.contains("{{"),
        "{page}"
    );
}
