//! Options with one meaning in every command.

/// The option `--json`.
#[derive(Debug, Clone, Default, clap::Args)]
pub(super) struct JsonArg {
    /// Print one JSON object
    #[arg(long)]
    pub(super) json: bool,
}

/// The option `--force`.
#[derive(Debug, Clone, Default, clap::Args)]
pub(super) struct ForceArg {
    /// Overwrite existing output
    #[arg(long)]
    pub(super) force: bool,
}

/// The option `--quiet`.
#[derive(Debug, Clone, Default, clap::Args)]
pub(super) struct QuietArg {
    /// Print only errors and the result
    #[arg(long, short)]
    pub(super) quiet: bool,
}

/// The option `--allow-external`.
#[derive(Debug, Clone, Default, clap::Args)]
pub(super) struct ExternalArg {
    /// Start external programs that the scenario names, without asking
    #[arg(long)]
    pub(super) allow_external: bool,
}
