//! The command line as people type it: files of the wrong kind, terminals of several widths.

use std::process::{Command, Stdio};

use crate::support::terminal::Terminal;
use crate::support::{PROTEAN, SOON, Sandbox, until};

/// An experiment of two cells without evaders in the way of its missions.
const EXPERIMENT: &str = r#"scenario = "builtin:chase_exact"
seeds = { first = 1, count = 2 }
[parameters.police_speed]
set = "teams.police.limits.v_max"
[parameters.evader_speed]
set = "teams.evader.limits.v_max"
[parameters.time_limit]
set = "rules.time_limit"
[grid]
police_speed = [0.35, 0.4]
evader_speed = [0.2]
time_limit = [1.5]
"#;

/// Writes a file of every kind; returns their names, each with words of the help that names its kind.
fn files(sandbox: &Sandbox) -> Vec<(&'static str, &'static str)> {
    let copied = sandbox
        .protean(["new", "scenario.toml", "--from", "hello"])
        .run();
    assert_eq!(copied.code, Some(0), "{copied}");
    sandbox.record("hello");
    for (name, content) in [
        ("experiment.toml", EXPERIMENT),
        (
            "map.yaml",
            "image: hall.pgm\nresolution: 0.05\norigin: [0, 0, 0]\n",
        ),
        ("scenario.yaml", "world:\n  map: hall\n"),
        ("instances.json", "[{\"id\": \"a\"}]"),
        ("grid.map", "type octile\nheight 1\nwidth 1\nmap\n.\n"),
        ("page.html", "<!doctype html>"),
        ("picture.svg", "<svg/>"),
        ("table.csv", "case,seed\n"),
        ("planner.py", "print()\n"),
    ] {
        sandbox.file(name, content);
    }
    vec![
        ("run.mcap", "it is a log: `protean report run.mcap`"),
        (
            "scenario.toml",
            "it is a scenario: `protean run scenario.toml`",
        ),
        (
            "experiment.toml",
            "it is an experiment: `protean sweep experiment.toml`",
        ),
        ("maps/hello.toml", "it is a map: a scenario names it"),
        ("map.yaml", "`protean new NAME.toml --from map.yaml`"),
        (
            "scenario.yaml",
            "it is YAML: scenarios and experiments are TOML",
        ),
        ("instances.json", "`protean plan instances.json`"),
        ("grid.map", "`protean new NAME.toml --from grid.map`"),
        ("page.html", "it is a page"),
        ("picture.svg", "it is a picture"),
        ("table.csv", "it is a table"),
        ("planner.py", "it is a program"),
    ]
}

/// The commands that read a file, `FILE`, and the files that they take.
const COMMANDS: [(&str, &[&str]); 13] = [
    ("run FILE", &["scenario.toml"]),
    ("check FILE", &["scenario.toml"]),
    ("latency FILE", &["scenario.toml", "run.mcap"]),
    ("sweep FILE", &["experiment.toml"]),
    ("plan FILE", &["instances.json"]),
    // YAML counts as a map of ROS, whose image is then missing.
    (
        "new new.toml --from FILE",
        &["grid.map", "map.yaml", "scenario.yaml"],
    ),
    ("report FILE", &["run.mcap"]),
    ("picture FILE", &["run.mcap"]),
    ("info FILE", &["run.mcap"]),
    ("cat FILE", &["run.mcap"]),
    ("export FILE --out tables", &["run.mcap"]),
    ("replay FILE", &["run.mcap"]),
    ("verify FILE", &["run.mcap"]),
];

#[test]
fn every_command_names_the_kind_of_a_wrong_file_and_the_command_for_it() {
    let sandbox = Sandbox::new();
    let kinds = files(&sandbox);
    let before = sandbox.files();
    let refuse = |line: &str, file: &str, help: &str| {
        let line = line.replace("FILE", file);
        let outcome = sandbox.protean(line.split(' ')).run();
        outcome.refused(2, &[file, help]);
        assert_eq!(
            outcome.stderr.matches("error: ").count(),
            1,
            "{line}: {outcome}"
        );
    };
    std::thread::scope(|scope| {
        for (line, takes) in COMMANDS {
            let wrong = kinds.iter().filter(|(file, _)| !takes.contains(file));
            scope.spawn(move || wrong.for_each(|(file, help)| refuse(line, file, help)));
        }
    });
    // Without a command, too.
    for (file, help) in &kinds {
        sandbox.protean([*file]).run().refused(2, &[file, help]);
    }
    assert_eq!(sandbox.files(), before, "nothing is written");
}

/// Runs a command at a terminal with this number of columns; returns its stdout.
fn at_terminal(sandbox: &Sandbox, columns: u16, line: &str) -> String {
    let terminal = Terminal::open();
    let heard = terminal.listen();
    let script = "stty rows 24 cols \"$1\" -onlcr && shift && exec \"$@\"";
    let columns = columns.to_string();
    let words = ["-c", script, "sh", &columns, PROTEAN].into_iter();
    let mut child = Command::new("sh")
        .args(words.chain(line.split(' ')))
        .current_dir(sandbox.path())
        .env("XDG_RUNTIME_DIR", sandbox.runtime_dir())
        .env("NO_COLOR", "1")
        .stdin(terminal.inside.try_clone().unwrap())
        .stdout(terminal.inside.try_clone().unwrap())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let status = until("the end", SOON, || child.try_wait().unwrap());
    assert!(
        status.code().is_some_and(|code| code != 2),
        "{line}: {status}"
    );
    let Terminal { outside, inside } = terminal;
    drop(inside);
    until("the whole output", SOON, || {
        (std::sync::Arc::strong_count(&heard) == 1).then_some(())
    });
    drop(outside);
    heard.lock().unwrap().clone()
}

/// Returns the tables of an output: a header, and rows below a rule.
fn tables(text: &str) -> Vec<Vec<&str>> {
    let lines: Vec<&str> = text.lines().collect();
    let is_rule = |line: &str| line.starts_with('─');
    let rules = (1..lines.len()).filter(|&i| is_rule(lines[i]));
    rules
        .map(|rule| {
            let rows = lines[rule + 1..].iter().copied();
            let rows = rows.take_while(|line| line.starts_with(' ') && !line.trim().is_empty());
            std::iter::once(lines[rule - 1]).chain(rows).collect()
        })
        .collect()
}

#[test]
fn tables_fit_the_terminal_and_cut_no_word() {
    let sandbox = Sandbox::new();
    sandbox.record("chase");
    sandbox.file("experiment.toml", EXPERIMENT);
    sandbox.file("planning.toml", "kind = \"planning\"\nseeds.count = 2\n");
    let made = sandbox
        .protean([
            "plan",
            "generate",
            "base",
            "--count",
            "2",
            "--out",
            "base.json",
        ])
        .run();
    assert_eq!(made.code, Some(0), "{made}");
    let limit = "--set rules.time_limit=1";
    for (line, count) in [
        (format!("run chase_referee --in-process {limit}"), 1),
        (
            format!("run hello --latency {limit} --out hello.mcap --force"),
            2,
        ),
        ("info run.mcap".to_owned(), 1),
        ("latency run.mcap".to_owned(), 3),
        ("plan base.json".to_owned(), 1),
        (
            "sweep experiment.toml --in-process --out missions".to_owned(),
            1,
        ),
        ("sweep planning.toml --out plans".to_owned(), 1),
    ] {
        let whole = sandbox.protean(line.split(' ')).run();
        let whole = tables(&whole.stdout);
        assert_eq!(whole.len(), count, "{line}: {whole:?}");
        for columns in [60, 80, 120] {
            let shown = at_terminal(&sandbox, columns, &line);
            let shown = tables(&shown);
            assert_eq!(shown.len(), count, "{line}: {shown:?}");
            for (shown, whole) in shown.iter().zip(&whole) {
                assert_eq!(shown.len(), whole.len(), "{line}: {shown:#?}");
                let titles = |table: &[&str]| table[0].split_whitespace().count();
                assert!(titles(shown) > 1, "{line}: {shown:#?}");
                for line in shown {
                    let width = line.trim_end().chars().count();
                    assert!(width <= usize::from(columns), "{columns}: {shown:#?}");
                }
                // Every title stands whole in the whole table, and the first one is the same.
                let mut rest = whole[0];
                for word in shown[0].split_whitespace() {
                    let at = rest
                        .find(word)
                        .unwrap_or_else(|| panic!("{word}: {shown:#?}"));
                    rest = &rest[at + word.len()..];
                }
            }
        }
    }
}

#[test]
fn a_quiet_run_prints_verdict_robots_digest_and_log() {
    let sandbox = Sandbox::new();
    let words = ["run", "patrol_octagon", "--quiet", "--out", "run.mcap"];
    let quiet = sandbox.protean(words).set("rules.time_limit=2").run();
    assert_eq!(
        (quiet.code, quiet.stderr.as_str()),
        (Some(0), ""),
        "{quiet}"
    );
    let titles: Vec<&str> = quiet
        .stdout
        .lines()
        .map(|line| line.trim_start().split("  ").next().unwrap())
        .collect();
    assert_eq!(titles.len(), 8, "{quiet}");
    assert_eq!(
        [titles[2], titles[6], titles[7]],
        ["robot", "digest", "log"],
        "{quiet}"
    );
}
