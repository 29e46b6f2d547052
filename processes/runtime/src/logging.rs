//! Log output of a process: plain text on stderr, from a level on.

use tracing_subscriber::filter::{LevelFilter, Targets};
use tracing_subscriber::layer::SubscriberExt as _;
use tracing_subscriber::util::SubscriberInitExt as _;

/// Variable that takes precedence over the level of the run, e.g. `debug` or `warn,runtime=trace`.
const VARIABLE: &str = "PROTEAN_LOG";

/// Parses levels and `module=level`, separated by commas. A single word must be a level: `Targets`
/// would take any other for a module name and enable nothing else, so that a typing error (`debgu`)
/// would silence all logs.
fn parsed(text: &str) -> Option<Targets> {
    text.split(',')
        .all(|word| word.contains('=') || word.trim().parse::<LevelFilter>().is_ok())
        .then(|| text.parse().ok())
        .flatten()
}

/// Returns the log filter: from the variable if it is valid, else from the run, else warnings.
fn filter(variable: Option<&str>, level: &str) -> Targets {
    variable
        .and_then(parsed)
        .or_else(|| parsed(level))
        .unwrap_or_else(|| Targets::new().with_default(LevelFilter::WARN))
}

/// Writes traces from `level` on (`error`, `warn`, `info`, `debug`, `trace`; or per module, as
/// `warn,runtime=trace`) to stderr; `PROTEAN_LOG` takes precedence. A second call in one process
/// changes nothing.
pub fn start(level: &str) {
    let variable = std::env::var(VARIABLE).ok();
    let _ = tracing_subscriber::fmt()
        .with_max_level(LevelFilter::TRACE)
        .with_writer(std::io::stderr)
        .with_ansi(false)
        .without_time()
        .with_target(false)
        .finish()
        .with(filter(variable.as_deref(), level))
        .try_init();
    ipc_types::bus::quiet_transport();
}

#[cfg(test)]
mod tests {
    use tracing::Level;

    use super::*;

    #[test]
    fn the_variable_precedes_the_level_and_invalid_values_do_not_count() {
        for (variable, level, told, silent) in [
            (None, "info", Level::INFO, Level::DEBUG),
            (Some("debug"), "info", Level::DEBUG, Level::TRACE),
            (Some("runtime=louder"), "error", Level::ERROR, Level::WARN),
            (Some("debgu"), "error", Level::ERROR, Level::WARN),
            (None, "louder still", Level::WARN, Level::INFO),
        ] {
            let filter = filter(variable, level);
            assert!(
                filter.would_enable("runtime", &told),
                "{variable:?} {level}"
            );
            assert!(
                !filter.would_enable("runtime", &silent),
                "{variable:?} {level}"
            );
        }
        let filter = filter(Some("warn,runtime=trace"), "info");
        assert!(filter.would_enable("runtime::life", &Level::TRACE));
        assert!(!filter.would_enable("pursuer", &Level::INFO));
    }
}
