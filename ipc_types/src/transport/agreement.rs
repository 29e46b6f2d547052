//! What the processes of a run agree on beyond what iceoryx2 compares by itself: the fingerprint of
//! the messages' layout, an attribute of every service.

use iceoryx2::prelude::{AttributeSpecifier, AttributeVerifier};
use iceoryx2::service::attribute::{AttributeKey, AttributeValue};

/// The attribute's name.
pub(super) const ATTRIBUTE: &str = "protean.schema";

/// For whoever creates a service.
pub(super) fn define(fingerprint: &str) -> Result<AttributeSpecifier, String> {
    let (key, value) = attribute(fingerprint)?;
    AttributeSpecifier::new()
        .define(&key, &value)
        .map_err(|e| format!("{e:?}"))
}

/// For whoever opens one.
pub(super) fn require(fingerprint: &str) -> Result<AttributeVerifier, String> {
    let (key, value) = attribute(fingerprint)?;
    AttributeVerifier::new()
        .require(&key, &value)
        .map_err(|e| format!("{e:?}"))
}

fn attribute(fingerprint: &str) -> Result<(AttributeKey, AttributeValue), String> {
    Ok((
        ATTRIBUTE.try_into().map_err(|e| format!("{e:?}"))?,
        fingerprint.try_into().map_err(|e| format!("{e:?}"))?,
    ))
}
