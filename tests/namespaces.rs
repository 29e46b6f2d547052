//! Runs in another PID namespace, as in containers that share `/dev/shm`.

use std::collections::BTreeSet;
use std::path::PathBuf;
use std::process::Command;

use runtime::lockstep::TickBarrier;
use rustix::process::Signal;

use crate::support::call::PATIENCE;
use crate::support::{SOON, Sandbox, skipped, until, wait_for_tick};

/// Starts a program as the first process of a PID namespace, which ends with it.
const UNSHARE: [&str; 4] = ["-p", "-f", "--mount-proc", "--kill-child"];

#[test]
fn a_run_in_another_pid_namespace_is_spared_until_it_has_ended() {
    match Command::new("unshare").args(UNSHARE).arg("true").output() {
        Ok(output) if output.status.success() => {}
        refused => return skipped("PID namespaces", &format!("{refused:?}")),
    }
    // Two runtime directories.
    let (living, other) = (Sandbox::new(), Sandbox::new());
    let words = "run chase --quiet --out run.mcap --set run.dt=0.0005 --set rules.time_limit=40000 \
                 --set teams.evader.limits.v_max=0.01 --set teams.police.limits.v_max=0.01";
    let call = living.protean(words.split_whitespace()).set(PATIENCE);
    let running = call.through("unshare", &UNSHARE).start();
    let run = living.next_run(&BTreeSet::new());
    wait_for_tick(&run, 2);
    let page = TickBarrier::open(&Sandbox::prefix(&run)).unwrap();
    let before: BTreeSet<PathBuf> = living.shared_memory().into_iter().collect();
    let clean = || other.protean(["clean"]);
    let hello = ["run", "hello", "--quiet", "--out", "hello.mcap"];
    for call in [
        clean(),
        clean().through("unshare", &UNSHARE),
        // With the same runtime directory.
        clean().runtime_dir(&living.runtime_dir()),
        other.protean(hello),
    ] {
        let outcome = call.run();
        assert_eq!(outcome.code, Some(0), "{outcome}");
        let now = living.shared_memory().into_iter().collect();
        assert!(before.is_subset(&now), "{outcome}");
        let posted = page.ticks_posted();
        until("another tick", SOON, || {
            (page.ticks_posted() > posted).then_some(())
        });
    }
    running.signal(Signal::KILL);
    running.finish();
    until("the end of the run", SOON, || {
        living.processes().is_empty().then_some(())
    });
    let cleaned = clean().run();
    assert_eq!(cleaned.code, Some(0), "{cleaned}");
    let left = living.shared_memory();
    assert_eq!(left, [] as [PathBuf; 0], "{cleaned}");
    assert_eq!(living.protean(["clean"]).run().code, Some(0));
    living.assert_nothing_left();
}
