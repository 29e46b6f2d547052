//! Any bytes as a PGM or PNG image, which becomes a map if it is one.
#![no_main]

use std::path::Path;

use geometry::map::{CellMap, Image, RosMap, UnknownCells};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let Ok(image) = Image::read(bytes) else {
        return;
    };
    assert_eq!(image.pixels().len(), image.width * image.height);
    assert!(image.samples.iter().all(|sample| *sample <= image.maxval));
    let yaml = "image: a.pgm\nresolution: 0.05\norigin: [0, 0, 0]\noccupied_thresh: 0.65\nfree_thresh: 0.196";
    let map = RosMap::parse(Path::new("a.yaml"), yaml).expect("a map's description");
    let cells = CellMap::from_occupancy(&map.classify(&image), UnknownCells::Occupied);
    if let Ok(grid) = cells.to_grid() {
        assert_eq!(grid.cells.len(), image.pixels().len());
    }
});
