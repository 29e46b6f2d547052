//! Tests of whole charts.

use proptest::prelude::*;
use roxmltree::Document;

use super::*;

fn point(x: f64, y: f64, low: f64, high: f64) -> Point {
    Point {
        x,
        y,
        interval: Some((low, high)),
    }
}

fn chart() -> Chart {
    let bare = |x, y| Point {
        x,
        y,
        interval: None,
    };
    Chart {
        title: "Chance of escape <& speed>".to_owned(),
        subtitle: "Police 0.3 m/s, exact knowledge".to_owned(),
        x_label: "speed of evaders / speed of Police".to_owned(),
        y_label: "evaders that escape".to_owned(),
        reference: "published, about ten games each".to_owned(),
        series: vec![
            Series {
                name: "RRT*".to_owned(),
                points: vec![
                    point(2.0, 0.8, 0.75, 0.84),
                    point(1.5, 0.6, 0.55, 0.65),
                    point(f64::NAN, 0.5, 0.4, 0.6),
                ],
                reference: vec![bare(1.5, 0.6), bare(2.0, 0.8)],
            },
            Series {
                name: "Potential field".to_owned(),
                points: vec![point(1.5, 0.2, 0.16, 0.25), point(2.0, 0.5, 0.45, 0.55)],
                reference: Vec::new(),
            },
        ],
        ..Chart::default()
    }
}

/// Returns the paths in the group of this name.
fn group<'a>(svg: &'a Document<'a>, name: &str) -> Vec<roxmltree::Node<'a, 'a>> {
    let title = |n: &roxmltree::Node<'_, '_>| {
        n.children()
            .any(|c| c.has_tag_name("title") && c.text() == Some(name))
    };
    let group = svg
        .descendants()
        .find(|n| n.has_tag_name("g") && title(n))
        .unwrap();
    group
        .descendants()
        .filter(|n| n.has_tag_name("path"))
        .collect()
}

#[test]
fn the_svg_contains_every_curve_with_its_points() {
    let text = draw(&chart()).svg();
    let svg = Document::parse(&text).unwrap();
    let texts: Vec<_> = svg.descendants().filter_map(|n| n.text()).collect();
    for expected in [
        "Chance of escape <& speed>",
        "Police 0.3 m/s, exact knowledge",
        "speed of evaders / speed of Police",
        "evaders that escape",
        "RRT*",
        "Potential field",
        "95 % interval",
        "1.5",
        "100 %",
        "RRT*, 1.5: 60.0 % (55.0 % … 65.0 %)",
        "published, about ten games each, 2: 80.0 %",
    ] {
        assert!(texts.contains(&expected), "{expected:?} in {texts:?}");
    }
    // A line, two bars, two hollow marks, two marks; the point that is not a number is left out.
    assert_eq!(group(&svg, "RRT*").len(), 7);
    assert_eq!(group(&svg, "Potential field").len(), 5);
}

#[test]
fn larger_values_are_farther_up_and_right() {
    let text = draw(&chart()).svg();
    let svg = Document::parse(&text).unwrap();
    let line = group(&svg, "RRT*")[0].attribute("d").unwrap();
    let numbers: Vec<f64> = line
        .split(['M', 'L', ' '])
        .filter_map(|part| part.parse().ok())
        .collect();
    let [x0, y0, x1, y1] = numbers[..] else {
        panic!("{line}");
    };
    assert!(x0 < x1 && y1 < y0, "{line}");
}

#[test]
fn categories_are_not_joined() {
    let mut chart = chart();
    chart.x_names = vec!["exact".to_owned(), "particle filter".to_owned()];
    for series in &mut chart.series {
        series.points = vec![point(0.0, 0.1, 0.0, 0.2), point(1.0, 0.9, 0.8, 1.0)];
        series.reference.clear();
    }
    let text = draw(&chart).svg();
    let svg = Document::parse(&text).unwrap();
    assert_eq!(group(&svg, "RRT*").len(), 4, "two bars, two marks");
    assert!(text.contains("RRT*, particle filter: 90.0 %"));
    assert!(!text.contains("published"));
}

#[test]
fn a_chart_without_points_shows_no_results() {
    for chart in [
        Chart::default(),
        Chart {
            unit: Unit::Number,
            series: vec![Series::default()],
            ..Chart::default()
        },
    ] {
        assert!(draw(&chart).svg().contains("no results"));
    }
}

#[test]
fn the_same_chart_gives_the_same_file() {
    assert_eq!(draw(&chart()).svg(), draw(&chart()).svg());
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]
    #[test]
    fn any_numbers_and_names_give_a_document(
        points in prop::collection::vec((any::<f64>(), any::<f64>(), any::<f64>()), 0..20),
        name in ".{0,30}",
        number in any::<bool>(),
        curves in 0_usize..9,
    ) {
        let points: Vec<Point> = points
            .into_iter()
            .map(|(x, y, high)| Point { x, y, interval: Some((y, high)) })
            .collect();
        let series = Series { name: name.clone(), points: points.clone(), reference: points };
        let chart = Chart {
            title: name.clone(),
            subtitle: name,
            unit: if number { Unit::Number } else { Unit::Share },
            series: vec![series; curves],
            ..Chart::default()
        };
        let text = draw(&chart).svg();
        prop_assert!(Document::parse(&text).is_ok());
        prop_assert!(!text.contains("NaN") && !text.contains("inf"));
    }
}

#[test]
fn logarithmic_axes_are_divided_by_powers_of_ten() {
    let point = |x, y| Point {
        x,
        y,
        interval: None,
    };
    let chart = Chart {
        x_scale: Scale::Logarithmic,
        y_scale: Scale::Logarithmic,
        unit: Unit::Number,
        lines_only: true,
        series: vec![Series {
            name: "curve".into(),
            // Values that are not positive are left out.
            points: vec![
                point(3.0, 20.0),
                point(2_000.0, 70.0),
                point(0.0, 5.0),
                point(9.0, -1.0),
            ],
            reference: Vec::new(),
        }],
        ..Chart::default()
    };
    let svg = draw(&chart).svg();
    for label in [">1<", ">10<", ">100<", ">1000<", ">10000<"] {
        assert!(svg.contains(label), "{label}: {svg}");
    }
    assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
    assert!(!svg.contains("curve, 3"), "points have no marks");
    let empty = Chart {
        series: Vec::new(),
        ..chart
    };
    assert!(!draw(&empty).svg().contains("NaN"));
}
