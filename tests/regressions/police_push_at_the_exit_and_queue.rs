//! Police at the exit pushed evaders, caught them outside the city, and elsewhere followed one evader in file.

use std::sync::LazyLock;

use serde_json::Value as Json;

use crate::support::Sandbox;
use crate::support::history::History;

/// Code of the Police, of a robot in play, and of the event of a capture.
const POLICE: u8 = 1;
const ACTIVE: u8 = 0;
const CAPTURED: u32 = 0;

/// Summaries and histories of the default game with the seeds 1 to 8: whole games, about 20 s on one core.
static GAMES: LazyLock<Vec<(Json, History)>> = LazyLock::new(|| {
    let sandbox = Sandbox::new();
    let play = |seed: u32| {
        let (seed, log) = (seed.to_string(), format!("{seed}.mcap"));
        let words = [
            "run",
            "chase",
            "--in-process",
            "--quiet",
            "--seed",
            &seed,
            "--out",
            &log,
        ];
        let summary = sandbox.protean(words).json();
        (summary, History::read(&sandbox.path().join(log)))
    };
    (1..=8).map(play).collect()
});

#[test]
fn no_evader_is_caught_outside_the_city_and_no_robot_is_pushed() {
    let mut captures = 0;
    for (summary, history) in &*GAMES {
        for event in history.events.iter().filter(|e| e.kind == CAPTURED) {
            captures += 1;
            let inside = event.x.abs() < 9.0 && event.y.abs() < 9.0;
            assert!(inside, "{event:?}");
        }
        let contacts: u64 = summary["robots"]
            .as_array()
            .unwrap()
            .iter()
            .map(|robot| robot["contacts"].as_u64().unwrap())
            .sum();
        assert!(contacts <= 2, "{contacts} contacts: {summary}");
    }
    assert!(captures > 0);
}

#[test]
fn police_do_not_follow_an_evader_in_file() {
    let (mut close, mut ticks) = (0_u32, 0_u32);
    for state in GAMES.iter().flat_map(|(_, history)| &history.states) {
        let police: Vec<_> = state
            .robots
            .iter()
            .filter(|robot| robot.team == POLICE && robot.status == ACTIVE)
            .collect();
        let is_close = police.iter().enumerate().any(|(i, a)| {
            police[..i]
                .iter()
                .any(|b| (a.x - b.x).powi(2) + (a.y - b.y).powi(2) < 1.0)
        });
        close += u32::from(is_close);
        ticks += 1;
    }
    let share = f64::from(close) / f64::from(ticks);
    // 0.24 to 0.5 with Police that follow in file; these come near each other when they cut off the last evader.
    assert!(share < 0.2, "two Police within 1 m in {share} of all ticks");
}
