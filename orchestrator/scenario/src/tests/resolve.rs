//! Resolved scenarios.

use geometry::map::{MapSpec, ObstacleChange, ObstacleId};
use sim_backend::spec::Condition;

use super::*;
use crate::Moment;
use crate::events::{EventSpec, Trigger};
use crate::spec::Pin;

#[test]
fn robots_inherit_from_team_and_defaults_and_keep_their_own() {
    let text = changed(
        "name = \"cop\"",
        "name = \"cop\"\nlimits.v_reverse_max = 0.1\nradius = 0.2",
    );
    let s = load(&text).unwrap();
    let cop = s.world.robots[0].model();
    assert_eq!(
        (cop.v_max, cop.omega_max, cop.v_reverse_max, cop.radius),
        (0.2, 1.5, 0.1, 0.2)
    );
    let thief = s.world.robots[1].model();
    assert_eq!(
        (thief.v_max, thief.omega_max, thief.radius),
        (0.2, 2.84, 0.105)
    );
}

#[test]
fn processes_are_expanded_named_and_ordered() {
    let s = load(GOOD).unwrap();
    let names: Vec<&str> = s.processes.iter().map(|p| p.name.as_str()).collect();
    assert_eq!(names, ["perception", "pursuer", "evader_potential"]);
    assert_eq!(s.processes[1].robots, [0]);
    assert_eq!(s.processes[0].program.params()["particles"], 200);
    assert_eq!(
        s.processes[0].program.params()["gain"],
        0.5,
        "defaults are filled in"
    );
    assert!(!s.uses_external_commands());

    let both = changed(
        "kind = \"evader_potential\"\nteam = \"evader\"\n",
        "kind = \"evader_potential\"\nrobots = []\n",
    );
    assert!(load(&both).is_err());
    let two = changed(
        "[[processes]]\nkind = \"pursuer\"\nrobots = [\"cop\"]\n[[processes]]\nkind = \"evader_potential\"\nteam = \"evader\"",
        "[[processes]]\nname = \"own\"\ncommand = [\"./planner\", \"-v\"]\nfolder = \"/missions/\"\nrobots = [\"thief\", \"cop\"]\nparams = { any = [1, \"x\"] }",
    );
    let s = load(&two).unwrap();
    let names: Vec<&str> = s.processes.iter().map(|p| p.name.as_str()).collect();
    assert_eq!(names, ["perception", "own_cop", "own_thief"]);
    assert_eq!(
        s.processes[1].program.command_line().as_deref(),
        Some("./planner -v (in /missions)")
    );
    assert_eq!(
        s.processes[1].program.params(),
        serde_json::json!({ "any": [1, "x"] })
    );
    assert!(s.uses_external_commands());
    let s =
        load(&two.replace("name = \"own\"", "name = \"own\"\ngrouping = \"together\"")).unwrap();
    assert_eq!(
        (
            s.processes[1].name.as_str(),
            s.processes[1].robots.as_slice()
        ),
        ("own", &[0, 1][..])
    );
}

#[test]
fn presets_of_parameters_are_filled_in_under_single_values() {
    let text = changed(
        "robots = [\"cop\"]",
        "robots = [\"cop\"]\nparams = { preset = \"paper\", particles = 3 }",
    );
    let s = load(&text).unwrap();
    assert_eq!(
        s.processes[1].program.params(),
        serde_json::json!({ "knowledge": "exact", "gain": 7.0, "particles": 3 })
    );
}

#[test]
fn events_are_sorted_and_numbered_after_the_maps_obstacles() {
    let s = load(GOOD).unwrap();
    let times: Vec<&Moment> = s.events.iter().map(|e| &e.moment).collect();
    assert_eq!(
        times,
        [&Moment::At { time_s: 2.5 }, &Moment::At { time_s: 5.0 }]
    );
    assert!(matches!(
        s.events[0].change(),
        Some(ObstacleChange::Appear {
            id: ObstacleId(1),
            ..
        })
    ));
    assert_eq!(
        s.events[1].change(),
        Some(ObstacleChange::Disappear { id: ObstacleId(0) })
    );
    let again = GOOD.to_owned()
        + "[[events]]\ntime_s = 9\naction = \"appear\"\nobstacle = \"wall\"\nshape = { circle = { center = [0, 0], radius = 0.1 } }\n";
    assert_eq!(
        load(&again).unwrap().events[2].id,
        0,
        "it is the same wall that comes back"
    );
}

/// Events of two obstacles that wait for robots, and one timed event that follows in their order.
const WAITING: &str = r#"
[[events]]
when = { robot = "thief", travelled = 1.5 }
action = "appear"
obstacle = "gate"
shape = { circle = { center = [1.0, 1.0], radius = 0.2 } }
[[events]]
time_s = 20.0
action = "move"
obstacle = "gate"
shape = { circle = { center = [1.5, 1.0], radius = 0.2 } }
[[events]]
when = { robot = "cop", within = 0.8, of = [1.0, -1.0] }
after_s = 2.0
action = "disappear"
obstacle = "block"
"#;

#[test]
fn events_that_wait_for_robots_come_last_in_the_order_of_the_file() {
    let s = load(&format!("{GOOD}{WAITING}")).unwrap();
    let told = |e: &EventSpec| (e.obstacle.clone(), e.id, e.in_turn);
    let told: Vec<_> = s.events.iter().map(told).collect();
    let expected = [
        ("wall", 0, false),
        // At a fixed time, but of an obstacle whose other events wait for robots.
        ("block", 1, true),
        ("gate", 2, true),
        ("gate", 2, true),
        ("block", 1, true),
    ]
    .map(|(name, id, in_turn)| (name.to_owned(), id, in_turn));
    assert_eq!(told, expected);
    assert_eq!(
        s.events[4].moment,
        Moment::When {
            when: Trigger {
                robot: "cop".into(),
                index: 0,
                condition: Condition::Within {
                    within: 0.8,
                    of: [1.0, -1.0]
                },
            },
            after_s: 2.0,
        }
    );
    assert!(matches!(
        &s.events[2].moment,
        Moment::When { when, after_s: 0.0 } if when.index == 1
    ));
}

#[test]
fn the_start_is_drawn_from_the_seed() {
    let start = |seed: &str| {
        let s = load_with(GOOD, &[&format!("run.seed={seed}")]).unwrap();
        assert_eq!(s.world.seed, s.run.seed);
        (s.world.robots[0].start, s.world.robots[1].start)
    };
    assert_eq!(start("1"), start("1"));
    assert_eq!(start("1").0, start("2").0);
    assert_ne!(start("1").1, start("2").1);
    let thief = start("3").1;
    assert!((thief.x - 2.0).abs() <= 0.1 && thief.y.abs() <= 0.1 && thief.theta.abs() <= 0.2);
}

#[test]
fn a_random_start_needs_no_start_and_the_log_has_it() {
    let random = changed(
        "name = \"thief\"",
        "name = \"thief\"\nrandom_start = { opponent_distance = 1.0, exit_distance = 0.5 }",
    );
    let random = random.replace("start = { x = 2.0, y = 0.0, theta = 0.0 }\n", "");
    let mut all = Vec::new();
    for seed in 0..20_u64 {
        let s = load_with(&random, &[&format!("run.seed={seed}")]).unwrap();
        assert_eq!(load(&s.to_toml()).unwrap(), s, "the log has the start");
        let thief = s.world.robots[1].start;
        all.push((thief.x, thief.y));
    }
    let spread = |v: fn(&(f64, f64)) -> f64| {
        let values = all.iter().map(v);
        values.clone().fold(f64::MIN, f64::max) - values.fold(f64::MAX, f64::min)
    };
    assert!(spread(|p| p.0) > 1.0 && spread(|p| p.1) > 1.0, "{all:?}");
}

#[test]
fn a_capture_radius_that_needs_overlapping_bodies_has_a_warning() {
    for (radius, warns) in [("0.3", false), ("0.21", false), ("0.2", true)] {
        let text = changed(
            "radius = 0.3 }\nexits",
            &format!("radius = {radius} }}\nexits"),
        );
        let remarks = load(&text).unwrap().remarks();
        assert_eq!(remarks.len(), usize::from(warns), "{remarks:?}");
        for remark in remarks {
            expect!["warning: rules.capture.radius is 0.2 m, below the sum of the radii of a pursuer and an evader (0.21 m): they touch before a capture"].assert_eq(&remark.to_string());
        }
    }
}

#[test]
fn the_exits_of_the_world_replace_those_of_the_map() {
    let text = changed(
        "[world.map.vector]",
        "[world]\nexits = [{ circle = { center = [3.5, 1.0], radius = 0.2 } }]\n[world.map.vector]\nexits = [{ circle = { center = [-3.0, 1.0], radius = 0.3 } }]",
    );
    let s = load(&text).unwrap();
    let MapSpec::Vector(map) = &s.world.map else {
        panic!("{:?}", s.world.map)
    };
    assert_eq!(map.exits.len(), 1);
    assert_eq!(map.exits[0].center().x, 3.5);
    assert_eq!(load(&s.to_toml()).unwrap(), s);
}

#[test]
fn a_written_scenario_loads_to_the_same() {
    let commands = changed(
        "kind = \"evader_potential\"",
        "command = [\"a b\", \"\\\"c\\\\\"]\nname = \"x\"",
    );
    let waiting = format!("{GOOD}{WAITING}").replace(
        "name = \"thief\"",
        "name = \"thief\"\ngoal = { circle = { center = [-3.0, 1.0], radius = 0.2 } }",
    );
    let waiting = waiting.replace("travelled = 1.5", "progress = 0.36");
    for text in [GOOD.to_owned(), commands, waiting] {
        let s = load_with(
            &text,
            &[
                "run.seed=77",
                "run.pin=one_core",
                "log.compression=none",
                "world.resolution=0.1",
                "robots.cop.scan={}",
            ],
        )
        .unwrap();
        assert_eq!(s.run.pin, Pin::OneCore);
        let written = s.to_toml();
        let again = load(&written).unwrap_or_else(|e| panic!("{e}\n{written}"));
        assert_eq!(again, s);
        assert_eq!(again.to_toml(), written);
    }
}

#[test]
fn overrides_change_the_value_of_their_key() {
    let s = load_with(
        GOOD,
        &[
            "rules.time_limit=60",
            "robots.cop.limits.v_max=0.5",
            "robots[1].name=bandit",
            "processes.perception.params.particles=9",
            "teams.evader.radius=0.15",
        ],
    )
    .unwrap();
    assert_eq!(s.rules().time_limit, Some(60.0));
    assert_eq!(s.world.robots[0].model().v_max, 0.5);
    assert_eq!(s.world.robots[1].name, "bandit");
    assert_eq!(s.world.robots[1].model().radius, 0.15);
    assert_eq!(s.processes[0].program.params()["particles"], 9);
}

#[test]
fn the_ready_timeout_of_a_process_defaults_to_that_of_the_run() {
    let text = changed(
        "kind = \"pursuer\"",
        "kind = \"pursuer\"\nready_timeout_s = 3.0",
    );
    let s = load_with(&text, &["run.ready_timeout_s=7"]).unwrap();
    for process in &s.processes {
        let own = process.program.kind_name() == Some("pursuer");
        let wanted = if own { 3.0 } else { 7.0 };
        assert_eq!(
            process.supervision.ready_timeout_s, wanted,
            "{}",
            process.name
        );
    }
    assert!(s.processes.len() > 1);
    assert_eq!(load(&s.to_toml()).unwrap(), s);
    expect![[r#"
        error: `ready_timeout_s` is out of range
          --> small.toml:26:1 (processes.pursuer.ready_timeout_s)
           |
        26 | [[processes]]
           | ^^^^^^^^^^^^^
           = value: 0
           = expected: a number between 0.1 and 3600 (s)

        error: `ready_timeout_s` is out of range
          --> small.toml:29:1 (processes.evader_potential.ready_timeout_s)
           |
        29 | [[processes]]
           | ^^^^^^^^^^^^^
           = value: 0
           = expected: a number between 0.1 and 3600 (s)

        error: `ready_timeout_s` is out of range
          --> small.toml:32:1 (processes.perception.ready_timeout_s)
           |
        32 | [[processes]]
           | ^^^^^^^^^^^^^
           = value: 0
           = expected: a number between 0.1 and 3600 (s)

        error: `run.ready_timeout_s` is out of range
         --> --set (run.ready_timeout_s)
          |
        1 | run.ready_timeout_s=0
          |                     ^
          = value: 0
          = expected: a number between 0.1 and 3600 (s)"#]]
    .assert_eq(&load_with(GOOD, &["run.ready_timeout_s=0"]).unwrap_err());
}

#[test]
fn external_programs_run_in_the_folder_of_the_scenario() {
    let dir = tempfile::tempdir().unwrap();
    let folder = |line: &str| {
        let program = format!("command = [\"./mine\"]\nname = \"x\"{line}");
        let path = dir.path().join("game.toml");
        std::fs::write(&path, changed("kind = \"evader_potential\"", &program)).unwrap();
        let target = path.display().to_string();
        let s = Loader::new(KINDS).load(&target, &[], None).unwrap();
        assert_eq!(load(&s.to_toml()).unwrap(), s);
        let mut commands = s.external_commands();
        commands.next().unwrap().program.command_line().unwrap()
    };
    let root = dir.path().display();
    assert_eq!(folder(""), format!("./mine (in {root})"));
    let line = "\nfolder = \"./target/release\"";
    assert_eq!(folder(line), format!("./mine (in {root}/target/release)"));
    assert_eq!(folder("\nfolder = \"/\""), "./mine (in /)");
}
