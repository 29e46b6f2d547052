//! The floor of a patrol of the police district of San Francisco in `RoSSO` (John et al., ICRA 2024, arXiv 2309.08742;
//! travel times in minutes between 12 places, from its repository), and simulated attacks of the best response.
//!
//! `cargo run --release -p patrol_chain --example san_francisco [duration] [starts] [attacks]`: attacks of 9 minutes, 4
//! random starts, a million attacks by default.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::time::Instant;

use patrol_chain::{Capture, Chain, KeyedStream, TravelTimes, optimise};
use rand::SeedableRng as _;
use rand_chacha::ChaCha8Rng;

/// Travel times (minutes); a wait at a place takes one.
const MINUTES: [[u32; 12]; 12] = [
    [1, 3, 3, 5, 4, 6, 3, 5, 7, 4, 6, 6],
    [3, 1, 5, 4, 2, 4, 4, 5, 5, 3, 5, 5],
    [3, 5, 1, 7, 6, 8, 3, 4, 9, 4, 8, 7],
    [6, 4, 7, 1, 5, 6, 4, 7, 5, 6, 6, 7],
    [4, 3, 6, 5, 1, 3, 5, 5, 6, 3, 4, 4],
    [6, 4, 8, 5, 3, 1, 6, 7, 3, 6, 2, 3],
    [2, 5, 3, 5, 6, 7, 1, 5, 7, 5, 7, 8],
    [3, 5, 2, 7, 6, 7, 3, 1, 9, 3, 7, 5],
    [8, 6, 9, 4, 6, 4, 6, 9, 1, 8, 5, 7],
    [4, 3, 4, 6, 3, 5, 5, 3, 7, 1, 5, 3],
    [6, 4, 8, 6, 4, 2, 6, 6, 4, 5, 1, 3],
    [6, 4, 6, 6, 3, 3, 6, 4, 5, 3, 2, 1],
];

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut words = std::env::args().skip(1);
    let mut number = |default| words.next().map_or(Ok(default), |word| word.parse());
    let (duration, starts, attacks) = (number(9)?, number(4)?, number(1_000_000)?);
    let edges = (0..12).flat_map(|i| (0..12).map(move |j| (i, j, MINUTES[i][j])));
    let times = TravelTimes::new(12, edges)?;
    let durations = [duration; 12];

    let floor = |chain: &Chain| Capture::new(chain, &durations).map(|c| c.best_response());
    let walk = floor(&Chain::uniform(times.clone()))?.probability;
    println!("random walk             floor {walk:.6}");
    for seed in 1..=starts {
        let began = Instant::now();
        let chain = optimise(
            &times,
            &durations,
            1,
            &mut ChaCha8Rng::seed_from_u64(seed.into()),
        )?;
        let response = floor(&chain)?;
        let seconds = began.elapsed().as_secs_f64();
        let (from, at, probability) = (response.from, response.at, response.probability);
        print!("start {seed}   {seconds:6.2} s   floor {probability:.6}");
        println!("   the best response leaves {from} behind and attacks {at}");
        if attacks > 0 {
            let share = captured(&chain, from, at, duration, attacks, seed);
            println!("   captured in {attacks} attacks: {share:.6}");
        }
    }
    Ok(())
}

/// The share of attacks in which a robot that leaves a node comes to the attacked one in time.
fn captured(chain: &Chain, from: usize, at: usize, duration: u32, attacks: u32, seed: u32) -> f64 {
    let mut count = 0;
    let mut key = [0; 32];
    for attack in 0..attacks {
        key[..4].copy_from_slice(&attack.to_le_bytes());
        key[4..8].copy_from_slice(&seed.to_le_bytes());
        let (mut node, mut left) = (from, duration);
        let mut stream = KeyedStream::new(key);
        loop {
            let next = chain.draw(node, &mut stream);
            let edges = chain.times().from(node);
            let edge = edges.iter().find(|edge| edge.to == next).unwrap();
            let Some(rest) = left.checked_sub(edge.time) else {
                break;
            };
            if next == at {
                count += 1;
                break;
            }
            (node, left) = (next, rest);
        }
    }
    f64::from(count) / f64::from(attacks)
}
