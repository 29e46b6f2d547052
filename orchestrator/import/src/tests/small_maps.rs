//! Scenarios on small maps, which pass the check or are refused.

use std::fs;

use proptest::prelude::*;
use scenario::Loader;

use super::super::Sizes;
use super::Folder;

/// Imports a file, writes the scenario, and loads it with some seeds. Returns `false` if the import is refused.
fn is_accepted(folder: &Folder, name: &str) -> bool {
    let found = match folder.import(name, Sizes::default()) {
        Ok(found) => found,
        Err(error) => {
            let is_explained = error.contains("m² of free space") || error.contains("no free cell");
            assert!(is_explained, "{error}");
            return false;
        }
    };
    fs::create_dir_all(folder.path("maps")).unwrap();
    fs::write(folder.path(&found.map_path), found.map).unwrap();
    let file = folder.path("scenario.toml");
    fs::write(&file, found.scenario).unwrap();
    for seed in [None, Some(1), Some(2)] {
        let loaded = Loader::new(kinds::KINDS).load(file.to_str().unwrap(), &[], seed);
        assert!(loaded.is_ok(), "{}", loaded.unwrap_err());
    }
    true
}

/// The rows of a map (`true` is free) in two formats.
fn folder(rows: &[Vec<bool>], resolution: f64) -> Folder {
    let (width, height) = (rows[0].len(), rows.len());
    let lines = |free: &str, wall: &str| -> String {
        let mark = |cell: &bool| if *cell { free } else { wall }.to_owned();
        let line = |row: &Vec<bool>| row.iter().map(mark).collect::<String>() + "\n";
        rows.iter().map(line).collect()
    };
    let map = format!(
        "type octile\nheight {height}\nwidth {width}\nmap\n{}",
        lines(".", "@")
    );
    let image = format!("P2 {width} {height} 255\n{}", lines("254 ", "0 "));
    let yaml = format!(
        "image: a.pgm\nresolution: {resolution}\norigin: [-1, 2, 0]\nnegate: 0\n\
         occupied_thresh: 0.65\nfree_thresh: 0.2\n"
    );
    Folder::new(&[("a.map", &map), ("a.pgm", &image), ("a.yaml", &yaml)])
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn a_small_map_is_refused_or_becomes_a_scenario_that_passes_the_check(
        rows in (1..8_usize, 1..8_usize).prop_flat_map(|(width, height)| {
            prop::collection::vec(prop::collection::vec(prop::bool::weighted(0.7), width), height)
        }),
        resolution in prop::sample::select(vec![0.05, 0.5, 3.0]),
    ) {
        let folder = folder(&rows, resolution);
        is_accepted(&folder, "a.map");
        is_accepted(&folder, "a.yaml");
    }
}

#[test]
fn open_maps_are_accepted_from_a_small_side_on() {
    for side in [1, 2, 5, 8, 20] {
        let folder = folder(&vec![vec![true; side]; side], 0.1);
        for name in ["a.map", "a.yaml"] {
            assert_eq!(is_accepted(&folder, name), side >= 5, "{name}: {side}");
        }
    }
    // 3 by 4 cells, of which 7 are free.
    let rows = ["@.@", "..@", "@.@", "..."];
    let rows = rows.map(|row| row.chars().map(|c| c == '.').collect());
    is_accepted(&self::folder(&rows, 1.0), "a.map");
}
