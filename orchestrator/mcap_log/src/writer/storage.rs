//! What files that grow are written to: the disk, or in tests one that fills up.

use std::fs::File;
use std::io::{self, Seek as _, SeekFrom, Write as _};
use std::os::unix::fs::MetadataExt as _;

/// Bytes that are appended, and cut back when an append fails half-way.
pub(crate) trait Storage: Send {
    /// Appends all bytes.
    fn append(&mut self, bytes: &[u8]) -> io::Result<()>;
    /// Cuts the file to this length (bytes); what is appended next goes there.
    fn cut(&mut self, length: u64) -> io::Result<()>;
    /// Waits until everything is on the disk.
    fn sync(&mut self) -> io::Result<()>;
}

impl Storage for File {
    fn append(&mut self, bytes: &[u8]) -> io::Result<()> {
        // Bytes would go on into a file that nobody can find again.
        if self.metadata()?.nlink() == 0 {
            let gone = "it was removed, or its directory was";
            return Err(io::Error::new(io::ErrorKind::NotFound, gone));
        }
        // Two writes would only happen when the first was cut short, by a full disk say.
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

    /// A disk with room for so many bytes.
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
    fn what_is_appended_after_a_cut_stands_where_it_was_cut() {
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
        assert!(file.append(b"more").is_err(), "nobody would ever see it");
    }
}
