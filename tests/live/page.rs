//! Runs and replays that a browser shows.

use std::io::{BufRead as _, BufReader, Read as _, Write as _};
use std::net::{Shutdown, TcpListener, TcpStream};
use std::path::Path;
use std::time::Instant;

use serde_json::{Value as Json, json};

use super::{LIMIT, Watched};
use crate::support::Sandbox;
use crate::support::browser::browse;
use crate::support::history::History;

/// A connection that has asked for a path with these header lines.
pub fn ask(address: &str, path: &str, lines: &str) -> TcpStream {
    request(address, "GET", path, lines, "")
}

/// A connection that has sent a request with these header lines and this body.
pub fn request(address: &str, method: &str, path: &str, lines: &str, body: &str) -> TcpStream {
    let mut stream = TcpStream::connect(address).unwrap();
    stream.set_read_timeout(Some(LIMIT)).unwrap();
    // In two parts, as a slow network delivers it.
    let request = format!("{method} {path} HTTP/1.1\r\nHost: {address}\r\n{lines}\r\n{body}");
    let (first, second) = request.split_at(7);
    stream.write_all(first.as_bytes()).unwrap();
    stream.write_all(second.as_bytes()).unwrap();
    stream
}

/// The status and the rest of an answer.
pub fn answer(mut stream: TcpStream) -> (String, String) {
    let mut text = String::new();
    stream.read_to_string(&mut text).unwrap();
    let (head, body) = text.split_once("\r\n\r\n").unwrap();
    let status = head.split(' ').nth(1).unwrap().to_owned();
    (status, body.to_owned())
}

/// The states of the data that a stream sends, up to the last.
fn states(stream: TcpStream) -> Vec<Json> {
    let lines = BufReader::new(stream).lines().map(Result::unwrap);
    let data = lines.filter(|line| line.starts_with('{'));
    data.map(|line| serde_json::from_str(&line).unwrap())
        .collect()
}

pub fn token<'a>(run: &'a Watched<'_>) -> &'a str {
    run.url.rsplit('/').next().unwrap()
}

#[test]
fn pages_of_other_origins_and_without_the_token_are_refused() {
    let sandbox = Sandbox::new();
    let run = Watched::start(&sandbox, &["--quiet"]);
    let path = format!("/{}", token(&run));
    let (status, page) = answer(ask(run.address(), "/", ""));
    assert_eq!(status, "200");
    assert!(page.len() < 1_000_000, "{} bytes", page.len());
    assert!(page.starts_with("<!doctype html>") && page.trim_end().ends_with("</html>"));
    assert!(page.contains("default-src 'none'") && page.contains("connect-src 'self'"));
    assert!(!page.contains(token(&run)), "it holds no secret");
    let evil = "Origin: https://evil.example\r\n";
    let wrong = format!("/{}", "0".repeat(32));
    for (path, lines) in [("/x", ""), (&*wrong, ""), ("//", ""), (&*path, evil)] {
        let (status, words) = answer(ask(run.address(), path, lines));
        assert_eq!(status, "403", "{path} {lines}");
        assert!(
            words.contains("token") || words.contains("origin"),
            "{words}"
        );
    }
    let own = format!("Origin: http://{}\r\n", run.address());
    let mut lines = BufReader::new(ask(run.address(), &path, &own)).lines();
    assert_eq!(lines.next().unwrap().unwrap(), "HTTP/1.1 200 OK");
    drop(lines);
    run.interrupt();
    assert_eq!(run.finish().0, Some(3));
    sandbox.assert_nothing_left();
}

#[test]
fn a_run_with_five_pages_has_the_digest_of_one_without() {
    let sandbox = Sandbox::new();
    let run = Watched::start(&sandbox, &["--set", "rules.time_limit=6"]);
    let path = format!("/{}", token(&run));
    // Never read.
    let _silent = ask(run.address(), &path, "");
    let asked = Instant::now();
    let mut first = BufReader::new(ask(run.address(), &path, ""));
    let mut line = String::new();
    while !line.starts_with('{') {
        line.clear();
        first.read_line(&mut line).unwrap();
    }
    let took = asked.elapsed();
    let pages: Vec<_> = (0..3)
        .map(|_| {
            let stream = ask(run.address(), &path, "");
            std::thread::spawn(move || states(stream))
        })
        .collect();
    // Leaves in the middle.
    drop(first);
    let alone = sandbox
        .protean(["run", "chase", "--out", "alone.mcap"])
        .set("rules.time_limit=6")
        .json();
    for page in pages {
        let states = page.join().unwrap();
        let times: Vec<f64> = states
            .iter()
            .map(|state| state["facts"]["live"]["now_s"].as_f64().unwrap())
            .collect();
        assert!(
            times.len() > 1 && times[0] < 6.0,
            "{times:?} after {took:?}"
        );
        assert!(times.is_sorted(), "{times:?}");
        let (last, before) = states.split_last().unwrap();
        for state in before {
            assert_eq!(state["facts"]["live"]["ended"], false);
            assert_eq!(state["facts"]["missing"], json!([]));
        }
        assert_eq!(last["facts"]["live"]["ended"], true);
        assert_eq!(last["facts"]["digest"], alone["digest"]);
        assert_eq!(last["facts"]["outcome"], alone["robots"]);
        assert_eq!(last["facts"]["missing"], json!([]));
    }
    let (code, output) = run.finish();
    assert_eq!(code, Some(0), "{output}");
    assert!(output.contains("live: 5 viewers"), "{output}");
    sandbox.assert_nothing_left();
}

#[test]
fn a_replay_shows_the_log_up_to_its_time() {
    let sandbox = Sandbox::new();
    let run = sandbox
        .protean(["run", "chase", "--out", "run.mcap"])
        .set("rules.time_limit=4")
        .json();
    let replay = Watched::replay(&sandbox, "run.mcap", &["--start", "2"]);
    let states = states(ask(replay.address(), &format!("/{}", token(&replay)), ""));
    let now = |state: &Json| state["facts"]["live"]["now_s"].as_f64().unwrap();
    // Before it begins, its time is 0.
    let first = states.iter().find(|state| now(state) > 0.0).unwrap();
    assert!((2.0..3.0).contains(&now(first)), "{}", now(first));
    for state in &states {
        let end_s = state["facts"]["end_s"].as_f64().unwrap();
        assert!(end_s <= now(state) + 1e-6, "{end_s}");
    }
    assert_eq!(
        first["facts"]["digest"],
        Json::Null,
        "no result before the end"
    );
    let last = states.last().unwrap();
    assert_eq!(last["facts"]["live"]["ended"], true);
    assert_eq!(last["facts"]["end_s"], 4.0);
    assert_eq!(last["facts"]["digest"], run["digest"]);
    assert_eq!(replay.finish().0, Some(0));
    sandbox.assert_nothing_left();
}

#[test]
fn a_page_grows_with_its_run_and_looks_back_meanwhile() {
    let sandbox = Sandbox::new();
    let run = Watched::start(
        &sandbox,
        &["--set", "rules.time_limit=25", "--set", "run.seed=3"],
    );
    let grows = "protean.end_s > window.from + 0.3";
    let mark = "void (window.from = protean.end_s)";
    let steps = json!([
        { "eval": "[protean.isRunning, protean.follows, document.getElementById('live-state').textContent]" },
        { "eval": mark },
        { "until": grows },
        { "eval": "[protean.follows, protean.t > window.from - 0.1]" },
        { "eval": "document.getElementById('layer-trails').click(), document.getElementById('zoom-in').click()" },
        { "key": " " },
        { "eval": "protean.seek(0.5), [protean.playing, protean.follows]" },
        { "eval": mark },
        { "until": grows },
        { "eval": "protean.at(0.5)" },
        { "eval": "[protean.t, document.getElementById('layer-trails').checked, document.getElementById('scrub').max > 1]" },
        { "eval": "document.getElementById('live').click(), [protean.playing, protean.follows]" },
        { "eval": mark },
        { "until": grows },
        { "eval": "protean.t > window.from - 0.1" },
        { "until": "!protean.isRunning && !protean.playing && document.getElementById('live-state').textContent === 'ended'" },
        { "eval": "[protean.digest, protean.missing, protean.outcome.length]" },
        { "eval": "protean.t === protean.end_s" },
        { "eval": "location.hash" },
    ]);
    let Some(found) = browse(Path::new(&run.page()), &steps) else {
        return;
    };
    assert_eq!(found["errors"], json!([]), "errors of the browser");
    let own = format!("http://{}/", run.address());
    for request in found["requests"].as_array().unwrap() {
        let request = request.as_str().unwrap();
        assert!(
            request.starts_with(&own) || request.starts_with("data:"),
            "{request}"
        );
    }
    let mut answers = found["answers"].as_array().unwrap().iter();
    let mut next = || answers.next().unwrap();
    assert_eq!(next(), &json!([true, true, "live"]));
    next();
    assert_eq!(
        (next(), next()),
        (&json!(true), &json!([true, true])),
        "it follows the run"
    );
    next();
    assert_eq!(next(), &json!([false, false]), "it looks back");
    next();
    assert_eq!(next(), &json!(true), "the mission goes on meanwhile");
    let history = History::read(&sandbox.path().join("run.mcap"));
    let shown = next();
    let state = history
        .states
        .iter()
        .find(|state| Some(state.tick) == shown["tick"].as_u64())
        .unwrap();
    for (shown, robot) in shown["robots"]
        .as_array()
        .unwrap()
        .iter()
        .zip(&state.robots)
    {
        let off = (shown["x"].as_f64().unwrap() - robot.x).abs();
        assert!(off <= 0.000_501, "{shown}");
    }
    assert_eq!(
        next(),
        &json!([0.5, false, true]),
        "what the reader has set stays"
    );
    assert_eq!(next(), &json!([true, true]));
    next();
    assert_eq!(
        (next(), next()),
        (&json!(true), &json!(true)),
        "it follows again"
    );
    next();
    let (code, output) = run.finish();
    assert_eq!(code, Some(0), "{output}");
    let info = sandbox.protean(["info", "run.mcap"]).json();
    let ended = next();
    assert_eq!(ended[0], info["digest"]);
    assert_eq!(ended[1], json!([]));
    assert_eq!(
        ended[2].as_u64(),
        Some(history.states[0].robots.len() as u64)
    );
    assert_eq!(next(), &json!(true), "it ends at the end");
    assert_eq!(next().as_str().unwrap().len(), 33, "the address stays");
    sandbox.assert_nothing_left();
}

/// Lines of the head of an answer and of a few states of the data.
const CUT_AFTER: usize = 12;

/// Forwards connections to an address; cuts the first that asks for this path, after [`CUT_AFTER`] lines of the answer. Returns its
/// own address.
fn breaking_proxy(to: &str, path: &str) -> String {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let own = listener.local_addr().unwrap().to_string();
    let (to, path) = (to.to_owned(), format!("GET {path} "));
    std::thread::spawn(move || {
        let mut is_cut = false;
        for client in listener.incoming() {
            let (mut client, mut first) = (client.unwrap(), [0; 4096]);
            let read = client.read(&mut first).unwrap_or(0);
            let Ok(mut server) = TcpStream::connect(&to) else {
                return;
            };
            server.write_all(&first[..read]).unwrap();
            let cuts = !is_cut && first.starts_with(path.as_bytes());
            is_cut |= cuts;
            std::thread::spawn(move || {
                let (mut part, mut lines) = ([0; 4096], 0);
                while let Ok(read @ 1..) = server.read(&mut part) {
                    lines += part[..read].split(|byte| *byte == b'\n').count() - 1;
                    if client.write_all(&part[..read]).is_err() || cuts && lines >= CUT_AFTER {
                        break;
                    }
                }
                let _ = client.shutdown(Shutdown::Both);
            });
        }
    });
    own
}

#[test]
fn a_page_whose_connection_breaks_goes_on() {
    let sandbox = Sandbox::new();
    let run = Watched::start(
        &sandbox,
        &["--set", "rules.time_limit=15", "--set", "run.seed=3"],
    );
    let path = format!("/{}", token(&run));
    let own = breaking_proxy(run.address(), &path);
    let page = run.page().replace(run.address(), &own);
    let state = "document.getElementById('live-state').textContent";
    let steps = json!([
        { "until": format!("{state} === 'ended'") },
        { "eval": "protean.digest" },
    ]);
    let Some(found) = browse(Path::new(&page), &steps) else {
        return;
    };
    assert_eq!(run.finish().0, Some(0));
    let info = sandbox.protean(["info", "run.mcap"]).json();
    assert_eq!(found["answers"][1], info["digest"]);
    // Not by what the page says meanwhile: that lasts for a second, which a busy browser may miss.
    let requests = found["requests"].as_array().unwrap().iter();
    let of_data = requests.filter(|url| url.as_str().unwrap().ends_with(&path));
    assert!(of_data.count() >= 2, "{found}");
    sandbox.assert_nothing_left();
}
