//! Acceptance of the results: digests and outcomes are written into the test files.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use platform::atomic_file::save;
use toml_edit::{DocumentMut, InlineTable, Item, Value};

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
    let mut documents: BTreeMap<&Path, DocumentMut> = BTreeMap::new();
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
            text.parse::<DocumentMut>().map_err(|_| changed())?
        };
        let document = documents.entry(path).or_insert(document);
        let table = match test.block {
            None => Some(document.as_item_mut()),
            Some(index) => document
                .get_mut("test")
                .and_then(|tests| tests.get_mut(index)),
        };
        let expect = table
            .and_then(|table| table.get_mut("expect"))
            .ok_or_else(changed)?;
        if test.outcome_only {
            changes.extend(outcomes(expect, test, result));
        }
        for mission in &result.missions {
            if let Some(change) = digest(expect, test, mission, why) {
                changes.push(format!("{}, seed {}: {change}", test.name, mission.seed));
            }
        }
    }
    if !changes.is_empty() {
        for (path, document) in documents {
            save(document.to_string().as_bytes(), path)
                .map_err(std::io::Error::other)
                .map_err(TestError::io(path, "cannot be written"))?;
        }
    }
    Ok(changes)
}

/// Writes the digest of a mission, if another one is expected; returns the reason.
fn digest(
    expect: &mut Item,
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
    let key = mission.seed.to_string();
    let item = expect.get_mut("digest")?;
    let value = if item.is_str() {
        item.as_value_mut()?
    } else {
        item.get_mut(key.as_str())?.as_value_mut()?
    };
    let decor = value.decor().clone();
    *value = Value::from(mission.digest.as_str());
    *value.decor_mut() = decor;
    if reason.is_empty() {
        return Some(format!("digest {}", mission.digest));
    }
    annotate(expect, &key, &reason);
    Some(format!("digest {}, {reason}", mission.digest))
}

/// Writes the reason behind the digest, in place of an earlier one; other comments stay.
fn annotate(expect: &mut Item, key: &str, reason: &str) -> Option<()> {
    // Within braces there is no room for a comment.
    let holder = if expect.is_inline_table() {
        expect
    } else {
        let digest = expect.get_mut("digest")?;
        if digest.is_value() {
            digest
        } else {
            digest.get_mut(key)?
        }
    };
    let decor = holder.as_value_mut()?.decor_mut();
    let comment = decor
        .suffix()
        .and_then(|suffix| suffix.as_str())
        .unwrap_or_default();
    let comment = comment.trim().trim_start_matches('#').trim();
    let own = comment
        .split("was ")
        .next()
        .unwrap_or_default()
        .trim_end_matches("; ");
    let text = if own.is_empty() {
        reason.to_owned()
    } else {
        format!("{own}; {reason}")
    };
    decor.set_suffix(format!(" # {text}"));
    Some(())
}

/// Writes the outcomes of the robots, if others or none are expected; returns the change.
fn outcomes(expect: &mut Item, test: &MissionTest, result: &TestReport) -> Option<String> {
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
    let expect = expect.as_table_like_mut()?;
    let item = expect.entry("outcome").or_insert(Item::None);
    let expected = item.as_table_like().map(|table| {
        let outcomes = table.iter();
        outcomes
            .filter_map(|(robot, outcome)| Some((robot, outcome.as_str()?)))
            .collect()
    });
    if found.is_empty() || expected.as_ref() == Some(&found) {
        return None;
    }
    let count = found.len();
    if let Item::Table(table) = item {
        table.clear();
        table.extend(found);
    } else {
        let mut outcomes: InlineTable = found.into_iter().collect();
        if let Some(value) = item.as_value() {
            *outcomes.decor_mut() = value.decor().clone();
        }
        *item = Item::Value(outcomes.into());
    }
    Some(format!("{}: outcomes of {count} robots", test.name))
}
