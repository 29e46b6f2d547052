//! A step allocates no memory once its buffers have grown.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;

use geometry::map::MapSpec;
use geometry::pose::{Pose2, Twist2};
use robot::spec::{RobotSpec, ScanSpec};
use robot::team::Role;
use sim_backend::spec::{CaptureSpec, RulesSpec, WorldSpec};
use sim_backend::world::World;
use testing::circle;

static ALLOCATIONS: AtomicUsize = AtomicUsize::new(0);

struct Counting;

// SAFETY: forwards every request to the system's allocator unchanged; counting does not affect it.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ALLOCATIONS.fetch_add(1, Ordering::Relaxed);
        // SAFETY: the caller keeps the contract of `alloc`.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: the caller keeps the contract of `dealloc`; the pointer came from `System`.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static COUNTING: Counting = Counting;

#[test]
fn steps_scans_and_views_do_not_allocate() {
    let map = testing::map([0.0, 0.0], [6.0, 6.0], 0.05, [circle([3.0, 3.0], 1.0)]);
    let places = [
        (1.0, 1.0),
        (1.5, 1.0),
        (5.0, 5.0),
        (5.0, 1.0),
        (1.0, 5.0),
        (3.0, 1.0),
    ];
    let robots = places.iter().enumerate().map(|(i, &(x, y))| {
        let role = if i < 4 { Role::Pursuer } else { Role::Evader };
        let mut robot = RobotSpec::new(&format!("r{i}"), role, Pose2::new(x, y, i as f64));
        robot.scan = Some(ScanSpec::default());
        robot
    });
    let mut world = World::new(WorldSpec {
        map: MapSpec::Vector(map),
        robots: robots.collect(),
        rules: RulesSpec {
            capture: Some(CaptureSpec::default()),
            ..RulesSpec::default()
        },
        seed: 1,
    })
    .unwrap();
    let mut ranges = Vec::new();
    let mut run = |steps: usize| {
        let mut events = 0;
        for k in 0..steps {
            let turn = if k % 100 < 50 { 0.7 } else { -0.4 };
            let commands = [Some(Twist2::new(0.2, turn)); 6];
            events += world.step(&commands, Duration::from_millis(50)).len();
            world.scan(k % 6, &mut ranges);
            world.sees(0, 5);
        }
        events
    };
    // Robots hit walls and each other from the first seconds on.
    assert!(run(4000) > 10);
    let before = ALLOCATIONS.load(Ordering::Relaxed);
    let events = run(4000);
    assert_eq!(ALLOCATIONS.load(Ordering::Relaxed), before);
    assert!(events > 10, "contacts go on: {events}");
}
