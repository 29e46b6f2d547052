//! Any text as a vector map; what is sound becomes the ground of a world.
#![no_main]

use geometry::map::{MapSpec, VectorMap, WorldMap};
use libfuzzer_sys::fuzz_target;

/// Larger grids only make it slow.
const MAX_CELLS: usize = 4_000;

fuzz_target!(|text: &str| {
    let Ok(mut map) = toml::from_str::<VectorMap>(text) else {
        return;
    };
    map.max_cells = map.max_cells.min(MAX_CELLS);
    if map.validate().is_ok() {
        let frame = map.frame().expect("the frame of a sound map");
        assert!(frame.len() <= MAX_CELLS);
        // Some shapes are only refused once they are laid on the ground.
        let _ = WorldMap::new(&MapSpec::Vector(map));
    }
});
