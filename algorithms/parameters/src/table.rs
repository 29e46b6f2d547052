//! Declaration of tables and choices of a scenario.

/// Declares tables of parameters: structs whose unknown keys are errors and whose absent keys have defaults.
///
/// A field has a type, then its range and unit in brackets ([`Bounds`](crate::Bounds)), then its default; without one,
/// the [`Default`] of its type. The struct derives `Debug`, `Clone`, `PartialEq`, `Serialize`, `Deserialize` and
/// `JsonSchema`; other attributes stand above it as usual.
#[macro_export]
macro_rules! table {
    (@default) => { Default::default() };
    (@default $default:expr) => { $default };
    (
        $(#[$attribute:meta])*
        $visibility:vis struct $name:ident {$(
            $(#[$field_attribute:meta])*
            $field_visibility:vis $field:ident: $type:ty $([$bounds:expr])? $(= $default:expr)?
        ),* $(,)?}
    ) => {
        $(#[$attribute])*
        #[derive(Debug, Clone, PartialEq, ::serde::Serialize, ::serde::Deserialize, ::schemars::JsonSchema)]
        #[serde(deny_unknown_fields, default)]
        $visibility struct $name {$(
            $(#[$field_attribute])*
            $(#[schemars(transform = $bounds)])?
            $field_visibility $field: $type,
        )*}

        impl Default for $name {
            fn default() -> Self {
                Self { $($field: $crate::table!(@default $($default)?)),* }
            }
        }
    };
}

/// Declares a choice: an enum whose variants are written as their names in `snake_case`.
///
/// It derives `Debug`, `Clone`, `Copy`, `PartialEq`, `Eq`, `Default`, `Serialize`, `Deserialize` and `JsonSchema`;
/// `#[default]` marks the default.
#[macro_export]
macro_rules! choice {
    (
        $(#[$attribute:meta])*
        $visibility:vis enum $name:ident {$(
            $(#[$variant_attribute:meta])* $variant:ident
        ),* $(,)?}
    ) => {
        $(#[$attribute])*
        #[derive(
            Debug, Clone, Copy, PartialEq, Eq, Default,
            ::serde::Serialize, ::serde::Deserialize, ::schemars::JsonSchema,
        )]
        #[serde(rename_all = "snake_case")]
        $visibility enum $name {$(
            $(#[$variant_attribute])* $variant,
        )*}
    };
}
