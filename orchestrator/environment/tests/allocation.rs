//! Steps of worlds without other processes allocate no memory once the buffers have grown.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicUsize, Ordering};

use environment::{Arrays, Environments, Options};
use scenario::{Loader, MapCache};

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
fn steps_do_not_allocate() {
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
