//! One map in many styles of YAML.

use std::process::Command;

use proptest::prelude::*;
use proptest::sample::{Index, select};

use super::*;

/// Values of a map.
#[derive(Debug, Clone)]
struct Values {
    image: &'static str,
    resolution: f64,
    origin: [f64; 2],
    yaw: f64,
    negate: bool,
    thresholds: [f64; 2],
    mode: Option<&'static str>,
}

fn values() -> impl Strategy<Value = Values> {
    let image = select(vec![
        "a.pgm",
        "./maps/a.png",
        "a # b.pgm",
        "a: b.pgm",
        "it's.pgm",
        "2024",
        "[a].png",
        "größe.pgm",
    ]);
    let length = select(vec![0.05, 0.5, 1.0, 1e-3, 2.0, 0.1 + 0.2]);
    let place = select(vec![0.0, -1.0, 2.5, -51.224_998, 1e5, 3.0e-4]);
    let yaw = select(vec![0.0, -0.0, 1.2e-17, -3e-9]);
    let share = select(vec![0.0, 0.196, 0.25, 0.65, 1.0]);
    let mode = select(vec![None, Some("trinary"), Some("scale")]);
    (
        image,
        length,
        [place.clone(), place],
        yaw,
        any::<bool>(),
        [share.clone(), share],
        mode,
    )
        .prop_map(
            |(image, resolution, origin, yaw, negate, mut thresholds, mode)| {
                thresholds.sort_by(f64::total_cmp);
                Values {
                    image,
                    resolution,
                    origin,
                    yaw,
                    negate,
                    thresholds,
                    mode,
                }
            },
        )
}

/// Choices of styles, used in turn.
struct Choices<'a>(&'a [Index], usize);

impl Choices<'_> {
    fn pick<'b>(&mut self, styles: &[&'b str]) -> &'b str {
        let choice = self.0[self.1 % self.0.len()];
        self.1 += 1;
        styles[choice.index(styles.len())]
    }

    /// A scalar, quoted or, if its characters permit, plain.
    fn scalar(&mut self, text: &str) -> String {
        let is_plain = |c: char| c.is_ascii_alphanumeric() || "._/+-".contains(c);
        let plain = text.chars().all(is_plain);
        match self.pick(&["plain", "single", "double", "escaped"]) {
            "plain" if plain => text.to_owned(),
            "escaped" => {
                text.chars().fold("\"".to_owned(), |escaped, c| {
                    format!("{escaped}\\u{:04x}", u32::from(c))
                }) + "\""
            }
            "double" => format!("\"{text}\""),
            _ => format!("'{}'", text.replace('\'', "''")),
        }
    }

    fn number(&mut self, x: f64) -> String {
        let text = match self.pick(&["short", "long", "exponent", "sign"]) {
            "short" => x.to_string(),
            "exponent" => format!("{x:e}"),
            "sign" if x.is_sign_positive() => format!("+{x}"),
            _ => format!("{x:?}"),
        };
        self.scalar(&text)
    }

    /// The end of a line.
    fn end(&mut self) -> &'static str {
        self.pick(&["\n", "  \n", "  # a comment: [\n", "\n\n", "\n# whole\n"])
    }

    fn origin(&mut self, in_flow: bool, [x, y]: [f64; 2], yaw: f64) -> String {
        let [x, y, yaw] = [x, y, yaw].map(|number| self.number(number));
        let flow = format!("[{x}, {y}, {yaw}]");
        match self.pick(&["flow", "lines", "block", "indented", "tagged"]) {
            "lines" => format!("[{x},\n         {y},\n         {yaw} ]"),
            "block" if !in_flow => format!("\n- {x}\n- {y}   # y\n- {yaw}"),
            "indented" if !in_flow => format!("\n    - {x}\n    - {y}\n    - {yaw}"),
            "tagged" if !in_flow => format!("!!python/tuple\n- {x}\n- {y}\n- {yaw}"),
            _ => flow,
        }
    }
}

/// Writes the values, and unknown keys beside them.
fn write(values: &Values, choices: &mut Choices<'_>) -> String {
    let in_flow = choices.pick(&["block", "flow"]) == "flow";
    let truth = if values.negate {
        ["1", "true", "True", "TRUE", "yes", "On", "y"]
    } else {
        ["0", "false", "False", "FALSE", "no", "Off", "n"]
    };
    let [free, occupied] = values.thresholds;
    let mut keys = vec![
        ("image", choices.scalar(values.image)),
        ("resolution", choices.number(values.resolution)),
        ("origin", choices.origin(in_flow, values.origin, values.yaw)),
        ("free_thresh", choices.number(free)),
        ("occupied_thresh", choices.number(occupied)),
    ];
    let truth = choices.pick(&truth);
    if values.negate || choices.pick(&["written", "absent"]) == "written" {
        keys.push(("negate", choices.scalar(truth)));
    }
    if let Some(mode) = values.mode {
        keys.push(("mode", choices.scalar(mode)));
    }
    match choices.pick(&["none", "text", "table"]) {
        "text" => keys.push(("map_type", choices.scalar("occupancy"))),
        "table" => keys.push((
            "properties",
            "{a: [1, {b: c}], origin: [9, 9, 9]}".to_owned(),
        )),
        _ => {}
    }
    let first = choices.0[0].index(keys.len());
    keys.rotate_left(first);
    let mut text = String::new();
    for (key, value) in &keys {
        let key = choices.scalar(key);
        if in_flow {
            let end = choices.pick(&[", ", ",\n  ", ",\n\n  # a comment\n  "]);
            text += &format!("{key}: {value}{end}");
        } else {
            text += &format!("{key}: {value}{}", choices.end());
        }
    }
    if in_flow {
        text = format!("{{{text}}}\n");
    }
    let start = choices.pick(&[
        "",
        "---\n",
        "# a comment\n\n",
        "%YAML 1.2\n---\n",
        "%YAML 1.1\n---\n",
    ]);
    let end = choices.pick(&["", "...\n", "---\n", "...\n# the end"]);
    text = format!("{start}{text}{end}");
    if choices.pick(&["lf", "crlf"]) == "crlf" {
        text = text.replace('\n', "\r\n");
    }
    choices.pick(&["", "\u{feff}"]).to_owned() + &text
}

/// Checks a text against the values.
fn check(values: &Values, text: &str) {
    let map = parse(text).unwrap_or_else(|error| panic!("{error}\n{text}"));
    let expected = RosMap {
        path: "maps/office.yaml".into(),
        image: values.image.into(),
        resolution: values.resolution,
        origin: values.origin,
        negate: values.negate,
        free_thresh: values.thresholds[0],
        occupied_thresh: values.thresholds[1],
        mode: match values.mode {
            Some("scale") => RosMode::Scale,
            _ => RosMode::Trinary,
        },
        ignored: map.ignored.clone(),
    };
    assert_eq!(map, expected, "\n{text}");
    let unknown = ["map_type", "properties"];
    assert!(map.ignored.iter().all(|(key, line)| {
        unknown.contains(&key.as_str()) && *line >= 1 && *line <= text.lines().count()
    }));
    let has_unknown = unknown.iter().any(|key| text.contains(key));
    assert!(!has_unknown || !map.ignored.is_empty(), "{text}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(500))]

    #[test]
    fn a_map_is_the_same_in_every_style(values in values(), choices in prop::collection::vec(any::<Index>(), 40)) {
        let mut choices = Choices(&choices, 0);
        check(&values, &write(&values, &mut choices));
    }

    /// Any text, and a map with a part replaced by any text, is refused or is a map within its limits.
    #[test]
    fn no_text_is_a_map_out_of_its_limits(junk in "[\\[\\]{}:,#&*!|>'\"%@`\\-? \n\ta-z0-9.~<]{0,40}", at in any::<Index>(), whole in any::<bool>()) {
        let text = if whole {
            junk
        } else {
            let at = at.index(YAML.len());
            format!("{}{junk}{}", &YAML[..at], &YAML[at..])
        };
        if let Ok(map) = parse(&text) {
            prop_assert!(map.resolution > 0.0 && map.free_thresh <= map.occupied_thresh);
        }
    }
}

/// Writes maps with the library that scripts use; its three styles, and files that Python writes by hand.
const SCRIPT: &str = r"
import json, sys, yaml
v = json.load(sys.stdin)
keys = {'image': v['image'], 'resolution': v['resolution'], 'origin': v['origin'] + [v['yaw']], 'negate': v['negate'],
        'occupied_thresh': v['occupied'], 'free_thresh': v['free'], 'map_type': None}
texts = [yaml.dump(keys, default_flow_style=style, **more) for style in (False, True, None)
         for more in ({}, {'explicit_start': True, 'explicit_end': True}, {'default_style': '\'', 'version': (1, 1)},
                      {'indent': 8, 'width': 10, 'line_break': '\r\n'}, {'sort_keys': False, 'allow_unicode': True})]
texts += [yaml.dump({**keys, 'negate': int(v['negate']), 'origin': tuple(keys['origin'])})]
texts += [''.join(f'{key}: {value}\n' for key, value in keys.items() if key != 'image') + 'image: ' + json.dumps(v['image'])]
json.dump(texts, sys.stdout)
";

#[test]
fn the_texts_of_python_are_read() {
    let has_yaml = Command::new("python3").args(["-c", "import yaml"]).output();
    if !has_yaml.is_ok_and(|output| output.status.success()) {
        eprintln!("skipped: maps of PyYAML: python3 has no package yaml");
        return;
    }
    for (image, resolution, yaw, negate) in [
        ("a.pgm", 0.05, 0.0, false),
        ("it's # größe: x.png", 1e-3, 1.2e-17, true),
        ("2024", 1.0, -0.0, true),
    ] {
        let values = Values {
            image,
            resolution,
            origin: [-51.224_998, 1e5],
            yaw,
            negate,
            thresholds: [0.196, 0.65],
            mode: None,
        };
        let quoted = format!("{image:?}");
        let input = format!(
            "{{\"image\": {quoted}, \"resolution\": {resolution:e}, \"origin\": [-51.224998, 100000.0], \"yaw\": {yaw:e}, \
             \"negate\": {negate}, \"free\": 0.196, \"occupied\": 0.65}}"
        );
        let mut python = Command::new("python3");
        python.args(["-c", SCRIPT]).env("PYTHONIOENCODING", "utf-8");
        let texts = output_of(&mut python, &input);
        let texts: Vec<String> = toml::from_str::<Texts>(&format!("texts = {texts}"))
            .unwrap()
            .texts;
        assert_eq!(texts.len(), 17);
        for text in texts {
            check(&values, &text);
        }
    }
}

/// A JSON array of texts in ASCII is a TOML array, too.
#[derive(serde::Deserialize)]
struct Texts {
    texts: Vec<String>,
}

fn output_of(command: &mut Command, input: &str) -> String {
    use std::io::Write;
    use std::process::Stdio;
    let mut child = command
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let mut stdin = child.stdin.take().unwrap();
    stdin.write_all(input.as_bytes()).unwrap();
    drop(stdin);
    let output = child.wait_with_output().unwrap();
    assert!(output.status.success());
    String::from_utf8(output.stdout).unwrap()
}
