//! Rewards: events times weights, and progress along the way.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod learner;

use environment::{Autoreset, EVENT_NAMES, Options, RewardWeights};
use learner::{Learner, options, template};

#[test]
fn rewards_are_events_times_weights() {
    // An evader drives from a start beside the exit into it; the Police stand far away.
    let starts = "robots.evader_1.start={ x = 8.3, y = 0.0, theta = 0.0 }";
    let template = template("chase_exact", &[starts]);
    let rewards = RewardWeights {
        escape: 5.0,
        lost: -2.0,
        time: -0.5,
        ..RewardWeights::default()
    };
    let options = Options {
        rewards,
        ..options(&["police_1", "evader_1"], "state")
    };
    let mut learner = Learner::new(template, options);
    learner.reset(Some(1));
    let (escape, lost) = (0, 3);
    assert_eq!((EVENT_NAMES[escape], EVENT_NAMES[lost]), ("escape", "lost"));
    for step in 1..200 {
        let actions = [0.0, 0.0, 1.0, 0.0];
        learner
            .environments
            .step(&actions, &mut learner.arrays.as_mut())
            .unwrap();
        let arrays = &learner.arrays;
        let time = -0.5 * 0.05;
        if arrays.statuses[1] == 2 {
            assert_eq!(arrays.events[6 + escape], 1.0);
            assert_eq!(arrays.events[lost], 1.0);
            assert_eq!(arrays.rewards, [time - 2.0, time + 5.0]);
            assert_eq!(arrays.reward_sums, [(time - 2.0) + (time + 5.0)]);
            assert!((arrays.returns[1] - (5.0 + time * f64::from(step))).abs() < 1e-9);
            assert!(!arrays.terminated[0], "a Police agent is still in the game");
            return;
        }
        assert_eq!(arrays.rewards, [time, time]);
    }
    panic!("the evader did not reach the exit");
}

#[test]
fn progress_is_rewarded_per_metre_of_the_way_that_became_shorter() {
    let goal = "robots.police_1.goal={ circle = { center = [-4.5, 4.5], radius = 0.3 } }";
    let template = template("chase_exact", &[goal, "rules.time_limit=3.0"]);
    for (autoreset, ticks) in [(Autoreset::SameStep, 1), (Autoreset::NextStep, 4)] {
        let options = Options {
            rewards: RewardWeights {
                progress: 0.5,
                ..RewardWeights::default()
            },
            autoreset,
            ticks_per_action: ticks,
            ..options(&["evader_1", "police_1", "police_2"], "state+path")
        };
        let mut learner = Learner::new(template.clone(), options);
        learner.reset(Some(1));
        let layouts = learner.environments.layouts();
        let names = layouts[0].names();
        let entry = names.iter().position(|name| name == "path.proximity");
        let length = |observations: &[f32]| 1.0 / f64::from(observations[entry.unwrap()]) - 1.0;
        // Two episodes: the reset between them is no progress.
        for _ in 0..2 {
            let mut before = length(&learner.arrays.observations);
            let mut sums = [0.0; 3];
            for step in 1.. {
                learner.step();
                let arrays = &learner.arrays;
                for (sum, reward) in sums.iter_mut().zip(&arrays.rewards) {
                    *sum += reward;
                }
                assert_eq!(arrays.rewards.iter().sum::<f64>(), arrays.reward_sums[0]);
                if arrays.truncated[0] {
                    assert_eq!(step, 60 / ticks);
                    assert_eq!(arrays.returns, sums);
                    break;
                }
                let now = length(&arrays.observations);
                assert!((arrays.rewards[0] - 0.5 * (before - now)).abs() < 1e-4);
                before = now;
            }
            // An evader to the exit, a Police robot to its goal; Police without a goal go nowhere.
            assert!(sums[0].abs() > 0.05 && sums[1].abs() > 0.05, "{sums:?}");
            assert_eq!(sums[2], 0.0);
            if autoreset == Autoreset::NextStep {
                learner.step();
                assert_eq!(learner.arrays.rewards, [0.0; 3]);
            }
        }
    }
}
