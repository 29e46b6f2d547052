//! Every field of every topic, decoded by an independent decoder: the Python package
//! `mcap-ros2-support` decodes our CDR with our schemas; its values are packed again and must equal
//! the bytes of shared memory.

use std::convert::Infallible;
use std::fmt::Write as _;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use ipc_types::message::{Descriptor, FieldKind, Message};
use ipc_types::topics::{Arity, Topic, TopicVisitor, for_each_topic};
use ipc_types::{cdr, schema};
use zerocopy::{FromBytes, IntoBytes};

/// The interpreter with the decoder, or the reason why there is none.
fn python() -> Result<PathBuf, String> {
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/python/prepare.py");
    let output = Command::new("python3")
        .arg(script)
        .arg(env!("CARGO_TARGET_TMPDIR"))
        .output()
        .map_err(|e| format!("python3: {e}"))?;
    if !output.status.success() {
        return Err(String::from_utf8_lossy(&output.stderr).trim().to_owned());
    }
    Ok(PathBuf::from(
        String::from_utf8_lossy(&output.stdout).trim(),
    ))
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().fold(String::new(), |mut text, b| {
        let _ = write!(text, "{b:02x}");
        text
    })
}

/// Path and type of every number, in order.
fn numbers(descriptor: &Descriptor, prefix: &str, out: &mut Vec<(String, &'static str, usize)>) {
    fn size(ros: &str) -> usize {
        ros.trim_start_matches(|c: char| c.is_alphabetic())
            .parse::<usize>()
            .unwrap()
            / 8
    }
    if descriptor.fields.is_empty() {
        out.push((
            prefix.trim_end_matches('.').to_owned(),
            descriptor.name,
            size(descriptor.name),
        ));
    }
    for field in descriptor.fields {
        let path = format!("{prefix}{}", field.name);
        match field.kind {
            FieldKind::Number(ros) => out.push((path, ros, size(ros))),
            FieldKind::Array(ros, n) => {
                out.extend((0..n).map(|i| (format!("{path}[{i}]"), ros, size(ros))));
            }
            FieldKind::Nested(inner) => numbers(inner, &format!("{path}."), out),
        }
    }
}

/// One line for the script, and the expected bytes of its answer.
struct Lines(Vec<(String, String, Vec<u8>)>);

impl TopicVisitor for Lines {
    type Error = Infallible;
    fn visit<T: Topic>(&mut self) -> Result<(), Infallible> {
        let counts: &[usize] = if T::ARITY == Arity::One {
            &[1]
        } else {
            &[0, 1, 3]
        };
        for &count in counts {
            let mut paths = Vec::new();
            numbers(&T::Header::DESCRIPTOR, "", &mut paths);
            for i in 0..count {
                let prefix = match T::ARITY {
                    Arity::One => String::new(),
                    Arity::Many => format!("{}[{i}].", T::id().facts().elements),
                };
                numbers(&T::Element::DESCRIPTOR, &prefix, &mut paths);
            }
            // Arbitrary bytes, but no NaN: Python keeps the value, not the bit pattern.
            let mut state = count as u64 + 12_345;
            let mut bytes = Vec::new();
            for (_, ros, size) in &paths {
                for _ in 0..*size {
                    state = state
                        .wrapping_mul(6_364_136_223_846_793_005)
                        .wrapping_add(1);
                    bytes.push((state >> 56) as u8);
                }
                if ros.starts_with("float") {
                    *bytes.last_mut().unwrap() &= 0b1011_1111;
                }
            }
            let (header, elements) = bytes.split_at(size_of::<T::Header>());
            let header = T::Header::read_from_bytes(header).unwrap();
            let elements: Vec<T::Element> = elements
                .chunks_exact(size_of::<T::Element>())
                .map(|bytes| T::Element::read_from_bytes(bytes).unwrap())
                .collect();
            assert_eq!(elements.len(), count, "the paths cover all of {}", T::NAME);
            assert_eq!([header.as_bytes(), elements.as_bytes()].concat(), bytes);
            let mut message = Vec::new();
            cdr::encode::<T>(&header, &elements, &mut message);
            let mut line = format!(
                "{}\t{}\t{}",
                schema::message_name(T::id()),
                hex(schema::ros2msg(T::id()).as_bytes()),
                hex(&message)
            );
            for (path, ros, _) in &paths {
                let _ = write!(line, "\t{path} {ros}");
            }
            self.0
                .push((format!("{} with {count} element(s)", T::NAME), line, bytes));
        }
        Ok(())
    }
}

#[test]
fn python_reads_every_field_of_every_topic() {
    let python = match python() {
        Ok(python) => python,
        Err(reason) => {
            // Directly to stderr, because the test harness captures the output of tests.
            let note = format!("\nSKIPPED: python_reads_every_field_of_every_topic: {reason}\n");
            std::io::stderr().write_all(note.as_bytes()).unwrap();
            return;
        }
    };
    let mut lines = Lines(Vec::new());
    let Ok(()) = for_each_topic(&mut lines);
    let lines_in: Vec<&str> = lines.0.iter().map(|(_, line, _)| line.as_str()).collect();
    let input = lines_in.join("\n");
    let mut child = Command::new(python)
        .arg(Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/python/decode_cdr.py"))
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let mut stdin = child.stdin.take().unwrap();
    let writer = std::thread::spawn(move || stdin.write_all(input.as_bytes()));
    let output = child.wait_with_output().unwrap();
    writer.join().unwrap().unwrap();
    assert!(output.status.success(), "the decoder failed, see above");
    let answers = String::from_utf8(output.stdout).unwrap();
    assert_eq!(answers.lines().count(), lines.0.len());
    for ((what, _, bytes), answer) in lines.0.iter().zip(answers.lines()) {
        assert_eq!(hex(bytes), answer, "{what}");
    }
}
