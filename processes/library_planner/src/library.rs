//! A loaded library and its table of functions.

use core::ffi::c_void;
use std::path::{Path, PathBuf};

use runtime::declaration::WrittenDeclaration;

use crate::abi::{BELIEFS, INPUTS, PlannerTable, SCANS, Start, Steering, Tick, VERSION, WAYS};
use crate::error::{TableError, Unexpected};
use crate::topics;

/// The function that a library exports.
const SYMBOL: &str = "protean_planner_table";

/// Reason why a file is no planner.
#[derive(Debug, thiserror::Error)]
pub enum LibraryError {
    /// The file cannot be read.
    #[error("{}: cannot be read: {source}: expected the shared library of a planner", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// Error of the operating system.
        source: std::io::Error,
    },
    /// The program has the C library inside; a second one would come with the planner.
    #[error("{}: this statically linked program loads no shared libraries: expected the program of the wheel, or of an own build", .0.display())]
    StaticProgram(PathBuf),
    /// The system does not load it.
    #[error("{}: {source}: expected the shared library of a planner, built for this machine with -shared", path.display())]
    Load {
        /// The file.
        path: PathBuf,
        /// Error of the dynamic linker.
        source: libloading::Error,
    },
    /// It exports no planner.
    #[error("{}: no function {SYMBOL}: expected a planner built with protean_planner.h (`protean schema planner`)", .0.display())]
    Symbol(PathBuf),
    /// Its table is of another version of the interface.
    #[error("{}: a planner of interface version {found}: expected version {VERSION}; build it with the header of `protean schema planner`", path.display())]
    Version {
        /// The file.
        path: PathBuf,
        /// Its version.
        found: u32,
    },
    /// Its table is not complete.
    #[error("{}: {source}", path.display())]
    Table {
        /// The file.
        path: PathBuf,
        /// Part of the table, and what is expected.
        source: TableError,
    },
}

/// A library with the functions of a planner. It stays loaded to the end of the program, as threads of its own may.
#[derive(Debug, Clone, Copy)]
pub struct Library {
    pub(crate) table: &'static PlannerTable,
}

// SAFETY: neither a library nor this program changes a table and its topics, as the header demands; they stay in memory.
#[expect(unsafe_code, reason = "a table has addresses of arrays")]
unsafe impl Sync for Library {}
// SAFETY: as for `Sync`; its functions are called by the thread that has created what they get.
#[expect(unsafe_code, reason = "a table has addresses of arrays")]
unsafe impl Send for Library {}

/// Libraries are the same if their tables are at the same address.
impl PartialEq for Library {
    fn eq(&self, other: &Self) -> bool {
        std::ptr::eq(self.table, other.table)
    }
}

/// The one function that a library exports.
type GetTable = unsafe extern "C" fn() -> *const PlannerTable;

impl Library {
    /// Loads a library and checks its table.
    ///
    /// Loading executes code of the library.
    ///
    /// # Errors
    /// [`LibraryError`] names the file and what is expected.
    #[expect(unsafe_code, reason = "a library is loaded and trusted by its table")]
    pub fn load(path: &Path) -> Result<Self, LibraryError> {
        let file = |source| LibraryError::File {
            path: path.to_owned(),
            source,
        };
        // A name without a folder would be searched in the folders of the system.
        let full = std::path::absolute(path).map_err(file)?;
        std::fs::File::open(&full).map_err(file)?;
        if cfg!(target_feature = "crt-static") {
            return Err(LibraryError::StaticProgram(path.to_owned()));
        }
        // SAFETY: the user names the library as code of this process; the header states the duties of such code.
        let loaded = unsafe { libloading::os::unix::Library::new(&full) };
        let loaded = loaded.map_err(|source| LibraryError::Load {
            path: path.to_owned(),
            source,
        })?;
        // SAFETY: the header declares the function of this name with this type.
        let table = match unsafe { loaded.get::<GetTable>(SYMBOL.as_bytes()) } {
            // SAFETY: as above; the function has no arguments.
            Ok(get_table) => unsafe { get_table() },
            Err(_) => return Err(LibraryError::Symbol(path.to_owned())),
        };
        // The code behind the table must stay.
        std::mem::forget(loaded);
        let fault = |source| LibraryError::Table {
            path: path.to_owned(),
            source,
        };
        let unexpected = |part: &str, expected: &str| fault(Unexpected::new(part, expected).into());
        if table.is_null() || !table.is_aligned() {
            return Err(unexpected(
                "result of protean_planner_table",
                "the address of a table",
            ));
        }
        // SAFETY: every version of the table begins with its version, and the library stays loaded.
        let found = unsafe { table.cast::<u32>().read() };
        if found != VERSION {
            return Err(LibraryError::Version {
                path: path.to_owned(),
                found,
            });
        }
        // SAFETY: a table of this version has this layout, which the header asserts, and never changes.
        let table = unsafe { &*table };
        let is_process = table.step.is_some();
        if table.create.is_none() || table.destroy.is_none() || is_process == table.steer.is_some()
        {
            return Err(unexpected(
                "functions",
                "create, destroy, and either steer or step; the others of the table are NULL",
            ));
        }
        if table.inputs & !(BELIEFS | SCANS | WAYS) != 0 {
            return Err(unexpected(
                "unknown inputs",
                "a sum of PROTEAN_BELIEFS, PROTEAN_SCANS and PROTEAN_WAYS",
            ));
        }
        let library = Self { table };
        if is_process {
            if table.inputs != 0 {
                return Err(unexpected(
                    "inputs of a process",
                    "0; it names its topics in reads",
                ));
            }
            library.declaration().map_err(fault)?;
        } else {
            if table.write_count != 0 {
                return Err(unexpected("writes of a planner", "none, or step"));
            }
            library.reads().map_err(|error| fault(error.into()))?;
        }
        Ok(library)
    }

    /// Returns `true` if it is a process with topics of its own, not a planner.
    pub fn is_process(self) -> bool {
        self.table.step.is_some()
    }

    /// Returns the topics that a process reads and writes.
    ///
    /// # Errors
    /// [`TableError`] names the topic; [`Self::load`] has checked it.
    pub fn declaration(self) -> Result<WrittenDeclaration, TableError> {
        topics::declaration(self.table)
    }

    /// Returns the names of the topics that it reads.
    ///
    /// # Errors
    /// As [`Self::declaration`].
    pub(crate) fn reads(self) -> Result<Vec<String>, Unexpected> {
        topics::reads(self.table)
    }

    /// Returns `true` if it uses these inputs.
    pub(crate) fn uses(self, input: u32) -> bool {
        self.table.inputs & input != 0
    }

    /// Returns its inputs beside state and map in words.
    pub(crate) fn inputs(self) -> String {
        let used = INPUTS.iter().filter(|(_, bit, _)| self.uses(*bit));
        let mut names: Vec<String> = used.map(|(name, ..)| (*name).to_owned()).collect();
        names.extend(self.reads().unwrap_or_default());
        if names.is_empty() {
            return "no further inputs".to_owned();
        }
        names.join(", ")
    }
}

/// Calls of the functions; their pointers are checked by [`Library::load`].
#[expect(unsafe_code, reason = "calls of the library")]
impl Library {
    /// Returns a new planner; NULL if it refuses.
    pub(crate) fn create(self, start: &Start) -> *mut c_void {
        let Some(create) = self.table.create else {
            return std::ptr::null_mut();
        };
        // SAFETY: the function has this type, as the header asserts; all pointers of `start` are valid for the call.
        unsafe { create(start) }
    }

    /// Steers in a tick with a planner that [`Self::create`] has returned.
    pub(crate) fn steer(self, planner: *mut c_void, tick: &Tick, out: &mut Steering) {
        if let Some(steer) = self.table.steer {
            // SAFETY: as in `create`; every planner is used by one thread and destroyed once, at its end.
            unsafe { steer(planner, tick, out) }
        }
    }

    /// Steps a process that [`Self::create`] has returned.
    pub(crate) fn step(self, process: *mut c_void, tick: &Tick) {
        if let Some(step) = self.table.step {
            // SAFETY: as in `steer`.
            unsafe { step(process, tick) }
        }
    }

    /// Frees a planner that [`Self::create`] has returned.
    pub(crate) fn destroy(self, planner: *mut c_void) {
        if let Some(destroy) = self.table.destroy {
            // SAFETY: as in `steer`.
            unsafe { destroy(planner) }
        }
    }
}
