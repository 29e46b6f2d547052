//! Lines of sight between robots.

use ipc_types::consumer::{Consumer, LoggedMessage};
use ipc_types::messages::perception::Sighting;
use ipc_types::messages::world::RobotState;
use ipc_types::topics::{Sightings, TopicId};

use super::channel::ViewerChannel;
use super::palette;
use super::picture::Picture;
use super::primitives::{kind, marker, picture, width};
use ros_messages::messages::{ColorRGBA, MarkerArray, Point};

/// Height of the lines (m): above plans.
const HEIGHT: f64 = 0.08;
/// Opacity of the weakest sighting.
const FAINT: f32 = 0.2;

/// `/sight`.
pub(super) struct SightTopic {
    channel: ViewerChannel<MarkerArray>,
    sight: Sight,
}

impl SightTopic {
    pub(super) fn new(picture: &mut Picture) -> Self {
        Self {
            channel: picture.add_channel("/sight"),
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
        let line = picture.line_width() / 2.0;
        if let Some(lines) = self.sight.draw(&picture.states, time_ns, line) {
            self.channel.write(&mut picture.ready, time_ns, &lines);
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
    /// if there are no lines to draw or remove. `line` is the width of a line (m).
    fn draw(&mut self, states: &[RobotState], time_ns: u64, line: f64) -> Option<MarkerArray> {
        let place = |robot: u32| {
            let state = states.iter().find(|state| state.robot == robot)?;
            Some(Point {
                x: state.x,
                y: state.y,
                z: HEIGHT,
            })
        };
        let mut lines = marker("sight", 0, kind::LINE_LIST, palette::SIGHT, time_ns);
        lines.scale = width(line);
        for sighting in &self.sightings {
            if let (Some(from), Some(to)) = (place(sighting.observer), place(sighting.robot)) {
                let visibility = sighting.visibility.clamp(0.0, 1.0) as f32;
                let color = ColorRGBA {
                    a: FAINT + (1.0 - FAINT) * visibility,
                    ..palette::SIGHT
                };
                lines.points.extend([from, to]);
                lines.colors.extend([color.clone(), color]);
            }
        }
        let shows = !lines.points.is_empty();
        let shown = core::mem::replace(&mut self.shown, shows);
        let mut sight = picture(time_ns);
        if shows {
            sight.markers.push(lines);
        }
        (shows || shown).then_some(sight)
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
        assert!(sight.draw(&states, 0, 0.1).is_none(), "no sightings");
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
        let drawn = sight.draw(&states, 1, 0.1).unwrap();
        let line = &drawn.markers[1];
        assert_eq!(
            line.points.iter().map(|p| p.x).collect::<Vec<_>>(),
            [1.0, 5.0]
        );
        assert!((line.colors[0].a - 0.6).abs() < 1e-6);
        sight.set([Sighting { seen: 0, ..seen }].into_iter());
        let drawn = sight.draw(&states, 2, 0.1).unwrap();
        assert_eq!(drawn.markers.len(), 1, "removes the line");
        assert!(sight.draw(&states, 3, 0.1).is_none());
    }
}
