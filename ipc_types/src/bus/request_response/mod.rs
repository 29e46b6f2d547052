//! Request–response services.

mod client;
mod server;

pub use client::{Client, PendingResponse};
pub use server::{ActiveRequest, Attendant, Server};

use crate::message::{Descriptor, Message};
use crate::topics::Service;

/// Fingerprint of the messages' layout.
pub fn layout<S: Service>() -> String {
    let size = |d: Descriptor| format!("{}:{}", d.name, d.fields.len());
    let parts = [
        size(S::RequestHeader::DESCRIPTOR),
        size(S::RequestElement::DESCRIPTOR),
        size(S::ResponseHeader::DESCRIPTOR),
        size(S::ResponseElement::DESCRIPTOR),
    ];
    blake3::hash(parts.join(",").as_bytes()).to_hex()[..16].to_owned()
}
