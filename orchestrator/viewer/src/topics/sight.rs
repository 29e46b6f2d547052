//! Lines of sight between robots.

use foxglove::messages::{Color, LinePrimitive, Point3, SceneEntity, SceneUpdate, line_primitive};
use ipc_types::consumer::{Consumer, LoggedMessage};
use ipc_types::messages::perception::Sighting;
use ipc_types::messages::world::RobotState;
use ipc_types::topics::{Sightings, TopicId};

use super::channel::ViewerChannel;
use super::palette;
use super::picture::Picture;
use super::primitives::{deletion, entity, pose};

/// Id of the entity.
const ID: &str = "sight";
/// Width of a line (pixels).
const PIXELS: f64 = 1.5;
/// Height of the lines (m): above plans.
const HEIGHT: f64 = 0.08;
/// Opacity of the weakest sighting.
const FAINT: f64 = 0.2;

/// `/viewer/sight`.
pub(super) struct SightTopic {
    channel: ViewerChannel<SceneUpdate>,
    sight: Sight,
}

impl SightTopic {
    pub(super) fn new(picture: &mut Picture) -> Self {
        Self {
            channel: picture.add_channel("/viewer/sight"),
            sight: Sight::default(),
        }
    }
}

impl Consumer<Picture> for SightTopic {
    fn topics(&self) -> &[TopicId] {
        &[TopicId::Sightings]
    }

    fn message(&mut self, message: &LoggedMessage<'_>, _: &mut Picture) {
        if let Some((_, sightings)) = message.view::<Sightings>() {
            self.sight.set(sightings);
        }
    }

    fn end_of_tick(&mut self, picture: &mut Picture) {
        let time_ns = picture.now_ns();
        if let Some(update) = self.sight.draw(&picture.states, time_ns) {
            self.channel.write(&mut picture.ready, time_ns, &update);
        }
    }
}

/// Sightings of the current tick.
#[derive(Debug, Default)]
struct Sight {
    sightings: Vec<Sighting>,
    shown: bool,
}

impl Sight {
    /// Replaces the sightings.
    fn set(&mut self, sightings: impl Iterator<Item = Sighting>) {
        self.sightings.clear();
        self.sightings.extend(sightings.filter(|s| s.seen != 0));
    }

    /// Returns a line from every seen robot to the robot that sees it best, with opacity by quality; `None`
    /// if there are no lines to draw or remove.
    fn draw(&mut self, states: &[RobotState], time_ns: u64) -> Option<SceneUpdate> {
        let place = |robot: u32| {
            let state = states.iter().find(|state| state.robot == robot)?;
            Some(Point3 {
                x: state.x,
                y: state.y,
                z: HEIGHT,
            })
        };
        let (mut points, mut colors) = (Vec::new(), Vec::new());
        for sighting in &self.sightings {
            if let (Some(from), Some(to)) = (place(sighting.observer), place(sighting.robot)) {
                let visibility = sighting.visibility.clamp(0.0, 1.0);
                let color = Color {
                    a: FAINT + (1.0 - FAINT) * visibility,
                    ..palette::SIGHT
                };
                points.extend([from, to]);
                colors.extend([color, color]);
            }
        }
        let mut update = SceneUpdate::default();
        let (shown, shows) = (self.shown, !points.is_empty());
        if shows {
            update.entities.push(SceneEntity {
                lines: vec![LinePrimitive {
                    r#type: line_primitive::Type::LineList as i32,
                    pose: Some(pose(0.0, 0.0, 0.0, 0.0)),
                    thickness: PIXELS,
                    scale_invariant: true,
                    points,
                    colors,
                    ..LinePrimitive::default()
                }],
                ..entity(ID.to_owned(), time_ns)
            });
        } else {
            update.deletions.push(deletion(ID.to_owned(), time_ns));
        }
        self.shown = shows;
        (shows || shown).then_some(update)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_of_sight_connect_observer_and_target_and_end_with_the_sighting() {
        let states = [(0, 1.0), (1, 5.0)].map(|(robot, x)| RobotState {
            robot,
            x,
            ..RobotState::default()
        });
        let mut sight = Sight::default();
        assert!(sight.draw(&states, 0).is_none(), "no sightings");
        let seen = Sighting {
            robot: 1,
            observer: 0,
            visibility: 0.5,
            seen: 1,
            ..Sighting::default()
        };
        let unobserved = Sighting {
            observer: u32::MAX,
            ..seen
        };
        sight.set([seen, unobserved].into_iter());
        let update = sight.draw(&states, 1).unwrap();
        let line = &update.entities[0].lines[0];
        assert_eq!(
            line.points.iter().map(|p| p.x).collect::<Vec<_>>(),
            [1.0, 5.0]
        );
        assert!((line.colors[0].a - 0.6).abs() < 1e-12);
        sight.set([Sighting { seen: 0, ..seen }].into_iter());
        assert_eq!(sight.draw(&states, 2).unwrap().deletions[0].id, ID);
        assert!(sight.draw(&states, 3).is_none());
    }
}
