//! Parts of an experiment in the hands of schedulers.

use std::process::Command;

use super::{MISSIONS, sandbox, sweep, sweep_json, table, undisturbed};

#[test]
fn scripts_for_schedulers_are_written() {
    let sandbox = sandbox();
    let outcome = sweep(
        &sandbox,
        "out",
        &["--engine", "slurm", "--shards", "5", "--seeds", "1..2"],
    );
    assert_eq!(outcome.code, Some(0), "{outcome}");
    assert_eq!(outcome.stdout.lines().count(), 3);
    let array = std::fs::read_to_string(sandbox.path().join("out/shards.sbatch")).unwrap();
    assert!(array.contains("#SBATCH --array=1-5"), "{array}");
    assert!(
        array.contains("small.toml --seeds 1..2 --quiet --jobs 1 --shard"),
        "{array}"
    );
    let outcome = sweep(&sandbox, "out", &["--engine", "parallel"]);
    assert_eq!(outcome.code, Some(0), "{outcome}");
    assert!(outcome.stdout.ends_with("/out/parallel.sh\n"), "{outcome}");
}

#[test]
fn gnu_parallel_gives_the_same_table() {
    let installed = Command::new("parallel").arg("--version").output();
    let installed = installed.is_ok_and(|o| String::from_utf8_lossy(&o.stdout).contains("GNU"));
    if !installed {
        eprintln!("skipped: GNU parallel is not installed");
        return;
    }
    let sandbox = sandbox();
    let more = [
        "--engine",
        "parallel",
        "--shards",
        "4",
        "--jobs",
        "2",
        "--in-process",
        "--submit",
    ];
    let outcome = sweep(&sandbox, "out", &more);
    assert_eq!(outcome.code, Some(0), "{outcome}");
    assert_eq!(table(&sandbox, "out"), undisturbed());
}

/// Slurm needs daemons, which a test does not start; but a stand-in for `sbatch` shows that the
/// scripts do together what they shall.
#[test]
fn the_slurm_scripts_do_what_they_say() {
    let sandbox = sandbox();
    let sbatch = "#!/bin/sh\n\
        # Runs a job at once, every task of an array one after the other.\n\
        [ \"$1\" = --version ] && exit 0\n\
        for word; do script=$word; done\n\
        last=$(sed -n 's/^#SBATCH --array=1-//p' \"$script\")\n\
        for task in $(seq 1 \"${last:-1}\"); do\n\
          SLURM_ARRAY_TASK_ID=$task sh \"$script\" >/dev/null || exit 1\n\
        done\n\
        echo 42\n";
    let path = sandbox.file("bin/sbatch", sbatch);
    std::fs::set_permissions(&path, std::os::unix::fs::PermissionsExt::from_mode(0o755)).unwrap();
    let paths = std::env::var("PATH").unwrap();
    let outcome = Command::new(env!("CARGO_BIN_EXE_protean"))
        .args([
            "sweep",
            "small.toml",
            "--out",
            "out",
            "--engine",
            "slurm",
            "--shards",
            "3",
            "--in-process",
            "--submit",
        ])
        .current_dir(sandbox.path())
        .env("XDG_RUNTIME_DIR", sandbox.runtime_dir())
        .env(
            "PATH",
            format!("{}:{paths}", sandbox.path().join("bin").display()),
        )
        .output()
        .unwrap();
    let stdout = String::from_utf8_lossy(&outcome.stdout);
    assert!(
        outcome.status.success(),
        "{stdout}\n{}",
        String::from_utf8_lossy(&outcome.stderr)
    );
    assert!(stdout.contains("submitted 42 and 42"), "{stdout}");
    assert_eq!(table(&sandbox, "out"), undisturbed());
}

#[test]
fn without_processes_the_table_is_the_same() {
    let sandbox = sandbox();
    let whole = undisturbed();
    let summary = sweep_json(&sandbox, "inside", &["--in-process"], 0);
    assert_eq!(summary["carried_out"], MISSIONS);
    assert_eq!(table(&sandbox, "inside"), whole);
    // Begun with processes, gone on with inside one.
    sweep_json(&sandbox, "mixed", &["--shard", "1/2"], 0);
    sweep_json(&sandbox, "mixed", &["--in-process"], 0);
    assert_eq!(table(&sandbox, "mixed"), whole);
}
