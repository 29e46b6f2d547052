//! C structures and tables of functions, each declared once: the Rust type, and in tests its description for the header.

/// Declares structures: the Rust types with C layout.
macro_rules! c_structures {
    ($(
        $(#[doc = $doc:literal])+
        pub struct $name:ident = $c:literal {
            $( $field:ident : $ty:ty = $member_doc:literal, )+
        }
    )+) => {$(
        $(#[doc = $doc])+
        #[repr(C)]
        #[derive(Debug, Clone, Copy)]
        pub struct $name {
            $( #[doc = $member_doc] pub $field: $ty, )+
        }

        #[cfg(test)]
        $crate::tests::header::types::describe_structure! {
            concat!($($doc),+), $name = $c, $( $field: $ty = $member_doc, )+
        }
    )+};
}
pub(crate) use c_structures;

/// Declares a table of functions whose first argument is a pointer to the structure that holds the table.
macro_rules! c_functions {
    (
        $(#[doc = $doc:literal])+
        pub struct $name:ident = $c:literal of $of_type:ident as $of:ident {
            $( $(#[doc = $function_doc:literal])+ fn $function:ident( $($arg:ident : $ty:ty),* ) -> $result:ty; )+
        }
    ) => {
        $(#[doc = $doc])+
        #[repr(C)]
        #[derive(Debug, Clone, Copy)]
        pub struct $name {
            $(
                $(#[doc = $function_doc])+
                pub $function: unsafe extern "C" fn(*const $of_type, $($ty),*) -> $result,
            )+
        }

        #[cfg(test)]
        $crate::tests::header::types::describe_functions! {
            concat!($($doc),+), $name = $c, $of_type as $of,
            $( concat!($($function_doc),+), $function( $($arg: $ty),* ) -> $result; )+
        }
    };
}
pub(crate) use c_functions;
