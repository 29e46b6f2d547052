//! A network, ready to evaluate.

use prost::Message;

use crate::MAX_FILE;
use crate::compile::{CompiledNetwork, compile};
use crate::error::{EvaluationError, NetworkError};
use crate::proto::Model;

/// A network with one input and one output of fixed length.
///
/// An evaluation allocates nothing. Its result is a function of file and input alone, with the same bits on every
/// machine.
#[derive(Debug, Clone, PartialEq)]
pub struct Network(CompiledNetwork);

impl Network {
    /// Reads the contents of an ONNX file. A dimension with a name (`batch`) has length 1.
    ///
    /// # Errors
    /// [`NetworkError`] names the first part of the file that is not supported, and what is.
    pub fn from_onnx(file: &[u8]) -> Result<Self, NetworkError> {
        if file.len() > MAX_FILE {
            return Err(NetworkError::TooLarge { bytes: file.len() });
        }
        compile(&Model::decode(file).map_err(NetworkError::Decode)?).map(Self)
    }

    /// Returns the length of the input.
    pub fn input_length(&self) -> usize {
        self.0.values.get(self.0.input).map_or(0, Vec::len)
    }

    /// Returns the length of the output.
    pub fn output_length(&self) -> usize {
        self.0.values.get(self.0.output).map_or(0, Vec::len)
    }

    /// Computes the output for an input.
    ///
    /// # Errors
    /// [`EvaluationError`] if the input has another length, or the output is not finite.
    pub fn evaluate(&mut self, input: &[f32]) -> Result<&[f32], EvaluationError> {
        let expected = self.input_length();
        let CompiledNetwork {
            steps,
            values,
            input: own,
            output,
        } = &mut self.0;
        match values.get_mut(*own) {
            Some(own) if own.len() == input.len() => own.copy_from_slice(input),
            _ => {
                let found = input.len();
                return Err(EvaluationError::InputLength { found, expected });
            }
        }
        for step in steps {
            // The result of a step is none of its operands.
            let mut result = values
                .get_mut(step.result)
                .map_or_else(Vec::new, core::mem::take);
            let operand = |i: usize| {
                let place = step.operands.get(i);
                let value = place.and_then(|&place| values.get(place));
                value.map_or(&[][..], Vec::as_slice)
            };
            step.operation.compute(operand, &mut result);
            if let Some(place) = values.get_mut(step.result) {
                *place = result;
            }
        }
        let output = values.get(*output).map_or(&[][..], Vec::as_slice);
        match output.iter().position(|value| !value.is_finite()) {
            None => Ok(output),
            Some(index) => {
                let value = output.get(index).copied().unwrap_or(f32::NAN);
                Err(EvaluationError::Output { index, value })
            }
        }
    }
}
