//! Any bytes as a request: header first, points behind. It is decoded or refused; what is decoded is
//! planned, for a bounded time, or refused.
#![no_main]

use ipc_types::messages::optimiser::{PlanRequest, PlanResponse};
use ipc_types::messages::world::ShapePoint;
use libfuzzer_sys::fuzz_target;
use optimiser::answer::{self, Refusal};
use optimiser::{request, service};
use zerocopy::FromBytes;

/// Points beyond these only make it slow.
const MAX_POINTS: usize = 64;

fuzz_target!(|bytes: &[u8]| {
    let Ok((header, rest)) = PlanRequest::read_from_prefix(bytes) else {
        return;
    };
    let (chunks, _) = rest.as_chunks::<{ size_of::<ShapePoint>() }>();
    let points: Vec<ShapePoint> = chunks
        .iter()
        .take(MAX_POINTS)
        .filter_map(|chunk| ShapePoint::read_from_bytes(chunk).ok())
        .collect();
    let mut patience = 50;
    let mut stop = || {
        patience -= 1;
        patience <= 0
    };
    let result = request::decode(&header, &points)
        .map_err(Refusal::from)
        .and_then(|(problem, options)| service::solve(&problem, &options, None, &mut stop));
    let (response, samples) = answer::encode(&header, &result, 0);
    assert_ne!(response.status, PlanResponse::FAILED);
    assert_eq!(response.is_plan(), !samples.is_empty());
});
