//! Teams of any name: who catches whom, who follows whom, and their names in all output.

use crate::support::Sandbox;
use crate::support::history::History;
use serde_json::Value as Json;

/// Two teams of pursuers, each hostile to one team of evaders, and an evader without opponents. The evaders start within
/// the capture radius of the pursuers that are not hostile to them.
const ROOM: &str = r#"
[run]
seed = 3
[world.map.vector]
bounds = { min = [-6.0, -3.0], max = [6.0, 3.0] }
[rules]
time_limit = 60.0
capture = { radius = 0.6 }
[teams.guards]
role = "pursuer"
hostile_to = ["thieves"]
limits = { v_max = 0.6 }
[teams.rangers]
role = "pursuer"
hostile_to = ["poachers"]
limits = { v_max = 0.6 }
[teams.thieves]
role = "evader"
limits = { v_max = 0.1 }
[teams.poachers]
role = "evader"
limits = { v_max = 0.1 }
[teams.tourists]
role = "evader"
hostile_to = []
limits = { v_max = 0.1 }
[[robots]]
name = "guard"
team = "guards"
start = { x = -3.0, y = 0.0, theta = 0.0 }
[[robots]]
name = "ranger"
team = "rangers"
start = { x = 3.0, y = 0.0, theta = 0.0 }
[[robots]]
name = "thief"
team = "thieves"
start = { x = 3.0, y = 0.4, theta = 0.0 }
[[robots]]
name = "poacher"
team = "poachers"
start = { x = -3.0, y = 0.4, theta = 0.0 }
[[robots]]
name = "tourist"
team = "tourists"
start = { x = -3.0, y = -0.4, theta = 0.0 }
goal = { circle = { center = [-5.0, 0.0], radius = 0.3 } }
[[processes]]
kind = "perception"
[[processes]]
kind = "pursuer"
team = "guards"
[[processes]]
kind = "pursuer"
name = "ranger"
team = "rangers"
[[processes]]
kind = "evader_potential"
robots = ["thief", "poacher", "tourist"]
grouping = "together"
[[processes]]
kind = "referee"
"#;

const GUARD: u32 = 0;
const RANGER: u32 = 1;
const THIEF: u32 = 2;
const POACHER: u32 = 3;
const TOURIST: u32 = 4;

fn record(sandbox: &Sandbox, words: &[&str]) -> (Json, History) {
    let words = [&["run", "room.toml", "--quiet"][..], words].concat();
    let summary = sandbox.protean(words).json();
    let log = sandbox.path().join(summary["log"].as_str().unwrap());
    (summary, History::read(&log))
}

#[test]
fn pursuers_follow_and_catch_the_robots_of_hostile_teams_alone() {
    let sandbox = Sandbox::new();
    sandbox.file("room.toml", ROOM);
    let (summary, history) = record(&sandbox, &["--out", "a.mcap"]);
    let captured: Vec<(u32, u32)> = history
        .events
        .iter()
        .filter(|event| event.kind == 0)
        .map(|event| (event.robot, event.other))
        .collect();
    assert!(captured.contains(&(THIEF, GUARD)), "{captured:?}");
    assert!(captured.contains(&(POACHER, RANGER)), "{captured:?}");
    assert_eq!(captured.len(), 2, "{captured:?}");
    // Perception follows the evaders that are hostile to a pursuer.
    assert!(history.beliefs.iter().any(|belief| belief.robot == THIEF));
    assert!(history.beliefs.iter().all(|belief| belief.robot != TOURIST));
    for (robot, team, role, outcome) in [
        (GUARD, "guards", "pursuer", "active"),
        (THIEF, "thieves", "evader", "caught"),
        (POACHER, "poachers", "evader", "caught"),
    ] {
        let robot = &summary["robots"][robot as usize];
        assert_eq!(robot["team"], team);
        assert_eq!(robot["role"], role);
        assert_eq!(robot["outcome"], outcome);
    }
    let again = sandbox.protean([
        "run",
        "room.toml",
        "--quiet",
        "--in-process",
        "--out",
        "b.mcap",
    ]);
    assert_eq!(again.json()["digest"], summary["digest"]);
}

#[test]
fn teams_have_their_names_in_pictures_and_pages() {
    let sandbox = Sandbox::new();
    sandbox.file("room.toml", ROOM);
    record(&sandbox, &["--in-process", "--out", "a.mcap"]);
    let drawn = sandbox
        .protean(["picture", "a.mcap", "--out", "a.svg"])
        .run();
    assert_eq!(drawn.code, Some(0), "{drawn}");
    let svg = std::fs::read_to_string(sandbox.path().join("a.svg")).unwrap();
    for text in ["1 pursuer, team guards", "1 evader, team tourists"] {
        assert!(svg.contains(text), "{text}");
    }
    let report = sandbox.protean(["report", "a.mcap"]).json();
    let page = report["page"].as_str().unwrap();
    let page = std::fs::read_to_string(sandbox.path().join(page)).unwrap();
    assert!(page.contains("\"team\":\"guards\"") && page.contains("the pursuers"));
}
