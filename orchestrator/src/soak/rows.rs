//! A soak as rows for programs, one per mission and process, and back.

use std::io::{Read, Write};

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
    /// Absent in rows of soaks before there was this column.
    #[serde(default)]
    middle_bytes: Option<u64>,
    late_bytes: Option<u64>,
    segments: u64,
    /// One per line.
    leftovers: String,
    failure: String,
}

/// Writes rows as missions end, so that nobody has to remember them: what is remembered would count
/// as memory of the orchestrator.
#[derive(Debug)]
pub struct RowWriter<W: Write> {
    rows: csv::Writer<W>,
    missions: usize,
}

impl<W: Write> RowWriter<W> {
    /// Into a file that is empty.
    pub fn new(file: W) -> Self {
        Self {
            rows: csv::Writer::from_writer(file),
            missions: 0,
        }
    }

    /// Writes what was seen of one mission, to the file itself and not only into memory.
    ///
    /// # Errors
    /// If the file does not take it.
    pub fn add(&mut self, mission: &Mission) -> Result<(), csv::Error> {
        for (name, held) in &mission.processes {
            self.rows.serialize(Row {
                mission: self.missions,
                scenario: mission.scenario.clone(),
                seed: mission.seed,
                begun_s: mission.begun_s,
                lasted_s: mission.lasted_s,
                process: name.clone(),
                samples: held.samples,
                memory_bytes: held.memory_bytes,
                descriptors: held.descriptors,
                early_bytes: held.quarters_bytes.map(|parts| parts[0]),
                middle_bytes: held.quarters_bytes.map(|parts| parts[1]),
                late_bytes: held.quarters_bytes.map(|parts| parts[2]),
                segments: mission.segments,
                leftovers: mission.leftovers.join("\n"),
                failure: mission.failure.clone().unwrap_or_default(),
            })?;
        }
        self.missions += 1;
        Ok(self.rows.flush()?)
    }
}

/// The missions of such rows.
///
/// # Errors
/// The first row that is none, with its line.
pub fn read(rows: impl Read) -> Result<Vec<Mission>, csv::Error> {
    let mut missions: Vec<(usize, Mission)> = Vec::new();
    for row in csv::Reader::from_reader(rows).deserialize() {
        let row: Row = row?;
        let quarters = [row.early_bytes, row.middle_bytes, row.late_bytes];
        let held = Use {
            samples: row.samples,
            memory_bytes: row.memory_bytes,
            descriptors: row.descriptors,
            quarters_bytes: match quarters {
                [Some(early), Some(middle), Some(late)] => Some([early, middle, late]),
                _ => None,
            },
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
            leftovers: row.leftovers.lines().map(str::to_owned).collect(),
            failure: Some(row.failure).filter(|why| !why.is_empty()),
        };
        missions.push((row.mission, mission));
    }
    Ok(missions.into_iter().map(|(_, mission)| mission).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::soak::watch::Held;

    #[test]
    fn what_is_read_is_what_was_written() {
        let held = |quarters_bytes| Use {
            samples: 3,
            memory_bytes: 5,
            descriptors: 30,
            quarters_bytes,
        };
        let mission = |number: u32, failure: Option<&str>| Mission {
            scenario: "chase \"by the clock\"".into(),
            seed: u64::from(number),
            begun_s: 0.1 + f64::from(number),
            lasted_s: 1.0 / 3.0,
            processes: [
                ("orchestrator".to_owned(), held(None)),
                ("police, 1".to_owned(), held(Some([7, 8, 9]))),
            ]
            .into(),
            segments: 40,
            leftovers: vec!["/dev/shm/left, 1".into(); number as usize],
            failure: failure.map(str::to_owned),
        };
        let missions = [mission(0, None), mission(1, Some("two\nlines"))];
        let mut bytes = Vec::new();
        let mut rows = RowWriter::new(&mut bytes);
        for mission in &missions {
            rows.add(mission).unwrap();
        }
        drop(rows);
        assert_eq!(read(&bytes[..]).unwrap(), missions);
    }

    #[test]
    fn a_file_that_is_full_is_told_with_the_mission_that_it_did_not_take() {
        struct Full;
        impl Write for Full {
            fn write(&mut self, _: &[u8]) -> std::io::Result<usize> {
                Err(std::io::ErrorKind::StorageFull.into())
            }
            fn flush(&mut self) -> std::io::Result<()> {
                Ok(())
            }
        }
        let mission = Mission {
            scenario: "chase".into(),
            seed: 1,
            begun_s: 0.0,
            lasted_s: 1.0,
            processes: [("orchestrator".to_owned(), Use::of(&Held::default(), None))].into(),
            segments: 0,
            leftovers: Vec::new(),
            failure: None,
        };
        assert!(RowWriter::new(Full).add(&mission).is_err());
    }

    #[test]
    fn what_is_no_row_is_named_by_its_line() {
        let missions = read(&b""[..]).unwrap();
        assert!(missions.is_empty());
        let error = read(&b"mission,scenario\n0,chase\n"[..]).unwrap_err();
        assert!(error.to_string().contains("line: 2"), "{error}");
    }
}
