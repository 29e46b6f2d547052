//! A network, ready to evaluate.

use prost::Message;

use crate::MAX_FILE;
use crate::compile::compile;
use crate::error::{EvaluationError, NetworkError};
use crate::proto::Model;
use crate::step::Step;

/// A network with one input and one output of fixed length.
///
/// An evaluation allocates nothing. Its result is a function of file and input alone, with the same bits on every
/// machine.
#[derive(Debug, Clone, PartialEq)]
pub struct Network {
    pub(crate) steps: Vec<Step>,
    /// Constants, the input and the results of steps.
    pub(crate) values: Vec<Vec<f32>>,
    pub(crate) input: usize,
    pub(crate) output: usize,
}

impl Network {
    /// Reads the contents of an ONNX file. A dimension with a name (`batch`) has length 1.
    ///
    /// # Errors
    /// [`NetworkError`] names the first part of the file that is not supported, and what is.
    pub fn from_onnx(file: &[u8]) -> Result<Self, NetworkError> {
        if file.len() > MAX_FILE {
            return Err(NetworkError::TooLarge { bytes: file.len() });
        }
        compile(&Model::decode(file).map_err(NetworkError::Decode)?)
    }

    /// Returns the length of the input.
    pub fn input_length(&self) -> usize {
        self.values.get(self.input).map_or(0, Vec::len)
    }

    /// Returns the length of the output.
    pub fn output_length(&self) -> usize {
        self.values.get(self.output).map_or(0, Vec::len)
    }

    /// Computes the output for an input.
    ///
    /// # Errors
    /// [`EvaluationError`] if the input has another length, or the output is not finite.
    pub fn evaluate(&mut self, input: &[f32]) -> Result<&[f32], EvaluationError> {
        let expected = self.input_length();
        match self.values.get_mut(self.input) {
            Some(own) if own.len() == input.len() => own.copy_from_slice(input),
            _ => {
                let found = input.len();
                return Err(EvaluationError::InputLength { found, expected });
            }
        }
        for step in &self.steps {
            // The result of a step is none of its operands.
            let mut result = self
                .values
                .get_mut(step.result)
                .map_or_else(Vec::new, core::mem::take);
            let operand = |i: usize| {
                let place = step.operands.get(i);
                let value = place.and_then(|&place| self.values.get(place));
                value.map_or(&[][..], Vec::as_slice)
            };
            step.operation.compute(operand, &mut result);
            if let Some(place) = self.values.get_mut(step.result) {
                *place = result;
            }
        }
        let output = self.values.get(self.output).map_or(&[][..], Vec::as_slice);
        match output.iter().position(|value| !value.is_finite()) {
            None => Ok(output),
            Some(index) => {
                let value = output.get(index).copied().unwrap_or(f32::NAN);
                Err(EvaluationError::Output { index, value })
            }
        }
    }
}
