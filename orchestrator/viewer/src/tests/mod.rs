//! Tests of the viewer topics of a synthetic run, in its log.

mod pictures;
mod python;

// Contains more than these tests use.
#[allow(dead_code)]
#[path = "../../../recorder/src/tests/made_up.rs"]
mod made_up;

use std::path::Path;

use ipc_types::messages::world::ObstacleEvent;
use mcap_log::LogOptions;
use recorder::{FieldOfView, Recording, RunInfo, Summary, ViewOrigin};

use self::made_up::{Sent, run_info};
use crate::{ViewerOptions, viewer_topics};

/// Returns the options of the viewer topics.
fn options() -> ViewerOptions {
    ViewerOptions {
        obstacles: vec![ObstacleEvent {
            id: 77,
            half_x: 1.0,
            shape: 1,
            ..ObstacleEvent::default()
        }],
        ..ViewerOptions::default()
    }
}

/// Creates a recording of the run with these viewer topics.
fn recording(path: &Path, options: &ViewerOptions) -> Recording {
    let run = RunInfo {
        fields_of_view: vec![FieldOfView {
            name: "seen by police_1".to_owned(),
            origin: ViewOrigin::Robot(0),
            range: None,
            angle: None,
        }],
        ..run_info()
    };
    let topics = viewer_topics(&run, options);
    made_up::recording(path, &LogOptions::default(), topics)
}

/// Records messages, which are ordered by tick, in batches of this size.
fn record(path: &Path, options: &ViewerOptions, sent: &[Sent], batch: usize) -> Summary {
    let mut recording = recording(path, options);
    for batch in sent.chunks(batch) {
        for message in batch {
            message.push(&mut recording);
        }
        let newest = batch.last().unwrap().stamp().tick;
        if let Some(completed) = newest.checked_sub(1) {
            recording.advance(completed, &mut ()).unwrap();
        }
    }
    recording.finish(&mut ()).unwrap()
}
