//! Periods of processes, and links on which messages come later or not at all.

use std::collections::BTreeSet;

use crate::support::Sandbox;
use crate::support::history::History;
use scenario::builtin::SCENARIOS;
use serde_json::Value as Json;

/// Links of a chase: late beliefs, late and lost states, late and lost commands.
const LINKS: &str = r#"
[[links]]
topic = "perception/belief"
delay_s = 0.25
loss = 0.2
[[links]]
topic = "world/*"
to = "evader_potential"
delay_s = 0.1
loss = 0.1
[[links]]
topic = "robot/command"
from = "evader_potential_*"
delay_s = 0.05
loss = 0.3
"#;

/// Writes the chase with more tables.
fn chase(sandbox: &Sandbox, name: &str, tables: &str) {
    let chase = SCENARIOS
        .iter()
        .find(|known| known.name == "chase")
        .unwrap();
    let text = chase.text.replace("maps/city.toml", "builtin:city");
    sandbox.file(name, text + tables);
}

/// Runs 4 s of a chase.
fn run(sandbox: &Sandbox, scenario: &str, words: &[&str]) -> Json {
    let call = sandbox.protean(["run", scenario, "--quiet", "--seed", "3"]);
    call.set("rules.time_limit=4")
        .args(words.iter().copied())
        .json()
}

#[test]
fn a_run_with_periods_and_links_is_the_same_in_processes_in_one_thread_and_from_its_log() {
    let sandbox = Sandbox::new();
    chase(&sandbox, "linked.toml", LINKS);
    let periods = [
        "--set",
        "processes.perception.period=10",
        "--set",
        "processes.pursuer.period=3",
    ];
    let with = |words: &[&'static str]| run(&sandbox, "linked.toml", &[&periods, words].concat());
    let processes = with(&["--out", "a.mcap"]);
    let one = with(&["--in-process"]);
    assert_eq!(processes["digest"], one["digest"]);
    assert_eq!(processes["links"], one["links"]);
    let links = processes["links"].as_array().unwrap();
    // The beliefs to four pursuers, and two evaders with their states and commands.
    assert_eq!(links.len(), 8, "{links:?}");
    let sum = |key: &str| {
        links
            .iter()
            .map(|link| link[key].as_u64().unwrap())
            .sum::<u64>()
    };
    assert!(
        sum("lost") > 20 && sum("lost") < sum("messages") / 2,
        "{links:?}"
    );
    let again = sandbox.protean(["verify", "a.mcap", "--in-process"]).run();
    assert!(again.stdout.contains("identical"), "{again}");
    for process in [
        "perception",
        "pursuer_police_2",
        "evader_potential_evader_1",
    ] {
        let test = sandbox
            .protean(["replay", "a.mcap", "--test", process])
            .run();
        assert!(test.stdout.contains("IDENTICAL"), "{test}");
    }
    let history = History::read(&sandbox.path().join("a.mcap"));
    let ticks = |topic: &str, source: u32| -> BTreeSet<u64> {
        let messages = history.of(topic).filter(|message| message.source == source);
        messages.map(|message| message.tick).collect()
    };
    assert_eq!(ticks("perception/belief", 1), (0..80).step_by(10).collect());
    // The first belief arrives in tick 5 at the earliest, and the pursuers step in every third tick.
    let pursuer = ticks("robot/command", 2);
    assert!(
        pursuer.iter().all(|tick| *tick > 5 && tick % 3 == 0),
        "{pursuer:?}"
    );
    assert!(pursuer.len() > 15, "{pursuer:?}");
    // They hold their commands: they stop once, at the start.
    let stops = |summary: &Json, robot: usize| summary["robots"][robot]["fail_safe_stops"].clone();
    assert_eq!(stops(&processes, 1), 1);
    sandbox.assert_nothing_left();
}

#[test]
fn keys_without_effect_change_no_bit() {
    let sandbox = Sandbox::new();
    let without = run(&sandbox, "chase", &["--in-process"]);
    chase(
        &sandbox,
        "neutral.toml",
        "[[links]]\ntopic = \"*\"\ndelay_s = 0.0\nloss = 0.0\n",
    );
    let period = ["--set", "processes.perception.period=1"];
    let neutral = run(&sandbox, "neutral.toml", &period);
    assert_eq!(without["digest"], neutral["digest"]);
    assert!(without["links"].is_null());
    // A tick is 0.05 s long: rounded down to no tick.
    chase(
        &sandbox,
        "short.toml",
        "[[links]]\ntopic = \"*\"\ndelay_s = 0.02\n",
    );
    let short = run(&sandbox, "short.toml", &["--in-process"]);
    assert_eq!(without["digest"], short["digest"]);
    chase(
        &sandbox,
        "late.toml",
        "[[links]]\ntopic = \"*\"\ndelay_s = 0.03\n",
    );
    let late = run(&sandbox, "late.toml", &["--in-process"]);
    assert_ne!(without["digest"], late["digest"]);
}

#[test]
fn a_slow_perception_changes_the_chase_and_lets_it_go_on() {
    let sandbox = Sandbox::new();
    let set = |period| format!("processes.perception.period={period}");
    let fast = run(&sandbox, "chase", &["--in-process", "--set", &set(1)]);
    let slow = run(&sandbox, "chase", &["--in-process", "--set", &set(10)]);
    let beliefs = |summary: &Json| summary["topics"]["perception/belief"]["messages"].as_u64();
    assert_ne!(fast["digest"], slow["digest"]);
    assert_eq!(beliefs(&fast), beliefs(&slow).map(|messages| 10 * messages));
    for robot in slow["robots"].as_array().unwrap() {
        assert!(robot["distance_m"].as_f64().unwrap() > 0.2, "{robot}");
        assert_eq!(robot["fail_safe_stops"], 0, "{robot}");
    }
}

#[test]
fn the_dataflow_shows_periods_and_links() {
    let sandbox = Sandbox::new();
    chase(&sandbox, "linked.toml", LINKS);
    let call = sandbox.protean(["check", "linked.toml", "--graph", "flow.mmd"]);
    let checked = call.set("processes.perception.period=5").run();
    assert_eq!(checked.code, Some(0), "{checked}");
    let text = std::fs::read_to_string(sandbox.path().join("flow.mmd")).unwrap();
    for part in [
        "<b>perception</b><br/>every 5th tick",
        "perception/belief (+0.25 s, 20 % lost)",
        "world/state (+0.1 s, 10 % lost)<br/>world/map",
        "robot/command (+0.05 s, 30 % lost)",
        ". \"robot/command\" .",
    ] {
        assert!(text.contains(part), "{part}\n{text}");
    }
}

#[test]
fn links_and_periods_that_make_no_sense_are_refused_with_their_place() {
    let sandbox = Sandbox::new();
    let state = "topic = \"world/state\"\n";
    for (link, words) in [
        (
            "topic = \"perception/beliefs\"",
            &["links[0].topic", "did you mean `perception/belief`"][..],
        ),
        ("topic = \"optimiser/plan\"", &["no topic is called"]),
        ("delay_s = 1.0", &["missing key `topic`"]),
        (
            &format!("{state}from = \"world\""),
            &["no process or kind", "links[0].from", "`simulator`"],
        ),
        (
            &format!("{state}to = \"pursuers\""),
            &["links[0].to", "did you mean `pursuer`"],
        ),
        (
            &format!("{state}from = \"perception\""),
            &["no message goes over this link"],
        ),
        (
            "topic = \"world/map\"",
            &["always arrive", "perception/belief"],
        ),
        ("topic = \"world/obstacle_event\"", &["always arrive"]),
        (
            &format!("{state}delay_s = -0.5"),
            &["-0.5", "between 0 and 60 (s)"],
        ),
        (
            &format!("{state}delay_s = inf"),
            &["delay_s", "a finite number"],
        ),
        (&format!("{state}loss = 1.0"), &["links[0].loss", "below 1"]),
        (
            &format!("{state}lost = 0.5"),
            &["links[0].lost", "did you mean `loss`"],
        ),
    ] {
        chase(&sandbox, "bad.toml", &format!("[[links]]\n{link}\n"));
        let refused = sandbox.protean(["check", "bad.toml"]).run();
        refused.refused(2, words);
        assert!(refused.stderr.contains("bad.toml:"), "{refused}");
    }
    for (change, words) in [
        (
            "processes.perception.period=0",
            &["period", "0", "a number from 1 to 10000 (ticks)"][..],
        ),
        (
            "processes.perception.period=10001",
            &["a number from 1 to 10000 (ticks)"],
        ),
    ] {
        let refused = sandbox.protean(["check", "chase"]).set(change).run();
        refused.refused(2, words);
    }
    let optimiser = sandbox
        .protean(["check", "popup"])
        .set("processes.optimiser.period=2")
        .run();
    optimiser.refused(2, &["answers requests", "no `period`"]);
}
