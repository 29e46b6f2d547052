use super::*;

mod styles;

const YAML: &str = "image: ./office.pgm  # beside this file\nresolution: 0.5\n\
                    origin: [-1.0, 2.0, 0.0]\nnegate: 0\noccupied_thresh: 0.65\n\
                    free_thresh: 0.196\n";

fn parse(text: &str) -> Result<RosMap, RosMapError> {
    RosMap::parse(Path::new("maps/office.yaml"), text)
}

use Occupancy::{Free, Occupied, Unknown};

#[test]
fn the_top_row_of_the_image_has_the_largest_y() {
    let image = Image::read(&b"P2 2 3 255\n 0 255\n 255 255\n 255 205\n"[..]).unwrap();
    let grid = parse(YAML).unwrap().classify(&image);
    // Black, top left: smallest x, largest y.
    assert_eq!(grid.at(Point2::new(-0.75, 3.25)), Some(&Occupied));
    assert_eq!(grid.at(Point2::new(-0.75, 2.25)), Some(&Free));
    // Unknown gray, bottom right.
    assert_eq!(grid.at(Point2::new(-0.25, 2.25)), Some(&Unknown));
    let cells = |unknown| CellMap::from_occupancy(&grid, unknown).runs;
    assert_eq!(cells(UnknownCells::Occupied), [1, 1, 2, 1, 1]);
    assert_eq!(cells(UnknownCells::Free), [4, 1, 1]);
}

#[test]
fn negated_maps_and_deep_images_are_classified_by_probability() {
    let yaml = YAML.replace("negate: 0", "negate: 1");
    let image = Image::read(&b"P2 3 1 1000\n 1000 0 400\n"[..]).unwrap();
    let grid = parse(&yaml).unwrap().classify(&image);
    assert_eq!(grid.cells, [Occupied, Free, Unknown]);
}

#[test]
fn colours_are_averaged_and_alpha_counts_by_mode() {
    let classified = |channels: usize, samples: &[u16], mode: &str| {
        let image = Image {
            width: samples.len() / channels,
            height: 1,
            channels,
            maxval: 255,
            samples: samples.to_vec(),
        };
        let yaml = YAML.replace("negate: 0", mode);
        parse(&yaml).unwrap().classify(&image).cells
    };
    // (255 + 255 + 0) / 3 is a third from white: unknown, as (255 + 255 + 255 + 0) / 4 is.
    let colours = [0, 0, 0, 255, 255, 255, 255, 255, 0];
    let expected = [Occupied, Free, Unknown];
    assert_eq!(classified(3, &colours, "mode: trinary"), expected);
    assert_eq!(classified(3, &colours, "mode: scale"), expected);
    let transparent = [
        255, 255, 255, 0, 255, 255, 255, 255, 0, 0, 0, 255, 0, 0, 0, 0,
    ];
    assert_eq!(
        classified(4, &transparent, "mode: trinary"),
        [Unknown, Free, Occupied, Occupied]
    );
    assert_eq!(
        classified(4, &transparent, "mode: scale"),
        [Unknown, Free, Occupied, Unknown]
    );
    // Gray and alpha as three grays and alpha.
    assert_eq!(
        classified(2, &[255, 0, 255, 255, 0, 255], "mode: trinary"),
        [Unknown, Free, Occupied]
    );
    assert_eq!(
        classified(1, &[0, 19, 50, 66, 100, 101, 255], "mode: raw"),
        [Free, Free, Unknown, Occupied, Occupied, Unknown, Unknown]
    );
}

#[test]
fn quotes_and_comments_are_understood() {
    let map = parse(&YAML.replace("./office.pgm", "\"a # b.pgm\"")).unwrap();
    assert_eq!(map.image, Path::new("a # b.pgm"));
    assert_eq!(map.origin, [-1.0, 2.0]);
}

#[test]
fn broken_yaml_names_file_line_value_and_expectation() {
    let message = |from: &str, to: &str| parse(&YAML.replace(from, to)).unwrap_err().to_string();
    assert_eq!(
        message("resolution: 0.5", "resolution: -1"),
        "map maps/office.yaml, line 2: resolution = -1: expected a number > 0 and ≤ 1e5 (m)"
    );
    assert!(message("0.0]", "0.3]").contains("line 3: origin = [-1.0, 2.0, 0.3]"));
    assert!(message("0.0]", "0.3]").contains("yaw = 0"));
    assert!(message("2.0, 0.0]", "nan, 0.0]").contains("line 3"));
    assert!(message("negate: 0", "negate: 2").contains("line 4: negate = 2: expected 0 or 1"));
    assert!(message("0.65", "1.65").contains("line 5: occupied_thresh = 1.65"));
    assert!(message("0.65", "0.1").contains("`free_thresh` is 0.196: expected at most"));
    assert!(message("free_thresh", "freethresh").contains("free_thresh is missing"));
    assert!(message("image:", "image =").contains("line 1"));
    assert!(message("./office.pgm", "").contains("line 1: image is empty: expected the path"));
    assert!(message("0.5\n", "0.5 0.5\n").contains("line 2: resolution = 0.5 0.5"));
    assert!(message("0.5\n", ".inf\n").contains("line 2: resolution = .inf"));
    assert!(message("0.0]", "1e-4]").contains("line 3: origin = [-1.0, 2.0, 1e-4]"));
    assert!(message("[-1.0, 2.0, 0.0]", "[-1.0, 2.0]").contains("line 3: origin = [-1.0, 2.0]"));
    assert!(message("[-1.0, 2.0, 0.0]", "{x: 1}").contains("line 3: origin = a table"));
    assert!(message("[-1.0, 2.0, 0.0]", "[[1], 2, 0]").contains("origin = a list of lists"));
    assert!(message("0.5\n", "&a 0.5\nx: *a\nx: 1\n").contains("line 4: x a second time"));
    assert!(message("-1.0", "*a").contains("line 3: while parsing node, found unknown anchor"));
    assert!(message("negate", "...\n---\nnegate").contains("line 6: a second document"));
    assert!(message("negate", "? [1]\n: 2\nnegate").contains("line 4: a key that is no text"));
    assert!(message("negate", "\tnegate").contains(": expected YAML"));
    assert!(message("image: ./office.pgm", "# no image").contains("image is missing"));
    assert!(message("negate: 0", "resolution: 1").contains("line 4: resolution a second time"));
    assert!(message("negate: 0", "mode: none").contains("mode = none: expected trinary, scale"));
    assert!(message("negate: 0", "negate: 1\nmode: raw").contains("`negate` is 1"));
}

#[test]
fn files_are_read_relative_to_the_yaml_and_errors_name_them() {
    let directory = std::env::temp_dir().join(format!("protean-ros-{}", std::process::id()));
    std::fs::create_dir_all(&directory).unwrap();
    let yaml = directory.join("office.yaml");
    std::fs::write(&yaml, YAML).unwrap();
    let error = RosMap::read(&yaml).unwrap().load().unwrap_err().to_string();
    assert!(error.contains("office.pgm"), "{error}");
    std::fs::write(directory.join("office.pgm"), b"P5 2 2 255\n\0\xff\xff").unwrap();
    let error = RosMap::read(&yaml).unwrap().load().unwrap_err().to_string();
    assert!(
        error.contains("office.pgm") && error.contains("3 pixels of 2 × 2"),
        "{error}"
    );
    std::fs::write(directory.join("office.pgm"), b"P5 2 2 255\n\0\xff\xff\xff").unwrap();
    let map = RosMap::read(&yaml).unwrap().load().unwrap();
    assert_eq!(map.cells, [Free, Free, Occupied, Free]);
    let error = RosMap::read(&directory.join("none.yaml"))
        .unwrap_err()
        .to_string();
    assert!(error.contains("none.yaml"), "{error}");
    std::fs::remove_dir_all(&directory).unwrap();
}

#[test]
fn unknown_keys_are_listed_in_the_order_of_the_file() {
    let map =
        parse(&YAML.replace("negate", "map_type: occupancy\nauthor: {name: x}\nnegate")).unwrap();
    let expected = [("map_type".to_owned(), 4), ("author".to_owned(), 5)];
    assert_eq!(map.ignored, expected);
}

#[test]
fn hostile_texts_are_refused_with_short_messages() {
    let joined = |n: usize, part: fn(usize) -> String| (0..n).map(part).collect::<String>();
    let bomb = joined(29, |i| format!("k{}: &k{} [*k{i}, *k{i}]\n", i + 1, i + 1));
    for text in [
        "[".repeat(1 << 20),
        "- ".repeat(1 << 19),
        "{a: ".repeat(1 << 18),
        joined(1400, |i| format!("{}a:\n", " ".repeat(i))),
        format!("image: {}\nresolution: {0}", "x".repeat(1 << 19)),
        format!("{}: 1\n{0}: 2\n", "x".repeat(900)),
        format!("k0: &k0 1\n{bomb}origin: *k29\n{YAML}"),
        format!("origin: [{}]", "1,".repeat(1 << 19)),
        joined(200_000, |i| format!("{i}:\n")),
    ] {
        let message = parse(&text).unwrap_err().to_string();
        assert!(message.len() < 400, "{message}");
    }
}
