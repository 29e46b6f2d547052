//! Which messages are drawn, and by what.

use ipc_types::topics::{
    Belief, Dominance, ObstacleEvents, Plan, ProcessEvents, ProcessLog, Scan, Sightings, Topic,
    Tree, WorldEvents, WorldMap, WorldState,
};

use super::super::error::LogError;
use super::super::log_writer::LogWriter;
use super::super::message::Message;
use super::super::topic_info::{Role, view};
use super::Viewer;

impl Viewer {
    /// Draws what a message says, or keeps it for the picture of its tick.
    pub(in crate::recorder) fn message(
        &mut self,
        message: &Message<'_>,
        log: &mut LogWriter,
    ) -> Result<(), LogError> {
        let (bytes, time_ns) = (message.bytes, message.time_ns);
        match message.role {
            Role::State => {
                if let Some((header, robots)) = view::<WorldState>(bytes) {
                    self.state(&header, time_ns, robots);
                }
            }
            Role::Event => {
                if let Some((_, mut events)) = view::<WorldEvents>(bytes) {
                    return events.try_for_each(|event| self.event(&event, time_ns, log));
                }
            }
            Role::ProcessEvent => {
                if let Some((_, mut events)) = view::<ProcessEvents>(bytes) {
                    return events.try_for_each(|event| self.process_event(&event, time_ns, log));
                }
            }
            Role::ProcessLog => {
                if let Some((header, text)) = view::<ProcessLog>(bytes) {
                    let text: Vec<u8> = text.collect();
                    return self.process_log(&header, &text, time_ns, log);
                }
            }
            Role::Map => {
                if let Some((header, cells)) = view::<WorldMap>(bytes) {
                    return self.map(&header, time_ns, cells, log);
                }
            }
            Role::Dominance => {
                if let Some((header, cells)) = view::<Dominance>(bytes) {
                    return self.dominance(&header, time_ns, cells, log);
                }
            }
            Role::Obstacle => {
                if let Some((_, mut events)) = view::<ObstacleEvents>(bytes) {
                    return events.try_for_each(|event| self.obstacle(&event, time_ns, log));
                }
            }
            Role::Plan => {
                if let Some((header, points)) = view::<Plan>(bytes) {
                    self.plan(header.robot, points);
                }
            }
            Role::Tree => {
                if let Some((header, edges)) = view::<Tree>(bytes) {
                    self.tree(header.robot, edges);
                }
            }
            Role::Sighting => {
                if let Some((_, sightings)) = view::<Sightings>(bytes) {
                    self.sightings(sightings);
                }
            }
            Role::Belief => {
                if let Some((header, particles)) = view::<Belief>(bytes) {
                    let length = particles.len() * size_of::<<Belief as Topic>::Element>();
                    let start = bytes.len().saturating_sub(length);
                    let particles = bytes.get(start..).unwrap_or_default();
                    return self.belief(header.robot, time_ns, particles, log);
                }
            }
            Role::Scan => {
                if let Some((header, ranges)) = view::<Scan>(bytes) {
                    return self.scan(&header, time_ns, ranges, log);
                }
            }
            _ => {}
        }
        Ok(())
    }
}
