//! The JSON Schema of a type, generated once.

use std::any::TypeId;
use std::collections::BTreeMap;
use std::sync::{Mutex, OnceLock, PoisonError};

use schemars::JsonSchema;
use schemars::generate::SchemaSettings;
use serde_json::Value;

/// The schema of a type in one piece, without references.
pub fn inline<P: JsonSchema + 'static>() -> &'static Value {
    static MADE: OnceLock<Mutex<BTreeMap<TypeId, &'static Value>>> = OnceLock::new();
    let made = MADE.get_or_init(Mutex::default);
    // The map is complete whenever the lock is free: a schema enters it after its generation.
    let mut made = made.lock().unwrap_or_else(PoisonError::into_inner);
    made.entry(TypeId::of::<P>()).or_insert_with(|| {
        let settings = SchemaSettings::draft2020_12().with(|s| s.inline_subschemas = true);
        let schema = settings.into_generator().into_root_schema_for::<P>();
        // One per type of the program: it lives as long as the program.
        Box::leak(Box::new(schema.to_value()))
    })
}
