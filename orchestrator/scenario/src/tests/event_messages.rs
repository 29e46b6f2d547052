//! Errors of events that wait for robots.

use super::*;

/// Compares the errors of the small scenario, each time with other lines for the first event's moment, with the snapshot.
#[track_caller]
fn refused_when(lines: &[&str], errors: &Expect) {
    let texts = lines.iter().map(|lines| changed("time_s = 5.0", lines));
    texts_refused(texts, errors);
}

/// Compares the errors of the small scenario, each time with some events appended, with the snapshot.
#[track_caller]
fn refused_with(events: &[&str], errors: &Expect) {
    let texts = events.iter().map(|events| format!("{GOOD}{events}"));
    texts_refused(texts, errors);
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
        &[
            "",
            "time_s = 5.0\nwhen = { robot = \"cop\", travelled = 1.0 }",
            "time_s = 5.0\nafter_s = 1.0",
            "when = { robot = \"cop\", travelled = 1.0 }\nafter_s = -1.0",
            "when = 5.0",
        ],
        &expect![[r#"
            error: neither `time_s` nor `when` defines the time of the event
              --> small.toml:35:1 (events[0].time_s)
               |
            35 | [[events]]
               | ^^^^^^^^^^
               = expected: time_s = 10.0 (s), or when = { robot = "…", travelled = 1.5 } (m)
            error: an event with both `time_s` and `when`
              --> small.toml:37:8 (events[0].when)
               |
            37 | when = { robot = "cop", travelled = 1.0 }
               |        ^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^
               = expected: one of them
            error: `after_s` delays an event with `when`, not one with `time_s`
              --> small.toml:37:11 (events[0].after_s)
               |
            37 | after_s = 1.0
               |           ^^^
               = value: 1.0
               = expected: a later `time_s`
            error: `after_s` is out of range
              --> small.toml:37:11 (events[0].after_s)
               |
            37 | after_s = -1.0
               |           ^^^^
               = value: -1
               = expected: a number between 0 and 1000000000 (s)
            error: wrong type: a number
              --> small.toml:36:8 (events[0].when)
               |
            36 | when = 5.0
               |        ^^^
               = value: 5.0
               = expected: a table"#]],
    );
}

#[test]
fn a_condition_needs_an_existing_robot() {
    refused_when(
        &[
            "when = { travelled = 1.0 }",
            "when = { robot = \"copp\", travelled = 1.0 }",
        ],
        &expect![[r#"
            error: missing key `robot`
              --> small.toml:36:8 (events[0].when.robot)
               |
            36 | when = { travelled = 1.0 }
               |        ^^^^^^^^^^^^^^^^^^^
            error: no robot is called `copp`
              --> small.toml:36:18 (events[0].when.robot)
               |
            36 | when = { robot = "copp", travelled = 1.0 }
               |                  ^^^^^^
               = value: "copp"
               = expected: one of `cop`, `thief`
               = help: did you mean `cop`?"#]],
    );
}

#[test]
fn a_robot_has_one_condition() {
    refused_when(
        &[
            "when = { robot = \"cop\" }",
            "when = { robot = \"cop\", travelled = 1.0, within = 0.5, of = [0.0, 0.0] }",
            "when = { robot = \"cop\", within = 0.5 }",
            "when = { robot = \"cop\", of = [1.0, 0.0] }",
            "when = { robot = \"cop\", traveled = 1.0 }",
            "when = { robot = \"cop\", within = 0.5, of = [1.0] }",
        ],
        &expect![[r#"
            error: `when` has no condition
              --> small.toml:36:8 (events[0].when)
               |
            36 | when = { robot = "cop" }
               |        ^^^^^^^^^^^^^^^^^
               = expected: `travelled` (m), `progress` (0 to 1), or `within` (m) together with `of`
            error: `when` has two conditions, `travelled` and `within`
              --> small.toml:36:51 (events[0].when.within)
               |
            36 | when = { robot = "cop", travelled = 1.0, within = 0.5, of = [0.0, 0.0] }
               |                                                   ^^^
               = value: 0.5
               = expected: one of `travelled` (m), `progress` (0 to 1), or `within` (m) together with `of`
            error: missing key `of`
              --> small.toml:36:8 (events[0].when.of)
               |
            36 | when = { robot = "cop", within = 0.5 }
               |        ^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^
               = expected: of = [x, y], the point that the robot comes near (m)
            error: `of` is the point that a robot comes `within` a distance of
              --> small.toml:36:30 (events[0].when.of)
               |
            36 | when = { robot = "cop", of = [1.0, 0.0] }
               |                              ^^^^^^^^^^
               = value: [1.0, 0.0]
               = expected: within = 0.8 (m) beside it
            error: unknown key `traveled`
              --> small.toml:36:25 (events[0].when.traveled)
               |
            36 | when = { robot = "cop", traveled = 1.0 }
               |                         ^^^^^^^^
               = value: 1.0
               = expected: one of `robot`, `travelled`, `progress`, `within`, `of`
               = help: did you mean `travelled`?
            error: value not allowed
              --> small.toml:36:44 (events[0].when.of)
               |
            36 | when = { robot = "cop", within = 0.5, of = [1.0] }
               |                                            ^^^^^
               = value: [1.0]
               = expected: an array of 2 values"#]],
    );
}

#[test]
fn the_values_of_conditions_are_checked() {
    refused_when(
        &[
            "when = { robot = \"cop\", travelled = -1.5 }",
            "when = { robot = \"cop\", travelled = nan }",
            "when = { robot = \"cop\", within = 0.0, of = [0.0, 0.0] }",
            "when = { robot = \"cop\", within = 0.5, of = [0.0, 1e6] }",
            "when = { robot = \"cop\", within = 0.5, of = [5.0, 2.5] }",
        ],
        &expect![[r#"
            error: `when.travelled` is out of range
              --> small.toml:36:37 (events[0].when.travelled)
               |
            36 | when = { robot = "cop", travelled = -1.5 }
               |                                     ^^^^
               = value: -1.5
               = expected: a number between 0 and 100000 (m)
            error: value not allowed
              --> small.toml:36:37 (events[0].when.travelled)
               |
            36 | when = { robot = "cop", travelled = nan }
               |                                     ^^^
               = value: nan
               = expected: a finite number
            error: `when.within` is out of range
              --> small.toml:36:34 (events[0].when.within)
               |
            36 | when = { robot = "cop", within = 0.0, of = [0.0, 0.0] }
               |                                  ^^^
               = value: 0
               = expected: a number above 0 and at most 100000 (m)
            error: no place of the map is within 0.5 m of [0.0, 1000000.0]: it ends 999998.000 m from there
              --> small.toml:36:44 (events[0].when.of)
               |
            36 | when = { robot = "cop", within = 0.5, of = [0.0, 1e6] }
               |                                            ^^^^^^^^^^
               = value: [0.0, 1000000.0]
               = expected: a point in or near x = -4 to 4, y = -2 to 2 (m)

            error: `when.of[1]` is out of range
              --> small.toml:36:50 (events[0].when.of[1])
               |
            36 | when = { robot = "cop", within = 0.5, of = [0.0, 1e6] }
               |                                                  ^^^
               = value: 1000000
               = expected: a number within ±100000 (m)
            error: no place of the map is within 0.5 m of [5.0, 2.5]: it ends 1.118 m from there
              --> small.toml:36:44 (events[0].when.of)
               |
            36 | when = { robot = "cop", within = 0.5, of = [5.0, 2.5] }
               |                                            ^^^^^^^^^^
               = value: [5.0, 2.5]
               = expected: a point in or near x = -4 to 4, y = -2 to 2 (m)"#]],
    );
    let near = "when = { robot = \"cop\", within = 1.2, of = [5.0, 2.5] }";
    assert!(load(&changed("time_s = 5.0", near)).is_ok());
}

#[test]
fn progress_needs_a_goal_away_from_the_start() {
    let progress = "when = { robot = \"cop\", progress = 0.36 }";
    refused_when(
        &[progress],
        &expect![[r#"
        error: robot `cop` has no goal to make progress to
          --> small.toml:36:36 (events[0].when.progress)
           |
        36 | when = { robot = "cop", progress = 0.36 }
           |                                    ^^^^
           = value: 0.36
           = expected: a robot with a `goal`, or `travelled` or `within` instead"#]],
    );
    let with_goal = |center: &str, progress: &str| {
        let goal =
            format!("name = \"cop\"\ngoal = {{ circle = {{ center = {center}, radius = 0.3 }} }}");
        changed("time_s = 5.0", progress).replace("name = \"cop\"", &goal)
    };
    assert!(load(&with_goal("[3.0, 1.5]", progress)).is_ok());
    let texts = [
        with_goal("[-3.0, 0.0]", progress),
        with_goal("[3.0, 1.5]", &progress.replace("0.36", "36")),
    ];
    texts_refused(
        texts,
        &expect![[r#"
        error: robot `cop` starts at the centre of its goal
          --> small.toml:37:36 (events[0].when.progress)
           |
        37 | when = { robot = "cop", progress = 0.36 }
           |                                    ^^^^
           = value: 0.36
           = expected: a robot with a distance between its start and its goal
        error: `when.progress` is out of range
          --> small.toml:37:36 (events[0].when.progress)
           |
        37 | when = { robot = "cop", progress = 36 }
           |                                    ^^
           = value: 36
           = expected: a number between 0 and 1"#]],
    );
}

#[test]
fn an_ordered_event_must_fit_the_events_before_it() {
    refused_with(
        &[
            &gate(LATER, "disappear"),
            &gate(LATER, "move").replace("\"gate\"", "\"wal\""),
        ],
        &expect![[r#"
            error: no obstacle `gate` is present after the events before this one
              --> small.toml:47:12 (events[2].obstacle)
               |
            47 | obstacle = "gate"
               |            ^^^^^^
               = value: "gate"
               = expected: one of `wall`, `block`
               = help: the changes of an obstacle that has a `when` happen in the order of the file
            error: no obstacle `wal` is present after the events before this one
              --> small.toml:47:12 (events[2].obstacle)
               |
            47 | obstacle = "wal"
               |            ^^^^^
               = value: "wal"
               = expected: one of `wall`, `block`
               = help: did you mean `wall`?"#]],
    );
    let twice = gate(LATER, "appear").repeat(2);
    refused_with(
        &[&twice],
        &expect![[r#"
        error: obstacle `gate` appears after the events before this one, but it is present already
          --> small.toml:52:12 (events[3].obstacle)
           |
        52 | obstacle = "gate"
           |            ^^^^^^
           = value: "gate"
           = expected: the name of an obstacle that is not present at that time
           = help: the changes of an obstacle that has a `when` happen in the order of the file"#]],
    );
    // At a fixed time, but of an obstacle that waits: the order of the file holds.
    let behind = gate("time_s = 9.0", "disappear") + &gate(LATER, "appear");
    refused_with(
        &[&behind],
        &expect![[r#"
            error: no obstacle `gate` is present after the events before this one
              --> small.toml:47:12 (events[2].obstacle)
               |
            47 | obstacle = "gate"
               |            ^^^^^^
               = value: "gate"
               = expected: one of `wall`, `block`
               = help: the changes of an obstacle that has a `when` happen in the order of the file"#]],
    );
    let back = gate("time_s = 9.0", "appear")
        + &gate(LATER, "disappear")
        + &gate("time_s = 0.0", "appear");
    refused_with(
        &[&back],
        &expect![[r#"
        error: obstacle `gate` changes at 0 s, after a change at 9 s
          --> small.toml:54:10 (events[4].time_s)
           |
        54 | time_s = 0.0
           |          ^^^
           = value: 0.0
           = expected: a time of at least 9 (s)
           = help: the changes of an obstacle that has a `when` happen in the order of the file"#]],
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
    refused_with(
        &[&broken],
        &expect![[r#"
            error: no robot is called `absent`
              --> small.toml:45:18 (events[2].when.robot)
               |
            45 | when = { robot = "absent", travelled = 1.0 }
               |                  ^^^^^^^^
               = value: "absent"
               = expected: one of `cop`, `thief`"#]],
    );
}
