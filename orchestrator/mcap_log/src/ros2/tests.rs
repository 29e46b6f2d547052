//! Random messages of random schemas, written by an encoder of its own.

use proptest::prelude::*;
use tables::Cell;

use super::{Cdr, DecodeError, Schema};

/// Number of elements of a field: one, an array or a sequence.
#[derive(Debug, Clone, Copy)]
enum Elements {
    One,
    Array(usize),
    Sequence(usize),
}

#[derive(Debug, Clone)]
enum Type {
    Primitive(&'static str),
    Message(Vec<(Type, Elements)>),
}

impl Type {
    fn has_wide_text(&self) -> bool {
        match self {
            Self::Primitive(name) => name.starts_with("wstring"),
            Self::Message(fields) => fields.iter().any(|(kind, _)| kind.has_wide_text()),
        }
    }
}

const PRIMITIVES: [&str; 20] = [
    "bool",
    "byte",
    "char",
    "int8",
    "uint8",
    "int16",
    "uint16",
    "int32",
    "uint32",
    "int64",
    "uint64",
    "float32",
    "float64",
    "string",
    "string<=9",
    "wstring",
    "wstring<=9",
    "time",
    "duration",
    "builtin_interfaces/Time",
];

fn message() -> impl Strategy<Value = Type> {
    let elements = prop_oneof![
        Just(Elements::One),
        (1_usize..4).prop_map(Elements::Array),
        (0_usize..4).prop_map(Elements::Sequence),
    ];
    let leaf = prop::sample::select(&PRIMITIVES[..]).prop_map(Type::Primitive);
    let nested = leaf.prop_recursive(3, 16, 4, move |inner| {
        prop::collection::vec((inner, elements.clone()), 0..4).prop_map(Type::Message)
    });
    prop::collection::vec((nested, Just(Elements::One)), 0..6).prop_map(Type::Message)
}

/// Returns the definition of a message: its fields, and the sections of the nested messages.
fn definition(fields: &[(Type, Elements)], sections: &mut String, messages: &mut usize) -> String {
    let mut text = String::new();
    for (index, (kind, elements)) in fields.iter().enumerate() {
        let name = match kind {
            Type::Primitive(name) => (*name).to_owned(),
            Type::Message(nested) => {
                *messages += 1;
                let name = format!("M{messages}");
                let nested = definition(nested, sections, messages);
                *sections += &format!("===\nMSG: p/{name}\n{nested}");
                name
            }
        };
        text += &match elements {
            Elements::One => format!("{name} f{index}\n"),
            Elements::Array(count) => format!("{name}[{count}] f{index}\n"),
            Elements::Sequence(count) if count % 2 == 0 => format!("{name}[<=4] f{index}\n"),
            Elements::Sequence(_) => format!("{name}[] f{index}\n"),
        };
    }
    text
}

/// Writer of random values.
struct Encoder {
    body: Vec<u8>,
    expected: Vec<Cell>,
    little: bool,
    /// Size of a unit of wide text (bytes).
    unit: usize,
    random: u64,
}

impl Encoder {
    fn random(&mut self) -> u64 {
        self.random = self
            .random
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        self.random >> 11
    }

    fn number(&mut self, size: usize, bits: u64) {
        while !self.body.len().is_multiple_of(size) {
            self.body.push(0);
        }
        let bytes = bits.to_le_bytes();
        if self.little {
            self.body.extend(&bytes[..size]);
        } else {
            self.body.extend(bytes[..size].iter().rev());
        }
    }

    fn value(&mut self, name: &str) {
        let bits = self.random();
        let text = ["", "a", "hé", "ab c"][bits as usize % 4];
        let bits = bits << 11 ^ bits;
        let (size, cell) = match name {
            "bool" => (1, Cell::Bool(bits & 1 == 1)),
            "byte" | "char" | "uint8" => (1, Cell::UInt(bits & 0xff)),
            "int8" => (1, Cell::Int(i64::from(bits as i8))),
            "uint16" => (2, Cell::UInt(bits & 0xffff)),
            "int16" => (2, Cell::Int(i64::from(bits as i16))),
            "uint32" => (4, Cell::UInt(bits & 0xffff_ffff)),
            "int32" => (4, Cell::Int(i64::from(bits as i32))),
            "uint64" => (8, Cell::UInt(bits)),
            "int64" => (8, Cell::Int(bits as i64)),
            "float32" => (4, Cell::F32(f32::from(bits as i16) / 8.0)),
            "float64" => (8, Cell::F64(f64::from(bits as i32) / 8.0)),
            "time" | "duration" | "builtin_interfaces/Time" => {
                self.value("int32");
                self.value("uint32");
                return;
            }
            name if name.starts_with("wstring") => {
                let units: Vec<u16> = text.encode_utf16().collect();
                self.number(4, units.len() as u64);
                for unit in units {
                    self.number(self.unit, u64::from(unit));
                }
                self.expected.push(Cell::Text(text.to_owned()));
                return;
            }
            _ => {
                self.number(4, text.len() as u64 + 1);
                self.body.extend(text.as_bytes());
                self.body.push(0);
                self.expected.push(Cell::Text(text.to_owned()));
                return;
            }
        };
        let bits = match cell {
            Cell::Bool(value) => u64::from(value),
            Cell::F32(value) => u64::from(value.to_bits()),
            Cell::F64(value) => value.to_bits(),
            _ => bits,
        };
        self.number(size, bits);
        self.expected.push(cell);
    }

    fn element(&mut self, kind: &Type) {
        match kind {
            Type::Primitive(name) => self.value(name),
            Type::Message(fields) if fields.is_empty() => self.body.push(0),
            Type::Message(fields) => {
                for (kind, elements) in fields {
                    let count = match *elements {
                        Elements::One => 1,
                        Elements::Array(count) => count,
                        Elements::Sequence(count) => {
                            self.number(4, count as u64);
                            count
                        }
                    };
                    (0..count).for_each(|_| self.element(kind));
                }
            }
        }
    }
}

/// Decodes all values of a message.
fn decode(schema: &Schema, bytes: &[u8]) -> Result<Vec<Cell>, DecodeError> {
    let mut cells = Vec::new();
    let mut cdr = Cdr::new(schema, bytes)?;
    for field in schema.fields() {
        cdr.field(field, &field.name, &mut |_, cell, _| cells.push(cell))?;
    }
    Ok(cells)
}

proptest! {
    #[test]
    fn a_message_is_read_to_its_end(
        message in message(),
        random: u64,
        little: bool,
        wide: bool,
        padding in 0_usize..4,
        more in 4_usize..70,
    ) {
        let Type::Message(fields) = &message else {
            panic!("a message")
        };
        let mut sections = String::new();
        let text = definition(fields, &mut sections, &mut 0) + &sections;
        let schema = Schema::parse("p/msg/T", text.as_bytes()).expect(&text);
        let unit = if wide { 4 } else { 2 };
        let mut encoder = Encoder { body: Vec::new(), expected: Vec::new(), little, unit, random };
        encoder.element(&message);
        let whole = [&[0, u8::from(little), 0, 0], encoder.body.as_slice()].concat();
        let with = |count: usize| [whole.as_slice(), &vec![0; count]].concat();

        prop_assert_eq!(decode(&schema, &with(padding)), Ok(encoder.expected), "{}", text);
        // The two forms of wide text may differ by a few bytes.
        if !message.has_wide_text() {
            prop_assert_eq!(decode(&schema, &with(more)), Err(DecodeError::Left(more)));
            for length in 0..whole.len() {
                prop_assert!(decode(&schema, &whole[..length]).is_err(), "{}: {}", text, length);
            }
        }
    }
}

#[test]
fn other_encodings_are_named() {
    let schema = Schema::parse("p/msg/T", b"int32 a").unwrap();
    for (head, name) in [(3, "PL_CDR"), (7, "XCDR2"), (9, "XCDR2"), (77, "4d")] {
        let error = decode(&schema, &[0, head, 0, 0, 5, 0, 0, 0]).unwrap_err();
        assert!(error.to_string().contains(name), "{error}");
    }
}
