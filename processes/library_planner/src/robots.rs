//! The robots of a run as a library sees them.

use std::ffi::CString;

use planner_view::view::RobotView;
use runtime::config::RobotInfo;

use crate::abi::{Point, Robot, SIDES};

/// The robots of a run from the view of one of them, in the order of their indices.
#[derive(Debug)]
pub struct Robots {
    /// Names of the robots and of their teams, to which the robots refer.
    _names: Vec<[CString; 2]>,
    all: Vec<Robot>,
    own: Option<usize>,
}

impl Robots {
    /// Returns the robots at their starts; `None` without a robot of this index. A process has no own robot.
    pub fn new(infos: &[RobotInfo], own: Option<usize>) -> Option<Self> {
        let me = match own {
            Some(own) => Some(infos.get(own)?),
            None => None,
        };
        // Scenarios allow no zero byte in a name.
        let text = |text: &str| CString::new(text).unwrap_or_default();
        let names: Vec<[CString; 2]> = infos
            .iter()
            .map(|info| [text(&info.name), text(&info.team)])
            .collect();
        let [other, team, opponent] = SIDES.map(|(_, code, _)| code);
        let robots = infos.iter().zip(&names).enumerate();
        let robots = robots.map(|(index, (info, [name, team_name]))| Robot {
            name: name.as_ptr(),
            team: team_name.as_ptr(),
            x: info.start.x,
            y: info.start.y,
            theta: info.start.theta,
            v: 0.0,
            omega: 0.0,
            radius: info.model.radius,
            v_max: info.model.v_max,
            v_reverse_max: info.model.v_reverse_max,
            omega_max: info.model.omega_max,
            goal: (info.goal.as_ref()).map_or(Point::NONE, |goal| goal.center().into()),
            index: index as u32,
            role: info.role.code(),
            side: match me {
                Some(me) if info.team == me.team => team,
                Some(me) if me.opponents.contains(&(index as u32)) => opponent,
                _ => other,
            },
            active: true,
            present: true,
        });
        Some(Self {
            all: robots.collect(),
            _names: names,
            own,
        })
    }

    /// Replaces the state of the robots by that of a tick.
    pub fn update(&mut self, views: &[RobotView]) {
        for view in views {
            let Some(robot) = self.all.get_mut(view.index) else {
                continue;
            };
            (robot.x, robot.y, robot.theta) = (view.pose.x, view.pose.y, view.pose.theta);
            (robot.v, robot.omega) = (view.twist.v, view.twist.omega);
            (robot.active, robot.present) = (view.active, view.present);
        }
    }

    /// Returns all robots.
    pub fn all(&self) -> &[Robot] {
        &self.all
    }

    /// Returns the robot to steer; `None` in a process.
    pub fn own(&self) -> Option<&Robot> {
        self.all.get(self.own?)
    }
}
