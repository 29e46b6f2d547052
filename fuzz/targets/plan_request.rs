//! Any bytes as a request to the optimiser: it is decoded, within its ranges, or refused.
#![no_main]

#[path = "support/request.rs"]
mod support;

use ipc_types::messages::optimiser::PlanResponse;
use libfuzzer_sys::fuzz_target;
use optimiser::wire::{Refusal, decode_request, encode_answer};

fuzz_target!(|bytes: &[u8]| {
    let Some((header, points)) = support::split(bytes) else {
        return;
    };
    match decode_request(&header, &points) {
        Ok((problem, options)) => {
            assert!(problem.validate().is_ok() && options.validate().is_ok());
            assert_eq!(problem.obstacles.len(), header.shapes as usize);
        }
        Err(error) => {
            let (response, samples) = encode_answer(&header, &Err(Refusal::from(error)), 0);
            assert_eq!(response.status, PlanResponse::INVALID);
            assert!(samples.is_empty() && !response.reason_text().is_empty());
        }
    }
});
