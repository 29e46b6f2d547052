//! Errors between the parts of a scenario: processes, events, maps, overrides.

use super::*;

#[test]
fn process_kinds_are_known_or_the_nearest_is_suggested() {
    refused(
        "kind = \"pursuer\"",
        "kind = \"persuer\"",
        &[
            "unknown process kind `persuer`",
            "small.toml:27:8 (processes.persuer.kind)",
            "did you mean `pursuer`?",
            "`evader_potential`",
        ],
    );
    refused(
        "kind = \"pursuer\"",
        "kind = \"simulator\"",
        &["the simulator always runs and is not listed"],
    );
    refused(
        "kind = \"pursuer\"",
        "",
        &["a process without `kind`", "small.toml:26:1"],
    );
    refused(
        "kind = \"pursuer\"",
        "kind = \"pursuer\"\ncommand = [\"x\"]",
        &["both `kind` and `command`"],
    );
    refused(
        "kind = \"pursuer\"",
        "kind = \"pursuer\"\nfolder = \"x\"",
        &["`folder` without `command`"],
    );
    refused(
        "kind = \"pursuer\"",
        "command = []",
        &["the command names no program"],
    );
    refused(
        "kind = \"perception\"",
        "kind = \"perception\"\nname = \"simulator\"",
        &["`simulator` is reserved"],
    );
    refused(
        "kind = \"perception\"",
        "kind = \"perception\"\nname = \"pursuer\"",
        &["two processes are called `pursuer`"],
    );
    refused(
        "params = {",
        "params = 3 #",
        &["(processes.perception.params)", "expected: a table"],
    );
    refused(
        "robots = [\"cop\"]",
        "robots = [\"cop\"]\nparams = { preset = \"papr\" }",
        &["has no such preset", "did you mean `paper`?"],
    );
}

#[test]
fn the_reaction_to_a_failure_must_fit_the_mode() {
    let pursuer = |keys: &str| format!("kind = \"pursuer\"\n{keys}");
    for (keys, words) in [
        (
            "on_failure = \"retry\"",
            "`retry` is not one of the choices",
        ),
        (
            "on_failure = \"restart\"",
            "expected: \"abort\" or \"continue\", or run.mode = \"real_time\"",
        ),
        ("restart = { limit = 2 }", "unknown key `restart`"),
        ("ready_timeout_s = 0.0", "`ready_timeout_s` is out of range"),
    ] {
        refused("kind = \"pursuer\"", &pursuer(keys), &[words]);
    }
}

#[test]
fn every_robot_is_driven_by_exactly_one_process() {
    refused(
        "robots = [\"cop\"]",
        "robots = [\"copp\"]",
        &[
            "no robot is called `copp`",
            "small.toml:28:11 (processes.pursuer.robots[0])",
            "did you mean `cop`?",
            "one of `cop`, `thief`",
        ],
    );
    refused(
        "robots = [\"cop\"]",
        "robots = [\"cop\", \"thief\"]",
        &[
            "robot `thief` is driven by two processes, `pursuer_thief` and `evader_potential`",
            "small.toml:29:1",
        ],
    );
    refused(
        "robots = [\"cop\"]",
        "robots = [\"cop\", \"cop\"]",
        &["robot `cop` occurs twice"],
    );
    refused(
        "[[processes]]\nkind = \"pursuer\"\nrobots = [\"cop\"]\n",
        "",
        &[
            "robot `cop` is driven by no process",
            "small.toml:17:1 (robots.cop)",
            "add robots = [\"cop\"]",
        ],
    );
    refused(
        "robots = [\"cop\"]",
        "",
        &["this process drives no robot", "robots = [\"…\"] or team ="],
    );
    refused(
        "robots = [\"cop\"]",
        "robots = [\"cop\"]\nteam = \"police\"",
        &["both `robots` and `team`"],
    );
    refused(
        "robots = [\"cop\"]",
        "team = \"neutral\"",
        &["no robot is in team `neutral`"],
    );
    refused(
        "params = { particles = 200 }",
        "team = \"police\"",
        &["a process of kind `perception` drives no robots"],
    );
}

#[test]
fn processes_that_wait_for_each_other_are_named_with_their_inputs() {
    let circle = "\n[[processes]]\nkind = \"ping\"\n[[processes]]\nkind = \"pong\"\n";
    let problems = load(&(GOOD.to_owned() + circle)).unwrap_err();
    let expected = "processes wait for each other within a tick: `ping` reads observer/prediction, \
                    `pong` reads world/verdict";
    assert!(problems.contains(expected), "{problems}");
    let one = "\n[[processes]]\nkind = \"ping\"\n";
    let lacks = load(&(GOOD.to_owned() + one)).unwrap_err();
    assert!(lacks.contains("process `ping` reads observer/prediction, but no process writes it"));
    assert!(lacks.contains("kind = \"pong\""), "{lacks}");
}

#[test]
fn the_inputs_of_a_process_must_be_written() {
    let block = "[[processes]]\nkind = \"perception\"\nparams = { particles = 200 }\n";
    refused(
        block,
        "",
        &[
            "process `pursuer` reads perception/belief, but no process writes it",
            "kind = \"perception\"",
        ],
    );
    let exact = changed(block, "").replace(
        "robots = [\"cop\"]",
        "robots = [\"cop\"]\nparams.knowledge = \"exact\"",
    );
    assert!(load(&exact).is_ok());
    refused(
        block,
        &format!("{block}{}", block.replace("kind", "name = \"p2\"\nkind")),
        &["two processes write perception/belief, `perception` and `p2`"],
    );
    refused(
        "kind = \"evader_potential\"",
        "kind = \"evader_braitenberg\"",
        &[
            "robot `thief` has no range scanner, but process `evader_braitenberg`",
            "small.toml:21:1 (robots.thief.scan)",
            "scan = {}",
        ],
    );
    let sighted = changed(
        "kind = \"evader_potential\"",
        "kind = \"evader_braitenberg\"",
    )
    .replace("name = \"thief\"", "name = \"thief\"\nscan = {}");
    assert!(load(&sighted).is_ok());
}

#[test]
fn events_must_be_possible() {
    refused(
        "time_s = 2.5",
        "time_s = -2.5",
        &[
            "`time_s` is out of range",
            "small.toml:40:10 (events[1].time_s)",
            "value: -2.5",
            "a number between 0 and 1000000000 (s)",
        ],
    );
    refused(
        "obstacle = \"wall\"",
        "obstacle = \"wal\"",
        &[
            "no obstacle `wal` is present at 5 s",
            "(events[0].obstacle)",
            "one of `wall`, `block`",
            "did you mean `wall`?",
        ],
    );
    refused(
        "obstacle = \"block\"",
        "obstacle = \"wall\"",
        &["obstacle `wall` appears at 2.5 s, but it is present already"],
    );
    refused(
        "shape = { circle = { center = [1.0, -1.0], radius = 0.2 } }",
        "",
        &["missing key `shape`", "(events[1].shape)"],
    );
    refused(
        "radius = 0.2 } }",
        "radius = -0.2 } }",
        &["(events[1].shape.circle.radius)", "value: -0.2"],
    );
    let star: Vec<String> = (0..17).map(|i| format!("[{}.0, {}.0]", i, i * i)).collect();
    let polygon = format!(
        "shape = {{ polygon = {{ vertices = [{}] }} }}",
        star.join(", ")
    );
    refused(
        "shape = { circle = { center = [1.0, -1.0], radius = 0.2 } }",
        &polygon,
        &["at most 16 vertices"],
    );
    refused(
        "obstacle = \"wall\"",
        "obstacle = \"wall\"\nshape = { circle = { center = [1.0, -1.0], radius = 0.2 } }",
        &["an obstacle that disappears has no shape"],
    );
}

#[test]
fn logs_and_ends_are_checked() {
    refused(
        "[run]",
        "[log]\ncompression = \"zip\"\n[run]",
        &["`zip` is not one of the choices", "one of `zstd`, `none`"],
    );
    let endless = changed("time_limit = 30.0", "")
        .replace("capture = { radius = 0.3 }", "")
        .replace(
            "exits = [{ circle = { center = [3.0, 0.0], radius = 0.3 } }]",
            "",
        );
    contains(
        &load(&endless).unwrap_err(),
        &[
            "this run has no end condition",
            "(rules.time_limit)",
            "rules.time_limit = 60.0 (s)",
        ],
    );
}

#[test]
fn maps_are_checked_where_they_are_written() {
    refused(
        "[world.map.vector]\nbounds = { min = [-4.0, -2.0], max = [4.0, 2.0] }",
        "[world.map.vector]\nbounds = { min = [-4.0, -2.0], max = [-5.0, 2.0] }",
        &[
            "`bounds.max[0]` is out of range",
            "small.toml:9:39 (world.map.vector.bounds.max[0])",
            "value: -5",
        ],
    );
    refused(
        "half_extents = [0.2, 1.0]",
        "half_extents = [0.2, -1.0]",
        &[
            "(world.map.vector.obstacles[0].shape.rectangle.half_extents[1])",
            "small.toml:12:",
            "value: -1",
        ],
    );
    refused(
        "bounds = { min = [-4.0, -2.0], max = [4.0, 2.0] }",
        "bounds = { min = [0.0, 0.0], max = [1000000.0, 1000000.0] }",
        &["(world.map.vector.bounds.max[0])", "within ±100000"],
    );
    refused(
        "bounds = { min = [-4.0, -2.0], max = [4.0, 2.0] }",
        "bounds = { min = [-4.0, -2.0], max = [4.0, 2.0] }\nresolution = 0.0001",
        &[
            "(world.map.vector.resolution)",
            "at most max_cells = 16000000",
            "80000 × 40000",
        ],
    );
    refused(
        "[world.map.vector]",
        "[world]\nresolution = 0.0001\n[world.map.vector]",
        &["(world.resolution)", "small.toml:9:14"],
    );
    refused(
        "[world.map.vector]",
        "[world]\nresolution = 0.0011\n[world.map.vector]\nmax_cells = 50000000",
        &[
            "the map has too many cells",
            "value: 7273 × 3637 cells",
            "at most 25000000 cells",
            "(world.map)",
        ],
    );
    let none = GOOD
        .replace("[world.map.vector]", "[world]\nmap = \"maps/x.toml\"\n[x]")
        .replace("[[world.map.vector.obstacles]]", "[[x.o]]");
    contains(
        &load(&none).unwrap_err(),
        &[
            "this scenario cannot refer to files",
            "(world.map)",
            "value: \"maps/x.toml\"",
        ],
    );
    contains(
        &load("title = \"x\"").unwrap_err(),
        &["missing table `[world]`", "the scenario has no robots"],
    );
    let none = GOOD
        .replace("[world.map.vector]", "[world]\n[x]")
        .replace("[[world.map.vector.obstacles]]", "[[x.o]]");
    contains(
        &load(&none).unwrap_err(),
        &["missing key `map`", "small.toml:8:1 (world.map)"],
    );
}

#[test]
fn an_error_in_an_override_says_so() {
    let e = load_with(GOOD, &["run.seed=five"]).unwrap_err();
    contains(
        &e,
        &[
            "wrong type: text",
            "--> --set (run.seed)",
            "run.seed=five",
            "value: \"five\"",
        ],
    );
    let e = load_with(GOOD, &["run.sead=5"]).unwrap_err();
    contains(
        &e,
        &[
            "unknown key `sead`",
            "--> --set (run.sead)",
            "did you mean `seed`?",
        ],
    );
    let e = load_with(GOOD, &["robots.cop.limits.v_max=-1"]).unwrap_err();
    contains(&e, &["--> --set (robots.cop.limits.v_max)", "value: -1"]);
    let e = load_with(GOOD, &["robots.bob.radius=1"]).unwrap_err();
    contains(
        &e,
        &["`robots` has no element `bob`", "one of `cop`, `thief`"],
    );
    let e = load_with(GOOD, &["processes.perception.params.particles=many"]).unwrap_err();
    contains(&e, &["--> --set (processes.perception.params.particles)"]);
    let e = load_with(GOOD, &["run.seed=9999999999999999999"]).unwrap_err();
    contains(&e, &["whole number out of range", "--> --set"]);
}
