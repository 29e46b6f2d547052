//! Patrols past fictive temporary obstacles.
