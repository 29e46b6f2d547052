//! Constants of a file.

use crate::error::NetworkError;
use crate::node::shown;
use crate::proto::TensorProto;
use crate::{MAX_RANK, MAX_VALUES};

/// Number of the element type `float` in a file.
pub const FLOAT: i32 = 1;
/// Number of the element type `int64` in a file.
const INT64: i32 = 7;
/// Value of `data_location` for data in another file.
const EXTERNAL: i32 = 1;

/// Elements of a constant.
#[derive(Debug, Clone, PartialEq)]
pub enum Elements {
    /// Weights and bounds.
    Floats(Vec<f32>),
    /// Shapes.
    Integers(Vec<i64>),
}

/// A constant.
#[derive(Debug, Clone, PartialEq)]
pub struct Tensor {
    pub(crate) shape: Vec<usize>,
    pub(crate) elements: Elements,
}

/// Returns the number of elements of a shape; `None` if its rank or size is beyond the limits.
pub fn size(shape: &[usize]) -> Option<usize> {
    let count = shape
        .iter()
        .try_fold(1_usize, |count, &dim| count.checked_mul(dim))?;
    (shape.len() <= MAX_RANK && count <= MAX_VALUES).then_some(count)
}

/// Reads a constant.
///
/// # Errors
/// [`NetworkError::Constant`] names the constant.
pub fn read(proto: &TensorProto, name: &str) -> Result<Tensor, NetworkError> {
    let refused = |found: String, expected: &str| NetworkError::Constant {
        name: shown(name),
        found,
        expected: expected.to_owned(),
    };
    if proto.data_location == EXTERNAL {
        return Err(refused(
            "its values are in another file".to_owned(),
            "values in the file itself",
        ));
    }
    let shape: Option<Vec<usize>> = proto
        .dims
        .iter()
        .map(|&dim| usize::try_from(dim).ok())
        .collect();
    let shape = shape.filter(|shape| size(shape).is_some());
    let Some(shape) = shape else {
        let dims = proto.dims.get(..=MAX_RANK).unwrap_or(&proto.dims);
        let expected = format!("up to {MAX_RANK} dimensions and {MAX_VALUES} values");
        return Err(refused(format!("its shape is {dims:?}"), &expected));
    };
    let raw = &proto.raw_data;
    let elements = match proto.data_type {
        FLOAT if raw.is_empty() => Elements::Floats(proto.float_data.clone()),
        FLOAT => {
            let (words, rest) = raw.as_chunks::<4>();
            if !rest.is_empty() {
                let found = format!("it has {} bytes", raw.len());
                return Err(refused(found, "four bytes for each value"));
            }
            Elements::Floats(words.iter().map(|word| f32::from_le_bytes(*word)).collect())
        }
        INT64 if raw.is_empty() => Elements::Integers(proto.int64_data.clone()),
        INT64 => {
            let (words, rest) = raw.as_chunks::<8>();
            if !rest.is_empty() {
                let found = format!("it has {} bytes", raw.len());
                return Err(refused(found, "eight bytes for each value"));
            }
            Elements::Integers(words.iter().map(|word| i64::from_le_bytes(*word)).collect())
        }
        other => {
            let found = format!("its element type is number {other}");
            return Err(refused(found, "float (1), or int64 (7) of a shape"));
        }
    };
    let count = match &elements {
        Elements::Floats(values) => values.len(),
        Elements::Integers(values) => values.len(),
    };
    if Some(count) != size(&shape) {
        let found = format!("it has {count} values");
        return Err(refused(found, &format!("those of the shape {shape:?}")));
    }
    if let Elements::Floats(values) = &elements
        && let Some(value) = values.iter().find(|value| !value.is_finite())
    {
        return Err(refused(format!("it contains {value}"), "finite numbers"));
    }
    Ok(Tensor { shape, elements })
}
