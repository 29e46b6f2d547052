//! What one turn of the page costs: post, everybody does the tick, the conductor goes on. Threads
//! stand in for processes, each with a mapping of its own, and do nothing in their turn; beside the
//! same on a standard library barrier, which threads of one process could use instead.
//!
//! Measured before with processes on one core of another machine of this kind: a futex page turns
//! 39 000 to 42 000 ticks/s with 8 of them, data included; events 19 000.

use std::hint::black_box;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Barrier};
use std::time::{Duration, Instant};

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use runtime::lockstep::{
    Conductor, Overseer, Participant, Phase, SlotState, Turn, TurnEnd, TurnPage,
};

/// How many take part beside the conductor.
const MEMBERS: [usize; 4] = [1, 2, 4, 8];

/// A page of its own, with members at work on it; both go when it is dropped.
struct Table {
    prefix: String,
    overseer: Overseer,
    conductor: Conductor,
    next: u64,
    members: Vec<std::thread::JoinHandle<()>>,
}

impl Table {
    fn lay(members: usize) -> Self {
        let prefix = format!("pbench_{}_{members}_", std::process::id());
        let page = TurnPage::create(&prefix, members + 1).expect("a page");
        let overseer = Overseer::new(Arc::new(page));
        for slot in 1..=members {
            overseer.seat(slot, true, false);
        }
        let open = || Arc::new(TurnPage::open(&prefix).expect("a page"));
        let threads = (1..=members)
            .map(|slot| {
                let seat = Participant::new(open(), slot, Vec::new());
                std::thread::spawn(move || take_part(&seat))
            })
            .collect();
        let table = Self {
            conductor: Conductor::new(open(), 0, usize::MAX),
            overseer,
            prefix,
            next: 0,
            members: threads,
        };
        let page = table.overseer.page();
        while (1..=members).any(|slot| page.state(slot) != SlotState::Connected) {
            std::thread::yield_now();
        }
        table
    }

    fn turn(&mut self) {
        self.conductor.post(self.next);
        while self.conductor.wait(self.next) != TurnEnd::Complete {}
        self.next += 1;
    }
}

impl Drop for Table {
    fn drop(&mut self) {
        self.overseer.set_phase(Phase::Stop);
        for member in self.members.drain(..) {
            let _ = member.join();
        }
        let _ = std::fs::remove_file(TurnPage::path_for(&self.prefix));
    }
}

fn take_part(seat: &Participant) {
    seat.set_state(SlotState::Connected);
    let mut next = 0;
    loop {
        match seat.wait_turn(next) {
            Turn::Tick(tick) => {
                seat.done(black_box(tick));
                next += 1;
            }
            Turn::Idle => {}
            Turn::Stop => return,
        }
    }
}

/// Two rounds of a barrier per turn: everybody begins, everybody is done.
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
