//! Which messages are drawn, and by what.

use ipc_types::cdr::view;
use ipc_types::consumer::LoggedMessage;
use ipc_types::topics::{
    Belief, Dominance, ObstacleEvents, Plan, ProcessEvents, ProcessLog, Scan, Sightings, Topic,
    TopicId, Tree, WorldEvents, WorldMap, WorldState,
};

use super::super::error::LogError;
use super::super::log_writer::LogWriter;
use super::Viewer;

impl Viewer {
    /// Draws what a message says, or keeps it for the picture of its tick.
    pub(in crate::recorder) fn message(
        &mut self,
        message: &LoggedMessage<'_>,
        log: &mut LogWriter,
    ) -> Result<(), LogError> {
        let (bytes, time_ns) = (message.bytes, message.time_ns);
        match message.topic {
            TopicId::WorldState => {
                if let Some((header, robots)) = view::<WorldState>(bytes) {
                    self.state(&header, time_ns, robots);
                }
            }
            TopicId::WorldEvents => {
                if let Some((_, mut events)) = view::<WorldEvents>(bytes) {
                    return events.try_for_each(|event| self.event(&event, time_ns, log));
                }
            }
            TopicId::ProcessEvents => {
                if let Some((_, mut events)) = view::<ProcessEvents>(bytes) {
                    return events.try_for_each(|event| self.process_event(&event, time_ns, log));
                }
            }
            TopicId::ProcessLog => {
                if let Some((header, text)) = view::<ProcessLog>(bytes) {
                    let text: Vec<u8> = text.collect();
                    return self.process_log(&header, &text, time_ns, log);
                }
            }
            TopicId::WorldMap => {
                if let Some((header, cells)) = view::<WorldMap>(bytes) {
                    return self.map(&header, time_ns, cells, log);
                }
            }
            TopicId::Dominance => {
                if let Some((header, cells)) = view::<Dominance>(bytes) {
                    return self.dominance(&header, time_ns, cells, log);
                }
            }
            TopicId::ObstacleEvents => {
                if let Some((_, mut events)) = view::<ObstacleEvents>(bytes) {
                    return events.try_for_each(|event| self.obstacle(&event, time_ns, log));
                }
            }
            TopicId::Plan => {
                if let Some((header, points)) = view::<Plan>(bytes) {
                    self.plan(header.robot, points);
                }
            }
            TopicId::Tree => {
                if let Some((header, edges)) = view::<Tree>(bytes) {
                    self.tree(header.robot, edges);
                }
            }
            TopicId::Sightings => {
                if let Some((_, sightings)) = view::<Sightings>(bytes) {
                    self.sightings(sightings);
                }
            }
            TopicId::Belief => {
                if let Some((header, particles)) = view::<Belief>(bytes) {
                    let length = particles.len() * size_of::<<Belief as Topic>::Element>();
                    let start = bytes.len().saturating_sub(length);
                    let particles = bytes.get(start..).unwrap_or_default();
                    return self.belief(header.robot, time_ns, particles, log);
                }
            }
            TopicId::Scan => {
                if let Some((header, ranges)) = view::<Scan>(bytes) {
                    return self.scan(&header, time_ns, ranges, log);
                }
            }
            _ => {}
        }
        Ok(())
    }
}
