//! Claims about single plans.

use statistics::{Mean, wilson};

use crate::claim::{Finding, Measured, Unit, Verdict};
use crate::plans::{Plan, Plans};
use crate::words::{hundredths, share, shares};

/// Iterations after which the paper stopped searching on arcs.
const MAX_PAPER_ITERATIONS: u32 = 5000;
/// Minimum increase of the distance from the Police that counts as avoiding them (m): a quarter of
/// a street.
const MIN_AVOIDANCE: f64 = 0.25;

/// Claim (g).
pub(super) fn arcs(plans: &Plans, paper: bool) -> Finding {
    let case = if paper {
        "rrt_star_arc_paper"
    } else {
        "rrt_star_arc"
    };
    let tried: Vec<&Plan> = plans
        .of(case, "start")
        .filter(|p| p.iterations <= MAX_PAPER_ITERATIONS)
        .collect();
    if tried.is_empty() {
        return Finding::missing(&format!("plans of {case} at the start of a game"));
    }
    let found = tried.iter().filter(|p| p.found).count() as u64;
    let interval = wilson(found, tried.len() as u64);
    let verdict = if interval.low > 0.5 {
        Verdict::Refuted
    } else if interval.high < 0.5 {
        Verdict::Confirmed
    } else {
        Verdict::Undecided
    };
    let share_found = found as f64 / tried.len() as f64;
    let plans = (tried.len() as u64, "plans");
    let ours = Measured::number(share_found, interval, Unit::Share, plans);
    let most = tried.iter().map(|p| p.iterations).max().unwrap_or(0);
    let mut numbers = vec![format!(
        "A path within {most} iterations: {found} of {} ({}, {})",
        tried.len(),
        share(share_found),
        shares(interval)
    )];
    let lengths: Vec<f64> = tried.iter().filter_map(|p| p.length_m).collect();
    if let (Some(mean), Some(shortest)) =
        (Mean::of(&lengths), tried.iter().find_map(|p| p.shortest_m))
    {
        numbers.push(format!(
            "Mean length of the paths: {} m; the shortest path is {} m",
            hundredths(mean.value),
            hundredths(shortest)
        ));
    }
    Finding {
        verdict,
        ours,
        numbers,
    }
}

/// Claim (h).
pub(super) fn avoids(plans: &Plans, paper: bool) -> Finding {
    let case = if paper {
        "rrt_star_line_paper"
    } else {
        "rrt_star_line"
    };
    let paired: Vec<_> = plans
        .of(case, "random")
        .filter(|p| p.found)
        .filter_map(|p| Some((p, p.closest_m?, p.shortest_closest_m?)))
        .collect();
    let gains: Vec<f64> = paired
        .iter()
        .map(|(_, ours, shortest)| ours - shortest)
        .collect();
    let Some(gain) = Mean::of(&gains) else {
        return Finding::missing(&format!("plans of {case} among Police at random places"));
    };
    let interval = gain.interval();
    let verdict = Verdict::above(interval, MIN_AVOIDANCE);
    let ours = Measured::number(
        gain.value,
        interval,
        Unit::Number(2, "m"),
        (gains.len() as u64, "plans"),
    );
    let farther = gains.iter().filter(|g| **g > 0.01).count();
    let nearer = gains.iter().filter(|g| **g < -0.01).count();
    let mut numbers = vec![
        format!(
            "Farther from the nearest Police by {} m on average ({} … {} m), {} plans",
            hundredths(gain.value),
            hundredths(interval.low),
            hundredths(interval.high),
            gains.len()
        ),
        format!("Farther in {farther}, nearer in {nearer} of them"),
    ];
    let detours = paired
        .iter()
        .filter_map(|(p, ..)| Some(p.length_m? / p.shortest_m? - 1.0));
    let detours: Vec<f64> = detours.collect();
    if let Some(detour) = Mean::of(&detours) {
        numbers.push(format!(
            "The path is {} longer on average",
            share(detour.value)
        ));
    }
    Finding {
        verdict,
        ours,
        numbers,
    }
}
