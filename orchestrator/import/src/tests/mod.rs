//! Imports of small files, and of broken ones.

use std::fs;
use std::path::PathBuf;

use geometry::map::{VectorMap, WorldMap};
use nalgebra::Point2;
use proptest::prelude::*;

use scenario::Loader;

use super::{Imported, Sizes, import};

mod confinement;
mod second_writings;
mod small_maps;
mod xml_limits;

const MAP: &str = "type octile\nheight 4\nwidth 6\nmap\n@@@@@@\n@..G.@\n@.TWS@\n@@@@.@\n";
const SCEN: &str = "version 1\n0\tmaps/room.map\t6\t4\t1\t1\t4\t3\t5.0\n\
                    0\tmaps/room.map\t6\t4\t1\t1\t4\t1\t3.0\n0\tmaps/room.map\t6\t4\t1\t2\t4\t1\t4.0\n";
const OSM: &str = r#"<?xml version="1.0"?>
<osm version="0.6">
 <node id="1" lat="48.0000" lon="16.0000"/>
 <node id="2" lat="48.0000" lon="16.0010"/>
 <node id="3" lat="48.0005" lon="16.0010"/>
 <node id="4" lat="49.0000" lon="17.0000"/>
 <way id="7"><nd ref="1"/><nd ref="2"/><nd ref="3"/><nd ref="99"/><tag k="highway" v="residential"/></way>
 <way id="8"><nd ref="1"/><nd ref="4"/><tag k="power" v="line"/></way>
</osm>"#;
const GRAPHML: &str = r#"<?xml version="1.0"?>
<graphml xmlns="http://graphml.graphdrawing.org/xmlns">
 <key id="d0" for="node" attr.name="x" attr.type="string"/>
 <key id="d1" for="node" attr.name="y" attr.type="string"/>
 <key id="d2" for="edge" attr.name="geometry" attr.type="string"/>
 <graph edgedefault="directed">
  <node id="a"><data key="d0">0</data><data key="d1">0</data></node>
  <node id="b"><data key="d0">60</data><data key="d1">40</data></node>
  <edge source="a" target="b"><data key="d2">LINESTRING (0 0, 60 0, 60 40)</data></edge>
 </graph>
</graphml>"#;

struct Folder(tempfile::TempDir);

impl Folder {
    fn new(files: &[(&str, &str)]) -> Self {
        let folder = tempfile::tempdir().unwrap();
        for (name, text) in files {
            fs::write(folder.path().join(name), text).unwrap();
        }
        Self(folder)
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn import(&self, name: &str, sizes: Sizes) -> Result<Imported, String> {
        let loader = Loader::new(kinds::KINDS);
        import(&self.path(name), sizes, false, &loader).map_err(|e| e.to_string())
    }
}

fn imported(name: &str, text: &str, sizes: Sizes) -> Result<Imported, String> {
    Folder::new(&[(name, text)]).import(name, sizes)
}

fn world(imported: &Imported) -> WorldMap {
    let map: VectorMap = toml::from_str(&imported.map).unwrap();
    map.validate().unwrap();
    WorldMap::from_vectors(&map).unwrap()
}

#[test]
fn a_map_of_cells_is_the_same_world_with_its_first_row_on_top() {
    let sizes = Sizes {
        cell: 0.5,
        ..Sizes::default()
    };
    let found = imported("room.map", MAP, sizes).unwrap();
    assert_eq!(found.map_path, "maps/room.toml");
    assert!(found.scenario.contains("map = \"maps/room.toml\""));
    let world = world(&found);
    let is_free = |column: f64, row: f64| {
        let at = Point2::new(0.5 * (column + 0.5), 0.5 * (3.5 - row));
        world.is_clear(at, 0.2)
    };
    let rows: Vec<&str> = MAP.lines().skip(4).collect();
    for (row, cells) in rows.iter().enumerate() {
        for (column, cell) in cells.chars().enumerate() {
            let free = is_free(column as f64, row as f64);
            assert_eq!(free, ".GS".contains(cell), "{column}, {row}");
        }
    }
    assert!((world.frame().resolution - 0.125).abs() < 1e-12);
}

#[test]
fn free_cells_that_are_cut_off_become_obstacles() {
    let text = "type octile\nheight 1\nwidth 12\nmap\n..@.........\n";
    let world = world(&imported("a.map", text, Sizes::default()).unwrap());
    assert!(!world.is_clear(Point2::new(1.0, 0.5), 0.1));
    assert!(world.is_clear(Point2::new(4.5, 0.5), 0.4));
}

#[test]
fn problems_become_robots_with_starts_and_goals_on_the_map_beside_them() {
    let folder = Folder::new(&[("room.map", MAP), ("room.map.scen", SCEN)]);
    let found = folder.import("room.map.scen", Sizes::default()).unwrap();
    // The second problem begins where the first does.
    for part in [
        "start = { x = 1.5, y = 2.5, theta = 0.0 }",
        "center = [4.5, 0.5]",
        "start = { x = 1.5, y = 1.5, theta = 0.0 }",
        "center = [4.5, 2.5]",
    ] {
        assert!(found.scenario.contains(part), "{part}\n{}", found.scenario);
    }
    assert!(!found.scenario.contains("robot_3"));
    let error = imported("room.map.scen", SCEN, Sizes::default()).unwrap_err();
    assert!(
        error.contains("room.map.scen refers to maps/room.map: cannot read"),
        "{error}"
    );
}

#[test]
fn streets_are_free_corridors() {
    // 0.0010° of longitude at 48° are 74 m, 0.0005° of latitude 56 m.
    let sizes = Sizes {
        street: 6.0,
        ..Sizes::default()
    };
    let osm = world(&imported("a.osm", OSM, sizes).unwrap());
    let graph = world(&imported("a.graphml", GRAPHML, sizes).unwrap());
    for (world, corners) in [
        (&osm, [[-37.2, -27.8], [37.2, -27.8], [37.2, 27.8]]),
        (&graph, [[-30.0, -20.0], [30.0, -20.0], [30.0, 20.0]]),
    ] {
        for pair in corners.windows(2) {
            for share in [0.0, 0.3, 0.7, 1.0] {
                let [x, y] = [0, 1].map(|i| pair[0][i] + share * (pair[1][i] - pair[0][i]));
                let distance = world.distance(Point2::new(x, y));
                assert!((1.9..4.5).contains(&distance), "{x}, {y}: {distance}");
            }
        }
        let [first, _, last] = corners;
        let off = Point2::new(first[0], last[1]);
        assert!(world.distance(off) <= 0.0, "no street at {off}");
    }
}

#[test]
fn degrees_are_told_by_the_coordinate_system_of_a_graph() {
    let graph = |crs: &str| {
        let text = format!(
            r#"<graphml><graph><data key="crs">{crs}</data>
            <node id="a"><data key="x">16.0</data><data key="y">48.0</data></node>
            <node id="b"><data key="x">16.001</data><data key="y">48.0005</data></node>
            <edge source="a" target="b"/></graph></graphml>"#
        );
        imported("a.graphml", &text, Sizes::default())
    };
    // 0.0010° of longitude at 48° are 74 m.
    for crs in ["epsg:4326", "EPSG:4326", "{'init': 'epsg:4326'}", "WGS84"] {
        let streets = world(&graph(crs).unwrap());
        let frame = streets.frame();
        let width = frame.width as f64 * frame.resolution;
        assert!((width - 82.4).abs() < 2.0, "{crs}: {width} m");
    }
    // Without it they are metres, and the streets one point.
    let error = graph("").unwrap_err();
    assert!(error.contains("or the `crs` of degrees"), "{error}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(128))]

    #[test]
    fn a_file_with_a_part_replaced_never_panics(
        of in 0..4_usize,
        at in 0.0..1.0_f64,
        length in 0..12_usize,
        with in prop_oneof![
            ".{0,8}",
            prop::sample::select(vec!["NaN", "inf", "-1", "1e308", "99999999999999999999", "\n", "\t", "<", "/>"])
                .prop_map(str::to_owned),
        ],
    ) {
        let text: Vec<char> = [MAP, SCEN, GRAPHML, OSM][of].chars().collect();
        let at = (at * text.len() as f64) as usize;
        let end = text.len().min(at + length);
        let changed: String = text[..at].iter().chain(with.chars().collect::<Vec<_>>().iter()).chain(&text[end..]).collect();
        let name = format!("room.{}", ["map", "scen", "graphml", "osm"][of]);
        let folder = Folder::new(&[("room.map", MAP), (&name, &changed)]);
        if let Ok(found) = folder.import(&name, Sizes::default()) {
            world(&found);
        }
    }
}

#[test]
fn broken_files_are_explained() {
    for (name, text, expected) in [
        (
            "a.map",
            "type octile\nheight x\n",
            "a.map, line 2: \"x\": expected height",
        ),
        (
            "a.map",
            "octile\n",
            "line 1: \"octile\": expected type octile",
        ),
        (
            "a.map",
            "type octile\nheight 1\nwidth 2\nmap\n.x\n",
            "line 5: \".x\": expected 2 of the characters",
        ),
        (
            "a.map",
            "type octile\nheight 2\nwidth 1\nmap\n.\n",
            "1 rows of cells: expected 2 rows",
        ),
        (
            "a.map",
            "type octile\nheight 99999\nwidth 99999\nmap\n",
            "99999 × 99999 cells: expected at most 25000000",
        ),
        (
            "a.map",
            "type octile\nheight 1\nwidth 1\nmap\n@\n",
            "no free cell",
        ),
        ("a.scen", "version 2\n", "expected version 1"),
        ("a.scen", "version 1\n", "no problem"),
        ("a.scen", "version 1\n0 m 1 1 0 0 0\n", "line 2"),
        (
            "a.scen",
            "version 1\n0 m 1 1 0 0 0 1 1\n",
            "positions on the map",
        ),
        ("a.osm", "<osm>", "a.osm: "),
        ("a.osm", "<gpx/>", "an element <gpx>: expected <osm>"),
        ("a.osm", "<osm/>", "no street"),
        (
            "a.osm",
            "<osm>\n<node id='1' lat='x' lon='2'/></osm>",
            "line 2",
        ),
        ("a.graphml", "<a/>", "no <graph>"),
        ("a.graphml", "<graph>\n<node id='a'/></graph>", "line 2"),
        (
            "a.graphml",
            &GRAPHML.replace(">60<", ">1e7<"),
            "streets on 10000.0 km × 0.0 km: expected a smaller part",
        ),
        (
            "a.txt",
            "",
            "unknown kind of file: expected .yaml, .yml, .map",
        ),
        (
            "a.PNG",
            "",
            "an image without its scale: expected the .yaml",
        ),
        ("a.yaml", "image: none.pgm\n", "resolution"),
    ] {
        let error = imported(name, text, Sizes::default()).unwrap_err();
        assert!(error.contains(expected), "{expected:?} is not in {error:?}");
    }
    let error = Folder::new(&[])
        .import("none.map", Sizes::default())
        .unwrap_err();
    assert!(
        error.contains("cannot read") && error.contains("none.map"),
        "{error}"
    );
}

#[test]
fn a_line_of_an_edge_that_cannot_be_read_is_an_error() {
    for line in [
        "",
        "LINESTRING",
        "LINESTRING EMPTY",
        "LINESTRING (0 0)",
        "LINESTRING (0 0, 60)",
        "LINESTRING (0 0, 60 x)",
        "LINESTRING (0 0, 60 inf)",
        "LINESTRING (0 0, 60 40",
        "LINESTRING (0 0, 60 40))",
        "LINESTRING (0 0,, 60 40)",
        "LINESTRING (0 0, 60 40) EMPTY",
        "LINESTRING X (0 0, 60 40)",
        "LINESTRING (0 0 0 0 0, 60 40 0 0 0)",
        "MULTILINESTRING EMPTY",
        "MULTILINESTRING (EMPTY)",
        "MULTILINESTRING (0 0, 60 40)",
        "MULTILINESTRING ((0 0, 60 40)",
        "MULTILINESTRING ((0 0, 60 40) (60 40, 0 0))",
        "POINT (0 0)",
        "{'type': 'LineString'}",
    ] {
        let text = GRAPHML.replace("LINESTRING (0 0, 60 0, 60 40)", line);
        let error = imported("a.graphml", &text, Sizes::default()).unwrap_err();
        let found = format!("line 9: {line:?}: expected LINESTRING");
        assert!(
            line.is_empty() || error.contains(&found),
            "{found:?} is not in {error:?}"
        );
    }
}

#[test]
fn a_way_needs_the_places_of_its_nodes_that_exist() {
    let node = r#"<node id="2" lat="48.0000" lon="16.0010"/>"#;
    let deleted = OSM.replace(node, r#"<node id="2" visible="false"/>"#);
    let error = imported("a.osm", &deleted, Sizes::default()).unwrap_err();
    assert!(
        error.contains("line 7: \"deleted node 2\": expected a node of the way"),
        "{error}"
    );
    let without = OSM.replace("<node", "<center");
    let error = imported("a.osm", &without, Sizes::default()).unwrap_err();
    assert!(error.contains("`out geom`"), "{error}");
}

#[test]
fn a_name_keeps_all_but_its_extension() {
    let map = "type octile\nheight 9\nwidth 9\nmap\n".to_owned() + &".........\n".repeat(9);
    for (name, stem) in [
        ("planet_10.068,48.135.map", "planet_10.068_48.135"),
        ("münchen \"ost\".map", "münchen__ost_"),
    ] {
        let found = imported(name, &map, Sizes::default()).unwrap();
        assert_eq!(found.map_path, format!("maps/{stem}.toml"));
        world(&found);
    }
}
