//! The built-in scenarios.

use geometry::map::MapSpec;
use geometry::pose::Pose2;
use geometry::region::Region;
use scenario::{Loader, ResolvedScenario, builtin, list};

use crate::{KINDS, load};

#[test]
fn every_built_in_scenario_loads_and_can_be_written() {
    for scenario in builtin::SCENARIOS {
        let s = load(scenario.name, &[], None).unwrap_or_else(|e| panic!("{}: {e}", scenario.name));
        assert_eq!(s.name, scenario.name);
        assert!(!s.uses_external_commands());
        let again = Loader::new(KINDS)
            .load_text(
                "log",
                &s.to_toml(),
                &scenario::files::Base::Nothing,
                &[],
                None,
            )
            .unwrap_or_else(|e| panic!("{}: {e}", scenario.name));
        assert_eq!(again, s);
    }
}

#[test]
fn the_world_accepts_every_built_in_scenario_and_its_events() {
    for scenario in builtin::SCENARIOS {
        let s = load(scenario.name, &[], None).unwrap();
        let mut world = sim_backend::world::World::new(s.world.clone())
            .unwrap_or_else(|e| panic!("{}: {e}", scenario.name));
        for event in &s.events {
            let change = event.change().expect("a resolved event has its shape");
            world
                .apply(&change)
                .unwrap_or_else(|e| panic!("{}: {e}", scenario.name));
        }
    }
}

#[test]
fn the_list_has_a_title_and_a_summary_for_each() {
    let list = list();
    assert_eq!(list[0].name, builtin::DEFAULT);
    for entry in list {
        assert!(entry.title.len() > 4, "{entry:?}");
        assert!(entry.summary.ends_with('.'), "{entry:?}");
        assert!(entry.summary.len() < 100, "{entry:?}");
    }
}

#[test]
fn the_published_chase_is_the_papers_set_up() {
    let s = load(
        "chase_paper",
        &["defaults.robot.start_jitter={}".to_owned()],
        Some(9),
    )
    .unwrap();
    let starts: Vec<_> = s
        .world
        .robots
        .iter()
        .map(|r| (r.start.x, r.start.y))
        .collect();
    let want = [
        (7.5, 4.5),
        (7.5, 1.5),
        (7.5, -1.5),
        (7.5, -4.5),
        (-4.5, 7.5),
        (-4.5, -7.5),
    ];
    assert_eq!(starts, want);
    assert_eq!(s.run.seed, 9);
    assert_eq!(s.run.dt, 0.05);
    let speeds: Vec<f64> = s.world.robots.iter().map(|r| r.model().v_max).collect();
    assert_eq!(speeds, [0.3, 0.3, 0.3, 0.3, 0.45, 0.45]);
    assert_eq!(s.rules().capture.unwrap().radius, 0.3);
    // One process per robot, and one for perception.
    assert_eq!(s.processes.len(), 7);
    assert_eq!(s.processes[0].name, "perception");
    assert_eq!(s.processes[1].name, "pursuer_police_1");
    let paper = [Region::Circle {
        center: [9.0, 0.0],
        radius: 0.5,
    }];
    assert_eq!(exits(&s), paper);
}

#[test]
fn an_evader_cannot_leave_the_city_without_escaping() {
    for scenario in builtin::SCENARIOS {
        let s = load(scenario.name, &[], None).unwrap();
        let published = s.name == "chase_paper";
        if published || !s.name.starts_with("chase") {
            continue;
        }
        let exits = exits(&s);
        for step in -150..=150 {
            // Every place in the gap, at the middle of the wall and outside.
            let y = f64::from(step) / 120.0;
            for x in [8.501, 9.0, 9.25, 9.499] {
                let out = exits
                    .iter()
                    .any(|e| e.contains(Pose2::new(x, y, 0.0).position()));
                assert_eq!(out, y.abs() < 1.25, "{}: x {x}, y {y}", s.name);
            }
        }
    }
}

fn exits(scenario: &ResolvedScenario) -> Vec<Region> {
    let MapSpec::Vector(map) = &scenario.world.map else {
        panic!("{:?}", scenario.world.map)
    };
    [&map.exits[..], &scenario.rules().exits].concat()
}

#[test]
fn seeds_displace_the_chase_within_its_limits() {
    let nominal = load(
        "chase_exact",
        &["defaults.robot.start_jitter={}".to_owned()],
        None,
    )
    .unwrap();
    let drawn = load("chase_exact", &[], Some(2)).unwrap();
    for (a, b) in nominal.world.robots.iter().zip(&drawn.world.robots) {
        assert_ne!(a.start, b.start);
        assert!((a.start.x - b.start.x).abs() <= 0.05 && (a.start.y - b.start.y).abs() <= 0.05);
        let turn = geometry::math::angle_difference(a.start.theta, b.start.theta);
        assert!(turn.abs() <= 0.1);
    }
}
