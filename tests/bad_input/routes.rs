//! Patrols and coverage that cannot be: keys, contours, times, workplaces, routes.

use crate::support::Sandbox;

/// A run that must be refused, with a text that has these words in this order; ` | ` parts them.
#[track_caller]
fn refused(sandbox: &Sandbox, arguments: &[&str], words: &str) {
    let words: Vec<&str> = words.split(" | ").collect();
    super::refused(sandbox, arguments, &words);
}

/// A change of the octagon's mission that must be refused, with a text that has these words.
#[track_caller]
fn mission(sandbox: &Sandbox, change: &str, words: &str) {
    let change = format!("processes.patrol.params.mission.{change}");
    refused(sandbox, &["patrol_octagon", "--set", &change], words);
}

/// The same of a coverage.
#[track_caller]
fn cover(sandbox: &Sandbox, scenario: &str, change: &str, words: &str) {
    refused(sandbox, &[scenario, "--set", change], words);
}

#[test]
fn keys_that_are_none_or_make_no_secret() {
    let sandbox = Sandbox::new();
    let place = "(processes.patrol.params.mission.key)";
    for (key, words) in [
        ("catp:0,0", "all zero | at least one value other than 0"),
        ("cat64:0,0", "all zero | at least one value other than 0"),
        ("catf64:0.5,0.25", "repeats after 3 steps | more digits"),
        ("catf64:1.0,0.25", "`x` of `catf64` is 1 | below 1"),
        ("catf64:NaN,0.25", "`x` of `catf64` is NaN | below 1"),
        ("catp:1.5,0.3", "`1.5` is not a decimal key | 0.644"),
        ("catp:0.4", "`0.4` of `catp` has 1 | two values"),
        ("chebp:5,5", "equal or mirrored | change one of them"),
        (
            "chebp:5,9223372036854775778",
            "equal or mirrored | change one of them",
        ),
        ("chebf64:0.3,-0.3", "equal or mirrored | change one of them"),
        (
            "chebf64:0.5,0.3",
            "leads to a fixed point | away from these",
        ),
        ("chebf64:2,0.3", "`x` of `chebf64` is 2 | between -1 and 1"),
        ("keyed:00", "2 characters | 64 hexadecimal digits"),
        ("rot13:1,2", "`rot13` is not a generator | catp, cat64"),
        ("garbage", "`garbage` is not a generator | kind:values"),
    ] {
        mission(
            &sandbox,
            &format!("key={key}"),
            &format!("{words} | {place}"),
        );
    }
    let place = "(processes.cover.params.key)";
    for (key, expected) in [
        (
            "chebp-raw:0,3",
            "`tx` of `chebp-raw` is 0: expected above 0",
        ),
        ("standard:0,0", "leads to a fixed point"),
    ] {
        let change = format!("processes.cover.params.key={key}");
        cover(
            &sandbox,
            "coverage_open",
            &change,
            &format!("`key`:  | {expected} | {place}"),
        );
    }
    let map = "processes.cover.params.map=arnold";
    let words = "`arnold` is not a generator | catp, cat64 | (processes.cover.params.map)";
    cover(&sandbox, "coverage_open", map, words);
    let secret = ["--set", "processes.cover.kind=coverage_keyed"];
    let public = "processes.cover.params.key=catp:0.4,0.644";
    let words = "`key` is out of range | params.key | no other generator is secret";
    refused(
        &sandbox,
        &[&["coverage_open"], &secret[..], &["--set", public]].concat(),
        words,
    );
}

#[test]
fn contours_times_and_widths_that_make_no_patrol() {
    let sandbox = Sandbox::new();
    for (change, words) in [
        (
            "contour=[]",
            "`mission.contour` is out of range | mission.contour) | value: a list of 0 | at least 2 values",
        ),
        (
            "contour=[[5,0]]",
            "`mission.contour` is out of range | mission.contour) | value: a list of 1 | at least 2 values",
        ),
        (
            "contour=[[5,0],[0,5],[0,5],[0,10]]",
            "`contour[2]` is (0, 5) | remove one of the two | mission.contour[2])",
        ),
        (
            "contour=[[5,0],[nan,5]]",
            "value not allowed | mission.contour[1][0]) | a finite number",
        ),
        (
            "contour=[[5,0],[0,5],[0,50]]",
            "`contour[2]` is (0, 50) | enlarge the map | mission.contour[2])",
        ),
        (
            "t_max=40",
            "`t_max` is 40 s | 48.284 m takes at least 48.284 s | mission.t_max)",
        ),
        (
            "t_max=50",
            "`t_max` = 50 s | more time or a faster robot | mission.t_max)",
        ),
        (
            "t_max=0",
            "`mission.t_max` is out of range | mission.t_max) | value: 0 | above 0 and at most 1000000 (s)",
        ),
        (
            "t_max=-5",
            "`mission.t_max` is out of range | mission.t_max) | value: -5 | above 0 and at most 1000000 (s)",
        ),
        (
            "t_max=nan",
            "value not allowed | mission.t_max) | a finite number",
        ),
        (
            "alpha=0",
            "`mission.alpha` is out of range | mission.alpha) | value: 0 | above 0 (m)",
        ),
        (
            "alpha=-1",
            "`mission.alpha` is out of range | mission.alpha) | value: -1 | above 0 (m)",
        ),
        (
            "alpha=inf",
            "value not allowed | mission.alpha) | a finite number",
        ),
        ("margin=1", "`mission.margin` is out of range | below 1"),
        (
            "preset=papr",
            "`papr` is not one of | mission.preset) | `paper_fit`",
        ),
        (
            "danger_zones=[{ polygon = { vertices = [[0,0],[1,1],[1,0],[0,1]] } }]",
            "`danger_zones[0]` | a simple polygon | mission.danger_zones[0])",
        ),
    ] {
        mission(&sandbox, change, words);
    }
    // The robot is what makes the time too short.
    let slow = ["patrol_octagon", "--set", "robots.guard.limits.v_max=0.4"];
    let words = "`t_max` is 120 s | the robot's 0.4 m/s | mission.t_max)";
    refused(&sandbox, &slow, words);
    let blind = [
        "patrol_square",
        "--set",
        "processes.patrol.params.driver.go_to.arrived=0",
    ];
    refused(
        &sandbox,
        &blind,
        "`driver.go_to.arrived` is out of range | above 0",
    );
    let known = "processes.patrol.params.obstacles_known=true";
    let in_hall = "processes.patrol.params.mission.contour=[[1,1],[6,1],[6,5]]";
    let words = "`contour[1]` is (6, 1) | an obstacle leaves no room | mission.contour[1])";
    refused(
        &sandbox,
        &["patrol_square", "--set", known, "--set", in_hall],
        words,
    );
    let fto = "processes.patrol.kind=patrol_fto";
    let mixed = "processes.patrol.params.mixed.retry_laps=0";
    let words = "`mixed.retry_laps` is out of range | at least 1";
    refused(
        &sandbox,
        &["patrol_square", "--set", fto, "--set", mixed],
        words,
    );
}

#[test]
fn workplaces_that_no_robot_can_cover() {
    let sandbox = Sandbox::new();
    let list = "world.map.vector.obstacles";
    let block = "world.map.vector.obstacles.block.shape.rectangle.";
    let shape = "shape.rectangle.center = ";
    let half = "shape.rectangle.half_extents = [2.45, 5]";
    for (change, words) in [
        (
            format!("{block}center=[50, 50]"),
            "`block` lies | outside the workplace | world.map.vector.obstacles[0])",
        ),
        (
            format!("{block}half_extents=[20, 20]"),
            "`block`  | covers the whole workplace | world.map.vector.obstacles[0])",
        ),
        (
            format!(
                "{list}=[{{ name = \"west\", {shape}[2.5, 5], {half} }}, \
                 {{ name = \"east\", {shape}[7.5, 5], {half} }}]"
            ),
            "`follow.margin` is 0.05 m | no free space | fewer or smaller obstacles",
        ),
        (
            "processes.cover.params.follow.margin=6".into(),
            "`follow.margin` is 6 m | below 5 m | (processes.cover.params.follow.margin)",
        ),
        (
            "processes.cover.params.follow.tolerance=0".into(),
            "`follow.tolerance` is out of range | = value: 0 | at least 0.000001",
        ),
        (
            "processes.cover.params.follow.driver.go_to.arrived=0".into(),
            "`follow.driver.go_to.arrived` is out of range | = value: 0 | above 0",
        ),
    ] {
        cover(&sandbox, "coverage_case1", &change, words);
    }
    let crossed =
        "world.map.vector.obstacles.triangle.shape.polygon.vertices=[[6,6],[8,8],[8,6],[6,8]]";
    let words = "edge 0 | meets edge 2 | a simple polygon | world.map.vector.obstacles[1]";
    cover(&sandbox, "coverage_polygons", crossed, words);
    let empty = "world.map.vector.bounds={ min = [0, 0], max = [0, 10] }";
    let words = "`bounds.max[0]` is out of range | more than bounds.min[0] = 0";
    cover(&sandbox, "coverage_case1", empty, words);
    let missing = "no map `maps/nowhere.toml` is built in | = expected: ";
    cover(
        &sandbox,
        "coverage_case1",
        "world.map=builtin:nowhere",
        missing,
    );
}

#[test]
fn routes_bridges_and_numbers_that_do_not_fit_the_workplace() {
    let sandbox = Sandbox::new();
    for (change, words) in [
        (
            "route={ cycle = [0, 3, 9] }",
            "no rectangle 9 | rectangles 0 to 3 | (processes.cover.params.route)",
        ),
        (
            "route={ cycle = [0, 1] }",
            "no bridge joins rectangles 0 and 1 | a rectangle between | params.route)",
        ),
        (
            "route={ cycle = [2, 1] }",
            "starts in rectangle 0 | add it or start elsewhere | params.route)",
        ),
        (
            "route={ cycle = [] }",
            "starts in rectangle 0 | add it or start elsewhere | params.route)",
        ),
        (
            "bridges=[{ between = [0, 1], min = [3, 3], max = [7, 7] }]",
            "bridge from (3, 3) to (7, 7) | out of the obstacles | params.bridges)",
        ),
        (
            "bridges=[{ between = [0, 7], min = [3, 3], max = [7, 7] }]",
            "bridge to rectangle 7 | name two of those | params.bridges)",
        ),
        (
            "bridges=[{ between = [0, 2], min = [1, 1], max = [2, 2] }]",
            "bridge between rectangles 0 and 2 | leave this one out | params.bridges)",
        ),
        (
            "iterations={ by = [5, 5] }",
            "2 numbers for 4 rectangles | one for each | params.iterations)",
        ),
        (
            "iterations={ each = 0 }",
            "`iterations` is out of range | = value:  | at least one sub-goal",
        ),
        (
            "transit={ wait = { cap = 0 } }",
            "`transit.wait.cap` is out of range | = value: 0 | at least 1",
        ),
        (
            "loops=-1",
            "value not allowed | = value: -1 | a whole number from 0",
        ),
        (
            "follow.interpolation=spline",
            "`spline` is not one of | follow.interpolation) | one of `linear`, `arc`",
        ),
    ] {
        let change = format!("processes.cover.params.{change}");
        cover(&sandbox, "coverage_case1", &change, words);
    }
}
