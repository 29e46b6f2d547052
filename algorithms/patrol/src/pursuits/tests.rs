use geometry::pose::Pose2;
use planner_view::view::BeliefView;
use robot::team::Team;

use super::*;

/// Three guards and two intruders in the open.
struct Field {
    map: PlannerMap,
    robots: Vec<RobotView>,
    pursuits: Pursuits,
    time_s: f64,
}

impl Field {
    fn new() -> Self {
        let roles = [
            Role::Pursuer,
            Role::Pursuer,
            Role::Pursuer,
            Role::Evader,
            Role::Evader,
        ];
        let teams = Team::of_robots(
            roles.len(),
            |i| roles[i],
            |i, j| roles[i] == roles[j],
            |i, j| roles[i] != roles[j],
        );
        let robots = [-2.0, 0.0, 2.0, 1.5, -1.5]
            .iter()
            .enumerate()
            .map(|(index, &x)| RobotView {
                team: teams[index],
                ..testing::robot(index, roles[index], Pose2::new(x, 0.0, 0.0), 1.0)
            });
        Self {
            map: testing::open_ground(),
            robots: robots.collect(),
            pursuits: Pursuits::new(&[0, 1, 2], 5.0),
            time_s: 0.0,
        }
    }

    /// Observes a second of ticks in which these intruders are seen.
    fn second(&mut self, seen: &[usize]) -> [Option<usize>; 3] {
        for _ in 0..10 {
            let belief = |robot: usize| BeliefView {
                robot,
                particles: &[],
                mean: self.robots[robot].pose,
                position_std: 0.0,
                seen: seen.contains(&robot),
            };
            let beliefs = [belief(3), belief(4)];
            let view = View {
                beliefs: &beliefs,
                ..testing::view(self.time_s, &self.robots, &[])
            };
            self.pursuits.observe(&self.map, &view);
            self.time_s += 0.1;
        }
        [0, 1, 2].map(|guard| self.pursuits.intruder_of(guard))
    }
}

#[test]
fn the_nearest_guard_on_patrol_pursues_an_intruder_that_is_seen() {
    let mut field = Field::new();
    assert_eq!(field.second(&[]), [None; 3]);
    assert_eq!(field.second(&[3]), [None, None, Some(3)]);
    // It keeps its intruder, though another guard comes nearer.
    field.robots[1].pose.x = 1.4;
    assert_eq!(field.second(&[3, 4]), [Some(4), None, Some(3)]);
    field.robots[2].active = false;
    assert_eq!(field.second(&[3, 4]), [Some(4), Some(3), None]);
}

#[test]
fn a_pursuit_ends_when_the_intruder_is_out_of_play_or_lost() {
    let mut field = Field::new();
    field.second(&[3, 4]);
    field.robots[4].active = false;
    assert_eq!(field.second(&[3]), [None, None, Some(3)]);
    for _ in 0..4 {
        assert_eq!(field.second(&[]), [None, None, Some(3)]);
    }
    field.second(&[]);
    assert_eq!(field.second(&[]), [None; 3]);
    // Seen again, it is pursued again.
    assert_eq!(field.second(&[3]), [None, None, Some(3)]);
}

#[test]
fn guards_see_each_other_in_their_duties() {
    let mut field = Field::new();
    field.second(&[3]);
    let mut seen = Vec::new();
    field.pursuits.on_patrol(&field.robots, &mut seen);
    let active: Vec<bool> = seen.iter().map(|robot| robot.active).collect();
    assert_eq!(active, [true, true, false, true, true]);
    field.pursuits.in_pursuit(&field.robots, &mut seen);
    let roles: Vec<Role> = seen.iter().map(|robot| robot.team.role).collect();
    let (guard, body, intruder) = (Role::Pursuer, Role::Neutral, Role::Evader);
    assert_eq!(roles, [body, body, guard, intruder, body]);
    assert!(seen.iter().all(|robot| robot.active && robot.present));
}
