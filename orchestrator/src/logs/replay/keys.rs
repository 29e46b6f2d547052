//! Keys, from a terminal or a pipe.

use std::collections::VecDeque;
use std::io::{IsTerminal as _, Stdin};
use std::os::fd::AsFd as _;
use std::time::Duration;

use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::fs::FileType;

use super::terminal::RawTerminal;

/// What somebody wants.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Key {
    /// Space: stop, or go on.
    Pause,
    /// `s` or the right arrow: one tick.
    Step,
    /// The left arrow: some seconds back.
    Back,
    /// The upper arrow.
    Faster,
    /// The lower arrow.
    Slower,
    /// `q`.
    Quit,
}

/// Reads keys from stdin, if somebody can press any there.
pub(super) struct Keys {
    stdin: Stdin,
    /// Set if stdin is one that keys come from.
    terminal: Option<RawTerminal>,
    open: bool,
    /// The beginning of an arrow.
    pending: Vec<u8>,
    /// Pressed, and not yet handed out.
    pressed: VecDeque<Key>,
}

impl Keys {
    /// Lets a terminal hand over keys as they are pressed, until this is dropped. Ctrl-C and its
    /// kin stay what they are. Nothing is read from a terminal whose foreground is somebody else's.
    pub(super) fn open() -> Self {
        let stdin = std::io::stdin();
        let mut keys = Self {
            open: false,
            terminal: None,
            pending: Vec::new(),
            pressed: VecDeque::new(),
            stdin,
        };
        if keys.stdin.is_terminal() {
            keys.terminal = RawTerminal::new(&keys.stdin).ok().flatten();
            keys.open = keys.terminal.is_some();
        } else if let Ok(found) = rustix::fs::fstat(&keys.stdin) {
            let kind = FileType::from_raw_mode(found.st_mode);
            keys.open = matches!(kind, FileType::Fifo | FileType::Socket);
        }
        keys
    }

    /// Whether keys can come.
    pub(super) fn can_come(&self) -> bool {
        self.open || !self.pressed.is_empty()
    }

    /// Whether they come from a person.
    pub(super) fn terminal(&self) -> bool {
        self.terminal.is_some()
    }

    /// The next key; waits for one at most this long.
    pub(super) fn wait(&mut self, timeout: Duration) -> Option<Key> {
        if self.pressed.is_empty() {
            let keys = self.read(timeout);
            self.pressed.extend(keys);
        }
        self.pressed.pop_front()
    }

    fn read(&mut self, timeout: Duration) -> Vec<Key> {
        let timeout = Timespec {
            tv_sec: i64::try_from(timeout.as_secs()).unwrap_or(i64::MAX),
            tv_nsec: i64::from(timeout.subsec_nanos()),
        };
        if !self.open {
            // A signal ends it early: the caller looks.
            let _ = poll(&mut [], Some(&timeout));
            return Vec::new();
        }
        let mut fds = [PollFd::new(&self.stdin, PollFlags::IN)];
        if !matches!(poll(&mut fds, Some(&timeout)), Ok(n) if n > 0) {
            return Vec::new();
        }
        let mut buffer = [0; 64];
        // Not through `Stdin`'s buffer, which `poll` does not know of.
        match rustix::io::read(self.stdin.as_fd(), &mut buffer) {
            Ok(0) if !self.terminal() => {
                self.open = false;
                Vec::new()
            }
            Ok(count) => self.parse(buffer.get(..count).unwrap_or_default()),
            Err(_) => Vec::new(),
        }
    }

    fn parse(&mut self, bytes: &[u8]) -> Vec<Key> {
        let mut keys = Vec::new();
        for &byte in bytes {
            self.pending.push(byte);
            let key = match self.pending.as_slice() {
                [0x1b] | [0x1b, b'[' | b'O'] => continue,
                [b' '] => Some(Key::Pause),
                [b's'] | [0x1b, _, b'C'] => Some(Key::Step),
                [0x1b, _, b'D'] => Some(Key::Back),
                [0x1b, _, b'A'] => Some(Key::Faster),
                [0x1b, _, b'B'] => Some(Key::Slower),
                [b'q'] => Some(Key::Quit),
                _ => None,
            };
            self.pending.clear();
            keys.extend(key);
        }
        keys
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arrows_may_come_in_pieces_and_other_keys_are_nothing() {
        let mut keys = Keys {
            stdin: std::io::stdin(),
            terminal: None,
            open: false,
            pending: Vec::new(),
            pressed: VecDeque::new(),
        };
        assert_eq!(keys.parse(b" s\x1b["), [Key::Pause, Key::Step]);
        assert_eq!(keys.parse(b"C\x1bOD"), [Key::Step, Key::Back]);
        assert_eq!(keys.parse(b"x\x1b[A\x1b[B\n"), [Key::Faster, Key::Slower]);
        assert_eq!(keys.parse(b"q"), [Key::Quit]);
    }
}
