//! Agreement of the processes of a run beyond the checks of iceoryx2: the hash of the messages'
//! layout, an attribute of every service.

use iceoryx2::prelude::{AttributeSpecifier, AttributeVerifier};
use iceoryx2::service::attribute::{AttributeKey, AttributeValue};

/// Name of the attribute.
pub(crate) const ATTRIBUTE: &str = "protean.schema";

/// The attribute for the creator of a service.
pub(crate) fn define(fingerprint: &str) -> Result<AttributeSpecifier, String> {
    let (key, value) = attribute(fingerprint)?;
    AttributeSpecifier::new()
        .define(&key, &value)
        .map_err(|e| format!("{e:?}"))
}

/// The required attribute for opening a service.
pub(crate) fn require(fingerprint: &str) -> Result<AttributeVerifier, String> {
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
