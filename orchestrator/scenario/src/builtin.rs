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

/// All built-in scenarios; the default comes first.
pub const SCENARIOS: [Builtin; 19] = [
    Builtin {
        name: "chase",
        text: include_str!("../../../scenarios/chase.toml"),
    },
    Builtin {
        name: "chase_exact",
        text: include_str!("../../../scenarios/chase_exact.toml"),
    },
    Builtin {
        name: "chase_paper",
        text: include_str!("../../../scenarios/chase_paper.toml"),
    },
    Builtin {
        name: "chase_layouts",
        text: include_str!("../../../scenarios/chase_layouts.toml"),
    },
    Builtin {
        name: "chase_braitenberg",
        text: include_str!("../../../scenarios/chase_braitenberg.toml"),
    },
    Builtin {
        name: "chase_rrt_star",
        text: include_str!("../../../scenarios/chase_rrt_star.toml"),
    },
    Builtin {
        name: "chase_popup",
        text: include_str!("../../../scenarios/chase_popup.toml"),
    },
    Builtin {
        name: "chase_referee",
        text: include_str!("../../../scenarios/chase_referee.toml"),
    },
    Builtin {
        name: "chase_reach_avoid",
        text: include_str!("../../../scenarios/chase_reach_avoid.toml"),
    },
    Builtin {
        name: "popup",
        text: include_str!("../../../scenarios/popup.toml"),
    },
    Builtin {
        name: "popup_city",
        text: include_str!("../../../scenarios/popup_city.toml"),
    },
    Builtin {
        name: "single_lane",
        text: include_str!("../../../scenarios/single_lane.toml"),
    },
    Builtin {
        name: "patrol_octagon",
        text: include_str!("../../../scenarios/patrol_octagon.toml"),
    },
    Builtin {
        name: "patrol_square",
        text: include_str!("../../../scenarios/patrol_square.toml"),
    },
    Builtin {
        name: "coverage_open",
        text: include_str!("../../../scenarios/coverage_open.toml"),
    },
    Builtin {
        name: "coverage_case1",
        text: include_str!("../../../scenarios/coverage_case1.toml"),
    },
    Builtin {
        name: "coverage_case2",
        text: include_str!("../../../scenarios/coverage_case2.toml"),
    },
    Builtin {
        name: "coverage_polygons",
        text: include_str!("../../../scenarios/coverage_polygons.toml"),
    },
    Builtin {
        name: "hello",
        text: include_str!("../../../scenarios/hello.toml"),
    },
];

/// Built-in maps: path as scenarios write it, and text.
const MAPS: [(&str, &str); 2] = [
    (
        "maps/city.toml",
        include_str!("../../../scenarios/maps/city.toml"),
    ),
    (
        "maps/hello.toml",
        include_str!("../../../scenarios/maps/hello.toml"),
    ),
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
