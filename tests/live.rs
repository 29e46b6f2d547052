//! Runs that are watched: real connections to the real program.

mod control;
mod page;
mod replay;

use std::collections::BTreeMap;
use std::io::{BufRead as _, BufReader};
use std::net::TcpStream;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::sync::Arc;
use std::time::{Duration, Instant};

use rustix::process::Signal;
use serde_json::{Value as Json, json};
use tungstenite::client::IntoClientRequest as _;
use tungstenite::http::StatusCode;
use tungstenite::{Error, HandshakeError, Message, WebSocket};

use crate::support::call::PATIENCE;
use crate::support::{PROTEAN, Sandbox};

/// Longest that anything here may take.
const LIMIT: Duration = Duration::from_secs(120);

/// A run that serves viewers; killed if the test ends first.
pub struct Watched<'a> {
    sandbox: &'a Sandbox,
    child: Child,
    url: String,
    /// The rest of its output.
    output: Option<std::thread::JoinHandle<String>>,
}

impl<'a> Watched<'a> {
    /// Starts a run with `--live 0` and these words, and waits for its address.
    pub fn start(sandbox: &'a Sandbox, words: &[&str]) -> Self {
        let run = ["run", "chase", "--live", "0", "--out", "run.mcap"];
        let words = [&run[..], &["--set", PATIENCE], words].concat();
        Self::start_with(sandbox, &words)
    }

    /// Starts a replay of a log with `--live 0` and these words, and waits for its address.
    pub fn replay(sandbox: &'a Sandbox, log: &str, words: &[&str]) -> Self {
        let words = [&["replay", log, "--live", "0"], words].concat();
        Self::start_with(sandbox, &words)
    }

    fn start_with(sandbox: &'a Sandbox, words: &[&str]) -> Self {
        let mut child = Command::new(PROTEAN)
            .args(words)
            .current_dir(sandbox.path())
            .env("XDG_RUNTIME_DIR", sandbox.runtime_dir())
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let mut lines = BufReader::new(child.stderr.take().unwrap()).lines();
        let mut before = String::new();
        let url = loop {
            let line = lines
                .next()
                .unwrap_or_else(|| panic!("no address: {before}"));
            let line = line.unwrap();
            if let Some(url) = line.strip_prefix("live: ws://") {
                break format!("ws://{url}");
            }
            before += &line;
        };
        let output =
            std::thread::spawn(move || lines.map_while(Result::ok).collect::<Vec<_>>().join("\n"));
        Self {
            sandbox,
            child,
            url,
            output: Some(output),
        }
    }

    /// The address that viewers connect to.
    pub fn url(&self) -> &str {
        &self.url
    }

    /// The address of the page in a browser.
    fn page(&self) -> String {
        let token = self.url.rsplit('/').next().unwrap();
        format!("http://{}/#{token}", self.address())
    }

    /// Ends it as Ctrl-C does.
    pub fn interrupt(&self) {
        crate::support::sandbox::signal(self.child.id(), Signal::INT);
    }

    /// `127.0.0.1:PORT`.
    fn address(&self) -> &str {
        let rest = self.url.strip_prefix("ws://").unwrap();
        rest.split_once('/').unwrap().0
    }

    /// Waits for its end; its code, and what it output.
    pub fn finish(mut self) -> (Option<i32>, String) {
        let deadline = Instant::now() + LIMIT;
        let status = loop {
            if let Some(status) = self.child.try_wait().unwrap() {
                break status;
            }
            assert!(Instant::now() < deadline, "the run does not end");
            std::thread::sleep(Duration::from_millis(10));
        };
        let output = self.output.take().unwrap().join().unwrap();
        (status.code(), output)
    }
}

impl Drop for Watched<'_> {
    fn drop(&mut self) {
        if self.output.is_some() {
            let _ = self.child.kill();
            let _ = self.child.wait();
            self.sandbox.kill_all();
        }
    }
}

/// A viewer's end of the connection.
struct Viewer(WebSocket<TcpStream>);

impl Viewer {
    /// Connects to an address, with or without an origin; the status if it is refused.
    fn connect(url: &str, origin: Option<&str>, protocol: &str) -> Result<Self, StatusCode> {
        let mut request = url.into_client_request().unwrap();
        let headers = request.headers_mut();
        headers.insert("sec-websocket-protocol", protocol.parse().unwrap());
        if let Some(origin) = origin {
            headers.insert("origin", origin.parse().unwrap());
        }
        let host = url.strip_prefix("ws://").unwrap();
        let stream = TcpStream::connect(host.split('/').next().unwrap()).unwrap();
        stream.set_read_timeout(Some(LIMIT)).unwrap();
        match tungstenite::client(request, stream) {
            Ok((socket, response)) => {
                assert_eq!(response.headers()["sec-websocket-protocol"], protocol);
                Ok(Self(socket))
            }
            Err(HandshakeError::Failure(Error::Http(response))) => Err(response.status()),
            Err(error) => panic!("{error}"),
        }
    }

    fn say(&mut self, text: &Json) {
        self.0.send(Message::text(text.to_string())).unwrap();
    }

    /// The next message; `None` when the server has closed the connection.
    fn receive(&mut self) -> Option<Received> {
        loop {
            match self.0.read() {
                Ok(Message::Text(text)) => {
                    return Some(Received::Text(serde_json::from_str(&text).unwrap()));
                }
                Ok(Message::Binary(bytes)) => return Some(Received::from_bytes(&bytes)),
                Ok(Message::Close(_)) | Err(Error::ConnectionClosed) => return None,
                Ok(_) => {}
                Err(error) => panic!("{error}"),
            }
        }
    }

    /// The first words: what the server is, and its channels by topic.
    fn greeted(&mut self) -> (Json, BTreeMap<String, Json>) {
        self.greeted_with(&["/rosout", "world/state"])
    }

    /// As [`Self::greeted`], until these topics are announced: a replay announces its topics one after the other.
    fn greeted_with(&mut self, topics: &[&str]) -> (Json, BTreeMap<String, Json>) {
        let Some(Received::Text(info)) = self.receive() else {
            panic!("no greeting");
        };
        assert!(matches!(self.receive(), Some(Received::Time(_))));
        let mut channels = BTreeMap::new();
        while !topics.iter().all(|topic| channels.contains_key(*topic)) {
            if let Some(Received::Text(text)) = self.receive() {
                assert_eq!(text["op"], "advertise");
                for channel in text["channels"].as_array().unwrap() {
                    let topic = channel["topic"].as_str().unwrap().to_owned();
                    channels.insert(topic, channel.clone());
                }
            }
        }
        (info, channels)
    }

    /// Subscribes to these channels, under the numbers of the channels and a thousand.
    fn subscribe(&mut self, channels: &BTreeMap<String, Json>, topics: &[&str]) {
        let of = |topic: &&str| {
            let id = channels[*topic]["id"].as_u64().unwrap();
            json!({ "id": id + 1000, "channelId": id })
        };
        let subscriptions: Vec<Json> = topics.iter().map(of).collect();
        self.say(&json!({ "op": "subscribe", "subscriptions": subscriptions }));
    }
}

enum Received {
    Text(Json),
    Time(u64),
    Message {
        subscription: u32,
        time_ns: u64,
        data: Vec<u8>,
    },
}

impl Received {
    fn from_bytes(bytes: &[u8]) -> Self {
        let number = |at: usize| u64::from_le_bytes(bytes[at..at + 8].try_into().unwrap());
        match bytes[0] {
            1 => Self::Message {
                subscription: u32::from_le_bytes(bytes[1..5].try_into().unwrap()),
                time_ns: number(5),
                data: bytes[13..].to_vec(),
            },
            2 => Self::Time(number(1)),
            other => panic!("opcode {other}"),
        }
    }
}

/// In simulated nanoseconds.
const SECOND: u64 = 1_000_000_000;

const NOW: &str = "foxglove.sdk.v1";

/// The id that tests give to the subscription of a channel.
fn subscription(channel: &Json) -> u32 {
    channel["id"].as_u64().unwrap() as u32 + 1000
}

/// Times and bytes of messages.
type Messages = Vec<(u64, Vec<u8>)>;

/// A log as viewers see it.
struct Log {
    /// By topic.
    messages: BTreeMap<String, Messages>,
    /// Message encoding and schema by topic.
    schemas: BTreeMap<String, (String, Arc<mcap::Schema<'static>>)>,
}

impl Log {
    fn read(path: &Path) -> Self {
        let bytes = std::fs::read(path).unwrap();
        let (mut messages, mut schemas) = (BTreeMap::new(), BTreeMap::new());
        for message in mcap::MessageStream::new(&bytes).unwrap() {
            let message = message.unwrap();
            let topic = message.channel.topic.clone();
            let schema = message.channel.schema.as_ref().unwrap();
            let schema = Arc::new(mcap::Schema {
                data: schema.data.to_vec().into(),
                ..(**schema).clone()
            });
            let encoding = message.channel.message_encoding.clone();
            schemas.insert(topic.clone(), (encoding, schema));
            let of_topic: &mut Messages = messages.entry(topic).or_default();
            of_topic.push((message.log_time, message.data.to_vec()));
        }
        Self { messages, schemas }
    }

    /// Asserts that a channel is announced as it stands in the log.
    #[track_caller]
    fn is_announced(&self, topic: &str, channel: &Json) {
        let (encoding, schema) = &self.schemas[topic];
        assert_eq!(channel["encoding"], encoding.as_str());
        assert_eq!(channel["schemaName"], schema.name);
        assert_eq!(channel["schemaEncoding"], schema.encoding);
        let text = channel["schema"].as_str().unwrap();
        assert_eq!(text.as_bytes(), &*schema.data);
    }
}

#[test]
fn a_viewer_sees_what_the_log_holds_and_the_run_stays_the_same() {
    let sandbox = Sandbox::new();
    let words = ["--json", "--pace", "2", "--set", "rules.time_limit=6"];
    let run = Watched::start(&sandbox, &words);
    let mut viewer = Viewer::connect(&run.url, None, NOW).unwrap();
    let (info, channels) = viewer.greeted();
    assert_eq!(info["op"], "serverInfo");
    assert_eq!(
        info["capabilities"],
        json!(["time"]),
        "nothing to meddle with"
    );
    let topics = ["world/state", "/robots", "/map", "perception/belief"];
    viewer.subscribe(&channels, &topics);
    // Requests that clients may not make get no answer and have no effect.
    viewer.say(&json!({ "op": "advertise", "channels": [{ "id": 1, "topic": "robot/command" }] }));
    viewer.say(&json!({ "op": "setParameters", "parameters": [] }));
    viewer.0.send(Message::binary(vec![1, 1, 0, 0, 0])).unwrap();
    let mut heard: BTreeMap<u32, Vec<(u64, Vec<u8>)>> = BTreeMap::new();
    let mut now = 0;
    while let Some(message) = viewer.receive() {
        match message {
            Received::Text(text) => assert_eq!(text["op"], "advertise"),
            Received::Time(time_ns) => {
                assert!(time_ns >= now);
                now = time_ns;
            }
            Received::Message {
                subscription,
                time_ns,
                data,
            } => {
                assert!(time_ns <= now, "the clock goes before");
                heard.entry(subscription).or_default().push((time_ns, data));
            }
        }
    }
    let (code, output) = run.finish();
    assert_eq!(code, Some(0), "{output}");
    assert!(output.contains("live: 1 viewers"), "{output}");
    assert!(output.contains(", 0 dropped"), "{output}");
    assert_eq!(now, 6_000_000_000, "to the end");
    let log = Log::read(&sandbox.path().join("run.mcap"));
    for topic in topics {
        let channel = &channels[topic];
        log.is_announced(topic, channel);
        // From the moment of the subscription on the same to the byte.
        let heard = &heard[&subscription(channel)];
        let logged = &log.messages[topic];
        assert!(logged.ends_with(heard), "{topic}");
        assert!(!heard.is_empty());
    }
    let alone = sandbox
        .protean(["run", "chase", "--out", "alone.mcap"])
        .set("rules.time_limit=6")
        .json();
    let watched = sandbox.protean(["info", "run.mcap"]).json();
    assert_eq!(watched["digest"], alone["digest"], "{watched}");
    sandbox.assert_nothing_left();
}

#[test]
fn other_hosts_are_refused_and_viewers_of_all_versions_accepted() {
    let sandbox = Sandbox::new();
    let run = Watched::start(&sandbox, &["--quiet"]);
    let open = format!("ws://{}/", run.address());
    let refused = |url: &str, origin| Viewer::connect(url, origin, NOW).err();
    assert_eq!(
        refused(&open, None),
        Some(StatusCode::FORBIDDEN),
        "no token"
    );
    let wrong = format!("{open}{}", "0".repeat(32));
    assert_eq!(refused(&wrong, None), Some(StatusCode::FORBIDDEN));
    assert_eq!(
        refused(&run.url, Some("https://evil.example")),
        Some(StatusCode::FORBIDDEN),
        "a page of the web that knows the address"
    );
    let other = Viewer::connect(&run.url, None, "chat").err();
    assert_eq!(other, Some(StatusCode::BAD_REQUEST));
    for origin in [None, Some("file://"), Some("https://app.foxglove.dev")] {
        assert_eq!(refused(&run.url, origin), None, "{origin:?}");
    }
    let mut old = Viewer::connect(&run.url, None, "foxglove.websocket.v1").unwrap();
    let (_, channels) = old.greeted();
    // A late joiner gets the map, which was sent before the first tick.
    old.subscribe(&channels, &["/map"]);
    let subscription = subscription(&channels["/map"]);
    loop {
        match old.receive() {
            Some(Received::Message {
                subscription: s, ..
            }) if s == subscription => break,
            Some(_) => {}
            None => panic!("no map"),
        }
    }
    // A silent connection does not delay the others.
    let _silent = TcpStream::connect(run.address()).unwrap();
    let second = sandbox
        .protean(["run", "chase", "--quiet", "--out", "second.mcap", "--live"])
        .arg(run.address().rsplit(':').next().unwrap())
        .run();
    second.refused(
        2,
        &[
            "error: cannot serve live viewers on ",
            run.address(),
            "in use",
        ],
    );
    assert!(!sandbox.path().join("second.mcap").exists());
    run.interrupt();
    let address = run.address().to_owned();
    // All connections are closed in order.
    while old.receive().is_some() {}
    let (code, output) = run.finish();
    assert_eq!(code, Some(3), "{output}");
    assert!(
        TcpStream::connect(&address).is_err(),
        "the port is free again"
    );
    sandbox.assert_nothing_left();
}

#[test]
fn a_viewer_that_takes_nothing_does_not_hold_the_run_up() {
    let sandbox = Sandbox::new();
    let words = [
        "--pace",
        "1000",
        "--set",
        "processes.perception.params.filter.particles=4000",
    ];
    let run = Watched::start(&sandbox, &words);
    let mut viewer = Viewer::connect(&run.url, None, NOW).unwrap();
    let (_, channels) = viewer.greeted();
    let all: Vec<&str> = channels.keys().map(String::as_str).collect();
    viewer.subscribe(&channels, &all);
    // Never reads again.
    let (code, output) = run.finish();
    assert_eq!(code, Some(0), "{output}");
    assert!(output.contains("live: 1 viewers"), "{output}");
    // It misses messages; where the run takes long enough for that, it is cut off before.
    let nothing = " 0 dropped for slow viewers, 0 viewers disconnected";
    assert!(!output.contains(nothing), "{output}");
    drop(viewer);
    sandbox.assert_nothing_left();
}
