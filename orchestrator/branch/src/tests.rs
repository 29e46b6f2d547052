use std::path::{Path, PathBuf};

use mcap_log::ReadProgress;
use mission::in_process::{InProcessOptions, run};
use replay::lineage::Change;
use replay::{RerunOptions, rerun};

use crate::{BranchReport, DecidedReport, Decision, Moment, OutcomeShare, Parent, RobotShares};

/// Records a mission into a folder; returns its log.
fn record(folder: &Path, name: &str, set: &[&str]) -> PathBuf {
    let log = folder.join(format!("{name}.mcap"));
    let set: Vec<String> = set.iter().map(|&text| text.to_owned()).collect();
    let options = InProcessOptions {
        out: Some(log.clone()),
        ..InProcessOptions::default()
    };
    run(&kinds::load(name, &set, Some(1)).unwrap(), &options).unwrap();
    log
}

fn read(log: &Path) -> Parent {
    Parent::read(log, kinds::KINDS, false, &mut ReadProgress::default()).unwrap()
}

fn branch(parent: &Parent, at_s: f64, change: &Change, out: &Path) -> BranchReport {
    let tick = parent.tick(at_s).unwrap();
    let mut watch = ReadProgress::default();
    parent
        .branch(tick, change, Some(out), true, &mut watch)
        .unwrap()
}

fn strings(texts: &[&str]) -> Vec<String> {
    texts.iter().map(|&text| text.to_owned()).collect()
}

#[test]
fn a_branch_is_its_parent_before_the_moment_and_can_be_repeated_and_branched() {
    let folder = tempfile::tempdir().unwrap();
    let log = record(folder.path(), "chase", &["rules.time_limit=8"]);
    let parent = read(&log);
    let out = folder.path().join("branch.mcap");
    let nothing = branch(&parent, 3.0, &Change::default(), &out);
    assert_eq!(Some(&nothing.branch_digest), parent.info.digest.as_ref());
    let changes = [
        Change {
            command: strings(&["police_1=-0.1,0.5"]),
            for_s: Some(1.0),
            ..Change::default()
        },
        Change {
            set: strings(&["teams.police.limits.v_max=0.1"]),
            ..Change::default()
        },
        Change {
            set: strings(&["processes.perception.params.filter.particles=50"]),
            ..Change::default()
        },
        Change {
            replace: strings(&["evader_potential_evader_1=evader_reach_avoid"]),
            ..Change::default()
        },
        Change {
            reseed: strings(&["all"]),
            seed: 3,
            ..Change::default()
        },
        Change {
            place: strings(&["police_1=1.5,1.5,0.5", "police_2=-4.5,-1.5"]),
            ..Change::default()
        },
        Change {
            draw: strings(&["teams.police.limits.v_max=0.04..0.06"]),
            seed: 3,
            ..Change::default()
        },
    ];
    for change in &changes {
        let done = branch(&parent, 3.0, change, &out);
        assert!(
            done.same && done.messages > 100,
            "{change:?}: {:?}",
            done.comparison.first
        );
        assert_ne!(done.branch_digest, nothing.branch_digest, "{change:?}");
        let mut watch = ReadProgress::default();
        let first = diff::diff(&log, &out, &mut watch).unwrap().comparison.first;
        let tick = first.unwrap().tick();
        assert!(tick >= parent.tick(3.0).unwrap(), "{change:?}: tick {tick}");
        // The log alone is enough to execute it again, and to branch it.
        let again = rerun(&out, kinds::KINDS, RerunOptions::default(), &mut watch).unwrap();
        assert!(again.same && again.whole, "{change:?}");
        let child = folder.path().join("child.mcap");
        let more = branch(&read(&out), 5.0, &changes[4], &child);
        assert!(more.same, "{change:?}: {:?}", more.comparison.first);
        let again = rerun(&child, kinds::KINDS, RerunOptions::default(), &mut watch).unwrap();
        assert!(
            again.same && again.digest == more.branch_digest,
            "{change:?}"
        );
    }
}

/// Asserts that a change is refused with a word, and leaves no log.
#[track_caller]
fn refused(parent: &Parent, change: &Change, folder: &Path, word: &str) {
    let out = folder.join("refused.mcap");
    let mut watch = ReadProgress::default();
    let error = parent
        .branch(10, change, Some(&out), false, &mut watch)
        .unwrap_err();
    assert!(error.to_string().contains(word), "{error}");
    assert!(!out.exists(), "{change:?}");
}

#[test]
fn a_branch_that_begins_on_demand_equals_one_with_its_tick() {
    let folder = tempfile::tempdir().unwrap();
    let parent = read(&record(folder.path(), "chase", &["rules.time_limit=3"]));
    let change = Change {
        reseed: strings(&["all"]),
        ..Change::default()
    };
    let digest = |tick: u64, begin: u64| {
        let options = InProcessOptions::default();
        let run = parent.run(tick, &change, None, options, &mut |at| Ok(at == begin));
        run.unwrap().summary.digest
    };
    assert_eq!(digest(u64::MAX, 30), digest(30, u64::MAX));
    assert_ne!(digest(u64::MAX, 31), digest(30, u64::MAX));
}

#[test]
fn moments_and_changes_that_no_run_can_take_are_refused_with_their_values() {
    let folder = tempfile::tempdir().unwrap();
    let log = record(folder.path(), "chase_exact", &["rules.time_limit=2"]);
    let parent = read(&log);
    for at_s in [0.01, -1.0, 2.0, f64::NAN] {
        let error = parent.tick(at_s).unwrap_err().to_string();
        assert!(
            error.contains("expected a multiple of 0.05 s from 0.00"),
            "{error}"
        );
    }
    let change = |set: &[&str], replace: &[&str], command: &[&str], reseed: &[&str]| Change {
        set: strings(set),
        replace: strings(replace),
        command: strings(command),
        reseed: strings(reseed),
        ..Change::default()
    };
    for (change, word) in [
        (
            change(&["rules.time_limit=2"], &[], &[], &[]),
            "changes nothing",
        ),
        (
            change(&["robots.police_1.start.x=0"], &[], &[], &[]),
            "starts",
        ),
        (
            change(&["robots.police_1.radius=0.05"], &[], &[], &[]),
            "radii",
        ),
        (change(&["run.seed=2"], &[], &[], &[]), "a key of `run`"),
        (change(&["world.blur_sigma=0.1"], &[], &[], &[]), "the map"),
        (change(&["rules.nothing=1"], &[], &[], &[]), "--set"),
        (
            change(&[], &["unknown=pursuer"], &[], &[]),
            "--replace unknown=pursuer",
        ),
        (
            change(&[], &[], &["police_1=0.1"], &[]),
            "expected ROBOT=V,OMEGA",
        ),
        (change(&[], &[], &["unknown=0,0"], &[]), "police_1"),
        (change(&[], &[], &[], &["unknown"]), "expected all"),
    ] {
        refused(&parent, &change, folder.path(), word);
    }
    for (place, word) in [
        ("police_1=0,0", "is in a wall"),
        ("police_1=20,0", "is outside the map"),
        ("police_1=1", "expected ROBOT=X,Y[,HEADING] (m, rad)"),
        ("police_1=1,2,NaN", "expected ROBOT=X,Y"),
        ("unknown=1.5,1.5", "with ROBOT one of police_1"),
    ] {
        let change = Change {
            place: strings(&[place]),
            ..Change::default()
        };
        refused(&parent, &change, folder.path(), word);
    }
}

#[test]
fn examples_have_the_two_most_frequent_outcomes_of_at_most_40_moments() {
    let share = |(outcome, count, stream): (&str, u64, u64)| OutcomeShare {
        outcome: outcome.to_owned(),
        count,
        stream,
        share: count as f64 / 9.0,
        interval: statistics::wilson(count, 9),
    };
    let robot = |name: &str, outcomes: &[(&str, u64, u64)]| RobotShares {
        robot: name.to_owned(),
        recorded: "caught".to_owned(),
        outcomes: outcomes.iter().copied().map(share).collect(),
    };
    let moment = |n: u32| Moment {
        time_s: f64::from(n),
        continuations: 9,
        robots: vec![
            robot(
                "a",
                &[("active", 1, 7), ("caught", 3, 2), ("escaped", 5, 4)],
            ),
            robot("b", &[("caught", 9, 1)]),
            robot("c", &[("active", 9, 9)]),
        ],
    };
    let decision = |robot: &str, time_s| Decision {
        robot: robot.to_owned(),
        outcome: "caught".to_owned(),
        time_s,
        between_s: None,
        certain: true,
    };
    let report = |moments: u32| DecidedReport {
        scenario: String::new(),
        seed: 1,
        change: Change::default(),
        threshold: 0.9,
        continuations: 0,
        moments: (0..moments).map(moment).collect(),
        decisions: vec![decision("a", 1.5), decision("b", 1e9)],
    };
    let all = [
        (0.0, 1),
        (0.0, 2),
        (0.0, 4),
        (1.0, 1),
        (1.0, 2),
        (1.0, 4),
        (2.0, 1),
    ];
    assert_eq!(report(3).examples(), all);
    assert_eq!(report(0).examples(), []);
    let mut times: Vec<f64> = report(100).examples().iter().map(|found| found.0).collect();
    times.dedup();
    assert_eq!((times.len(), times[39]), (40, 97.0));
}
