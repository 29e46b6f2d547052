use crate::design::Design;
use coverage::goal::GoalSource;
use coverage::sub_goals::FollowParams;
use coverage::sub_goals::site::Site;
use geometry::shape::Aabb;
use nalgebra::Point2;

use super::*;

fn site() -> Site {
    let bounds = Aabb {
        min: Point2::origin(),
        max: Point2::new(4.0, 4.0),
    };
    let (margin, start) = (FollowParams::default(), Point2::new(1.0, 1.0));
    Site::new(bounds, &[], 0.105, &margin, start).unwrap()
}

fn points<D: Design>(text: &str, seed: u64) -> Vec<Point2<f64>> {
    let params: D::Params = toml::from_str(text).unwrap();
    parameters::check(&params).unwrap();
    let site = site();
    let mut goals = D::goals(&params, &site, seed, None).unwrap();
    let mut from = site.start;
    let mut points = Vec::new();
    for number in 0..10 {
        let goal = goals.next_goal(from).unwrap();
        assert_eq!(goal.waypoint.number, number);
        from = goal.waypoint.point;
        points.push(from);
    }
    let mut on = D::goals(&params, &site, seed, Some(goals)).unwrap();
    assert_eq!(on.next_goal(from).unwrap().waypoint.number, 10);
    points
}

#[test]
fn the_key_decides_and_else_the_seed() {
    let key = format!("key = \"keyed:{}\"", "07".repeat(32));
    assert_eq!(points::<KeyedGoals>(&key, 1), points::<KeyedGoals>(&key, 2));
    assert_ne!(points::<KeyedGoals>("", 1), points::<KeyedGoals>("", 2));
    assert_eq!(points::<KeyedGoals>("", 1), points::<KeyedGoals>("", 1));
    assert_eq!(
        points::<RandomBounce>(&key, 1),
        points::<RandomBounce>(&key, 2)
    );
    assert_ne!(points::<RandomBounce>("", 1), points::<RandomBounce>("", 2));
    assert_eq!(points::<Uniform>(&key, 1), points::<Uniform>(&key, 2));
    assert_ne!(points::<Uniform>("", 1), points::<Uniform>("", 2));
}

#[test]
fn lanes_are_as_far_apart_as_the_body_is_wide() {
    let points = points::<Boustrophedon>("", 1);
    let across: Vec<f64> = points.windows(2).map(|p| (p[1].y - p[0].y).abs()).collect();
    let widest = across.into_iter().fold(0.0, f64::max);
    assert!(widest > 0.19 && widest <= 0.21 + 1e-12, "{widest}");
}

fn refusal<D: Design>(text: &str) -> String {
    let params: D::Params = toml::from_str(text).unwrap();
    parameters::check(&params).unwrap_err().to_string()
}

#[test]
fn keys_that_are_no_secret_and_values_out_of_range_are_refused() {
    for text in [
        refusal::<KeyedGoals>("key = \"catp:0.4,0.644\""),
        refusal::<Uniform>("key = \"catp:0.4,0.644\""),
    ] {
        assert!(text.starts_with("`key` is catp:"), "{text}");
    }
    let text = refusal::<KeyedGoals>("goals = { choices = 9.0 }");
    assert!(text.starts_with("`goals.choices` is 9"), "{text}");
    for text in [
        refusal::<KeyedGoals>("follow = { margin = -1.0 }"),
        refusal::<RandomBounce>("follow = { margin = -1.0 }"),
        refusal::<Boustrophedon>("follow = { margin = -1.0 }"),
    ] {
        assert!(text.starts_with("`follow.margin` is -1"), "{text}");
    }
}

#[test]
fn cells_too_large_for_the_body_are_refused() {
    let params: KeyedCoverageParams = toml::from_str("goals = { cell = 0.12 }").unwrap();
    let error = KeyedGoals::goals(&params, &site(), 1, None).unwrap_err();
    assert_eq!(error.field(), "goals.cell");
    let text = error.to_string();
    assert!(text.starts_with("`cell` is 0.12"), "{text}");
}
