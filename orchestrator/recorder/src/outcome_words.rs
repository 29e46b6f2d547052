//! The outcome of a run in words.

use super::summary::{CoverageOutcome, RobotOutcome, WaypointOutcome};
use super::time_text::time_text;

/// Outcomes of evaders, the better for them first, and their words.
const EVADERS: [(&str, &str); 6] = [
    ("escaped", "escaped"),
    ("goal_reached", "reached the goal"),
    ("timed_out", "held out"),
    ("active", "still free"),
    ("disabled", "disabled"),
    ("caught", "caught"),
];

/// Returns who won or what was achieved, as one line without a full stop.
///
/// ```
/// use recorder::{RobotOutcome, outcome_words};
///
/// let evader = |name: &str, outcome: &str, time_s| RobotOutcome {
///     name: name.to_owned(),
///     team: "evader".to_owned(),
///     outcome: outcome.to_owned(),
///     time_s,
///     ..RobotOutcome::default()
/// };
/// let one_each = [evader("a", "caught", 29.1), evader("b", "escaped", 40.0)];
/// assert_eq!(outcome_words(&one_each, None), "1 of 2 evaders escaped (b), 1 caught");
/// let caught = [evader("a", "caught", 29.1), evader("b", "caught", 135.7)];
/// let words = "the Police win: 2 of 2 evaders caught, the last after 135.70 s";
/// assert_eq!(outcome_words(&caught, None), words);
/// ```
pub fn outcome_words(robots: &[RobotOutcome], coverage: Option<&CoverageOutcome>) -> String {
    let parts = [
        evaders(robots),
        goals(robots),
        coverage.map(|c| {
            let share = 100.0 * c.coverable_fraction;
            format!("{share:.1} % of the coverable area visited")
        }),
        waypoints(robots),
    ];
    let parts: Vec<String> = parts.into_iter().flatten().collect();
    if parts.is_empty() {
        format!("ended after {} s", last_time(robots.iter()))
    } else {
        parts.join("; ")
    }
}

/// Time of the last of these outcomes, as text (s).
fn last_time<'a>(robots: impl Iterator<Item = &'a RobotOutcome>) -> String {
    time_text(robots.map(|robot| robot.time_s).fold(0.0, f64::max))
}

/// Names of the robots with this outcome.
fn names<'a>(robots: impl Iterator<Item = &'a RobotOutcome>, outcome: &str) -> String {
    let names = robots.filter(|robot| robot.outcome == outcome);
    names
        .map(|robot| robot.name.as_str())
        .collect::<Vec<_>>()
        .join(", ")
}

/// The outcomes of the evaders; `None` without evaders.
fn evaders(robots: &[RobotOutcome]) -> Option<String> {
    let evaders = || robots.iter().filter(|robot| robot.role() == "evader");
    let all = evaders().count();
    let count = |outcome| evaders().filter(|robot| robot.outcome == outcome).count();
    let mut words = String::new();
    for (outcome, word) in EVADERS {
        match count(outcome) {
            0 => {}
            1 if all == 1 => words = format!("{} {word}", names(evaders(), outcome)),
            some if words.is_empty() => {
                words = format!("{some} of {all} evaders {word}");
                if outcome == "escaped" && some < all {
                    words += &format!(" ({})", names(evaders(), outcome));
                }
            }
            some => words += &format!(", {some} {word}"),
        }
    }
    let (caught, open) = (count("caught"), count("active") + count("disabled"));
    let has_pursuers = robots.iter().any(|robot| robot.role() == "pursuer");
    let winner = match (caught, open) {
        _ if all == 0 => return None,
        (0, 0) if !has_pursuers => String::new(),
        (caught, _) if caught == all => winner(robots, "pursuer", ("police", "Police")),
        (0, 0) => winner(robots, "evader", ("evader", "evaders")),
        _ => return Some(words),
    };
    let last = if all == 1 { "" } else { ", the last" };
    let time = last_time(evaders());
    Some(format!("{winner}{words}{last} after {time} s"))
}

/// Returns the words for the victory of the robots of a role, which the robots of its `standard` team have without
/// their team's name.
fn winner(robots: &[RobotOutcome], role: &str, (standard, name): (&str, &str)) -> String {
    let mut teams = robots.iter().filter(|robot| robot.role() == role);
    let first = teams.next().map_or(standard, |robot| &robot.team);
    let is_one = teams.all(|robot| robot.team == first);
    match first {
        _ if !is_one => format!("the {role}s win: "),
        team if team == standard => format!("the {name} win: "),
        team => format!("team {team} wins: "),
    }
}

/// The outcomes of the other robots that have goals; `None` if no goal was decided.
fn goals(robots: &[RobotOutcome]) -> Option<String> {
    let others = || robots.iter().filter(|robot| robot.role() != "evader");
    let reached = || others().filter(|robot| robot.outcome == "goal_reached");
    let is_decided = |robot: &RobotOutcome| robot.outcome == "timed_out";
    if reached().count() == 0 && !others().any(is_decided) {
        return None;
    }
    let (reached, time, all) = (reached().count(), last_time(reached()), others().count());
    Some(match (reached, all) {
        (0, _) => "no robot reached its goal".to_owned(),
        (1, 1) => format!("the robot reached its goal after {time} s"),
        _ => format!("{reached} of {all} robots reached their goals, the last after {time} s"),
    })
}

/// The outcomes of all waypoints; `None` without waypoints.
fn waypoints(robots: &[RobotOutcome]) -> Option<String> {
    let visits = || robots.iter().filter_map(|robot| robot.waypoints.as_ref());
    let reached: u64 = visits().map(|w| w.reached).sum();
    let left_out: u64 = visits().map(WaypointOutcome::left_out).sum();
    let all = reached + left_out;
    let laps: u32 = visits().filter_map(|w| w.laps).sum();
    let laps = match laps {
        0 => String::new(),
        1 => " in 1 lap".to_owned(),
        laps => format!(" in {laps} laps"),
    };
    (all > 0).then(|| format!("{reached} of {all} waypoints reached{laps}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn robot(team: &str, outcome: &str, time_s: f64) -> RobotOutcome {
        RobotOutcome {
            name: "r".to_owned(),
            team: team.to_owned(),
            outcome: outcome.to_owned(),
            time_s,
            ..RobotOutcome::default()
        }
    }

    #[test]
    fn the_team_without_a_loss_wins() {
        let police = robot("police", "active", 50.0);
        for (evaders, words) in [
            (
                vec![("escaped", 30.0), ("timed_out", 50.0)],
                "the evaders win: 1 of 2 evaders escaped (r), 1 held out, the last after 50.00 s",
            ),
            (
                vec![("caught", 12.34)],
                "the Police win: r caught after 12.34 s",
            ),
            (
                vec![("caught", 12.0), ("active", 50.0)],
                "1 of 2 evaders still free, 1 caught",
            ),
            (
                vec![("caught", 1.0), ("timed_out", 50.0), ("escaped", 2.0)],
                "1 of 3 evaders escaped (r), 1 held out, 1 caught",
            ),
        ] {
            let evaders = evaders.into_iter().map(|(o, t)| robot("evader", o, t));
            let robots: Vec<_> = [police.clone()].into_iter().chain(evaders).collect();
            assert_eq!(outcome_words(&robots, None), words);
        }
        let of = |team: &str, role: &str, outcome| RobotOutcome {
            role: role.to_owned(),
            ..robot(team, outcome, 12.34)
        };
        let guards = of("guards", "pursuer", "active");
        let (dogs, thief) = (of("dogs", "pursuer", "active"), "thieves");
        let caught = of(thief, "evader", "caught");
        let words = |robots: &[RobotOutcome]| outcome_words(robots, None);
        assert_eq!(
            words(&[guards.clone(), caught.clone()]),
            "team guards wins: r caught after 12.34 s"
        );
        assert_eq!(
            words(&[guards.clone(), dogs, caught]),
            "the pursuers win: r caught after 12.34 s"
        );
        assert_eq!(
            words(&[guards, of(thief, "evader", "escaped")]),
            "team thieves wins: r escaped after 12.34 s"
        );
        let alone = [robot("evader", "escaped", 21.15)];
        assert_eq!(outcome_words(&alone, None), "r escaped after 21.15 s");
    }

    #[test]
    fn robots_with_goals_waypoints_and_areas_have_words() {
        let drives = robot("neutral", "active", 60.0);
        let arrived = robot("neutral", "goal_reached", 41.2);
        let late = robot("neutral", "timed_out", 60.0);
        let words = |robots: &[RobotOutcome]| outcome_words(robots, None);
        assert_eq!(words(std::slice::from_ref(&drives)), "ended after 60.00 s");
        assert_eq!(
            words(std::slice::from_ref(&late)),
            "no robot reached its goal"
        );
        assert_eq!(
            words(std::slice::from_ref(&arrived)),
            "the robot reached its goal after 41.20 s"
        );
        assert_eq!(
            words(&[arrived, late]),
            "1 of 2 robots reached their goals, the last after 41.20 s"
        );
        let guard = RobotOutcome {
            waypoints: Some(WaypointOutcome {
                reached: 190,
                inside_obstacle: 1,
                timed_out: 2,
                unreachable: 0,
                stuck: 0,
                route_left_out: 0,
                farthest_m: 0.1,
                laps: Some(5),
                longest_lap_s: None,
                lap_limit_s: None,
                planned: None,
                driven: None,
            }),
            ..drives
        };
        let coverage = CoverageOutcome {
            fraction: 0.5,
            coverable_fraction: 0.982,
            free_m2: 1.0,
            visited_m2: 0.5,
            mean_idleness_s: 1.0,
            worst_idleness_s: 2.0,
            unevenness: 0.1,
            way_m: 10.0,
            by_way: Vec::new(),
        };
        assert_eq!(
            outcome_words(&[guard], Some(&coverage)),
            "98.2 % of the coverable area visited; 190 of 193 waypoints reached in 5 laps"
        );
        assert_eq!(outcome_words(&[], None), "ended after 0.00 s");
    }
}
