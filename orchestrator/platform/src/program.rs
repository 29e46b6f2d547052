//! This program, to be started again.

/// Path that executes the program that is running, also when its file has been replaced or removed since
/// (by an update, or a build in the middle of a sweep).
pub const THIS: &str = "/proc/self/exe";
