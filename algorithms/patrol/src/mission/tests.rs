use super::*;
use crate::awg::tests::octagon;

fn drive(v_max: f64) -> Drive {
    Drive {
        limits: Limits::new(v_max, 0.0, 6.0).unwrap(),
        acceleration: None,
        angular_acceleration: None,
    }
}

fn case_1() -> MissionParams {
    MissionParams {
        contour: octagon().points().iter().map(|p| [p.x, p.y]).collect(),
        ..MissionParams::default()
    }
}

#[test]
fn absent_parameters_follow_from_robot_and_seed() {
    let go_to = GoToParams::default();
    let made = |seed| case_1().prepare(&drive(1.0), &go_to, seed).unwrap();
    let mission = made(7);
    assert_eq!(mission, made(7));
    assert_ne!(mission.key, made(8).key);
    assert_eq!(mission.key.kind(), KeyKind::Keyed);
    let alpha = mission.awg.params().alpha;
    assert!((0.5..1.8).contains(&alpha), "{alpha}");
    // A robot with finite acceleration of turning gets a smaller width.
    let heavy = Drive {
        acceleration: Some(4.0),
        angular_acceleration: Some(40.0),
        ..drive(1.0)
    };
    let slower = case_1().prepare(&heavy, &go_to, 7).unwrap();
    assert!(slower.awg.params().alpha < alpha);
}

#[test]
fn laps_on_the_waypoint_clock_end_in_time() {
    let go_to = GoToParams::default();
    let prepared = |params: MissionParams| params.prepare(&drive(1.0), &go_to, 7).unwrap();
    // Sides of 6.5 s are rounded to 7 waypoints, which would exceed the time.
    let square = MissionParams {
        contour: vec![[0.0, 0.0], [3.3, 0.0], [3.3, 3.3], [0.0, 3.3]],
        t_max: 26.4,
        margin: 0.1,
        ..MissionParams::default()
    };
    assert!((prepared(square).awg.lap_time() - 0.95 * 26.4).abs() < 1e-9);
    assert!((prepared(case_1()).awg.lap_time() - 118.0).abs() < 1e-9);
    let printed = MissionParams {
        preset: Preset::Printed,
        ..case_1()
    };
    assert_eq!(prepared(printed).awg.lap_time(), 116.0);
}

#[test]
fn given_parameters_are_kept() {
    let params: MissionParams = toml::from_str(
        "contour = [[0, 0], [8, 0], [8, 6]]\nclosed = false\nt_max = 30\nalpha = 0.7\n\
         key = 'catp:0.4,0.644'\npreset = 'printed'\n\
         danger_zones = [{ circle = { center = [8, 0], radius = 3 } }]",
    )
    .unwrap();
    let mission = params
        .prepare(&drive(1.0), &GoToParams::default(), 1)
        .unwrap();
    assert_eq!(mission.key, "catp:0.4,0.644".parse().unwrap());
    let found = mission.awg.params();
    assert_eq!((found.t_max, found.alpha), (30.0, 0.7));
    assert_eq!(found.mode, Preset::Printed.mode());
    let threatened: Vec<bool> = mission
        .awg
        .legs(0)
        .iter()
        .map(|l| l.stretch.threatened)
        .collect();
    assert_eq!(threatened, [false, true, true, false]);
    let text = toml::to_string(&params).unwrap();
    assert_eq!(toml::from_str::<MissionParams>(&text).unwrap(), params);
    assert!(toml::from_str::<MissionParams>("tmax = 3").is_err());
}

#[test]
fn errors_of_a_patrol_contain_the_remedy() {
    let refused = |change: &dyn Fn(&mut MissionParams)| {
        let mut params = case_1();
        change(&mut params);
        let made = params.prepare(&drive(1.0), &GoToParams::default(), 1);
        made.unwrap_err().to_string()
    };
    for (error, part) in [
        (
            refused(&|p| p.contour.clear()),
            "`contour` is a list of 0: expected at least 2 values",
        ),
        (refused(&|p| p.contour[3] = p.contour[2]), "`contour[3]`"),
        (refused(&|p| p.t_max = 30.0), "at least 48.284 s"),
        (refused(&|p| p.alpha = Some(-1.0)), "`alpha` is -1"),
        (refused(&|p| p.margin = 1.0), "`margin` is 1"),
        (
            refused(&|p| p.key = Some("catp:0,0".parse().unwrap())),
            "`key`: ",
        ),
        (refused(&|p| p.t_max = 49.0), "t_max"),
    ] {
        assert!(error.contains(part), "{error}");
    }
}

#[test]
fn check_and_prepare_agree() {
    let go_to = GoToParams::default();
    for (t_max, v_max) in [
        (120.0, 1.0),
        (40.0, 1.0),
        (50.0, 1.0),
        (120.0, 0.3),
        (400.0, 0.2),
    ] {
        for alpha in [None, Some(1.0)] {
            let order = MissionParams {
                t_max,
                alpha,
                ..case_1()
            };
            let prepared = order.prepare(&drive(v_max), &go_to, 3).map(drop);
            let checked = order.check(&drive(v_max), &go_to, 3);
            assert_eq!(checked, prepared, "{t_max} s, {v_max} m/s, {alpha:?}");
        }
    }
}
