//! Connects adversaries to their topics: state and map in, attacks out.

use control::go_to::GoToParams;
use geometry::pose::Pose2;
use geometry::visibility::VisibilityField;
use ipc_types::bus::{Bus, Publisher, PublisherOptions};
use ipc_types::messages::attacker::{AttackHeader, Guard};
use ipc_types::topics::Attacks;
use nalgebra::Point2;
use patrol::attack::{Adversary, BestResponse, Method, Schedule, Visits, guarded};
use patrol::mission::Drive;
use runtime::declaration::{Declaration, Input, Output};
use runtime::grids::{blurred_map, map_grids};
use runtime::inputs::{MapInput, StateInput, reply_stamp};
use runtime::maps::Maps;
use runtime::{Process, ProcessConfig, ProcessError, ProcessKind, RobotInfo};
use std::sync::Arc;

use crate::params::AttackerParams;

/// Process of some adversaries.
pub struct AttackerProcess {
    config: ProcessConfig,
    params: AttackerParams,
    guards: Vec<Guard>,
    places: Vec<Point2<f64>>,
    visits: Visits,
    adversaries: Vec<Adversary>,
    best_response: Option<BestResponse>,
    state: StateInput,
    /// The map and its lines of sight, if guards see.
    map: Option<MapInput>,
    sight: Option<VisibilityField>,
    attacks: Publisher<Attacks>,
    last_tick: Option<u64>,
}

impl ProcessKind for AttackerProcess {
    const NAME: &'static str = "attacker";
    const SUMMARY: &'static str =
        "attacks places that robots guard, at times and places chosen from what it sees";

    type Params = AttackerParams;

    fn declare(params: &AttackerParams) -> Declaration {
        Declaration::default()
            .reads(Input::STATE)
            .reads_if(params.sight.is_some(), Input::MAP)
            .writes(Output::new::<Attacks>(0))
    }

    fn open(
        config: &ProcessConfig,
        params: &AttackerParams,
        bus: &Bus,
    ) -> Result<Self, ProcessError> {
        let run = &config.run;
        let refuse = |reason: String| ProcessError::Params {
            process: config.name.clone(),
            kind: config.kind.clone(),
            reason,
        };
        let is_watched =
            |info: &RobotInfo| params.watch.is_empty() || params.watch.contains(&info.name);
        let unknown = params
            .watch
            .iter()
            .find(|&name| run.robots.iter().all(|r| r.name != *name));
        if let Some(name) = unknown {
            return Err(refuse(format!(
                "`watch` names `{name}`: expected robots of the scenario"
            )));
        }
        let watched = || (0..).zip(&run.robots).filter(|(_, info)| is_watched(info));
        let guards: Vec<Guard> = watched().map(|(robot, _)| Guard { robot }).collect();
        let mission = params.mission.as_ref().zip(watched().next());
        let best_response = match mission {
            Some((mission, (_, info))) if params.methods.contains(&Method::BestResponse) => {
                let drive = Drive::from_model(&info.model).map_err(|e| refuse(e.to_string()))?;
                let prepared = mission.prepare(&drive, &GoToParams::default(), run.seed);
                let prepared = prepared.map_err(|e| refuse(format!("`mission`: {e}")))?;
                Some(BestResponse {
                    awg: prepared.of_team(guards.len()).awg,
                    samples: params.samples,
                })
            }
            _ => None,
        };
        let adversary = |&method: &Method| {
            let name = AttackHeader::METHODS[method as usize];
            let rng = runtime::seed::stream(run.seed, &config.name, "", name);
            Adversary::new(method, params.schedule(), rng)
        };
        let places = params.places();
        Ok(Self {
            visits: Visits::new(places.len()),
            adversaries: params.methods.iter().map(adversary).collect(),
            best_response,
            state: StateInput::open(bus, run.robots.len())?,
            map: params.sight.map(|_| MapInput::open(bus)).transpose()?,
            sight: None,
            attacks: bus.publisher(PublisherOptions::new(config.index, guards.len()))?,
            config: config.clone(),
            params: params.clone(),
            guards,
            places,
            last_tick: None,
        })
    }
}

impl Process for AttackerProcess {
    fn share_maps(&mut self, maps: &Arc<Maps>) {
        if let Some(map) = &mut self.map {
            map.share(maps);
        }
    }

    fn connect(&mut self) -> Result<(), ProcessError> {
        self.state.connect()?;
        if let Some(map) = &self.map {
            map.connect()?;
        }
        Ok(self.attacks.update_connections()?)
    }

    fn prepare(&mut self) -> Result<(), ProcessError> {
        if let Some(map) = &mut self.map
            && map.update()?
        {
            let grids = map_grids(&map.header, map.cells());
            let blurred = blurred_map(grids.blurred, grids.occupied)?;
            self.sight = Some(VisibilityField::new(&blurred));
        }
        Ok(())
    }

    fn step(&mut self, tick: u64) -> Result<(), ProcessError> {
        self.state.take_turn(tick, self.config.run.clock)?;
        self.prepare()?;
        let newest = self.state.header.stamp.tick;
        // In real time there may be no new state.
        if self.last_tick.is_some_and(|last| newest <= last) || self.state.robots.is_empty() {
            return Ok(());
        }
        self.last_tick = Some(newest);
        let time_s = newest as f64 * self.config.run.tick_period();
        let states = self.guards.iter().filter_map(|guard| {
            let state = self.state.robots.get(guard.robot as usize);
            state.filter(|state| state.status == 0)
        });
        let poses: Vec<Pose2> = states.map(|s| Pose2::new(s.x, s.y, s.theta)).collect();
        let positions: Vec<Point2<f64>> = poses.iter().map(Pose2::position).collect();
        let sight = self.sight.as_ref();
        let is_visible = |a, b| sight.is_some_and(|field| field.is_visible(a, b));
        let (rule, schedule) = (self.params.rule(), self.params.schedule());
        let is_guarded = guarded(&self.places, &positions, rule, is_visible);
        self.visits.observe(time_s, &is_guarded);
        for adversary in &mut self.adversaries {
            let (places, best_response) = (&self.places, self.best_response.as_ref());
            let place = adversary.step(time_s, &self.visits, |rng, window_s| {
                let schedule = Schedule {
                    window_s,
                    ..schedule
                };
                best_response?.plan(&poses, places, (&schedule, rule), is_visible, rng)
            });
            let Some(place) = place.and_then(|place| self.places.get(place)) else {
                continue;
            };
            let header = AttackHeader {
                stamp: reply_stamp(&self.state.header, self.state.received_ns),
                x: place.x,
                y: place.y,
                duration_s: schedule.duration_s,
                distance: rule.distance,
                sight: rule.sight,
                method: adversary.method() as u32,
                reserved: 0,
            };
            self.attacks.send(header, &self.guards)?;
        }
        Ok(())
    }

    fn rejected(&self) -> u64 {
        self.state.rejected + self.map.as_ref().map_or(0, |map| map.rejected)
    }
}
