//! Coverage with real processes: sub-goals as planned, robots in free space, area recomputed from the log.

use crate::support::call::PATIENCE;
use crate::support::geometry::{Walls, between, to_segment};
use crate::support::history::History;
use crate::support::sandbox::signal;
use crate::support::ways::Drive;
use crate::support::{Sandbox, wait_for_tick};
use plan::routes::coverage::{Extent, plan};
use rustix::process::Signal;
use serde_json::Value as Json;

/// Side of the cells in which area is counted (m): the maps' own.
const CELL: f64 = 0.1;

/// The area of a workplace by the map alone, and what of it a disc has swept.
struct Count {
    min: [f64; 2],
    /// Columns and rows.
    size: [usize; 2],
    /// Row by row: whether a cell's centre is free, and whether it has been swept.
    cells: Vec<(bool, bool)>,
}

impl Count {
    fn new(walls: &Walls) -> Self {
        let size = [0, 1].map(|i| ((walls.max[i] - walls.min[i]) / CELL).round() as usize);
        let mut count = Self {
            min: walls.min,
            size,
            cells: vec![(false, false); size[0] * size[1]],
        };
        for cell in 0..count.cells.len() {
            let center = count.center(cell % size[0], cell / size[0]);
            count.cells[cell].0 = walls.clearance(center) > 0.0;
        }
        count
    }

    fn center(&self, col: usize, row: usize) -> [f64; 2] {
        let at = |i: usize, n: usize| self.min[i] + (n as f64 + 0.5) * CELL;
        [at(0, col), at(1, row)]
    }

    /// A disc of this radius (m) along a track.
    fn sweep(&mut self, track: &[[f64; 2]], radius: f64) {
        for pair in track.windows(2) {
            let reach = radius + between(pair[0], pair[1]);
            let range = |i: usize| {
                let cell = |p: f64| ((p - self.min[i]) / CELL).max(0.0) as usize;
                cell(pair[0][i] - reach)..(cell(pair[0][i] + reach) + 1).min(self.size[i])
            };
            let (cols, rows) = (range(0), range(1));
            for (col, row) in rows.flat_map(|row| cols.clone().map(move |col| (col, row))) {
                if to_segment(self.center(col, row), pair[0], pair[1]) <= radius {
                    self.cells[row * self.size[0] + col].1 = true;
                }
            }
        }
    }

    /// Free area (m²).
    fn free(&self) -> f64 {
        self.cells.iter().filter(|(free, _)| *free).count() as f64 * CELL * CELL
    }

    /// Swept part of it.
    fn fraction(&self) -> f64 {
        let swept = self.cells.iter().filter(|cell| **cell == (true, true));
        swept.count() as f64 * CELL * CELL / self.free()
    }
}

fn number(json: &Json, key: &str) -> f64 {
    json[key].as_f64().unwrap()
}

/// The sub-goals of the log are those that a plan without a run has from the same scenario, and the
/// straight legs between them stay in the free space.
#[track_caller]
fn goals_are_as_planned(drive: &Drive, scenario: &str, set: &[&str]) {
    let ends = &drive.history.waypoints;
    let set: Vec<String> = set.iter().map(|&change| change.to_owned()).collect();
    let loaded = kinds::load(scenario, &set, None).unwrap();
    let extent = Extent::Goals(ends.len() as u64 + 1);
    let planned = plan(&loaded, None, extent).unwrap().json();
    let planned = planned["sub_goals"].as_array().unwrap();
    assert!(
        planned.len() > ends.len() && ends.len() >= 10,
        "{}",
        ends.len()
    );
    for (end, goal) in ends.iter().zip(planned) {
        let same = |key: &str, value: f64| number(goal, key).to_bits() == value.to_bits();
        assert!(same("x", end.x) && same("y", end.y), "{end:?} {goal}");
        assert_eq!(goal["number"], end.number);
        assert_eq!(goal["loop"], end.lap);
        assert_eq!(goal["kind"], *end.kind);
        assert_eq!(end.outcome, "reached", "{end:?}");
    }
    let start = drive.track()[0];
    let places = std::iter::once(start).chain(ends.iter().map(|end| [end.x, end.y]));
    let places: Vec<[f64; 2]> = places.collect();
    for leg in places.windows(2) {
        let steps = (between(leg[0], leg[1]) / 0.01).ceil().max(1.0);
        for step in 0..=steps as u32 {
            let part = f64::from(step) / steps;
            let p = [0, 1].map(|i| leg[0][i] + part * (leg[1][i] - leg[0][i]));
            let clearance = drive.walls.clearance(p);
            assert!(
                clearance >= drive.radius - 1e-9,
                "{clearance} m at {p:?} on {leg:?}"
            );
        }
    }
}

/// Asserts that the area in the summary is the area that the poses have swept.
#[track_caller]
fn area_is_as_driven(drive: &Drive) {
    let told = &drive.summary["coverage"];
    let mut count = Count::new(&drive.walls);
    let free = count.free();
    assert!(
        (number(told, "free_m2") - free).abs() < 0.01 * free,
        "{free} {told}"
    );
    let track = drive.track();
    count.sweep(&track, drive.radius);
    let fraction = count.fraction();
    assert!(
        (number(told, "fraction") - fraction).abs() < 0.005,
        "{fraction} {told}"
    );
    assert!(number(told, "coverable_fraction") >= number(told, "fraction") - 1e-12);
    let way: f64 = track.windows(2).map(|pair| between(pair[0], pair[1])).sum();
    assert!(
        (number(told, "way_m") / way - 1.0).abs() < 0.01,
        "{way} {told}"
    );

    // On the way there: what had been swept when the way had become so long.
    for by_way in told["by_way"].as_array().unwrap() {
        let states = &drive.history.states;
        let longer =
            |s: &&crate::support::history::State| s.robots[0].distance <= number(by_way, "way_m");
        let ticks = states.iter().take_while(longer).count();
        let mut count = Count::new(&drive.walls);
        count.sweep(&track[..ticks], drive.radius);
        let fraction = count.fraction();
        let told = number(by_way, "coverable_fraction");
        assert!((told - fraction).abs() < 0.01, "{fraction} {by_way}");
    }
}

#[test]
fn the_empty_workplace_is_covered_as_planned_and_counted() {
    let sandbox = Sandbox::new();
    let drive = Drive::run(&sandbox, "coverage_open", &["rules.time_limit=280"]);
    goals_are_as_planned(&drive, "coverage_open", &[]);
    area_is_as_driven(&drive);
    let by_way = drive.summary["coverage"]["by_way"].as_array().unwrap();
    assert_eq!(by_way.len(), 1, "250 m: {by_way:?}");
}

#[test]
fn workplaces_with_obstacles_are_covered_as_planned_and_counted() {
    let sandbox = Sandbox::new();
    for scenario in ["coverage_case1", "coverage_case2", "coverage_polygons"] {
        let few = "processes.cover.params.iterations={ in_all = 12 }";
        let set = ["rules.time_limit=150", few];
        let drive = Drive::run(&sandbox, scenario, &set);
        goals_are_as_planned(&drive, scenario, &set);
        area_is_as_driven(&drive);
        // Through passages and around corners, not in one part only.
        let transits = drive
            .history
            .waypoints
            .iter()
            .filter(|end| end.kind == "transit");
        assert!(transits.count() >= 2, "{scenario}");
    }
}

#[test]
fn arcs_in_place_of_corners_are_driven_without_stopping() {
    let sandbox = Sandbox::new();
    let arc = "processes.cover.params.follow.interpolation=arc";
    let time = "rules.time_limit=120";
    let standing = |drive: &Drive| {
        let states = drive.history.states.iter();
        states.filter(|state| state.robots[0].v < 0.05).count()
    };
    for scenario in ["coverage_case1", "coverage_polygons"] {
        let straight = Drive::run(&sandbox, scenario, &[time]);
        let round = Drive::run(&sandbox, scenario, &[time, arc]);
        goals_are_as_planned(&round, scenario, &[arc]);
        area_is_as_driven(&round);
        assert!(
            standing(&round) * 2 < standing(&straight),
            "{scenario}: {} ticks and {}",
            standing(&round),
            standing(&straight)
        );
    }
}

#[test]
fn an_obstacle_that_pops_up_is_driven_around_from_then_on() {
    let sandbox = Sandbox::new();
    let made = sandbox
        .protean(["new", "popup.toml", "--from", "coverage_case2"])
        .run();
    assert_eq!(made.code, Some(0), "{made}");
    let text = std::fs::read_to_string(sandbox.path().join("popup.toml")).unwrap();
    let event = r#"
[[events]]
time_s = 40.0
action = "appear"
obstacle = "crate"
shape.rectangle = { center = [5.0, 8.2], half_extents = [0.8, 0.5] }
"#;
    sandbox.file("popup.toml", text + event);
    let drive = Drive::run(&sandbox, "popup.toml", &["rules.time_limit=160"]);
    let appeared: Vec<u64> = drive.history.obstacles.iter().map(|c| c.tick).collect();
    assert_eq!(appeared, [800]);
    // `Drive` has judged the distance to it; that it was in the way is judged here.
    let crossed = |from: usize, to: usize| {
        let inside = |p: &&[f64; 2]| (p[0] - 5.0).abs() < 0.8 && (p[1] - 8.2).abs() < 0.5;
        drive.track()[from..to].iter().filter(inside).count()
    };
    assert!(crossed(0, 800) > 0, "the robot had been there before");
    assert_eq!(crossed(801, drive.history.states.len()), 0);
    let later = drive.history.waypoints.iter().filter(|end| end.tick > 900);
    assert!(later.clone().count() >= 10 && later.clone().all(|end| end.outcome == "reached"));
}

/// The arguments that put this many robots with a planner of a kind into the empty workplace.
fn team(count: usize, planner: &str) -> [String; 2] {
    let robots = format!(
        "robots=[{{ name = \"sweeper\", team = \"neutral\", count = {count}, random_start = {{}}, radius = 0.1, \
         limits = {{ v_max = 1.0, omega_max = 5.0 }}, scan = {{ beams = 36, \
         angle_increment = 0.17453292519943295, range_min = 0.0, range_max = 1.0, noise = 0.0 }} }}]"
    );
    let cover = "name = \"cover\", team = \"neutral\", on_failure = \"continue\"";
    [robots, format!("processes=[{{ {cover}, {planner} }}]")]
}

#[test]
fn a_team_covers_as_much_as_its_robots_would_alone_in_parts_of_the_workplace() {
    let sandbox = Sandbox::new();
    let covered = |count: usize, planner: &str, time_s: u32| {
        let call = sandbox.protean(["run", "coverage_open", "--quiet", "--in-process"]);
        let sets = team(count, planner);
        let call = sets.iter().fold(call, |call, set| call.set(set));
        let summary = call.set(&format!("rules.time_limit={time_s}")).json();
        number(&summary["coverage"], "coverable_fraction")
    };
    for kind in ["coverage_keyed", "coverage_boustrophedon"] {
        let planner = format!("kind = \"{kind}\"");
        let (one, three) = (covered(1, &planner, 120), covered(3, &planner, 120));
        assert!(one > 0.1 && three > 2.4 * one, "{kind}: {one}, {three}");
    }
    let apart = "kind = \"coverage_keyed\", params = { follow = { divide = false } }";
    let divided = covered(3, "kind = \"coverage_keyed\"", 240);
    let undivided = covered(3, apart, 240);
    assert!(divided > undivided + 0.03, "{divided}, {undivided}");
}

#[test]
fn the_others_take_over_the_part_of_a_robot_whose_process_is_killed() {
    const FAILED: usize = 1;
    let sandbox = Sandbox::new();
    let call = sandbox.protean([
        "run",
        "coverage_open",
        "--json",
        "--quiet",
        "--out",
        "run.mcap",
    ]);
    let sets = team(3, "kind = \"coverage_keyed\"");
    let call = sets.iter().fold(call, |call, set| call.set(set));
    let running = call.set("rules.time_limit=400").set(PATIENCE).start();
    let run = sandbox.next_run(&std::collections::BTreeSet::new());
    wait_for_tick(&run, 1000);
    signal(sandbox.process("cover_sweeper_2").pid, Signal::KILL);
    let outcome = running.finish();
    assert_eq!(outcome.code, Some(3), "{outcome}");
    let history = History::read(&sandbox.path().join("run.mcap"));
    let summary = outcome.json();
    let left = summary["processes"][0]["outages"][0]["left_tick"]
        .as_u64()
        .unwrap() as usize;
    assert!(left < 4000, "killed at tick {left}");

    // The parts are columns of the square; shares of their cells of 0.2 m.
    let swept = |from: usize, robot: usize| {
        let mut shares = [0.0; 3];
        let mut seen = std::collections::BTreeSet::new();
        for state in &history.states[from..] {
            let robot = &state.robots[robot];
            let cell = [robot.x, robot.y].map(|p| (p / 0.2) as usize);
            if seen.insert(cell) {
                shares[((robot.x * 0.3) as usize).min(2)] += 3.0 / 2500.0;
            }
        }
        shares
    };
    let before: [f64; 3] = {
        let until = &history.states[400..left];
        let mut counts = [0.0; 3];
        for state in until {
            counts[((state.robots[FAILED].x * 0.3) as usize).min(2)] += 1.0 / until.len() as f64;
        }
        counts
    };
    let part = (0..3).find(|&part| before[part] > 0.9).expect("one part");
    let later = [0, 2].map(|robot| swept(left + 400, robot)[part]);
    assert!(later.iter().sum::<f64>() > 0.4, "{later:?} of part {part}");
    let sooner = [0, 2].map(|robot| {
        let states = history.states[400..left].iter();
        let inside = |x: f64| x * 0.3 > part as f64 + 0.1 && x * 0.3 < part as f64 + 0.9;
        states.filter(|state| inside(state.robots[robot].x)).count()
    });
    assert_eq!(sooner, [0, 0]);
}
