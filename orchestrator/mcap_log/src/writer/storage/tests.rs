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
