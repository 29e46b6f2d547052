//! Cost of one tick of the barrier: the leader posts, all members finish, the leader continues.
//! Threads stand in for processes, each with its own mapping, and do no work. Baseline: the barrier
//! of the standard library, which works only within one process.
//!
//! Measured earlier, with processes on one core of another machine of this kind: 39 000 to 42 000
//! ticks/s of a futex barrier with 8 processes, data included; 19 000 with events.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::hint::black_box;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Barrier};
use std::time::{Duration, Instant};

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use runtime::lockstep::{
    BarrierLeader, BarrierMember, BarrierMonitor, Phase, SlotState, TickBarrier, TickEnd, TickWait,
};

/// Number of barrier members.
const MEMBERS: [usize; 4] = [1, 2, 4, 8];

/// A barrier with working members; dropping it ends them.
struct Table {
    prefix: String,
    monitor: BarrierMonitor,
    leader: BarrierLeader,
    next: u64,
    members: Vec<std::thread::JoinHandle<()>>,
}

impl Table {
    fn lay(members: usize) -> Self {
        let prefix = format!("pbench_{}_{members}_", std::process::id());
        let barrier = TickBarrier::create(&prefix, members + 1).expect("a page");
        let monitor = BarrierMonitor::new(Arc::new(barrier));
        for slot in 1..=members {
            monitor.assign_slot(slot, true, false);
        }
        let open = || Arc::new(TickBarrier::open(&prefix).expect("a page"));
        let threads = (1..=members)
            .map(|slot| {
                let member = BarrierMember::new(open(), slot, Vec::new());
                std::thread::spawn(move || take_part(&member))
            })
            .collect();
        let table = Self {
            leader: BarrierLeader::new(open(), 0, usize::MAX),
            monitor,
            prefix,
            next: 0,
            members: threads,
        };
        let barrier = table.monitor.barrier();
        while (1..=members).any(|slot| barrier.state(slot) != SlotState::Connected) {
            std::thread::yield_now();
        }
        table
    }

    fn turn(&mut self) {
        self.leader.post(self.next);
        while self.leader.wait(self.next) != TickEnd::Complete {}
        self.next += 1;
    }
}

impl Drop for Table {
    fn drop(&mut self) {
        self.monitor.set_phase(Phase::Stop);
        for member in self.members.drain(..) {
            let _ = member.join();
        }
        let _ = std::fs::remove_file(TickBarrier::path_for(&self.prefix));
    }
}

fn take_part(member: &BarrierMember) {
    member.set_state(SlotState::Connected);
    let mut next = 0;
    loop {
        match member.wait_tick(next) {
            TickWait::Tick(tick) => {
                member.done(black_box(tick));
                next += 1;
            }
            TickWait::Idle => {}
            TickWait::Stop => return,
        }
    }
}

/// Two rounds of a barrier per tick: all begin, all have finished.
fn barrier_turns(members: usize, turns: u64) -> Duration {
    let barrier = Barrier::new(members + 1);
    let over = AtomicBool::new(false);
    std::thread::scope(|scope| {
        for _ in 0..members {
            scope.spawn(|| {
                loop {
                    barrier.wait();
                    if over.load(Ordering::Relaxed) {
                        return;
                    }
                    barrier.wait();
                }
            });
        }
        let start = Instant::now();
        for _ in 0..turns {
            barrier.wait();
            barrier.wait();
        }
        let took = start.elapsed();
        over.store(true, Ordering::Relaxed);
        barrier.wait();
        took
    })
}

fn turns(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("turn");
    group.throughput(Throughput::Elements(1));
    for members in MEMBERS {
        let mut table = Table::lay(members);
        group.bench_function(BenchmarkId::new("page", members), |b| {
            b.iter(|| table.turn());
        });
        drop(table);
        group.bench_function(BenchmarkId::new("std barrier", members), |b| {
            b.iter_custom(|n| barrier_turns(members, n));
        });
    }
    group.finish();
}

criterion_group! {
    name = all;
    config = Criterion::default()
        .warm_up_time(Duration::from_millis(300))
        .measurement_time(Duration::from_secs(1))
        .sample_size(20);
    targets = turns
}
criterion_main!(all);
