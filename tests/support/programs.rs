//! Scenarios of robots that programs of a user's own drive.

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
