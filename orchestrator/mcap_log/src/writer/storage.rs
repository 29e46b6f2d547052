//! Storage of growing files: the disk, or in tests a disk of limited size.

use std::fs::File;
use std::io::{self, Seek as _, SeekFrom, Write as _};
use std::os::unix::fs::MetadataExt as _;

/// Storage with append and truncate.
pub(crate) trait Storage: Send {
    /// Appends all bytes.
    fn append(&mut self, bytes: &[u8]) -> io::Result<()>;
    /// Truncates the file to this length (bytes); the next append continues there.
    fn cut(&mut self, length: u64) -> io::Result<()>;
    /// Waits until all data are on the disk.
    fn sync(&mut self) -> io::Result<()>;
}

impl Storage for File {
    fn append(&mut self, bytes: &[u8]) -> io::Result<()> {
        // Writes to a deleted file would be lost.
        if self.metadata()?.nlink() == 0 {
            let gone = "the file or its directory was removed";
            return Err(io::Error::new(io::ErrorKind::NotFound, gone));
        }
        // A second write happens only after a short one, for example on a full disk.
        self.write_all(bytes)
    }
    fn cut(&mut self, length: u64) -> io::Result<()> {
        self.set_len(length)?;
        self.seek(SeekFrom::End(0)).map(drop)
    }
    fn sync(&mut self) -> io::Result<()> {
        self.sync_all()
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use std::sync::{Arc, Mutex};

    use super::*;

    /// A disk of limited size.
    #[derive(Debug, Clone)]
    pub(crate) struct SmallDisk {
        pub contents: Arc<Mutex<Vec<u8>>>,
        room: usize,
    }

    impl SmallDisk {
        pub fn new(room: usize) -> Self {
            let contents = Arc::default();
            Self { contents, room }
        }
    }

    impl Storage for SmallDisk {
        fn append(&mut self, bytes: &[u8]) -> io::Result<()> {
            let mut contents = self.contents.lock().unwrap();
            let fits = bytes.len().min(self.room - contents.len());
            contents.extend_from_slice(&bytes[..fits]);
            if fits < bytes.len() {
                return Err(io::ErrorKind::StorageFull.into());
            }
            Ok(())
        }
        fn cut(&mut self, length: u64) -> io::Result<()> {
            self.contents.lock().unwrap().truncate(length as usize);
            Ok(())
        }
        fn sync(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    #[test]
    fn an_append_after_a_truncation_continues_there() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("log");
        let mut file = File::create_new(&path).unwrap();
        let storage: &mut dyn Storage = &mut file;
        storage.append(b"whole half").unwrap();
        storage.cut(6).unwrap();
        storage.append(b"next").unwrap();
        storage.sync().unwrap();
        assert_eq!(std::fs::read(&path).unwrap(), b"whole next");
        std::fs::remove_file(&path).unwrap();
        assert!(file.append(b"more").is_err(), "the file is deleted");
    }
}
