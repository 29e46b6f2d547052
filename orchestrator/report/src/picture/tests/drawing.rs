//! Properties of every picture.

use ::draw::palette;
use geometry::pose::Pose2;
use geometry::region::Region;
use robot::team::Role;
use roxmltree::{Document, Node};
use testing::{circle, rectangle};

use crate::picture::{
    BeliefTrace, Cells, DominanceTrace, Mark, MarkKind, PlaceTrace, PlanTrace, RobotTrace,
    RunTrace, StaticObstacle, StaticScene, TaskTrace, Trail, TrailPoint, TreeTrace, VerdictTrace,
    WaypointTrace, draw,
};

fn robot(name: &str, role: Role, way: impl IntoIterator<Item = (f64, f64)>) -> RobotTrace {
    let mut trail = Trail::default();
    let mut pose = Pose2::default();
    for (i, (x, y)) in way.into_iter().enumerate() {
        pose = Pose2::new(x, y, 0.5);
        trail.push(TrailPoint {
            x,
            y,
            time_s: i as f64 * 0.05,
        });
    }
    RobotTrace {
        name: name.to_owned(),
        team: role.team().to_owned(),
        role,
        radius: 0.1,
        pose,
        active: true,
        trail,
        sweeps: None,
    }
}

fn trace() -> RunTrace {
    let wall = rectangle([2.0, 1.5], [0.5, 0.5]);
    let pillar = circle([3.0, 0.8], 0.2);
    RunTrace {
        title: "Cats & <dogs>".to_owned(),
        description: "One chases the other.\n".repeat(30),
        scenario: "test".to_owned(),
        seed: "7".to_owned(),
        time_s: 2.0,
        end_s: 5.0,
        static_scene: StaticScene {
            min: [0.0, 0.0],
            max: [4.0, 3.0],
            obstacles: [(0, wall, false), (1, pillar, true)]
                .into_iter()
                .map(|(id, shape, came)| (id, StaticObstacle { shape, came }))
                .collect(),
            cells: None,
            own: 1,
            exits: vec![Region::Circle {
                center: [3.5, 2.5],
                radius: 0.3,
            }],
        },
        robots: vec![
            robot("police_1", Role::Pursuer, [(0.5, 0.5), (0.6, 0.5)]),
            robot("evader \"x\"", Role::Evader, [(3.0, 2.5), (3.1, 2.6)]),
            robot("a<b", Role::Neutral, [(1.0, 2.5)]),
        ],
        beliefs: vec![BeliefTrace {
            robot: 1,
            mean: [1.0, 1.0],
            particles: vec![[1.0, 1.0], [1.1, 0.9], [99.0, -99.0]],
        }],
        plans: Vec::new(),
        trees: Vec::new(),
        dominance: None,
        verdicts: Vec::new(),
        marks: vec![Mark {
            kind: MarkKind::Captured,
            robot: 1,
            at: [3.1, 2.6],
            time_s: 1.5,
        }],
        task: TaskTrace::default(),
    }
}

fn class<'a>(document: &'a Document<'a>, name: &str) -> Vec<Node<'a, 'a>> {
    document
        .descendants()
        .filter(|n| n.attribute("class") == Some(name))
        .collect()
}

fn texts(document: &Document<'_>) -> Vec<String> {
    document
        .descendants()
        .filter(|n| n.has_tag_name("text"))
        .filter_map(|n| n.text().map(str::to_owned))
        .collect()
}

/// Returns every coordinate in the document, as (x, y).
fn coordinates(document: &Document<'_>) -> Vec<(f64, f64)> {
    let mut found = Vec::new();
    for node in document.descendants() {
        let number = |key| node.attribute(key).map(|v: &str| v.parse::<f64>().unwrap());
        for (x, y) in [("x", "y"), ("cx", "cy")] {
            if let (Some(x), Some(y)) = (number(x), number(y)) {
                found.push((x, y));
                let size = (
                    number("width").unwrap_or(0.0),
                    number("height").unwrap_or(0.0),
                );
                found.push((x + size.0, y + size.1));
            }
        }
        for piece in node.attribute("d").unwrap_or_default().split(['M', 'L']) {
            let piece = piece.trim_end_matches('Z').trim_end_matches("h0");
            if let Some((x, y)) = piece.split_once(' ') {
                found.push((x.parse().unwrap(), y.parse().unwrap()));
            }
        }
    }
    found
}

fn page(document: &Document<'_>) -> (f64, f64) {
    let number = |key| {
        document
            .root_element()
            .attribute(key)
            .unwrap()
            .parse()
            .unwrap()
    };
    (number("width"), number("height"))
}

fn assert_on_page(svg: &str) {
    let document = Document::parse(svg).unwrap();
    let (width, height) = page(&document);
    let coordinates = coordinates(&document);
    assert!(coordinates.len() > 10);
    for (x, y) in coordinates {
        assert!(
            (0.0..=width).contains(&x) && (0.0..=height).contains(&y),
            "{x} {y}"
        );
    }
}

#[test]
fn a_picture_is_valid_xml_and_names_every_robot() {
    let svg = draw(&trace());
    let document = Document::parse(&svg).unwrap();
    assert_eq!(class(&document, "robot").len(), 3);
    let texts = texts(&document);
    for name in [
        "police_1",
        "evader \"x\" caught, 1.50 s",
        "a<b",
        "exit",
        "Cats & <dogs>",
    ] {
        assert!(texts.iter().any(|t| t == name), "{name} in {texts:?}");
    }
    assert!(
        texts
            .iter()
            .any(|t| t.contains("seed 7") && t.contains("2.00 s of 5.00 s"))
    );
    assert_eq!(draw(&trace()), svg, "the same trace gives the same picture");
}

#[test]
fn everything_is_on_the_page_even_points_beyond_the_map() {
    let mut trace = trace();
    assert_on_page(&draw(&trace));
    trace.robots[0].pose = Pose2::new(1e6, -1e6, 1.0);
    trace.marks[0].at = [-50.0, 50.0];
    assert_on_page(&draw(&trace));
}

#[test]
fn y_points_up_and_headings_turn_counter_clockwise() {
    let mut trace = trace();
    trace.robots.truncate(2);
    trace.robots[0].pose = Pose2::new(0.5, 0.5, core::f64::consts::FRAC_PI_2);
    trace.robots[1].pose = Pose2::new(0.5, 2.5, 0.0);
    let svg = draw(&trace);
    let document = Document::parse(&svg).unwrap();
    let disc = |i: usize| {
        let robot = class(&document, "robot")[i];
        let circle = robot
            .descendants()
            .find(|n| n.has_tag_name("circle"))
            .unwrap();
        let nose = robot
            .descendants()
            .find(|n| n.has_tag_name("path"))
            .unwrap();
        let tip = nose.attribute("d").unwrap()[1..].split('L').next().unwrap();
        let (x, y) = tip.split_once(' ').unwrap();
        let number = |text: &str| text.parse::<f64>().unwrap();
        let center = ["cx", "cy"].map(|key| number(circle.attribute(key).unwrap()));
        (center, [number(x), number(y)])
    };
    let ((low, up), (high, right)) = (disc(0), disc(1));
    assert!(
        low[1] > high[1],
        "the robot with the larger y stands higher"
    );
    assert!(
        up[1] < low[1] && (up[0] - low[0]).abs() < 0.2,
        "heading +y points up"
    );
    assert!(right[0] > high[0] && (right[1] - high[1]).abs() < 0.2);
}

#[test]
fn obstacles_added_during_the_run_have_another_colour() {
    let svg = draw(&trace());
    let document = Document::parse(&svg).unwrap();
    let obstacles = class(&document, "obstacles");
    assert_eq!(obstacles.len(), 2);
    assert_ne!(
        obstacles[0].attribute("fill"),
        obstacles[1].attribute("fill")
    );
    assert!(
        texts(&document)
            .iter()
            .any(|t| t.contains("during the run"))
    );
    let mut plain = trace();
    plain.static_scene.obstacles.remove(&1);
    plain.beliefs.clear();
    let svg = draw(&plain);
    assert!(!svg.contains("during the run") && !svg.contains("belief of"));
}

#[test]
fn names_of_crowded_robots_do_not_overlap() {
    let mut trace = trace();
    let way = |i| [(1.0 + 0.1 * f64::from(i), 0.5)];
    trace.robots = (0..6)
        .map(|i| robot(&format!("robot_{i}"), Role::Pursuer, way(i)))
        .collect();
    trace.marks.clear();
    let svg = draw(&trace);
    let document = Document::parse(&svg).unwrap();
    let boxes: Vec<[f64; 4]> = document
        .descendants()
        .filter(|n| n.has_tag_name("text") && n.attribute("class") == Some("halo"))
        .map(|n| {
            let number = |key| n.attribute(key).unwrap().parse::<f64>().unwrap();
            let half = n.text().unwrap().chars().count() as f64 * 14.0 * 0.66 / 2.0;
            [
                number("x") - half,
                number("y") - 12.0,
                number("x") + half,
                number("y") + 3.0,
            ]
        })
        .collect();
    assert!(boxes.len() >= 7, "six robots and the exit");
    for (i, a) in boxes.iter().enumerate() {
        for b in &boxes[..i] {
            let apart = a[2] <= b[0] || b[2] <= a[0] || a[3] <= b[1] || b[3] <= a[1];
            assert!(apart, "{a:?} and {b:?}");
        }
    }
}

#[test]
fn the_largest_run_makes_a_picture_of_at_most_400_kb() {
    // 64 robots on winding paths for 10 000 ticks, 64 beliefs, plans and trees, and noisy maps.
    let mut trace = trace();
    trace.robots = (0..64)
        .map(|r| {
            let way = (0..10_000).map(|i| {
                let (sin, cos) = geometry::math::sincos(f64::from(i * (r + 3)) * 0.011);
                (2.0 + 1.9 * sin, 1.5 + 1.4 * cos)
            });
            robot(&format!("robot_number_{r}"), Role::Pursuer, way)
        })
        .collect();
    trace.beliefs = (0..64)
        .map(|robot| BeliefTrace {
            robot,
            mean: [1.0, 1.0],
            particles: vec![[1.234, 2.345]; 1000],
        })
        .collect();
    trace.marks = (0..64)
        .map(|robot| Mark {
            kind: MarkKind::Captured,
            robot,
            at: [0.05 * robot as f64, 1.0],
            time_s: 100.0,
        })
        .collect();
    let way: Vec<[f32; 2]> = (0..4000).map(|i| [1.0, i as f32 * 7e-4]).collect();
    trace.plans = (0..64)
        .map(|robot| PlanTrace {
            robot,
            points: way.clone(),
            aim: None,
        })
        .collect();
    trace.trees = (0..64)
        .map(|robot| TreeTrace {
            robot,
            edges: way.iter().map(|&to| [[1.234, 2.345], to]).collect(),
        })
        .collect();
    for robot in &mut trace.robots {
        robot.sweeps = Some(0.1);
    }
    trace.task = TaskTrace {
        goals: Vec::new(),
        rectangles: vec![[[1.234, 1.234], [2.345, 2.345]]; 1000],
        waypoints: (0..1500)
            .map(|i| WaypointTrace {
                at: [1.234, f64::from(i) * 1e-3],
                is_reached: i % 2 == 0,
            })
            .collect(),
        swept: Some(0.5),
        ..TaskTrace::default()
    };
    trace.static_scene.obstacles.clear();
    trace.static_scene.cells = Some(Cells {
        origin: [0.0, 0.0],
        side: 0.004,
        width: 1000,
        occupied: (0..750_000_u32)
            .map(|i| i.wrapping_mul(2_654_435_761) >> 30 == 0)
            .collect(),
    });
    let noise = trace.static_scene.cells.clone().unwrap();
    trace.dominance = Some(DominanceTrace {
        police: noise.clone(),
        evader: noise.clone(),
        cut_off: noise,
    });
    let svg = draw(&trace);
    assert!(svg.len() <= 400_000, "{} bytes", svg.len());
    assert_on_page(&svg);
}

#[test]
fn a_run_without_robots_map_or_title_still_makes_a_page() {
    let svg = draw(&RunTrace::default());
    let (width, height) = page(&Document::parse(&svg).unwrap());
    assert!(width > 100.0 && height > 100.0, "{width} {height}");
}

#[test]
fn plans_trees_and_dominance_are_drawn_and_explained() {
    let mut trace = trace();
    let plain = draw(&trace);
    let document = Document::parse(&plain).unwrap();
    assert!(class(&document, "dominance").is_empty());
    let cells = |occupied: [bool; 2]| Cells {
        origin: [0.0; 2],
        side: 1.0,
        width: 2,
        occupied: occupied.to_vec(),
    };
    trace.plans = vec![PlanTrace {
        robot: 1,
        points: vec![[3.0, 2.5], [3.0, 1.0], [3.5, 2.5]],
        aim: Some([3.5, 2.7]),
    }];
    trace.trees = vec![TreeTrace {
        robot: 1,
        edges: vec![[[3.0, 2.5], [3.0, 1.0]], [[3.0, 2.5], [3.5, 2.5]]],
    }];
    trace.dominance = Some(DominanceTrace {
        police: cells([true, false]),
        evader: cells([false, true]),
        cut_off: cells([false, false]),
    });
    trace.verdicts = vec![VerdictTrace {
        robot: 1,
        is_possible: true,
        margin_s: 4.5,
    }];
    let svg = draw(&trace);
    assert_on_page(&svg);
    let document = Document::parse(&svg).unwrap();
    assert_eq!(class(&document, "verdict").len(), 2, "map and legend");
    let commands = |name: &str| {
        let group = class(&document, name)[0];
        let paths = group.children().filter_map(|path| path.attribute("d"));
        paths
            .map(|d| d.matches(['M', 'L']).count())
            .collect::<Vec<_>>()
    };
    assert_eq!(commands("plans"), [3]);
    assert_eq!(commands("trees"), [4]);
    // A rectangle has four commands.
    assert_eq!(commands("dominance"), [4, 4, 0]);
    let words = texts(&document).join(" ");
    let verdict = "evader \"x\": escape possible by 4.5 s";
    for text in [
        "planned path; a ring",
        "search tree",
        "reaches it safely",
        verdict,
    ] {
        assert!(words.contains(text), "{text}: {words}");
    }
}

#[test]
fn patrols_and_coverage_show_their_contour_zones_rectangles_waypoints_and_swept_ground() {
    let mut trace = trace();
    let plain = draw(&trace);
    for absent in [
        "swept ground",
        "contour",
        "danger zone",
        "rectangle",
        "waypoint ",
    ] {
        let texts = texts(&Document::parse(&plain).unwrap()).join(" ");
        assert!(!texts.contains(absent), "{absent}: {texts}");
    }
    trace.robots[2] = robot("a<b", Role::Neutral, [(1.0, 2.5), (2.0, 2.5), (2.0, 1.5)]);
    trace.robots[2].sweeps = Some(0.1);
    trace.task = TaskTrace {
        goals: Vec::new(),
        contours: vec![vec![[1.0, 1.0], [3.0, 1.0], [1.0, 1.0]]],
        danger_zones: vec![circle([1.0, 1.0], 0.5), rectangle([3.0, 1.0], [0.5, 0.2])],
        rectangles: vec![[[0.0, 0.0], [1.0, 2.0]], [[1.0, 0.0], [4.0, 3.0]]],
        waypoints: [true, true, false]
            .map(|is_reached| WaypointTrace {
                at: [2.0, 2.5],
                is_reached,
            })
            .to_vec(),
        places: [(0.0, 0.05), (0.5, 0.05), (1.5, 1.0)]
            .map(|(x, idle_s)| PlaceTrace {
                ends: [[1.0 + x, 1.0], [1.5 + x, 1.0]],
                idle_s,
            })
            .to_vec(),
        swept: Some(0.4567),
    };
    let svg = draw(&trace);
    assert_on_page(&svg);
    let document = Document::parse(&svg).unwrap();
    let count = |name: &str| {
        let group = class(&document, name)[0];
        group.children().filter(Node::is_element).count()
    };
    let counts = [
        "contours",
        "danger-zones",
        "rectangles",
        "waypoints",
        "swept",
    ]
    .map(count);
    assert_eq!(counts, [1, 2, 2, 2, 1]);
    let of_waypoints = class(&document, "waypoints")[0].children();
    let moves: Vec<usize> = of_waypoints
        .filter_map(|path| Some(path.attribute("d")?.matches('M').count()))
        .collect();
    assert_eq!(moves, [2, 2], "two squares, and two lines of a cross");
    // A line of both places that have just been visited, and one of the other.
    let places = class(&document, "places")[0].children();
    let lines = places.filter_map(|path| Some((path.attribute("stroke")?, path.attribute("d")?)));
    let lines = lines.filter(|(_, line)| !line.is_empty());
    let lines: Vec<_> = lines
        .map(|(color, line)| (color, line.matches('L').count()))
        .collect();
    assert_eq!(lines, [(palette::EVADER, 1), (palette::PURSUER, 2)]);
    // 4 m are 760 px: a disc of radius 0.1 m sweeps 38 px.
    let swept = class(&document, "swept")[0].first_element_child().unwrap();
    assert_eq!(swept.attribute("stroke-width"), Some("38"));
    let texts = texts(&document).join(" ");
    for text in [
        "swept ground: 45.7 %",
        "less than 0.25 s ago",
        "contour of the patrol, in the colours of its last visit",
        "danger zone",
        "as 2 rectangles",
        "2 waypoints reached",
        "1 waypoint left out",
    ] {
        assert!(texts.contains(text), "{text}: {texts}");
    }
}
