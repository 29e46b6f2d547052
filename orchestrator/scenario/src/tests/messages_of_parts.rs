//! Errors between the parts of a scenario: processes, events, maps, overrides.

use super::*;

#[test]
fn process_kinds_are_known_or_the_nearest_is_suggested() {
    refused(
        &[
            ("kind = \"pursuer\"", "kind = \"persuer\""),
            ("kind = \"pursuer\"", "kind = \"ros2_bridge\""),
            ("kind = \"pursuer\"", "kind = \"simulator\""),
            ("kind = \"pursuer\"", ""),
            (
                "kind = \"pursuer\"",
                "kind = \"pursuer\"\ncommand = [\"x\"]",
            ),
            ("kind = \"pursuer\"", "kind = \"pursuer\"\nfolder = \"x\""),
            ("kind = \"pursuer\"", "command = []"),
            (
                "kind = \"perception\"",
                "kind = \"perception\"\nname = \"simulator\"",
            ),
            (
                "kind = \"perception\"",
                "kind = \"perception\"\nname = \"pursuer\"",
            ),
            ("params = {", "params = 3 #"),
            (
                "robots = [\"cop\"]",
                "robots = [\"cop\"]\nparams = { preset = \"papr\" }",
            ),
        ],
        &expect![[r#"
            error: unknown process kind `persuer`
              --> small.toml:27:8 (processes.persuer.kind)
               |
            27 | kind = "persuer"
               |        ^^^^^^^^^
               = value: "persuer"
               = expected: one of `perception`, `pursuer`, `evader_braitenberg`, `evader_potential`, `ping`, `pong`, `optimiser`, `navigator`
               = help: did you mean `pursuer`?
            error: unknown process kind `ros2_bridge`
              --> small.toml:27:8 (processes.ros2_bridge.kind)
               |
            27 | kind = "ros2_bridge"
               |        ^^^^^^^^^^^^^
               = value: "ros2_bridge"
               = help: this program is built without it; the Python wheel has it, and a program built with --features ros2
            error: the simulator always runs and is not listed
              --> small.toml:27:8 (processes.simulator.kind)
               |
            27 | kind = "simulator"
               |        ^^^^^^^^^^^
               = value: "simulator"
               = help: remove this block; the world is described in [world], [rules] and [[robots]]
            error: a process without `kind`
              --> small.toml:26:1 (processes[0])
               |
            26 | [[processes]]
               | ^^^^^^^^^^^^^
               = expected: kind = "…" for a built-in process, or command = ["…"] for an external program
            error: both `kind` and `command`
              --> small.toml:28:11 (processes.pursuer.command)
               |
            28 | command = ["x"]
               |           ^^^^^
               = value: ["x"]
               = expected: one of them: `kind` for a built-in process, `command` for an external program
            error: `folder` without `command`
              --> small.toml:28:10 (processes.pursuer.folder)
               |
            28 | folder = "x"
               |          ^^^
               = value: "x"
               = expected: no `folder`: it is the working directory of an external program
            error: the command names no program
              --> small.toml:27:11 (processes[0].command)
               |
            27 | command = []
               |           ^^
               = value: []
               = expected: command = ["program", "argument", …]
            error: `simulator` is reserved
              --> small.toml:32:1 (processes.simulator.name)
               |
            32 | [[processes]]
               | ^^^^^^^^^^^^^
               = expected: another name
            error: two processes are called `pursuer`
              --> small.toml:32:1 (processes.pursuer.name)
               |
            32 | [[processes]]
               | ^^^^^^^^^^^^^
               = expected: a unique name for every process (`name = "…"`)
            error: wrong type: a whole number
              --> small.toml:34:10 (processes.perception.params)
               |
            34 | params = 3 # particles = 200 }
               |          ^
               = expected: a table
            error: kind `pursuer` has no such preset
              --> small.toml:29:21 (processes.pursuer.params.preset)
               |
            29 | params = { preset = "papr" }
               |                     ^^^^^^
               = value: "papr"
               = expected: `paper`
               = help: did you mean `paper`?"#]],
    );
}

#[test]
fn the_reaction_to_a_failure_must_fit_the_mode() {
    let pursuer = |keys: &str| format!("kind = \"pursuer\"\n{keys}");
    let changes = [
        "on_failure = \"retry\"",
        "on_failure = \"restart\"",
        "restart = { limit = 2 }",
        "ready_timeout_s = 0.0",
    ];
    let texts = changes.map(|keys| changed("kind = \"pursuer\"", &pursuer(keys)));
    texts_refused(
        texts,
        &expect![[r#"
            error: `retry` is not one of the choices
              --> small.toml:28:14 (processes.pursuer.on_failure)
               |
            28 | on_failure = "retry"
               |              ^^^^^^^
               = value: "retry"
               = expected: one of `abort`, `restart`, `continue`
               = help: did you mean `restart`?
            error: lock-step mode cannot restart a process
              --> small.toml:28:14 (processes.pursuer.on_failure)
               |
            28 | on_failure = "restart"
               |              ^^^^^^^^^
               = value: "restart"
               = expected: "abort" or "continue", or run.mode = "real_time"
            error: unknown key `restart`
              --> small.toml:28:1 (processes.pursuer.restart)
               |
            28 | restart = { limit = 2 }
               | ^^^^^^^
               = value: { limit = 2 }
               = expected: one of `name`, `kind`, `command`, `folder`, `declaration`, `robots`, `team`, `grouping`, `on_failure`, `ready_timeout_s`, `period`, `params`
            error: `ready_timeout_s` is out of range
              --> small.toml:28:19 (processes.pursuer.ready_timeout_s)
               |
            28 | ready_timeout_s = 0.0
               |                   ^^^
               = value: 0
               = expected: a number between 0.1 and 3600 (s)"#]],
    );
}

#[test]
fn every_robot_is_driven_by_exactly_one_process() {
    refused(
        &[
            ("robots = [\"cop\"]", "robots = [\"copp\"]"),
            ("robots = [\"cop\"]", "robots = [\"cop\", \"thief\"]"),
            ("robots = [\"cop\"]", "robots = [\"cop\", \"cop\"]"),
            (
                "[[processes]]\nkind = \"pursuer\"\nrobots = [\"cop\"]\n",
                "",
            ),
            ("robots = [\"cop\"]", ""),
            (
                "robots = [\"cop\"]",
                "robots = [\"cop\"]\nteam = \"police\"",
            ),
            ("robots = [\"cop\"]", "team = \"neutral\""),
            ("params = { particles = 200 }", "team = \"police\""),
        ],
        &expect![[r#"
            error: no robot is called `copp`
              --> small.toml:28:11 (processes.pursuer.robots[0])
               |
            28 | robots = ["copp"]
               |           ^^^^^^
               = value: "copp"
               = expected: one of `cop`, `thief`
               = help: did you mean `cop`?
            error: robot `thief` is driven by two processes, `pursuer_thief` and `evader_potential`
              --> small.toml:29:1 (processes.evader_potential)
               |
            29 | [[processes]]
               | ^^^^^^^^^^^^^
               = expected: exactly one process that drives it
            error: robot `cop` occurs twice in the list
              --> small.toml:28:18 (processes.pursuer.robots[1])
               |
            28 | robots = ["cop", "cop"]
               |                  ^^^^^
               = value: "cop"
            error: robot `cop` is driven by no process
              --> small.toml:17:1 (robots.cop)
               |
            17 | [[robots]]
               | ^^^^^^^^^^
               = expected: exactly one process that drives it
               = help: add robots = ["cop"] to a [[processes]] block
            error: this process drives no robot
              --> small.toml:26:1 (processes.pursuer)
               |
            26 | [[processes]]
               | ^^^^^^^^^^^^^
               = expected: robots = ["…"] or team = "…"
            error: both `robots` and `team`
              --> small.toml:29:8 (processes.pursuer.team)
               |
            29 | team = "police"
               |        ^^^^^^^^
               = value: "police"
               = expected: one of them
            error: no robot is in team `neutral`
              --> small.toml:28:8 (processes.pursuer.team)
               |
            28 | team = "neutral"
               |        ^^^^^^^^^
               = value: "neutral"
               = expected: one of `evader`, `police`
            error: a process of kind `perception` drives no robots
              --> small.toml:34:8 (processes.perception.team)
               |
            34 | team = "police"
               |        ^^^^^^^^
               = value: "police"
               = expected: no `team`"#]],
    );
}

#[test]
fn processes_that_wait_for_each_other_are_named_with_their_inputs() {
    let circle = "\n[[processes]]\nkind = \"ping\"\n[[processes]]\nkind = \"pong\"\n";
    let one = "\n[[processes]]\nkind = \"ping\"\n";
    let texts = [circle, one].map(|processes| GOOD.to_owned() + processes);
    texts_refused(
        texts,
        &expect![[r#"
        error: processes wait for each other within a tick: `ping` reads observer/prediction, `pong` reads world/verdict
          --> small.toml:45:1 (processes.ping)
           |
        45 | [[processes]]
           | ^^^^^^^^^^^^^
           = expected: inputs of the tick before for one of them
        error: process `ping` reads observer/prediction, but no process writes it
          --> small.toml:45:1 (processes.ping)
           |
        45 | [[processes]]
           | ^^^^^^^^^^^^^
           = expected: a [[processes]] block with kind = "pong""#]],
    );
}

#[test]
fn the_inputs_of_a_process_must_be_written() {
    let block = "[[processes]]\nkind = \"perception\"\nparams = { particles = 200 }\n";
    refused(
        &[(block, "")],
        &expect![[r#"
        error: process `pursuer` reads perception/belief, but no process writes it
          --> small.toml:26:1 (processes.pursuer)
           |
        26 | [[processes]]
           | ^^^^^^^^^^^^^
           = expected: a [[processes]] block with kind = "perception""#]],
    );
    let exact = changed(block, "").replace(
        "robots = [\"cop\"]",
        "robots = [\"cop\"]\nparams.knowledge = \"exact\"",
    );
    assert!(load(&exact).is_ok());
    refused(
        &[
            (
                block,
                &format!("{block}{}", block.replace("kind", "name = \"p2\"\nkind")),
            ),
            (
                "kind = \"evader_potential\"",
                "kind = \"evader_braitenberg\"",
            ),
        ],
        &expect![[r#"
            error: two processes write perception/belief, `perception` and `p2`
              --> small.toml:35:1 (processes.p2)
               |
            35 | [[processes]]
               | ^^^^^^^^^^^^^
               = expected: at most one
            error: robot `thief` has no range scanner, but process `evader_braitenberg` (evader_braitenberg) steers by it
              --> small.toml:21:1 (robots.thief.scan)
               |
            21 | [[robots]]
               | ^^^^^^^^^^
               = expected: a `scan` table on the robot
               = help: scan = {} is the TurtleBot3's scanner: 360 beams, 3.5 m"#]],
    );
    let sighted = changed(
        "kind = \"evader_potential\"",
        "kind = \"evader_braitenberg\"",
    )
    .replace("name = \"thief\"", "name = \"thief\"\nscan = {}");
    assert!(load(&sighted).is_ok());
}
