//! Names of temporary files and directories.

/// Returns the beginning of a temporary name, to be completed by random characters, that no other process gives: copies of a
/// process draw the same random characters, and what removes the remains of one must not meet a file of another. In other PID
/// namespaces the random characters differ.
pub fn own_name(beginning: &str) -> String {
    format!("{beginning}{}_", std::process::id())
}
