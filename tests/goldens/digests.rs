//! The simulated history of every built-in scenario: bit for bit the same on any machine and in any version.

use std::fmt::Write as _;

use crate::support::Sandbox;
use crate::support::call::PATIENCE;
use scenario::builtin::SCENARIOS;

const FILE: &str = "digests.txt";
const SEEDS: [&str; 2] = ["1", "2"];

/// One line per scenario and seed: name, seed, digest.
fn digests(seeds: &[&str], in_process: bool) -> String {
    let sandbox = Sandbox::new();
    let mut lines = String::new();
    for scenario in SCENARIOS {
        for seed in seeds {
            let mut call =
                sandbox.protean(["run", scenario.name, "--seed", *seed, "--quiet", "--json"]);
            call = if in_process {
                call.arg("--in-process")
            } else {
                call.set(PATIENCE)
                    .arg("--force")
                    .arg("--out")
                    .arg("run.mcap")
            };
            let outcome = call.run();
            assert_eq!(outcome.code, Some(0), "{outcome}");
            let summary = outcome.json();
            writeln!(
                lines,
                "{} {seed} {}",
                scenario.name,
                summary["digest"].as_str().unwrap()
            )
            .unwrap();
        }
    }
    lines
}

// Each of the two takes about a minute on one core: whole missions are what is promised, and a
// history that differs only late would pass a shorter one.
#[test]
fn digests_in_one_process() {
    super::compare(FILE, &digests(&SEEDS, true));
}

#[test]
fn digests_with_processes() {
    let golden = super::golden(FILE);
    for line in digests(&SEEDS[..1], false).lines() {
        assert!(
            golden.lines().any(|known| known == line),
            "{line}: not in goldens/{FILE}"
        );
    }
}
