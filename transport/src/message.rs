//! Common properties of messages: a fixed layout without padding, a stable name, and a description of the
//! fields, from which schemas for logs are generated.

pub use iceoryx2::prelude::ZeroCopySend;
pub use zerocopy;

use zerocopy::{FromBytes, Immutable, IntoBytes, KnownLayout};

/// A type that crosses a process boundary as its bytes.
///
/// Implemented only by the [`message!`](crate::message!) macro (and by the plain numbers that can be the
/// elements of a slice). `IntoBytes` proves at compile time that there is no implicit padding, so that equal
/// values are equal bytes. `FromBytes` proves that all bytes are a valid value, so that a malicious sender can
/// send nonsense but never cause undefined behaviour. Codes of enumerations are plain integers with a checked
/// accessor.
pub trait Message:
    core::fmt::Debug
    + Copy
    + PartialEq
    + Default
    + FromBytes
    + IntoBytes
    + Immutable
    + KnownLayout
    + ZeroCopySend
    + Send
    + Sync
    + 'static
{
    /// Name, size, alignment and fields.
    const DESCRIPTOR: Descriptor;
}

/// Description of a message type, for schemas and compatibility checks.
#[derive(Debug, Clone, Copy)]
pub struct Descriptor {
    /// Stable name, the same in every language: `protean/RobotState`; for plain numbers the ROS name.
    pub name: &'static str,
    /// Size (bytes).
    pub size: usize,
    /// Alignment (bytes).
    pub align: usize,
    /// The fields in order; empty for plain numbers.
    pub fields: &'static [Field],
}

/// One field of a message.
#[derive(Debug, Clone, Copy)]
pub struct Field {
    /// Name of the field.
    pub name: &'static str,
    /// Meaning, with the unit.
    pub doc: &'static str,
    /// Offset from the start of the message (bytes).
    pub offset: usize,
    /// Its type.
    pub kind: FieldKind,
}

/// Type of a field.
#[derive(Debug, Clone, Copy)]
pub enum FieldKind {
    /// A number, by its ROS 2 name (`float64`, `uint32`, …).
    Number(&'static str),
    /// A fixed number of numbers.
    Array(&'static str, usize),
    /// Another message.
    Nested(&'static Descriptor),
}

/// Types that may be a field of a message.
pub trait FieldType {
    /// The type in schemas.
    const KIND: FieldKind;
}

macro_rules! numbers {
    ($($rust:ty => $ros:literal),+ $(,)?) => {$(
        impl FieldType for $rust {
            const KIND: FieldKind = FieldKind::Number($ros);
        }
        impl<const N: usize> FieldType for [$rust; N] {
            const KIND: FieldKind = FieldKind::Array($ros, N);
        }
        impl Message for $rust {
            const DESCRIPTOR: Descriptor = Descriptor {
                name: $ros,
                size: size_of::<$rust>(),
                align: align_of::<$rust>(),
                fields: &[],
            };
        }
    )+};
}
numbers! {
    u8 => "uint8", u16 => "uint16", u32 => "uint32", u64 => "uint64",
    i8 => "int8", i16 => "int16", i32 => "int32", i64 => "int64",
    f32 => "float32", f64 => "float64",
}

/// Defines a message: the `repr(C)` struct, its zero-copy traits, its compile-time layout checks
/// and its [`Descriptor`].
///
/// The file imports [`ZeroCopySend`], which the generated code names.
///
/// The first field must have the alignment of the whole struct: only then are the bytes of a
/// slice of messages also their ROS 2 CDR encoding (the encapsulation aligns the first primitive,
/// nothing later needs padding).
#[macro_export]
macro_rules! message {
    (
        $(#[$meta:meta])*
        pub struct $name:ident = $ros:literal {
            $first:ident : $first_ty:ty = $first_doc:literal,
            $( $field:ident : $ty:ty = $doc:literal, )*
        }
    ) => {
        $(#[$meta])*
        #[repr(C)]
        #[derive(
            Debug, Clone, Copy, PartialEq, $crate::message::zerocopy::FromBytes,
            $crate::message::zerocopy::IntoBytes, $crate::message::zerocopy::Immutable,
            $crate::message::zerocopy::KnownLayout, ZeroCopySend,
        )]
        #[zerocopy(crate = "ipc_types::message::zerocopy")]
        #[type_name($ros)]
        // The texts of fields enter schema hashes, so their units stay as they are: `[m]`.
        #[allow(rustdoc::broken_intra_doc_links)]
        pub struct $name {
            #[doc = $first_doc]
            pub $first: $first_ty,
            $( #[doc = $doc] pub $field: $ty, )*
        }

        impl $crate::message::Message for $name {
            const DESCRIPTOR: $crate::message::Descriptor = $crate::message::Descriptor {
                name: $ros,
                size: size_of::<$name>(),
                align: align_of::<$name>(),
                fields: &[
                    $crate::message::Field {
                        name: stringify!($first),
                        doc: $first_doc,
                        offset: core::mem::offset_of!($name, $first),
                        kind: <$first_ty as $crate::message::FieldType>::KIND,
                    },
                    $($crate::message::Field {
                        name: stringify!($field),
                        doc: $doc,
                        offset: core::mem::offset_of!($name, $field),
                        kind: <$ty as $crate::message::FieldType>::KIND,
                    },)*
                ],
            };
        }

        impl $crate::message::FieldType for $name {
            const KIND: $crate::message::FieldKind = $crate::message::FieldKind::Nested(
                &<$name as $crate::message::Message>::DESCRIPTOR,
            );
        }

        impl Default for $name {
            fn default() -> Self {
                $crate::message::zerocopy::FromZeros::new_zeroed()
            }
        }

        const _: () = assert!(
            align_of::<$first_ty>() == align_of::<$name>(),
            "the first field must have the alignment of the message (CDR = bytes)"
        );
    };
}
