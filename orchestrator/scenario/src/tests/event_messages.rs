//! Errors of events that wait for robots.

use super::*;

/// The small scenario with the first event's moment replaced by these lines.
#[track_caller]
fn refused_when(lines: &str, wants: &[&str]) {
    refused("time_s = 5.0", lines, wants);
}

/// Returns the errors of the small scenario with these events appended.
#[track_caller]
fn refused_with(events: &str, wants: &[&str]) {
    let text = format!("{GOOD}{events}");
    contains(&load(&text).expect_err("must be refused"), wants);
}

const GATE: &str = "shape = { circle = { center = [1.0, 1.0], radius = 0.2 } }\n";

/// An event of the obstacle `gate`.
fn gate(moment: &str, action: &str) -> String {
    let shape = if action == "disappear" { "" } else { GATE };
    format!("[[events]]\n{moment}\naction = \"{action}\"\nobstacle = \"gate\"\n{shape}")
}

const LATER: &str = "when = { robot = \"cop\", travelled = 1.0 }";

#[test]
fn an_event_has_one_time_or_condition() {
    refused_when(
        "",
        &[
            "neither `time_s` nor `when`",
            "small.toml:35:1 (events[0].time_s)",
            "time_s = 10.0 (s), or when = {",
        ],
    );
    refused_when(
        "time_s = 5.0\nwhen = { robot = \"cop\", travelled = 1.0 }",
        &[
            "both `time_s` and `when`",
            "small.toml:37:8 (events[0].when)",
        ],
    );
    refused_when(
        "time_s = 5.0\nafter_s = 1.0",
        &[
            "`after_s` delays an event with `when`",
            "small.toml:37:11 (events[0].after_s)",
            "a later `time_s`",
        ],
    );
    refused_when(
        "when = { robot = \"cop\", travelled = 1.0 }\nafter_s = -1.0",
        &[
            "`after_s` is out of range",
            "(events[0].after_s)",
            "value: -1",
            "a number between 0 and 1000000000 (s)",
        ],
    );
    refused_when(
        "when = 5.0",
        &["wrong type", "small.toml:36:8 (events[0].when)", "5.0"],
    );
}

#[test]
fn a_condition_needs_an_existing_robot() {
    refused_when(
        "when = { travelled = 1.0 }",
        &["missing key `robot`", "(events[0].when.robot)"],
    );
    refused_when(
        "when = { robot = \"copp\", travelled = 1.0 }",
        &[
            "no robot is called `copp`",
            "small.toml:36:18 (events[0].when.robot)",
            "value: \"copp\"",
            "one of `cop`, `thief`",
            "did you mean `cop`?",
        ],
    );
}

#[test]
fn a_robot_has_one_condition() {
    refused_when(
        "when = { robot = \"cop\" }",
        &[
            "`when` has no condition",
            "small.toml:36:8 (events[0].when)",
            "`travelled` (m), `progress` (0 to 1), or `within` (m) together with `of`",
        ],
    );
    refused_when(
        "when = { robot = \"cop\", travelled = 1.0, within = 0.5, of = [0.0, 0.0] }",
        &[
            "two conditions, `travelled` and `within`",
            "small.toml:36:51 (events[0].when.within)",
            "one of `travelled`",
        ],
    );
    refused_when(
        "when = { robot = \"cop\", within = 0.5 }",
        &["missing key `of`", "(events[0].when.of)", "of = [x, y]"],
    );
    refused_when(
        "when = { robot = \"cop\", of = [1.0, 0.0] }",
        &[
            "comes `within` a distance of",
            "(events[0].when.of)",
            "within = 0.8 (m) beside it",
        ],
    );
    refused_when(
        "when = { robot = \"cop\", traveled = 1.0 }",
        &[
            "unknown key `traveled`",
            "(events[0].when.traveled)",
            "did you mean `travelled`?",
        ],
    );
    refused_when(
        "when = { robot = \"cop\", within = 0.5, of = [1.0] }",
        &["(events[0].when.of"],
    );
}

#[test]
fn the_values_of_conditions_are_checked() {
    refused_when(
        "when = { robot = \"cop\", travelled = -1.5 }",
        &[
            "`when.travelled` is out of range",
            "small.toml:36:37 (events[0].when.travelled)",
            "value: -1.5",
            "a number between 0 and 100000 (m)",
        ],
    );
    refused_when(
        "when = { robot = \"cop\", travelled = nan }",
        &["(events[0].when.travelled)", "a finite number"],
    );
    refused_when(
        "when = { robot = \"cop\", within = 0.0, of = [0.0, 0.0] }",
        &["(events[0].when.within)", "value: 0", "a number above 0"],
    );
    refused_when(
        "when = { robot = \"cop\", within = 0.5, of = [0.0, 1e6] }",
        &[
            "(events[0].when.of[1])",
            "value: 1000000",
            "within ±100000 (m)",
        ],
    );
    refused_when(
        "when = { robot = \"cop\", within = 0.5, of = [5.0, 2.5] }",
        &[
            "no place of the map is within 0.5 m of [5.0, 2.5]: it ends 1.118 m from there",
            "(events[0].when.of)",
            "x = -4 to 4, y = -2 to 2 (m)",
        ],
    );
    let near = "when = { robot = \"cop\", within = 1.2, of = [5.0, 2.5] }";
    assert!(load(&changed("time_s = 5.0", near)).is_ok());
}

#[test]
fn progress_needs_a_goal_away_from_the_start() {
    let progress = "when = { robot = \"cop\", progress = 0.36 }";
    refused_when(
        progress,
        &[
            "robot `cop` has no goal to make progress to",
            "small.toml:36:36 (events[0].when.progress)",
            "value: 0.36",
            "a robot with a `goal`",
        ],
    );
    let with_goal = |center: &str, progress: &str| {
        let goal =
            format!("name = \"cop\"\ngoal = {{ circle = {{ center = {center}, radius = 0.3 }} }}");
        changed("time_s = 5.0", progress).replace("name = \"cop\"", &goal)
    };
    assert!(load(&with_goal("[3.0, 1.5]", progress)).is_ok());
    contains(
        &load(&with_goal("[-3.0, 0.0]", progress)).unwrap_err(),
        &[
            "robot `cop` starts at the centre of its goal",
            "(events[0].when.progress)",
        ],
    );
    contains(
        &load(&with_goal("[3.0, 1.5]", &progress.replace("0.36", "36"))).unwrap_err(),
        &[
            "`when.progress` is out of range",
            "value: 36",
            "a number between 0 and 1",
        ],
    );
}

#[test]
fn an_ordered_event_must_fit_the_events_before_it() {
    refused_with(
        &gate(LATER, "disappear"),
        &[
            "no obstacle `gate` is present after the events before this one",
            "small.toml:47:12 (events[2].obstacle)",
            "one of `wall`, `block`",
            "happen in the order of the file",
        ],
    );
    refused_with(
        &gate(LATER, "move").replace("\"gate\"", "\"wal\""),
        &["no obstacle `wal` is present", "did you mean `wall`?"],
    );
    let twice = gate(LATER, "appear").repeat(2);
    refused_with(
        &twice,
        &[
            "obstacle `gate` appears after the events before this one, but it is present already",
            "(events[3].obstacle)",
        ],
    );
    // At a fixed time, but of an obstacle that waits: the order of the file holds.
    let behind = gate("time_s = 9.0", "disappear") + &gate(LATER, "appear");
    refused_with(
        &behind,
        &[
            "no obstacle `gate` is present after the events before this one",
            "(events[2].obstacle)",
            "in the order of the file",
        ],
    );
    let back = gate("time_s = 9.0", "appear")
        + &gate(LATER, "disappear")
        + &gate("time_s = 0.0", "appear");
    refused_with(
        &back,
        &[
            "obstacle `gate` changes at 0 s, after a change at 9 s",
            "(events[4].time_s)",
            "a time of at least 9 (s)",
        ],
    );
    let sound = gate("time_s = 9.0", "appear")
        + &gate(LATER, "move")
        + &gate("time_s = 12.0", "disappear")
        + &gate(LATER, "appear");
    assert!(load(&format!("{GOOD}{sound}")).is_ok());
}

#[test]
fn an_error_is_reported_once() {
    let broken = gate("when = { robot = \"absent\", travelled = 1.0 }", "appear")
        + &gate("time_s = 9.0", "disappear");
    let error = load(&format!("{GOOD}{broken}")).unwrap_err();
    contains(&error, &["no robot is called `absent`"]);
    assert!(!error.contains("no obstacle `gate`"), "{error}");
}
