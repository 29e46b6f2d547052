//! Functions of the operating system: files, processes, signals and the terminal.

pub mod atomic_file;
pub mod browser;
pub mod descriptors;
pub mod file_kind;
pub mod file_lock;
pub mod fork;
pub mod limits;
pub mod machine;
pub mod output_format;
pub mod output_lines;
pub mod own_file;
pub mod own_name;
pub mod presence;
pub mod proc;
pub mod program;
pub mod progress;
pub mod scratch;
pub mod shell;
pub mod signals;
pub mod spawn;
pub mod terminal;
