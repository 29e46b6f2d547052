//! Locks that the file system refuses: one that has none does not stop a command, another cause is named.

use rustix::io::Errno;

use super::{Fate, Injection, injected, injector};
use crate::support::Sandbox;

const EXPERIMENT: &str = "scenario = \"builtin:hello\"\nseeds = { first = 1, count = 1 }\n\
                          [parameters.limit]\nset = \"rules.time_limit\"\n[grid]\nlimit = [0.5]\n";

/// A command and the file that its first lock guards.
const COMMANDS: [(&str, &str); 2] = [
    (
        "run hello --in-process --quiet --out run.mcap --set rules.time_limit=1",
        "run.mcap",
    ),
    ("sweep small.toml --out out --jobs 1 --in-process", "out"),
];

#[test]
fn a_lock_is_held_by_another_only_if_the_system_says_so() {
    let Some(injector) = injector() else { return };
    let no_locks = [Errno::NOLCK, Errno::NOSYS, Errno::OPNOTSUPP];
    let others = [Errno::IO, Errno::ACCESS];
    for (command, path) in COMMANDS {
        for error in no_locks.into_iter().chain(others).chain([Errno::AGAIN]) {
            let sandbox = Sandbox::new();
            sandbox.file("small.toml", EXPERIMENT);
            let at = Injection {
                calls: "flock",
                number: 1,
                fate: Fate::Error(error),
            };
            let outcome = injected(sandbox.protean(command.split(' ')), injector, at).run();
            let cause = std::io::Error::from(error).to_string();
            let words = ["another run", "another sweep"];
            let is_in_use = words.iter().any(|words| outcome.stderr.contains(words));
            assert_eq!(is_in_use, error == Errno::AGAIN, "{outcome}");
            if no_locks.contains(&error) {
                assert_eq!(outcome.code, Some(0), "{outcome}");
                let remark = format!("{path}: its file system has no locks ({cause})");
                assert!(outcome.stderr.contains(&remark), "{outcome}");
                assert!(sandbox.path().join(path).exists());
            } else {
                assert_eq!(outcome.code, Some(2), "{outcome}");
                assert!(
                    !sandbox.path().join("run.mcap").exists() || is_in_use,
                    "{outcome}"
                );
                assert!(is_in_use || outcome.stderr.contains(&cause), "{outcome}");
            }
            sandbox.assert_empty();
        }
    }
}
