//! Plays a log.

use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};

use ipc_types::bus::{Publisher, PublisherOptions};
use ipc_types::messages::process::RunControl;
use ipc_types::stamp::PlainHeader;
use ipc_types::topics::{Control, NAMES, Topic as _};
use kit::config::{Clock, ProcessConfig};
use kit::lockstep::{Conductor, Overseer, Phase, TurnPage};

use super::super::error::LogsError;
use super::super::filter::nanoseconds;
use super::super::known;
use super::super::watch::Watch;
use super::broadcast::Broadcast;
use super::keys::{Key, Keys};
use super::pace::Pace;
use super::played::{ReplayOptions, Replayed};
use super::screen::Screen;
use super::source::{Logged, Source};
use super::stage::{Choir, Clocks, SayError, Stage};
use crate::mission::{MissionError, write_config};

/// How long those who listen get to connect to somebody who speaks up late.
const INTRODUCTION: Duration = Duration::from_millis(10);
/// How long the ports stay open behind the last message for those who listen, so that they can take
/// it.
const LINGER: Duration = Duration::from_millis(250);
/// How often those who came late are connected, and the time is told.
const BEAT: Duration = Duration::from_millis(50);
/// How far the left arrow goes back [ns].
const BACK: u64 = 5_000_000_000;
/// Slowest and fastest that arrows make it.
const RATES: (f64, f64) = (1.0 / 1024.0, 1024.0);

/// Sends the messages of a log once more, as a run of its own that others can join.
///
/// # Errors
/// [`LogsError`]: the log cannot be read or is none of ours, or a reader holds the replay back for
/// too long.
pub fn replay(
    log: &Path,
    options: &ReplayOptions,
    watch: &mut Watch,
) -> Result<Replayed, LogsError> {
    let start = Instant::now();
    let (from, to) = (
        nanoseconds("--start", options.start_s)?.unwrap_or(0),
        nanoseconds("--end", options.end_s)?.unwrap_or(u64::MAX),
    );
    if from > to {
        let text = "--start: expected a time that is not after --end";
        return Err(LogsError::Argument(text.to_owned()));
    }
    if options.rate.is_nan() || options.rate <= 0.0 {
        let text = format!("--rate {}: expected a factor above 0", options.rate);
        return Err(LogsError::Argument(text));
    }
    let mut source = Source::open(log, &options.topics, to, options.live.is_some())?;
    let scenario = source.origin().scenario(log, &[], "")?;
    if !source.has_index() && !options.quiet {
        eprintln!(
            "note: {} has no index: it is read from its beginning; `protean recover` makes one",
            log.display()
        );
    }
    let keys = Keys::open();
    if options.paused && !keys.can_come() {
        let text = "--paused: stdin is neither this terminal's foreground nor a pipe: nobody can \
                    press a key";
        return Err(LogsError::Argument(text.to_owned()));
    }
    // A sleep ends when it should, not up to 50 µs later.
    let _ = rustix::thread::set_current_timer_slack(std::num::NonZeroU64::new(1));
    let mut player = Player::open(&mut source, &scenario, options, keys, watch)?;
    let played = player.play(from, start, watch);
    let mut report = player.end();
    played?;
    report.scenario.clone_from(&scenario.name);
    report.faults = source.faults();
    Ok(report)
}

/// Why a message is not sent.
enum Flow {
    /// It is.
    Go,
    /// Something else comes first: from this log time on.
    From(u64),
    /// Nothing more is.
    Quit,
}

struct Player<'a> {
    source: &'a mut Source,
    options: &'a ReplayOptions,
    choir: Choir,
    control: Publisher<Control>,
    overseer: Overseer,
    conductor: Conductor,
    keys: Keys,
    screen: Screen,
    broadcast: Option<Broadcast>,
    pace: Pace,
    paused: bool,
    /// Tick and log time of now.
    now: (u64, u64),
    beat: Instant,
    log: std::path::PathBuf,
    report: Replayed,
    by_rank: Vec<u64>,
    first: Option<Instant>,
    // Last: it is wiped when everything else is gone.
    stage: Stage,
}

impl<'a> Player<'a> {
    fn open(
        source: &'a mut Source,
        scenario: &crate::scenario::ResolvedScenario,
        options: &'a ReplayOptions,
        keys: Keys,
        watch: &mut Watch,
    ) -> Result<Self, LogsError> {
        let log = source.path().to_owned();
        let broadcast = options
            .live
            .map(|port| Broadcast::start(port, source))
            .transpose()
            .map_err(MissionError::from)?;
        let stage = Stage::build(scenario)?;
        let prefix = stage.space.space().prefix();
        let processes = stage.plan.launches.len();
        let page = TurnPage::create(prefix, processes).map_err(MissionError::from)?;
        let page = Arc::new(page);
        let overseer = Overseer::new(Arc::clone(&page));
        for launch in &stage.plan.launches {
            write_config(stage.root(), &joining(&launch.config, options.rate))?;
        }
        let orchestrator = stage.plan.orchestrator_index();
        let control = stage
            .bus
            .publisher(PublisherOptions::new(orchestrator, 1))
            .map_err(MissionError::from)?;
        let mut choir = Choir::new();
        // Whoever speaks at the beginning has a port before anybody comes to listen.
        source.audition(watch, &mut |rank, speaker| {
            if NAMES.get(rank) != Some(&Control::NAME) {
                let opened = choir.open(&stage.bus, rank, speaker);
                opened.map_err(MissionError::from)?;
            }
            Ok(())
        })?;
        overseer.set_phase(Phase::Run);
        let screen = Screen::new(source.last_time(), options.quiet, keys.terminal());
        if !options.quiet {
            eprintln!(
                "playing {}: root {}, prefix {prefix}",
                log.display(),
                stage.root().display(),
            );
        }
        Ok(Self {
            source,
            options,
            choir,
            control,
            conductor: Conductor::new(page, 0, 1 << 20),
            overseer,
            keys,
            screen,
            broadcast,
            pace: Pace::new(options.rate, 0),
            paused: options.paused,
            now: (0, 0),
            beat: Instant::now(),
            log,
            report: Replayed::default(),
            by_rank: vec![0; NAMES.len()],
            first: None,
            stage,
        })
    }

    fn play(&mut self, from: u64, start: Instant, watch: &mut Watch) -> Result<(), LogsError> {
        let mut at = from;
        loop {
            let before = Instant::now();
            let lasting = self.source.seek(at, watch)?;
            if self.report.messages == 0 {
                self.report.seek_s = before.elapsed().as_secs_f64();
                self.report.start_up_s = start.elapsed().as_secs_f64();
            }
            self.now = (at / self.stage.plan.run.tick_period_ns.max(1), at);
            if let Some(broadcast) = &mut self.broadcast {
                broadcast.jump(at);
            }
            for message in &lasting {
                self.report.restored += u64::from(self.say(message)?);
            }
            self.pace.restart(at);
            self.tell(if self.paused {
                PAUSE
            } else {
                RunControl::START
            })?;
            match self.play_on(watch)? {
                Flow::From(time) => at = time.max(from),
                Flow::Go => {
                    self.report.times += 1;
                    if !self.options.again || self.report.ticks == 0 {
                        break;
                    }
                    at = from;
                }
                Flow::Quit => {
                    self.report.interrupted = true;
                    break;
                }
            }
        }
        self.report.wall_time_s = self
            .first
            .map_or(0.0, |first| first.elapsed().as_secs_f64());
        self.tell(STOP)
    }

    /// Plays from where the source stands to its end, unless something comes first.
    fn play_on(&mut self, watch: &Watch) -> Result<Flow, LogsError> {
        // Read whole before it is due: what is in a chunk takes its time.
        let mut tick = Vec::new();
        while self.source.tick(&mut tick)? {
            let Some(first) = tick.first() else { break };
            let time = first.time;
            match self.wait(time, watch)? {
                Flow::Go => {}
                other => return Ok(other),
            }
            self.report.ticks += 1;
            // Where only viewers get something, no tick passes.
            let ours = tick.iter().find(|message| message.is_ours());
            let stamp = ours.and_then(|message| known::stamp(&message.data));
            self.now = (stamp.map_or(self.now.0, |stamp| stamp.tick), time);
            for message in &tick {
                if self.say(message)? {
                    self.pace.sent(time);
                }
            }
            if let Some(stamp) = stamp {
                self.conductor.post_without_waiting(stamp.tick);
            }
        }
        Ok(Flow::Go)
    }

    /// Waits until the messages of a time are due, and does what somebody wants meanwhile.
    fn wait(&mut self, time: u64, watch: &Watch) -> Result<Flow, LogsError> {
        loop {
            if watch.interrupted.load(std::sync::atomic::Ordering::Relaxed) {
                return Ok(Flow::Quit);
            }
            let now = Instant::now();
            if now.saturating_duration_since(self.beat) >= BEAT {
                self.beat(now)?;
            }
            let left = if self.paused {
                BEAT
            } else if self.pace.rate.is_infinite() {
                // Keys are looked for once per beat, and nothing waits for them.
                if now != self.beat {
                    return Ok(Flow::Go);
                }
                Duration::ZERO
            } else {
                let left = self.pace.due(time).saturating_duration_since(now);
                if left.is_zero() {
                    return Ok(Flow::Go);
                }
                left.min(BEAT)
            };
            if let Some(key) = self.keys.wait(left) {
                match key {
                    Key::Pause => {
                        self.paused = !self.paused;
                        self.pace.restart(self.now.1);
                        self.tell(if self.paused {
                            PAUSE
                        } else {
                            RunControl::START
                        })?;
                    }
                    Key::Step => {
                        self.paused = true;
                        self.tell(STEP)?;
                        self.pace.restart(time);
                        return Ok(Flow::Go);
                    }
                    Key::Back => return Ok(Flow::From(self.now.1.saturating_sub(BACK))),
                    Key::Faster | Key::Slower => {
                        let factor = if key == Key::Faster { 2.0 } else { 0.5 };
                        self.set_rate(factor)?;
                    }
                    Key::Quit => return Ok(Flow::Quit),
                }
            }
            if self.paused && !self.keys.can_come() {
                // Whoever could have pressed one is gone.
                return Ok(Flow::Quit);
            }
        }
    }

    fn set_rate(&mut self, factor: f64) -> Result<(), LogsError> {
        if self.pace.rate.is_infinite() {
            return Ok(());
        }
        let now = if self.paused {
            self.now.1
        } else {
            self.pace.time()
        };
        self.pace.rate = (self.pace.rate * factor).clamp(RATES.0, RATES.1);
        self.pace.restart(now);
        self.tell(if self.paused {
            PAUSE
        } else {
            RunControl::START
        })
    }

    /// Looks after those who look on.
    fn beat(&mut self, now: Instant) -> Result<(), LogsError> {
        self.beat = now;
        self.choir.greet().map_err(MissionError::from)?;
        self.control
            .update_connections()
            .map_err(MissionError::from)?;
        self.screen.show(self.now.1, self.pace.rate, self.paused);
        Ok(())
    }

    /// Says what the replay does, in `run/control`.
    fn tell(&mut self, command: u32) -> Result<(), LogsError> {
        let mut header = PlainHeader::default();
        (header.stamp.tick, header.stamp.time_ns) = self.now;
        let order = RunControl {
            rate: if self.pace.rate.is_infinite() {
                0.0
            } else {
                self.pace.rate
            },
            command,
            reserved: 0,
        };
        self.control
            .send(header, &[order])
            .map_err(MissionError::from)?;
        Ok(())
    }

    /// Shows a message to viewers, and sends it; false if it is for viewers only, is none, or is what
    /// the replay says itself.
    fn say(&mut self, message: &Logged) -> Result<bool, LogsError> {
        if let Some(broadcast) = &mut self.broadcast {
            broadcast.show(self.source, message);
        }
        if !message.is_ours() {
            return Ok(false);
        }
        if NAMES.get(message.rank) == Some(&Control::NAME) {
            return Ok(false);
        }
        let speaker = message.speaker();
        if self
            .choir
            .open(&self.stage.bus, message.rank, speaker)
            .map_err(MissionError::from)?
        {
            self.stage.attend(INTRODUCTION);
        }
        let clocks = if self.options.restamp {
            Clocks::Now
        } else {
            Clocks::Recorded
        };
        match self.choir.say(message, clocks) {
            Ok(()) => {}
            Err(SayError::Decode(_)) => {
                self.report.malformed += 1;
                return Ok(false);
            }
            Err(SayError::Port(error)) => return Err(MissionError::from(error).into()),
            Err(SayError::Send(error)) => return Err(MissionError::from(error).into()),
        }
        self.first.get_or_insert_with(Instant::now);
        self.report.messages += 1;
        self.report.bytes += message.data.len() as u64;
        if let Some(count) = self.by_rank.get_mut(message.rank) {
            *count += 1;
        }
        Ok(true)
    }

    /// Ends the run; what was played.
    fn end(mut self) -> Replayed {
        self.stage.attend(LINGER);
        self.overseer.set_phase(Phase::Stop);
        self.report.live = self.broadcast.take().map(Broadcast::finish);
        self.screen.finish();
        let counts = NAMES
            .iter()
            .zip(&self.by_rank)
            .filter(|(_, count)| **count > 0);
        self.report.topics = counts
            .map(|(name, count)| ((*name).to_owned(), *count))
            .collect();
        self.report.jitter_us = self.pace.jitter();
        self.report.lateness_us = self.pace.lateness();
        tracing::debug!("played {}", self.log.display());
        self.report
    }
}

/// Commands of `run/control`.
const PAUSE: u32 = 2;
const STEP: u32 = 3;
const STOP: u32 = 4;

/// What a process is told that joins the replay: time passes without waiting for it.
fn joining(config: &ProcessConfig, rate: f64) -> ProcessConfig {
    let mut config = config.clone();
    config.run.clock = Clock::RealTime {
        factor: if rate.is_finite() { rate } else { 1000.0 },
        deadline_ns: 500_000_000,
    };
    config
}
