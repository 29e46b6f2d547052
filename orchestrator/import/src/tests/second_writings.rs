//! Second writings of the same world, which have the same free cells.

use std::fmt::Write as _;

use proptest::prelude::*;

use super::super::{Sizes, world};
use super::Folder;

/// The points of a street (dm).
type Street = Vec<[i32; 2]>;

/// A way of writing: each bit is a choice.
#[derive(Clone, Copy)]
struct Style(u32);

impl Style {
    fn has(self, choice: u32) -> bool {
        self.0 >> choice & 1 == 1
    }

    /// Chooses one of several, by bits from this one on.
    fn one<T: Copy>(self, choice: u32, of: &[T]) -> T {
        of[(self.0 >> choice) as usize % of.len()]
    }

    /// Splits points in two, which share a point, or not at all.
    fn split(self, choice: u32, points: &[[i32; 2]]) -> Vec<Street> {
        if self.has(choice) && points.len() > 2 {
            let middle = points.len() / 2;
            vec![points[middle..].to_vec(), points[..=middle].to_vec()]
        } else {
            vec![points.to_vec()]
        }
    }

    fn reversed(self, choice: u32, points: &[[i32; 2]]) -> Street {
        let mut points = points.to_vec();
        if self.has(choice) {
            points.reverse();
        }
        points
    }

    /// Line ends and byte order mark.
    fn text(self, text: &str) -> String {
        let text = if self.has(20) {
            text.replace('\n', "\r\n")
        } else {
            text.to_owned()
        };
        if self.has(21) {
            format!("\u{feff}{text}")
        } else {
            text
        }
    }
}

fn metres(v: i32) -> f64 {
    f64::from(v) / 10.0
}

/// Well-known text, with directions, dimensions, parts, spaces and case as chosen.
fn geometry(style: Style, points: &[[i32; 2]]) -> String {
    let (dimension, more) = style.one(
        0,
        &[
            ("", ""),
            (" Z", " 5"),
            ("Z", " 5.5"),
            (" ZM", " -1 2"),
            (" M", " 1e3"),
            ("", " 7"),
        ],
    );
    let [open, comma, close] = style.one(4, &[["(", ",", ")"], [" ( ", " ,", " )\n"]]);
    let line = |points: &Street| {
        let points: Vec<String> = points
            .iter()
            .map(|p| format!("{} {}{more}", metres(p[0]), metres(p[1])))
            .collect();
        format!("{open}{}{close}", points.join(comma))
    };
    let points = style.reversed(5, points);
    let text = if style.has(6) {
        let mut parts: Vec<String> = style
            .split(7, &points)
            .iter()
            .map(|part| line(&style.reversed(8, part)))
            .collect();
        if style.has(9) {
            parts.push("EMPTY".to_owned());
        }
        format!(
            "MULTILINESTRING{dimension}{open}{}{close}",
            parts.join(comma)
        )
    } else {
        format!("LINESTRING{dimension}{}", line(&points))
    };
    if style.has(10) {
        text.to_ascii_lowercase()
    } else {
        text
    }
}

/// A graph whose edges are streets, or their halves.
fn graphml(style: Style, streets: &[Street]) -> String {
    let mut text =
        r#"<graphml><key id="d0" for="node" attr.name="x"/><key id="d1" for="node" attr.name="y"/>
<key id="d2" for="edge" attr.name="geometry"/><graph>
"#
        .to_owned();
    let edges: Vec<Street> = streets
        .iter()
        .flat_map(|street| style.split(11, street))
        .collect();
    for (i, edge) in edges.iter().enumerate() {
        let ends = [edge[0], edge[edge.len() - 1]];
        for ([x, y], end) in ends.into_iter().zip("ab".chars()) {
            let [x, y] = [x, y].map(metres);
            writeln!(
                text,
                r#"<node id="{end}{i}"><data key="d0">{x}</data><data key="d1">{y}</data></node>"#
            )
            .unwrap();
        }
        let (from, to) = if style.has(12) {
            ('b', 'a')
        } else {
            ('a', 'b')
        };
        let geometry = if edge.len() > 2 || style.has(13) {
            format!(r#"<data key="d2">{}</data>"#, geometry(style, edge))
        } else {
            String::new()
        };
        writeln!(
            text,
            r#"<edge source="{from}{i}" target="{to}{i}">{geometry}</edge>"#
        )
        .unwrap();
    }
    style.text(&(text + "</graph></graphml>\n"))
}

const STREET: &str = r#"<tag k="highway" v="residential"/>"#;

/// An extract whose ways are streets, or their halves, beside ways that do not exist.
fn osm(style: Style, streets: &[Street]) -> String {
    let (mut nodes, mut ways) = (String::new(), String::new());
    let place = |[x, y]: [i32; 2]| format!(r#"lat="48.{y:06}" lon="11.{x:06}""#);
    let has_own_places = style.has(0);
    let mut way = |points: &[[i32; 2]], more: &str, tags: &str| {
        write!(
            ways,
            "<way{more}><bounds minlat=\"48\"/><center lat=\"50\" lon=\"12\"/>"
        )
        .unwrap();
        for &point in points {
            let [x, y] = point;
            let id = format!("{x}-{y}");
            let at = place(point);
            if has_own_places {
                write!(ways, r#"<nd ref="{id}" {at}/>"#).unwrap();
            } else {
                write!(ways, r#"<nd ref="{id}"/>"#).unwrap();
                writeln!(nodes, r#"<node id="{id}" {at}/>"#).unwrap();
            }
        }
        writeln!(ways, "{tags}</way>").unwrap();
    };
    for street in streets {
        for part in style.split(1, street) {
            way(
                &style.reversed(2, &part),
                style.one(3, &["", " action='modify'", " visible='true'"]),
                STREET,
            );
        }
    }
    let corners = [[0, 0], [9000, 9000]];
    if style.has(5) {
        let more = style.one(6, &[" action='delete'", " visible=\"false\""]);
        way(&corners, more, STREET);
    }
    if style.has(7) {
        let word = style.one(
            8,
            &["abandoned", "construction", "disused", "proposed", "razed"],
        );
        let tags = style.one(
            12,
            &[
                "<tag k='highway' v='WORD'/>",
                "<tag k='WORD:highway' v='primary'/>",
                "<tag k='WORD' v='yes'/><tag k='highway' v='primary'/>",
            ],
        );
        way(&corners, "", &tags.replace("WORD", word));
    }
    if style.has(15) {
        nodes.push_str("<node id='gone' visible='false'/>\n<node id='gone2' action='delete' lat='10' lon='10'/>\n");
        ways.push_str("<relation id='1' visible='false'/>\n");
    }
    let [first, second] = if style.has(16) {
        [ways, nodes]
    } else {
        [nodes, ways]
    };
    style.text(&format!(
        "<osm version=\"0.6\">\n<bounds minlat=\"0\"/>\n{first}{second}</osm>\n"
    ))
}

/// A map of cells, `true` is free.
fn octile(style: Style, rows: &[Vec<bool>]) -> String {
    let mut text = format!(
        "type octile\nheight {}\nwidth {}\nmap\n",
        rows.len(),
        rows[0].len()
    );
    let (free, wall) = (
        style.one(0, &['.', 'G', 'S']),
        style.one(2, &['@', 'O', 'T', 'W']),
    );
    for row in rows {
        text.extend(row.iter().map(|cell| if *cell { free } else { wall }));
        text.push('\n');
    }
    style.text(&(text + style.one(4, &["", "\n"])))
}

/// A map of ROS: the file and its image.
fn ros(style: Style, rows: &[Vec<bool>]) -> [Vec<u8>; 2] {
    let negate = style.has(0);
    let (width, height) = (rows[0].len(), rows.len());
    let pixels = rows
        .iter()
        .flatten()
        .map(|cell| if *cell == negate { 0_u8 } else { 254 });
    let image = if style.has(1) {
        let pixels: Vec<String> = pixels.map(|pixel| pixel.to_string()).collect();
        format!("P2 # plain\n{width} {height}\n255\n{}\n", pixels.join(" ")).into_bytes()
    } else {
        let head = format!("P5\n{width} {height}\n255\n").into_bytes();
        head.into_iter().chain(pixels).collect()
    };
    let yaml = format!(
        "image: a.pgm\nresolution: 0.5\norigin: [0.0, 0.0, 0.0]\nnegate: {}\n\
         occupied_thresh: 0.65\nfree_thresh: 0.196\n",
        u8::from(negate)
    );
    [yaml.into_bytes(), image]
}

/// The free cells of a file's world, row by row, and their side (m).
fn free_cells(name: &str, files: &[(&str, &[u8])]) -> (Vec<bool>, f64) {
    let folder = Folder::new(&[]);
    for (name, bytes) in files {
        std::fs::write(folder.path(name), bytes).unwrap();
    }
    let (world, _) = world(&folder.path(name), Sizes::default(), false).unwrap();
    (world.occupied.cells, world.resolution)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    #[test]
    fn a_second_writing_of_the_same_world_has_the_same_free_cells(
        bends in prop::collection::vec(prop::collection::vec([0..1000_i32, 0..1000_i32], 2..6), 1..5),
        rows in (1..8_usize, 1..8_usize).prop_flat_map(|(width, height)| {
            prop::collection::vec(prop::collection::vec(any::<bool>(), width), height)
        }),
        style in any::<u32>(),
    ) {
        let (plain, other) = (Style(0), Style(style));
        // Long enough, and connected.
        let mut streets: Vec<Street> = vec![vec![[0, 0], [0, 700], [1000, 700]]];
        streets.extend(bends.into_iter().map(|mut street| {
            street.insert(0, [0, 0]);
            street
        }));
        for (name, write) in [
            ("a.graphml", graphml as fn(Style, &[Street]) -> String),
            ("a.osm", osm),
        ] {
            let [first, second] = [plain, other].map(|style| {
                let text = write(style, &streets);
                (free_cells(name, &[(name, text.as_bytes())]), text)
            });
            prop_assert_eq!(first.0, second.0, "{}", second.1);
        }
        let mut rows = rows;
        rows[0][0] = true;
        let octile = [plain, other].map(|style| free_cells("a.map", &[("a.map", octile(style, &rows).as_bytes())]));
        prop_assert_eq!(&octile[0], &octile[1]);
        let ros = [plain, other].map(|style| {
            let [yaml, image] = ros(style, &rows);
            free_cells("a.yaml", &[("a.yaml", &yaml), ("a.pgm", &image)])
        });
        prop_assert_eq!(&ros[0], &ros[1]);
        prop_assert_eq!(&octile[0].0, &ros[0].0);
    }
}
