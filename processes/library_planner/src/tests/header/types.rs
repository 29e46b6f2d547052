//! Descriptions of C structures and tables of functions.

use core::ffi::{c_char, c_void};

use super::structure::Structure;

/// A type that can be a member or an argument.
pub(crate) trait CType {
    /// Returns its declaration with this name, e.g. `const char *name`; without a name the type.
    fn declare(name: &str) -> String;
}

/// A structure of the header.
pub(crate) trait CStructure {
    /// Its C name.
    const NAME: &'static str;

    /// Returns its description.
    fn structure() -> Structure;
}

/// A function of a table: the inline function that calls it.
#[derive(Debug, Clone)]
pub(crate) struct Function {
    /// Comment.
    pub doc: &'static str,
    /// Its name in the table.
    pub name: &'static str,
    /// Declaration of its result without a name.
    pub result: String,
    /// Declarations of its arguments after the first.
    pub arguments: Vec<String>,
    /// Names of these arguments.
    pub names: Vec<&'static str>,
}

/// A table of functions whose first argument is a structure that holds the table.
pub(crate) trait CFunctions: CStructure {
    /// The structure of the first argument.
    type Of: CStructure;
    /// Name of the first argument.
    const OF: &'static str;

    /// Returns the functions in order.
    fn functions() -> Vec<Function>;
}

macro_rules! numbers {
    ($($rust:ty => $c:literal),+ $(,)?) => {$(
        impl CType for $rust {
            fn declare(name: &str) -> String {
                format!("{} {name}", $c).trim_end().to_owned()
            }
        }
    )+};
}
numbers! {
    () => "void", bool => "bool", u8 => "uint8_t", u32 => "uint32_t", u64 => "uint64_t", usize => "size_t",
    f32 => "float", f64 => "double",
}

impl CType for *const c_char {
    fn declare(name: &str) -> String {
        format!("const char *{name}")
    }
}

impl CType for *const c_void {
    fn declare(name: &str) -> String {
        format!("const void *{name}")
    }
}

impl CType for *mut c_void {
    fn declare(name: &str) -> String {
        format!("void *{name}")
    }
}

impl CType for *const f32 {
    fn declare(name: &str) -> String {
        format!("const float *{name}")
    }
}

impl<T: CStructure> CType for *const T {
    fn declare(name: &str) -> String {
        format!("const {} *{name}", T::NAME)
    }
}

impl<T: CStructure> CType for *mut T {
    fn declare(name: &str) -> String {
        format!("{} *{name}", T::NAME)
    }
}

impl<T: CStructure> CType for T {
    fn declare(name: &str) -> String {
        format!("{} {name}", T::NAME).trim_end().to_owned()
    }
}

macro_rules! functions {
    ($($arg:ident)*) => {
        impl<R: CType, $($arg: CType),*> CType for Option<unsafe extern "C" fn($($arg),*) -> R> {
            fn declare(name: &str) -> String {
                let arguments: Vec<String> = vec![$($arg::declare("")),*];
                let arguments = arguments.join(", ");
                R::declare(&format!("(*{name})({arguments})"))
            }
        }
    };
}
functions!(A);
functions!(A B);
functions!(A B C);

/// Describes a structure.
macro_rules! describe_structure {
    ($doc:expr, $name:ident = $c:literal, $( $field:ident : $ty:ty = $member_doc:literal, )+) => {
        impl $crate::tests::header::types::CStructure for $name {
            const NAME: &'static str = $c;

            fn structure() -> $crate::tests::header::structure::Structure {
                $crate::tests::header::structure::Structure {
                    name: $c.to_owned(),
                    doc: $doc.trim().to_owned(),
                    size: size_of::<$name>(),
                    members: vec![$($crate::tests::header::structure::Member {
                        name: stringify!($field).to_owned(),
                        declaration: <$ty as $crate::tests::header::types::CType>::declare(stringify!($field)),
                        doc: $member_doc.to_owned(),
                        offset: core::mem::offset_of!($name, $field),
                    },)+],
                }
            }
        }
    };
}
pub(crate) use describe_structure;

/// Describes a table of functions.
macro_rules! describe_functions {
    (
        $doc:expr, $name:ident = $c:literal, $of_type:ident as $of:ident,
        $( $function_doc:expr, $function:ident( $($arg:ident : $ty:ty),* ) -> $result:ty; )+
    ) => {
        impl $crate::tests::header::types::CStructure for $name {
            const NAME: &'static str = $c;

            fn structure() -> $crate::tests::header::structure::Structure {
                let functions = <$name as $crate::tests::header::types::CFunctions>::functions();
                let mut offsets = [$( core::mem::offset_of!($name, $function) ),+].into_iter();
                let members = functions.into_iter().map(|function| $crate::tests::header::structure::Member {
                    name: function.name.to_owned(),
                    declaration: function.pointer(
                        <$of_type as $crate::tests::header::types::CStructure>::NAME,
                        stringify!($of),
                    ),
                    doc: String::new(),
                    offset: offsets.next().unwrap_or_default(),
                });
                $crate::tests::header::structure::Structure {
                    name: $c.to_owned(),
                    doc: $doc.trim().to_owned(),
                    size: size_of::<$name>(),
                    members: members.collect(),
                }
            }
        }

        impl $crate::tests::header::types::CFunctions for $name {
            type Of = $of_type;
            const OF: &'static str = stringify!($of);

            fn functions() -> Vec<$crate::tests::header::types::Function> {
                vec![$( $crate::tests::header::types::Function {
                    doc: $function_doc.trim(),
                    name: stringify!($function),
                    result: <$result as $crate::tests::header::types::CType>::declare(""),
                    arguments: vec![$( <$ty as $crate::tests::header::types::CType>::declare(stringify!($arg)) ),*],
                    names: vec![$( stringify!($arg) ),*],
                } ),+]
            }
        }
    };
}
pub(crate) use describe_functions;

impl Function {
    /// Returns the declaration of a pointer to it in its table.
    pub fn pointer(&self, of: &str, of_name: &str) -> String {
        let Self { name, result, .. } = self;
        let arguments = self.all_arguments(of, of_name);
        format!("{} (*{name})({arguments})", result.trim_end())
    }

    /// Returns the inline function that calls it: `protean_NAME(of, …)`.
    pub fn inline(&self, of: &str, of_name: &str) -> String {
        let Self {
            doc, name, result, ..
        } = self;
        let arguments = self.all_arguments(of, of_name);
        let names: Vec<&str> = core::iter::once(of_name)
            .chain(self.names.iter().copied())
            .collect();
        let hand_over = if result == "void" { "" } else { "return " };
        let doc = wrapped(doc);
        format!(
            "{doc}static inline {result} protean_{name}({arguments}) {{\n    {hand_over}{of_name}->functions->{name}({});\n}}\n\n",
            names.join(", ")
        )
    }

    fn all_arguments(&self, of: &str, of_name: &str) -> String {
        let first = format!("const {of} *{of_name}");
        let arguments: Vec<&str> = core::iter::once(&*first)
            .chain(self.arguments.iter().map(String::as_str))
            .collect();
        arguments.join(", ")
    }
}

/// Returns a comment in lines of at most 100 characters.
pub(crate) fn wrapped(doc: &str) -> String {
    let mut text = "/*".to_owned();
    let mut length = text.len();
    for word in doc.split_whitespace() {
        if length + 1 + word.len() > 97 {
            text += "\n *";
            length = 2;
        }
        text += " ";
        text += word;
        length += 1 + word.len();
    }
    text + " */\n"
}
