//! Conversion of the messages of `optimiser/plan`: requests to problems, plans to answers.

mod decode_request;
mod encode_answer;

pub use decode_request::{RequestError, decode_request};
pub use encode_answer::{Refusal, encode_answer};
