//! Acceptance of the results: digests and outcomes are written into the test files.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use platform::atomic_file::save;

use crate::edit::{Document, Edit};
use crate::error::TestError;
use crate::expectation::Check;
use crate::report::{MissionRecord, SuiteReport, TestReport};
use crate::test_file::MissionTest;

/// Number of digits of an earlier digest in a comment.
const DIGITS: usize = 12;

/// Writes the digests of the missions, or with `outcome_only` the outcomes of the robots, into the files of the tests
/// in place of those expected. Comments and layout stay; a comment beside a digest says why it changed. Returns a line for
/// each change.
///
/// # Errors
/// [`TestError::Io`], [`TestError::Changed`].
pub fn update(
    tests: &[MissionTest],
    report: &SuiteReport,
    why: &str,
) -> Result<Vec<String>, TestError> {
    let mut changes = Vec::new();
    let mut documents: BTreeMap<&Path, Document> = BTreeMap::new();
    for (test, result) in tests.iter().zip(&report.tests) {
        let path = test.file.as_path();
        let changed = || TestError::Changed {
            path: path.to_owned(),
        };
        let document = if let Some(document) = documents.remove(path) {
            document
        } else {
            let text = fs::read_to_string(path);
            let text = text.map_err(TestError::io(path, "cannot be read"))?;
            Document::parse(text).ok_or_else(changed)?
        };
        let document = documents.entry(path).or_insert(document);
        let mut expect = document.expect(test.block).ok_or_else(changed)?;
        if test.outcome_only {
            changes.extend(outcomes(&mut expect, test, result));
        }
        for mission in &result.missions {
            if let Some(change) = digest(&mut expect, test, mission, why) {
                changes.push(format!("{}, seed {}: {change}", test.name, mission.seed));
            }
        }
    }
    for (path, document) in documents {
        let Some(text) = document.edited() else {
            continue;
        };
        save(text.as_bytes(), path)
            .map_err(std::io::Error::other)
            .map_err(TestError::io(path, "cannot be written"))?;
    }
    Ok(changes)
}

/// Writes the digest of a mission, if another one is expected; returns the reason.
fn digest(
    expect: &mut Edit<'_>,
    test: &MissionTest,
    mission: &MissionRecord,
    why: &str,
) -> Option<String> {
    let old = test
        .expectations
        .iter()
        .find_map(|expectation| match &expectation.check {
            Check::Digest { seed, digest } if *seed == mission.seed => Some(digest),
            _ => None,
        })?;
    if mission.digest.is_empty() || *old == mission.digest {
        return None;
    }
    let was = old.get(..DIGITS).map(|old| format!("was {old}"));
    let why = Some(why.to_owned()).filter(|why| !why.is_empty());
    let first = mission.first_difference.as_ref();
    let first = first.map(|first| format!("first difference: {first}"));
    let reasons: Vec<String> = [was, why, first].into_iter().flatten().collect();
    let reason = reasons.join("; ").replace(char::is_control, " ");
    expect.digest(mission.seed, &mission.digest, &reason)?;
    let because = if reason.is_empty() { "" } else { ", " };
    Some(format!("digest {}{because}{reason}", mission.digest))
}

/// Writes the outcomes of the robots, if others or none are expected; returns the change.
fn outcomes(expect: &mut Edit<'_>, test: &MissionTest, result: &TestReport) -> Option<String> {
    let missions = &result.missions;
    let is_whole = missions.len() == test.seeds.len();
    let first = missions.first();
    let first = first.filter(|mission| is_whole && !mission.digest.is_empty())?;
    // Robots whose outcome depends on the seed have none that a test could expect.
    let same = |(robot, outcome): &(&String, &String)| {
        let mut missions = missions.iter();
        missions.all(|mission| mission.robots.get(*robot) == Some(*outcome))
    };
    let found = first.robots.iter().filter(same);
    let found: BTreeMap<&str, &str> = found.map(|(r, o)| (r.as_str(), o.as_str())).collect();
    if found.is_empty() || found == expect.expected() {
        return None;
    }
    expect.outcomes(&found)?;
    Some(format!("{}: outcomes of {} robots", test.name, found.len()))
}
