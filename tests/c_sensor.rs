//! A sensor, a tracker and a planner in C, with messages of their own: the libraries of `examples/c_sensor`.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::support::call::Call;
use crate::support::{Sandbox, python, skipped};

/// A process with faults, selected by its parameter `mode` and by macros.
const FAULTY: &str = r#"
#include "protean_planner.h"
typedef struct echo { double range; uint32_t robot, reserved; } echo;
static const protean_field ECHO[] = {
    PROTEAN_FIELD(echo, range, "float64"), PROTEAN_FIELD(echo, robot, "uint32"), PROTEAN_FIELD(echo, reserved, "uint32")};
static const protean_topic ECHOES = {OWN, PROTEAN_ELEMENTS(echo, ECHO), .capacity = 2, .flags = PROTEAN_SOLE};
static const protean_topic HEARD = {.name = READ, .size = READ_BYTES};
static int mode;
static void *create(const protean_start *start) {
    if (start->own) protean_refuse(start, "it has a robot");
    mode = (int)protean_number(start, "mode", 0.0);
    if (mode == 1) protean_refuse(start, "no battery");
    return &mode;
}
static void destroy(void *process) { (void)process; }
static void step(void *process, const protean_tick *tick) {
    const echo all[3] = {{1.0, 0, 0}, {2.0, 1, 0}, {3.0, 2, 0}};
    (void)process;
    if (mode == 2) protean_write(tick, "own/other", all, 1);
    if (mode == 3) protean_write(tick, OWN, all, 3);
    if (mode == 4) protean_write(tick, OWN, 0, 2);
    if (mode == 5) protean_write(tick, OWN, all, 1);
    if (mode == 6) protean_read(tick, "own/other");
    if (mode == 7) protean_clearance(tick, (protean_point){1.0, 1.0});
    if (mode == 8) protean_fail(tick, "it is dark");
    if (mode == 9) protean_write(tick, 0, all, 1);
    protean_write(tick, OWN, all, 2);
}
const protean_planner *protean_planner_table(void) {
    static const protean_planner table = {.version = PROTEAN_PLANNER_VERSION, .create = create, .destroy = destroy, .step = step,
        .reads = &HEARD, .read_count = 1, .writes = &ECHOES, .write_count = 1};
    return &table;
}
"#;

fn example(file: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../examples")
        .join(file)
}

/// Compiles a source to `build/NAME.so` of a sandbox; returns `false`, with a note on stderr, without a compiler.
fn compile(sandbox: &Sandbox, source: &Path, name: &str, macros: &[String]) -> bool {
    let library = sandbox.file(&format!("build/{name}.so"), "");
    let compiled = Command::new("cc")
        .args([
            "-std=c99",
            "-O2",
            "-Wall",
            "-Wextra",
            "-Wpedantic",
            "-Werror",
        ])
        .args(["-ffp-contract=off", "-fPIC", "-shared", "-I"])
        .args([example("cpp_planner"), "-o".into(), library])
        .args(macros)
        .arg(source)
        .output();
    match compiled {
        Ok(output) => {
            let errors = String::from_utf8_lossy(&output.stderr);
            assert!(output.status.success(), "{errors}");
            true
        }
        Err(error) => {
            skipped("processes in C", &format!("cc: {error}"));
            false
        }
    }
}

/// The example with its libraries; `None` without a compiler.
fn sensor() -> Option<Sandbox> {
    let sandbox = Sandbox::new();
    let mission = std::fs::read_to_string(example("c_sensor/mission.toml")).unwrap();
    sandbox.file("mission.toml", mission);
    for name in ["sensor", "tracker", "chaser"] {
        let source = example(&format!("c_sensor/{name}.c"));
        if !compile(&sandbox, &source, name, &[]) {
            return None;
        }
    }
    Some(sandbox)
}

fn run<'a>(sandbox: &'a Sandbox, mission: &'a str) -> Call<'a> {
    sandbox.protean(["run", mission, "--allow-external"])
}

#[test]
fn processes_in_c_with_messages_of_their_own_run_are_logged_measured_and_executed_again() {
    let Some(sandbox) = sensor() else { return };
    let summary = run(&sandbox, "mission.toml")
        .args(["--out", "mission.mcap"])
        .json();
    let ticks = summary["ticks"].as_u64().unwrap();
    for topic in ["sonar/bearing", "sonar/track"] {
        let messages = summary["topics"][topic]["messages"].as_u64();
        assert_eq!(messages, Some(ticks), "{topic}: {summary}");
    }
    let local = run(&sandbox, "mission.toml").args(["--in-process", "--out", "local.mcap"]);
    assert_eq!(local.json()["digest"], summary["digest"]);
    for further in [&[][..], &["--in-process"]] {
        let verify = ["verify", "mission.mcap", "--allow-external"];
        let verified = sandbox.protean(verify).args(further.iter().copied()).json();
        assert_eq!(verified["same"], true, "{verified}");
    }
    let test = [
        "replay",
        "mission.mcap",
        "--test",
        "tracker",
        "--allow-external",
    ];
    let again = sandbox.protean(test).run();
    assert!(again.stdout.contains("IDENTICAL"), "{again}");

    // A program that does not know the topics measures them by their layouts in the log.
    let latency = sandbox.protean(["latency", "mission.mcap"]).run();
    for step in ["sensor step", "tracker step", "chaser_north step"] {
        assert!(latency.stdout.contains(step), "{step}: {latency}");
    }
    let graph = ["check", "mission.toml", "--graph", "flow.mmd"];
    let refused = sandbox.protean(graph).run();
    refused.refused(2, &["its declaration is not known", "--allow-external"]);
    let drawn = sandbox.protean(graph).arg("--allow-external").run();
    assert_eq!(drawn.code, Some(0), "{drawn}");
    let graph = std::fs::read_to_string(sandbox.path().join("flow.mmd")).unwrap();
    assert!(graph.contains(r#"-- "sonar/bearing" --> "#), "{graph}");
    let marks = sandbox
        .protean(["cat", "mission.mcap", "/marks"])
        .run()
        .stdout;
    assert!(marks.contains(r#""ns":"sonar/track""#), "{marks:.400}");
    let found: Option<BTreeMap<String, BTreeMap<String, u64>>> =
        python::call("read_rosbag.py", sandbox.path());
    if let Some(read) = found {
        assert_eq!(read["mission"]["sonar/track"], ticks);
        assert_eq!(read["mission"]["sonar/bearing"], ticks);
    }
    sandbox.assert_nothing_left();
}

#[test]
fn late_and_lost_messages_of_processes_in_c_are_the_same_in_processes_in_one_thread_and_from_the_log()
 {
    let Some(sandbox) = sensor() else { return };
    let mission = std::fs::read_to_string(example("c_sensor/mission.toml")).unwrap();
    // To a process in C, from one in C to one in C, and from one in C to a planner in C.
    let links = "[[links]]\ntopic = \"world/state\"\nto = \"sensor\"\ndelay_s = 0.1\n\
                 [[links]]\ntopic = \"sonar/bearing\"\ndelay_s = 0.15\nloss = 0.2\n\
                 [[links]]\ntopic = \"sonar/track\"\nfrom = \"tracker\"\nto = \"chaser_*\"\nloss = 0.3\n";
    sandbox.file("linked.toml", mission + links);
    let plain = run(&sandbox, "mission.toml").arg("--in-process").json();
    let processes = run(&sandbox, "linked.toml").args(["--out", "linked.mcap"]);
    let processes = processes.json();
    let one = run(&sandbox, "linked.toml").arg("--in-process").json();
    assert_ne!(one["digest"], plain["digest"]);
    assert_eq!(processes["digest"], one["digest"]);
    assert_eq!(processes["links"], one["links"]);
    let links = one["links"].as_array().unwrap();
    for topic in ["sonar/bearing", "sonar/track"] {
        let link = links.iter().find(|link| link["topic"] == topic);
        assert!(link.unwrap()["lost"].as_u64() > Some(0), "{links:?}");
    }
    let verify = ["verify", "linked.mcap", "--allow-external"];
    let verified = sandbox.protean(verify).json();
    assert_eq!(verified["same"], true, "{verified}");
    sandbox.assert_nothing_left();
}

#[test]
fn tests_sweeps_and_comparisons_ask_programs_for_their_declarations() {
    let Some(sandbox) = sensor() else { return };
    let digest = run(&sandbox, "mission.toml").json()["digest"].clone();
    let test = format!("scenario = \"mission.toml\"\nseed = 1\nexpect.digest = {digest}\n");
    sandbox.file("pinned.toml", test);
    let test = ["test", "pinned.toml", "--processes", "--allow-external"];
    let tested = sandbox.protean(test).run();
    assert_eq!(tested.code, Some(0), "{tested}");
    let sweep = "scenario = \"mission.toml\"\nseeds = { first = 1, count = 1 }\n";
    sandbox.file("sweep.toml", sweep);
    let sweep = ["sweep", "sweep.toml", "--out", "swept", "--allow-external"];
    let swept = sandbox.protean(sweep).run();
    assert_eq!(swept.code, Some(0), "{swept}");
    let table = std::fs::read_to_string(sandbox.path().join("swept/results.csv")).unwrap();
    assert!(table.contains(digest.as_str().unwrap()), "{table}");
    let diff = ["diff", "mission.toml", "mission.toml", "--allow-external"];
    assert_eq!(sandbox.protean(diff).json()["same"], true);
    sandbox.assert_nothing_left();
}

/// A sandbox with builds of the process with faults.
struct Faulty {
    sandbox: Sandbox,
}

impl Faulty {
    /// Builds libraries: name, topic that it writes, topic that it reads and the size of its structure. `None` without a compiler.
    fn new(builds: &[[&str; 4]]) -> Option<Self> {
        let sandbox = Sandbox::new();
        let source = sandbox.file("faulty.c", FAULTY);
        for [name, own, read, bytes] in builds {
            let macros = [
                format!("-DOWN=\"{own}\""),
                format!("-DREAD=\"{read}\""),
                format!("-DREAD_BYTES={bytes}"),
            ];
            if !compile(&sandbox, &source, name, &macros) {
                return None;
            }
        }
        Some(Self { sandbox })
    }

    /// Runs a mission with these processes, by name and library; it is refused or fails.
    fn fails(&self, processes: &[(&str, &str)], options: &[&str], code: i32, words: &[&str]) {
        let mut text = "[world]\nmap = \"builtin:hello\"\n[rules]\ntime_limit = 1.0\n\
                        exits = [{ circle = { center = [0.5, 0.5], radius = 0.1 } }]\n[[robots]]\nname = \"robot\"\n\
                        team = \"evader\"\nstart = { x = 1.0, y = 0.5, theta = 0.0 }\n\
                        [[processes]]\nkind = \"evader_potential\"\nteam = \"evader\"\n"
            .to_owned();
        for (name, library) in processes {
            text += &format!(
                "[[processes]]\nname = \"{name}\"\ncommand = [\"protean\", \"planner\", \"build/{library}.so\"]\n\
                 declaration = \"ask\"\n"
            );
        }
        self.sandbox.file("mission.toml", text);
        let call = run(&self.sandbox, "mission.toml").arg("--quiet");
        let failed = call.args(options.iter().copied()).run();
        failed.refused(code, words);
    }
}

#[test]
fn faults_of_declarations_in_c_are_named() {
    let builds = [
        ["whole", "own/echo", "world/state", "64"],
        ["flat", "own/echo", "world/state", "0"],
        ["wide", "own/answer", "own/echo", "24"],
        ["deaf", "own/echo", "own/nothing", "16"],
    ];
    let Some(faulty) = Faulty::new(&builds) else {
        return;
    };
    let flat = "topic \"world/state\": the structure has 0 bytes: expected 64";
    faulty.fails(&[("flat", "flat")], &[], 1, &["flat", flat]);
    let deaf = "own/nothing, but no process writes it";
    faulty.fails(
        &[("deaf", "deaf")],
        &[],
        2,
        &[deaf, "processes.deaf.declaration"],
    );
    let wide = "topic \"own/echo\": the structure has 24 bytes: expected 16";
    let pair = [("wide", "wide"), ("whole", "whole")];
    faulty.fails(&pair, &[], 1, &["wide", wide]);
    let two = "two processes write own/echo, `one` and `two`";
    let pair = [("one", "whole"), ("two", "whole")];
    faulty.fails(&pair, &[], 2, &[two]);
    let absent = [
        "build/absent.so: cannot be read: No such file",
        "process absent: it does not state its declaration",
    ];
    faulty.fails(&[("absent", "absent")], &[], 2, &absent);
    faulty.sandbox.assert_nothing_left();
}

#[test]
fn faults_of_processes_in_c_are_named() {
    let builds = [["whole", "own/echo", "world/state", "64"]];
    let Some(faulty) = Faulty::new(&builds) else {
        return;
    };
    let cases = [
        ("mode=1", "process sonar", "no battery"),
        (
            "moed=1",
            "unknown parameter `moed`",
            "expected one of `mode`",
        ),
        (
            "mode=2",
            "the process fails: protean_write",
            "topic \"own/other\": expected own/echo",
        ),
        (
            "mode=3",
            "own/echo: 3 elements at an array",
            "expected at most 2",
        ),
        (
            "mode=4",
            "own/echo: 2 elements at NULL",
            "expected at most 2",
        ),
        (
            "mode=5",
            "protean_write: own/echo",
            "expected one message in a tick",
        ),
        (
            "mode=6",
            "protean_read: topic \"own/other\"",
            "expected world/state",
        ),
        (
            "mode=7",
            "the process fails",
            "a process has no robot and no map",
        ),
        (
            "mode=8",
            "process sonar",
            "at 0 s the process fails: it is dark",
        ),
        ("mode=9", "protean_write: topic \"\"", "expected own/echo"),
    ];
    for (param, fault, expectation) in cases {
        let set = format!("processes.sonar.params.{param}");
        let options = ["--in-process", "--set", &set];
        faulty.fails(&[("sonar", "whole")], &options, 1, &[fault, expectation]);
    }
    let options = ["--set", "processes.sonar.params.mode=8"];
    faulty.fails(
        &[("sonar", "whole")],
        &options,
        1,
        &["process sonar", "it is dark"],
    );
    faulty.sandbox.assert_nothing_left();
}
