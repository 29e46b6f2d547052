//! The turn page with threads in the place of processes (each with a mapping of its own).

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

use runtime::lockstep::{
    Conductor, Overseer, PageError, Participant, Phase, SlotState, Turn, TurnEnd, TurnPage,
};

/// A page of a test's own, removed also when the test fails.
pub struct Page(String);

impl Page {
    pub fn new(name: &str, processes: usize) -> (Self, Overseer) {
        let prefix = format!("pt_{}_{name}_", std::process::id());
        let page = TurnPage::create(&prefix, processes).unwrap();
        (Self(prefix), Overseer::new(Arc::new(page)))
    }

    pub fn open(&self) -> Arc<TurnPage> {
        Arc::new(TurnPage::open(&self.0).unwrap())
    }
}

impl Drop for Page {
    fn drop(&mut self) {
        let _ = std::fs::remove_file(TurnPage::path_for(&self.0));
    }
}

/// Steps ticks until the run stops; `step` sees every tick once and in order.
fn take_part(seat: &Participant, mut step: impl FnMut(u64) -> bool) {
    seat.set_state(SlotState::Connected);
    let mut next = 0;
    loop {
        match seat.wait_turn(next) {
            Turn::Tick(tick) => {
                assert_eq!(tick, next);
                if !step(tick) {
                    return;
                }
                seat.done(tick);
                next += 1;
            }
            Turn::Idle => {}
            Turn::Stop => return,
        }
    }
}

fn conduct(conductor: &Conductor, ticks: u64, mut after: impl FnMut(u64)) {
    for tick in 0..ticks {
        conductor.post(tick);
        loop {
            match conductor.wait(tick) {
                TurnEnd::Complete => break,
                TurnEnd::Idle => {}
                TurnEnd::Stop => panic!("nobody stops this run"),
            }
        }
        after(tick);
    }
}

fn wait_connected(page: &TurnPage, slots: core::ops::Range<usize>) {
    while slots
        .clone()
        .any(|slot| page.state(slot) != SlotState::Connected)
    {
        std::thread::yield_now();
    }
}

#[test]
fn every_tick_is_done_by_everybody_before_the_next_and_downstream_after_upstream() {
    const TICKS: u64 = 3000;
    let (page, overseer) = Page::new("order", 6);
    // 1 is upstream of 2 and 3; 4 and 5 follow the simulator only.
    for slot in 1..6 {
        overseer.seat(slot, true, slot == 1);
    }
    let counts: Vec<AtomicU64> = (0..6).map(|_| AtomicU64::new(0)).collect();
    std::thread::scope(|scope| {
        for slot in 1..6 {
            let upstream = if slot == 2 || slot == 3 {
                vec![1]
            } else {
                Vec::new()
            };
            let seat = Participant::new(page.open(), slot, upstream.clone());
            let counts = &counts;
            scope.spawn(move || {
                take_part(&seat, |tick| {
                    for &up in &upstream {
                        assert_eq!(
                            counts[up].load(Ordering::SeqCst),
                            tick + 1,
                            "upstream first"
                        );
                    }
                    counts[slot].store(tick + 1, Ordering::SeqCst);
                    true
                });
            });
        }
        wait_connected(overseer.page(), 1..6);
        overseer.set_phase(Phase::Run);
        let conductor = Conductor::new(page.open(), 0, 1_000_000);
        conduct(&conductor, TICKS, |tick| {
            for count in &counts[1..] {
                assert_eq!(count.load(Ordering::SeqCst), tick + 1);
            }
        });
        overseer.set_phase(Phase::Stop);
    });
}

#[test]
fn a_process_that_dies_in_the_middle_of_a_tick_is_taken_out_of_the_count() {
    let (page, overseer) = Page::new("death", 4);
    for slot in 1..4 {
        overseer.seat(slot, true, slot == 1);
    }
    let (died, death) = std::sync::mpsc::channel();
    std::thread::scope(|scope| {
        for slot in 1..4 {
            // 3 waits for 1, which dies at tick 50 without a word.
            let upstream = if slot == 3 { vec![1] } else { Vec::new() };
            let seat = Participant::new(page.open(), slot, upstream);
            let died = died.clone();
            scope.spawn(move || {
                take_part(&seat, |tick| {
                    let dies = slot == 1 && tick == 50;
                    if dies {
                        died.send(()).unwrap();
                    }
                    !dies
                });
            });
        }
        wait_connected(overseer.page(), 1..4);
        overseer.set_phase(Phase::Run);
        let gravedigger = overseer.clone();
        scope.spawn(move || {
            death.recv().unwrap();
            gravedigger.bury(1);
        });
        let conductor = Conductor::new(page.open(), 0, 1_000_000);
        conduct(&conductor, 200, |_| {});
        assert_eq!(overseer.page().ticks_done(1), 50);
        assert_eq!(overseer.page().ticks_done(3), 200);
        overseer.set_phase(Phase::Stop);
    });
}

#[test]
fn the_world_waits_for_a_process_that_ended_until_the_orchestrator_has_decided() {
    let (page, overseer) = Page::new("ended", 3);
    for slot in 1..3 {
        overseer.seat(slot, true, false);
    }
    let seats = [1, 2].map(|slot| Participant::new(page.open(), slot, Vec::new()));
    for seat in &seats {
        seat.set_state(SlotState::Connected);
    }
    overseer.set_phase(Phase::Run);
    let conductor = Conductor::new(page.open(), 0, 1_000_000);
    for (tick, ended) in (0..).zip([SlotState::Failed, SlotState::Stopped]) {
        conductor.post(tick);
        seats[1].done(tick);
        seats[0].set_state(ended);
        assert_eq!(conductor.wait(tick), TurnEnd::Idle, "{ended:?}");
        overseer.bury(1);
        assert_eq!(conductor.wait(tick), TurnEnd::Complete);
        overseer.reseat(1);
        seats[0].set_state(SlotState::Connected);
    }
    overseer.bury(1);
    // At the end of a run everybody leaves: the tick that they leave open is not complete.
    conductor.post(2);
    overseer.set_phase(Phase::Stop);
    seats[1].set_state(SlotState::Stopped);
    overseer.bury(2);
    assert_eq!(conductor.wait(2), TurnEnd::Stop);
}

#[test]
fn the_simulator_waits_for_a_recorder_that_lags_and_never_runs_further_ahead() {
    const LAG: usize = 8;
    let (page, overseer) = Page::new("lag", 1);
    overseer.set_phase(Phase::Run);
    let conductor = Conductor::new(page.open(), 0, LAG);
    std::thread::scope(|scope| {
        let recorder = overseer.clone();
        scope.spawn(move || {
            let mut recorded = 0;
            while recorded < 200 {
                recorder.wait_for_records(Duration::from_millis(20));
                let Some(completed) = recorder.completed_tick() else {
                    continue;
                };
                assert!(
                    completed + 1 - recorded <= LAG as u64,
                    "{completed} against {recorded}"
                );
                recorded = completed + 1;
                recorder.recorded(completed);
            }
        });
        for tick in 0..200 {
            assert!(conductor.complete(tick));
        }
    });
}

#[test]
fn a_stop_wakes_everybody() {
    let (page, overseer) = Page::new("stop", 2);
    overseer.seat(1, true, false);
    overseer.set_phase(Phase::Run);
    std::thread::scope(|scope| {
        let seat = Participant::new(page.open(), 1, Vec::new());
        scope.spawn(move || take_part(&seat, |_| panic!("no tick was posted")));
        let conductor = Conductor::new(page.open(), 0, 2);
        wait_connected(overseer.page(), 1..2);
        scope.spawn(move || {
            assert!(conductor.complete(0));
            // The recorder never comes: the next one waits until the stop.
            assert!(!conductor.complete(1));
        });
        overseer.set_phase(Phase::Stop);
    });
}

#[test]
fn in_real_time_a_late_process_gets_the_newest_tick() {
    let (page, overseer) = Page::new("late", 2);
    overseer.seat(1, true, false);
    overseer.set_phase(Phase::Run);
    let seat = Participant::new(page.open(), 1, Vec::new());
    let conductor = Conductor::new(page.open(), 0, 1);
    for tick in 0..5 {
        conductor.post_without_waiting(tick);
    }
    assert_eq!(seat.wait_newest(0, Duration::ZERO), Turn::Tick(4));
    assert_eq!(seat.wait_newest(5, Duration::ZERO), Turn::Idle);
    conductor.post_without_waiting(5);
    assert_eq!(seat.wait_newest(5, Duration::ZERO), Turn::Tick(5));
}

#[test]
fn one_that_joins_in_the_middle_of_a_run_waits_until_the_simulator_has_connected_to_it() {
    let (page, overseer) = Page::new("join", 3);
    let conductor = Conductor::new(page.open(), 0, 1);
    let mut connected = 0;
    let mut admit = || {
        let connect = || {
            connected += 1;
            Ok::<_, std::convert::Infallible>(())
        };
        conductor.admit(connect).unwrap();
        connected
    };
    let seat = |slot| Participant::new(page.open(), slot, Vec::new());
    assert!(!seat(1).joins_late(), "time has not started");
    overseer.set_phase(Phase::Run);
    conductor.post_without_waiting(0);
    assert_eq!(admit(), 0, "no request");
    overseer.bury(1);
    overseer.bury(2);
    std::thread::scope(|scope| {
        let joined: Vec<_> = [1, 2]
            .map(|slot| {
                overseer.reseat(slot);
                let seat = seat(slot);
                assert!(seat.joins_late());
                scope.spawn(move || seat.join(|| true))
            })
            .into();
        while joined.iter().any(|thread| !thread.is_finished()) {
            admit();
        }
        for thread in joined {
            assert!(thread.join().unwrap());
        }
    });
    assert!((1..=2).contains(&admit()), "once per request at most");
    assert!(!seat(1).join(|| false), "told to end");
    overseer.set_phase(Phase::Stop);
    assert!(!seat(1).join(|| true), "the run ends");
}

#[test]
fn a_dead_process_stays_dead_until_its_seat_is_given_again() {
    let (page, overseer) = Page::new("buried", 2);
    overseer.seat(1, true, false);
    let seat = Participant::new(page.open(), 1, Vec::new());
    seat.set_state(SlotState::Prepared);
    overseer.bury(1);
    seat.set_state(SlotState::Connected);
    assert_eq!(overseer.page().state(1), SlotState::Dead);
    overseer.reseat(1);
    assert_eq!(overseer.page().state(1), SlotState::Starting);
}

#[test]
fn pages_of_strangers_and_too_many_processes_are_refused() {
    let (page, _overseer) = Page::new("strange", 2);
    let error = TurnPage::create(&page.0, 2).unwrap_err();
    assert!(matches!(error, PageError::File { .. }), "{error}");
    std::fs::write(TurnPage::path_for(&page.0), b"something else").unwrap();
    let error = TurnPage::open(&page.0).unwrap_err().to_string();
    assert!(error.contains("14 bytes"), "{error}");
    let error = TurnPage::create("pt_many_", 65).unwrap_err().to_string();
    assert!(
        error.contains("65 processes") && error.contains("64"),
        "{error}"
    );
}
