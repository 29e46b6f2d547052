//! Any text as the YAML file of a ROS map.
#![no_main]

use std::path::Path;

use geometry::map::RosMap;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| {
    if let Ok(map) = RosMap::parse(Path::new("maps/a.yaml"), text) {
        assert!(map.resolution > 0.0 && map.resolution.is_finite());
        assert!(map.origin.iter().all(|x| x.is_finite()));
        assert!(map.free_thresh <= map.occupied_thresh);
    }
});
