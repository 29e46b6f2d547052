//! Storage of growing files: the disk, or in tests a disk of limited size.

use std::fs::File;
use std::io::{self, Seek as _, SeekFrom, Write as _};
use std::os::unix::fs::MetadataExt as _;

/// Storage with append and truncate.
pub trait Storage: Send {
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
pub mod tests;
