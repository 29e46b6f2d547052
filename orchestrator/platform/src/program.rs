//! The path of the running program.

/// Path that executes the running program, even if its file has been replaced or removed since (by an update,
/// or by a build during a sweep).
pub const THIS: &str = "/proc/self/exe";
