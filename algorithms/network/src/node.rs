//! A node of a graph: its name, inputs and attributes.

use crate::error::NetworkError;
use crate::proto::{Attribute, NodeProto};

/// Maximum number of characters of a name in an error.
const MAX_SHOWN: usize = 80;

/// Returns a name from a file for an error: without control characters, and not too long.
pub fn shown(name: &str) -> String {
    let characters = name.chars().take(MAX_SHOWN);
    characters.flat_map(char::escape_debug).collect()
}

/// A node, for reading with errors that name it.
#[derive(Debug, Clone, Copy)]
pub struct Node<'a>(pub(crate) &'a NodeProto);

impl<'a> Node<'a> {
    /// Its name, or that of its output.
    pub(crate) fn name(self) -> String {
        let first = self.0.output.first().map_or("", String::as_str);
        let name = if self.0.name.is_empty() {
            first
        } else {
            self.0.name.as_str()
        };
        shown(name)
    }

    /// Its operator, with its domain if that is not the standard one.
    pub(crate) fn operator(self) -> String {
        match self.0.domain.as_str() {
            "" | "ai.onnx" => shown(&self.0.op_type),
            domain => shown(&format!("{domain}.{}", self.0.op_type)),
        }
    }

    /// The error of one of its parts.
    pub(crate) fn refused(
        self,
        found: impl Into<String>,
        expected: impl Into<String>,
    ) -> NetworkError {
        NetworkError::Node {
            node: self.name(),
            operator: self.operator(),
            found: found.into(),
            expected: expected.into(),
        }
    }

    /// The name of an input, if the node has it.
    pub(crate) fn input(self, index: usize) -> Option<&'a str> {
        let name = self.0.input.get(index)?;
        (!name.is_empty()).then_some(name.as_str())
    }

    /// Checks that the node has only these attributes.
    pub(crate) fn check_attributes(self, known: &[&str]) -> Result<(), NetworkError> {
        let mut attributes = self.0.attribute.iter();
        match attributes.find(|attribute| !known.contains(&attribute.name.as_str())) {
            None => Ok(()),
            Some(attribute) if known.is_empty() => Err(self.refused(
                format!("it has the attribute `{}`", shown(&attribute.name)),
                "none",
            )),
            Some(attribute) => Err(self.refused(
                format!("it has the attribute `{}`", shown(&attribute.name)),
                format!("one of {}", known.join(", ")),
            )),
        }
    }

    /// An attribute, if the node has it.
    pub(crate) fn attribute(self, name: &str) -> Option<&'a Attribute> {
        self.0
            .attribute
            .iter()
            .find(|attribute| attribute.name == name)
    }

    /// An integer attribute.
    pub(crate) fn integer(self, name: &str, default: i64) -> i64 {
        self.attribute(name).and_then(|a| a.i).unwrap_or(default)
    }

    /// A real attribute, which is finite.
    pub(crate) fn real(self, name: &str, default: f32) -> Result<f32, NetworkError> {
        let value = self.attribute(name).and_then(|a| a.f).unwrap_or(default);
        if value.is_nan() {
            return Err(self.refused(format!("`{name}` is {value}"), "a number"));
        }
        Ok(value)
    }

    /// Resolves an axis, which counts from the end if it is negative; at most `last`.
    pub(crate) fn axis(
        self,
        default: i64,
        rank: usize,
        last: usize,
    ) -> Result<usize, NetworkError> {
        let axis = self.integer("axis", default);
        let from_start = if axis < 0 {
            axis.checked_add_unsigned(rank as u64)
        } else {
            Some(axis)
        };
        from_start
            .and_then(|axis| usize::try_from(axis).ok())
            .filter(|&axis| axis <= last)
            .ok_or_else(|| {
                self.refused(
                    format!("`axis` is {axis}"),
                    format!("an axis of {rank} dimensions"),
                )
            })
    }
}
