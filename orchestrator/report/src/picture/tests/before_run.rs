//! Pictures of scenarios before they run.

use kinds::KINDS;
use roxmltree::Document;
use scenario::Loader;
use scenario::files::Base;

use crate::picture::{RunTrace, draw};

const CELLS: &str = r#"
[world.map.cells]
width = 4
height = 3
resolution = 1.0
origin = [0.0, 0.0]
runs = [5, 2, 5]
[rules]
time_limit = 10.0
[[robots]]
name = "a"
team = "neutral"
start = { x = 0.5, y = 0.5, theta = 1.0 }
goal.circle = { center = [3.5, 2.5], radius = 0.3 }
[[processes]]
kind = "evader_potential"
robots = ["a"]
"#;

/// Returns the texts and the classes of the picture of a scenario.
fn picture(scenario: &scenario::ResolvedScenario) -> (Vec<String>, Vec<String>) {
    let svg = draw(&RunTrace::before_run(scenario).unwrap());
    let document = Document::parse(&svg).unwrap();
    let texts = document.descendants().filter(|n| n.has_tag_name("text"));
    let texts = texts.filter_map(|n| n.text().map(str::to_owned)).collect();
    // Groups with content.
    let classes = document
        .descendants()
        .filter(|n| n.has_children() && n.children().any(|child| child.is_element()))
        .filter_map(|n| n.attribute("class").map(str::to_owned))
        .collect();
    (texts, classes)
}

#[test]
fn the_picture_before_a_run_has_robots_walls_exits_goals_and_zones_but_no_paths() {
    for (name, parts, words) in [
        (
            "chase",
            &["obstacles", "exits", "robot"][..],
            &["police_4", "exit", "exit for the evaders"][..],
        ),
        (
            "popup",
            &["obstacles", "goals", "robot"],
            &["goal of a robot", "appears during the run"],
        ),
        (
            "patrol_octagon",
            &["contours", "robot"],
            &["contour of the patrol"],
        ),
        (
            "coverage_case1",
            &["rectangles", "robot"],
            &["walls and blocks"],
        ),
    ] {
        let scenario = Loader::new(KINDS).load(name, &[], None).unwrap();
        let (texts, classes) = picture(&scenario);
        for part in parts {
            assert!(classes.iter().any(|c| c == part), "{name}: no {part}");
        }
        for word in words.iter().chain(&["before it runs"]) {
            let found = texts.iter().any(|text| text.contains(word));
            assert!(found, "{name}: no {word:?} in {texts:?}");
        }
        assert!(!texts.iter().any(|text| text.contains("path so far")));
    }
}

#[test]
fn a_grid_map_is_drawn_as_cells() {
    let scenario = Loader::new(KINDS)
        .load_text("a.toml", CELLS, &Base::Nothing, &[], None)
        .unwrap();
    let trace = RunTrace::before_run(&scenario).unwrap();
    let scene = &trace.static_scene;
    assert_eq!((scene.min, scene.max), ([0.0, 0.0], [4.0, 3.0]));
    let cells = scene.cells.as_ref().unwrap();
    assert_eq!(cells.rectangles(), [[[1.0, 1.0], [3.0, 2.0]]]);
    let (texts, _) = picture(&scenario);
    assert!(texts.iter().any(|text| text == "walls and blocks"));
}
