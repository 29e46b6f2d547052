//! Episodes with other values of the scenario than those of the environments.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod scripted;

use std::collections::BTreeMap;
use std::sync::Arc;

use environment::{Arrays, EnvironmentError, Environments, Options, Start, Variant, WhichEpisode};
use scenario::{Loader, MapCache, Template};
use scripted::ordinary_run;

fn template(name: &str, overrides: &[&str]) -> Template {
    let mut draft = Loader::new(kinds::KINDS).draft(name).unwrap();
    for argument in overrides {
        draft.apply("--set", argument);
    }
    draft.template(&mut MapCache::default()).unwrap()
}

fn environments(scenario: Template, agents: &[&str], observation: &str) -> Environments {
    let options = Options {
        instances: 3,
        agents: agents.iter().map(|&name| name.to_owned()).collect(),
        observation: observation.parse().unwrap(),
        seed: 1,
        ..Options::default()
    };
    Environments::new(scenario, options, Arc::default()).unwrap()
}

/// Begins the next episode with this scenario.
fn next(variant: &Variant) -> Start {
    Start {
        variant: Some(variant.clone()),
        ..Start::default()
    }
}

#[test]
fn an_episode_with_other_values_is_an_ordinary_run_with_them() {
    // The world alone; with other processes; with ways on another map.
    for (name, agents, observation, values) in [
        (
            "chase_exact",
            &["evader", "police"][..],
            "state",
            &["teams.evader.limits.v_max=0.2", "rules.time_limit=0.4"][..],
        ),
        (
            "chase_exact",
            &["evader_1"],
            "state",
            &["teams.police.limits.v_max=0.1", "rules.time_limit=0.4"],
        ),
        (
            "hello",
            &["robot"],
            "state+path",
            &[
                "world.map={vector={bounds={min=[0,0],max=[5,3]},resolution=0.05,obstacles=[{name='box',shape={rectangle={center=[2.5,2.2],half_extents=[0.3,0.3]}}}]}}",
                "rules.time_limit=0.4",
            ],
        ),
    ] {
        let base = template(name, &["rules.time_limit=0.8"]);
        let other = template(name, values);
        let mut environments = environments(base.clone(), agents, observation);
        let variant = environments
            .variant()
            .with(other.clone(), BTreeMap::default());
        let variant = variant.unwrap();
        let mut arrays = Arrays::new(environments.shape());
        environments.reset(None, &mut arrays.as_mut()).unwrap();
        let starts = [None, Some(next(&variant)), None];
        environments
            .reset_each(&starts, &mut arrays.as_mut())
            .unwrap();
        let actions = vec![0.7; environments.shape().actions()];
        for _ in 0..8 {
            environments.step(&actions, &mut arrays.as_mut()).unwrap();
        }
        assert_eq!(arrays.truncated, [false, true, false], "{name}");
        for (instance, which, scenario) in [
            (0, WhichEpisode::Running, &base),
            (1, WhichEpisode::Last, &other),
            (2, WhichEpisode::Running, &base),
        ] {
            let episode = environments.episode(instance, which).unwrap();
            let (_, report) = episode.replay(None, false, &Arc::default()).unwrap();
            let (digest, _) = ordinary_run(&environments, scenario, &episode);
            assert_eq!(report.summary.digest, digest, "{name}, instance {instance}");
        }
        // The episodes that follow have these values, too, until a reset gives others.
        let ended = environments.episode(1, WhichEpisode::Last).unwrap();
        for _ in 0..8 {
            environments.step(&actions, &mut arrays.as_mut()).unwrap();
        }
        assert_eq!(arrays.truncated, [true; 3], "{name}");
        let again = environments
            .variant()
            .with(base, BTreeMap::default())
            .unwrap();
        let starts = [None, Some(next(&again)), None];
        environments
            .reset_each(&starts, &mut arrays.as_mut())
            .unwrap();
        for _ in 0..8 {
            environments.step(&actions, &mut arrays.as_mut()).unwrap();
        }
        assert_eq!(arrays.truncated, [false; 3], "{name}");
        // An earlier one keeps its values.
        let (_, report) = ended.replay(None, false, &Arc::default()).unwrap();
        assert_eq!(report.summary.ticks, 8);
    }
}

#[test]
fn values_that_change_the_arrays_are_refused() {
    let base = "defaults.robot.scan={beams=8,angle_increment=0.785}";
    let all = &["evader", "police"];
    let mut environments = environments(template("chase_exact", &[base]), all, "scan");
    let event = "events=[{time_s=1,action='appear',obstacle='box',shape={rectangle={center=[4.5,0],half_extents=[0.2,0.2]}}}]";
    for (values, text) in [
        (&[base, "run.dt=0.1"][..], "the time step"),
        (
            &["defaults.robot.scan={beams=9,angle_increment=0.7}"],
            "entries of observations",
        ),
        (&[base, event], "beside the agents"),
    ] {
        let refused = environments
            .variant()
            .with(template("chase_exact", values), BTreeMap::default());
        let error = refused.unwrap_err();
        assert!(matches!(error, EnvironmentError::Fixed(_)) && error.is_refusal());
        assert!(error.to_string().contains(text), "{error}");
    }
    let others = environments
        .variant()
        .with(template("hello", &[]), BTreeMap::default());
    assert!(matches!(others, Err(EnvironmentError::Agents(_))));
    // They go on.
    let mut arrays = Arrays::new(environments.shape());
    environments.reset(None, &mut arrays.as_mut()).unwrap();
}
