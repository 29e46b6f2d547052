//! Commands on existing logs.

use crate::support::history::History;
use crate::support::{Sandbox, python};
use serde_json::Value as Json;

#[test]
fn a_log_tells_what_it_holds_and_is_run_again_the_same() {
    let sandbox = Sandbox::new();
    let summary = sandbox.record("chase_exact");
    let info = sandbox.protean(["info", "run.mcap"]).json();
    for key in ["scenario", "seed", "digest", "ticks", "robots"] {
        assert_eq!(info[key], summary[key], "{key}");
    }
    for (name, topic) in summary["topics"].as_object().unwrap() {
        for key in ["messages", "bytes"] {
            assert_eq!(info["topics"][name][key], topic[key], "{name} {key}");
        }
    }
    assert_eq!(info["condition"]["complete"], true);
    assert_eq!(info["condition"]["faults"], Json::Array(Vec::new()));

    // Recorded by processes, done again by processes and within one.
    for more in [&["--json"][..], &["--json", "--in-process"]] {
        let words = ["verify", "run.mcap", "--quiet"].into_iter();
        let outcome = sandbox.protean(words.chain(more.iter().copied())).run();
        assert_eq!(outcome.code, Some(0), "{outcome}");
        let rerun = outcome.json();
        assert_eq!(rerun["digest"], summary["digest"]);
        assert_eq!(
            (&rerun["same"], &rerun["whole"]),
            (&true.into(), &true.into())
        );
        assert!(
            rerun["topics"]["world/state"]["equal"].as_u64() > Some(20),
            "{rerun}"
        );
    }
    let files = sandbox.files();
    assert_eq!(
        files,
        [sandbox.path().join("run.mcap")],
        "nothing else is left"
    );
    sandbox.assert_nothing_left();
}

/// Returns the number before ` simulated` in a text.
fn simulated(text: &str) -> &str {
    let numbers = text.match_indices(" simulated").map(|(at, _)| {
        let mut before = text[..at].rsplit(|c: char| !c.is_ascii_digit());
        before.next().unwrap_or_default()
    });
    // "1.50 s simulated" has none.
    let mut numbers = numbers.filter(|number| !number.is_empty());
    numbers.next().expect(text)
}

#[test]
fn every_command_counts_the_messages_of_a_log_alike_and_two_runs_of_a_seed_too() {
    let sandbox = Sandbox::new();
    let summary = sandbox.record("chase_exact");
    let expected = summary["simulated_messages"].to_string();
    let counts = History::read(&sandbox.path().join("run.mcap")).counts;
    let is_simulated = |topic: &str| {
        ipc_types::topics::TopicId::from_name(topic).is_some_and(|topic| topic.facts().simulated)
    };
    let counts = counts.iter().filter(|(topic, _)| is_simulated(topic));
    let counted: u64 = counts.map(|(_, (messages, _))| messages).sum();
    assert_eq!(expected, counted.to_string());

    let print = |words: &str| {
        let outcome = sandbox.protean(words.split(' ')).run();
        assert_eq!(outcome.code, Some(0), "{outcome}");
        outcome.stdout
    };
    let again = "run chase_exact --seed 3 --out again.mcap --set rules.time_limit=1.5";
    for words in [
        again,
        "info run.mcap",
        "info again.mcap",
        "verify run.mcap",
        "verify again.mcap --in-process",
        "replay run.mcap --as-fast-as-possible",
    ] {
        assert_eq!(simulated(&print(words)), expected, "{words}");
    }
    print("report run.mcap --out page.html");
    let page = std::fs::read_to_string(sandbox.path().join("page.html")).unwrap();
    let (_, facts) = page.split_once("\"messages\":\"").unwrap();
    assert_eq!(simulated(facts), expected);
    for words in ["info run.mcap", "replay run.mcap --as-fast-as-possible"] {
        let found = sandbox.protean(words.split(' ')).json();
        assert_eq!(found["simulated_messages"].to_string(), expected, "{words}");
    }
}

#[test]
fn a_log_with_another_behind_it_is_reported_by_every_command() {
    let sandbox = Sandbox::new();
    sandbox.record("chase_exact");
    let log = std::fs::read(sandbox.path().join("run.mcap")).unwrap();
    sandbox.file("joined.mcap", [&log[..], &log].concat());
    for words in [
        "info joined.mcap",
        "verify joined.mcap --in-process",
        "replay joined.mcap --as-fast-as-possible",
        "replay joined.mcap --test evader_potential_evader_1 --in-process",
        "export joined.mcap --out tables",
        "cat joined.mcap world/map",
        "report joined.mcap",
        "recover joined.mcap --out ok.mcap",
    ] {
        let outcome = sandbox.protean(words.split(' ')).run();
        assert_eq!(outcome.code, Some(3), "{words}: {outcome}");
        let told = outcome.stdout.clone() + &outcome.stderr;
        assert!(told.contains("another log follows"), "{words}: {outcome}");
        assert!(
            !told.contains("no messages are missing"),
            "{words}: {outcome}"
        );
    }
    for log in ["ok.mcap", "ok_2.mcap"] {
        let outcome = sandbox.protean(["verify", log, "--in-process"]).run();
        assert_eq!(outcome.code, Some(0), "{log}: {outcome}");
    }
}

#[test]
fn what_is_left_of_a_truncated_log_is_recovered_and_read_by_python() {
    let sandbox = Sandbox::new();
    sandbox.record("chase_exact");
    let bytes = std::fs::read(sandbox.path().join("run.mcap")).unwrap();
    let summary = mcap::Summary::read(&bytes).unwrap().unwrap();
    let starts = summary.chunk_indexes.iter().map(|i| i.chunk_start_offset);
    let last = starts.max().unwrap() as usize;
    sandbox.file("cut.mcap", &bytes[..last + 20]);
    let info = sandbox.protean(["info", "cut.mcap"]).run();
    assert_eq!(info.code, Some(3), "{info}");
    for words in [
        "INCOMPLETE",
        "ends in the middle",
        "the run did not reach its end",
    ] {
        assert!(info.stdout.contains(words), "{words}: {info}");
    }
    let recovered = sandbox
        .protean(["recover", "cut.mcap", "--out", "ok.mcap", "--json"])
        .run();
    assert_eq!(recovered.code, Some(3), "{recovered}");
    assert!(recovered.stderr.contains("is incomplete"), "{recovered}");
    let path = sandbox.path().join("ok.mcap");
    let history = History::read(&path);
    let messages: u64 = history.counts.values().map(|(messages, _)| messages).sum();
    assert_eq!(recovered.json()["messages"], messages);
    assert!(!history.states.is_empty());
    if let Some(read) = python::read(&path) {
        assert_eq!(read.history, history);
    }
    // It goes as far as the log: then it is the same.
    let rerun = sandbox
        .protean(["verify", "ok.mcap", "--in-process", "--quiet"])
        .run();
    assert_eq!(rerun.code, Some(3), "{rerun}");
    assert!(rerun.stdout.contains("identical up to tick"), "{rerun}");
}

#[test]
fn tables_of_a_log() {
    let sandbox = Sandbox::new();
    sandbox.record("chase_exact");
    let tables = sandbox
        .protean(["export", "run.mcap", "--out", "tables"])
        .json();
    let states = History::read(&sandbox.path().join("run.mcap")).states;
    let rows: usize = states.iter().map(|state| state.robots.len()).sum();
    assert_eq!(tables["tables"]["world/state"]["rows"], rows);
    let text = std::fs::read_to_string(sandbox.path().join("tables/world.state.csv")).unwrap();
    assert_eq!(text.lines().count(), rows + 1);
}

#[test]
fn a_file_that_another_program_compressed_with_lz4_is_read() {
    let sandbox = Sandbox::new();
    let path = sandbox.path().join("lz4.mcap");
    let Some(written) = python::call::<Json>("write_lz4.py", &path) else {
        return;
    };
    let info = sandbox.protean(["info", "lz4.mcap"]).json();
    let count = &written["messages"];
    assert_eq!(info["topics"]["/count"]["messages"], *count, "{info}");
    let condition = &info["condition"];
    assert!(
        condition["chunks"]["lz4"]["count"].as_u64() > Some(2),
        "{info}"
    );
    assert_eq!(
        (&condition["complete"], &condition["chunks_lost"]),
        (&true.into(), &0.into()),
        "{info}"
    );
    sandbox
        .protean(["export", "lz4.mcap", "--out", "tables"])
        .json();
    let text = std::fs::read_to_string(sandbox.path().join("tables/count.csv")).unwrap();
    let numbers = text.lines().skip(1).map(|row| {
        let (_, number) = row.rsplit_once(',').unwrap();
        number.parse::<u64>().unwrap()
    });
    assert!(numbers.eq(0..count.as_u64().unwrap()), "{text}");
}

#[test]
fn what_is_not_a_log_or_cannot_be_done_is_refused() {
    let sandbox = Sandbox::new();
    sandbox.file("empty.mcap", "");
    sandbox.file("text.mcap", "hello, world");
    let before = sandbox.files();
    for (name, words) in [
        ("nope.mcap", "No such file"),
        ("empty.mcap", "it is empty"),
        ("text.mcap", "not an MCAP file"),
    ] {
        for command in [
            &["info"][..],
            &["verify"],
            &["recover", "--out", "x.mcap"],
            &["export", "--out", "x"],
        ] {
            let outcome = sandbox.protean(command.iter().copied()).arg(name).run();
            outcome.refused(2, &["error: ", name, words]);
            assert_eq!(sandbox.files(), before, "{command:?} {name}");
        }
    }
    sandbox.record_in_real_time("rt.mcap");
    let outcome = sandbox.protean(["verify", "rt.mcap"]).run();
    outcome.refused(2, &["rt.mcap", "recorded in real time"]);
}

#[test]
fn the_messages_of_a_log_are_printed_as_lines_of_json() {
    let sandbox = Sandbox::new();
    let summary = sandbox.record("chase_exact");
    let printed = |words: &[&str]| {
        let words = ["cat", "run.mcap"].into_iter().chain(words.iter().copied());
        let outcome = sandbox.protean(words).run();
        assert_eq!(outcome.code, Some(0), "{outcome}");
        assert_eq!(outcome.stderr, "", "{outcome}");
        let lines = outcome.stdout.lines();
        let lines = lines.map(|line| serde_json::from_str::<Json>(line).unwrap());
        lines.collect::<Vec<Json>>()
    };
    let all = printed(&[]);
    let history = History::read(&sandbox.path().join("run.mcap"));
    let counts: u64 = history.counts.values().map(|(messages, _)| messages).sum();
    assert_eq!(all.len() as u64, counts);
    let states: Vec<&Json> = all.iter().filter(|l| l["topic"] == "world/state").collect();
    assert_eq!(states.len(), history.states.len());
    for (line, state) in states.iter().zip(&history.states) {
        let message = &line["message"];
        assert_eq!(message["stamp"]["tick"], state.tick);
        let robots = message["robots"].as_array().unwrap();
        assert_eq!(robots.len(), state.robots.len());
        for (robot, expected) in robots.iter().zip(&state.robots) {
            assert_eq!(robot["x"].as_f64(), Some(expected.x));
        }
    }
    let drawn = all.iter().find(|l| l["topic"] == "/robots").unwrap();
    assert_eq!(drawn["message"]["markers"][1]["ns"], "body", "{drawn}");

    let part = ["--topics", "world/*", "--start", "0.5", "--end", "1"];
    for line in printed(&part) {
        let time = line["log_time_s"].as_f64().unwrap();
        assert!((0.5..=1.0).contains(&time), "{line}");
        assert!(line["topic"].as_str().unwrap().starts_with("world/"));
    }
    assert_eq!(printed(&["--limit", "3"]), all[..3]);
    let refused = sandbox.protean(["cat", "run.mcap", "--topics", "nope"]);
    refused.run().refused(2, &["nope"]);

    let pipe = ["-c", "\"$@\" | head -n 1", "sh"];
    let head = sandbox.protean(["cat", "run.mcap"]).through("sh", &pipe);
    let head = head.run();
    assert_eq!((head.code, head.stdout.lines().count()), (Some(0), 1));
    assert_eq!(head.stderr, "", "a closed pipe is not an error");
    assert!(summary["ticks"].as_u64() > Some(0));
}
