//! A terminal, with a test in the place of the person before it.

use std::fs::File;
use std::io::{Read as _, Write as _};
use std::os::fd::OwnedFd;
use std::sync::{Arc, Mutex};

use rustix::fs::{Mode, OFlags};
use rustix::pty::OpenptFlags;
use rustix::termios::{self, LocalModes, OptionalActions, SpecialCodeIndex};

/// Both ends of a terminal.
pub struct Terminal {
    /// Where keys are pressed.
    pub outside: OwnedFd,
    /// What programs see.
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
        // As no terminal is by default: not the kernel's modes are given back, but these.
        let mut modes = termios::tcgetattr(&inside).unwrap();
        modes.special_codes[SpecialCodeIndex::VMIN] = 7;
        modes.local_modes.remove(LocalModes::ECHOK);
        termios::tcsetattr(&inside, OptionalActions::Now, &modes).unwrap();
        Self { outside, inside }
    }

    /// What a replay changes, and what it does not.
    pub fn modes(&self) -> (LocalModes, u8, u8) {
        let modes = termios::tcgetattr(&self.inside).unwrap();
        let code = |index| modes.special_codes[index];
        (
            modes.local_modes,
            code(SpecialCodeIndex::VMIN),
            code(SpecialCodeIndex::VTIME),
        )
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
