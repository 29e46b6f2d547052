//! A scenario and what is set beside it, in one text.

/// The lines that begin with `--set `, without it, and the others.
pub fn split(text: &str) -> (Vec<String>, String) {
    let (overrides, lines): (Vec<&str>, Vec<&str>) =
        text.lines().partition(|line| line.starts_with("--set "));
    let overrides = overrides.iter().map(|line| line[6..].to_owned()).collect();
    (overrides, lines.join("\n"))
}
