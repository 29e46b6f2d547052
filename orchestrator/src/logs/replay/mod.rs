//! A log, played: its messages sent once more, to whoever listens or to processes under test.

mod broadcast;
mod cast;
mod ears;
mod played;
mod player;
mod stage;
mod verify;

pub use played::{ReplayOptions, Replayed};
pub use player::replay;
pub use verify::{Verified, VerifyOptions, verify};
