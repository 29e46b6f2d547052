//! Scenarios and maps compiled into the program, so that it works from any folder.

/// A built-in scenario.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Builtin {
    /// Name to pass to `protean run`.
    pub name: &'static str,
    /// Text of the scenario (TOML).
    pub text: &'static str,
}

impl Builtin {
    /// Returns the path and the text of the map file that the scenario names, if it names one.
    pub fn map(&self) -> Option<(&'static str, &'static str)> {
        let names = |path: &str| self.text.contains(&format!("\nmap = \"{path}\""));
        MAPS.into_iter().find(|(path, _)| names(path))
    }
}

/// Name of the default scenario.
pub const DEFAULT: &str = "chase";

macro_rules! text {
    ($path:expr) => {
        include_str!(concat!("../../../scenarios/", $path, ".toml"))
    };
}

macro_rules! scenarios {
    ($($name:literal),+ $(,)?) => { [$(Builtin { name: $name, text: text!($name) }),+] };
}

/// All built-in scenarios; the default comes first.
pub const SCENARIOS: [Builtin; 23] = scenarios![
    "chase",
    "chase_exact",
    "chase_paper",
    "chase_layouts",
    "chase_braitenberg",
    "chase_rrt_star",
    "chase_popup",
    "chase_referee",
    "chase_reach_avoid",
    "popup",
    "popup_city",
    "single_lane",
    "patrol_octagon",
    "patrol_square",
    "patrol_team",
    "patrol_chase",
    "patrol_intruder",
    "patrol_graph",
    "coverage_open",
    "coverage_case1",
    "coverage_case2",
    "coverage_polygons",
    "hello",
];

/// Built-in maps: path as scenarios write it, and text.
const MAPS: [(&str, &str); 2] = [
    ("maps/city.toml", text!("maps/city")),
    ("maps/hello.toml", text!("maps/hello")),
];

/// Returns the built-in scenario with this name (`chase` or `chase.toml`).
pub fn scenario(name: &str) -> Option<Builtin> {
    let name = name.strip_suffix(".toml").unwrap_or(name);
    SCENARIOS.into_iter().find(|s| s.name == name)
}

/// Returns the built-in map at this path (`maps/city.toml`).
pub fn map(path: &str) -> Option<&'static str> {
    let path = path.strip_prefix("./").unwrap_or(path);
    MAPS.iter().find(|m| m.0 == path).map(|m| m.1)
}

/// Returns the paths of the built-in maps.
pub fn map_names() -> Vec<&'static str> {
    MAPS.iter().map(|m| m.0).collect()
}

/// Returns the names that `map = "builtin:…"` accepts.
pub fn map_stems() -> Vec<&'static str> {
    let stem = |path: &'static str| path.strip_prefix("maps/")?.strip_suffix(".toml");
    MAPS.iter().filter_map(|m| stem(m.0)).collect()
}
