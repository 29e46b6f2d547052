//! Errors of files beside a scenario.

use geometry::map::MapSpec;

use super::*;

#[test]
fn files_are_found_only_in_the_folder_of_the_scenario() {
    let dir = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| std::fs::write(dir.path().join(name), text).unwrap();
    let with_map = |map: &str| {
        let start = GOOD.find("[world.map.vector]").unwrap();
        let end = GOOD.find("[defaults.robot]").unwrap();
        let text = format!("{}[world]\nmap = {map}\n{}", &GOOD[..start], &GOOD[end..]);
        let text = text[..text.find("[[events]]").unwrap()].to_owned();
        write("game.toml", &text);
        let target = dir.path().join("game.toml").display().to_string();
        Loader::new(KINDS).load(&target, &[], Some(3)).map_err(|e| {
            e.to_string()
                .replace(&dir.path().display().to_string(), "FOLDER")
        })
    };
    write("room.toml", "bounds = { min = [-4, -2], max = [4, 2] }\n");
    let s = with_map("\"room.toml\"").unwrap();
    assert!(matches!(s.world.map, MapSpec::Vector(_)));
    assert_eq!((s.name.as_str(), s.run.seed), ("game", 3));
    assert_eq!(load(&s.to_toml()).unwrap(), s, "no file is needed any more");

    write(
        "bad.toml",
        "bounds = { min = [-4, -2], max = [4, 2] }\n[[obstacles]]\nshape = { circle = { center = [0, 0], radus = 1 } }\n",
    );
    write("cut.toml", "bounds = { min = [-4, -2], max = [4,");
    let maps = [
        "bad.toml",
        "cut.toml",
        "none.toml",
        "maps/city.toml",
        "../room.toml",
        "/etc/passwd",
        "room.png",
    ];
    let errors = maps.map(|map| with_map(&format!("{map:?}")).unwrap_err());
    expect![[r#"
        error: unknown key `radus`
         --> bad.toml:3:39 (obstacles[0].shape.circle.radus)
          |
        3 | shape = { circle = { center = [0, 0], radus = 1 } }
          |                                       ^^^^^
          = value: 1
          = expected: one of `center`, `radius`
          = help: did you mean `radius`?
        error: not valid TOML: unclosed array
         --> cut.toml:1:37
          |
        1 | bounds = { min = [-4, -2], max = [4,
          |                                     ^
          = expected: `]`

        error: not valid TOML: unclosed inline table
         --> cut.toml:1:37
          |
        1 | bounds = { min = [-4, -2], max = [4,
          |                                     ^
          = expected: `}`
        error: FOLDER/none.toml: cannot be read: No such file or directory (os error 2)
         --> FOLDER/game.toml:9:7 (world.map)
          |
        9 | map = "none.toml"
          |       ^^^^^^^^^^^
          = value: "none.toml"
          = expected: a file
        error: FOLDER/maps/city.toml: cannot be read: No such file or directory (os error 2)
         --> FOLDER/game.toml:9:7 (world.map)
          |
        9 | map = "maps/city.toml"
          |       ^^^^^^^^^^^^^^^^
          = value: "maps/city.toml"
          = expected: a file
          = help: a map `city` is built in: map = "builtin:city" works from any folder
        error: path leads out of the scenario's folder
         --> FOLDER/game.toml:9:7 (world.map)
          |
        9 | map = "../room.toml"
          |       ^^^^^^^^^^^^^^
          = value: "../room.toml"
          = expected: a relative path without `..`
        error: path leads out of the scenario's folder
         --> FOLDER/game.toml:9:7 (world.map)
          |
        9 | map = "/etc/passwd"
          |       ^^^^^^^^^^^^^
          = value: "/etc/passwd"
          = expected: a relative path without `..`
        error: FOLDER/room.png: cannot be read: No such file or directory (os error 2)
         --> FOLDER/game.toml:9:7 (world.map)
          |
        9 | map = "room.png"
          |       ^^^^^^^^^^
          = value: "room.png"
          = expected: a file"#]]
    .assert_eq(&errors.join("\n"));

    write(
        "grid.yaml",
        "image: grid.pgm\nresolution: 0.5\norigin: [-4, -2, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n",
    );
    let mut pgm = b"P5 16 8 255\n".to_vec();
    pgm.extend([255; 16 * 8]);
    std::fs::write(dir.path().join("grid.pgm"), &pgm).unwrap();
    let s = with_map("\"grid.yaml\"").unwrap();
    assert!(matches!(s.world.map, MapSpec::Cells(_)));
    assert_eq!(load(&s.to_toml()).unwrap(), s, "the cells are written out");
    std::fs::write(dir.path().join("grid.pgm"), &pgm[..50]).unwrap();
    expect![[r#"
        error: map image FOLDER/grid.pgm: truncated: 38 pixels of 16 × 8 = 128 declared in the header
         --> FOLDER/game.toml:9:7 (world.map)
          |
        9 | map = "grid.yaml"
          |       ^^^^^^^^^^^
          = value: "grid.yaml"
          = expected: a ROS map"#]].assert_eq(&with_map("\"grid.yaml\"").unwrap_err());
    write("grid.pgm", "P5 100000 10000 255\n");
    expect![[r#"
        error: map image FOLDER/grid.pgm: header: 100000 × 10000 pixels: expected at most 25000000 pixels
         --> FOLDER/game.toml:9:7 (world.map)
          |
        9 | map = "grid.yaml"
          |       ^^^^^^^^^^^
          = value: "grid.yaml"
          = expected: a ROS map"#]].assert_eq(&with_map("\"grid.yaml\"").unwrap_err());
    write(
        "out.yaml",
        "image: ../../secret.pgm\nresolution: 0.5\norigin: [-4, -2, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n",
    );
    expect![[r#"
        error: image of out.yaml: path leads out of the scenario's folder
         --> FOLDER/game.toml:9:7 (world.map)
          |
        9 | map = "out.yaml"
          |       ^^^^^^^^^^
          = value: "out.yaml"
          = expected: a relative path without `..`"#]]
    .assert_eq(&with_map("\"out.yaml\"").unwrap_err());
}

#[test]
fn an_unknown_scenario_is_refused_with_the_known_names() {
    let load = |target: &str| Loader::new(&[]).load(target, &[], None);
    let errors = ["chse", "/tmp"].map(|target| load(target).unwrap_err().to_string());
    expect![[r#"
        error: chse: cannot be read: No such file or directory (os error 2)
          = value: chse
          = expected: the path of a scenario, or a built-in scenario: one of `chase`, `chase_exact`, `chase_paper`, `chase_layouts`, `chase_braitenberg`, `chase_rrt_star`, `chase_popup`, `chase_referee`, `chase_reach_avoid`, `popup`, `popup_city`, `single_lane` … (23 in all)
          = help: did you mean `chase`?
        error: /tmp: cannot be read: Is a directory (os error 21)
          = value: /tmp
          = expected: the path of a scenario, or a built-in scenario: one of `chase`, `chase_exact`, `chase_paper`, `chase_layouts`, `chase_braitenberg`, `chase_rrt_star`, `chase_popup`, `chase_referee`, `chase_reach_avoid`, `popup`, `popup_city`, `single_lane` … (23 in all)"#]].assert_eq(&errors.join("\n"));
}
