//! Geometry of the robots' tasks in a picture: goals, contour, danger zones, rectangles, waypoints, swept
//! share.

use geometry::region::Region;
use geometry::shape::Shape;
use ipc_types::messages::robot::WaypointEnd;
use recorder::PatrolMeasurement;
use robot::spec::RobotSpec;
use runtime::kind::TaskSketch;

/// Maximum number of waypoints that are shown, the last ones.
const MAX_WAYPOINTS: usize = 1500;
/// Maximum number of rectangles that are shown.
const MAX_RECTANGLES: usize = 1000;

/// Geometry of the tasks of all robots.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct TaskTrace {
    /// Goals of robots.
    pub goals: Vec<Region>,
    /// Contours of patrols: their corners in order (m).
    pub contours: Vec<Vec<[f64; 2]>>,
    /// Danger zones of patrols.
    pub danger_zones: Vec<Shape>,
    /// Rectangles of divided workplaces: smallest and largest corner (m).
    pub rectangles: Vec<[[f64; 2]; 2]>,
    /// Waypoints that ended up to that moment, in order.
    pub waypoints: Vec<WaypointTrace>,
    /// Places of patrols, along each contour.
    pub places: Vec<PlaceTrace>,
    /// Share of the coverable area that is swept, 0 to 1; `None` if it is not accounted.
    pub swept: Option<f64>,
}

/// A place of a patrol: a piece of its contour.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlaceTrace {
    /// Both ends, x and y (m).
    pub ends: [[f64; 2]; 2],
    /// Idleness: time since its last visit, or since the begin of the run without one (s).
    pub idle_s: f64,
}

impl PlaceTrace {
    /// The places of a patrol.
    pub(crate) fn of_patrol(patrol: &PatrolMeasurement) -> Vec<Self> {
        let place = |(ends, idle_s)| Self { ends, idle_s };
        let idle_s = patrol.places().of_each().map(|place| place.idle_s);
        patrol.ends().into_iter().zip(idle_s).map(place).collect()
    }
}

/// A waypoint that has ended.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WaypointTrace {
    /// Position, x and y (m).
    pub at: [f64; 2],
    /// `true` if it was reached; `false` if it was left out.
    pub is_reached: bool,
}

impl TaskTrace {
    /// The geometry of the tasks of these robots, with the goals alone.
    pub(crate) fn of_goals(robots: &[RobotSpec]) -> Self {
        let mut task = Self::default();
        for goal in robots.iter().filter_map(|robot| robot.goal) {
            if !task.goals.contains(&goal) {
                task.goals.push(goal);
            }
        }
        task
    }

    /// Adds the geometry of a robot's task; equal ones of several robots are shown once.
    pub(crate) fn add(&mut self, sketch: &TaskSketch) {
        let TaskSketch {
            contour,
            danger_zones,
            rectangles,
            graph,
        } = sketch;
        if contour.len() > 1 && !self.contours.contains(contour) {
            self.contours.push(contour.clone());
        }
        // Its edges are lines as those of contours.
        let edges = graph.iter().flat_map(|graph| {
            let ends =
                |&[a, b]: &[usize; 2]| Some(vec![*graph.nodes.get(a)?, *graph.nodes.get(b)?]);
            graph.edges.iter().filter_map(ends)
        });
        for edge in edges {
            if !self.contours.contains(&edge) {
                self.contours.push(edge);
            }
        }
        for zone in danger_zones {
            if !self.danger_zones.contains(zone) {
                self.danger_zones.push(zone.clone());
            }
        }
        for rectangle in rectangles {
            if self.rectangles.len() < MAX_RECTANGLES && !self.rectangles.contains(rectangle) {
                self.rectangles.push(*rectangle);
            }
        }
    }
}

impl TaskTrace {
    /// Adds a waypoint that has ended.
    pub(crate) fn waypoint(&mut self, end: &WaypointEnd) {
        let at = [end.x, end.y];
        // Half at a time: removing single ones would move all others.
        if self.waypoints.len() >= 2 * MAX_WAYPOINTS {
            self.waypoints.drain(..MAX_WAYPOINTS);
        }
        self.waypoints.push(WaypointTrace {
            at,
            is_reached: end.outcome == 0,
        });
    }

    /// Drops the waypoints before the last ones.
    pub(crate) fn finish(&mut self) {
        let surplus = self.waypoints.len().saturating_sub(MAX_WAYPOINTS);
        self.waypoints.drain(..surplus);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_waypoints_are_shown_and_equal_tasks_once() {
        let mut task = TaskTrace::default();
        for i in 0..5000 {
            task.waypoint(&WaypointEnd {
                x: f64::from(i),
                outcome: u8::from(i == 4999),
                ..WaypointEnd::default()
            });
        }
        task.finish();
        assert_eq!(task.waypoints.len(), MAX_WAYPOINTS);
        let last = task.waypoints.last().unwrap();
        assert_eq!((last.at[0], last.is_reached), (4999.0, false));
        let sketch = TaskSketch {
            contour: vec![[0.0, 0.0], [1.0, 0.0]],
            danger_zones: vec![Shape::Circle {
                center: [0.0, 0.0],
                radius: 1.0,
            }],
            rectangles: vec![[[0.0, 0.0], [1.0, 1.0]]],
            graph: None,
        };
        task.add(&sketch);
        task.add(&sketch);
        task.add(&TaskSketch::default());
        let counts = (
            task.contours.len(),
            task.danger_zones.len(),
            task.rectangles.len(),
        );
        assert_eq!(counts, (1, 1, 1));
    }
}
