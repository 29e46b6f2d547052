//! Episodes: histories, seeds, threads, ends and rewards.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod learner;
mod scripted;

use std::sync::Arc;

use environment::{
    Arrays, Autoreset, EnvironmentError, Environments, Episode, Options, RewardWeights, Start,
    WhichEpisode,
};
use expect_test::expect;
use learner::{Learner, options, template};
use observation::action::ActionKind;
use observation::facts::RobotFacts;
use scenario::Template;
use scripted::ordinary_run;

impl Learner {
    fn reset_each(&mut self, starts: &[Option<Start>]) {
        self.environments
            .reset_each(starts, &mut self.arrays.as_mut())
            .unwrap();
    }

    fn act(&mut self, actions: &[f32]) -> Result<(), EnvironmentError> {
        self.environments.step(actions, &mut self.arrays.as_mut())
    }

    /// Steps until an episode of the first instance ends.
    fn finish_episode(&mut self) {
        for _ in 0..10_000 {
            self.step();
            if self.arrays.terminated[0] || self.arrays.truncated[0] {
                return;
            }
        }
        panic!("no end of the episode");
    }
}

/// Digest of an episode that is executed again.
fn replayed_digest(episode: &Episode) -> String {
    let (_, report) = episode.replay(None, false, &Arc::default()).unwrap();
    report.summary.digest
}

/// Does some steps of the first instance, and compares them with an ordinary run of the same actions.
fn assert_is_an_ordinary_run(learner: &mut Learner, template: &Template, steps: usize) {
    learner.reset(None);
    let length = learner.environments.shape().observation;
    let mut seen = vec![learner.arrays.observations[..].to_vec()];
    for _ in 0..steps {
        learner.step();
        assert!(!(learner.arrays.terminated[0] || learner.arrays.truncated[0]));
        seen.push(learner.arrays.observations.clone());
    }
    let episode = learner
        .environments
        .episode(0, WhichEpisode::Running)
        .unwrap();
    assert_eq!(episode.steps, steps as u64);
    let (digest, observed) = ordinary_run(&learner.environments, template, &episode);
    assert_eq!(replayed_digest(&episode), digest);
    for (agent, facts) in learner.environments.agents().enumerate() {
        let layout = &learner.environments.layouts()[agent];
        for (tick, expected) in observed[&facts.name].iter().enumerate() {
            let own = &seen[tick][agent * length..][..layout.length()];
            assert_eq!(own, expected, "{} at tick {tick}", facts.name);
        }
        assert_eq!(observed[&facts.name].len(), steps + 1);
    }
}

#[test]
fn episodes_of_worlds_alone_are_ordinary_runs() {
    let scans = "defaults.robot.scan={beams=16, angle_increment=0.39}";
    let template = template("chase_exact", &[scans]);
    let options = options(&["evader", "police"], "state+scan");
    let mut learner = Learner::new(template.clone(), options);
    learner.reset(Some(1));
    assert_is_an_ordinary_run(&mut learner, &template, 60);
}

#[test]
fn episodes_with_other_processes_are_ordinary_runs() {
    // Beliefs of the Police, which the observations contain, while the evaders plan.
    let template = template("chase", &[]);
    let options = options(&["police"], "state+belief");
    let mut learner = Learner::new(template.clone(), options);
    learner.reset(Some(1));
    assert_is_an_ordinary_run(&mut learner, &template, 40);
}

#[test]
fn ways_are_those_of_a_planner_also_when_an_obstacle_appears() {
    let template = template("chase_popup", &["events.0.time_s=1.0"]);
    let mut learner = Learner::new(
        template.clone(),
        options(&["evader"], "state+path+potential"),
    );
    learner.reset(Some(1));
    assert_is_an_ordinary_run(&mut learner, &template, 40);
}

#[test]
fn field_evaders_are_those_of_a_planner() {
    let template = template("chase", &[]);
    for action in [ActionKind::Tune, ActionKind::Residual] {
        let options = Options {
            action,
            ..options(&["evader"], "state+path+potential")
        };
        let mut learner = Learner::new(template.clone(), options);
        learner.reset(Some(1));
        // Long enough for times whose last bit depends on how they are computed.
        assert_is_an_ordinary_run(&mut learner, &template, 150);
    }
}

#[test]
fn an_agent_out_of_the_game_stops_whatever_its_action() {
    // A pursuer stands beside the first of two evaders.
    let start = "robots.evader_1.start={ x = 7.5, y = 3.9, theta = 0.0 }";
    let set = [start, "rules.capture.radius=0.7", "rules.time_limit=1.0"];
    let mut learner = Learner::new(
        template("chase_exact", &set),
        options(&["evader_1", "evader_2"], "state"),
    );
    learner.reset(Some(1));
    learner.finish_episode();
    let episode = learner.environments.episode(0, WhichEpisode::Last).unwrap();
    let rows: Vec<&[f32]> = episode.actions.chunks(4).collect();
    assert!(rows.len() > 10 && rows[0].iter().all(|&number| number != 0.0));
    for row in &rows[10..] {
        assert_eq!(row[..2], [0.0; 2]);
        assert!(row[2..].iter().all(|&number| number != 0.0));
    }
    let (_, report) = episode.replay(None, false, &Arc::default()).unwrap();
    assert_eq!(report.summary.robots[4].name, "evader_1");
}

#[test]
fn an_episode_after_ten_thousand_resets_is_an_ordinary_run() {
    let template = template("hello", &[]);
    let mut learner = Learner::new(template.clone(), options(&["robot"], "state"));
    learner.reset(Some(3));
    let first = learner.arrays.seeds[0];
    for _ in 0..10_000 {
        learner.reset(None);
    }
    assert_ne!(learner.arrays.seeds[0], first);
    assert_is_an_ordinary_run(&mut learner, &template, 50);
    // The first episode again.
    learner.reset(Some(3));
    assert_eq!(learner.arrays.seeds[0], first);
}

#[test]
fn results_do_not_depend_on_threads() {
    for agents in [&["evader"][..], &["evader", "police"]] {
        let run = |threads| {
            let options = Options {
                instances: 5,
                threads,
                ..options(agents, "state")
            };
            let template = template("chase_exact", &["rules.time_limit=1.0"]);
            let mut learner = Learner::new(template, options);
            learner.reset(Some(9));
            // Episodes end after 20 steps, and the next ones begin.
            (0..30)
                .map(|_| {
                    learner.step();
                    learner.arrays.clone()
                })
                .collect::<Vec<Arrays>>()
        };
        let alone = run(1);
        assert!(alone[19].truncated.iter().all(|&truncated| truncated));
        for threads in [2, 5, 8] {
            assert!(run(threads) == alone, "{agents:?}, {threads} threads");
        }
    }
}

#[test]
fn episodes_do_not_depend_on_what_begins_them() {
    let made = |autoreset, threads| {
        let options = Options {
            instances: 3,
            threads,
            autoreset,
            ..options(&["evader_1"], "state")
        };
        let mut learner = Learner::new(template("chase_exact", &["rules.time_limit=0.5"]), options);
        learner.reset(Some(9));
        learner
    };
    let actions = [0.5; 6];
    let mut same = made(Autoreset::SameStep, 1);
    for threads in [1, 2] {
        same.reset(Some(9));
        let mut next = made(Autoreset::NextStep, threads);
        let mut disabled = made(Autoreset::Disabled, threads);
        for step in 1..=25 {
            for learner in [&mut same, &mut next, &mut disabled] {
                learner.act(&actions).unwrap();
            }
            if step % 10 > 0 {
                assert_eq!(next.arrays.rewards, same.arrays.rewards);
                assert_eq!(next.arrays.observations, same.arrays.observations);
                assert_eq!(disabled.arrays.observations, same.arrays.observations);
                continue;
            }
            let finals = &same.arrays.final_observations;
            assert!(same.arrays.truncated.iter().all(|&ends| ends));
            assert_eq!(&next.arrays.observations, finals);
            assert_eq!(&disabled.arrays.observations, finals);
            assert_eq!(next.arrays.truncated, same.arrays.truncated);
            for i in 0..3 {
                let last = |learner: &Learner| {
                    let last = learner.environments.episode(i, WhichEpisode::Last);
                    let last = last.unwrap();
                    (last.seed, last.actions, last.commands, last.steps)
                };
                assert_eq!(last(&next), last(&same));
                assert_eq!(last(&disabled), last(&same));
            }
            // A step, whatever its action, and resets begin the next ones.
            next.act(&[-1.0; 6]).unwrap();
            let error = disabled.act(&actions).unwrap_err();
            assert!(matches!(error, EnvironmentError::Ended { instance: 0 }));
            let mut starts = [None, Some(Start::default()), None];
            disabled.reset_each(&starts);
            assert!(disabled.arrays.truncated[0] && !disabled.arrays.truncated[1]);
            starts = [Some(Start::default()), None, Some(Start::default())];
            disabled.reset_each(&starts);
            for learner in [&next, &disabled] {
                assert_eq!(learner.arrays.observations, same.arrays.observations);
                assert_eq!(learner.arrays.seeds, same.arrays.seeds);
                assert!(!learner.arrays.truncated[0] && learner.arrays.lengths[0] == 0);
            }
        }
    }
}

#[test]
fn an_instance_may_have_a_seed_of_its_own() {
    let options = Options {
        instances: 2,
        ..options(&["evader_1"], "state")
    };
    let mut learner = Learner::new(template("chase_exact", &[]), options);
    let first = |seed| {
        let first = Some((seed, 0));
        Some(Start {
            first,
            ..Start::default()
        })
    };
    learner.reset_each(&[first(5), first(7)]);
    let observations = learner.arrays.observations.clone();
    let seeds = learner.arrays.seeds.clone();
    learner.reset_each(&[first(7), first(5)]);
    let (a, b) = observations.split_at(observations.len() / 2);
    assert_eq!(learner.arrays.observations, [b, a].concat());
    assert_eq!(learner.arrays.seeds, [seeds[1], seeds[0]]);
    // As the only instance of environments with this seed.
    learner.reset(Some(5));
    assert_eq!(learner.arrays.seeds[0], seeds[0]);
}

#[test]
fn the_time_limit_truncates_and_the_next_episode_begins() {
    let template = template("chase_exact", &["rules.time_limit=0.5"]);
    let mut learner = Learner::new(template, options(&["evader_1"], "state"));
    learner.reset(Some(1));
    let first = learner.arrays.seeds[0];
    learner.finish_episode();
    let arrays = &learner.arrays;
    assert!(arrays.truncated[0] && !arrays.terminated[0]);
    assert_eq!((arrays.lengths[0], arrays.statuses[0]), (10, 4));
    assert_ne!(arrays.seeds[0], first);
    // Entry 0 of an observation is 1 in the game: no longer in the last one, again in the first one.
    assert_eq!(
        (arrays.final_observations[0], arrays.observations[0]),
        (0.0, 1.0)
    );
    let last = learner.environments.episode(0, WhichEpisode::Last).unwrap();
    assert_eq!((last.seed, last.steps), (first, 10));
}

#[test]
fn invalid_options_and_actions_are_refused() {
    let chase = template("chase", &[]);
    let refused = |options: Options| {
        let environments = Environments::new(chase.clone(), options, Arc::default());
        environments.map(|_| ()).unwrap_err().to_string()
    };
    let rewarded = |progress| {
        let rewards = RewardWeights {
            progress,
            ..RewardWeights::default()
        };
        Options {
            rewards,
            ..options(&["police"], "state")
        }
    };
    let none = Options {
        instances: 0,
        ..options(&["evader"], "state")
    };
    let errors = [
        options(&["evader_9"], "state"),
        options(&[], "state"),
        options(&["perception"], "state"),
        options(&["evader"], "scan"),
        none,
        rewarded(f64::NAN),
        rewarded(1.0),
    ]
    .map(refused);
    expect![[r#"
        agents: no robot, team or process "evader_9": expected one of police_1, police_2, police_3, police_4, evader_1, evader_2, police, evader, pursuer_police_1, pursuer_police_2, pursuer_police_3, pursuer_police_4, evader_potential_evader_1, evader_potential_evader_2
        agents = []: expected names of robots, teams or processes
        agents: process "perception" steers no robot
        observation scan: robot evader_1 has no range scan: expected `scan = {}` in the scenario
        instances = 0: expected 1 to 2^16
        progress = NaN: expected a finite number
        reward progress: expected an agent with a goal, or an evader and an exit"#]].assert_eq(&errors.join("\n"));
    let exact = Environments::new(
        template("chase_exact", &[]),
        options(&["police"], "belief"),
        Arc::default(),
    );
    assert!(matches!(exact, Err(EnvironmentError::NoBeliefs)));

    let mut learner = Learner::new(
        template("chase_exact", &[]),
        options(&["evader_1"], "state"),
    );
    let mut step = |actions: &[f32]| {
        let mut arrays = learner.arrays.as_mut();
        learner.environments.step(actions, &mut arrays).unwrap_err()
    };
    assert!(matches!(step(&[0.0; 2]), EnvironmentError::NotReset));
    assert!(matches!(
        step(&[0.0; 3]),
        EnvironmentError::Length { given: 3, .. }
    ));
    learner.reset(None);
    let mut arrays = learner.arrays.as_mut();
    let error = learner.environments.step(&[0.0, f32::NAN], &mut arrays);
    assert!(matches!(error, Err(EnvironmentError::Action { .. })));
    // The episode goes on.
    learner.act(&[0.0; 2]).unwrap();
    let episode = learner.environments.episode(0, WhichEpisode::Last);
    assert!(matches!(episode, Err(EnvironmentError::NoEpisode { .. })));
    let episode = learner.environments.episode(1, WhichEpisode::Last);
    assert!(matches!(episode, Err(EnvironmentError::Instance { .. })));
}

#[test]
fn a_replay_has_a_log_with_its_digest() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("episode.mcap");
    let template = template("chase_exact", &["rules.time_limit=0.5"]);
    let mut learner = Learner::new(template, options(&["evader"], "state"));
    learner.reset(Some(1));
    learner.finish_episode();
    let episode = learner.environments.episode(0, WhichEpisode::Last).unwrap();
    let run = episode.replay(Some(path.clone()), false, &Arc::default());
    let (scenario, report) = run.unwrap();
    assert_eq!(scenario.run.seed, episode.seed);
    assert_eq!(report.summary.ticks, 10);
    assert_eq!(report.summary.digest, replayed_digest(&episode));
    assert!(path.metadata().unwrap().len() > 1000);
    let again = episode.replay(Some(path), false, &Arc::default());
    assert!(again.unwrap_err().is_refusal());
}

#[test]
fn an_interrupted_step_or_reset_demands_a_reset_of_all_instances() {
    use std::sync::atomic::Ordering;
    for threads in [1, 2] {
        let options = Options {
            instances: 3,
            threads,
            ..options(&["evader_1"], "state")
        };
        let mut learner = Learner::new(template("chase_exact", &[]), options);
        learner.reset(Some(1));
        let first = learner.arrays.observations.clone();
        let actions = vec![1.0; learner.environments.shape().actions()];
        let interruption = learner.environments.interruption();
        let refused = |result: Result<(), EnvironmentError>, is_reset: bool| match result {
            Err(EnvironmentError::Interrupted) => assert!(is_reset),
            Err(EnvironmentError::NotReset) => assert!(!is_reset),
            other => panic!("{other:?}"),
        };
        interruption.store(true, Ordering::Relaxed);
        refused(learner.act(&actions), true);
        interruption.store(false, Ordering::Relaxed);
        refused(learner.act(&actions), false);
        interruption.store(true, Ordering::Relaxed);
        let mut arrays = learner.arrays.as_mut();
        refused(learner.environments.reset(Some(1), &mut arrays), true);
        interruption.store(false, Ordering::Relaxed);
        refused(learner.act(&actions), false);
        learner.reset(Some(1));
        assert_eq!(learner.arrays.observations, first);
        learner.act(&actions).unwrap();
    }
}

#[test]
fn agents_have_the_facts_of_their_robots() {
    let template = template("chase_exact", &[]);
    let world = template.with_seed(1).unwrap().world;
    let facts = RobotFacts::of_specs(&world.robots);
    let learner = Learner::new(template, options(&["evader", "police_2"], "state"));
    let agents: Vec<&RobotFacts> = learner.environments.agents().collect();
    assert_eq!(agents, [&facts[4], &facts[5], &facts[1]]);
}
