//! Spreading an experiment over machines: scripts for GNU parallel and Slurm.
//!
//! Each part is an ordinary `protean sweep … --shard I/N`, so that any other scheduler can do the
//! same; the last step is `protean sweep merge`.

use std::io::ErrorKind;
use std::os::unix::fs::PermissionsExt as _;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitStatus, Stdio};

use super::error::SweepError;
use super::shell;

/// Who carries out the parts of an experiment.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum Scheduler {
    /// This program, on this machine.
    Local,
    /// GNU parallel: on this machine, or over ssh on others.
    Parallel,
    /// The Slurm workload manager.
    Slurm,
}

/// What the scripts shall do.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Plan {
    /// This program.
    pub program: PathBuf,
    /// Arguments of `protean sweep` that every part is given: the experiment and whatever changes
    /// it, but for `--shard`, `--out` and `--jobs`.
    pub arguments: Vec<String>,
    /// Directory in which the paths of the arguments begin.
    pub folder: PathBuf,
    /// Where the merged results go; the parts' own directories and the scripts are below it.
    pub out: PathBuf,
    /// Name of the experiment.
    pub name: String,
    /// Number of parts, > 0.
    pub shards: usize,
    /// Missions at once, > 0: with GNU parallel in all parts together, with Slurm in each.
    pub jobs: usize,
}

/// The scripts that were written.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Scripts {
    /// What starts everything.
    pub start: PathBuf,
    /// All files.
    pub files: Vec<PathBuf>,
}

impl Plan {
    /// The command of one part with this many missions at once; `index` is its number, or what a
    /// shell puts there.
    fn shard(&self, index: &str, jobs: usize) -> String {
        let program = self.program.display().to_string();
        let mut words = vec![program.as_str(), "sweep"];
        words.extend(self.arguments.iter().map(String::as_str));
        let jobs = jobs.to_string();
        words.extend(["--quiet", "--jobs", &jobs]);
        let out = shell::quote(&self.out.display().to_string());
        let count = self.shards;
        format!(
            "{} --shard {index}/{count} --out {out}/shard-{index}-of-{count}",
            shell::line(words)
        )
    }

    fn merge(&self) -> String {
        let program = self.program.display().to_string();
        let out = shell::quote(&self.out.display().to_string());
        format!(
            "{} sweep merge {out}/shard-*-of-{} --out {out}",
            shell::quote(&program),
            self.shards
        )
    }

    fn cd(&self) -> String {
        format!("cd {}", shell::quote(&self.folder.display().to_string()))
    }

    /// Writes the script for GNU parallel.
    ///
    /// # Errors
    /// [`SweepError::Io`].
    pub fn write_parallel(&self) -> Result<Scripts, SweepError> {
        let out = shell::quote(&self.out.display().to_string());
        // A part that ends with failed missions is merged like the others: the merge says what is
        // missing, and its exit code is that of the script.
        let text = format!(
            "#!/bin/sh\n\
             # The experiment {name} in {shards} parts with GNU parallel, and their results merged.\n\
             # PARALLEL_OPTIONS takes more of its options, such as --sshloginfile hosts.\n\
             {cd} || exit 1\n\
             seq {shards} | parallel --will-cite --jobs \"${{PARALLEL_JOBS:-{jobs}}}\" \
             --joblog {out}/parallel.log $PARALLEL_OPTIONS \\\n    {command}\n\
             exec {merge}\n",
            name = self.name,
            shards = self.shards,
            jobs = self.jobs,
            cd = self.cd(),
            command = shell::quote(&format!(
                "{} ; code=$?; [ $code -eq 3 ] && exit 0; exit $code",
                self.shard("{}", 1)
            )),
            merge = self.merge(),
        );
        let start = self.out.join("parallel.sh");
        self.write(&start, &text)?;
        Ok(Scripts {
            files: vec![start.clone()],
            start,
        })
    }

    /// Writes the scripts for Slurm: an array of the parts, a job that merges them once all have
    /// ended, and a script that submits both.
    ///
    /// # Errors
    /// [`SweepError::Io`].
    pub fn write_slurm(&self) -> Result<Scripts, SweepError> {
        let at = |name: &str| self.out.join(name);
        let (array, merge, start) = (at("shards.sbatch"), at("merge.sbatch"), at("slurm.sh"));
        let shown = |path: &Path| shell::quote(&path.display().to_string());
        // `sbatch` itself reads the lines that begin with #SBATCH, without a shell.
        let log = |name: &str| self.out.join(name).display().to_string();
        let text = format!(
            "#!/bin/sh\n\
             #SBATCH --job-name=protean-{name}\n\
             #SBATCH --array=1-{shards}\n\
             #SBATCH --ntasks=1\n\
             #SBATCH --cpus-per-task={jobs}\n\
             #SBATCH --output=\"{log}\"\n\
             {cd} || exit 1\n\
             {command}\n\
             code=$?\n\
             # Failed missions are in the results; the merge lists them.\n\
             [ $code -eq 3 ] && exit 0\n\
             exit $code\n",
            name = self.name,
            shards = self.shards,
            jobs = self.jobs,
            log = log("shard-%a.log"),
            cd = self.cd(),
            command = self.shard("$SLURM_ARRAY_TASK_ID", self.jobs),
        );
        self.write(&array, &text)?;
        let text = format!(
            "#!/bin/sh\n\
             #SBATCH --job-name=protean-{name}-merge\n\
             #SBATCH --ntasks=1\n\
             #SBATCH --output=\"{log}\"\n\
             {cd} || exit 1\n\
             exec {merge}\n",
            name = self.name,
            log = log("merge.log"),
            cd = self.cd(),
            merge = self.merge(),
        );
        self.write(&merge, &text)?;
        let text = format!(
            "#!/bin/sh\n\
             # Submits the experiment {name} in {shards} parts to Slurm, and the merge of their results.\n\
             # SBATCH_OPTIONS takes more options, such as --partition=short --time=2:00:00.\n\
             id=$(sbatch --parsable $SBATCH_OPTIONS {array}) || exit 1\n\
             id=${{id%%;*}}\n\
             merge=$(sbatch --parsable $SBATCH_OPTIONS --dependency=afterany:\"$id\" {merge}) || exit 1\n\
             echo \"submitted $id and ${{merge%%;*}}; the results will be in \"{out}\n",
            name = self.name,
            shards = self.shards,
            array = shown(&array),
            merge = shown(&merge),
            out = shown(&self.out),
        );
        self.write(&start, &text)?;
        Ok(Scripts {
            files: vec![array, merge, start.clone()],
            start,
        })
    }

    fn write(&self, path: &Path, text: &str) -> Result<(), SweepError> {
        std::fs::create_dir_all(&self.out)
            .map_err(SweepError::io(&self.out, "cannot make the directory"))?;
        std::fs::write(path, text).map_err(SweepError::io(path, "cannot be written"))?;
        std::fs::set_permissions(path, std::fs::Permissions::from_mode(0o755))
            .map_err(SweepError::io(path, "cannot be made executable"))
    }
}

/// Whether the program that a scheduler needs is there.
///
/// # Errors
/// [`SweepError::Launcher`] says which one is missing and how to get it.
pub fn check(scheduler: Scheduler) -> Result<(), SweepError> {
    let (program, help) = match scheduler {
        Scheduler::Local => return Ok(()),
        Scheduler::Parallel => (
            "parallel",
            "install GNU parallel (Debian: apt-get install parallel)",
        ),
        Scheduler::Slurm => (
            "sbatch",
            "submit where Slurm is installed (Debian: slurm-client)",
        ),
    };
    let found = Command::new(program)
        .arg("--version")
        .stdin(Stdio::null())
        .output();
    let what = match found {
        // The `parallel` of moreutils is another program.
        Ok(output) if scheduler == Scheduler::Parallel => {
            if String::from_utf8_lossy(&output.stdout).contains("GNU") {
                return Ok(());
            }
            "it is not GNU parallel".to_owned()
        }
        Ok(_) => return Ok(()),
        Err(error) if error.kind() == ErrorKind::NotFound => "not installed".to_owned(),
        Err(error) => error.to_string(),
    };
    Err(SweepError::Launcher {
        program: program.to_owned(),
        what,
        help: Some(help),
    })
}

/// Runs a script to its end.
///
/// # Errors
/// [`SweepError::Launcher`] if it cannot be started.
pub fn start(script: &Path) -> Result<ExitStatus, SweepError> {
    Command::new("sh")
        .arg(script)
        .stdin(Stdio::null())
        .status()
        .map_err(|error| SweepError::Launcher {
            program: script.display().to_string(),
            what: format!("cannot be started: {error}"),
            help: None,
        })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plan(out: &Path) -> Plan {
        Plan {
            program: "/opt/a program/protean".into(),
            arguments: vec!["my experiment.toml".into(), "--set".into(), "a.b=1".into()],
            folder: "/home/it's me".into(),
            out: out.to_owned(),
            name: "my_experiment".into(),
            shards: 3,
            jobs: 2,
        }
    }

    /// The script is one that a shell understands.
    fn is_shell(path: &Path) {
        let output = Command::new("sh").arg("-n").arg(path).output().unwrap();
        assert!(
            output.status.success(),
            "{}",
            String::from_utf8_lossy(&output.stderr)
        );
        assert_eq!(path.metadata().unwrap().permissions().mode() & 0o111, 0o111);
    }

    #[test]
    fn the_script_for_gnu_parallel_runs_every_part_and_merges() {
        let directory = tempfile::tempdir().unwrap();
        let scripts = plan(directory.path()).write_parallel().unwrap();
        is_shell(&scripts.start);
        let text = std::fs::read_to_string(&scripts.start).unwrap();
        for word in [
            "seq 3 | parallel",
            r"cd '/home/it'\''s me'",
            "--shard {}/3",
            "sweep merge",
            "shard-*-of-3",
        ] {
            assert!(text.contains(word), "{word} is missing in\n{text}");
        }
    }

    #[test]
    fn the_scripts_for_slurm_are_an_array_and_a_merge_that_depends_on_it() {
        let directory = tempfile::tempdir().unwrap();
        let scripts = plan(directory.path()).write_slurm().unwrap();
        assert_eq!(scripts.files.len(), 3);
        scripts.files.iter().for_each(|file| is_shell(file));
        let read = |name: &str| std::fs::read_to_string(directory.path().join(name)).unwrap();
        let array = read("shards.sbatch");
        for word in [
            "#SBATCH --array=1-3\n",
            "#SBATCH --cpus-per-task=2\n",
            "'/opt/a program/protean' sweep 'my experiment.toml' --set a.b=1 --quiet --jobs 2 \
             --shard $SLURM_ARRAY_TASK_ID/3",
        ] {
            assert!(array.contains(word), "{word} is missing in\n{array}");
        }
        assert!(read("merge.sbatch").contains("sweep merge"));
        assert!(read("slurm.sh").contains("--dependency=afterany:\"$id\""));
    }
}
