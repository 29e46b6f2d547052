//! Definition and CDR form of a ROS 2 message, both from one description of its fields.

/// Little-endian plain CDR.
const ENCAPSULATION: [u8; 4] = [0, 1, 0, 0];

/// Line between the definitions of a schema.
const RULE: &str =
    "================================================================================";

/// Writer of plain CDR (XCDR1): every number is aligned to its size, counted from the end of the encapsulation
/// header.
#[derive(Debug)]
pub struct CdrWriter<'a> {
    out: &'a mut Vec<u8>,
    start: usize,
}

impl CdrWriter<'_> {
    fn number<const N: usize>(&mut self, bytes: [u8; N]) {
        let padding = (self.out.len() - self.start).wrapping_neg() % N;
        self.out.extend_from_slice(&[0; 8][..padding]);
        self.out.extend_from_slice(&bytes);
    }

    fn length(&mut self, length: usize) {
        // Messages are far below 4 GiB.
        self.number((length as u32).to_le_bytes());
    }
}

/// Type of a field: a number, a text, a message, or a list of these.
pub trait RosType {
    /// Returns its name in definitions, such as `float64` or `geometry_msgs/Point[]`.
    fn name() -> String;

    /// Writes a value.
    fn write(&self, out: &mut CdrWriter<'_>);

    /// Writes the values of a list.
    fn write_all(values: &[Self], out: &mut CdrWriter<'_>)
    where
        Self: Sized,
    {
        for value in values {
            value.write(out);
        }
    }

    /// Adds the definition of a message and of all messages in it, in this order.
    fn define(_: &mut Definitions) {}
}

/// Definitions of messages: name and lines.
pub type Definitions = Vec<(String, String)>;

/// Appends the CDR form of a message.
pub fn encode<M: RosType>(message: &M, out: &mut Vec<u8>) {
    out.extend_from_slice(&ENCAPSULATION);
    let start = out.len();
    message.write(&mut CdrWriter { out, start });
}

/// Returns the name (`PACKAGE/msg/NAME`) and the schema (`ros2msg`) of a message.
pub fn definition<M: RosType>() -> (String, String) {
    let mut all = Definitions::new();
    M::define(&mut all);
    let mut schema = String::new();
    for (index, (name, lines)) in all.iter().enumerate() {
        if index > 0 {
            schema += &format!("{RULE}\nMSG: {name}\n");
        }
        schema += lines;
    }
    (M::name().replace('/', "/msg/"), schema)
}

/// Adds the definition of a message: names of the types and of the fields.
pub fn add_definition(
    name: String,
    fields: &[(String, &str)],
    contained: &[fn(&mut Definitions)],
    all: &mut Definitions,
) {
    if all.iter().any(|(known, _)| *known == name) {
        return;
    }
    // A field named by a Rust keyword is written `r#type` in Rust.
    let line =
        |(kind, field): &(String, &str)| format!("{kind} {}\n", field.trim_start_matches("r#"));
    all.push((name, fields.iter().map(line).collect()));
    for define in contained {
        define(all);
    }
}

/// Defines messages as structs, each with the name of its package.
macro_rules! ros_messages {
    ($($(#[$doc:meta])* $package:ident / $name:ident { $($field:ident: $kind:ty),* $(,)? })*) => { $(
        $(#[$doc])*
        #[derive(Debug, Clone, Default, PartialEq, serde::Serialize, serde::Deserialize)]
        pub struct $name { $(#[doc = concat!("`", stringify!($field), "` of the definition.")] pub $field: $kind),* }

        impl $crate::RosType for $name {
            fn name() -> String {
                concat!(stringify!($package), "/", stringify!($name)).to_owned()
            }

            fn write(&self, out: &mut $crate::CdrWriter<'_>) {
                $(self.$field.write(out);)*
            }

            fn define(all: &mut $crate::Definitions) {
                $crate::add_definition(
                    Self::name(),
                    &[$((<$kind>::name(), stringify!($field))),*],
                    &[$(<$kind>::define),*],
                    all,
                );
            }
        }
    )* };
}
pub(crate) use ros_messages;

macro_rules! numbers {
    ($($kind:ty = $name:literal),*) => { $(
        impl RosType for $kind {
            fn name() -> String {
                $name.to_owned()
            }

            fn write(&self, out: &mut CdrWriter<'_>) {
                out.number(self.to_le_bytes());
            }
        }
    )* };
}
numbers!(
    i32 = "int32",
    u32 = "uint32",
    f32 = "float32",
    f64 = "float64",
    i8 = "int8"
);

impl RosType for u8 {
    fn name() -> String {
        "uint8".to_owned()
    }

    fn write(&self, out: &mut CdrWriter<'_>) {
        out.out.push(*self);
    }

    fn write_all(values: &[Self], out: &mut CdrWriter<'_>) {
        out.out.extend_from_slice(values);
    }
}

impl RosType for bool {
    fn name() -> String {
        "bool".to_owned()
    }

    fn write(&self, out: &mut CdrWriter<'_>) {
        out.out.push(u8::from(*self));
    }
}

impl RosType for String {
    fn name() -> String {
        "string".to_owned()
    }

    fn write(&self, out: &mut CdrWriter<'_>) {
        out.length(self.len() + 1);
        out.out.extend_from_slice(self.as_bytes());
        out.out.push(0);
    }
}

impl<T: RosType> RosType for Vec<T> {
    fn name() -> String {
        format!("{}[]", T::name())
    }

    fn write(&self, out: &mut CdrWriter<'_>) {
        out.length(self.len());
        T::write_all(self, out);
    }

    fn define(all: &mut Definitions) {
        T::define(all);
    }
}

/// Covariance of a pose or a twist: 36 numbers.
impl RosType for [[f64; 6]; 6] {
    fn name() -> String {
        "float64[36]".to_owned()
    }

    fn write(&self, out: &mut CdrWriter<'_>) {
        f64::write_all(self.as_flattened(), out);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    ros_messages! {
        /// Message within [`Outer`].
        test_msgs / Inner { flag: bool, value: f64 }
        /// Message with all kinds of fields.
        test_msgs / Outer { r#type: u8, text: String, empty: Vec<Inner>, inner: Vec<Inner>, last: i32 }
    }

    #[test]
    fn definitions_begin_with_the_message_and_contain_each_message_once() {
        let (name, schema) = definition::<Outer>();
        assert_eq!(name, "test_msgs/msg/Outer");
        let expected = "uint8 type\nstring text\ntest_msgs/Inner[] empty\ntest_msgs/Inner[] inner\nint32 last\n";
        assert_eq!(
            schema,
            format!("{expected}{RULE}\nMSG: test_msgs/Inner\nbool flag\nfloat64 value\n")
        );
    }

    #[test]
    fn numbers_are_aligned_and_empty_sequences_have_no_gap() {
        let message = Outer {
            r#type: 7,
            text: "ab".to_owned(),
            empty: Vec::new(),
            inner: vec![Inner {
                flag: true,
                value: 1.0,
            }],
            last: -1,
        };
        let mut bytes = vec![0xee];
        encode(&message, &mut bytes);
        let one = 1.0_f64.to_le_bytes();
        let expected: Vec<u8> = [
            &[0xee][..],
            &ENCAPSULATION,
            &[7, 0, 0, 0],
            &[3, 0, 0, 0],
            b"ab\0\0",
            &[0, 0, 0, 0],
            &[1, 0, 0, 0],
            &[1, 0, 0, 0],
            &one,
            &[0xff; 4],
        ]
        .concat();
        assert_eq!(bytes, expected);
    }
}
