//! `--set` and its effects.

use config::parse_document;
use proptest::prelude::*;

use super::*;

const TEXT: &str = "
    [run]
    seed = 1
    mode = 'lock_step'
    [[robots]]
    name = 'police_1'
    start = { x = 1, y = 2, theta = 0 }
    [[robots]]
    name = 'police_2'
    [[processes]]
    kind = 'perception'
    params = { particles = 10 }
";

fn tree() -> (Node, Sources) {
    let mut sources = Sources::default();
    let id = sources.add(SourceKind::File, "t.toml", TEXT);
    let mut problems = Diagnostics::default();
    let node = parse_document(&sources, id, &mut problems).unwrap();
    assert!(problems.is_empty());
    (node, sources)
}

fn set(argument: &str) -> Result<Node, String> {
    let (mut node, mut sources) = tree();
    let mut problems = Diagnostics::default();
    apply(&mut node, &mut sources, "--set", argument, &mut problems);
    problems.into_result(node).map_err(|p| p.to_string())
}

fn at(argument: &str, path: &str) -> String {
    let root = set(argument).unwrap();
    let mut node = &root;
    for key in path.split('.') {
        node = match node.as_array() {
            Some(list) => &list[key.parse::<usize>().unwrap()],
            None => node.get(key).unwrap(),
        };
    }
    node.render_short()
}

#[test]
fn values_are_set_by_key_index_and_name() {
    assert_eq!(at("run.seed=7", "run.seed"), "7");
    assert_eq!(
        at("robots.police_2.limits.v_max=0.5", "robots.1.limits.v_max"),
        "0.5"
    );
    assert_eq!(at("robots[0].start.x = -3", "robots.0.start.x"), "-3");
    assert_eq!(at("robots.0.start.x=4", "robots.0.start.x"), "4");
    assert_eq!(
        at(
            "processes.perception.params.particles=99",
            "processes.0.params.particles"
        ),
        "99"
    );
    assert_eq!(at("rules.time_limit=60", "rules.time_limit"), "60");
    assert_eq!(at("run.pin=[1, 2]", "run.pin"), "[1, 2]");
    assert_eq!(at("run.\"odd key\"=1", "run.odd key"), "1");
}

#[test]
fn elements_are_added_behind_the_others() {
    assert_eq!(
        at("processes[+]={ kind = \"pursuer\" }", "processes.1.kind"),
        "\"pursuer\""
    );
    assert_eq!(at("events[+]={ time_s = 1 }", "events.0.time_s"), "1");
    let text = set("run[+]=1").unwrap_err();
    assert!(text.contains("`run` is a table, not an array"), "{text}");
    let text = set("robots[+].radius=1").unwrap_err();
    assert!(text.contains("`robots` has no element `+`"), "{text}");
}

#[test]
fn the_place_is_the_same_however_an_element_is_named() {
    let place = |argument: &str| {
        let (mut node, mut sources) = tree();
        let mut problems = Diagnostics::default();
        let path = apply(&mut node, &mut sources, "--set", argument, &mut problems);
        path.map(|path| path.to_string())
    };
    let by_name = place("robots.police_2.start.x=1");
    assert_eq!(by_name.as_deref(), Some("robots.police_2.start.x"));
    assert_eq!(place("robots[1].start.x=1"), by_name);
    assert_eq!(place("robots.1.start.x=1"), by_name);
    assert_eq!(place("robots.police_3.start.x=1"), None);
}

#[test]
fn values_are_found_by_key() {
    let (node, _) = tree();
    let found = |key: &str| find(&node, key).map(Node::render_short);
    assert_eq!(found("robots.police_1.start.y").as_deref(), Some("2"));
    assert_eq!(
        found("processes[0].params.particles").as_deref(),
        Some("10")
    );
    for key in [
        "robots.police_3",
        "robots[7]",
        "run.seed.x",
        "rules",
        "a..b",
        "",
    ] {
        assert_eq!(found(key), None, "{key}");
    }
}

#[test]
fn bare_words_are_text_and_everything_else_is_toml() {
    assert_eq!(at("run.mode=real_time", "run.mode"), "\"real_time\"");
    assert_eq!(at("run.mode=\"real_time\"", "run.mode"), "\"real_time\"");
    assert_eq!(
        at("run.mode=maps/a b.toml", "run.mode"),
        "\"maps/a b.toml\""
    );
    assert_eq!(at("run.mode=true", "run.mode"), "true");
    assert_eq!(at("run.mode=a=b", "run.mode"), "\"a=b\"");
}

#[test]
fn invalid_overrides_are_reported() {
    for (argument, wants) in [
        (
            "run.seed",
            &["override without `=`", "--> --set", "key=value"][..],
        ),
        ("run.seed=", &["override without a value"]),
        ("=1", &["key that cannot be read"]),
        ("run..seed=1", &["key that cannot be read"]),
        ("run.seed=[1, ", &["not valid TOML", "--> --set"]),
        ("run.seed=\"a", &["not valid TOML"]),
        (
            "robots.police_3.radius=1",
            &[
                "`robots` has no element `police_3`",
                "one of `police_1`, `police_2`, or an index from 0 to 1",
                "did you mean `police_",
            ],
        ),
        (
            "robots[2].radius=1",
            &["`robots` has no element `2`", "0 to 1"],
        ),
        (
            "run.seed.x=1",
            &[
                "`run.seed` is a whole number: there is nothing inside it",
                "value: 1",
            ],
        ),
        ("run[0]=1", &["`run` is a table, not an array"]),
    ] {
        let text = set(argument).unwrap_err();
        for want in wants {
            assert!(
                text.contains(want),
                "{argument}: missing {want:?} in:\n{text}"
            );
        }
    }
}

#[test]
fn the_place_of_a_value_is_the_argument() {
    let (mut node, mut sources) = tree();
    let mut problems = Diagnostics::default();
    apply(
        &mut node,
        &mut sources,
        "--set",
        "run.seed=7",
        &mut problems,
    );
    let origin = node.get("run").and_then(|n| n.get("seed")).unwrap().origin;
    let place = sources.place(origin).unwrap();
    assert!(place.is_override);
    assert_eq!(
        (place.snippet.as_str(), place.marker, place.length),
        ("run.seed=7", 9, 1)
    );
}

proptest! {
    #[test]
    fn arbitrary_overrides_never_panic(argument in ".{0,80}") {
        let _ = set(&argument);
    }

    #[test]
    fn overrides_of_numbers_and_text_round_trip(number in any::<i64>(), float in -1e300f64..1e300, text in "[^\\\\\"\\p{C}]{0,20}") {
        prop_assert_eq!(at(&format!("run.seed={number}"), "run.seed"), number.to_string());
        let root = set(&format!("run.seed={float:?}")).unwrap();
        let found = root.get("run").and_then(|n| n.get("seed")).unwrap();
        prop_assert_eq!(&found.value, &Value::Float(float));
        let root = set(&format!("run.mode=\"{text}\"")).unwrap();
        let found = root.get("run").and_then(|n| n.get("mode")).unwrap();
        prop_assert_eq!(found.as_str(), Some(text.as_str()));
    }
}
