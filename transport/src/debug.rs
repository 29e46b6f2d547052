//! `Debug` of types that hold ports.

/// Implements `Debug` for a type that holds what cannot be shown, by its name and one value of it. Its generic
/// parameters stand in brackets.
#[macro_export]
macro_rules! debug_with {
    ([$($generics:tt)*] $type:ty, $own:pat => $value:expr) => {
        impl<$($generics)*> ::core::fmt::Debug for $type {
            fn fmt(&self, f: &mut ::core::fmt::Formatter<'_>) -> ::core::fmt::Result {
                let $own = self;
                f.debug_tuple(stringify!($type)).field(&$value).finish_non_exhaustive()
            }
        }
    };
}
