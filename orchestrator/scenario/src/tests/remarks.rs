//! Remarks about values that are accepted and probably wrong.

use super::*;

fn warnings(text: &str) -> Vec<String> {
    let remarks = load(text).unwrap().remarks();
    assert!(remarks.iter().all(super::super::ScenarioRemark::is_warning));
    remarks.iter().map(ToString::to_string).collect()
}

#[test]
fn values_that_look_like_degrees_have_one_warning_per_key() {
    assert_eq!(warnings(GOOD), [""; 0]);
    let text = changed(
        "limits = { v_max = 0.2 }",
        "limits = { v_max = 0.2, omega_max = 180, angular_acceleration = 90 }",
    );
    let text = text.replace("limits = { omega_max = 1.5 }", "");
    let text = text.replace(
        "half_extents = [0.2, 1.0] }",
        "half_extents = [0.2, 1.0], angle = 45.0 }",
    );
    let text = text.replace(
        "circle = { center = [1.0, -1.0], radius = 0.2 } }",
        "rectangle = { center = [1.0, -1.0], half_extents = [0.1, 0.1], angle = -45 } }",
    );
    assert_eq!(
        warnings(&text),
        [
            "warning: world.map: `obstacles[0].shape.rectangle.angle` is 45 rad, usually at most 2π; 45° are 0.785 rad",
            "warning: cop: `limits.omega_max` is 180 rad/s, usually at most 20; 180° are 3.142 rad (1 more like it)",
            "warning: cop: `limits.angular_acceleration` is 90 rad/s², usually at most 60; 90° are 1.571 rad (1 more like it)",
            "warning: block: `rectangle.angle` is -45 rad, usually at most 2π; -45° are -0.785 rad",
        ]
    );
}

#[test]
fn robots_that_drive_farther_than_their_radius_in_a_tick_have_one_warning() {
    for (v_max, warns) in [("2.1", false), ("2.2", true), ("200", true)] {
        let found = warnings(&changed("v_max = 0.2", &format!("v_max = {v_max}")));
        assert_eq!(found.len(), usize::from(warns), "{found:?}");
    }
    assert_eq!(
        warnings(&changed("v_max = 0.2", "v_max = 200")),
        [
            "warning: cop: it may drive 10.000 m in a tick, farther than its radius of 0.105 m (1 more like it)"
        ]
    );
    let backwards = warnings(&changed("v_max = 0.2", "v_reverse_max = 200"));
    assert_eq!(backwards.len(), 1, "{backwards:?}");
}

#[test]
fn a_heading_in_degrees_is_refused() {
    let start = |theta: &str| {
        changed(
            "y = 0.0, theta = 0.0 }\n[[robots]]",
            &format!("y = 0.0, theta = {theta} }}\n[[robots]]"),
        )
    };
    texts_refused(
        ["180", "-3.141592653589793", "3.1416"].map(start),
        &expect![[r#"
            error: `start.theta` is out of range
              --> small.toml:20:38 (robots.cop.start.theta)
               |
            20 | start = { x = -3.0, y = 0.0, theta = 180 }
               |                                      ^^^
               = value: 180
               = expected: a number above -π and at most π (rad)
            error: `start.theta` is out of range
              --> small.toml:20:38 (robots.cop.start.theta)
               |
            20 | start = { x = -3.0, y = 0.0, theta = -3.141592653589793 }
               |                                      ^^^^^^^^^^^^^^^^^^
               = value: -3.141592653589793
               = expected: a number above -π and at most π (rad)
            error: `start.theta` is out of range
              --> small.toml:20:38 (robots.cop.start.theta)
               |
            20 | start = { x = -3.0, y = 0.0, theta = 3.1416 }
               |                                      ^^^^^^
               = value: 3.1416
               = expected: a number above -π and at most π (rad)"#]],
    );
    assert_eq!(warnings(&start("3.141592653589793")), [""; 0]);
}

#[test]
fn keys_that_a_map_does_not_have_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &[u8]| std::fs::write(folder.path().join(name), text).unwrap();
    let mut image = b"P5 16 8 255\n".to_vec();
    image.extend([255; 16 * 8]);
    write("room.pgm", &image);
    let known = "image: room.pgm\nresolution: 0.5\norigin: [-4, -2, 0]\noccupied_thresh: 0.65\nfree_thresh: 0.196\n";
    let text = changed(
        "[world.map.vector]\nbounds = { min = [-4.0, -2.0], max = [4.0, 2.0] }\n[[world.map.vector.obstacles]]\nname = \"wall\"\nshape = { rectangle = { center = [0.0, 0.5], half_extents = [0.2, 1.0] } }",
        "[world]\nmap = \"room.yaml\"",
    );
    let text = text.replace(
        "[[events]]\ntime_s = 5.0\naction = \"disappear\"\nobstacle = \"wall\"\n",
        "",
    );
    let base = Base::Folder {
        folder: folder.path().to_owned(),
        allow_outside: false,
    };
    let remarks = |keys: &str| {
        write("room.yaml", format!("{known}{keys}").as_bytes());
        let loader = Loader::new(KINDS);
        let loaded = loader.load_text("small.toml", &text, &base, &[], None);
        let remarks = loaded.unwrap().remarks();
        remarks.iter().map(ToString::to_string).collect::<Vec<_>>()
    };
    assert_eq!(remarks("negate: 0\n"), [""; 0]);
    assert_eq!(
        remarks("map_type: occupancy\nNegate: 1\n"),
        [
            "warning: map room.yaml: keys without effect: `map_type` (line 6), `Negate` (line 7, not `negate`)"
        ]
    );
    let many = (0..9).fold(String::new(), |keys, i| format!("{keys}k{i}: {i}\n"));
    let many = remarks(&many);
    assert!(
        many.len() == 1 && many[0].ends_with("`k4` (line 10) and 4 more"),
        "{many:?}"
    );
}
