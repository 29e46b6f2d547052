//! Agreement of the processes of a run beyond the checks of iceoryx2: the hash of the messages'
//! layout, an attribute of every service.

use core::fmt::Debug;

use iceoryx2::prelude::{AttributeSpecifier, AttributeVerifier};
use iceoryx2::service::attribute::{AttributeKey, AttributeValue};

use crate::error::BusError;

/// Name of the attribute.
pub const ATTRIBUTE: &str = "protean.schema";

/// The attribute for the creator of the service of a topic.
pub fn define(topic: &'static str, schema: &str) -> Result<AttributeSpecifier, BusError> {
    let failed = |reason: &dyn Debug| BusError::Create {
        topic,
        reason: format!("{reason:?}"),
    };
    let (key, value) = attribute(schema, failed)?;
    let defined = AttributeSpecifier::new().define(&key, &value);
    defined.map_err(|e| failed(&e))
}

/// The required attribute for opening the service of a topic.
pub fn require(topic: &'static str, schema: &str) -> Result<AttributeVerifier, BusError> {
    let failed = |reason: &dyn Debug| BusError::Open {
        topic,
        reason: format!("{reason:?}"),
    };
    let (key, value) = attribute(schema, failed)?;
    let required = AttributeVerifier::new().require(&key, &value);
    required.map_err(|e| failed(&e))
}

fn attribute(
    schema: &str,
    failed: impl Fn(&dyn Debug) -> BusError,
) -> Result<(AttributeKey, AttributeValue), BusError> {
    let key = ATTRIBUTE.try_into().map_err(|e| failed(&e))?;
    let value = schema.try_into().map_err(|e| failed(&e))?;
    Ok((key, value))
}
