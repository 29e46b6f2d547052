//! Process of the Police: connects [`pursuit_evasion::pursuit`] to its topics.

pub mod process;
