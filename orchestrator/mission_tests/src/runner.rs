//! Execution of the missions of tests, several at once.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Instant;

use platform::presence::entry;
use platform::progress::Progress;
use sweep::engine::{Call, Engine};
use sweep::spec::LogPolicy;
use sweep::{Part, Row};

use crate::baseline::Baseline;
use crate::error::TestError;
use crate::evaluate::{of_all, of_mission};
use crate::expectation::Check;
use crate::first_difference::{Logs, describe};
use crate::limit::number;
use crate::report::{Finding, MissionRecord, SuiteReport, TestReport, Verdict};
use crate::test_file::MissionTest;

/// Options of the execution of tests.
pub struct RunOptions {
    /// Number of parallel missions, > 0.
    pub jobs: usize,
    /// Missions whose logs are kept.
    pub keep_logs: LogPolicy,
    /// Folder of the logs.
    pub logs: PathBuf,
    /// `true` if no progress is shown.
    pub quiet: bool,
    /// Set by the caller (Ctrl-C): running missions are aborted.
    pub interrupted: Arc<AtomicBool>,
}

/// A finished mission.
struct Ended {
    test: usize,
    row: Row,
    record: MissionRecord,
    findings: Vec<Finding>,
}

/// Data that the workers share.
struct Shared<'a> {
    tests: &'a [MissionTest],
    engine: &'a dyn Engine,
    options: &'a RunOptions,
    baseline: Option<&'a Baseline>,
    /// Test and seed of every mission.
    missions: Vec<(usize, u64)>,
    next: AtomicUsize,
    progress: Mutex<Progress>,
}

/// Runs the missions of tests and judges them.
///
/// # Errors
/// [`TestError::Io`]: the folder of the logs cannot be created, or a thread cannot be started.
pub fn run(
    tests: &[MissionTest],
    engine: &dyn Engine,
    options: &RunOptions,
    baseline: Option<&Baseline>,
) -> Result<SuiteReport, TestError> {
    let start = Instant::now();
    if options.keep_logs != LogPolicy::None {
        std::fs::create_dir_all(&options.logs)
            .map_err(TestError::io(&options.logs, "cannot be created"))?;
    }
    let of_test = |(index, test): (usize, &MissionTest)| {
        let seeds = test.seeds.clone().into_iter();
        seeds.map(move |seed| (index, seed))
    };
    let missions: Vec<(usize, u64)> = tests.iter().enumerate().flat_map(of_test).collect();
    let jobs = options.jobs.clamp(1, missions.len().max(1));
    let shared = Shared {
        tests,
        engine,
        options,
        baseline,
        progress: Mutex::new(Progress::new(missions.len(), 0, options.quiet, "missions")),
        missions,
        next: AtomicUsize::new(0),
    };
    let mut ended = std::thread::scope(|scope| -> Result<Vec<Ended>, TestError> {
        let mut workers = Vec::new();
        for worker in 0..jobs {
            let shared = &shared;
            let thread = std::thread::Builder::new().name(format!("test-{worker}"));
            let thread = thread.spawn_scoped(scope, move || shared.work());
            workers.push(thread.map_err(TestError::io("--jobs", "cannot start a thread"))?);
        }
        // A mission that panics is a failed mission; its worker goes on.
        Ok(workers
            .into_iter()
            .flat_map(|worker| worker.join().unwrap_or_default())
            .collect())
    })?;
    shared
        .progress
        .lock()
        .unwrap_or_else(PoisonError::into_inner)
        .finish();
    ended.sort_by_key(|mission| (mission.test, mission.record.seed));
    let mut rest = ended.into_iter().peekable();
    let tests: Vec<TestReport> = (0..)
        .zip(tests)
        .map(|(index, test)| {
            let own = std::iter::from_fn(|| rest.next_if(|mission| mission.test == index));
            judge(test, own.collect())
        })
        .collect();
    Ok(SuiteReport {
        verdict: tests
            .iter()
            .map(|test| test.verdict)
            .max()
            .unwrap_or(Verdict::Pass),
        interrupted: options.interrupted.load(Ordering::SeqCst),
        wall_time_s: start.elapsed().as_secs_f64(),
        tests,
    })
}

/// Returns the result of a test from those of its missions.
fn judge(test: &MissionTest, ended: Vec<Ended>) -> TestReport {
    let rows: Vec<&Row> = ended.iter().map(|mission| &mission.row).collect();
    let is_whole = ended.len() == test.seeds.len();
    let mut of_many = Vec::new();
    for expectation in test.expectations.iter().filter(|_| is_whole) {
        if let Some((verdict, found)) = of_all(&expectation.check, &rows)
            && verdict != Verdict::Pass
        {
            of_many.push(Finding {
                verdict,
                expected: expectation.text.clone(),
                line: expectation.line,
                seed: None,
                found,
                first_difference: None,
                command: None,
                log: None,
            });
        }
    }
    let (mut findings, mut missions) = (Vec::new(), Vec::new());
    for mission in ended {
        findings.extend(mission.findings);
        missions.push(mission.record);
    }
    findings.extend(of_many);
    let verdicts = findings.iter().map(|finding| finding.verdict);
    // A test without all its missions is not decided.
    let least = if is_whole {
        Verdict::Pass
    } else {
        Verdict::Inconclusive
    };
    TestReport {
        name: test.name.clone(),
        file: test.file.clone(),
        line: test.line,
        verdict: verdicts.fold(least, Verdict::max),
        findings,
        missions,
    }
}

impl Shared<'_> {
    /// Executes one mission after the other until none is left.
    fn work(&self) -> Vec<Ended> {
        let mut ended = Vec::new();
        while !self.options.interrupted.load(Ordering::SeqCst) {
            let next = self.next.fetch_add(1, Ordering::SeqCst);
            let Some(&(index, seed)) = self.missions.get(next) else {
                break;
            };
            let Some(test) = self.tests.get(index) else {
                break;
            };
            let Some(mission) = self.carry_out(index, test, seed) else {
                break;
            };
            let mut progress = self.progress.lock().unwrap_or_else(PoisonError::into_inner);
            progress.done(!mission.findings.is_empty(), || {
                format!("{} (seed {seed}) failed", test.name)
            });
            ended.push(mission);
        }
        ended
    }

    /// Executes a mission; returns `None` if it was interrupted.
    fn carry_out(&self, index: usize, test: &MissionTest, seed: u64) -> Option<Ended> {
        let logs = Logs::new(&self.options.logs, test, seed);
        // The difference from an accepted run needs a log, too.
        let accepted = self
            .accepted_digest(test, seed)
            .filter(|_| !matches!(entry(&logs.accepted), Ok(None)));
        let has_log = self.options.keep_logs != LogPolicy::None || accepted.is_some();
        let call = Call {
            log: has_log.then(|| logs.new.clone()),
            interrupted: Arc::clone(&self.options.interrupted),
        };
        let done = match test.template.with_seed(seed) {
            Ok(scenario) => {
                let done = self.engine.execute(&scenario, &call);
                done.map_err(|error| error.to_string())
            }
            Err(problems) => Err(problems.to_string()),
        };
        let (row, events) = match done {
            Ok(report) if report.interrupted => {
                logs.settle(true, false);
                return None;
            }
            Ok(report) => (Row::of(&report), report.summary.events),
            Err(error) => (Row::failed(error), Vec::new()),
        };
        let first_difference = accepted
            .filter(|digest| *digest != row.digest)
            .and_then(|digest| {
                describe(&logs.accepted, digest, &logs.new, &self.options.interrupted)
            });
        let mut found: Vec<(String, usize, String)> = if row.is_failed() {
            vec![(
                "the mission runs to its end".to_owned(),
                test.line,
                row.error.clone(),
            )]
        } else {
            let checks = test.expectations.iter();
            checks
                .filter_map(|expectation| {
                    let found = of_mission(&expectation.check, seed, &row, &events)?;
                    Some((expectation.text.clone(), expectation.line, found))
                })
                .collect()
        };
        let keep = match self.options.keep_logs {
            LogPolicy::None => false,
            LogPolicy::Failed => !found.is_empty(),
            LogPolicy::All => true,
        };
        let log = logs.settle(!found.is_empty(), keep);
        let findings = found.drain(..).map(|(expected, line, found)| Finding {
            verdict: Verdict::Fail,
            expected,
            line,
            seed: Some(seed),
            found,
            first_difference: first_difference.clone(),
            command: Some(test.command(seed)),
            log: log.clone(),
        });
        Some(Ended {
            test: index,
            findings: findings.collect(),
            record: record(seed, &row, first_difference),
            row,
        })
    }

    /// Returns the digest that is expected of a mission, or else the one that it had in the baseline.
    fn accepted_digest<'s>(&'s self, test: &'s MissionTest, seed: u64) -> Option<&'s str> {
        let expected = test.expectations.iter().find_map(|e| match &e.check {
            Check::Digest { seed: of, digest } if *of == seed => Some(digest.as_str()),
            _ => None,
        });
        expected.or_else(|| Some(self.baseline?.mission(&test.name, seed)?.digest.as_str()))
    }
}

fn record(seed: u64, row: &Row, first_difference: Option<String>) -> MissionRecord {
    let robots = row.robots.iter();
    let columns = <Row as Part<Row>>::COLUMNS.iter();
    let numbers = columns.filter_map(|c| Some((c.name.to_owned(), number(&c.cell(row))?)));
    MissionRecord {
        seed,
        outcome: row.outcome.name().to_owned(),
        digest: row.digest.clone(),
        robots: robots
            .map(|r| (r.name.clone(), r.outcome.clone()))
            .collect(),
        columns: numbers.collect::<BTreeMap<_, _>>(),
        first_difference,
    }
}
