//! Seats that are left and taken again, with threads in the place of processes.

use std::convert::Infallible;
use std::sync::atomic::{AtomicU32, AtomicU64, Ordering};
use std::sync::mpsc;
use std::time::{Duration, Instant};

use kit::lockstep::{Conductor, Overseer, Participant, Phase, SlotState, Turn, TurnEnd, TurnPage};
use proptest::prelude::*;

use crate::lockstep::Page;

/// Nothing here takes as long.
const PATIENCE: Duration = Duration::from_secs(60);

/// Does ticks until the run stops or its time comes to die, without a word; returns the first tick
/// that it did.
fn live(seat: &Participant, dies_at: Option<u64>, mut step: impl FnMut(u64)) -> Option<u64> {
    let mut next = seat.first_tick();
    let mut first = None;
    seat.set_state(SlotState::Ready);
    if seat.is_successor() && !seat.ask_to_connect(|| true) {
        return None;
    }
    seat.set_state(SlotState::Connected);
    seat.set_state(SlotState::Prepared);
    loop {
        match seat.wait_turn(next) {
            Turn::Tick(tick) => {
                assert_eq!(tick, next, "every tick once, in order");
                if first.is_none() {
                    first = Some(tick);
                    seat.begins(tick);
                }
                if dies_at == Some(tick) {
                    return first;
                }
                step(tick);
                seat.done(tick);
                next += 1;
            }
            Turn::Idle => {}
            Turn::Stop => return first,
        }
    }
}

/// The simulator's side of a run of this many ticks; counts how often it was asked to connect.
fn conduct(conductor: &Conductor, ticks: u64, connected: &AtomicU32, mut after: impl FnMut(u64)) {
    let deadline = Instant::now() + PATIENCE;
    let in_time = |tick| assert!(Instant::now() < deadline, "hangs at tick {tick}");
    for tick in 0..ticks {
        let connect = || {
            connected.fetch_add(1, Ordering::SeqCst);
            Ok::<_, Infallible>(())
        };
        while conductor.admit(tick, connect).unwrap() != TurnEnd::Complete {
            in_time(tick);
        }
        conductor.post(tick);
        while conductor.wait(tick) != TurnEnd::Complete {
            in_time(tick);
        }
        after(tick);
    }
}

/// A life of a seat: how many ticks it does, and how long the seat is empty then.
type Life = (u64, u64);

/// Has every seat live through its lives and then stay; checks who did which tick.
fn play(name: &str, lives: &[Vec<Life>], upstream_of_last: bool, ticks: u64) {
    let slots = lives.len();
    let (page, overseer) = Page::new(name, slots + 1);
    let done: Vec<Vec<AtomicU64>> = (0..=slots)
        .map(|_| (0..ticks).map(|_| AtomicU64::new(0)).collect())
        .collect();
    let connected = AtomicU32::new(0);
    let upstream = |slot: usize| {
        let has_one = upstream_of_last && slot == slots && slots > 1;
        if has_one { vec![1] } else { Vec::new() }
    };
    for slot in 1..=slots {
        overseer.seat(slot, true, slot == 1);
    }
    let (died, deaths) = mpsc::channel::<usize>();
    // The ticks that every seat must have done.
    let mut expected = vec![vec![true; ticks as usize]; slots + 1];
    for (slot, lives) in (1..).zip(lives) {
        let mut at = 0;
        for &(length, away) in lives {
            at += length;
            let away = away.max(1);
            for tick in at..(at + away).min(ticks) {
                expected[slot][tick as usize] = false;
            }
            at += away;
        }
    }
    std::thread::scope(|scope| {
        let start = |slot: usize, life: usize| {
            let seat = Participant::new(page.open(), slot, upstream(slot), false);
            let dies_at = lives[slot - 1]
                .get(life)
                .map(|&(length, _)| seat.first_tick() + length);
            let (done, died) = (&done, died.clone());
            scope.spawn(move || {
                live(&seat, dies_at, |tick| {
                    if slot == slots {
                        for up in upstream(slot) {
                            // Whoever is upstream has done it, or is away.
                            let did = done[up][tick as usize].load(Ordering::SeqCst);
                            let should = tick_is_done(&lives[up - 1], tick);
                            assert_eq!(did == 1, should, "upstream first, tick {tick}");
                        }
                    }
                    done[slot][tick as usize].fetch_add(1, Ordering::SeqCst);
                });
                if dies_at.is_some() {
                    let _ = died.send(slot);
                }
            });
        };
        for slot in 1..=slots {
            start(slot, 0);
        }
        let world = overseer.page();
        while (1..=slots).any(|slot| world.state(slot) != SlotState::Prepared) {
            std::thread::yield_now();
        }
        overseer.set_phase(Phase::Run);
        let conductor = Conductor::new(page.open(), 0, 1 << 20, false);
        let connected = &connected;
        let simulator = scope.spawn(move || conduct(&conductor, ticks, connected, |_| {}));
        look_after(&overseer, lives, &deaths, &simulator, start);
        simulator.join().unwrap();
        overseer.set_phase(Phase::Stop);
    });
    for slot in 1..=slots {
        for (tick, done) in done[slot].iter().enumerate() {
            let count = done.load(Ordering::SeqCst);
            assert_eq!(
                count,
                u64::from(expected[slot][tick]),
                "slot {slot}, tick {tick}: {lives:?}"
            );
        }
    }
}

/// Whether a seat with these lives does this tick.
fn tick_is_done(lives: &[Life], tick: u64) -> bool {
    let mut at = 0;
    for &(length, away) in lives {
        at += length;
        if tick < at {
            return true;
        }
        at += away.max(1);
        if tick < at {
            return false;
        }
    }
    true
}

/// The supervisor's side: buries the dead and has their seats taken again.
fn look_after(
    overseer: &Overseer,
    lives: &[Vec<Life>],
    deaths: &mpsc::Receiver<usize>,
    simulator: &std::thread::ScopedJoinHandle<'_, ()>,
    start: impl Fn(usize, usize),
) {
    let page = overseer.page();
    let mut died = vec![0; lives.len() + 1];
    let mut expected: Vec<(usize, u64)> = Vec::new();
    while !simulator.is_finished() {
        if let Ok(slot) = deaths.recv_timeout(Duration::from_micros(200)) {
            let left = page.ticks_done(slot);
            let (_, away) = lives[slot - 1][died[slot]];
            died[slot] += 1;
            let back = left + away.max(1);
            overseer.expect_back(slot, Some(back));
            overseer.bury(slot);
            expected.push((slot, back));
        }
        let held = page.held_before();
        expected.retain(|&(slot, back)| {
            let is_due = held.is_some_and(|held| held >= back);
            if is_due {
                overseer.reseat(slot);
                start(slot, died[slot]);
            }
            !is_due
        });
    }
}

#[test]
fn a_seat_is_taken_again_at_the_tick_for_which_time_was_held() {
    play("again", &[vec![(10, 5)], vec![]], false, 40);
}

#[test]
fn who_waits_for_a_process_that_is_back_waits_for_it_again() {
    play(
        "upstream",
        &[vec![(20, 3), (7, 1)], vec![], vec![]],
        true,
        60,
    );
}

#[test]
fn two_that_are_due_at_once_are_both_waited_for() {
    let lives = [vec![(5, 10)], vec![(5, 10)], vec![]];
    play("both", &lives, false, 30);
}

#[test]
fn one_that_is_no_longer_expected_is_not_waited_for() {
    let (page, overseer) = Page::new("withdrawn", 2);
    overseer.seat(1, true, false);
    let seat = Participant::new(page.open(), 1, Vec::new(), false);
    seat.set_state(SlotState::Prepared);
    overseer.set_phase(Phase::Run);
    let conductor = Conductor::new(page.open(), 0, 1 << 20, false);
    let connect = || Ok::<_, Infallible>(());
    overseer.expect_back(1, Some(3));
    overseer.bury(1);
    assert_eq!(conductor.admit(2, connect).unwrap(), TurnEnd::Complete);
    assert_eq!(overseer.page().held_before(), None);
    assert_eq!(conductor.admit(3, connect).unwrap(), TurnEnd::Idle);
    assert_eq!(overseer.page().held_before(), Some(3));
    // It failed to start: it comes later, or not at all.
    overseer.reseat(1);
    overseer.expect_back(1, Some(5));
    overseer.bury(1);
    assert_eq!(conductor.admit(3, connect).unwrap(), TurnEnd::Complete);
    assert_eq!(overseer.page().held_before(), None);
    assert_eq!(conductor.admit(5, connect).unwrap(), TurnEnd::Idle);
    overseer.expect_back(1, None);
    assert_eq!(conductor.admit(5, connect).unwrap(), TurnEnd::Complete);
    overseer.expect_back(1, Some(6));
    overseer.set_phase(Phase::Stop);
    assert_eq!(conductor.admit(6, connect).unwrap(), TurnEnd::Stop);
}

#[test]
fn a_second_of_the_same_finds_its_seat_taken_until_the_first_is_buried() {
    let (page, overseer) = Page::new("claimed", 2);
    overseer.seat(0, false, false);
    overseer.seat(1, true, false);
    assert!(page.open().claim(1));
    assert!(!page.open().claim(1), "a second one");
    assert!(page.open().claim(0), "another seat");
    overseer.bury(1);
    assert!(!page.open().claim(1), "nobody was sent for");
    overseer.reseat(1);
    assert!(page.open().claim(1), "the successor");
    assert!(!page.open().claim(1), "a second successor");
}

#[test]
fn the_buried_do_not_rise() {
    let (page, overseer) = Page::new("buried", 2);
    overseer.seat(1, true, false);
    let seat = Participant::new(page.open(), 1, Vec::new(), false);
    seat.set_state(SlotState::Prepared);
    overseer.bury(1);
    seat.set_state(SlotState::Connected);
    let world: &TurnPage = overseer.page();
    assert_eq!(world.state(1), SlotState::Dead);
    overseer.reseat(1);
    assert_eq!(
        (world.state(1), world.times_taken(1)),
        (SlotState::Starting, 2)
    );
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, ..ProptestConfig::default() })]

    #[test]
    fn whoever_dies_and_comes_back_whenever_every_tick_is_done_by_the_living(
        lives in proptest::collection::vec(
            proptest::collection::vec((0_u64..12, 1_u64..6), 0..4), 1..5,
        ),
        upstream in any::<bool>(),
    ) {
        play("any", &lives, upstream, 48);
    }
}
