//! The rules of the game.

use geometry::extent::{not_negative, positive};
use geometry::map::MAX_EXITS;
use geometry::region::Region;
use parameters::{Parameters, above};

use super::CoverageSpec;

parameters::table! {
    /// Rules of a mission; the defaults are a world without a game: no capture, no exits, no end.
    pub struct RulesSpec {
        /// Capture of evaders by pursuers of hostile teams; none if absent.
        pub capture: Option<CaptureSpec>,
        /// Exits for evaders, in addition to those of the map.
        #[schemars(length(max = MAX_EXITS))]
        pub exits: Vec<Region>,
        /// Simulated time after which evaders and robots with a goal are timed out; never if absent.
        pub time_limit: Option<f64> [above(0).at_most(1e9).unit("s")],
        /// End of the mission before the time limit.
        pub end: MissionEnd = MissionEnd::Decided,
        /// Accounting of the visited area; none if absent.
        #[serde(skip_serializing_if = "Option::is_none")]
        pub coverage: Option<CoverageSpec>,
        /// Behaviour of a blocked robot.
        pub blocked: ObstacleResponse = ObstacleResponse::Slide,
        /// Body of a caught evader.
        pub caught: OutOfPlay = OutOfPlay::Stay,
        /// Body of an escaped evader (it left the arena: removed by default).
        pub escaped: OutOfPlay = OutOfPlay::Remove,
    }
}

parameters::table! {
    /// Capture of an evader by a pursuer of a hostile team.
    #[derive(Copy)]
    pub struct CaptureSpec {
        /// Distance of centres below which a pursuer catches an evader.
        pub radius: f64 [positive("m")] = 0.3,
        /// Time for which a pursuer must have been that near without interruption. At 0 the first
        /// tick catches.
        pub dwell: f64 [not_negative("s")] = 0.0,
        /// `true`: distance alone decides (the paper's rule). `false`: the straight line between the centres must
        /// also be free of walls and obstacles; other robots do not count.
        pub through_walls: bool = true,
    }
}

parameters::choice! {
    /// Behaviour of a robot that hits an obstacle.
    pub enum ObstacleResponse {
        /// The robot keeps the part of its motion along the obstacle.
        #[default]
        Slide,
        /// The robot stays at the point of contact until its motion leads away.
        Stop,
    }
}

parameters::choice! {
    /// End of a mission before its time limit.
    pub enum MissionEnd {
        /// As soon as every evader and every robot with a goal has finished; without such robots there is none.
        #[default]
        Decided,
        /// None: a patrol goes on after its intruders.
        TimeLimit,
    }
}

parameters::choice! {
    /// Body of a robot that is out of the game.
    pub enum OutOfPlay {
        /// It stays, as an obstacle for other robots and their scans.
        #[default]
        Stay,
        /// It is removed: robots neither touch nor see it.
        Remove,
    }
}

impl Parameters for RulesSpec {}

#[cfg(test)]
mod tests {
    use parameters::check;

    use super::*;

    #[test]
    fn absent_rules_are_a_world_without_a_game() {
        let rules: RulesSpec = toml::from_str("").unwrap();
        assert_eq!(rules.capture, None);
        assert_eq!(rules.caught, OutOfPlay::Stay);
        assert_eq!(rules.escaped, OutOfPlay::Remove);
        assert_eq!(rules.blocked, ObstacleResponse::Slide);
        let rules: RulesSpec = toml::from_str(
            "capture = {}\nexits = [{ circle = { center = [9, 0], radius = 0.5 } }]",
        )
        .unwrap();
        assert_eq!(rules.capture.unwrap().radius, 0.3);
        assert!(check(&rules).is_ok());
    }

    #[test]
    fn bad_rules_are_named() {
        let rules: RulesSpec = toml::from_str("time_limit = -1.0").unwrap();
        assert!(
            check(&rules)
                .unwrap_err()
                .to_string()
                .contains("`time_limit` is -1")
        );
        assert!(toml::from_str::<RulesSpec>("capture = { radios = 1 }").is_err());
    }
}
