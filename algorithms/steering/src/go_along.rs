//! Driving along a path, from corner to corner, without memory.

use geometry::pose::{Pose2, Twist2};
use planner_view::limits::Limits;

use crate::go_to::{GoToParams, go_to};
use crate::path_tracking::Path;

/// The command that leads from a pose along a path in ticks of `dt` (s): [`go_to`] to the next corner.
///
/// The next corner is the first one beyond the point of the path that is nearest to the robot, and farther from the
/// robot than `params.arrived`; near the end, it is the end. A stop for an empty path.
pub fn go_along(
    pose: &Pose2,
    path: &Path,
    limits: &Limits,
    params: &GoToParams,
    dt: f64,
) -> Twist2 {
    let here = pose.position();
    let Some((progress, _)) = path.project(here, 0.0, path.length()) else {
        return Twist2::STOP;
    };
    let mut ahead = path
        .points()
        .iter()
        .zip(path.along())
        .filter(|(_, along)| **along > progress)
        .map(|(corner, _)| *corner)
        .skip_while(|corner| (corner - here).norm() <= params.arrived);
    match ahead.next().or_else(|| path.points().last().copied()) {
        Some(corner) => go_to(pose, corner, ahead.next(), limits, params, dt),
        None => Twist2::STOP,
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Point2;

    use super::*;
    use crate::go_to::coast;

    const DT: f64 = 0.05;

    fn limits() -> Limits {
        Limits::new(0.5, 0.0, 3.0).unwrap()
    }

    #[test]
    fn the_robot_drives_around_the_corners_to_the_end() {
        let path = Path::new([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(Point2::from));
        let params = GoToParams {
            deceleration: Some(1.0),
            ..GoToParams::default()
        };
        let mut pose = Pose2::new(0.0, 0.0, 0.0);
        let mut off = 0.0_f64;
        for _ in 0..400 {
            let command = go_along(&pose, &path, &limits(), &params, DT);
            pose = coast(&pose, command, DT);
            off = off.max(path.project(pose.position(), 0.0, path.length()).unwrap().1);
        }
        assert!(
            (pose.position() - Point2::new(0.0, 1.0)).norm() < params.arrived,
            "{pose:?}"
        );
        assert!(off < 0.1, "{off}");
    }

    #[test]
    fn a_path_of_one_point_leads_there_and_none_to_a_stop() {
        let pose = Pose2::new(0.0, 0.0, 0.0);
        let params = GoToParams::default();
        let command = |points: &[Point2<f64>]| {
            go_along(
                &pose,
                &Path::new(points.iter().copied()),
                &limits(),
                &params,
                DT,
            )
        };
        assert_eq!(command(&[]), Twist2::STOP);
        assert_eq!(command(&[Point2::new(2.0, 0.0)]), Twist2::new(0.5, 0.0));
        assert_eq!(command(&[Point2::new(f64::NAN, 0.0)]), Twist2::STOP);
    }
}
