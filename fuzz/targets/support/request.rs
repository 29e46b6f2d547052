//! Bytes as they come to the optimiser: header first, points behind.

use ipc_types::messages::optimiser::PlanRequest;
use ipc_types::messages::world::ShapePoint;
use zerocopy::FromBytes;

/// Points beyond these only make it slow.
const MAX_POINTS: usize = 64;

/// The header and the points; `None` if the bytes are fewer than a header.
pub fn split(bytes: &[u8]) -> Option<(PlanRequest, Vec<ShapePoint>)> {
    let (header, rest) = PlanRequest::read_from_prefix(bytes).ok()?;
    let (chunks, _) = rest.as_chunks::<{ size_of::<ShapePoint>() }>();
    let points = chunks
        .iter()
        .take(MAX_POINTS)
        .filter_map(|chunk| ShapePoint::read_from_bytes(chunk).ok())
        .collect();
    Some((header, points))
}
