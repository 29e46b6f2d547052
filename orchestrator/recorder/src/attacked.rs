//! Judgement of attacks from the positions of the robots and the map alone.

use geometry::visibility::VisibilityField;
use ipc_types::consumer::{Consumer, LoggedMessage};
use ipc_types::messages::attacker::AttackHeader;
use ipc_types::messages::world::MapCell;
use ipc_types::topics::{Attacks, TopicId, WorldMap, WorldState};
use metrics::detection::DetectionRule;
use nalgebra::Point2;
use runtime::grids::{blurred_map, map_grids};

use super::run_info::RunInfo;
use super::summary::{AttackOutcome, OutcomePart, Summary, seconds};

/// Maximum number of attacks; later ones are only in the log.
const MAX_ATTACKS: usize = 10_000;

/// An attack that is not over.
#[derive(Debug)]
struct Open {
    /// Index in the list of attacks.
    attack: usize,
    end_ns: u64,
    place: Point2<f64>,
    rule: DetectionRule,
    guards: Vec<u32>,
}

/// Newest map, and its lines of sight when an attack needs them.
#[derive(Debug, Default)]
struct Map {
    message: Vec<u8>,
    sight: Option<VisibilityField>,
}

/// All attacks.
#[derive(Debug)]
pub(super) struct Attacked {
    run: RunInfo,
    attacks: Vec<AttackOutcome>,
    open: Vec<Open>,
    map: Map,
    /// Positions of the robots at a time (ns); `None` out of play.
    robots: Vec<Option<Point2<f64>>>,
    now_ns: u64,
}

impl Attacked {
    /// Creates the judgement of a run.
    pub(super) fn new(run: &RunInfo) -> Self {
        Self {
            run: run.clone(),
            attacks: Vec::new(),
            open: Vec::new(),
            map: Map::default(),
            robots: vec![None; run.robots.len()],
            now_ns: 0,
        }
    }

    fn begin(&mut self, message: &LoggedMessage<'_>, attack: &AttackHeader, guards: Vec<u32>) {
        if self.attacks.len() >= MAX_ATTACKS {
            return;
        }
        let duration_ns = (attack.duration_s.max(0.0) * 1e9).round() as u64;
        self.open.push(Open {
            attack: self.attacks.len(),
            end_ns: message.time_ns.saturating_add(duration_ns),
            place: Point2::new(attack.x, attack.y),
            rule: DetectionRule {
                distance: attack.distance,
                sight: attack.sight,
            },
            guards,
        });
        self.attacks.push(AttackOutcome {
            attacker: self.run.process_name(message.stamp.source),
            method: attack.method_name().to_owned(),
            x: attack.x,
            y: attack.y,
            begin_s: message.time_s(),
            duration_s: attack.duration_s,
            distance_m: attack.distance,
            sight_m: attack.sight,
            outcome: "open".to_owned(),
            detected_s: None,
        });
        // The state of its tick comes before or after it.
        if self.now_ns == message.time_ns {
            self.judge();
        }
    }

    /// Judges the open attacks by the newest positions.
    fn judge(&mut self) {
        let (now_ns, robots, map) = (self.now_ns, &self.robots, &mut self.map);
        let attacks = &mut self.attacks;
        self.open.retain(|open| {
            let position = |&robot: &u32| robots.get(robot as usize).copied().flatten();
            let mut guards = open.guards.iter().filter_map(position);
            let mut is_visible = |a, b| map.sight().is_some_and(|field| field.is_visible(a, b));
            let is_detected = now_ns <= open.end_ns
                && guards.any(|guard| open.rule.detects(open.place, guard, &mut is_visible));
            let outcome = if is_detected {
                "detected"
            } else if now_ns >= open.end_ns {
                "undetected"
            } else {
                return true;
            };
            if let Some(attack) = attacks.get_mut(open.attack) {
                outcome.clone_into(&mut attack.outcome);
                attack.detected_s = is_detected.then_some(seconds(now_ns));
            }
            false
        });
    }
}

impl Map {
    /// The lines of sight; `None` before the first valid map.
    fn sight(&mut self) -> Option<&VisibilityField> {
        if self.sight.is_none() {
            let message = LoggedMessage::new(TopicId::WorldMap, 0, &self.message)?;
            let (header, cells) = message.view::<WorldMap>()?;
            let cells: Vec<MapCell> = cells.collect();
            let grids = map_grids(&header, &cells);
            let map = blurred_map(grids.blurred, grids.occupied).ok()?;
            self.sight = Some(VisibilityField::new(&map));
        }
        self.sight.as_ref()
    }
}

impl Consumer for Attacked {
    fn topics(&self) -> &[TopicId] {
        // A map may be large: it is kept only for the kind that attacks.
        if self.run.processes.iter().any(|p| p.kind == "attacker") {
            &[TopicId::WorldState, TopicId::Attacks, TopicId::WorldMap]
        } else {
            &[TopicId::WorldState, TopicId::Attacks]
        }
    }

    fn message(&mut self, message: &LoggedMessage<'_>, (): &mut ()) {
        if let Some((header, guards)) = message.view::<Attacks>() {
            self.begin(message, &header, guards.map(|guard| guard.robot).collect());
        } else if message.topic == TopicId::WorldMap {
            self.map = Map {
                message: message.bytes.to_vec(),
                sight: None,
            };
        } else if let Some((_, states)) = message.view::<WorldState>() {
            for state in states {
                if let Some(robot) = self.robots.get_mut(state.robot as usize) {
                    *robot = (state.status == 0).then(|| Point2::new(state.x, state.y));
                }
            }
            self.now_ns = message.time_ns;
            self.judge();
        }
    }
}

impl OutcomePart for Attacked {
    fn finish(self: Box<Self>, summary: &mut Summary) {
        summary.attacks = self.attacks;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ProcessInfo;
    use ipc_types::cdr;
    use ipc_types::messages::attacker::Guard;
    use ipc_types::messages::world::{MapHeader, RobotState, WorldHeader};
    use ipc_types::topics::Topic;

    fn send<T: Topic>(
        attacked: &mut Attacked,
        tick: u64,
        header: &T::Header,
        elements: &[T::Element],
    ) {
        let mut bytes = Vec::new();
        cdr::encode::<T>(header, elements, &mut bytes);
        let message = LoggedMessage::new(T::id(), tick * 1_000_000_000, &bytes).unwrap();
        attacked.message(&message, &mut ());
    }

    /// Robot 1 drives along y = 0 at 1 m/s from x = 0; robot 0 stands at the place of all attacks.
    fn state(attacked: &mut Attacked, tick: u64) {
        let robot = |robot, x| RobotState {
            x,
            robot,
            ..RobotState::default()
        };
        let robots = [robot(0, 10.0), robot(1, tick as f64)];
        send::<WorldState>(attacked, tick, &WorldHeader::default(), &robots);
    }

    fn attack(attacked: &mut Attacked, tick: u64, duration_s: f64, sight: f64) {
        let header = AttackHeader {
            x: 10.0,
            duration_s,
            distance: 1.0,
            sight,
            method: 3,
            ..AttackHeader::default()
        };
        send::<Attacks>(attacked, tick, &header, &[Guard { robot: 1 }]);
    }

    fn attacked() -> Attacked {
        let process = ProcessInfo {
            index: 0,
            name: "intruder".to_owned(),
            kind: "attacker".to_owned(),
            upstream: Vec::new(),
        };
        let robot = super::super::RobotInfo {
            name: String::new(),
            team: String::new(),
            radius: 0.1,
            visits_waypoints: false,
            lap_limit_s: None,
        };
        Attacked::new(&RunInfo {
            processes: vec![process],
            robots: vec![robot.clone(), robot],
            ..RunInfo::default()
        })
    }

    #[test]
    fn attacks_are_detected_by_their_guards_while_they_last() {
        let mut attacked = attacked();
        // Over before the guard comes, at its very end, open at the end of the run; before or after the state of its tick.
        for tick in 0..=9 {
            if tick == 2 {
                attack(&mut attacked, tick, 6.0, 0.0);
            }
            state(&mut attacked, tick);
            if tick == 2 {
                attack(&mut attacked, tick, 7.0, 0.0);
            }
            if tick == 9 {
                attack(&mut attacked, 9, 5.0, 0.0);
            }
        }
        for tick in 12..14 {
            state(&mut attacked, tick);
            attack(&mut attacked, tick, 50.0, 0.0);
        }
        let outcome = |a: &AttackOutcome| (a.begin_s, a.outcome.clone(), a.detected_s);
        let found: Vec<_> = attacked.attacks.iter().map(outcome).collect();
        assert_eq!(
            found,
            [
                (2.0, "undetected".to_owned(), None),
                (2.0, "detected".to_owned(), Some(9.0)),
                (9.0, "detected".to_owned(), Some(9.0)),
                (12.0, "open".to_owned(), None),
                (13.0, "open".to_owned(), None),
            ]
        );
        let first = &attacked.attacks[0];
        assert_eq!(
            (&*first.attacker, &*first.method),
            ("intruder", "best_response")
        );
    }

    #[test]
    fn walls_hide_places_from_guards_that_see() {
        for (wall, seen_s) in [(false, 5.0), (true, 9.0)] {
            let mut attacked = attacked();
            let header = MapHeader {
                resolution: 1.0,
                origin_x: -0.5,
                origin_y: -0.5,
                width: 20,
                height: 1,
                revision: 1,
                ..MapHeader::default()
            };
            let cell = |column| MapCell {
                blurred: 1.0,
                occupied: u8::from(wall && column == 8),
                ..MapCell::default()
            };
            let cells: Vec<MapCell> = (0..20).map(cell).collect();
            send::<WorldMap>(&mut attacked, 0, &header, &cells);
            for tick in 0..10 {
                state(&mut attacked, tick);
                if tick == 0 {
                    attack(&mut attacked, tick, 20.0, 5.0);
                }
            }
            assert_eq!(attacked.attacks[0].detected_s, Some(seen_s), "{wall}");
        }
    }
}
