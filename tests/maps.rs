//! Maps and scenarios from other programs' files, checked, drawn and run.

use std::fs;

use crate::support::Sandbox;

/// A PNG image of 8 × 6 gray pixels: free, with two unknown columns on the right.
fn png() -> Vec<u8> {
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, 8, 6);
    encoder.set_color(png::ColorType::Grayscale);
    let pixels: Vec<u8> = (0..48).map(|i| if i % 8 < 6 { 254 } else { 205 }).collect();
    let mut writer = encoder.write_header().unwrap();
    writer.write_image_data(&pixels).unwrap();
    writer.finish().unwrap();
    file
}

const YAML: &str = "image: room.png\nmode: trinary\nresolution: 0.5\norigin: [0, 0, 0]\nnegate: 0\n\
                    occupied_thresh: 0.65\nfree_thresh: 0.196\n";
const ROOM: &str = r#"
[world]
map = { file = { path = "room.yaml" } }
[rules]
time_limit = 2.0
exits = [{ circle = { center = [0.5, 2.5], radius = 0.2 } }]
[[robots]]
name = "thief"
team = "evader"
start = { x = 2.0, y = 1.5, theta = 0.0 }
[[processes]]
kind = "evader_potential"
team = "evader"
"#;

#[test]
fn a_png_map_of_map_server_runs_and_a_start_on_an_unknown_cell_is_named() {
    let sandbox = Sandbox::new();
    sandbox.file("room.png", png());
    sandbox.file("room.yaml", YAML);
    sandbox.file("a.toml", ROOM);
    let words = ["run", "a.toml", "--in-process", "--out", "a.mcap"];
    let summary = sandbox.protean(words).json();
    assert_eq!(summary["robots"][0]["name"], "thief");

    let unknown = ROOM.replace("x = 2.0", "x = 3.25");
    sandbox.file("b.toml", &unknown);
    sandbox.protean(["check", "b.toml"]).run().refused(
        2,
        &[
            "robot `thief` starts on a cell that the map marks unknown",
            "b.toml:10",
            "unknown = \"free\"",
        ],
    );
    let free = unknown.replace("room.yaml\"", "room.yaml\", unknown = \"free\"");
    sandbox.file("b.toml", free);
    let checked = sandbox.protean(["check", "b.toml"]).run();
    assert_eq!(checked.code, Some(0), "{checked}");
}

#[test]
fn a_map_of_the_current_folder_takes_the_place_of_a_built_in_one() {
    let sandbox = Sandbox::new();
    sandbox.file("room.png", png());
    sandbox.file("room.yaml", YAML);
    let hello = |map: &str| {
        let map = format!("world.map={map}");
        let words = ["run", "hello", "--in-process", "--out", "a.mcap", "--force"];
        let exits = "rules.exits=[{circle={center=[2.5,2.5],radius=0.2}}]";
        sandbox.protean(words).set(&map).set(exits).run()
    };
    let ran = hello("room.yaml");
    assert_eq!(ran.code, Some(0), "{ran}");
    hello("../room.yaml").refused(2, &["path leads out of", "without `..`"]);
    hello("none.yaml").refused(2, &["./none.yaml: cannot be read"]);
}

#[test]
fn a_check_draws_the_world_and_keeps_an_existing_picture() {
    let sandbox = Sandbox::new();
    let words = ["check", "chase_layouts", "--picture", "world.svg"];
    let checked = sandbox.protean(words).set("teams.police.count=8").run();
    assert_eq!(checked.code, Some(0), "{checked}");
    let picture = fs::read_to_string(sandbox.path().join("world.svg")).unwrap();
    for part in ["<svg", "police_8", "evader_2", "before it runs"] {
        assert!(picture.contains(part), "{part}");
    }
    let again = sandbox.protean(words).run();
    again.refused(2, &["world.svg", "--force"]);
    let forced = sandbox.protean(words).arg("--force").run();
    assert_eq!(forced.code, Some(0), "{forced}");
}

#[test]
fn files_that_are_no_maps_are_refused_before_the_package_is_asked() {
    let sandbox = Sandbox::new();
    for (from, words) in [
        ("room.PNG", ["room.PNG", "an image without its scale"]),
        (
            "room.txt",
            [
                "room.txt",
                "unknown kind of file: expected .yaml, .yml, .map",
            ],
        ),
    ] {
        let refused = sandbox.protean(["new", "x.toml", "--from", from]).run();
        refused.refused(2, &words);
    }
}

const KNOWN: &str = "image: room.png\nresolution: 0.5\norigin: [0, 0, 0]\noccupied_thresh: 0.65\nfree_thresh: 0.196\n";

#[test]
fn keys_that_a_map_does_not_have_are_named_by_check_and_run() {
    let sandbox = Sandbox::new();
    sandbox.file("room.png", png());
    sandbox.file("room.yaml", format!("{KNOWN}map_type: occupancy\n"));
    sandbox.file("a.toml", ROOM);
    let remark = "map room.yaml: keys without effect: `map_type` (line 6)";
    let checked = sandbox.protean(["check", "a.toml"]).run();
    assert_eq!(checked.code, Some(0), "{checked}");
    assert!(checked.stdout.contains(remark), "{checked}");
    let words = ["run", "a.toml", "--in-process", "--out", "a.mcap"];
    let ran = sandbox.protean(words).run();
    assert!(ran.code == Some(0) && ran.stderr.contains(remark), "{ran}");
    for (start, format) in [(&b"\xff\xd8\xff\xe0"[..], "JPEG"), (b"BM\0\0", "BMP")] {
        sandbox.file("room.png", start);
        let refused = sandbox.protean(["check", "a.toml"]).run();
        refused.refused(2, &["room.png", format, "convert FILE map.png"]);
    }
}

/// Every format of text that users write: with a byte order mark, it is read as without one.
#[test]
fn a_byte_order_mark_has_no_effect_in_any_format() {
    let experiment = "scenario = \"vectors.toml\"\nseeds = { first = 1, count = 1 }\n\
                      parameters.limit.set = \"rules.time_limit\"\ngrid.limit = [0.5]\n[[figures]]\nname = \"limits\"\n\
                      x = \"limit\"\ncompare = \"points.csv\"\n";
    let instance = r#"[{"id": "one", "cm_per_px": 0.75, "vmax_px_s": 20, "wmax_rad_s": 16, "buffer_px": 10,
        "bounds_px": [0, 0, 640, 480], "start": {"x": 10, "y": 10, "theta": 0.7}, "start_speed": null,
        "goal": {"x": 630, "y": 470}, "obstacles": []}]"#;
    let vectors = ROOM.replace("{ file = { path = \"room.yaml\" } }", "\"room.toml\"");
    let files = [
        ("room.yaml", KNOWN),
        ("room.toml", "bounds = { min = [0, 0], max = [4, 3] }\n"),
        ("a.toml", ROOM),
        ("vectors.toml", &vectors),
        ("experiment.toml", experiment),
        ("points.csv", "series,x,y\npaper,0.5,0\n"),
        ("instances.json", instance),
    ];
    let answers = |mark: &str| {
        let sandbox = Sandbox::new();
        sandbox.file("room.png", png());
        for (name, text) in files {
            sandbox.file(name, format!("{mark}{text}"));
        }
        let calls: [&[&str]; 4] = [
            &["check", "a.toml"],
            &["check", "vectors.toml"],
            &[
                "sweep",
                "experiment.toml",
                "--out",
                "out",
                "--in-process",
                "--jobs",
                "1",
                "--quiet",
            ],
            &["plan", "instances.json", "--quiet"],
        ];
        for call in calls {
            let outcome = sandbox.protean(call.iter().copied()).run();
            assert_eq!(outcome.code, Some(0), "{mark:?} {call:?}: {outcome}");
        }
        fs::read_to_string(sandbox.path().join("out/results.csv")).unwrap()
    };
    assert_eq!(answers("\u{feff}"), answers(""));
}
