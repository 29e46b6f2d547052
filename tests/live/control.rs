//! Runs and replays that a page controls, and branches that it asks for.

use std::collections::BTreeSet;
use std::io::{BufRead as _, BufReader};
use std::net::TcpStream;
use std::path::Path;

use runtime::lockstep::TickBarrier;
use serde_json::{Value as Json, json};

use super::Watched;
use super::page::{answer, ask, request, token};
use crate::support::browser::browse;
use crate::support::{SOON, Sandbox, until};

/// Sends an order with the token and these header lines.
fn send(run: &Watched<'_>, lines: &str, order: &str) -> TcpStream {
    let path = format!("/{}", token(run));
    let lines = format!("Content-Length: {}\r\n{lines}", order.len());
    request(run.address(), "POST", &path, &lines, order)
}

/// The tick barrier of the run after those known.
fn barrier(sandbox: &Sandbox, known: &BTreeSet<String>) -> TickBarrier {
    let prefix = Sandbox::prefix(&sandbox.next_run(known));
    until("the tick barrier", SOON, || TickBarrier::open(&prefix).ok())
}

/// The answer to an order, which is obeyed.
#[track_caller]
fn order(run: &Watched<'_>, order: &Json) -> Json {
    let (status, words) = answer(send(run, "", &order.to_string()));
    assert_eq!(status, "200", "{order}: {words}");
    serde_json::from_str(&words).unwrap()
}

/// Asserts that an order is refused with a status and words.
#[track_caller]
fn refused(stream: TcpStream, status: &str, words: &str) {
    let (found, body) = answer(stream);
    assert_eq!(found, status, "{body}");
    assert!(body.contains(words), "{body}");
}

#[test]
fn orders_without_the_flag_or_the_token_or_of_other_origins_have_no_effect() {
    let sandbox = Sandbox::new();
    let run = Watched::start(&sandbox, &["--quiet"]);
    refused(
        send(&run, "", "\"pause\""),
        "403",
        "start it with --control",
    );
    run.interrupt();
    assert_eq!(run.finish().0, Some(3));
    let words = ["--quiet", "--force", "--control"];
    let run = Watched::start(&sandbox, &words);
    let without = |path: &str| {
        request(
            run.address(),
            "POST",
            path,
            "Content-Length: 7\r\n",
            "\"pause\"",
        )
    };
    refused(without("/"), "403", "token");
    refused(without(&format!("/{}", "0".repeat(32))), "403", "token");
    refused(
        send(&run, "Origin: https://evil.example\r\n", "\"pause\""),
        "403",
        "origin",
    );
    refused(send(&run, "", "\"stop\""), "422", "expected");
    refused(
        send(&run, "", "{\"pace\":0}"),
        "422",
        "pace is 0: expected a factor",
    );
    refused(
        send(&run, "", "{\"branch\":{\"at_s\":1}}"),
        "422",
        "the run goes on",
    );
    // A GET gives no orders.
    let state = order(&run, &json!({ "pace": 2.0 }));
    assert_eq!(state, json!({ "paused": false, "steps": 0, "pace": 2.0 }));
    run.interrupt();
    let (code, output) = run.finish();
    assert_eq!(code, Some(3), "{output}");
    sandbox.assert_nothing_left();
    sandbox
        .protean(["run", "chase", "--live", "0", "--control", "--set"])
        .arg("run.mode=\"real_time\"")
        .run()
        .refused(2, &["--control", "expected lock_step"]);
}

#[test]
fn a_run_that_is_paused_stepped_and_paced_has_the_history_of_one_without() {
    let sandbox = Sandbox::new();
    // A pause is longer than the time after which a process counts as hung.
    let set = [
        "--set",
        "rules.time_limit=6",
        "--set",
        "run.hang_timeout_s=1",
    ];
    let run = Watched::start(&sandbox, &[&["--control"], &set[..]].concat());
    let barrier = barrier(&sandbox, &BTreeSet::new());
    let path = format!("/{}", token(&run));
    let mut page = BufReader::new(ask(run.address(), &path, ""));
    assert_eq!(order(&run, &json!("pause"))["paused"], true);
    // The simulator counts its waits, ten a second.
    let waits = |more: u64| {
        let from = barrier.ticks_done(0);
        until("waits of the simulator", SOON, || {
            (barrier.ticks_done(0) >= from + more).then_some(())
        });
    };
    waits(3);
    let held = barrier.ticks_posted();
    waits(15);
    assert_eq!(barrier.ticks_posted(), held, "the world is held");
    let mut line = String::new();
    while !line.contains("\"paused\":true") {
        line.clear();
        page.read_line(&mut line).unwrap();
    }
    for step in 1..=3 {
        order(&run, &json!("step"));
        until("a step", SOON, || {
            (barrier.ticks_posted() >= held + step).then_some(())
        });
        waits(3);
        assert_eq!(barrier.ticks_posted(), held + step);
    }
    // Once the last page has left, it goes on after ten seconds.
    drop(page);
    until("the run to go on", SOON, || {
        (barrier.ticks_posted() > held + 3).then_some(())
    });
    order(&run, &json!("pause"));
    order(&run, &json!({ "pace": 1000.0 }));
    order(&run, &json!("go"));
    until("the end", SOON, || barrier.is_over().then_some(()));
    drop(barrier);
    // The page stays until Ctrl-C.
    let ended = until("the end on a page", SOON, || {
        let mut lines = BufReader::new(ask(run.address(), &path, "")).lines();
        lines.find_map(|line| Some(line.ok()?).filter(|line| line.contains("\"ended\":true")))
    });
    let ended: Json = serde_json::from_str(&ended).unwrap();
    run.interrupt();
    let (code, output) = run.finish();
    assert_eq!(code, Some(0), "{output}");
    assert!(output.contains("until Ctrl-C"), "{output}");
    let alone = sandbox
        .protean(["run", "chase", "--out", "alone.mcap"])
        .set("rules.time_limit=6")
        .json();
    assert_eq!(ended["facts"]["digest"], alone["digest"]);
    sandbox.assert_nothing_left();
}

#[test]
fn the_page_pauses_and_steps_a_replay() {
    let sandbox = Sandbox::new();
    sandbox
        .protean(["run", "chase", "--out", "run.mcap"])
        .set("rules.time_limit=20")
        .json();
    let known = sandbox.runs();
    let replay = Watched::replay(&sandbox, "run.mcap", &["--control"]);
    let ticks = barrier(&sandbox, &known);
    let page = ask(replay.address(), &format!("/{}", token(&replay)), "");
    order(&replay, &json!("pause"));
    // Held, it does not go on at any pace.
    order(&replay, &json!({ "pace": 1000.0 }));
    let held = ticks.ticks_posted();
    for step in 1..=20 {
        order(&replay, &json!("step"));
        until("a step", SOON, || {
            (ticks.ticks_posted() >= held + step).then_some(())
        });
    }
    // One tick may have been under way.
    assert!(ticks.ticks_posted() <= held + 21);
    order(&replay, &json!({ "pace": 1.0 }));
    order(&replay, &json!("go"));
    drop((ticks, page));
    let steps = json!([
        // The first data may be older than the last order.
        { "until": "!document.getElementById('world').hidden && document.getElementById('pace').value === '1'" },
        { "key": "h" },
        { "until": "document.getElementById('hold').textContent === 'Resume run'" },
        { "eval": "void (window.from = protean.end_s)" },
        { "eval": "document.getElementById('step').click()" },
        { "until": "protean.end_s > window.from" },
        { "key": ">" },
        { "until": "document.getElementById('pace').value === '2'" },
        { "eval": "const pace = document.getElementById('pace'); pace.value = '1000'; pace.dispatchEvent(new Event('change'))" },
        { "until": "document.getElementById('pace').value === '1000'" },
        { "key": "h" },
        { "until": "!protean.isRunning && document.getElementById('live-state').textContent === 'ended'" },
        { "eval": "document.getElementById('world').hidden" },
    ]);
    let Some(found) = browse(Path::new(&replay.page()), &steps) else {
        return;
    };
    assert_eq!(found["errors"], json!([]), "errors of the browser");
    let answers = &found["answers"];
    let shown = answers.as_array().unwrap().last();
    assert_eq!(shown, Some(&json!(true)), "{answers}");
    replay.interrupt();
    assert_eq!(replay.finish().0, Some(0));
    sandbox.assert_nothing_left();
}

#[test]
fn a_replay_that_begins_again_answers_what_if_beside_it() {
    let sandbox = Sandbox::new();
    sandbox
        .protean(["run", "chase", "--out", "run.mcap"])
        .set("rules.time_limit=3")
        .json();
    let known = sandbox.runs();
    let words = ["--control", "--loop", "--pace", "4"];
    let replay = Watched::replay(&sandbox, "run.mcap", &words);
    // The server has the log by then.
    drop(barrier(&sandbox, &known));
    let branch = json!({ "branch": { "at_s": 1, "set": ["teams.police.limits.v_max=0.2"] } });
    let made = order(&replay, &branch);
    assert_eq!(made["run"]["facts"]["end_s"], 3.0);
    // The page has received newer data meanwhile.
    let lines = "(async () => { const reader = (await fetch('/' + location.hash.slice(1), { cache: 'no-store' })).body.getReader(); \
                 for (let n = 0; n < 3;) n += (await reader.read()).value.filter((byte) => byte === 10).length; \
                 await reader.cancel(); })()";
    let state = "[protean.runs.length, protean.isRunning, protean.t]";
    let until_whole = "protean.isRunning && protean.end_s === 3 && protean.digest";
    let value = "document.getElementById('what-if-set').value = 'teams.police.limits.v_max=0.2'";
    let steps = json!([
        { "until": until_whole },
        { "eval": format!("protean.pause(), protean.seek(1), {value}") },
        { "eval": "document.getElementById('go-on').click()" },
        { "until": "protean.runs.length === 2" },
        { "eval": lines },
        { "eval": state },
        { "eval": "protean.runs[1].digest" },
        { "key": "l" },
        { "until": "protean.runs.length === 1 && protean.isRunning && protean.follows" },
        { "eval": "void (window.from = protean.drawn)" },
        { "until": "protean.drawn > window.from + 20" },
        { "eval": "document.getElementById('world').hidden" },
    ]);
    let Some(found) = browse(Path::new(&replay.page()), &steps) else {
        return;
    };
    assert_eq!(found["errors"], json!([]), "errors of the browser");
    let answers = &found["answers"];
    assert_eq!(answers[5], json!([2, false, 1]), "{answers}");
    assert_eq!(answers[6], made["made"]["digest"], "{answers}");
    assert_eq!(answers[10], false, "{answers}");
    replay.interrupt();
    assert_eq!(replay.finish().0, Some(3));
    sandbox.assert_nothing_left();
}

#[test]
fn a_robot_that_is_dragged_makes_the_branch_of_the_printed_command() {
    let sandbox = Sandbox::new();
    let words = ["--control", "--pace", "1000", "--set", "rules.time_limit=6"];
    let run = Watched::start(&sandbox, &words);
    let at = |name: &str| format!("protean.at(2).robots.find((robot) => robot.name === '{name}')");
    let screen = "const box = document.getElementById('map').getBoundingClientRect(), v = protean.view; \
                  const px = (x, y) => [box.left + v.width / 2 + (x - v.x) * v.scale, box.top + v.height / 2 - (y - v.y) * v.scale]";
    let made = "document.getElementById('what-if-made')";
    let go = "document.getElementById('go-on').click()";
    let set = "document.getElementById('what-if-set').value";
    let steps = json!([
        { "until": "!document.getElementById('what-if').hidden" },
        { "eval": "protean.pause(), protean.seek(2)" },
        { "drag": format!("(() => {{ {screen}; const r = {}; return [...px(r.x, r.y), ...px(1.5, -1.5)]; }})()", at("police_1")) },
        { "eval": "document.getElementById('what-if-change').textContent" },
        { "eval": go },
        { "until": format!("{made}.textContent.includes('digest')") },
        { "eval": format!("[protean.runs.length, protean.runs[1].digest, {made}.querySelector('code').textContent, protean.t]") },
        { "eval": "protean.runs[1].at(2).robots[0]" },
        { "eval": format!("{set} = 'rules.nothing=1'; {go}") },
        { "until": format!("{made}.textContent.includes('rules.nothing')") },
        { "eval": "document.getElementById('what-if-clear').click(), protean.runs.length" },
    ]);
    let Some(found) = browse(Path::new(&run.page()), &steps) else {
        return;
    };
    // The refused order is an error of the browser's network, not of the page.
    let errors = found["errors"].as_array().unwrap();
    assert!(
        errors.iter().all(|error| error.to_string().contains("422")),
        "{errors:?}"
    );
    let answers = &found["answers"];
    assert_eq!(answers[1], Json::Null);
    let text = answers[2].as_str().unwrap();
    assert!(
        text.starts_with("From 2.00 s on, with police_1=1."),
        "{text}"
    );
    let [count, digest, command, time] = &answers[5].as_array().unwrap()[..] else {
        panic!("{answers}")
    };
    assert_eq!((count, time), (&json!(2), &json!(2)));
    let place = &answers[6];
    for (axis, wanted) in [("x", 1.5), ("y", -1.5)] {
        let off = place[axis].as_f64().unwrap() - wanted;
        // A pixel, and the resolution of the page.
        assert!(off.abs() < 0.05, "{place}");
    }
    assert_eq!(answers[9], 1, "{answers}");
    let words = command.as_str().unwrap().strip_prefix("protean ").unwrap();
    let again = sandbox.protean(words.split(' ')).arg("--json").run();
    assert_eq!(again.code, Some(0), "{again}");
    assert_eq!(&again.json()["branch_digest"], digest);
    // One at a time.
    let branch = json!({ "branch": { "at_s": 1, "set": ["teams.police.limits.v_max=0.2"] } });
    let both = [(); 2].map(|()| send(&run, "", &branch.to_string()));
    let mut codes = both.map(answer);
    codes.sort();
    assert_eq!(codes[0].0, "200", "{}", codes[0].1);
    assert_eq!(codes[1].0, "422");
    assert!(codes[1].1.contains("one at a time"), "{}", codes[1].1);
    run.interrupt();
    assert_eq!(run.finish().0, Some(0));
    sandbox.assert_nothing_left();
}
