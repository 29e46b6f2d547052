use recorder::{
    CoverageByWay, CoverageOutcome, LapFigures, PredictionOutcome, RobotOutcome, WaypointOutcome,
};
use sweep::{Outcome, Row};

use super::evidence::{Cell, Study};
use super::*;
use crate::claim::Verdict::{Confirmed, NoData, Refuted, Undecided};

fn row(length_m: f64, mae_m: f64) -> Row {
    let lap = LapFigures {
        length_m,
        mae_m,
        turns: 119.0,
        maa: 1.94,
        maa_fold: 0.77,
    };
    let mut row = Row::failed("");
    row.outcome = Outcome::Ended;
    row.robots = vec![RobotOutcome {
        name: "guard".into(),
        team: "neutral".into(),
        role: "neutral".into(),
        outcome: "active".into(),
        time_s: 600.0,
        distance_m: 580.0,
        contacts: 0,
        fail_safe_stops: 0,
        fail_safe_ticks: 0,
        standstills: 0,
        escape_possible_fraction: None,
        escape_impossible_from_s: None,
        waypoints: Some(WaypointOutcome {
            reached: 90,
            inside_obstacle: 10,
            timed_out: 0,
            unreachable: 0,
            route_left_out: 0,
            farthest_m: 0.05,
            laps: Some(5),
            longest_lap_s: Some(118.0),
            lap_limit_s: Some(120.0),
            planned: Some(lap),
            driven: Some(lap),
        }),
    }];
    row.coverage = Some(CoverageOutcome {
        fraction: 0.8,
        coverable_fraction: 0.84,
        free_m2: 100.0,
        visited_m2: 80.0,
        mean_idleness_s: 100.0,
        worst_idleness_s: 900.0,
        unevenness: 0.5,
        way_m: 1100.0,
        by_way: vec![CoverageByWay {
            way_m: 1000.0,
            coverable_fraction: 0.8125,
        }],
    });
    row
}

fn study(case: &str, value: &str, rows: Vec<Row>) -> Study {
    Study {
        program: "0.1.0".into(),
        seeds: "1..2".into(),
        cells: vec![Cell {
            case: case.into(),
            value: value.into(),
            rows: (1..).zip(rows).collect(),
        }],
    }
}

fn line(page: &Page, start: &str) -> String {
    let mut lines = page.text.lines();
    lines.find(|l| l.starts_with(start)).unwrap().to_owned()
}

#[test]
fn without_results_the_page_has_notes_and_the_table_of_sequences() {
    let page = page(&Evidence::default()).unwrap();
    let missing = page.text.matches("*No results of this experiment.*");
    assert_eq!(missing.count(), 3);
    assert!(page.images.is_empty());
    // The paper: 0.8309, 0.8074 in floating point.
    let original = line(&page, "| original | 2000 |");
    assert!(original.contains("0.8309 | 0.8074"), "{original}");
}

#[test]
fn means_are_shown_with_the_published_values() {
    let page = page(&made_up()).unwrap();
    // A lap has 117 m in 120 s.
    let alpha = line(&page, "| paper_fit | 1.7 |");
    assert!(
        alpha.contains("| 0.97 ±") && alpha.contains("| 0.92 ±"),
        "{alpha}"
    );
    let square = line(&page, "| small | awg |");
    assert!(
        square.contains("0.71 |") && square.contains("| 0.10 |"),
        "{square}"
    );
    assert!(line(&page, "| chebyshev raw | – | – | 0.812 | – |").contains("0.50"));
    let names: Vec<_> = page.images.iter().map(|image| image.name).collect();
    assert_eq!(names, ["patrol-speed", "patrol-mae", "coverage-by-way"]);
    assert_eq!(page.images[0].chart.series[0].reference[0].y, 0.9651);
}

/// Synthetic results of all three experiments.
fn made_up() -> Evidence {
    Evidence {
        alpha: Some(study(
            "paper_fit",
            "1.7",
            vec![row(116.0, 0.9), row(118.0, 0.94)],
        )),
        square: Some(study("awg", "small", vec![row(75.0, 0.71)])),
        coverage: Some(study("chebyshev_raw", "", vec![row(1.0, 1.0)])),
    }
}

#[test]
fn one_run_repeated_has_no_interval() {
    let mut repeated = made_up();
    // The mean of five times this number is not exactly this number.
    let run = row(75.0, 0.958_442_808_795_306_5);
    repeated.square = Some(study("fto", "none", vec![run; 5]));
    let page = page(&repeated).unwrap();
    let fto = line(&page, "| none | fto | 0.96");
    assert!(!fto.contains('±'), "{fto}");
}

#[test]
fn an_observer_that_knows_the_method_has_a_column_of_its_own() {
    let prediction = |method: &str, mean_m| PredictionOutcome {
        observer: 0,
        robot: "sweeper".into(),
        method: method.into(),
        horizon_s: 5.0,
        predictions: 100,
        without: 0,
        mean_m: Some(mean_m),
        median_m: None,
        rms_m: None,
        goals_observed: 50,
        key_recovered_s: None,
        key_recovered_after: None,
    };
    let mut known = row(1.0, 1.0);
    known.predictions = vec![
        prediction("similar_goal_per_axis", 0.96),
        prediction("kalman", 2.5),
        prediction("chebyshev_key", 0.2),
    ];
    let mut evidence = made_up();
    evidence.coverage = Some(study("chebyshev_arcsine", "", vec![known]));
    let row = line(&page(&evidence).unwrap(), "| chebyshev arcsine |");
    assert!(row.ends_with("| – | 0.96 | 0.20 |"), "{row}");
}

#[test]
fn the_page_is_what_it_was() {
    let page = page(&made_up()).unwrap();
    assert_eq!(page.text, include_str!("expected.md"));
}

#[test]
fn the_numbers_of_the_patrol_are_claims() {
    let claims = list(&Evidence::default()).unwrap();
    let verdict = |id: &str| claims.iter().find(|c| c.id == id).unwrap().verdict;
    for (id, expected) in [
        ("patrol.lyapunov", Confirmed),
        ("patrol.v", Confirmed),
        ("patrol.case1.speed", Confirmed),
        ("patrol.case1.mae", Confirmed),
        // A mean of folded angles, not of angles.
        ("patrol.case1.maa", Refuted),
        ("patrol.case1.maa_folded", Confirmed),
        // The speed, copied.
        ("patrol.case1.andc", Refuted),
        ("patrol.case2.mae", Confirmed),
        ("patrol.case2.andc", Refuted),
        ("patrol.case1.mae_driven", NoData),
        ("patrol.fto.mae", NoData),
    ] {
        assert_eq!(verdict(id), expected, "{id}");
    }
}

#[test]
fn the_numbers_of_the_coverage_are_claims() {
    let with_coverage = |case: &str, share: f64, seed: u64| {
        let mut row = row(113.0, 0.9);
        let coverage = row.coverage.as_mut().unwrap();
        coverage.by_way[0].coverable_fraction = share + 0.001 * seed as f64;
        coverage.unevenness = if case.ends_with("raw") { 0.6 } else { 0.9 };
        (seed, row)
    };
    let cell = |case: &str, share: f64| Cell {
        case: case.into(),
        value: String::new(),
        rows: (1..=3)
            .map(|seed| with_coverage(case, share * seed as f64, seed))
            .collect(),
    };
    let evidence = Evidence {
        coverage: Some(Study {
            cells: vec![cell("chebyshev_arcsine", 0.1), cell("chebyshev_raw", 0.2)],
            ..Study::default()
        }),
        ..Evidence::default()
    };
    let claims = coverage_list(&evidence);
    let claim = |id: &str| claims.iter().find(|c| c.id == id).unwrap();
    for (id, expected) in [
        ("coverage.lyapunov", Confirmed),
        ("coverage.lyapunov_arcsine", Refuted),
        ("coverage.v.raw.2000", Confirmed),
        ("coverage.v.raw.falls", Refuted),
        ("coverage.v.lower", Confirmed),
        // −0.1, −0.2 and −0.3: the interval contains 0 by 0.05.
        ("coverage.covers_more", Undecided),
        ("coverage.more_even", Refuted),
    ] {
        assert_eq!(claim(id).verdict, expected, "{:?}", claim(id));
    }
    assert_eq!(claim("coverage.v.arcsine.10000").ours.n, 200);
}
