//! A log, played: its messages sent once more, to whoever listens or to processes under test.

mod keys;
mod pace;
mod player;
mod screen;
mod source;
mod stage;

pub use pace::Spread;
pub use player::{ReplayOptions, Replayed, replay};
