//! A terminal, with a test in the place of the person before it.

use std::fs::File;
use std::io::{Read as _, Write as _};
use std::os::fd::OwnedFd;
use std::sync::{Arc, Mutex};

use rustix::fs::{Mode, OFlags};
use rustix::pty::OpenptFlags;

/// Both ends of a terminal.
pub struct Terminal {
    /// The side of the keyboard.
    pub outside: OwnedFd,
    /// The side of the programs.
    pub inside: OwnedFd,
}

impl Terminal {
    pub fn open() -> Self {
        let flags = OpenptFlags::RDWR | OpenptFlags::NOCTTY | OpenptFlags::CLOEXEC;
        let outside = rustix::pty::openpt(flags).unwrap();
        rustix::pty::grantpt(&outside).unwrap();
        rustix::pty::unlockpt(&outside).unwrap();
        let name = rustix::pty::ptsname(&outside, Vec::new()).unwrap();
        let flags = OFlags::RDWR | OFlags::NOCTTY | OFlags::CLOEXEC;
        let inside = rustix::fs::open(name, flags, Mode::empty()).unwrap();
        Self { outside, inside }
    }

    /// Gathers what programs write to it, until the last of them and `inside` are gone.
    pub fn listen(&self) -> Arc<Mutex<String>> {
        let heard = Arc::new(Mutex::new(String::new()));
        let (mut outside, to) = (File::from(self.outside.try_clone().unwrap()), heard.clone());
        std::thread::spawn(move || {
            let mut bytes = [0_u8; 4096];
            while let Ok(read @ 1..) = outside.read(&mut bytes) {
                let text = String::from_utf8_lossy(&bytes[..read]).into_owned();
                to.lock().unwrap().push_str(&text);
            }
        });
        heard
    }

    /// Types.
    pub fn press(&self, keys: &str) {
        let mut outside = File::from(self.outside.try_clone().unwrap());
        outside.write_all(keys.as_bytes()).unwrap();
    }
}
