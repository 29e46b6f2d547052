//! The obstacles present after each event, in the order of the events.

use config::{Code, list_choices, nearest};
use geometry::map::MapSpec;

use super::{Action, EventSpec, Moment};

/// Order of the events of an obstacle whose times are not known in advance.
const ORDERED: &str =
    "the changes of an obstacle that has a `when` happen in the order of the file";

/// Obstacles present after the events so far.
pub(super) struct History {
    known: Vec<ObstacleRecord>,
    next: u32,
}

/// An obstacle of the map, or of an event so far.
struct ObstacleRecord {
    name: String,
    id: u32,
    is_present: bool,
    /// Latest time of its ordered events so far (s).
    latest_s: f64,
}

/// Reason why an event is impossible.
pub(super) struct ImpossibleEvent {
    pub(super) field: &'static str,
    pub(super) code: Code,
    pub(super) message: String,
    pub(super) expected: Option<String>,
    pub(super) help: Option<String>,
}

impl History {
    pub(super) fn new(map: &MapSpec) -> Self {
        let obstacles = match map {
            MapSpec::Vector(map) => map.obstacles.as_slice(),
            _ => &[],
        };
        let known = obstacles
            .iter()
            .enumerate()
            .filter(|(_, o)| !o.name.is_empty())
            .map(|(i, o)| ObstacleRecord {
                name: o.name.clone(),
                id: i as u32,
                is_present: true,
                latest_s: 0.0,
            })
            .collect();
        Self {
            known,
            next: obstacles.len() as u32,
        }
    }

    /// Applies the next event and returns the id of its obstacle.
    pub(super) fn apply(&mut self, event: &EventSpec) -> Result<u32, ImpossibleEvent> {
        let found = self.known.iter_mut().find(|k| k.name == event.obstacle);
        let in_turn_at = match event.moment {
            Moment::At { time_s } => event.in_turn.then_some(time_s),
            Moment::When { .. } => None,
        };
        match (event.action, found) {
            (Action::Appear, None) => {
                let id = self.next;
                self.next += 1;
                self.known.push(ObstacleRecord {
                    name: event.obstacle.clone(),
                    id,
                    is_present: true,
                    latest_s: in_turn_at.unwrap_or(0.0),
                });
                Ok(id)
            }
            (action, Some(known)) if known.is_present != (action == Action::Appear) => {
                if let Some(time_s) = in_turn_at {
                    if time_s < known.latest_s {
                        return Err(too_early(event, time_s, known.latest_s));
                    }
                    known.latest_s = time_s;
                }
                known.is_present = action != Action::Disappear;
                Ok(known.id)
            }
            (Action::Appear, Some(_)) => Err(ImpossibleEvent {
                field: "obstacle",
                code: Code::Duplicate,
                message: format!(
                    "obstacle `{}` appears {}, but it is present already",
                    event.obstacle,
                    describe_time(event)
                ),
                expected: Some("the name of an obstacle that is not present at that time".into()),
                help: event.in_turn.then(|| ORDERED.to_owned()),
            }),
            (Action::Disappear | Action::Move, _) => Err(self.missing(event)),
        }
    }

    /// Returns the error for an event whose obstacle is not present.
    fn missing(&self, event: &EventSpec) -> ImpossibleEvent {
        let name = &event.obstacle;
        // The order of timed events and ordered events is unknown, so that either may be listed.
        let choices: Vec<&str> = self
            .known
            .iter()
            .filter(|k| k.is_present || (event.in_turn && k.name != *name))
            .map(|k| k.name.as_str())
            .collect();
        let near = nearest(name, choices.iter().copied());
        let suggestion = near.map(|near| format!("did you mean `{near}`?"));
        // A name that was present before is not a misspelling.
        let was_present = self.known.iter().any(|k| k.name == *name);
        let help = match suggestion {
            Some(suggestion) if !(event.in_turn && was_present) => Some(suggestion),
            _ => event.in_turn.then(|| ORDERED.to_owned()),
        };
        ImpossibleEvent {
            field: "obstacle",
            code: Code::UnknownName,
            message: format!("no obstacle `{name}` is present {}", describe_time(event)),
            expected: Some(list_choices(&choices)),
            help,
        }
    }
}

/// Describes the time of an event in words.
fn describe_time(event: &EventSpec) -> String {
    match event.moment {
        Moment::At { time_s } if !event.in_turn => format!("at {time_s} s"),
        _ => "after the events before this one".to_owned(),
    }
}

fn too_early(event: &EventSpec, time_s: f64, latest_s: f64) -> ImpossibleEvent {
    ImpossibleEvent {
        field: "time_s",
        code: Code::Requirement,
        message: format!(
            "obstacle `{}` changes at {time_s} s, after a change at {latest_s} s",
            event.obstacle
        ),
        expected: Some(format!("a time of at least {latest_s} (s)")),
        help: Some(ORDERED.to_owned()),
    }
}
