//! Errors of events, maps, logs and overrides.

use super::*;

#[test]
fn events_must_be_possible() {
    refused(
        &[
            ("time_s = 2.5", "time_s = -2.5"),
            ("obstacle = \"wall\"", "obstacle = \"wal\""),
            ("obstacle = \"block\"", "obstacle = \"wall\""),
            (
                "shape = { circle = { center = [1.0, -1.0], radius = 0.2 } }",
                "",
            ),
            ("radius = 0.2 } }", "radius = -0.2 } }"),
        ],
        &expect![[r#"
            error: `time_s` is out of range
              --> small.toml:40:10 (events[1].time_s)
               |
            40 | time_s = -2.5
               |          ^^^^
               = value: -2.5
               = expected: a number between 0 and 1000000000 (s)
            error: no obstacle `wal` is present at 5 s
              --> small.toml:38:12 (events[0].obstacle)
               |
            38 | obstacle = "wal"
               |            ^^^^^
               = value: "wal"
               = expected: one of `wall`, `block`
               = help: did you mean `wall`?
            error: obstacle `wall` appears at 2.5 s, but it is present already
              --> small.toml:42:12 (events[1].obstacle)
               |
            42 | obstacle = "wall"
               |            ^^^^^^
               = value: "wall"
               = expected: the name of an obstacle that is not present at that time
            error: missing key `shape`
              --> small.toml:39:1 (events[1].shape)
               |
            39 | [[events]]
               | ^^^^^^^^^^
               = expected: shape = { circle = { … } }, { rectangle = { … } } or { polygon = { … } }
            error: `shape.circle.radius` is out of range
              --> small.toml:43:53 (events[1].shape.circle.radius)
               |
            43 | shape = { circle = { center = [1.0, -1.0], radius = -0.2 } }
               |                                                     ^^^^
               = value: -0.2
               = expected: a number above 0 and at most 100000 (m)"#]],
    );
    let star: Vec<String> = (0..17).map(|i| format!("[{}.0, {}.0]", i, i * i)).collect();
    let polygon = format!(
        "shape = {{ polygon = {{ vertices = [{}] }} }}",
        star.join(", ")
    );
    refused(
        &[
            (
                "shape = { circle = { center = [1.0, -1.0], radius = 0.2 } }",
                &polygon,
            ),
            (
                "obstacle = \"wall\"",
                "obstacle = \"wall\"\nshape = { circle = { center = [1.0, -1.0], radius = 0.2 } }",
            ),
        ],
        &expect![[r#"
            error: too many vertices for an obstacle of an event
              --> small.toml:43:34 (events[1].shape.polygon.vertices)
               |
            43 | shape = { polygon = { vertices = [[0.0, 0.0], [1.0, 1.0], [2.0, 4.0], [3.0, 9.0], [4.0, 16.0], [5.0, 25.0], [6…
               |                                  ^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^
               = value: [[0.0, 0.0], [1.0, 1.0], [2.0, 4.0], [3.0, 9.0], [4.0, 16.0]…
               = expected: at most 16 vertices
            error: an obstacle that disappears has no shape
              --> small.toml:39:9 (events[0].shape)
               |
            39 | shape = { circle = { center = [1.0, -1.0], radius = 0.2 } }
               |         ^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^
               = expected: no `shape`"#]],
    );
}

#[test]
fn logs_and_ends_are_checked() {
    refused(
        &[("[run]", "[log]\ncompression = \"zip\"\n[run]")],
        &expect![[r#"
            error: `zip` is not one of the choices
             --> small.toml:3:15 (log.compression)
              |
            3 | compression = "zip"
              |               ^^^^^
              = value: "zip"
              = expected: one of `zstd`, `none`"#]],
    );
    let endless = changed("time_limit = 30.0", "")
        .replace("capture = { radius = 0.3 }", "")
        .replace(
            "exits = [{ circle = { center = [3.0, 0.0], radius = 0.3 } }]",
            "",
        );
    texts_refused(
        [endless],
        &expect![[r#"
        error: this run has no end condition
         --> small.toml:4:1 (rules.time_limit)
          |
        4 | [rules]
          | ^^^^^^^
          = expected: a time limit, a robot with a goal, or evaders that can escape or be caught
          = help: set rules.time_limit = 60.0 (s)"#]],
    );
}

#[test]
fn maps_are_checked_where_they_are_written() {
    refused(
        &[
            (
                "[world.map.vector]\nbounds = { min = [-4.0, -2.0], max = [4.0, 2.0] }",
                "[world.map.vector]\nbounds = { min = [-4.0, -2.0], max = [-5.0, 2.0] }",
            ),
            ("half_extents = [0.2, 1.0]", "half_extents = [0.2, -1.0]"),
            (
                "bounds = { min = [-4.0, -2.0], max = [4.0, 2.0] }",
                "bounds = { min = [0.0, 0.0], max = [1000000.0, 1000000.0] }",
            ),
            (
                "bounds = { min = [-4.0, -2.0], max = [4.0, 2.0] }",
                "bounds = { min = [-4.0, -2.0], max = [4.0, 2.0] }\nresolution = 0.0001",
            ),
            (
                "[world.map.vector]",
                "[world]\nresolution = 0.0001\n[world.map.vector]",
            ),
            (
                "[world.map.vector]",
                "[world]\nresolution = 0.0011\n[world.map.vector]\nmax_cells = 50000000",
            ),
        ],
        &expect![[r#"
            error: `bounds.max[0]` is out of range
             --> small.toml:9:39 (world.map.vector.bounds.max[0])
              |
            9 | bounds = { min = [-4.0, -2.0], max = [-5.0, 2.0] }
              |                                       ^^^^
              = value: -5
              = expected: more than bounds.min[0] = -4 (m)
            error: `obstacles[0].shape.rectangle.half_extents[1]` is out of range
              --> small.toml:12:67 (world.map.vector.obstacles[0].shape.rectangle.half_extents[1])
               |
            12 | shape = { rectangle = { center = [0.0, 0.5], half_extents = [0.2, -1.0] } }
               |                                                                   ^^^^
               = value: -1
               = expected: a number above 0 and at most 100000 (m)
            error: `bounds.max[0]` is out of range
             --> small.toml:9:37 (world.map.vector.bounds.max[0])
              |
            9 | bounds = { min = [0.0, 0.0], max = [1000000.0, 1000000.0] }
              |                                     ^^^^^^^^^
              = value: 1000000
              = expected: a number within ±100000 (m)
            error: `resolution` is out of range
              --> small.toml:10:14 (world.map.vector.resolution)
               |
            10 | resolution = 0.0001
               |              ^^^^^^
               = value: 0.0001
               = expected: cells large enough that the map has at most max_cells = 16000000 of them; it would have 80000 × 40000
            error: `resolution` is out of range
             --> small.toml:9:14 (world.resolution)
              |
            9 | resolution = 0.0001
              |              ^^^^^^
              = value: 0.0001
              = expected: cells large enough that the map has at most max_cells = 16000000 of them; it would have 80000 × 40000
            error: the map has too many cells
              --> small.toml:10:8 (world.map)
               |
            10 | [world.map.vector]
               |        ^^^
               = value: 7273 × 3637 cells
               = expected: at most 25000000 cells
               = help: set a coarser world.resolution"#]],
    );
    let without_map = |world: &str| {
        GOOD.replace("[world.map.vector]", world)
            .replace("[[world.map.vector.obstacles]]", "[[x.o]]")
    };
    let texts = [
        without_map("[world]\nmap = \"maps/x.toml\"\n[x]"),
        "title = \"x\"".to_owned(),
        without_map("[world]\n[x]"),
    ];
    texts_refused(
        texts,
        &expect![[r#"
            error: this scenario cannot refer to files
             --> small.toml:9:7 (world.map)
              |
            9 | map = "maps/x.toml"
              |       ^^^^^^^^^^^^^
              = value: "maps/x.toml"
              = expected: a map written in the scenario itself

            error: unknown key `x`
              --> small.toml:10:2 (x)
               |
            10 | [x]
               |  ^
               = value: { bounds = { min = [-4.0, -2.0], max = [4.0, 2.0] }, o = [{ …
               = expected: one of `name`, `title`, `description`, `run`, `world`, `rules`, `defaults`, `teams`, `robots`, `processes`, `events`, `links` … (14 in all)
            error: missing table `[world]`
             --> small.toml:1:1 (world)
              |
            1 | title = "x"
              | ^
              = expected: [world] with map = "path/of/a/map.toml"

            error: the scenario has no robots
             --> small.toml:1:1 (robots)
              |
            1 | title = "x"
              | ^
              = expected: at least one [[robots]] block
            error: missing key `map`
             --> small.toml:8:1 (world.map)
              |
            8 | [world]
              | ^^^^^^^
              = expected: map = "path/of/a/map.toml", or [world.map.vector]

            error: unknown key `x`
             --> small.toml:9:2 (x)
              |
            9 | [x]
              |  ^
              = value: { bounds = { min = [-4.0, -2.0], max = [4.0, 2.0] }, o = [{ …
              = expected: one of `name`, `title`, `description`, `run`, `world`, `rules`, `defaults`, `teams`, `robots`, `processes`, `events`, `links` … (14 in all)"#]],
    );
}

#[test]
fn an_error_in_an_override_says_so() {
    let errors = [
        "run.seed=five",
        "run.sead=5",
        "robots.cop.limits.v_max=-1",
        "robots.bob.radius=1",
        "processes.perception.params.particles=many",
        "run.seed=9999999999999999999",
    ]
    .map(|change| load_with(GOOD, &[change]).unwrap_err());
    expect![[r#"
        error: wrong type: text
         --> --set (run.seed)
          |
        1 | run.seed=five
          |          ^^^^
          = value: "five"
          = expected: a whole number, 0 or more
        error: unknown key `sead`
         --> --set (run.sead)
          |
        1 | run.sead=5
          |     ^^^^
          = value: 5
          = expected: one of `dt`, `seed`, `mode`, `real_time_factor`, `pin`, `hang_timeout_s`, `ready_timeout_s`, `command_deadline_s`
          = help: did you mean `seed`?
        error: `limits.v_max` is out of range
         --> --set (robots.cop.limits.v_max)
          |
        1 | robots.cop.limits.v_max=-1
          |                         ^^
          = value: -1
          = expected: a number above 0 and at most 100000 (m/s)
        error: `robots` has no element `bob`
         --> --set (robots.bob)
          |
        1 | robots.bob.radius=1
          |        ^^^
          = expected: one of `cop`, `thief`, or an index from 0 to 1
        error: wrong type: text
         --> --set (processes.perception.params.particles)
          |
        1 | processes.perception.params.particles=many
          |                                       ^^^^
          = value: "many"
          = expected: a whole number, 0 or more
        error: whole number out of range
         --> --set
          |
        1 | run.seed=9999999999999999999
          |          ^^^^^^^^^^^^^^^^^^^
          = value: 9999999999999999999
          = expected: -9223372036854775808 to 9223372036854775807"#]].assert_eq(&errors.join("\n"));
}
