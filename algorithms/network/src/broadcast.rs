//! Broadcasting of shapes, as in ONNX.

/// Returns the shape of the result of two operands, if they fit.
pub fn shape(left: &[usize], right: &[usize]) -> Option<Vec<usize>> {
    let rank = left.len().max(right.len());
    (0..rank)
        .map(
            |axis| match (dim(left, rank, axis), dim(right, rank, axis)) {
                (a, b) if a == b => Some(a),
                (1, other) | (other, 1) => Some(other),
                _ => None,
            },
        )
        .collect()
}

/// Returns, for each element of the result, the index of the element of an operand; `None` if they are the same.
pub fn indices(operand: &[usize], result: &[usize]) -> Option<Vec<u32>> {
    let count: usize = result.iter().product();
    if operand.iter().product::<usize>() == count {
        return None;
    }
    let rank = result.len();
    let of_element = |mut element: usize| {
        let mut index = 0;
        let mut stride = 1;
        for axis in (0..rank).rev() {
            let length = result.get(axis).copied().unwrap_or(1).max(1);
            let at = element % length;
            element /= length;
            let own = dim(operand, rank, axis);
            if own > 1 {
                index += at * stride;
                stride *= own;
            }
        }
        u32::try_from(index).unwrap_or(u32::MAX)
    };
    Some((0..count).map(of_element).collect())
}

/// The length of an axis, of a shape that is extended to `rank` by ones in front.
fn dim(shape: &[usize], rank: usize, axis: usize) -> usize {
    let missing = rank - shape.len();
    axis.checked_sub(missing)
        .and_then(|axis| shape.get(axis).copied())
        .unwrap_or(1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shapes_are_extended_in_front_and_ones_repeat() {
        assert_eq!(shape(&[2, 3], &[3]), Some(vec![2, 3]));
        assert_eq!(shape(&[2, 1], &[1, 3]), Some(vec![2, 3]));
        assert_eq!(shape(&[], &[4]), Some(vec![4]));
        assert_eq!(shape(&[2], &[3]), None);
    }

    #[test]
    fn indices_repeat_the_elements_of_the_smaller_operand() {
        assert_eq!(indices(&[3], &[2, 3]), Some(vec![0, 1, 2, 0, 1, 2]));
        assert_eq!(indices(&[2, 1], &[2, 3]), Some(vec![0, 0, 0, 1, 1, 1]));
        assert_eq!(indices(&[], &[2]), Some(vec![0, 0]));
        assert_eq!(indices(&[1, 3], &[3]), None);
    }
}
