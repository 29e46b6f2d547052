//! Tests of verdicts, and of the page as a whole.

mod claims;
mod results;
mod verdicts;

use super::evidence::{Cell, Evidence, Method, Study};
use super::page;
use crate::plans::{Plan, Plans};
use crate::statistics::BySeed;
use draw::figures::draw;

/// Number of games of a cell.
const GAMES: u64 = 200;

/// Returns games of two evaders; in this share of them (%) both escape. Which these are depends on the cell
/// alone: cells are independent.
fn games(cell: u64, percent: u32) -> BySeed {
    let mut order: Vec<u64> = (1..=GAMES).collect();
    order.sort_by_key(|&seed| mixed(seed ^ mixed(cell)));
    let escaped = |rank: u64| 100 * rank < u64::from(percent) * GAMES;
    (0..)
        .zip(order)
        .map(|(rank, seed)| (seed, if escaped(rank) { (2, 2) } else { (0, 2) }))
        .collect()
}

/// The generator `SplitMix64`: distributes the bits of a number.
fn mixed(value: u64) -> u64 {
    let z = value.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

/// Returns a study of 200 games per cell: methods with their chances (%) at each speed.
fn study(ratios: &[f64], methods: &[(&str, &[u32])]) -> Study {
    let cells = methods.iter().flat_map(|(name, percents)| {
        ratios.iter().zip(*percents).map(|(&ratio, percent)| Cell {
            method: (*name).to_owned(),
            ratio,
            games: games(
                name.bytes().map(u64::from).sum::<u64>() * 100 + (10.0 * ratio) as u64,
                *percent,
            ),
            caught: u64::from(400 - percent * 4),
            ..Cell::default()
        })
    });
    Study {
        name: "test".to_owned(),
        program: "0.1.0".to_owned(),
        seeds: "1..200".to_owned(),
        methods: methods
            .iter()
            .map(|(name, _)| Method {
                name: (*name).to_owned(),
                title: name.replace('_', " "),
            })
            .collect(),
        cells: cells.collect(),
    }
}

const SPEEDS: [f64; 7] = [0.8, 0.9, 1.0, 1.5, 2.0, 2.5, 3.0];

fn speed() -> Study {
    study(
        &SPEEDS,
        &[
            ("braitenberg", &[0, 0, 1, 1, 2, 3, 4]),
            ("potential_field", &[1, 2, 4, 20, 50, 65, 75]),
            ("rrt_star_line", &[5, 10, 25, 62, 80, 88, 90]),
            ("rrt_star_arc", &[4, 9, 22, 60, 78, 86, 88]),
        ],
    )
}

fn knowledge() -> Study {
    study(
        &SPEEDS,
        &[
            ("exact", &[5, 10, 25, 62, 80, 88, 90]),
            ("particle_filter", &[35, 50, 60, 85, 92, 95, 96]),
        ],
    )
}

fn plan(case: &str, scene: &str, seed: u64, closest: Option<f64>) -> Plan {
    Plan {
        case: case.to_owned(),
        scene: scene.to_owned(),
        seed,
        iterations: 5000,
        found: closest.is_some(),
        length_m: closest.map(|_| 18.0),
        closest_m: closest,
        shortest_m: Some(17.14),
        shortest_closest_m: Some(0.5),
    }
}

fn plans() -> Plans {
    let seeds = || 1..=40_u64;
    let arcs = seeds().map(|s| plan("rrt_star_arc", "start", s, Some(1.0)));
    let old = seeds().map(|s| {
        plan(
            "rrt_star_arc_paper",
            "start",
            s,
            s.is_multiple_of(3).then_some(1.0),
        )
    });
    let around = seeds().map(|s| plan("rrt_star_line", "random", s, Some(1.5 + 0.01 * s as f64)));
    Plans(arcs.chain(old).chain(around).collect())
}

fn evidence() -> Evidence {
    Evidence {
        speed: Some(speed()),
        speed_rrt_star: None,
        speed_paper: None,
        knowledge: Some(knowledge()),
        knowledge_paper: Some(knowledge()),
        plans: Some(plans()),
    }
}

#[test]
fn the_page_is_what_it_was() {
    let page = page(&evidence()).unwrap();
    assert_eq!(page.text, include_str!("expected.md"));
}

#[test]
fn the_page_shows_its_pictures() {
    let page = page(&evidence()).unwrap();
    assert_eq!(page.images.len(), 3);
    for image in &page.images {
        assert!(
            page.text.contains(&format!("(images/{}.svg)", image.name)),
            "{}",
            image.name
        );
        let svg = draw(&image.chart).svg();
        assert!(roxmltree::Document::parse(&svg).is_ok());
        for series in &image.chart.series {
            assert!(
                svg.contains(&format!("<title>{}</title>", series.name)),
                "{}",
                series.name
            );
        }
    }
    let published: usize = page.images[2]
        .chart
        .series
        .iter()
        .map(|s| s.reference.len())
        .sum();
    assert_eq!(published, 6);
}

#[test]
fn every_cell_has_a_row() {
    let text = page(&evidence()).unwrap().text;
    let rows = text.lines().filter(|l| l.contains(" / 400 |")).count();
    assert_eq!(rows, 7 * 2);
    assert!(
        text.contains("| particle filter | 0.9× | 200 | 200 / 400 | 50.0 % |"),
        "{text}"
    );
    assert!(text.contains("| games | 200 | 200 | 200 | 200 |"), "{text}");
    assert!(
        text.contains("| 2.0× | 2 % (1 … 5) | 50 % (43 … 57) | 80 % ("),
        "{text}"
    );
}

#[test]
fn rrt_star_evaders_of_another_experiment_are_columns_beside_the_others() {
    let mut evidence = evidence();
    evidence.speed_rrt_star = Some(study(&[0.8, 1.0], &[("rrt_star_other", &[10, 90])]));
    let text = page(&evidence).unwrap().text;
    assert!(
        text.contains("| rrt star arc | rrt star other |\n"),
        "{text}"
    );
    assert!(text.contains("| rrt star other | 0.8× … 1.0× |"), "{text}");
    assert!(text.contains("| 88 % (83 … 92) | – |\n"), "{text}");
}

#[test]
fn without_results_the_page_has_a_note() {
    let page = page(&Evidence::default()).unwrap();
    assert!(page.images.is_empty());
    assert_eq!(
        page.text
            .matches("*No results of this experiment.*")
            .count(),
        4
    );
    assert!(!page.text.contains("**confirmed**") && !page.text.contains("**refuted**"));
}
