use runtime::lockstep::SlotState;

use super::*;

const TIMEOUT: Duration = Duration::from_secs(10);

fn process(on_failure: OnFailure) -> Process {
    Process {
        is_simulator: false,
        on_failure,
        ready_timeout: Duration::from_secs(60),
        upstream: Vec::new(),
        makes_plans: false,
        needs_plans: false,
        drives_robots: true,
        participation: Participation::Active,
        failures: 0,
        killed_for: None,
        done: 0,
        since: Instant::now(),
    }
}

/// A run of the simulator and three processes with this reaction to failures.
fn state(in_lock_step: bool, on_failure: OnFailure) -> State {
    let mut state = State {
        in_lock_step,
        hang_timeout: TIMEOUT,
        processes: vec![
            Process {
                is_simulator: true,
                ..process(OnFailure::Abort)
            },
            process(on_failure),
            process(on_failure),
            process(on_failure),
        ],
        has_begun: false,
        silence: Silence::new(Instant::now()),
        has_failures: false,
    };
    state.begin(Instant::now());
    state
}

/// A moment with 8 posted ticks, of which the process has done 5.
fn at(now: Instant) -> Moment {
    Moment {
        now,
        posted: 8,
        done: 5,
    }
}

fn ended() -> Event {
    Event::Ended("ended with exit code 3".into())
}

/// Returns the actions in short form.
fn short(actions: &[Action]) -> String {
    let words = actions.iter().map(|action| match action {
        Action::Kill => "kill",
        Action::Stop => "stop",
        Action::FreeDead => "free",
        Action::MarkDead => "mark",
        Action::Restart => "restart",
        Action::Log { kind, .. } => match *kind {
            ProcessEvent::LEFT => "left",
            ProcessEvent::GIVEN_UP => "given-up",
            _ => "back",
        },
        Action::Warn(_) => "warn",
        Action::End { .. } => "end",
    });
    words.collect::<Vec<_>>().join(" ")
}

#[test]
fn a_failure_leads_to_these_actions_in_this_order() {
    use OnFailure::{Abort, Continue, Restart};
    let aborted = "left stop mark free end";
    let done_without = "left free given-up warn mark";
    let restarted = "left free warn mark";
    let not_started = Event::NotStarted("no such file".into());
    for (policy, failures, event, expected) in [
        (Abort, 0, ended(), aborted),
        (Abort, 0, Event::Silent, "left end"),
        (Continue, 0, ended(), done_without),
        (Continue, 0, Event::Silent, "kill"),
        (Restart, 0, ended(), restarted),
        (Restart, 4, ended(), restarted),
        (Restart, 5, ended(), aborted),
        (Restart, 4, Event::Silent, "kill"),
        (Restart, 5, Event::Silent, "left end"),
        (Restart, 1, Event::NotReady, "kill"),
        (Restart, 1, not_started.clone(), restarted),
        (Restart, 5, not_started, aborted),
        (Restart, 1, Event::RestartDue, "free restart"),
        (Restart, 1, Event::Rejoined, "back warn"),
    ] {
        let mut state = state(false, policy);
        state.processes[1].failures = failures;
        let actions = state.decide(1, event.clone(), at(Instant::now()));
        assert_eq!(short(&actions), expected, "{policy:?} {failures} {event:?}");
        let goes_on = !expected.ends_with("end");
        let is_failure = expected.starts_with("left");
        assert_eq!(state.has_failures(), goes_on && is_failure);
    }
}

#[test]
fn before_the_first_tick_every_failure_ends_the_run() {
    for (event, expected) in [(ended(), "stop mark free end"), (Event::NotReady, "end")] {
        let mut state = state(false, OnFailure::Restart);
        state.has_begun = false;
        let actions = state.decide(1, event, at(Instant::now()));
        assert_eq!(short(&actions), expected);
        let Some(Action::End { when, .. }) = actions.last() else {
            panic!("{actions:?}");
        };
        assert_eq!(when, "before it was ready");
    }
}

#[test]
fn a_process_that_was_killed_is_named_with_the_reason_for_that() {
    for (event, reason) in [
        (Event::Silent, "did not answer for 10s and was killed"),
        (Event::NotReady, "was not ready within 60s and was killed"),
    ] {
        let mut state = state(false, OnFailure::Continue);
        assert_eq!(state.decide(1, event, at(Instant::now())), [Action::Kill]);
        let actions = state.decide(1, ended(), at(Instant::now()));
        let left = Action::Log {
            kind: ProcessEvent::LEFT,
            tick: 7,
            failures: 1,
            reason: reason.into(),
        };
        assert_eq!(actions[0], left);
        // Its end may be detected again.
        assert_eq!(state.decide(1, ended(), at(Instant::now())), []);
    }
}

#[test]
fn a_process_leaves_at_the_tick_that_it_owes_and_the_world_at_its_last() {
    for (in_lock_step, slot, tick) in [(true, 1, 5), (true, 0, 7), (false, 1, 7)] {
        let mut state = state(in_lock_step, OnFailure::Abort);
        state.processes[slot].failures = 2;
        let actions = state.decide(slot, ended(), at(Instant::now()));
        assert!(
            matches!(actions[0], Action::Log { tick: left, .. } if left == tick),
            "{actions:?}"
        );
        let Some(Action::End { when, .. }) = actions.last() else {
            panic!("{actions:?}");
        };
        assert_eq!(when, "at tick 7 after 2 restarts");
    }
}

/// Processes that take part and have done this many ticks; the simulator comes first.
fn seen(done: [u64; 4]) -> [Observation; 4] {
    done.map(|done| Observation {
        state: SlotState::Prepared,
        done,
    })
}

/// The activity of a process of which only this is known.
fn stopped(is_stopped: bool) -> Activity {
    Activity {
        is_stopped,
        ..Activity::default()
    }
}

#[test]
fn in_lock_step_the_blocking_process_is_reported() {
    let never = |_: usize| Activity::default();
    let blocking_process = |done: [u64; 4], planner: usize, halted: usize| {
        let mut state = state(true, OnFailure::Abort);
        // The third process waits for messages of the first one.
        state.processes[3].upstream = vec![1];
        state.processes[planner].makes_plans = true;
        let start = Instant::now();
        let seen = seen(done);
        assert_eq!(state.timed_events(start, 8, &seen, never), []);
        assert_eq!(state.timed_events(start + TIMEOUT / 2, 8, &seen, never), []);
        let events = state.timed_events(start + TIMEOUT, 8, &seen, |slot| stopped(slot == halted));
        assert_eq!(state.timed_events(start + TIMEOUT, 8, &seen, never), []);
        let [(slot, Event::Silent)] = events[..] else {
            panic!("{events:?}");
        };
        slot
    };
    assert_eq!(
        blocking_process([0, 8, 8, 8], 0, 0),
        0,
        "all have done theirs"
    );
    assert_eq!(blocking_process([0, 8, 7, 8], 0, 0), 2);
    assert_eq!(
        blocking_process([0, 7, 8, 7], 0, 0),
        1,
        "the other waits for it"
    );
    assert_eq!(blocking_process([0, 8, 8, 7], 0, 0), 3);
    assert_eq!(
        blocking_process([0, 7, 7, 7], 2, 0),
        2,
        "others may wait for its plans"
    );
    assert_eq!(blocking_process([0, 7, 7, 7], 2, 3), 3, "it is stopped");
}

#[test]
fn a_process_that_waits_for_a_plan_is_not_blamed_for_the_optimiser() {
    let blamed = |halted: usize, optimiser: SlotState| {
        let mut state = state(true, OnFailure::Abort);
        state.processes[1].makes_plans = true;
        state.processes[2].needs_plans = true;
        // Its own step is done, the plan is not.
        let mut seen = seen([0, 8, 7, 8]);
        seen[1].state = optimiser;
        let start = Instant::now();
        assert_eq!(
            state.timed_events(start, 8, &seen, |_| Activity::default()),
            []
        );
        let mut events =
            state.timed_events(start + TIMEOUT, 8, &seen, |slot| stopped(slot == halted));
        events.remove(0).0
    };
    assert_eq!(blamed(0, SlotState::Prepared), 1);
    assert_eq!(blamed(1, SlotState::Prepared), 1);
    assert_eq!(blamed(2, SlotState::Prepared), 2, "it is stopped");
    assert_eq!(blamed(0, SlotState::Dead), 2, "no optimiser lives");
}

/// The optimiser (1) and a navigator (2) that needs its plans and has not done tick 7.
fn with_an_optimiser() -> (State, [Observation; 4]) {
    let mut state = state(true, OnFailure::Abort);
    state.processes[1].makes_plans = true;
    state.processes[2].needs_plans = true;
    (state, seen([0, 8, 7, 8]))
}

#[test]
fn a_navigator_that_loops_is_not_blamed_on_the_optimiser() {
    for busy in [1, 2] {
        let (mut state, seen) = with_an_optimiser();
        let start = Instant::now();
        let spent = |time: Duration| {
            move |slot: usize| {
                let mut activity = Activity::default();
                if slot == busy {
                    activity.cpu.ran = time;
                }
                activity
            }
        };
        state.timed_events(start, 8, &seen, spent(Duration::ZERO));
        state.timed_events(start + TIMEOUT / 5, 8, &seen, spent(Duration::ZERO));
        let end = start + 2 * TIMEOUT;
        let events = state.timed_events(end, 8, &seen, spent(TIMEOUT));
        assert_eq!(events, [(busy, Event::Silent)]);
    }
}

#[test]
fn waiting_for_a_core_does_not_count_as_a_hang() {
    // The optimiser, or this process, which has the recorder.
    for waiting in [1, 4] {
        let (mut state, seen) = with_an_optimiser();
        let start = Instant::now();
        let waited = |time: Duration| {
            move |slot: usize| {
                let mut activity = Activity::default();
                if slot == waiting {
                    activity.cpu.waited = time;
                }
                activity
            }
        };
        state.timed_events(start, 8, &seen, waited(Duration::ZERO));
        state.timed_events(start + TIMEOUT / 5, 8, &seen, waited(Duration::ZERO));
        let at = |tenths: u32| TIMEOUT * tenths / 10;
        for (time, wait, is_hung) in [(10, 1, false), (100, 91, false), (101, 91, true)] {
            let events = state.timed_events(start + at(time), 8, &seen, waited(at(wait)));
            assert_eq!(!events.is_empty(), is_hung, "{waiting} {time} {wait}");
        }
    }
}

#[test]
fn a_tick_of_many_slow_steps_is_no_hang() {
    let (mut state, _) = with_an_optimiser();
    let start = Instant::now();
    for (tenths, done) in [[0, 7, 7, 7], [0, 8, 7, 7], [0, 8, 8, 7]]
        .into_iter()
        .enumerate()
    {
        let now = start + TIMEOUT * u32::try_from(9 * tenths).unwrap() / 10;
        let events = state.timed_events(now, 8, &seen(done), |_| Activity::default());
        assert_eq!(events, [], "{done:?}");
    }
}

#[test]
fn a_world_that_waits_for_its_next_tick_is_no_hang() {
    let mut state = state(true, OnFailure::Abort);
    let start = Instant::now();
    let mut events = |time: u32, waits| {
        let now = start + TIMEOUT * time;
        state.timed_events(now, 8, &seen([waits, 8, 8, 8]), |_| Activity::default())
    };
    for time in 0..5 {
        assert_eq!(events(time, u64::from(time)), []);
    }
    assert_eq!(events(6, 4), [(0, Event::Silent)], "it waits no more");
}

#[test]
fn in_real_time_each_process_without_progress_is_reported() {
    let mut state = state(false, OnFailure::Restart);
    let start = Instant::now();
    let half = TIMEOUT / 2;
    let look = |state: &mut State, now: Instant, posted: u64, done: [u64; 4]| {
        let events = state.timed_events(now, posted, &seen(done), |_| Activity::default());
        let slots = events.into_iter().map(|(slot, event)| {
            assert_eq!(event, Event::Silent);
            slot
        });
        slots.collect::<Vec<_>>()
    };
    assert_eq!(look(&mut state, start, 1, [0, 1, 1, 1]), [] as [usize; 0]);
    assert_eq!(
        look(&mut state, start + half, 2, [0, 2, 1, 1]),
        [] as [usize; 0]
    );
    assert_eq!(look(&mut state, start + TIMEOUT, 3, [0, 3, 1, 1]), [2, 3]);
    assert_eq!(
        look(&mut state, start + TIMEOUT, 3, [0, 3, 1, 1]),
        [] as [usize; 0]
    );
    // The simulator.
    let later = start + TIMEOUT + TIMEOUT;
    assert_eq!(look(&mut state, later, 3, [0, 3, 3, 3]), [0]);
}

#[test]
fn a_restart_waits_for_its_delay_and_has_a_timeout() {
    let mut state = state(false, OnFailure::Restart);
    let now = Instant::now();
    state.decide(1, ended(), at(now));
    assert!(state.is_restarting());
    let mut seen = seen([8; 4]);
    seen[1].state = SlotState::Starting;
    let due = now + RESTART_DELAY;
    let look = |state: &mut State, now: Instant, seen: &[Observation]| {
        let events = state.timed_events(now, 8, seen, |_| Activity::default());
        events
            .into_iter()
            .map(|(slot, event)| {
                assert_eq!(slot, 1);
                event
            })
            .collect::<Vec<_>>()
    };
    assert_eq!(look(&mut state, now, &seen), []);
    assert_eq!(look(&mut state, due, &seen), [Event::RestartDue]);
    state.decide(1, Event::RestartDue, at(due));
    assert_eq!(look(&mut state, due, &seen), []);
    let late = due + state.ready_timeout(1);
    state.silence.restart(late);
    state
        .processes
        .iter_mut()
        .for_each(|process| process.since = late);
    assert_eq!(look(&mut state, late, &seen), [Event::NotReady]);
    seen[1].state = SlotState::Prepared;
    assert_eq!(look(&mut state, late, &seen), [Event::Rejoined]);
    state.decide(1, Event::Rejoined, at(late));
    assert!(!state.is_restarting());
    assert_eq!(look(&mut state, late, &seen), []);
}

#[test]
fn a_start_step_waits_for_the_first_incomplete_process_until_its_timeout() {
    use SlotState::{Connected, Dead, Prepared, Ready, Starting, Stopped};
    let state = state(true, OnFailure::Abort);
    let timeout = state.ready_timeout(2);
    for (wanted, second, is_behind) in [
        (Ready, Starting, true),
        (Ready, Ready, false),
        (Connected, Starting, true),
        (Connected, Ready, true),
        (Connected, Connected, false),
        (Prepared, Connected, true),
        (Prepared, Prepared, false),
        // Its end is a separate event.
        (Prepared, Stopped, false),
        (Prepared, Dead, false),
    ] {
        let mut seen = seen([0; 4]);
        seen[2].state = second;
        let step = |taken| state.start_step(wanted, taken, &seen);
        let (waiting, late) = if is_behind {
            (StartStep::Waiting, StartStep::Late(2))
        } else {
            (StartStep::Done, StartStep::Done)
        };
        assert_eq!(step(timeout / 2), waiting, "{wanted:?} {second:?}");
        assert_eq!(step(timeout), late, "{wanted:?} {second:?}");
    }
}
