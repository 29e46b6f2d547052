//! `protean test`: missions as tests.

use std::fs;

use crate::support::Sandbox;

const SET: &str = "set.rules.time_limit = 2\n";

#[test]
fn a_test_of_three_lines_passes_and_its_digest_is_accepted() {
    let sandbox = Sandbox::new();
    // Two lines, and an accepted digest that keeps the comments of its file.
    let text = "# The short chase.\nscenario = \"chase\" # built in\nset.rules.time_limit = 2\n[expect]\n\
                outcome.evader_1 = \"timed_out\"\ndigest = \"\" # pinned\n";
    sandbox.file("tests/short.toml", text);
    let words = |line: &str| line.split(' ').map(str::to_owned).collect::<Vec<_>>();
    let call = |line: &str| {
        sandbox
            .protean(words(line).iter().map(String::as_str))
            .run()
    };
    let first = call("test --quiet");
    assert_eq!(first.code, Some(1), "{first}");
    assert!(
        first
            .stdout
            .contains("tests/short.toml:6: digest = \"\" (seed 1)"),
        "{first}"
    );
    let command = "repeat: protean run chase --set rules.time_limit=2 --seed 1";
    assert!(first.stdout.contains(command), "{first}");
    call("test --quiet --update");
    let accepted = call("test --quiet --keep-logs all --json");
    assert_eq!(accepted.code, Some(0), "{accepted}");
    fs::write(sandbox.path().join("base.json"), &accepted.stdout).unwrap();
    let file = sandbox.path().join("tests/short.toml");
    let written = fs::read_to_string(&file).unwrap();
    assert!(
        written.starts_with("# The short chase.\nscenario = \"chase\" # built in\n"),
        "{written}"
    );

    // A changed planner: the first difference from the accepted log is named, everywhere.
    let change = "--set processes.perception.params.filter.particles=90 --baseline base.json";
    let files = "--junit out.xml --markdown out.md --github --update=fewer";
    let changed = call(&format!("test --quiet {change} {files}"));
    assert_eq!(changed.code, Some(1), "{changed}");
    let difference = "perception, perception/belief";
    assert!(
        changed
            .stdout
            .contains("::error file=tests/short.toml,line=6,title=tests/short::"),
        "{changed}"
    );
    assert!(changed.stdout.contains(difference), "{changed}");
    for (name, expected) in [
        ("out.xml", "failures=\"1\""),
        ("out.xml", difference),
        (
            "out.md",
            "tests/short: 1 of 1 missions changed, first `tick ",
        ),
        ("tests/short.toml", "\" # pinned; was "),
        ("tests/short.toml", "; fewer; first difference: tick "),
    ] {
        let text = fs::read_to_string(sandbox.path().join(name)).unwrap();
        assert!(text.contains(expected), "{expected}: {text}");
    }
    let again = call("test --quiet --set processes.perception.params.filter.particles=90");
    assert_eq!(again.code, Some(0), "{again}");
}

#[test]
fn every_kind_of_expectation_holds_and_fails() {
    let sandbox = Sandbox::new();
    for (holds, fails) in [
        ("outcome = \"time_limit\"", "outcome = \"ended\""),
        (
            "outcome.evader_1 = \"timed_out\"",
            "outcome.evader_1 = \"escaped\"",
        ),
        ("no_contact = true", "columns.contacts.at_least = 1"),
        (
            "events = [\"timed_out evader_2\", \"game_over\"]",
            "events = [\"game_over\", \"timed_out evader_2\"]",
        ),
        (
            "columns.sim_time_s = { within = [1.9, 2.1] }",
            "columns.sim_time_s = { at_most = 1.5 }",
        ),
        (
            "columns.sim_time_s = { value = 2.1, within = 0.2 }",
            "columns.ticks = 41",
        ),
        (
            "columns.outcome = \"time_limit\"",
            "columns.first_capture_s = 1",
        ),
        (
            "robots.evader_1.distance_m.at_most = 5",
            "robots.evader_1.distance_m.at_least = 5",
        ),
        (
            "escape_share = { over = 2, within = [0, 1] }",
            "shares.ended = { over = 20, within = [0.5, 1] }",
        ),
        (
            "shares.slow = { columns.ticks.at_least = 9, within = [0, 1] }",
            "means.ticks = { over = 2, within = [0, 9] }",
        ),
    ] {
        for (expect, code) in [(holds, 0), (fails, 1)] {
            let text = format!("scenario = \"chase\"\n{SET}expect.{expect}\n");
            sandbox.file("tests/one.toml", &text);
            let done = sandbox.protean(["test", "--quiet"]).run();
            assert_eq!(done.code, Some(code), "{expect}: {done}");
        }
    }
    // Neither inside nor outside: more missions can decide.
    let text = format!(
        "scenario = \"chase\"\n{SET}expect.escape_share = {{ over = 3, within = [0, 0.2] }}\n"
    );
    sandbox.file("tests/one.toml", &text);
    let open = sandbox.protean(["test", "--quiet", "--jobs", "2"]).run();
    assert_eq!(open.code, Some(3), "{open}");
    assert!(
        open.stdout
            .contains("0 passed, 0 failed, 1 inconclusive (3 missions)"),
        "{open}"
    );
    let text = format!(
        "scenario = \"chase\"\nseeds = \"3..4\"\n{SET}[expect]\noutcome_only = true\ndigest = \"old\"\n"
    );
    sandbox.file(
        "tests/one.toml",
        text.replace("\ndigest", "\nno_contact = true\ndigest"),
    );
    let accepted = sandbox.protean(["test", "--quiet", "--update"]).run();
    assert_eq!(accepted.code, Some(0), "{accepted}");
    let written = fs::read_to_string(sandbox.path().join("tests/one.toml")).unwrap();
    assert!(written.contains("evader_1 = \"timed_out\""), "{written}");
    let again = sandbox
        .protean(["test", "--quiet", "--processes", "--filter", "one"])
        .run();
    assert_eq!(again.code, Some(0), "{again}");
    sandbox.assert_nothing_left();
}

#[test]
fn faults_of_test_files_have_line_key_and_suggestion() {
    let sandbox = Sandbox::new();
    for (text, expected) in [
        (
            "scenario = \"chse\"\nexpect.no_contact = true",
            &["tests/bad.toml:1", "did you mean `chase`"][..],
        ),
        (
            "scenario = \"chase\"\nexpct.no_contact = true",
            &["tests/bad.toml:2", "did you mean `expect`"],
        ),
        (
            "scenario = \"chase\"\nexpect.outcome.evader_9 = \"escaped\"",
            &["tests/bad.toml:2", "did you mean `evader_"],
        ),
        (
            "scenario = \"chase\"\nexpect.outcome.evader_1 = \"escapd\"",
            &["(expect.outcome.evader_1)", "did you mean `escaped`"],
        ),
        (
            "scenario = \"chase\"\nexpect.columns.tick = 1",
            &["(expect.columns.tick)", "did you mean `ticks`"],
        ),
        (
            "scenario = \"chase\"\nexpect.columns.ticks = { at_mots = 1 }",
            &["at_mots", "did you mean `at_most`"],
        ),
        (
            "scenario = \"chase\"\nexpect.columns.ticks = { within = [2, 1] }",
            &["no value meets this", "low <= high"],
        ),
        (
            "scenario = \"chase\"\nexpect.columns.ticks = \"many\"",
            &["values of another type", "a whole number"],
        ),
        (
            "scenario = \"chase\"\nexpect.events = [\"escapd\"]",
            &["(expect.events)", "did you mean `escaped`"],
        ),
        (
            "scenario = \"chase\"\nexpect.digest = \"12\"",
            &["this is no digest", "64 hexadecimal digits"],
        ),
        (
            "scenario = \"chase\"\nseeds = [1, 2]\nexpect.digest = \"\"",
            &["one digest for several missions", "by seed"],
        ),
        (
            "scenario = \"chase\"\nset.rules.time_limt = 1\nexpect.no_contact = true",
            &["tests/bad.toml:2", "did you mean `time_limit`"],
        ),
        (
            "scenario = \"patrol_square\"\nexpect.escape_share = { over = 9, within = [0, 1] }",
            &["no robot", "a scenario with evaders"],
        ),
        (
            "scenario = \"chase\"\nexpect.escape_share = { over = 0, within = [0, 1] }",
            &["0 missions", "from 1 to"],
        ),
        (
            "scenario = \"chase\"\nexpect = {}",
            &["nothing is expected"],
        ),
        ("x = 1", &["there are no tests in tests"]),
        (
            "[[test]]\nname = \"end_to_end\"\npath = \"end_to_end.rs\"",
            &["there are no tests in tests"],
        ),
    ] {
        sandbox.file("tests/bad.toml", text);
        let refused = sandbox.protean(["test"]).run();
        assert_eq!(refused.code, Some(2), "{text}: {refused}");
        for part in expected {
            assert!(refused.stderr.contains(part), "{part}: {refused}");
        }
    }
}

#[test]
fn a_scenario_with_expectations_is_a_test_and_its_runs_are_those_without() {
    let sandbox = Sandbox::new();
    let hello = scenario::builtin::scenario("hello").unwrap().text;
    let hello = hello.replace("maps/hello.toml", "builtin:hello");
    sandbox.file("plain.toml", &hello);
    sandbox.file(
        "hello.toml",
        format!("{hello}\n[expect]\noutcome = \"ended\"\n"),
    );
    let digest = |name: &str| {
        let run = sandbox
            .protean([
                "run",
                name,
                "--in-process",
                "--json",
                "--quiet",
                "--seed",
                "1",
            ])
            .run();
        run.json()["digest"].clone()
    };
    assert_eq!(digest("plain.toml"), digest("hello.toml"));
    let done = sandbox.protean(["test", "--quiet", "hello.toml"]).run();
    assert_eq!(done.code, Some(0), "{done}");
    for (expect, place, near) in [
        ("no_contacts = true", "expect.no_contacts", "no_contact"),
        ("columns.tick = 1", "expect.columns.tick", "ticks"),
        ("outcome.robt = \"caught\"", "expect.outcome.robt", "robot"),
        ("events = [\"escapd\"]", "expect.events", "escaped"),
    ] {
        sandbox.file("hello.toml", format!("{hello}\n[expect]\n{expect}\n"));
        for command in ["check", "test"] {
            let refused = sandbox.protean([command, "hello.toml"]).run();
            refused.refused(2, &[place, &format!("did you mean `{near}`")]);
        }
    }
}

#[test]
fn a_folder_may_have_other_files_and_a_named_file_is_a_test() {
    let sandbox = Sandbox::new();
    sandbox.file(
        "tests/Cargo.toml",
        "[package]\nname = \"tests\"\n[[test]]\nname = \"all\"\n",
    );
    let text = format!("scenario = \"chase\"\n{SET}expect.outcome = \"time_limit\"\n");
    sandbox.file("tests/short.toml", &text);
    let done = sandbox.protean(["test", "--quiet"]).run();
    assert_eq!(done.code, Some(0), "{done}");
    assert!(done.stdout.contains("1 passed, 0 failed"), "{done}");
    let named = sandbox.protean(["test", "tests/Cargo.toml"]).run();
    named.refused(2, &["there are no tests in tests/Cargo.toml", "`[[test]]`"]);
    let none = sandbox.protean(["test", "--filter", "long"]).run();
    none.refused(2, &["no test has \"long\" in its name"]);
}

#[test]
fn a_mission_without_end_is_not_decided() {
    let sandbox = Sandbox::new();
    let text = "scenario = \"patrol_square\"\nseeds = [1, 2]\nset.rules.time_limit = 1000000\n\
                expect.no_contact = true\nexpect.means.ticks = { within = [0, 1] }\n";
    sandbox.file("tests/endless.toml", text);
    let command = ["test", "--quiet", "--timeout", "1", "--keep-logs", "failed"];
    let done = sandbox.protean(command).run();
    assert_eq!(done.code, Some(3), "{done}");
    for part in [
        "inconclusive  tests/endless (0 missions)",
        "tests/endless.toml:1: the mission ends within 1 s of real time (seed 2)",
        "repeat: protean run patrol_square --set rules.time_limit=1000000 --seed 2",
        "log: logs/tests/tests-endless-2-failed.mcap",
        "0 passed, 0 failed, 1 inconclusive",
    ] {
        assert!(done.stdout.contains(part), "{part}: {done}");
    }
}
