//! Tests of existing files and full disks.

use std::collections::BTreeMap;
use std::io;
use std::os::unix::fs::PermissionsExt as _;
use std::path::Path;
use std::sync::Arc;

use super::storage::tests::SmallDisk;
use super::{ChannelSpec, LogOptions, LogWriteError, LogWriter, Manifest};

fn create(path: &Path, force: bool) -> Result<LogWriter, LogWriteError> {
    let options = LogOptions {
        force,
        ..LogOptions::default()
    };
    LogWriter::create(path, &options, &Manifest::default())
}

#[test]
fn an_existing_file_is_kept_unless_forced() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("run.mcap");
    std::fs::write(&path, "precious".repeat(1000)).unwrap();
    let error = create(&path, false).unwrap_err();
    assert!(matches!(error, LogWriteError::Exists { .. }), "{error}");
    assert!(error.to_string().contains("run.mcap"));
    assert!(std::fs::read(&path).unwrap().starts_with(b"precious"));
    create(&path, true).unwrap().finish().unwrap();
    let log = std::fs::read(&path).unwrap();
    assert!(log.starts_with(mcap::MAGIC) && log.ends_with(mcap::MAGIC));
    assert_eq!(path.metadata().unwrap().permissions().mode() & 0o777, 0o600);
}

#[test]
fn a_file_that_another_run_writes_is_refused() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("run.mcap");
    let log = create(&path, false).unwrap();
    assert!(matches!(
        create(&path, false),
        Err(LogWriteError::Exists { .. })
    ));
    let error = create(&path, true).unwrap_err();
    assert!(matches!(error, LogWriteError::InUse { .. }), "{error}");
    assert!(error.to_string().contains("run.mcap"));
    log.finish().unwrap();
    assert!(matches!(
        create(&path, false),
        Err(LogWriteError::Exists { .. })
    ));
    create(&path, true).unwrap();
}

#[test]
fn a_link_is_refused_and_its_target_kept() {
    let directory = tempfile::tempdir().unwrap();
    let (file, link) = (
        directory.path().join("file.mcap"),
        directory.path().join("link.mcap"),
    );
    std::fs::write(&file, "old").unwrap();
    std::os::unix::fs::symlink("file.mcap", &link).unwrap();
    let error = create(&link, true).unwrap_err();
    assert!(matches!(error, LogWriteError::NotAFile { .. }), "{error}");
    assert!(link.is_symlink());
    assert_eq!(std::fs::read(&file).unwrap(), b"old");
}

#[test]
fn an_error_names_the_path() {
    let directory = tempfile::tempdir().unwrap();
    for force in [false, true] {
        let error = create(directory.path(), force).unwrap_err();
        assert!(matches!(error, LogWriteError::NotAFile { .. }), "{error}");
        let error = create(Path::new("/dev/null"), force).unwrap_err();
        assert!(matches!(error, LogWriteError::NotAFile { .. }), "{error}");
        let missing = directory.path().join("no/such/run.mcap");
        let error = create(&missing, force).unwrap_err();
        assert!(matches!(error, LogWriteError::Create { .. }), "{error}");
        assert!(error.to_string().contains("no/such/run.mcap"), "{error}");
    }
}

#[test]
fn on_a_full_disk_all_complete_chunks_stay_readable() {
    for room in [2_000, 30_000, 100_001, 100_002, 150_000] {
        let disk = SmallDisk::new(room);
        let contents = Arc::clone(&disk.contents);
        let options = LogOptions {
            chunk_bytes: 10_000,
            ..LogOptions::default()
        };
        let path = Path::new("full.mcap");
        let mut log = LogWriter::on(Box::new(disk), path, &options, &Manifest::default()).unwrap();
        let spec = ChannelSpec {
            topic: "noise",
            schema_name: "",
            schema_encoding: "",
            schema: &[],
            message_encoding: "",
            metadata: &BTreeMap::new(),
        };
        let channel = log.add_channel(&spec).unwrap();
        let mut state = 1_u64;
        let mut written = 0_u32;
        let error = loop {
            let noise: Vec<u8> = (0..500)
                .map(|_| {
                    state = state
                        .wrapping_mul(6_364_136_223_846_793_005)
                        .wrapping_add(1);
                    (state >> 56) as u8
                })
                .collect();
            match log.write(channel, written, 0, 0, &noise) {
                Ok(()) => written += 1,
                Err(error) => break error,
            }
        };
        let LogWriteError::Write {
            source, readable, ..
        } = &error
        else {
            panic!("{error}")
        };
        assert_eq!(source.kind(), io::ErrorKind::StorageFull);
        assert!(error.to_string().contains("full.mcap"), "{error}");
        assert!(
            log.write(channel, 0, 0, 0, &[])
                .and_then(|()| log.flush())
                .is_err()
        );
        drop(log);

        let contents = contents.lock().unwrap();
        assert_eq!(contents.len() as u64, *readable);
        let options = mcap::read::Options::IgnoreEndMagic.into();
        let stream = mcap::MessageStream::new_with_options(&contents, options).unwrap();
        let read = stream.map_while(Result::ok).count() as u32;
        // A chunk contains 20 messages; all chunks except the one that did not fit are readable.
        assert_eq!(read, written / 20 * 20, "room for {room}");
    }
}

#[test]
fn a_log_of_which_nothing_could_be_written_is_removed() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("run.mcap");
    for force in [false, true] {
        let options = LogOptions {
            force,
            ..LogOptions::default()
        };
        let error = LogWriter::create_on(&path, &options, &Manifest::default(), |_| {
            Box::new(SmallDisk::new(10))
        })
        .unwrap_err();
        assert!(
            error.to_string().contains("nothing of it is left"),
            "{error}"
        );
        assert!(!path.exists());
        std::fs::write(&path, "old").unwrap();
    }
}
