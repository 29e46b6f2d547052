//! Scenarios of robots that programs of a user's own drive.

use super::PROTEAN;

/// The lines of an external program that is the process of a built-in kind.
pub fn as_program(kind: &str, params: &str) -> String {
    let script = format!("exec '{PROTEAN}' process {kind} --config \\\"$PROTEAN_CONFIG\\\"");
    format!("command = [\"/bin/sh\", \"-c\", \"{script}\"]\nparams = {params}")
}

/// A scenario with one robot and the process that drives it, whose lines, after its name, are `lines`.
pub fn driven_by(name: &str, lines: &str) -> String {
    format!(
        r#"
[world]
map = "builtin:hello"
[rules]
time_limit = 5.0
[[robots]]
name = "robot"
team = "neutral"
start = {{ x = 0.5, y = 0.5, theta = 0.0 }}
[[processes]]
name = "{name}"
robots = ["robot"]
{lines}
"#
    )
}
