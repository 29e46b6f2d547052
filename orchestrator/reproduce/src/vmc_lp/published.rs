//! The published results.

/// Number of runs of every count of Table 2.
pub(super) const RUNS: u64 = 500;

/// A row of Table 2: two settings of a parameter.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Sensitivity {
    /// The parameter.
    pub parameter: &'static str,
    /// `true` if the report calls it sensitive.
    pub sensitive: bool,
    /// Both settings.
    pub settings: [Setting; 2],
    /// `true` if local pursuit also has the parameter.
    pub of_lp: bool,
}

impl Sensitivity {
    /// Returns the report's word for it.
    pub(super) fn word(&self) -> &'static str {
        if self.sensitive {
            "sensitive"
        } else {
            "less sensitive"
        }
    }
}

/// A setting of Table 2.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Setting {
    /// Name in the experiment.
    pub name: &'static str,
    /// Title in the table.
    pub title: &'static str,
    /// Short name for figures.
    pub short: &'static str,
    /// Number of failed runs of [`RUNS`].
    pub failed: u64,
}

const fn setting(
    name: &'static str,
    title: &'static str,
    short: &'static str,
    failed: u64,
) -> Setting {
    Setting {
        name,
        title,
        short,
        failed,
    }
}

/// Table 2.
pub(super) const TABLE_2: [Sensitivity; 7] = [
    Sensitivity {
        parameter: "control points",
        sensitive: true,
        settings: [
            setting("control_points_5", "5", "5 cp", 29),
            setting("control_points_8", "8", "8 cp", 7),
        ],
        of_lp: true,
    },
    Sensitivity {
        parameter: "degree",
        sensitive: false,
        settings: [
            setting("degree_4", "4", "deg 4", 2),
            setting("degree_6", "6", "deg 6", 5),
        ],
        of_lp: true,
    },
    Sensitivity {
        parameter: "nodes",
        sensitive: true,
        settings: [
            setting("nodes_10", "10", "N 10", 20),
            setting("nodes_15", "15", "N 15", 6),
        ],
        of_lp: true,
    },
    Sensitivity {
        parameter: "reference point",
        sensitive: true,
        settings: [
            setting("reference_1800", "−(1800, 1800) px", "ref 1.8k", 6),
            setting("reference_18000", "−(18000, 18000) px", "ref 18k", 39),
        ],
        of_lp: false,
    },
    Sensitivity {
        parameter: "initial angle",
        sensitive: true,
        settings: [
            setting("angle_0_90", "0 … 90°", "0–90°", 25),
            setting("angle_40_45", "40 … 45°", "40–45°", 6),
        ],
        of_lp: true,
    },
    Sensitivity {
        parameter: "obstacles",
        sensitive: true,
        settings: [
            setting("obstacles_1_10", "1 … 10", "1–10", 2),
            setting("obstacles_30_40", "30 … 40", "30–40", 51),
        ],
        of_lp: true,
    },
    Sensitivity {
        parameter: "radius",
        sensitive: true,
        settings: [
            setting("radius_5_15", "5 … 15 px", "r 5–15", 6),
            setting("radius_20_30", "20 … 30 px", "r 20–30", 125),
        ],
        of_lp: true,
    },
];

/// One test of Tables 3 and 4, with both methods.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Test {
    /// CPU times (s): LP, VMC.
    pub cpu: [f64; 2],
    /// Performance indices, the time to drive (s): LP, VMC.
    pub time: [f64; 2],
}

const fn test(cpu: [f64; 2], time: [f64; 2]) -> Test {
    Test { cpu, time }
}

/// Table 3: one planning horizon.
pub(super) const TABLE_3: [Test; 6] = [
    test([3.69, 8.08], [29.24, 31.56]),
    test([2.16, 3.44], [30.29, 30.23]),
    test([4.81, 32.28], [38.41, 39.54]),
    test([4.72, 5.44], [39.22, 39.54]),
    test([3.11, 5.10], [36.17, 37.18]),
    test([5.03, 9.51], [33.13, 34.07]),
];

/// Table 4, first planning.
pub(super) const TABLE_4_FIRST: [Test; 4] = [
    test([3.29, 9.23], [31.28, 31.83]),
    test([4.25, 6.33], [30.45, 29.79]),
    test([4.05, 6.35], [29.40, 30.78]),
    test([3.97, 6.45], [34.75, 36.13]),
];

/// Table 4, second planning.
pub(super) const TABLE_4_SECOND: [Test; 4] = [
    test([2.67, 8.42], [20.41, 22.05]),
    test([2.41, 4.15], [19.23, 18.39]),
    test([2.78, 6.81], [18.80, 20.64]),
    test([2.07, 4.69], [21.82, 22.38]),
];
