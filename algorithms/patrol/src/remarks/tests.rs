use control::go_to::GoToParams;
use geometry::shape::Aabb;
use planner_view::limits::Limits;

use super::*;
use crate::awg::Mode;
use crate::awg::tests::awg;
use crate::mission::{AlphaChoice, Drive, MissionParams};

fn mission(extra: &str) -> Mission {
    let params: MissionParams = toml::from_str(&format!(
        "contour = [[0, 0], [10, 0], [10, 10], [0, 10]]\nt_max = 80\n{extra}"
    ))
    .unwrap();
    let drive = Drive {
        limits: Limits::new(1.0, 0.0, 5.2).unwrap(),
        acceleration: None,
        angular_acceleration: None,
    };
    params.prepare(&drive, &GoToParams::default(), 1).unwrap()
}

fn room(margin: f64) -> Room<'static> {
    let bounds = Aabb {
        min: Point2::new(-margin, -margin),
        max: Point2::new(10.0 + margin, 10.0 + margin),
    };
    Room::new(bounds, None, 0.2)
}

fn zones(zones: &str) -> Mission {
    mission(&format!("alpha = 0.5\ndanger_zones = [{zones}]"))
}

const SIDE: &str = "{ circle = { center = [10, 5], radius = 3 } }";
const APART: &str = "{ circle = { center = [5, 5], radius = 3 } }";
const SHORT: &str = "{ circle = { center = [5, 10.3], radius = 0.35 } }";

#[test]
fn a_sound_patrol_needs_no_remark() {
    assert_eq!(of_zig_zag(&mission("alpha = 0.5"), &room(1.0)), []);
    assert_eq!(of_zig_zag(&zones(SIDE), &room(1.0)), []);
    assert_eq!(of_contour(&zones(&format!("{SIDE}, {SHORT}"))), []);
}

#[test]
fn a_zone_that_touches_no_contour_is_named() {
    let mission = zones(&format!("{SIDE}, {APART}"));
    let apart = Remark::ZoneApart { index: 1 };
    assert_eq!(
        of_zig_zag(&mission, &room(1.0)),
        std::slice::from_ref(&apart)
    );
    assert_eq!(of_contour(&mission), [apart]);
}

#[test]
fn a_zone_too_short_for_a_waypoint_is_named() {
    let found = of_zig_zag(&zones(&format!("{SHORT}, {SIDE}")), &room(1.0));
    let [Remark::ZoneTooShort { index: 0, length }] = found[..] else {
        panic!("{found:?}");
    };
    assert!((0.1..0.7).contains(&length), "{length}");
}

#[test]
fn a_short_zone_inside_a_protected_one_is_no_defect() {
    let short = "{ circle = { center = [10, 5], radius = 0.1 } }";
    let mission = zones(&format!("{short}, {SIDE}"));
    assert_eq!(of_zig_zag(&mission, &room(1.0)), []);
}

#[test]
fn a_patrol_without_any_additional_waypoint_is_called_unprotected() {
    let apart = mission(&format!("danger_zones = [{APART}]"));
    assert_eq!(apart.alpha_choice, AlphaChoice::Unused);
    // Four sides of a second each.
    let mut hasty = mission("");
    hasty.awg = awg(&hasty.contour, 4.0, 1.0, Mode::default());
    for (mission, zones) in [(apart, true), (hasty, false)] {
        let found = of_zig_zag(&mission, &room(1.0));
        assert_eq!(found.last(), Some(&Remark::Unprotected { zones }));
    }
}

#[test]
fn waypoints_where_the_robot_does_not_fit_are_counted() {
    let mission = mission("alpha = 3");
    let found = of_zig_zag(&mission, &room(1.0));
    let [
        Remark::Misfits {
            outside,
            blocked: 0,
            all: 960,
            at,
            ..
        },
    ] = found[..]
    else {
        panic!("{found:?}");
    };
    assert!((100..500).contains(&outside), "{outside}");
    assert!(!room(1.0).fits(at));
    assert_eq!(of_zig_zag(&mission, &room(4.0)), []);
}
