//! Steps of worlds without other processes allocate no memory once the buffers have grown; instances are small.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use environment::{Arrays, Environments, Options};
use scenario::{Loader, MapCache};

static ALLOCATIONS: AtomicUsize = AtomicUsize::new(0);
/// Bytes in use.
static LIVE: AtomicUsize = AtomicUsize::new(0);
/// The counts are those of all threads.
static ONE_TEST: Mutex<()> = Mutex::new(());

struct Counting;

// SAFETY: forwards every request to the system's allocator unchanged; counting does not affect it.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ALLOCATIONS.fetch_add(1, Ordering::Relaxed);
        LIVE.fetch_add(layout.size(), Ordering::Relaxed);
        // SAFETY: the caller keeps the contract of `alloc`.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        LIVE.fetch_sub(layout.size(), Ordering::Relaxed);
        // SAFETY: the caller keeps the contract of `dealloc`; the pointer came from `System`.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static COUNTING: Counting = Counting;

#[test]
fn instances_with_built_in_opponents_are_small() {
    let _alone = ONE_TEST.lock().unwrap();
    assert_takes("chase_exact", 25_000);
    // Two beliefs of 400 hypotheses.
    assert_takes("chase", 150_000);
}

/// Asserts that an instance takes less memory (B).
fn assert_takes(scenario: &str, most: usize) {
    let draft = Loader::new(kinds::KINDS).draft(scenario).unwrap();
    let template = draft.template(&mut MapCache::default()).unwrap();
    // The map and its data, which all instances share, are there from the first on.
    let cache = std::sync::Arc::default();
    let bytes_of = |instances: usize| {
        let options = Options {
            instances,
            agents: vec!["evader".into()],
            ..Options::default()
        };
        let cache = std::sync::Arc::clone(&cache);
        let mut environments = Environments::new(template.clone(), options, cache).unwrap();
        let mut arrays = Arrays::new(environments.shape());
        let before = LIVE.load(Ordering::Relaxed);
        environments.reset(None, &mut arrays.as_mut()).unwrap();
        let actions = vec![0.0; environments.shape().actions()];
        for _ in 0..4 {
            environments.step(&actions, &mut arrays.as_mut()).unwrap();
        }
        LIVE.load(Ordering::Relaxed) - before
    };
    bytes_of(1);
    let (few, many) = (bytes_of(8), bytes_of(72));
    let each = (many - few) / 64;
    assert!(each < most, "{scenario}: {each} B");
}

#[test]
fn steps_do_not_allocate() {
    let _alone = ONE_TEST.lock().unwrap();
    let draft = Loader::new(kinds::KINDS).draft("chase_exact").unwrap();
    let template = draft.template(&mut MapCache::default()).unwrap();
    let options = Options {
        instances: 3,
        agents: vec!["police".into(), "evader".into()],
        ..Options::default()
    };
    let mut environments = Environments::new(template, options, std::sync::Arc::default()).unwrap();
    let mut arrays = Arrays::new(environments.shape());
    // The robots turn in circles, and touch walls and each other no more than they have before.
    let actions: Vec<f32> = (0..environments.shape().actions())
        .map(|k| if k % 2 == 0 { 0.6 } else { 0.8 })
        .collect();
    let mut run = |steps: usize, seed: Option<u64>| {
        environments.reset(seed, &mut arrays.as_mut()).unwrap();
        let before = ALLOCATIONS.load(Ordering::Relaxed);
        for _ in 0..steps {
            environments.step(&actions, &mut arrays.as_mut()).unwrap();
        }
        assert_eq!(arrays.lengths, [steps as u64; 3], "no episode has ended");
        ALLOCATIONS.load(Ordering::Relaxed) - before
    };
    run(1100, Some(1));
    // The memory of the next episode is that of the last one.
    assert_eq!(run(1000, None), 0);
}
