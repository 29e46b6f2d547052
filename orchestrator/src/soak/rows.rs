//! A soak as rows for programs, one per mission and process, and back.

use serde::{Deserialize, Serialize};

use super::mission::{Mission, Use};

/// A process in a mission; what is of the mission stands in every row of it.
#[derive(Debug, Serialize, Deserialize)]
struct Row {
    mission: usize,
    scenario: String,
    seed: u64,
    begun_s: f64,
    lasted_s: f64,
    process: String,
    samples: usize,
    memory_bytes: u64,
    descriptors: u64,
    early_bytes: Option<u64>,
    late_bytes: Option<u64>,
    segments: u64,
    leftovers: usize,
    failure: String,
}

/// The rows, with a heading.
///
/// # Errors
/// If a row cannot be put together, which memory alone can cause.
pub fn write(missions: &[Mission]) -> Result<Vec<u8>, csv::Error> {
    let mut rows = csv::Writer::from_writer(Vec::new());
    for (number, mission) in missions.iter().enumerate() {
        for (name, held) in &mission.processes {
            rows.serialize(Row {
                mission: number,
                scenario: mission.scenario.clone(),
                seed: mission.seed,
                begun_s: mission.begun_s,
                lasted_s: mission.lasted_s,
                process: name.clone(),
                samples: held.samples,
                memory_bytes: held.memory_bytes,
                descriptors: held.descriptors,
                early_bytes: held.early_and_late_bytes.map(|parts| parts[0]),
                late_bytes: held.early_and_late_bytes.map(|parts| parts[1]),
                segments: mission.segments,
                leftovers: mission.leftovers.len(),
                failure: mission.failure.clone().unwrap_or_default(),
            })?;
        }
    }
    rows.into_inner().map_err(|e| e.into_error().into())
}

/// The missions of such rows. What was left behind has lost its names.
///
/// # Errors
/// The first row that is none, with its line.
pub fn read(bytes: &[u8]) -> Result<Vec<Mission>, csv::Error> {
    let mut missions: Vec<(usize, Mission)> = Vec::new();
    for row in csv::Reader::from_reader(bytes).deserialize() {
        let row: Row = row?;
        let held = Use {
            samples: row.samples,
            memory_bytes: row.memory_bytes,
            descriptors: row.descriptors,
            early_and_late_bytes: row.early_bytes.zip(row.late_bytes).map(|(e, l)| [e, l]),
        };
        if let Some((number, mission)) = missions.last_mut()
            && *number == row.mission
        {
            mission.processes.insert(row.process, held);
            continue;
        }
        let mission = Mission {
            scenario: row.scenario,
            seed: row.seed,
            begun_s: row.begun_s,
            lasted_s: row.lasted_s,
            processes: [(row.process, held)].into(),
            segments: row.segments,
            leftovers: (0..row.leftovers.min(LEFT))
                .map(|_| "something".to_owned())
                .collect(),
            failure: Some(row.failure).filter(|why| !why.is_empty()),
        };
        missions.push((row.mission, mission));
    }
    Ok(missions.into_iter().map(|(_, mission)| mission).collect())
}

/// Things left behind by one mission that are believed to a file.
const LEFT: usize = 10_000;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_read_is_what_was_written() {
        let held = |early_and_late_bytes| Use {
            samples: 3,
            memory_bytes: 5,
            descriptors: 30,
            early_and_late_bytes,
        };
        let mission = |number: u32, failure: Option<&str>| Mission {
            scenario: "chase \"by the clock\"".into(),
            seed: u64::from(number),
            begun_s: 0.1 + f64::from(number),
            lasted_s: 1.0 / 3.0,
            processes: [
                ("orchestrator".to_owned(), held(None)),
                ("police, 1".to_owned(), held(Some([7, 9]))),
            ]
            .into(),
            segments: 40,
            leftovers: vec!["something".into(); number as usize],
            failure: failure.map(str::to_owned),
        };
        let missions = [mission(0, None), mission(1, Some("two\nlines"))];
        let bytes = write(&missions).unwrap();
        assert_eq!(read(&bytes).unwrap(), missions);
    }

    #[test]
    fn what_is_no_row_is_named_by_its_line() {
        let missions = read(b"").unwrap();
        assert!(missions.is_empty());
        let error = read(b"mission,scenario\n0,chase\n").unwrap_err();
        assert!(error.to_string().contains("line: 2"), "{error}");
    }
}
