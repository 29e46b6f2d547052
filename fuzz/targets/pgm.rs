//! Any bytes as a PGM image, which becomes a map if it is one.
#![no_main]

use std::path::Path;

use geometry::map::{Pgm, RosMap, UnknownCells};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let Ok(image) = Pgm::read(bytes) else {
        return;
    };
    assert_eq!(image.pixels.len(), image.width * image.height);
    assert!(image.pixels.iter().all(|gray| *gray <= image.maxval));
    let yaml = "image: a.pgm\nresolution: 0.05\norigin: [0, 0, 0]\noccupied_thresh: 0.65\nfree_thresh: 0.196";
    let map = RosMap::parse(Path::new("a.yaml"), yaml).expect("a map's description");
    let cells = map.classify(&image, UnknownCells::Occupied);
    if let Ok(grid) = cells.to_grid() {
        assert_eq!(grid.cells.len(), image.pixels.len());
    }
});
