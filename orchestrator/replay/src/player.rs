//! Replay of a log.

use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

use ipc_types::bus::{Publisher, PublisherOptions};
use ipc_types::messages::process::RunControl;
use ipc_types::stamp::PlainHeader;
use ipc_types::topics::{Control, NAMES, Topic as _};
use mcap_log::LogReadError;
use mcap_log::ReadProgress;
use mcap_log::known;
use mcap_log::source::{LogMessage, Source};
use platform::eprintln;
use runtime::config::Clock;
use runtime::lockstep::{BarrierLeader, BarrierMonitor, Phase};

use super::create_resources;
use super::live_replay::LiveReplay;
use super::publishers::TopicPublishers;
use super::replay_report::{ReplayOptions, ReplayReport};
use crate::ReplayError;
use crate::origin::scenario_of;
use log_tools::nanoseconds;
use mission::MissionError;
use mission::plan::Launch;
use mission::process_group::write_config;
use mission::resources::RunResources;
use scenario::ResolvedScenario;
use scenario::kind::Kind;

/// Time for subscribers to connect to a publisher that starts late.
const CONNECT_TIME: Duration = Duration::from_millis(10);
/// Maximum time for which the ports stay open after the last message, so that subscribers can receive it.
const LINGER: Duration = Duration::from_millis(250);
/// Interval between two checks for remaining subscribers.
const LINGER_POLL_INTERVAL: Duration = Duration::from_millis(1);
/// Interval at which late joiners are connected and dead subscribers are removed.
const POLL_INTERVAL: Duration = Duration::from_millis(50);
/// Command of `run/control` that ends a replay.
const STOP: u32 = 4;

/// Sends the messages of a log again, as a run that other processes can join.
///
/// # Errors
/// [`ReplayError`] if the log is unreadable or not a Protean log, or if a subscriber blocks the replay for too long.
pub fn replay(
    log: &Path,
    kinds: &[Kind],
    options: &ReplayOptions,
    watch: &mut ReadProgress,
) -> Result<ReplayReport, ReplayError> {
    let start = Instant::now();
    let (from, to) = (
        nanoseconds("--start", options.start_s)?.unwrap_or(0),
        nanoseconds("--end", options.end_s)?.unwrap_or(u64::MAX),
    );
    if from > to {
        let text = "--start: expected a time that is not after --end";
        return Err(LogReadError::Argument(text.to_owned()).into());
    }
    if options.rate.is_nan() || options.rate <= 0.0 {
        let text = format!("--pace {}: expected a factor above 0", options.rate);
        return Err(LogReadError::Argument(text).into());
    }
    let before = to.saturating_add(1);
    let mut source = Source::open(log, &options.topics, before, options.live.is_some())?;
    let scenario = scenario_of(source.origin(), log, &[], "", kinds)?;
    if !source.has_index() && !options.quiet {
        eprintln!(
            "note: {} has no index: it is read from its beginning; `protean recover` adds an index",
            log.display()
        );
    }
    // Sleeps then end on time, not up to 50 µs later.
    let _ = rustix::thread::set_current_timer_slack(std::num::NonZeroU64::new(1));
    let mut player = Player::open(&mut source, &scenario, options, watch)?;
    let played = player.play(from, start, watch);
    let (mut report, live) = player.end();
    // After a failure no page stays.
    played?;
    report.live = live.map(|live| live.finish(&watch.interrupted));
    report.scenario.clone_from(&scenario.name);
    report.faults = source.faults();
    Ok(report)
}

struct Player<'a> {
    source: &'a mut Source,
    options: &'a ReplayOptions,
    publishers: TopicPublishers,
    control: Publisher<Control>,
    monitor: BarrierMonitor,
    leader: BarrierLeader,
    live_replay: Option<LiveReplay>,
    /// Current speed relative to the recording; infinite for as fast as possible.
    rate: f64,
    /// Single steps taken, while pages hold the replay.
    steps: u32,
    /// A log time, and the time at which it is or was due.
    anchor: (u64, Instant),
    /// Current tick and log time.
    now: (u64, u64),
    last_poll: Instant,
    report: ReplayReport,
    by_rank: Vec<u64>,
    first: Option<Instant>,
    // Must be last: all other fields must be closed before it is removed.
    resources: RunResources,
}

impl<'a> Player<'a> {
    fn open(
        source: &'a mut Source,
        scenario: &ResolvedScenario,
        options: &'a ReplayOptions,
        watch: &mut ReadProgress,
    ) -> Result<Self, ReplayError> {
        let live_replay = options
            .live
            .map(|live| LiveReplay::start(live, source))
            .transpose()
            .map_err(MissionError::from)?;
        let resources = create_resources(scenario)?;
        let monitor = BarrierMonitor::new(Arc::clone(&resources.barrier));
        for launch in &resources.plan.launches {
            let launch = joining(launch, options.rate);
            let slot = launch.config.index as usize;
            write_config(resources.root(), &launch.config.name, slot, &launch)
                .map_err(MissionError::from)?;
        }
        let orchestrator = resources.plan.orchestrator_index();
        let control = resources
            .bus
            .publisher(PublisherOptions::new(orchestrator, 1))
            .map_err(MissionError::from)?;
        let mut publishers = TopicPublishers::new();
        // The first senders have ports before the first subscriber connects.
        source.visit_senders(watch, &mut |rank, sender| {
            if NAMES.get(rank) != Some(&Control::NAME) {
                publishers.open(&resources.bus, rank, sender)?;
            }
            Ok::<(), ReplayError>(())
        })?;
        monitor.set_phase(Phase::Run);
        if !options.quiet {
            eprintln!(
                "playing {}: root {}, prefix {}",
                source.path().display(),
                resources.root().display(),
                resources.plan.run.prefix,
            );
        }
        Ok(Self {
            source,
            options,
            publishers,
            control,
            leader: BarrierLeader::new(Arc::clone(&resources.barrier), 0, 1 << 20),
            monitor,
            live_replay,
            rate: options.rate,
            steps: 0,
            anchor: (0, Instant::now()),
            now: (0, 0),
            last_poll: Instant::now(),
            report: ReplayReport::default(),
            by_rank: vec![0; NAMES.len()],
            first: None,
            resources,
        })
    }

    /// Plays from log time `from` on, once or repeatedly; `start` is the time of the request.
    fn play(
        &mut self,
        from: u64,
        start: Instant,
        watch: &mut ReadProgress,
    ) -> Result<(), ReplayError> {
        loop {
            let before = Instant::now();
            let lasting = self.source.seek(from, watch)?;
            if self.report.messages == 0 {
                self.report.seek_s = before.elapsed().as_secs_f64();
                self.report.start_up_s = start.elapsed().as_secs_f64();
            }
            self.now = (from / self.resources.plan.run.tick_period_ns.max(1), from);
            if let Some(live_replay) = &mut self.live_replay {
                live_replay.jump(from);
            }
            for message in &lasting {
                self.report.restored += u64::from(self.send(message)?);
            }
            self.anchor = (from, Instant::now());
            self.publish_control(RunControl::START)?;
            if !self.play_on(watch)? {
                self.report.interrupted = true;
                break;
            }
            self.report.times += 1;
            if !self.options.again || self.report.ticks == 0 {
                break;
            }
        }
        self.report.wall_time_s = self
            .first
            .map_or(0.0, |first| first.elapsed().as_secs_f64());
        self.publish_control(STOP)
    }

    /// Plays from the source's position to its end. Returns `false` if interrupted.
    fn play_on(&mut self, watch: &ReadProgress) -> Result<bool, ReplayError> {
        // A tick is read completely before it is due, since reading a chunk takes time.
        let mut tick = Vec::new();
        while self.source.tick(&mut tick)? {
            let Some(first) = tick.first() else { break };
            let time = first.time;
            if !self.wait(time, watch)? {
                return Ok(false);
            }
            self.report.ticks += 1;
            // Messages for viewers only do not advance the tick.
            let ours = tick.iter().find(|message| message.is_ours());
            let stamp = ours.and_then(|message| known::stamp(&message.data));
            self.now = (stamp.map_or(self.now.0, |stamp| stamp.tick), time);
            for message in &tick {
                match self.send(message) {
                    // The signal also ends a send that waits for a subscriber, with an error.
                    Err(_) if watch.interrupted.load(Ordering::Relaxed) => return Ok(false),
                    sent => sent?,
                };
            }
            if let Some(stamp) = stamp {
                self.leader.post_without_waiting(stamp.tick);
            }
        }
        Ok(true)
    }

    /// Waits until the messages of a time are due, and connects and removes subscribers meanwhile. Returns `false` if
    /// interrupted.
    fn wait(&mut self, time: u64, watch: &ReadProgress) -> Result<bool, ReplayError> {
        loop {
            if watch.interrupted.load(Ordering::Relaxed) {
                return Ok(false);
            }
            let now = Instant::now();
            if now.saturating_duration_since(self.last_poll) >= POLL_INTERVAL {
                self.last_poll = now;
                self.update_subscribers()?;
            }
            let left = self.time_left(time, now)?;
            if left.is_zero() {
                return Ok(true);
            }
            std::thread::sleep(left.min(POLL_INTERVAL));
        }
    }

    /// Returns the time until the messages of a time are due, by the pace that pages have set; while they hold the replay, it
    /// goes on by their steps only.
    fn time_left(&mut self, time: u64, now: Instant) -> Result<Duration, ReplayError> {
        let control = self.live_replay.as_ref().and_then(LiveReplay::control);
        if let Some(wish) = control.map(viewer::Control::wish) {
            if wish.is_paused || wish.pace != self.rate {
                self.anchor = (if wish.is_paused { time } else { self.now.1 }, now);
            }
            if wish.pace != self.rate {
                self.rate = wish.pace;
                self.publish_control(RunControl::START)?;
            }
            if wish.is_paused && self.steps == wish.steps {
                return Ok(POLL_INTERVAL);
            }
            self.steps = if wish.is_paused {
                self.steps + 1
            } else {
                wish.steps
            };
        }
        let after = time.saturating_sub(self.anchor.0) as f64 * 1e-9 / self.rate;
        // A log may contain times beyond the range of the clock.
        let after = Duration::try_from_secs_f64(after.min(1e9)).unwrap_or_default();
        Ok((self.anchor.1 + after).saturating_duration_since(now))
    }

    /// Connects late joiners, which receive latched messages, and removes dead subscribers: a sender with a full buffer
    /// towards a dead one would wait.
    fn update_subscribers(&self) -> Result<(), ReplayError> {
        self.resources.bus.clean_up_dead();
        self.publishers.connect().map_err(MissionError::from)?;
        let connected = self.control.update_connections();
        connected.map_err(MissionError::from)?;
        Ok(())
    }

    /// Publishes the state of the replay in `run/control`.
    fn publish_control(&mut self, command: u32) -> Result<(), ReplayError> {
        let mut header = PlainHeader::default();
        (header.stamp.tick, header.stamp.time_ns) = self.now;
        let rate = self.rate;
        let order = RunControl {
            rate: if rate.is_infinite() { 0.0 } else { rate },
            command,
            reserved: 0,
        };
        self.control
            .send(header, &[order])
            .map_err(MissionError::from)?;
        Ok(())
    }

    /// Sends a message to viewers and subscribers. Returns `false` if it is for viewers only, is invalid, or is a
    /// message that the replay itself sends.
    fn send(&mut self, message: &LogMessage) -> Result<bool, ReplayError> {
        if let Some(live_replay) = &mut self.live_replay {
            live_replay.show(self.source, message);
        }
        if !message.is_ours() || NAMES.get(message.rank) == Some(&Control::NAME) {
            return Ok(false);
        }
        let sender = message.sender();
        if self
            .publishers
            .open(&self.resources.bus, message.rank, sender)?
        {
            self.linger(CONNECT_TIME);
        }
        if !self.publishers.publish(message)? {
            self.report.malformed += 1;
            return Ok(false);
        }
        self.first.get_or_insert_with(Instant::now);
        self.report.messages += 1;
        self.report.bytes += message.data.len() as u64;
        if let Some(count) = self.by_rank.get_mut(message.rank) {
            *count += 1;
        }
        Ok(true)
    }

    /// Waits up to `limit` for subscribers, if there are any. The replay cannot detect whether they have received all
    /// messages, or have connected to a new publisher.
    fn linger(&self, limit: Duration) {
        let deadline = Instant::now() + limit;
        while self.resources.has_listeners() && Instant::now() < deadline {
            std::thread::park_timeout(LINGER_POLL_INTERVAL);
        }
    }

    /// Ends the run and returns the report, and the server, which may outlive it.
    fn end(mut self) -> (ReplayReport, Option<LiveReplay>) {
        self.linger(LINGER);
        self.monitor.set_phase(Phase::Stop);
        let counts = NAMES
            .iter()
            .zip(&self.by_rank)
            .filter(|(_, count)| **count > 0);
        self.report.topics = counts
            .map(|(name, count)| ((*name).to_owned(), *count))
            .collect();
        self.report.simulated_messages = self.report.message_counts().simulated;
        (self.report, self.live_replay)
    }
}

/// Returns the configuration of a process that joins the replay: ticks pass without waiting for it.
fn joining(launch: &Launch, rate: f64) -> Launch {
    let mut launch = launch.clone();
    launch.config.run.clock = Clock::RealTime {
        factor: if rate.is_finite() { rate } else { 1000.0 },
        deadline_ns: 500_000_000,
    };
    launch
}
