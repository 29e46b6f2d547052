//! Limits of the shell that make runs fail.

use rustix::process::{Resource, getrlimit};

/// Returns a sentence that names the limits of file sizes and of memory that are in force; `None` without any.
pub fn in_force() -> Option<String> {
    let limits = [
        (Resource::Fsize, "of files to", "ulimit -f"),
        (Resource::As, "of memory to", "ulimit -v"),
    ];
    let named = limits.iter().filter_map(|(resource, what, command)| {
        let bytes = getrlimit(*resource).current?;
        Some(format!("{what} {} kB (`{command}`)", bytes / 1000))
    });
    let named: Vec<String> = named.collect();
    (!named.is_empty()).then(|| format!("the shell limits the size {}", named.join(" and ")))
}
