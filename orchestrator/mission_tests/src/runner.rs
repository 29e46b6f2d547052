//! Execution of the missions of tests, several at once.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use platform::presence::entry;
use platform::progress::Progress;
use sweep::engine::{Call, Engine};
use sweep::pool::{Pool, Turn};
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
    /// Real time after which a mission is ended between two ticks; it is then not decided.
    pub timeout: Duration,
    /// Missions whose logs are kept.
    pub keep_logs: LogPolicy,
    /// Folder of the logs.
    pub logs: PathBuf,
    /// `true` if no progress is shown.
    pub quiet: bool,
    /// Set by the caller (Ctrl-C): running missions are aborted.
    pub interrupted: Arc<AtomicBool>,
}

/// A mission that was not interrupted.
struct MissionResult {
    test: usize,
    seed: u64,
    /// Its result, unless the limit of real time ended it.
    result: Option<(Row, MissionRecord)>,
    findings: Vec<Finding>,
}

/// Data that the workers share.
struct WorkerContext<'a> {
    tests: &'a [MissionTest],
    engine: &'a dyn Engine,
    options: &'a RunOptions,
    baseline: Option<&'a Baseline>,
    /// Test and seed of every mission.
    missions: Vec<(usize, u64)>,
}

/// Runs the missions of tests and judges them.
///
/// # Errors
/// [`TestError::Io`]: the folder of the logs cannot be created; [`TestError::Threads`].
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
    let mut progress = Progress::new(missions.len(), 0, options.quiet, "missions");
    let shared = WorkerContext {
        tests,
        engine,
        options,
        baseline,
        missions,
    };
    let pool = Pool {
        jobs: options.jobs,
        timeout: options.timeout,
        interrupted: &options.interrupted,
    };
    let mut ended: Vec<MissionResult> = Vec::new();
    pool.run(
        shared.missions.len(),
        |_| (),
        |turn| shared.carry_out(turn),
        |mission| {
            if let Some(mission) = mission {
                let name = || tests.get(mission.test).map_or("", |test| &test.name);
                progress.done(!mission.findings.is_empty(), || {
                    format!("{} (seed {}) failed", name(), mission.seed)
                });
                ended.push(mission);
            }
            Ok(())
        },
    )?;
    progress.finish();
    ended.sort_by_key(|mission| (mission.test, mission.seed));
    let mut rest = ended.into_iter().peekable();
    let tests: Vec<TestReport> = (0..)
        .zip(tests)
        .map(|(index, test)| {
            let own = std::iter::from_fn(|| rest.next_if(|mission| mission.test == index));
            judge(test, own.collect())
        })
        .collect();
    let verdicts = tests.iter().map(|test| test.verdict);
    Ok(SuiteReport {
        verdict: verdicts.max().unwrap_or(Verdict::Pass),
        interrupted: options.interrupted.load(Ordering::SeqCst),
        wall_time_s: start.elapsed().as_secs_f64(),
        tests,
    })
}

/// Returns the result of a test from those of its missions.
fn judge(test: &MissionTest, ended: Vec<MissionResult>) -> TestReport {
    let (mut findings, mut rows, mut missions) = (Vec::new(), Vec::new(), Vec::new());
    for mission in ended {
        findings.extend(mission.findings);
        if let Some((row, record)) = mission.result {
            rows.push(row);
            missions.push(record);
        }
    }
    let rows: Vec<&Row> = rows.iter().collect();
    // A test without all its missions is not decided.
    let is_whole = rows.len() == test.seeds.len();
    for expectation in test.expectations.iter().filter(|_| is_whole) {
        if let Some((verdict, found)) = of_all(&expectation.check, &rows)
            && verdict != Verdict::Pass
        {
            findings.push(Finding {
                verdict,
                expected: expectation.text.clone(),
                line: expectation.line,
                found,
                ..Finding::default()
            });
        }
    }
    let verdicts = findings.iter().map(|finding| finding.verdict);
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

impl WorkerContext<'_> {
    /// Executes a mission; returns `None` if it was interrupted.
    fn carry_out(&self, turn: &Turn<'_>) -> Option<MissionResult> {
        let &(index, seed) = self.missions.get(turn.mission)?;
        let test = self.tests.get(index)?;
        let logs = Logs::new(&self.options.logs, test, seed);
        // The difference from an accepted run needs a log, too.
        let accepted = self
            .accepted_digest(test, seed)
            .filter(|_| !matches!(entry(&logs.accepted), Ok(None)));
        let has_log = self.options.keep_logs != LogPolicy::None || accepted.is_some();
        let call = Call {
            log: has_log.then(|| logs.new.clone()),
            interrupted: Arc::clone(&turn.end),
        };
        let done = match test.template.with_seed(seed) {
            Ok(scenario) => {
                let done = self.engine.execute(&scenario, &call);
                done.map_err(|error| error.to_string())
            }
            Err(problems) => Err(problems.to_string()),
        };
        let done = match done {
            Ok(report) if !report.interrupted => {
                Some((Row::from_report(&report), report.summary.events))
            }
            // An engine may report the end as an error.
            Err(error) if !turn.end.load(Ordering::SeqCst) => {
                Some((Row::failed(error), Vec::new()))
            }
            _ => None,
        };
        if done.is_none() && turn.is_stopped() {
            logs.settle(true, false);
            return None;
        }
        let first_difference = accepted
            .zip(done.as_ref())
            .filter(|(digest, (row, _))| *digest != row.digest)
            .and_then(|(digest, _)| describe(&logs, digest, &self.options.interrupted));
        let finding = |verdict, expected: String, line, found| Finding {
            verdict,
            expected,
            line,
            seed: Some(seed),
            found,
            first_difference: first_difference.clone(),
            command: Some(test.command(seed)),
            log: None,
        };
        let mut findings: Vec<Finding> = match &done {
            None => {
                let limit = self.options.timeout.as_secs_f64();
                let expected = format!("the mission ends within {limit} s of real time");
                let found = "it was aborted (--timeout)".to_owned();
                vec![finding(Verdict::Inconclusive, expected, test.line, found)]
            }
            Some((row, _)) if row.is_failed() => {
                let expected = "the mission runs to its end".to_owned();
                vec![finding(
                    Verdict::Fail,
                    expected,
                    test.line,
                    row.error.clone(),
                )]
            }
            Some((row, events)) => {
                let failing = test.expectations.iter().filter_map(|expectation| {
                    let found = of_mission(&expectation.check, seed, row, events)?;
                    let (text, line) = (expectation.text.clone(), expectation.line);
                    Some(finding(Verdict::Fail, text, line, found))
                });
                failing.collect()
            }
        };
        let failed = !findings.is_empty();
        let log = logs.settle(failed, self.options.keep_logs.keeps(failed));
        for finding in &mut findings {
            finding.log.clone_from(&log);
        }
        Some(MissionResult {
            test: index,
            seed,
            result: done.map(|(row, _)| {
                let record = record(seed, &row, first_difference);
                (row, record)
            }),
            findings,
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
        columns: numbers.collect(),
        first_difference,
    }
}
