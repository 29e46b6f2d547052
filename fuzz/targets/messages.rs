//! Any bytes as a message of every topic, and what its receivers make of it.
#![no_main]

use std::convert::Infallible;

use geometry::map::{MapSpec, VectorMap, WorldMap};
use ipc_types::cdr;
use ipc_types::messages::robot::Command;
use ipc_types::messages::world::{ObstacleEvent, ShapePoint, ShapesHeader};
use ipc_types::topics::{ObstacleEvents, Topic, TopicVisitor, WorldShapes, for_each_topic};
use libfuzzer_sys::fuzz_target;
use simulator::commands::CommandBoard;
use zerocopy::FromBytes;

struct Decode<'a>(&'a [u8]);

impl TopicVisitor for Decode<'_> {
    type Error = Infallible;
    fn visit<T: Topic>(&mut self) -> Result<(), Infallible> {
        if let Ok((header, elements)) = cdr::decode::<T>(self.0) {
            // Compared as bytes: NaN is not itself.
            let mut again = Vec::new();
            cdr::encode::<T>(&header, &elements, &mut again);
            assert_eq!(again.len(), self.0.len(), "{}", T::NAME);
        }
        Ok(())
    }
}

fn shapes(header: &ShapesHeader, points: &[ShapePoint]) {
    if let Ok((bounds, pieces)) = runtime::shapes::from_message(header, points) {
        assert!(bounds.max.x > bounds.min.x && bounds.max.y > bounds.min.y);
        assert_eq!(pieces.len(), header.shapes as usize);
    }
}

fn obstacle(event: &ObstacleEvent) {
    if let Ok(change) = runtime::obstacle::from_message(event) {
        let ground = VectorMap::empty([0.0, 0.0], [2.0, 2.0], 0.25);
        let mut map = WorldMap::new(&MapSpec::Vector(ground)).expect("an empty map");
        let _ = map.apply(&change);
    }
}

/// One after the other to a board with two robots that processes 3 and 4 drive.
fn commands(bytes: &[u8]) {
    const SIZE: usize = size_of::<ipc_types::stamp::Stamp>() + size_of::<Command>();
    let mut board = CommandBoard::new(vec![Some(3), Some(4), None]);
    for chunk in bytes.chunks_exact(SIZE) {
        let Ok((stamp, rest)) = ipc_types::stamp::Stamp::read_from_prefix(chunk) else {
            continue;
        };
        let Ok((command, _)) = Command::read_from_prefix(rest) else {
            continue;
        };
        let tick = stamp.tick.saturating_add(1);
        let _ = board.take(&stamp, &command, tick, 0);
        board.in_force(tick, 5);
        assert!(!board.is_missing(2));
    }
}

fuzz_target!(|bytes: &[u8]| {
    let Some((kind, bytes)) = bytes.split_first() else {
        return;
    };
    match kind % 4 {
        0 => {
            let Ok(()) = for_each_topic(&mut Decode(bytes));
        }
        1 => {
            if let Ok((header, points)) = cdr::decode::<WorldShapes>(bytes) {
                shapes(&header, &points);
            }
        }
        2 => {
            if let Ok((_, events)) = cdr::decode::<ObstacleEvents>(bytes)
                && let Some(event) = events.first()
            {
                obstacle(event);
            }
        }
        _ => commands(bytes),
    }
});
