//! The tick barrier with threads in the place of processes (each with its own mapping).

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

use runtime::lockstep::{
    BarrierError, BarrierLeader, BarrierMember, BarrierMonitor, Pacing, Phase, SlotState,
    TickBarrier, TickEnd, TickWait,
};

/// Separate barrier of a test, removed also when the test fails.
pub struct Barrier(String);

impl Barrier {
    pub fn new(name: &str, processes: usize) -> (Self, BarrierMonitor) {
        let prefix = format!("pt_{}_{name}_", std::process::id());
        let barrier = TickBarrier::create(&prefix, processes).unwrap();
        (Self(prefix), BarrierMonitor::new(Arc::new(barrier)))
    }

    pub fn open(&self) -> Arc<TickBarrier> {
        Arc::new(TickBarrier::open(&self.0).unwrap())
    }
}

impl Drop for Barrier {
    fn drop(&mut self) {
        let _ = std::fs::remove_file(TickBarrier::path_for(&self.0));
    }
}

/// Steps ticks until the run stops; `step` gets every tick once and in order.
fn take_part(member: &BarrierMember, mut step: impl FnMut(u64) -> bool) {
    member.set_state(SlotState::Connected);
    let mut next = 0;
    loop {
        match member.wait_tick(next) {
            TickWait::Tick(tick) => {
                assert_eq!(tick, next);
                if !step(tick) {
                    return;
                }
                member.done(tick);
                next += 1;
            }
            TickWait::Idle => {}
            TickWait::Stop => return,
        }
    }
}

fn conduct(leader: &BarrierLeader, ticks: u64, mut after: impl FnMut(u64)) {
    for tick in 0..ticks {
        leader.post(tick);
        loop {
            match leader.wait(tick) {
                TickEnd::Complete => break,
                TickEnd::Idle => {}
                TickEnd::Stop => panic!("this run is never stopped"),
            }
        }
        after(tick);
    }
}

fn wait_connected(barrier: &TickBarrier, slots: core::ops::Range<usize>) {
    while slots
        .clone()
        .any(|slot| barrier.state(slot) != SlotState::Connected)
    {
        std::thread::yield_now();
    }
}

#[test]
fn every_tick_is_done_by_all_members_before_the_next_and_downstream_after_upstream() {
    const TICKS: u64 = 3000;
    let (barrier, monitor) = Barrier::new("order", 6);
    // 1 is upstream of 2 and 3; 4 and 5 follow the simulator only.
    for slot in 1..6 {
        monitor.assign_slot(slot, true, slot == 1);
    }
    let counts: Vec<AtomicU64> = (0..6).map(|_| AtomicU64::new(0)).collect();
    std::thread::scope(|scope| {
        for slot in 1..6 {
            let upstream = if slot == 2 || slot == 3 {
                vec![1]
            } else {
                Vec::new()
            };
            let member = BarrierMember::new(barrier.open(), slot, upstream.clone());
            let counts = &counts;
            scope.spawn(move || {
                take_part(&member, |tick| {
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
        wait_connected(monitor.barrier(), 1..6);
        monitor.set_phase(Phase::Run);
        let leader = BarrierLeader::new(barrier.open(), 0, 1_000_000);
        conduct(&leader, TICKS, |tick| {
            for count in &counts[1..] {
                assert_eq!(count.load(Ordering::SeqCst), tick + 1);
            }
        });
        monitor.set_phase(Phase::Stop);
    });
}

#[test]
fn a_process_that_dies_in_the_middle_of_a_tick_is_taken_out_of_the_count() {
    let (barrier, monitor) = Barrier::new("death", 4);
    for slot in 1..4 {
        monitor.assign_slot(slot, true, slot == 1);
    }
    let (died, death) = std::sync::mpsc::channel();
    std::thread::scope(|scope| {
        for slot in 1..4 {
            // 3 waits for 1, which dies at tick 50 without a message.
            let upstream = if slot == 3 { vec![1] } else { Vec::new() };
            let member = BarrierMember::new(barrier.open(), slot, upstream);
            let died = died.clone();
            scope.spawn(move || {
                take_part(&member, |tick| {
                    let dies = slot == 1 && tick == 50;
                    if dies {
                        died.send(()).unwrap();
                    }
                    !dies
                });
            });
        }
        wait_connected(monitor.barrier(), 1..4);
        monitor.set_phase(Phase::Run);
        let gravedigger = monitor.clone();
        scope.spawn(move || {
            death.recv().unwrap();
            gravedigger.mark_dead(1);
        });
        let leader = BarrierLeader::new(barrier.open(), 0, 1_000_000);
        conduct(&leader, 200, |_| {});
        assert_eq!(monitor.barrier().ticks_done(1), 50);
        assert_eq!(monitor.barrier().ticks_done(3), 200);
        monitor.set_phase(Phase::Stop);
    });
}

#[test]
fn the_world_keeps_the_pace_of_the_orchestrator_and_is_held_and_stepped() {
    let (barrier, monitor) = Barrier::new("paced", 1);
    monitor.set_phase(Phase::Run);
    let leader = BarrierLeader::new(barrier.open(), 0, 1_000_000);
    let start = Instant::now();
    let mut pacing = Pacing::new(Duration::from_millis(40));
    monitor.pace(4.0, false, 0);
    for _ in 0..5 {
        assert!(leader.wait_until_due(&mut pacing, || true));
    }
    assert!(start.elapsed() >= Duration::from_millis(50));
    // Two steps at once; the third waits for its order.
    monitor.pace(0.001, true, 2);
    for _ in 0..2 {
        assert!(leader.wait_until_due(&mut pacing, || true));
    }
    let steps = AtomicU64::new(0);
    std::thread::scope(|scope| {
        scope.spawn(|| {
            while leader.wait_until_due(&mut pacing, || true) {
                steps.fetch_add(1, Ordering::SeqCst);
            }
        });
        let waits = || {
            let from = monitor.barrier().ticks_done(0);
            while monitor.barrier().ticks_done(0) < from + 2 {
                std::thread::yield_now();
            }
        };
        waits();
        assert_eq!(steps.load(Ordering::SeqCst), 0);
        monitor.pace(0.001, true, 3);
        waits();
        assert_eq!(steps.load(Ordering::SeqCst), 1);
        // Let go, it waits for the next tick at a slow pace; a fast one counts at once.
        monitor.pace(0.001, false, 3);
        waits();
        assert_eq!(steps.load(Ordering::SeqCst), 1);
        monitor.pace(f64::INFINITY, false, 3);
        while steps.load(Ordering::SeqCst) < 1000 {
            std::thread::yield_now();
        }
        monitor.set_phase(Phase::Stop);
    });
    monitor.set_phase(Phase::Run);
    monitor.pace(1.0, true, 3);
    let mut pacing = Pacing::new(Duration::from_millis(40));
    assert!(leader.wait_until_due(&mut pacing, || true), "older steps");
    assert!(
        !leader.wait_until_due(&mut pacing, || false),
        "it is to end"
    );
}

#[test]
fn the_world_waits_for_a_process_that_ended_until_the_orchestrator_has_decided() {
    let (barrier, monitor) = Barrier::new("ended", 3);
    for slot in 1..3 {
        monitor.assign_slot(slot, true, false);
    }
    let members = [1, 2].map(|slot| BarrierMember::new(barrier.open(), slot, Vec::new()));
    for member in &members {
        member.set_state(SlotState::Connected);
    }
    monitor.set_phase(Phase::Run);
    let leader = BarrierLeader::new(barrier.open(), 0, 1_000_000);
    for (tick, ended) in (0..).zip([SlotState::Failed, SlotState::Stopped]) {
        leader.post(tick);
        members[1].done(tick);
        members[0].set_state(ended);
        assert_eq!(leader.wait(tick), TickEnd::Idle, "{ended:?}");
        monitor.mark_dead(1);
        assert_eq!(leader.wait(tick), TickEnd::Complete);
        monitor.reset_slot(1);
        members[0].set_state(SlotState::Connected);
    }
    monitor.mark_dead(1);
    // At the end of a run all members leave: their unfinished tick is not complete.
    leader.post(2);
    monitor.set_phase(Phase::Stop);
    members[1].set_state(SlotState::Stopped);
    monitor.mark_dead(2);
    assert_eq!(leader.wait(2), TickEnd::Stop);
}

#[test]
fn the_simulator_waits_for_a_recorder_that_lags_and_never_runs_further_ahead() {
    const LAG: usize = 8;
    let (barrier, monitor) = Barrier::new("lag", 1);
    monitor.set_phase(Phase::Run);
    let leader = BarrierLeader::new(barrier.open(), 0, LAG);
    std::thread::scope(|scope| {
        let recorder = monitor.clone();
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
            assert!(leader.complete(tick));
        }
    });
}

#[test]
fn a_stop_wakes_all_members() {
    let (barrier, monitor) = Barrier::new("stop", 2);
    monitor.assign_slot(1, true, false);
    monitor.set_phase(Phase::Run);
    std::thread::scope(|scope| {
        let member = BarrierMember::new(barrier.open(), 1, Vec::new());
        scope.spawn(move || take_part(&member, |_| panic!("no tick was posted")));
        let leader = BarrierLeader::new(barrier.open(), 0, 2);
        wait_connected(monitor.barrier(), 1..2);
        scope.spawn(move || {
            assert!(leader.complete(0));
            // The recorder never arrives: the next tick waits until the stop.
            assert!(!leader.complete(1));
        });
        monitor.set_phase(Phase::Stop);
    });
}

#[test]
fn in_real_time_a_late_process_gets_the_newest_tick() {
    let (barrier, monitor) = Barrier::new("late", 2);
    monitor.assign_slot(1, true, false);
    monitor.set_phase(Phase::Run);
    let member = BarrierMember::new(barrier.open(), 1, Vec::new());
    let leader = BarrierLeader::new(barrier.open(), 0, 1);
    for tick in 0..5 {
        leader.post_without_waiting(tick);
    }
    assert_eq!(member.wait_newest(0, Duration::ZERO), TickWait::Tick(4));
    assert_eq!(member.wait_newest(5, Duration::ZERO), TickWait::Idle);
    leader.post_without_waiting(5);
    assert_eq!(member.wait_newest(5, Duration::ZERO), TickWait::Tick(5));
}

#[test]
fn a_late_joiner_waits_until_the_simulator_has_connected_to_it() {
    let (barrier, monitor) = Barrier::new("join", 3);
    let leader = BarrierLeader::new(barrier.open(), 0, 1);
    let mut connected = 0;
    let mut admit = || {
        let connect = || {
            connected += 1;
            Ok::<_, std::convert::Infallible>(())
        };
        leader.admit(connect).unwrap();
        connected
    };
    let member = |slot| BarrierMember::new(barrier.open(), slot, Vec::new());
    assert!(!member(1).joins_late(), "time has not started");
    monitor.set_phase(Phase::Run);
    leader.post_without_waiting(0);
    assert_eq!(admit(), 0, "no request");
    monitor.mark_dead(1);
    monitor.mark_dead(2);
    std::thread::scope(|scope| {
        let joined: Vec<_> = [1, 2]
            .map(|slot| {
                monitor.reset_slot(slot);
                let member = member(slot);
                assert!(member.joins_late());
                scope.spawn(move || member.join(|| true))
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
    assert!(!member(1).join(|| false), "stop requested");
    monitor.set_phase(Phase::Stop);
    assert!(!member(1).join(|| true), "the run ends");
}

#[test]
fn a_dead_process_stays_dead_until_its_slot_is_reset() {
    let (barrier, monitor) = Barrier::new("dead", 2);
    monitor.assign_slot(1, true, false);
    let member = BarrierMember::new(barrier.open(), 1, Vec::new());
    member.set_state(SlotState::Prepared);
    monitor.mark_dead(1);
    member.set_state(SlotState::Connected);
    assert_eq!(monitor.barrier().state(1), SlotState::Dead);
    monitor.reset_slot(1);
    assert_eq!(monitor.barrier().state(1), SlotState::Starting);
}

#[test]
fn files_of_other_programs_and_too_many_processes_are_refused() {
    let (barrier, _monitor) = Barrier::new("strange", 2);
    let error = TickBarrier::create(&barrier.0, 2).unwrap_err();
    assert!(matches!(error, BarrierError::File { .. }), "{error}");
    std::fs::write(TickBarrier::path_for(&barrier.0), b"something else").unwrap();
    let error = TickBarrier::open(&barrier.0).unwrap_err().to_string();
    assert!(error.contains("14 bytes"), "{error}");
    let error = TickBarrier::create("pt_many_", 65).unwrap_err().to_string();
    assert!(
        error.contains("65 processes") && error.contains("64"),
        "{error}"
    );
}
