//! Metrics of figures, by name; `protean_robotics.lab.figures` computes them.

parameters::choice! {
    /// Quantity of each cell that a figure shows.
    pub enum Metric {
        /// Escaped evaders of all evaders, 0 to 1.
        #[default]
        EscapeChance,
        /// Caught evaders of all evaders, 0 to 1.
        CaptureChance,
        /// Evaders that were neither caught nor escaped in time, of all evaders, 0 to 1.
        HeldOutChance,
        /// Mean simulated length of a game (s).
        GameTime,
        /// Mean simulated time of the first capture, of games that have one (s).
        FirstCapture,
        /// Mean simulated time of the first escape, of games that have one (s).
        FirstEscape,
        /// Mean number of contact episodes of all robots per game.
        Contacts,
        /// Mean speed of the evaders while they were in the game (m/s).
        EvaderMeanSpeed,
        /// Mean part of the game in which an escape was possible, 0 to 1; needs a `referee`.
        EscapePossible,
        /// Mean length of a lap through all its waypoints, of the robots that complete laps (m).
        LapLength,
        /// Mean time of the longest lap (s).
        LongestLap,
        /// Mean distance of a lap through all its waypoints from the route, at equal times in the time of the patrol (m).
        PlannedMae,
        /// Mean distance of driven laps from the route (m).
        DrivenMae,
        /// Mean change of direction on laps through all their waypoints (rad).
        PlannedMaa,
        /// Mean change of direction on driven laps (rad).
        DrivenMaa,
        /// Waypoints left out, of all, 0 to 1.
        LeftOut,
        /// Visited part of the area that can be visited, 0 to 1; needs `[rules.coverage]`.
        Coverage,
    }
}
