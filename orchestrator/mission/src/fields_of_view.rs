//! The fields of view of a run, drawn by viewers and reports.

use geometry::visibility::polygon::SightLimits;
use recorder::{FieldOfView, ViewOrigin};
use robot::team::Role;
use scenario::ResolvedScenario;

/// Returns the fields of view of a scenario's processes, each with a name. If no process has one, the pursuers have an
/// unlimited view in all directions.
pub(crate) fn fields_of_view(scenario: &ResolvedScenario) -> Vec<FieldOfView> {
    let robots = &scenario.world.robots;
    let lookouts = scenario.processes.iter().filter_map(|process| {
        let kind = process.program.kind()?;
        Some((&*process.name, kind.lookout(&process.robots, robots)?))
    });
    let name = |robot: usize| robots.get(robot).map_or("", |robot| robot.name.as_str());
    let mut fields: Vec<FieldOfView> = Vec::new();
    let mut has_lookout = false;
    let mut add = |from: String, by: &str, origin, limits: SightLimits| {
        let (range, angle) = (limits.range, limits.field_of_view);
        let same = |field: &FieldOfView| {
            field.origin == origin && field.range == range && field.angle == angle
        };
        // Equal fields of one place are drawn once.
        if !fields.iter().any(same) {
            fields.push(FieldOfView {
                name: format!("seen by {from}{by}"),
                origin,
                range,
                angle,
            });
        }
    };
    for (process, lookout) in lookouts {
        has_lookout = true;
        let by = format!(" ({process})");
        let given = lookout.robots.iter().copied();
        for robot in given.filter(|&robot| robot < robots.len()) {
            let origin = ViewOrigin::Robot(robot as u32);
            add(name(robot).to_owned(), &by, origin, lookout.limits);
        }
        for [x, y] in lookout.points {
            let origin = ViewOrigin::Point([x, y]);
            add(format!("{x} {y}"), &by, origin, lookout.limits);
        }
    }
    if !has_lookout {
        let police = (0..robots.len()).filter(|&robot| robots[robot].role() == Role::Pursuer);
        for robot in police {
            let origin = ViewOrigin::Robot(robot as u32);
            add(name(robot).to_owned(), "", origin, SightLimits::default());
        }
    }
    fields
}

#[cfg(test)]
mod tests {
    use super::*;
    use kinds::load;

    fn names(target: &str, set: &[&str]) -> Vec<String> {
        let set: Vec<String> = set.iter().map(|&set| set.to_owned()).collect();
        let fields = fields_of_view(&load(target, &set, None).unwrap());
        fields.into_iter().map(|field| field.name).collect()
    }

    #[test]
    fn perception_looks_from_all_police_within_its_limits() {
        let set = [
            "processes.perception.params.sensor.range=3",
            "processes.perception.params.sensor.field_of_view=2",
        ];
        let scenario = load("chase", &set.map(str::to_owned), None).unwrap();
        let fields = fields_of_view(&scenario);
        assert_eq!(fields.len(), 4);
        for (robot, field) in fields.iter().enumerate() {
            assert_eq!(field.origin, ViewOrigin::Robot(robot as u32));
            assert_eq!((field.range, field.angle), (Some(3.0), Some(2.0)));
        }
        assert_eq!(fields[0].name, "seen by police_1 (perception)");
        let json = serde_json::to_value(&fields[1]).unwrap();
        let expected = serde_json::json!({
            "name": "seen by police_2 (perception)",
            "robot": 1,
            "range": 3.0,
            "field_of_view": 2.0,
        });
        assert_eq!(json, expected);
    }

    #[test]
    fn without_perception_the_police_are_drawn_and_without_police_no_robot() {
        assert_eq!(names("chase_exact", &[])[0], "seen by police_1");
        assert_eq!(names("hello", &[]), [""; 0]);
    }

    #[test]
    fn an_observer_has_viewpoints_unless_it_has_exact_positions() {
        assert_eq!(names("patrol_square", &[]), [""; 0]);
        let places = "processes.observer.params.from_points=[[1.0, 0.5], [1.0, 0.5]]";
        assert_eq!(
            names(
                "patrol_square",
                &[places, "processes.observer.params.viewpoint.range=2"]
            ),
            ["seen by 1 0.5 (observer)"]
        );
    }
}
