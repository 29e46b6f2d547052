//! Which obstacles stand, as the events go by.

use config::{Code, list_choices, nearest};
use geometry::map::MapSpec;

use super::{Action, EventSpec, Moment};

/// How the order of events comes about that nobody knows the times of.
const IN_TURN: &str =
    "the changes of an obstacle that has a `when` happen in the order of the file";

/// Which obstacles stand, as the events go by.
pub(super) struct History {
    known: Vec<Known>,
    next: u32,
}

/// An obstacle of the map, or of an event so far.
struct Known {
    name: String,
    id: u32,
    stands: bool,
    /// Latest time of its events so far that happen in turn (s).
    latest_s: f64,
}

/// Why an event cannot happen.
pub(super) struct Impossible {
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
            .map(|(i, o)| Known {
                name: o.name.clone(),
                id: i as u32,
                stands: true,
                latest_s: 0.0,
            })
            .collect();
        Self {
            known,
            next: obstacles.len() as u32,
        }
    }

    /// Takes up the next event: the number of its obstacle.
    pub(super) fn apply(&mut self, event: &EventSpec) -> Result<u32, Impossible> {
        let found = self.known.iter_mut().find(|k| k.name == event.obstacle);
        let in_turn_at = match event.moment {
            Moment::At { time_s } => event.in_turn.then_some(time_s),
            Moment::When { .. } => None,
        };
        match (event.action, found) {
            (Action::Appear, None) => {
                let id = self.next;
                self.next += 1;
                self.known.push(Known {
                    name: event.obstacle.clone(),
                    id,
                    stands: true,
                    latest_s: in_turn_at.unwrap_or(0.0),
                });
                Ok(id)
            }
            (action, Some(known)) if known.stands != (action == Action::Appear) => {
                if let Some(time_s) = in_turn_at {
                    if time_s < known.latest_s {
                        return Err(too_early(event, time_s, known.latest_s));
                    }
                    known.latest_s = time_s;
                }
                known.stands = action != Action::Disappear;
                Ok(known.id)
            }
            (Action::Appear, Some(_)) => Err(Impossible {
                field: "obstacle",
                code: Code::Duplicate,
                message: format!(
                    "obstacle `{}` appears {}, but it stands already",
                    event.obstacle,
                    then(event)
                ),
                expected: Some("the name of an obstacle that does not stand at that time".into()),
                help: event.in_turn.then(|| IN_TURN.to_owned()),
            }),
            (Action::Disappear | Action::Move, _) => Err(self.missing(event)),
        }
    }

    /// Something shall happen to an obstacle that does not stand.
    fn missing(&self, event: &EventSpec) -> Impossible {
        let name = &event.obstacle;
        // What comes at a time could be gone or not when something comes in turn.
        let choices: Vec<&str> = self
            .known
            .iter()
            .filter(|k| k.stands || (event.in_turn && k.name != *name))
            .map(|k| k.name.as_str())
            .collect();
        let near = nearest(name, choices.iter().copied());
        let meant = near.map(|near| format!("did you mean `{near}`?"));
        // A name that has stood before is not misspelt.
        let has_stood = self.known.iter().any(|k| k.name == *name);
        let help = match meant {
            Some(meant) if !(event.in_turn && has_stood) => Some(meant),
            _ => event.in_turn.then(|| IN_TURN.to_owned()),
        };
        Impossible {
            field: "obstacle",
            code: Code::UnknownName,
            message: format!("no obstacle `{name}` stands {}", then(event)),
            expected: Some(list_choices(&choices)),
            help,
        }
    }
}

/// When an event happens, in words.
fn then(event: &EventSpec) -> String {
    match event.moment {
        Moment::At { time_s } if !event.in_turn => format!("at {time_s} s"),
        _ => "after the events before this one".to_owned(),
    }
}

fn too_early(event: &EventSpec, time_s: f64, latest_s: f64) -> Impossible {
    Impossible {
        field: "time_s",
        code: Code::Requirement,
        message: format!(
            "obstacle `{}` changes at {time_s} s, behind a change at {latest_s} s",
            event.obstacle
        ),
        expected: Some(format!("a time of at least {latest_s} (s)")),
        help: Some(IN_TURN.to_owned()),
    }
}
