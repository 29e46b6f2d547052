//! Any bytes as a request to the optimiser; what is decoded is planned, for a bounded time, or refused.
#![no_main]

#[path = "support/request.rs"]
mod support;

use ipc_types::messages::optimiser::PlanResponse;
use libfuzzer_sys::{Corpus, fuzz_target};
use optimiser::service;
use optimiser::wire::{decode_request, encode_answer};

fuzz_target!(|bytes: &[u8]| -> Corpus {
    let decoded = support::split(bytes)
        .and_then(|(header, points)| Some((header, decode_request(&header, &points).ok()?)));
    let Some((header, (problem, options))) = decoded else {
        return Corpus::Reject;
    };
    let mut patience = 300;
    let mut stop = || {
        patience -= 1;
        patience <= 0
    };
    let result = service::solve(&problem, &options, None, &mut stop);
    let (response, samples) = encode_answer(&header, &result, 0);
    assert_ne!(response.status, PlanResponse::FAILED);
    assert_eq!(response.is_plan(), !samples.is_empty());
    Corpus::Keep
});
