//! Maps of planners whose processes share a thread.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::sync::Arc;

use geometry::map::{MapSpec, VectorMap, WorldMap as Map};
use ipc_types::bus::{Bus, BusOptions, PublisherOptions};
use ipc_types::messages::world::{MapCell, MapHeader};
use ipc_types::topics::{RunSize, WorldMap, WorldShapes};
use planner::planner_map;
use runtime::inputs::{MapInput, ShapesInput};
use runtime::maps::{MapState, Maps};
use runtime::shapes;

const CELLS: usize = 16;

fn bus() -> Bus {
    let options = BusOptions {
        size: RunSize {
            robots: 1,
            processes: 2,
            events: 0,
        },
        recorder_ticks: 2,
        overflow: false,
    };
    Bus::local(options)
}

fn header() -> MapHeader {
    MapHeader {
        width: 4,
        height: 4,
        resolution: 0.5,
        revision: 1,
        ..MapHeader::default()
    }
}

#[test]
fn processes_of_one_thread_make_a_map_once() {
    let maps = Arc::new(Maps::default());
    let bus = bus();
    let mut map_state = MapState {
        spec: Arc::new(MapSpec::Vector(VectorMap::empty([0.0; 2], [2.0, 2.0], 0.5))),
        changes: Vec::new(),
        blur_sigma: 0.5,
    };
    let free = MapCell {
        clearance: 1.0,
        blurred: 1.0,
        ..MapCell::default()
    };
    let draw = || Ok::<_, core::convert::Infallible>((header(), vec![free; CELLS]));
    let Ok((header, cells)) = maps.message(&mut map_state, draw);
    let sender = bus
        .publisher::<WorldMap>(PublisherOptions::new(0, CELLS))
        .unwrap();
    let mut inputs: Vec<MapInput> = (0..2).map(|_| MapInput::open(&bus).unwrap()).collect();
    sender.send_shared(header, &cells).unwrap();
    for input in &mut inputs {
        input.share(&maps);
        assert!(input.update().unwrap());
    }
    let made: Vec<_> = inputs
        .iter()
        .map(|input| planner_map(input, None, false).unwrap())
        .collect();
    assert!(Arc::ptr_eq(&made[0], &made[1]));

    let shapes_out = bus
        .publisher::<WorldShapes>(PublisherOptions::new(0, 64))
        .unwrap();
    let mut pieces = ShapesInput::open(&bus).unwrap();
    let map = Map::new(&map_state.spec).unwrap();
    let (header, points) = shapes::to_message(map.shapes(), 1, header.stamp, 64);
    shapes_out.send(header, &points).unwrap();
    assert!(pieces.update().unwrap());
    let exact = planner_map(&inputs[0], Some(&pieces), false).unwrap();
    assert!(!Arc::ptr_eq(&exact, &made[0]));
    assert!(exact.space().is_some() && made[0].space().is_none());
}
