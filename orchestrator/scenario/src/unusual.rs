//! Values that are accepted and probably in another unit.

use geometry::map::MapSpec;
use parameters::{Unusual, unusual};

use super::kind::ConfiguredKind;
use super::resolved::ResolvedScenario;

impl ResolvedScenario {
    /// Returns warnings about values that suggest another unit: one for all places of a key.
    pub(super) fn unusual_values(&self) -> Vec<String> {
        let mut found = Grouped::default();
        let of_map = match &self.world.map {
            MapSpec::Vector(map) => unusual(map),
            MapSpec::Cells(map) => map.exits.iter().flat_map(unusual).collect(),
            MapSpec::File { .. } => Vec::new(),
        };
        found.add_all("world.map", of_map);
        found.add_all("rules", unusual(self.rules()));
        for robot in &self.world.robots {
            found.add_all(&robot.name, unusual(robot));
            let model = robot.model();
            let way = model.v_max.max(model.v_reverse_max) * self.run.dt;
            // Not for a product rounded up.
            if way > model.radius + 1e-9 {
                let text = format!(
                    "it may drive {way:.3} m in a tick, farther than its radius of {} m",
                    model.radius
                );
                found.add("way", &robot.name, &text);
            }
        }
        for process in &self.processes {
            let values = process.program.kind().map(ConfiguredKind::unusual);
            found.add_all(&process.name, values.unwrap_or_default());
        }
        for event in &self.events {
            let values = event.shape.as_ref().map(unusual);
            found.add_all(&event.obstacle, values.unwrap_or_default());
        }
        found.texts()
    }
}

/// Remarks by what they are about: the text of the first, and the number of the others.
#[derive(Default)]
struct Grouped(Vec<(String, String, usize)>);

impl Grouped {
    fn add(&mut self, about: &str, place: &str, text: &str) {
        match self.0.iter_mut().find(|(known, ..)| known == about) {
            Some((.., others)) => *others += 1,
            None => self
                .0
                .push((about.to_owned(), format!("{place}: {text}"), 0)),
        }
    }

    /// Adds values of a place, each about its key without indices.
    fn add_all(&mut self, place: &str, values: Vec<Unusual>) {
        for value in values {
            let about: String = value
                .field
                .chars()
                .filter(|c| !c.is_ascii_digit())
                .collect();
            self.add(&about, place, &value.to_string());
        }
    }

    fn texts(self) -> Vec<String> {
        let text = |(_, text, others)| match others {
            0 => text,
            others => format!("{text} (and {others} more)"),
        };
        self.0.into_iter().map(text).collect()
    }
}
