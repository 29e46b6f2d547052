use expect_test::expect;

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
    let changes = [
        ("resolution: 0.5", "resolution: -1"),
        ("0.0]", "0.3]"),
        ("2.0, 0.0]", "nan, 0.0]"),
        ("negate: 0", "negate: 2"),
        ("0.65", "1.65"),
        ("0.65", "0.1"),
        ("free_thresh", "freethresh"),
        ("image:", "image ="),
        ("./office.pgm", ""),
        ("0.5\n", "0.5 0.5\n"),
        ("0.5\n", ".inf\n"),
        ("0.0]", "1e-4]"),
        ("[-1.0, 2.0, 0.0]", "[-1.0, 2.0]"),
        ("[-1.0, 2.0, 0.0]", "{x: 1}"),
        ("[-1.0, 2.0, 0.0]", "[[1], 2, 0]"),
        ("0.5\n", "&a 0.5\nx: *a\nx: 1\n"),
        ("-1.0", "*a"),
        ("negate", "...\n---\nnegate"),
        ("negate", "? [1]\n: 2\nnegate"),
        ("negate", "\tnegate"),
        ("image: ./office.pgm", "# no image"),
        ("negate: 0", "resolution: 1"),
        ("negate: 0", "mode: none"),
        ("negate: 0", "negate: 1\nmode: raw"),
    ];
    let refused = |(from, to)| parse(&YAML.replace(from, to)).unwrap_err().to_string();
    expect![[r#"
        map maps/office.yaml, line 2: resolution = -1: expected a number > 0 and ≤ 1e5 (m)
        map maps/office.yaml, line 3: origin = [-1.0, 2.0, 0.3]: expected [x, y, yaw] with x and y within ±1e5 (m) and yaw = 0 (rad) (turned maps are not read)
        map maps/office.yaml, line 3: origin = [-1.0, nan, 0.0]: expected [x, y, yaw] with x and y within ±1e5 (m) and yaw = 0 (rad) (turned maps are not read)
        map maps/office.yaml, line 4: negate = 2: expected 0 or 1, or false or true
        map maps/office.yaml, line 5: occupied_thresh = 1.65: expected a number in [0, 1]
        map maps/office.yaml: `free_thresh` is 0.196: expected at most occupied_thresh = 0.1
        map maps/office.yaml: free_thresh is missing: expected a line `free_thresh: …`
        map maps/office.yaml, line 1: no key: expected one document with lines of `key: value`
        map maps/office.yaml, line 1: image is empty: expected the path of a PGM or PNG file
        map maps/office.yaml, line 2: resolution = 0.5 0.5: expected a number > 0 and ≤ 1e5 (m)
        map maps/office.yaml, line 2: resolution = .inf: expected a number > 0 and ≤ 1e5 (m)
        map maps/office.yaml, line 3: origin = [-1.0, 2.0, 1e-4]: expected [x, y, yaw] with x and y within ±1e5 (m) and yaw = 0 (rad) (turned maps are not read)
        map maps/office.yaml, line 3: origin = [-1.0, 2.0]: expected [x, y, yaw] with x and y within ±1e5 (m) and yaw = 0 (rad) (turned maps are not read)
        map maps/office.yaml, line 3: origin = a table: expected [x, y, yaw] with x and y within ±1e5 (m) and yaw = 0 (rad) (turned maps are not read)
        map maps/office.yaml, line 3: origin = a list of lists: expected [x, y, yaw] with x and y within ±1e5 (m) and yaw = 0 (rad) (turned maps are not read)
        map maps/office.yaml, line 4: x a second time: expected every key once
        map maps/office.yaml, line 3: while parsing node, found unknown anchor: expected YAML
        map maps/office.yaml, line 6: a second document: expected one document with lines of `key: value`
        map maps/office.yaml, line 4: a key that is no text: expected `key: value`
        map maps/office.yaml, line 4: while parsing a block mapping, did not find expected key: expected YAML
        map maps/office.yaml: image is missing: expected a line `image: …`
        map maps/office.yaml, line 4: resolution a second time: expected every key once
        map maps/office.yaml, line 4: mode = none: expected trinary, scale or raw
        map maps/office.yaml: `negate` is 1: expected 0 with mode = raw"#]].assert_eq(&changes.map(refused).join("\n"));
}

#[test]
fn files_are_read_relative_to_the_yaml_and_errors_name_them() {
    let directory = std::env::temp_dir().join(format!("protean-ros-{}", std::process::id()));
    std::fs::create_dir_all(&directory).unwrap();
    let yaml = directory.join("office.yaml");
    std::fs::write(&yaml, YAML).unwrap();
    let refused = |yaml: &Path| {
        let error = RosMap::read(yaml).and_then(|map| map.load()).unwrap_err();
        let folder = directory.display().to_string();
        error.to_string().replace(&folder, "FOLDER")
    };
    let mut errors = vec![refused(&yaml), refused(&directory.join("none.yaml"))];
    std::fs::write(directory.join("office.pgm"), b"P5 2 2 255\n\0\xff\xff").unwrap();
    errors.push(refused(&yaml));
    expect![[r#"
        map image FOLDER/./office.pgm: No such file or directory (os error 2)
        map FOLDER/none.yaml: cannot be read: No such file or directory (os error 2)
        map image FOLDER/./office.pgm: truncated: 3 pixels of 2 × 2 = 4 declared in the header"#]]
    .assert_eq(&errors.join("\n"));
    std::fs::write(directory.join("office.pgm"), b"P5 2 2 255\n\0\xff\xff\xff").unwrap();
    let map = RosMap::read(&yaml).unwrap().load().unwrap();
    assert_eq!(map.cells, [Free, Free, Occupied, Free]);
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
