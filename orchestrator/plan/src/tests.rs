mod hard;

use std::sync::atomic::AtomicBool;

use expect_test::expect;
use proptest::prelude::*;
use serde_json::{Value as Json, json};
use trajectory::obstacle_field::ObstacleField;

use super::file::{FileProblem, parse};
use super::generate::{NAMES, reference, with_reference};
use super::*;

fn good() -> Json {
    json!({
        "id": "a", "cm_per_px": 0.75, "vmax_px_s": 20.0, "wmax_rad_s": 16.0, "buffer_px": 10,
        "bounds_px": [0, 0, 640, 480], "start": { "x": 10, "y": 10, "theta": 0.7 },
        "start_speed": null, "goal": { "x": 600.5, "y": 400 },
        "obstacles": [{ "x": 300, "y": 200, "r": 30 }],
        "reference": { "t_lb_s": 1.0 }, "row": "base", "results": [[[]]],
    })
}

fn read_one(json: &Json) -> Result<Instance, FieldError> {
    let text = serde_json::to_vec(&[json]).unwrap();
    parse(&text).unwrap().remove(0).instance
}

/// Returns the instance with a changed field; `path` is a JSON pointer.
fn changed(path: &str, value: Json) -> Json {
    let mut json = good();
    let (parent, key) = path.rsplit_once('/').unwrap();
    let parent = json.pointer_mut(parent).unwrap();
    match parent {
        Json::Object(map) => {
            map.insert(key.to_owned(), value);
        }
        Json::Array(list) => list[key.parse::<usize>().unwrap()] = value,
        _ => panic!("{path}"),
    }
    json
}

#[test]
fn an_instance_is_read_in_its_units_and_converted_to_metres() {
    let instance = read_one(&good()).unwrap();
    assert_eq!(instance.goal, [600.5, 400.0]);
    assert_eq!(instance.start_speed, None);
    let problem = instance.problem();
    assert!((problem.limits.v_max - 0.15).abs() < 1e-15);
    assert!((problem.goal.x - 4.50375).abs() < 1e-12);
    assert_eq!(instance.contract().clearance, 0.075);
    // Reading a written instance gives the same instance.
    assert_eq!(read_one(&instance.to_json()).unwrap(), instance);
}

#[test]
fn every_optional_field_is_read() {
    let mut json = good();
    for (key, value) in [
        ("v_min", -4.0),
        ("start_speed", 5.0),
        ("start_turn_rate", -0.1),
        ("goal_speed", 3.0),
        ("wheel_speed_px_s", 25.0),
        ("wheel_separation_px", 12.0),
        ("acceleration_px_s2", 40.0),
        ("angular_acceleration_rad_s2", 30.0),
    ] {
        json[key] = json!(value);
    }
    json["goal"]["theta"] = json!(1.5);
    // Clockwise, and reversed.
    json["obstacles"] = json!([{ "polygon": [[100, 100], [100, 150], [150, 100]] }]);
    let instance = read_one(&json).unwrap();
    assert_eq!(
        instance.limits.wheels,
        Some(trajectory_problem::Wheels {
            speed: 25.0,
            separation: 12.0
        })
    );
    assert_eq!(instance.goal_heading, Some(1.5));
    assert_eq!(
        instance.obstacles,
        [Body::Polygon(vec![
            [150.0, 100.0],
            [100.0, 150.0],
            [100.0, 100.0]
        ])]
    );
    assert_eq!(read_one(&instance.to_json()).unwrap(), instance);
}

#[test]
fn what_is_wrong_is_named_with_field_value_and_expectation() {
    let many: Vec<Json> = vec![json!({ "x": 1, "y": 2, "r": 3 }); 5000];
    let changes = [
        ("/cm_per_px", json!(0)),
        ("/cm_per_px", json!(1e300)),
        ("/vmax_px_s", json!("fast")),
        ("/wmax_rad_s", json!(null)),
        ("/buffer_px", json!(-1)),
        ("/bounds_px", json!([0, 0, 1])),
        ("/bounds_px", json!([5, 0, 1, 1])),
        ("/bounds_px/2", json!(true)),
        ("/start", json!(3)),
        ("/start/theta", json!([])),
        ("/v_min", json!(5)),
        ("/v_min", json!(-21)),
        ("/start_speed", json!(21)),
        ("/goal/x", json!("é")),
        ("/goal/theta", json!({})),
        ("/wheel_speed_px_s", json!(5)),
        ("/wheel_separation_px", json!(5)),
        ("/acceleration_px_s2", json!(0)),
        ("/obstacles", json!(null)),
        ("/obstacles", json!(many)),
        ("/obstacles/0", json!([1, 2, 3])),
        ("/obstacles/0/r", json!(-2)),
        ("/obstacles/0", json!({ "x": 1, "r": 2 })),
        ("/obstacles/0", json!({ "polygon": [[0, 0], [1, 1]] })),
        (
            "/obstacles/0",
            json!({ "polygon": [[0, 0], [1, 1], [2, 2]] }),
        ),
        (
            "/obstacles/0",
            json!({ "polygon": [[0, 0], [9, 0], [1, 1], [0, 9]] }),
        ),
        (
            "/obstacles/0",
            json!({ "polygon": [[0, 5], [5, 5], [1, 2], [2.5, 7], [4, 2]] }),
        ),
        ("/obstacles/0", json!({ "polygon": [[0, 0], [1, 0], 7] })),
    ];
    let errors =
        changes.map(|(path, value)| read_one(&changed(path, value)).unwrap_err().to_string());
    expect![[r#"
        cm_per_px = 0: expected a number > 0 (cm/px)
        cm_per_px = 1e300: expected a number > 0 (cm/px) of at most 1e6 in size
        vmax_px_s = "fast": expected a number > 0 (px/s)
        wmax_rad_s = nothing: expected a number > 0 (rad/s)
        buffer_px = -1: expected a number ≥ 0 (px)
        bounds_px = a list of 3: expected [x, y, x, y] (px) of the lower and the upper corner
        bounds_px = [5.0, 0.0, 1.0, 1.0]: expected [x, y, x, y] (px) of the lower and the upper corner
        bounds_px[2] = true: expected a number (px)
        start.x = nothing: expected a number (px)
        start.theta = a list of 0: expected a number (rad)
        v_min = 5: expected a number ≤ 0 (px/s)
        v_min = -21: expected a number from -20 to 0 (px, s, rad)
        start_speed = 21: expected from -20 to 20 by the limits (px, s, rad)
        goal.x = "é": expected a number (px)
        goal.theta = an object with "": expected a number (rad)
        wheel_separation_px = nothing: expected a number > 0 (px) beside wheel_speed_px_s
        wheel_speed_px_s = nothing: expected a number > 0 (px/s) beside wheel_separation_px
        acceleration_px_s2 = 0: expected a number > 0 (px/s²)
        obstacles = nothing: expected a list, empty if none
        obstacles = a list of 5000: expected at most 4096 obstacles
        obstacles[0] = a list of 3: expected {"x", "y", "r"} or {"polygon": [[x, y], …]}
        obstacles[0].r = -2: expected a number ≥ 0 (px)
        obstacles[0].y = nothing: expected a number (px)
        obstacles[0].polygon = a list of 2: expected a list of 3 to 1024 corners [x, y] (px)
        obstacles[0].polygon = a list of 3: expected the corners of a convex polygon with an area > 0, in order
        obstacles[0].polygon = a list of 4: expected the corners of a convex polygon with an area > 0, in order
        obstacles[0].polygon = a list of 5: expected the corners of a convex polygon with an area > 0, in order
        obstacles[0].polygon[2] = 7: expected a corner [x, y] (px)"#]].assert_eq(&errors.join("\n"));
}

#[test]
fn files_without_instances_are_refused_as_a_whole() {
    let deep = "[".repeat(100_000);
    let texts = [
        "",
        "[",
        &deep,
        "{}",
        "[]",
        r#"[{"id": "a", "start": 1e999}]"#,
        r#"[{"id": "a", "id": "b"}]"#,
        "[NaN]",
    ];
    let errors = texts.map(|text| parse(text.as_bytes()).unwrap_err().to_string());
    expect![[r#"
        not JSON: EOF while parsing a value at line 1 column 0: expected an array of instances
        not JSON: EOF while parsing a list at line 1 column 1: expected an array of instances
        not JSON: recursion limit exceeded at line 1 column 128: expected an array of instances
        an object with "": expected an array of at least one instance
        an empty array: expected an array of at least one instance
        not JSON: number out of range at line 1 column 27: expected an array of instances
        not JSON: `id` occurs twice at line 1 column 17: expected an array of instances
        not JSON: expected value at line 1 column 2: expected an array of instances"#]]
    .assert_eq(&errors.join("\n"));
    let large = vec![b' '; super::file::MAX_FILE as usize + 1];
    assert!(matches!(parse(&large), Err(FileProblem::TooLarge)));
    assert!(parse(&[0xff, 0xfe, b'[']).is_err());
}

#[test]
fn an_element_without_a_valid_id_leaves_the_others_usable() {
    let mut nameless = good();
    nameless["id"] = json!("");
    let list = json!([good(), nameless, good(), 3, {}]);
    let elements = parse(&serde_json::to_vec(&list).unwrap()).unwrap();
    let ids: Vec<&str> = elements.iter().map(|e| e.id.as_str()).collect();
    assert_eq!(
        ids,
        ["a", "element 1", "element 2", "element 3", "element 4"]
    );
    assert!(elements[0].instance.is_ok());
    let errors = elements[1..]
        .iter()
        .map(|element| element.instance.as_ref().unwrap_err().to_string());
    expect![[r#"
        id = "": expected a text of 1 to 200 characters
        id = "a": expected an id of its own: element 0 has it
        element 3 = 3: expected an instance, an object
        id = nothing: expected a text of 1 to 200 characters"#]]
    .assert_eq(&errors.collect::<Vec<_>>().join("\n"));
}

#[test]
fn many_numbers_instead_of_instances_take_no_memory_for_errors() {
    let list = |invalid: usize| {
        let mut list = vec![good()];
        list.extend((0..invalid).map(|number| json!(number)));
        parse(&serde_json::to_vec(&list).unwrap())
    };
    let most = super::file::MAX_INVALID;
    assert_eq!(list(most).unwrap().len(), most + 1);
    let error = list(most + 1).unwrap_err().to_string();
    assert!(
        error.starts_with("more than 1000 invalid instances, the first: element 1 = 0:"),
        "{error}"
    );
    // The rest of the file is read, but it must be JSON.
    let broken = format!("[{}1", "1,".repeat(most + 1));
    assert!(matches!(
        parse(broken.as_bytes()),
        Err(FileProblem::Json(_))
    ));
}

#[test]
fn a_byte_order_mark_is_skipped() {
    let mut bytes = b"\xef\xbb\xbf".to_vec();
    bytes.extend(serde_json::to_vec(&[good()]).unwrap());
    assert!(parse(&bytes).unwrap()[0].instance.is_ok());
}

#[test]
fn a_plan_does_not_depend_on_the_scale_of_the_board() {
    let go = AtomicBool::new(false);
    // A board of 0.64 mm, the usual one, and one of 640 km.
    let answers = [1e-4, 0.75, 1e5].map(|cm_per_px| {
        let instance = read_one(&changed("/cm_per_px", json!(cm_per_px))).unwrap();
        solve(&instance, &Options::default(), 1, &go).unwrap()
    });
    for answer in &answers {
        let (t, bound) = (answer.t_s.unwrap(), answer.lower_bound_s.unwrap());
        assert_eq!(answer.honest, Some(true), "{answer:?}");
        assert!(bound <= t, "{bound} {t}");
        assert!((t - answers[1].t_s.unwrap()).abs() < 1e-2, "{t}");
    }
    // A board whose pixels are a thousand times as many.
    let scaled = |v: &Json| json!(v.as_f64().unwrap() * 1000.0);
    let mut json = good();
    for pointer in [
        "/vmax_px_s",
        "/buffer_px",
        "/start/x",
        "/start/y",
        "/goal/x",
        "/goal/y",
    ]
    .into_iter()
    .chain(["/obstacles/0/x", "/obstacles/0/y", "/obstacles/0/r"])
    .chain(["/bounds_px/2", "/bounds_px/3"])
    {
        let value = json.pointer_mut(pointer).unwrap();
        *value = scaled(value);
    }
    let answer = solve(&read_one(&json).unwrap(), &Options::default(), 1, &go).unwrap();
    assert!(
        (answer.t_s.unwrap() - answers[1].t_s.unwrap()).abs() < 1e-2,
        "{answer:?}"
    );
}

/// Grown, they overlap: their border has more arcs than there are discs.
#[test]
fn as_many_discs_as_are_permitted_have_a_shortest_path() {
    let discs: Vec<Json> = (0..4096)
        .map(|i| json!({ "x": 30 + 7919 * i % 560, "y": 30 + 10_473 * i % 419, "r": 1.5 }))
        .collect();
    let mut json = changed("/obstacles", json!(discs));
    json["buffer_px"] = json!(3);
    let problem = read_one(&json).unwrap().problem();
    let field = ObstacleField::new(&problem).unwrap().exact().unwrap();
    let path = field.shortest(problem.start.position(), problem.goal);
    assert!(path.unwrap().length > 5.0);
}

/// A million obstacles are counted but not stored.
#[test]
fn a_million_obstacles_are_refused_with_the_limit() {
    let mut text = serde_json::to_string(&[changed("/obstacles", json!([]))]).unwrap();
    let at = text.find("\"obstacles\":[").unwrap() + "\"obstacles\":[".len();
    let discs = vec![r#"{"x":1,"y":2,"r":3}"#; 1_000_000].join(",");
    text.insert_str(at, &discs);
    let error = parse(text.as_bytes()).unwrap().remove(0).instance;
    let error = error.unwrap_err().to_string();
    assert!(
        error.contains("a list of 1000000") && error.contains("at most 4096"),
        "{error}"
    );
}

#[test]
fn the_same_seed_gives_the_same_instance_within_its_ranges() {
    for name in NAMES {
        let recipe = Recipe::by_name(name).unwrap();
        parameters::check(&recipe).unwrap();
        for seed in 1..=20 {
            let instance = recipe.instance("i".into(), seed);
            assert_eq!(instance, recipe.instance("i".into(), seed));
            assert_ne!(instance, recipe.instance("i".into(), seed + 1));
            let count = instance.obstacles.len() as u32;
            let more = if name == "t4b" { 2 } else { 0 };
            assert!(count <= recipe.obstacles[1] + more, "{name}: {count}");
            for body in &instance.obstacles {
                let Body::Disc { r, .. } = body else {
                    panic!("{body:?}")
                };
                assert!((recipe.radius[0]..=recipe.radius[1]).contains(r));
            }
            // Reading it back gives the same: every instance is valid.
            assert_eq!(read_one(&with_reference(&instance)).unwrap(), instance);
        }
    }
    let [angle, base] = ["ang0_90", "base"].map(|n| Recipe::by_name(n).unwrap());
    let [a, b] = [angle, base].map(|r| r.instance("i".into(), 7));
    assert_eq!(a.obstacles, b.obstacles, "only the heading differs");
}

#[test]
fn a_pop_up_obstacle_blocks_the_first_path() {
    let (known, later) = (
        Recipe::by_name("t4a").unwrap(),
        Recipe::by_name("t4b").unwrap(),
    );
    let mut longer = 0;
    for seed in 1..=20 {
        let before = known.instance("i".into(), seed);
        let after = later.instance("i".into(), seed);
        assert_eq!(after.goal, before.goal);
        assert_eq!(after.obstacles[..3], before.obstacles[..]);
        let [whole, rest] = [before, after].map(|i| reference(&i).unwrap().path.length);
        assert!(rest >= 0.64 * whole - 1e-9, "seed {seed}");
        longer += usize::from(rest > 0.64 * whole + 1e-6);
    }
    assert!(longer >= 15, "{longer} of 20");
}

#[test]
fn a_plan_is_checked_against_the_instance_as_given() {
    let instance = read_one(&good()).unwrap();
    let go = AtomicBool::new(false);
    for name in ["bspline", "lp", "vmc", "tangent"] {
        let options = Options {
            method: trajectory::Method::by_name(name).unwrap(),
            ..Options::default()
        };
        let answer = solve(&instance, &options, 1, &go).unwrap();
        assert_eq!(answer.honest, Some(true), "{name}: {answer:?}");
        let (t, bound) = (answer.t_s.unwrap(), answer.lower_bound_s.unwrap());
        assert!(t >= bound * (1.0 - 1e-9) && t < bound * 1.01, "{name}");
        let samples = answer.samples.as_ref().unwrap();
        let last = samples.last().unwrap();
        assert!((last.x - 600.5).abs() < 1e-3 && (last.t - t).abs() < 1e-9);
        assert!(answer.cpu_ms.unwrap() > 0.0);
    }
    let stopped = AtomicBool::new(true);
    assert_eq!(solve(&instance, &Options::default(), 1, &stopped), None);
}

#[test]
fn answers_without_a_plan_contain_the_reason() {
    let go = AtomicBool::new(false);
    let solved = |json: &Json| {
        let instance = read_one(json).unwrap();
        solve(&instance, &Options::default(), 1, &go).unwrap()
    };
    let wall = json!([{ "polygon": [[300, -50], [310, -50], [310, 550], [300, 550]] }]);
    let answer = solved(&changed("/obstacles", wall));
    assert_eq!(answer.status, Outcome::NoPath);
    assert_eq!((answer.honest, answer.t_s), (None, None));
    assert!(answer.is_answer() && answer.error.is_some());
    let inside = json!([{ "x": 10, "y": 10, "r": 5 }]);
    let error = read_one(&changed("/obstacles", inside)).unwrap_err();
    assert_eq!(
        (error.field.as_str(), error.value.as_str()),
        ("start", "(10, 10)")
    );
    assert!(error.expected.contains("px"), "{error}");
}

fn json_value() -> impl Strategy<Value = Json> {
    let leaf = prop_oneof![
        Just(Json::Null),
        any::<bool>().prop_map(Json::from),
        any::<i64>().prop_map(Json::from),
        any::<f64>().prop_map(Json::from),
        "[a-z]{0,9}".prop_map(Json::from),
    ];
    leaf.prop_recursive(3, 24, 5, |inner| {
        prop_oneof![
            prop::collection::vec(inner.clone(), 0..5).prop_map(Json::from),
            prop::collection::hash_map("[xyr]|polygon|theta", inner, 0..4)
                .prop_map(|map| Json::Object(map.into_iter().collect())),
        ]
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn any_bytes_are_read_or_refused(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        let _ = parse(&bytes);
        let mut listed = b"[".to_vec();
        listed.extend(bytes);
        let _ = parse(&listed);
    }

    #[test]
    fn any_value_in_any_field_is_read_or_refused(
        key in prop::sample::select(vec![
            "cm_per_px", "vmax_px_s", "v_min", "wmax_rad_s", "buffer_px", "bounds_px", "start", "goal",
            "start_speed", "obstacles", "wheel_speed_px_s", "acceleration_px_s2", "goal_speed",
        ]),
        value in json_value(),
    ) {
        if let Ok(instance) = read_one(&changed(&format!("/{key}"), value)) {
            prop_assert!(instance.problem().validate().is_ok());
            prop_assert_eq!(read_one(&instance.to_json()).unwrap(), instance);
        }
    }
}

#[test]
fn outcomes_have_one_name_in_json_and_tables() {
    for outcome in Outcome::ALL {
        let json = serde_json::to_value(outcome).unwrap();
        assert_eq!(json, outcome.name());
    }
}
