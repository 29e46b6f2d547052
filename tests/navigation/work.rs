//! The work of the plans of the built-in missions.

use crate::support::Sandbox;

/// Works of all plans of a mission, ascending.
fn works(sandbox: &Sandbox, mission: &str) -> Vec<u64> {
    let words = ["run", mission, "--in-process", "--quiet"];
    let log = ["--log-level", "debug"];
    let outcome = sandbox.protean(words).args(log).run();
    assert_eq!(outcome.code, Some(0), "{outcome}");
    let lines = outcome
        .stderr
        .lines()
        .filter(|line| line.contains("planned"));
    let mut works: Vec<u64> = lines
        .map(|line| {
            let (_, rest) = line.split_once("work ").expect("the work of a plan");
            let (number, _) = rest.split_once(',').expect("more behind it");
            number.parse().expect("a number")
        })
        .collect();
    works.sort_unstable();
    works
}

/// Largest work of a plan: the limit of the optimiser's process (2¹⁸), and the step that exceeds it.
const MAX_WORK: u64 = 265_000;

#[test]
fn a_limit_of_work_ends_every_plan_of_a_mission_and_most_need_little_of_it() {
    let sandbox = Sandbox::new();
    for (mission, least) in [("popup", 2), ("popup_city", 20), ("single_lane", 4)] {
        let works = works(&sandbox, mission);
        assert!(works.len() >= least, "{mission}: {works:?}");
        assert!(works[works.len() - 1] <= MAX_WORK, "{mission}: {works:?}");
        assert!(
            works[works.len() / 2] <= MAX_WORK / 3,
            "{mission}: {works:?}"
        );
    }
}
