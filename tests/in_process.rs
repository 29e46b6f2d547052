//! A run in one process is the run with processes, to the bit.

use crate::support::Sandbox;
use crate::support::history::History;
use scenario::builtin::SCENARIOS;
use serde_json::Value as Json;

/// A scenario, what is changed in it, and the seeds it is run with.
struct Case {
    scenario: &'static str,
    set: &'static [&'static str],
    seeds: &'static [&'static str],
}

const CASES: [Case; 32] = [
    Case {
        scenario: "chase",
        set: &["rules.time_limit=5"],
        seeds: &["1"],
    },
    // Two perceptions and the largest messages.
    Case {
        scenario: "chase",
        set: &[
            "rules.time_limit=2",
            "processes.perception.params.filter.particles=3000",
        ],
        seeds: &["3"],
    },
    // To its natural end: captures and escapes.
    Case {
        scenario: "chase_exact",
        set: &["run.dt=0.1"],
        seeds: &["2"],
    },
    Case {
        scenario: "chase_exact",
        set: &[
            "rules.time_limit=4",
            "processes.pursuer.params.preset=paper",
        ],
        seeds: &["4"],
    },
    Case {
        scenario: "chase_braitenberg",
        set: &["rules.time_limit=4"],
        seeds: &["1"],
    },
    Case {
        scenario: "chase_layouts",
        set: &["rules.time_limit=4"],
        seeds: &["5"],
    },
    // All of its obstacle events fall into this time.
    Case {
        scenario: "chase_popup",
        set: &["run.dt=0.1", "rules.time_limit=80"],
        seeds: &["1"],
    },
    Case {
        scenario: "chase_paper",
        set: &["rules.time_limit=4"],
        seeds: &["1"],
    },
    Case {
        scenario: "chase_layouts",
        set: &["rules.time_limit=4"],
        seeds: &["1"],
    },
    Case {
        scenario: "single_lane",
        set: &["rules.time_limit=20"],
        seeds: &["1"],
    },
    // Plans and trees.
    Case {
        scenario: "chase_rrt_star",
        set: &["rules.time_limit=4"],
        seeds: &["1"],
    },
    // Verdicts, which are part of the outcome.
    Case {
        scenario: "chase_referee",
        set: &["rules.time_limit=4"],
        seeds: &["1"],
    },
    Case {
        scenario: "chase_reach_avoid",
        set: &["rules.time_limit=4"],
        seeds: &["1"],
    },
    // Requests and answers, and obstacles that wait for a robot.
    Case {
        scenario: "popup",
        set: &[],
        seeds: &["1"],
    },
    Case {
        scenario: "popup_city",
        set: &["rules.time_limit=20"],
        seeds: &["1"],
    },
    // Waypoints, and predictions of an observer.
    Case {
        scenario: "patrol_octagon",
        set: &["rules.time_limit=30"],
        seeds: &["1"],
    },
    Case {
        scenario: "patrol_square",
        set: &["rules.time_limit=30"],
        seeds: &["2"],
    },
    Case {
        scenario: "patrol_square",
        set: &["rules.time_limit=30", "processes.patrol.kind=patrol_fto"],
        seeds: &["1"],
    },
    Case {
        scenario: "patrol_square",
        set: &[
            "rules.time_limit=30",
            "processes.patrol.kind=patrol_fto",
            "processes.patrol.params.protection=mixed",
        ],
        seeds: &["1"],
    },
    Case {
        scenario: "patrol_team",
        set: &["rules.time_limit=60"],
        seeds: &["1"],
    },
    // Events of robots.
    Case {
        scenario: "patrol_chase",
        set: &["rules.time_limit=60"],
        seeds: &["1"],
    },
    // Attacks, which are part of the outcome.
    Case {
        scenario: "patrol_intruder",
        set: &["rules.time_limit=60", "processes.intruder.params.first_s=1"],
        seeds: &["1"],
    },
    Case {
        scenario: "patrol_graph",
        set: &["rules.time_limit=60"],
        seeds: &["1"],
    },
    Case {
        scenario: "patrol_graph",
        set: &[
            "rules.time_limit=60",
            "processes.patrol.params.strategy=markov",
        ],
        seeds: &["1"],
    },
    Case {
        scenario: "coverage_open",
        set: &["rules.time_limit=30"],
        seeds: &["1"],
    },
    // Three robots, each in its part of the workplace.
    Case {
        scenario: "coverage_open",
        set: &[
            "rules.time_limit=30",
            "robots=[{ name = \"sweeper\", team = \"neutral\", count = 3, random_start = {}, limits = { v_max = 1.0 } }]",
            "processes=[{ name = \"cover\", kind = \"coverage_keyed\", team = \"neutral\" }]",
        ],
        seeds: &["1"],
    },
    Case {
        scenario: "coverage_case1",
        set: &["rules.time_limit=30"],
        seeds: &["1"],
    },
    Case {
        scenario: "coverage_case1",
        set: &[
            "rules.time_limit=30",
            "processes.cover.params.follow.interpolation=arc",
        ],
        seeds: &["3"],
    },
    Case {
        scenario: "coverage_case2",
        set: &["rules.time_limit=30"],
        seeds: &["1"],
    },
    Case {
        scenario: "coverage_polygons",
        set: &["rules.time_limit=30", "processes.cover.params.map=keyed"],
        seeds: &["1"],
    },
    Case {
        scenario: "coverage_polygons",
        set: &["rules.time_limit=30"],
        seeds: &["1"],
    },
    Case {
        scenario: "hello",
        set: &[],
        seeds: &["7"],
    },
];

fn run(sandbox: &Sandbox, case: &Case, seed: &str, words: &[&str]) -> Json {
    let mut call = sandbox.protean(["run", case.scenario, "--quiet", "--seed", seed]);
    for change in case.set {
        call = call.set(change);
    }
    for word in words {
        call = call.arg(word);
    }
    call.json()
}

/// The fields of a summary that do not depend on how it was run.
fn simulated(summary: &Json) -> Json {
    let mut simulated = serde_json::Map::new();
    for field in [
        "scenario",
        "seed",
        "digest",
        "ticks",
        "sim_time_s",
        "interrupted",
        "robots",
        "events",
        "events_omitted",
        "coverage",
        "attacks",
        "escape_possible_fraction",
        "escape_impossible_from_s",
    ] {
        simulated.insert(field.to_owned(), summary[field].clone());
    }
    // Heartbeats, names and pictures for viewers belong to processes and logs.
    let topics = summary["topics"].as_object().unwrap();
    let counted = topics.iter().filter(|(name, _)| {
        let other = ["run/control", "world/robots"];
        !name.starts_with('/') && !name.starts_with("process/") && !other.contains(&name.as_str())
    });
    simulated.insert(
        "topics".to_owned(),
        counted
            .map(|(name, count)| (name.clone(), count.clone()))
            .collect::<serde_json::Map<_, _>>()
            .into(),
    );
    simulated.into()
}

#[test]
fn digest_outcome_and_metrics_are_those_of_the_run_with_processes() {
    for scenario in SCENARIOS {
        assert!(
            CASES.iter().any(|case| case.scenario == scenario.name),
            "no case for {}",
            scenario.name
        );
    }
    let sandbox = Sandbox::new();
    for case in &CASES {
        for seed in case.seeds {
            let processes = run(&sandbox, case, seed, &[]);
            let one = run(&sandbox, case, seed, &["--in-process"]);
            let what = format!("{} {:?} seed {seed}", case.scenario, case.set);
            assert_eq!(simulated(&processes), simulated(&one), "{what}");
            assert!(processes["latency_us"].is_object(), "{what}");
            assert!(one["latency_us"].is_null(), "{what}");
            assert_eq!(one["log"], "", "{what}");
        }
    }
    sandbox.assert_nothing_left();
}

#[test]
fn obstacle_events_are_in_the_history() {
    let sandbox = Sandbox::new();
    let case = CASES
        .iter()
        .find(|case| case.scenario == "chase_popup")
        .unwrap();
    let summary = run(&sandbox, case, "1", &["--in-process"]);
    let obstacles = summary["events"]
        .as_array()
        .unwrap()
        .iter()
        .filter(|event| event["kind"] == "obstacle")
        .count();
    // The test above is worth nothing if the game ends before the first of them.
    assert!(obstacles >= 2, "{obstacles}");
    assert_eq!(summary["topics"]["world/obstacle_event"]["messages"], 5);
}

#[test]
fn a_log_is_written_when_asked_for_and_is_the_same_but_for_the_clocks() {
    let sandbox = Sandbox::new();
    let case = &CASES[0];
    let processes = run(&sandbox, case, "1", &["--out", "many.mcap"]);
    let one = run(&sandbox, case, "1", &["--in-process", "--out", "one.mcap"]);
    assert_eq!(simulated(&processes), simulated(&one));
    assert!(one["latency_us"].is_null());
    let read = |name: &str| History::read(&sandbox.path().join(name));
    let (many, one) = (read("many.mcap"), read("one.mcap"));
    assert_eq!(many.states, one.states);
    assert_eq!(many.events, one.events);
    assert_eq!(many.commands, one.commands);
    assert_eq!(many.sightings, one.sightings);
    assert_eq!(many.beliefs, one.beliefs);
    assert_eq!(many.maps, one.maps);
    let again = sandbox
        .protean(["run", "hello", "--in-process", "--out", "one.mcap"])
        .run();
    assert_eq!(again.code, Some(2), "{again}");
    assert!(again.stderr.contains("exists already"), "{again}");
}

#[test]
fn what_needs_processes_is_refused_by_name() {
    let sandbox = Sandbox::new();
    let refused = |words: &[&str], set: &[&str]| {
        let mut call = sandbox.protean(["run", "--in-process"]);
        for word in words {
            call = call.arg(word);
        }
        for change in set {
            call = call.set(change);
        }
        let outcome = call.run();
        assert_ne!(outcome.code, Some(0), "{outcome}");
        outcome.stderr
    };
    let real_time = refused(&["hello"], &["run.mode=real_time"]);
    assert!(real_time.contains("run.mode"), "{real_time}");
    let both = refused(&["hello", "--real-time"], &[]);
    assert!(both.contains("--real-time"), "{both}");
}
