//! The legend beside the map: symbols and scale bar.

use draw::canvas::{Canvas, Num, Style, wrap};
use draw::legend::Legend as Rows;
use draw::palette;
use recorder::time_text;
use robot::team::Role;

use super::draw_layers::verdict_sign;
use super::draw_task::{CONTOUR, GOAL, RECTANGLE, SWEPT_OPACITY, ZONE, waypoint_signs};
use super::layout::LEGEND;
use super::signs::{HALO, Sign, disc, sign};
use super::trace::{MarkKind, RunTrace, pursuers};

/// Font size of the legend (px).
const SIZE: f64 = 14.5;
/// Font size of secondary text (px).
const SMALL: f64 = 12.5;
/// Font size of the description (px).
const DESCRIPTION_SIZE: f64 = 13.5;
/// Maximum number of lines of the description.
const MAX_LINES: usize = 14;
/// Distance of two lines of the description (px).
const LINE: f64 = 19.0;
/// Space below the description (px).
const BELOW: f64 = 22.0;
/// Space for the scale bar at the end (px).
const SCALE_BAR: f64 = 64.0;
/// Maximum size of a team whose members' outcomes are listed.
const MAX_OUTCOMES: usize = 8;

/// Symbol of a row.
#[derive(Debug, Clone, Copy)]
enum RowSign {
    /// In this colour.
    Robot(&'static str),
    Trail,
    Belief,
    Plan,
    Tree,
    Area(&'static str),
    Verdict {
        is_possible: bool,
    },
    Exit,
    Mark(MarkKind),
    Wall,
    Obstacle,
    Task(TaskSign),
}

/// Symbol of a part of a robot's task.
#[derive(Debug, Clone, Copy)]
enum TaskSign {
    /// In this colour.
    Swept(&'static str),
    Goal,
    Contour,
    Zone,
    Rectangle,
    Waypoint {
        is_reached: bool,
    },
}

/// The legend of one picture.
pub struct Legend {
    /// Lines of the description.
    description: Vec<String>,
    rows: Rows<RowSign>,
}

impl Legend {
    /// Builds the rows for the content of the picture.
    pub(super) fn from_trace(trace: &RunTrace) -> Self {
        let mut rows = Rows::new(LEGEND);
        let named = trace.robots.iter();
        let pursuers = pursuers(named.map(|robot| (robot.team.as_str(), robot.role)));
        team_rows(trace, &mut rows);
        if !trace.is_before_run() {
            rows.row(RowSign::Trail, "path so far; later parts are bolder");
        }
        task_rows(trace, &mut rows);
        if !trace.beliefs.is_empty() {
            let text = format!("belief of {pursuers} about the evaders: particles of their filter");
            rows.row(RowSign::Belief, &text);
        }
        if !trace.plans.is_empty() {
            let has_aim = trace.plans.iter().any(|plan| plan.aim.is_some());
            let ring = ["", "; a ring: what the robot heads for"][usize::from(has_aim)];
            rows.row(RowSign::Plan, &format!("planned path{ring}"));
        }
        if !trace.trees.is_empty() {
            let text = "search tree of an evader";
            rows.row(RowSign::Tree, text);
        }
        if trace.dominance.is_some() {
            let first = format!("{pursuers} are first");
            for (color, text) in [
                (palette::EVADER, "an evader reaches it safely"),
                (palette::OBSTACLE, "an evader is first, but can be cut off"),
                (palette::PURSUER, &first),
            ] {
                rows.row(RowSign::Area(color), text);
            }
        }
        for (is_possible, text) in [
            (true, "can escape, says the referee"),
            (false, "can be stopped, says the referee"),
        ] {
            if trace.verdicts.iter().any(|v| v.is_possible == is_possible) {
                rows.row(RowSign::Verdict { is_possible }, text);
            }
        }
        if !trace.static_scene.exits.is_empty() {
            rows.row(RowSign::Exit, "exit for the evaders");
        }
        for (kind, text) in [
            (MarkKind::Captured, "caught here"),
            (MarkKind::Escaped, "escaped here"),
            (MarkKind::GoalReached, "arrived here"),
        ] {
            if trace.marks.iter().any(|mark| mark.kind == kind) {
                rows.row(RowSign::Mark(kind), text);
            }
        }
        if trace.static_scene.has_walls() {
            rows.row(RowSign::Wall, "walls and blocks");
        }
        if trace.static_scene.obstacles.values().any(|o| o.came) {
            let text = if trace.is_before_run() {
                "appears during the run"
            } else {
                "changed during the run"
            };
            rows.row(RowSign::Obstacle, text);
        }
        // The whole description is in the scenario.
        let mut description = wrap(&trace.description, DESCRIPTION_SIZE, LEGEND);
        if description.len() > MAX_LINES {
            description.truncate(MAX_LINES);
            if let Some(last) = description.last_mut() {
                last.push_str(" …");
            }
        }
        Self { description, rows }
    }

    fn story_height(&self) -> f64 {
        if self.description.is_empty() {
            0.0
        } else {
            self.description.len() as f64 * LINE + BELOW
        }
    }

    /// Returns its height (px).
    pub(super) fn height(&self) -> f64 {
        self.story_height() + self.rows.height() + SCALE_BAR
    }

    /// Draws it with its upper left corner here (px), the scale bar at `bottom`.
    pub(super) fn draw(&self, canvas: &mut Canvas, left: f64, top: f64) {
        let style = Style {
            size: DESCRIPTION_SIZE,
            color: palette::FAINT_INK,
            bold: false,
            anchor: "start",
            halo: false,
        };
        for (i, line) in self.description.iter().enumerate() {
            canvas.label(left, top + 13.0 + i as f64 * LINE, &style, line);
        }
        for row in self.rows.placed(left, top + self.story_height()) {
            row.sign.draw(canvas, row.center);
            for ([x, y], style, text) in row.lines {
                canvas.label(x, y, &style, text);
            }
        }
    }
}

/// Adds the robots of each team, their verdicts and their ends.
fn team_rows(trace: &RunTrace, rows: &mut Rows<RowSign>) {
    let robots = || trace.robots.iter().enumerate();
    // Pursuers, evaders, neutral robots; the teams of a role in the order of their first robots.
    let mut teams: Vec<(Role, &str, usize)> = Vec::new();
    for role in [Role::Pursuer, Role::Evader, Role::Neutral] {
        for (i, robot) in robots().filter(|(_, robot)| robot.role == role) {
            if teams.iter().all(|&(_, team, _)| team != robot.team) {
                teams.push((role, &robot.team, i));
            }
        }
    }
    for (role, team, first) in teams {
        let members = || robots().filter(|(_, robot)| robot.team == team);
        let count = members().count();
        let words = match role {
            Role::Pursuer if team == role.team() => "Police robot",
            Role::Pursuer => "pursuer",
            Role::Evader => "evader",
            Role::Neutral => "robot",
        };
        let mut text = format!("{count} {words}{}", if count == 1 { "" } else { "s" });
        if team != role.team() {
            text += &format!(", team {team}");
        }
        rows.row(RowSign::Robot(trace.color(first)), &text);
        let verdicts = trace.verdicts.iter().filter_map(|verdict| {
            let (_, robot) = members().find(|(i, _)| *i == verdict.robot)?;
            Some(format!("{}: {}", robot.name, verdict.words()))
        });
        let verdicts = verdicts.take(MAX_OUTCOMES);
        verdicts.for_each(|verdict| rows.detail(&verdict));
        let outcomes = trace.marks.iter().filter_map(|mark| {
            let (_, robot) = members().find(|(i, _)| *i == mark.robot)?;
            Some(format!(
                "{} {}, {} s",
                robot.name,
                mark.kind.words(),
                time_text(mark.time_s)
            ))
        });
        let outcomes = outcomes.take(MAX_OUTCOMES);
        outcomes.for_each(|outcome| rows.detail(&outcome));
    }
}

/// Adds the rows of the robots' tasks.
fn task_rows(trace: &RunTrace, rows: &mut Rows<RowSign>) {
    let task = &trace.task;
    if !trace.is_before_run() && trace.robots.iter().any(|robot| robot.sweeps.is_some()) {
        let text = match task.swept {
            Some(share) => format!("swept ground: {:.1} % of what can be swept", 100.0 * share),
            None => "swept ground".to_owned(),
        };
        let [new, middle, old] = palette::idleness_bounds(trace.time_s);
        let ages = [
            format!("{text}; last visit less than {new} s ago"),
            format!("less than {middle} s ago"),
            format!("less than {old} s ago"),
            "longer ago".to_owned(),
        ];
        for (color, text) in palette::IDLENESS.into_iter().zip(ages) {
            rows.row(RowSign::Task(TaskSign::Swept(color)), &text);
        }
    }
    if !task.goals.is_empty() {
        rows.row(RowSign::Task(TaskSign::Goal), "goal of a robot");
    }
    if !task.contours.is_empty() {
        let text = if task.places.is_empty() {
            "contour of the patrol"
        } else {
            "contour of the patrol, in the colours of its last visit"
        };
        rows.row(RowSign::Task(TaskSign::Contour), text);
    }
    if !task.danger_zones.is_empty() {
        rows.row(RowSign::Task(TaskSign::Zone), "danger zone");
    }
    if !task.rectangles.is_empty() {
        let text = match task.rectangles.len() {
            1 => "the free space as one rectangle".to_owned(),
            count => format!("the free space as {count} rectangles"),
        };
        rows.row(RowSign::Task(TaskSign::Rectangle), &text);
    }
    for (is_reached, text) in [(true, "reached"), (false, "left out")] {
        let ended = task.waypoints.iter();
        let count = ended.filter(|w| w.is_reached == is_reached).count();
        if count > 0 {
            let s = if count == 1 { "" } else { "s" };
            let text = format!("{count} waypoint{s} {text}");
            rows.row(RowSign::Task(TaskSign::Waypoint { is_reached }), &text);
        }
    }
}

impl RowSign {
    fn draw(&self, canvas: &mut Canvas, at: [f64; 2]) {
        let [x, y] = at;
        match *self {
            Self::Robot(color) => disc(canvas, at, 7.5, 0.0, color, true),
            Self::Trail => {
                let ink = palette::FAINT_INK;
                for (from, to, width, opacity) in [
                    (-10.0, -2.0, 2.0, 0.45),
                    (-2.0, 5.0, 2.6, 0.7),
                    (5.0, 12.0, 3.4, 1.0),
                ] {
                    canvas.add(format_args!(
                        "<path d=\"M{} {}L{} {}\" stroke=\"{ink}\" stroke-width=\"{width}\" \
                         stroke-opacity=\"{opacity}\"/>\n",
                        Num(x + from),
                        Num(y),
                        Num(x + to),
                        Num(y),
                    ));
                }
                sign(canvas, Sign::Start, [x - 10.0, y], ink);
            }
            Self::Belief => {
                canvas.add(format_args!(
                    "<g fill=\"{}\" fill-opacity=\"0.8\">",
                    palette::BELIEF
                ));
                for (dx, dy) in [
                    (-7.0, 1.0),
                    (-2.0, -5.0),
                    (0.0, 3.0),
                    (4.0, -1.0),
                    (8.0, 4.0),
                    (7.0, -6.0),
                ] {
                    canvas.add(format_args!(
                        "<circle cx=\"{}\" cy=\"{}\" r=\"2\"/>",
                        Num(x + dx),
                        Num(y + dy)
                    ));
                }
                canvas.add(format_args!("</g>\n"));
            }
            Self::Plan => canvas.add(format_args!(
                "<path d=\"M{} {y}L{} {y}\" stroke=\"{}\" stroke-width=\"1.8\" \
                 stroke-dasharray=\"6 4\"/>\n",
                Num(x - 10.0),
                Num(x + 12.0),
                palette::FAINT_INK,
                y = Num(y),
            )),
            Self::Tree => {
                canvas.add(format_args!(
                    "<g fill=\"none\" stroke=\"{}\" stroke-width=\"0.9\">",
                    palette::EVADER
                ));
                for [from, to] in [
                    [[-10.0, 2.0], [-2.0, 0.0]],
                    [[-2.0, 0.0], [5.0, -7.0]],
                    [[-2.0, 0.0], [5.0, 4.0]],
                    [[5.0, 4.0], [12.0, 1.0]],
                    [[5.0, 4.0], [8.0, 8.0]],
                ] {
                    canvas.add(format_args!(
                        "<path d=\"M{} {}L{} {}\"/>",
                        Num(x + from[0]),
                        Num(y + from[1]),
                        Num(x + to[0]),
                        Num(y + to[1])
                    ));
                }
                canvas.add(format_args!("</g>\n"));
            }
            Self::Area(color) => canvas.add(format_args!(
                "<rect x=\"{}\" y=\"{}\" width=\"18\" height=\"14\" fill=\"{color}\" \
                 fill-opacity=\"0.25\"/>\n",
                Num(x - 9.0),
                Num(y - 7.0),
            )),
            Self::Verdict { is_possible } => verdict_sign(canvas, at, 8.0, is_possible),
            Self::Exit => canvas.add(format_args!(
                "<circle cx=\"{}\" cy=\"{}\" r=\"9\" fill=\"{c}\" fill-opacity=\"0.18\" \
                 stroke=\"{c}\" stroke-width=\"2\" stroke-dasharray=\"4 3\"/>\n",
                Num(x),
                Num(y),
                c = palette::EXIT,
            )),
            Self::Mark(kind) => sign(canvas, Sign::Mark(kind), at, HALO),
            Self::Wall => square(canvas, at, palette::WALL, palette::EDGE),
            Self::Obstacle => square(canvas, at, palette::OBSTACLE, palette::OBSTACLE),
            Self::Task(sign) => sign.draw(canvas, at),
        }
    }
}

impl TaskSign {
    fn draw(self, canvas: &mut Canvas, at: [f64; 2]) {
        let [x, y] = at;
        match self {
            Self::Swept(color) => canvas.add(format_args!(
                "<path d=\"M{} {y}L{} {y}\" stroke=\"{color}\" stroke-width=\"14\" \
                 stroke-linecap=\"round\" stroke-opacity=\"{SWEPT_OPACITY}\"/>\n",
                Num(x - 6.0),
                Num(x + 6.0),
                y = Num(y),
            )),
            Self::Contour => canvas.add(format_args!(
                "<path d=\"M{} {y}L{} {y}\" {CONTOUR}/>\n",
                Num(x - 12.0),
                Num(x + 12.0),
                y = Num(y),
            )),
            Self::Zone => canvas.add(format_args!(
                "<circle cx=\"{}\" cy=\"{}\" r=\"9\" {ZONE}/>\n",
                Num(x),
                Num(y),
            )),
            Self::Goal => canvas.add(format_args!(
                "<circle cx=\"{}\" cy=\"{}\" r=\"9\" {GOAL}/>\n",
                Num(x),
                Num(y),
            )),
            Self::Rectangle => canvas.add(format_args!(
                "<rect x=\"{}\" y=\"{}\" width=\"22\" height=\"14\" {RECTANGLE}/>\n",
                Num(x - 11.0),
                Num(y - 7.0),
            )),
            Self::Waypoint { is_reached } => waypoint_signs(canvas, [at], is_reached, 4.0),
        }
    }
}

fn square(canvas: &mut Canvas, at: [f64; 2], fill: &str, edge: &str) {
    canvas.add(format_args!(
        "<rect x=\"{}\" y=\"{}\" width=\"18\" height=\"14\" fill=\"{fill}\" stroke=\"{edge}\"/>\n",
        Num(at[0] - 9.0),
        Num(at[1] - 7.0),
    ));
}

/// Draws a bar of a round length below the legend, its line at `y` (px); `enlarged` is the factor
/// by which the smallest robots are enlarged.
pub fn scale_bar(canvas: &mut Canvas, left: f64, y: f64, scale: f64, enlarged: f64) {
    let (metres, pixels) = round_length(scale);
    let (x0, x1) = (Num(left + 2.0), Num(left + 2.0 + pixels));
    canvas.add(format_args!(
        "<path d=\"M{x0} {top}L{x0} {bottom}M{x0} {y}L{x1} {y}M{x1} {top}L{x1} {bottom}\" \
         stroke=\"{}\" stroke-width=\"2\" fill=\"none\"/>\n",
        palette::INK,
        top = Num(y - 5.0),
        bottom = Num(y + 5.0),
        y = Num(y),
    ));
    let style = Style {
        size: SIZE,
        color: palette::INK,
        bold: false,
        anchor: "start",
        halo: false,
    };
    canvas.label(
        left + pixels + 12.0,
        y + 5.0,
        &style,
        &format!("{metres} m"),
    );
    if enlarged > 1.05 {
        let style = Style {
            size: SMALL,
            color: palette::FAINT_INK,
            ..style
        };
        let text = format!("robots drawn {enlarged:.1} times their size");
        canvas.label(left, y - 16.0, &style, &text);
    }
}

/// Returns a length of 1, 2 or 5 times a power of ten (m) that is 60 to 150 pixels long, and its
/// pixels.
fn round_length(scale: f64) -> (f64, f64) {
    let mut metres = 1e-3;
    for step in [2.0, 2.5, 2.0].into_iter().cycle().take(30) {
        if metres * scale >= 60.0 {
            break;
        }
        metres *= step;
    }
    // Repeated multiplication is inexact: round to the nearest such number.
    let metres = (metres * 1e3).round() / 1e3;
    (metres, metres * scale)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scale_bars_have_round_lengths() {
        for (scale, metres) in [
            (40.0, 2.0),
            (760.0, 0.1),
            (7.6, 10.0),
            (0.5, 200.0),
            (13.0, 5.0),
        ] {
            let (length, pixels) = round_length(scale);
            assert_eq!(length, metres, "at {scale} px/m");
            assert!(
                (60.0..=160.0).contains(&pixels),
                "{pixels} px at {scale} px/m"
            );
        }
    }
}
