//! A log, played: its messages sent once more, to whoever listens or to processes under test.

mod broadcast;
mod cast;
mod deviation;
mod ears;
mod keys;
mod pace;
mod played;
mod player;
mod screen;
mod source;
mod stage;
mod terminal;
mod verify;

pub use deviation::Deviation;
pub use pace::Spread;
pub use played::{ReplayOptions, Replayed};
pub use player::replay;
pub use verify::{TopicVerdict, Verified, VerifyOptions, verify};
