//! Values that are accepted and probably in another unit.

use geometry::map::MapSpec;
use parameters::{Unusual, unusual};

use super::remarks::first_of_each;
use super::resolved::ResolvedScenario;

impl ResolvedScenario {
    /// Returns warnings about values that suggest another unit: one for all places of a key.
    pub(super) fn unusual_values(&self) -> Vec<String> {
        let mut found: Vec<(String, String)> = Vec::new();
        let of_map = match &self.world.map {
            MapSpec::Vector(map) => unusual(map),
            MapSpec::Cells(map) => map.exits.iter().flat_map(unusual).collect(),
            MapSpec::File { .. } => Vec::new(),
        };
        found.extend(of_place("world.map", of_map));
        found.extend(of_place("rules", unusual(self.rules())));
        for robot in &self.world.robots {
            found.extend(of_place(&robot.name, unusual(robot)));
            let model = robot.model();
            let way = model.v_max.max(model.v_reverse_max) * self.run.dt;
            // Not for a product rounded up.
            if way > model.radius + 1e-9 {
                let text = format!(
                    "{}: it may drive {way:.3} m in a tick, farther than its radius of {} m",
                    robot.name, model.radius
                );
                found.push(("way".to_owned(), text));
            }
        }
        for process in &self.processes {
            let values = process.program.kind().map(|kind| kind.unusual());
            found.extend(of_place(&process.name, values.unwrap_or_default()));
        }
        for event in &self.events {
            let values = event.shape.as_ref().map(unusual);
            found.extend(of_place(&event.obstacle, values.unwrap_or_default()));
        }
        first_of_each(found)
    }
}

/// Returns values of a place with what each is about: its key without indices.
fn of_place(place: &str, values: Vec<Unusual>) -> impl Iterator<Item = (String, String)> {
    values.into_iter().map(move |value| {
        let key = value.field.chars().filter(|c| !c.is_ascii_digit());
        (key.collect(), format!("{place}: {value}"))
    })
}
