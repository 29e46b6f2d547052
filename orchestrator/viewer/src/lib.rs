//! Visualisation of a run in viewers (Foxglove, Lichtblick, `RViz`, Rerun, `PlotJuggler`).
//!
//! * `topics`: the viewer topics, ROS 2 messages that [`viewer_topics`] derives from the messages of a run: a
//!   [`recorder::Recording`] writes them into the log;
//! * `live`: [`LiveServer`], which sends logged messages to viewers during the run, and shows it in a browser.

mod live;
mod topics;

#[cfg(test)]
mod tests;

pub use live::{
    BroadcastHandle, Broadcaster, Control, LiveError, LiveOptions, LiveServer, LiveTotals, Wish,
};
pub use topics::{ViewerOptions, viewer_topics};
