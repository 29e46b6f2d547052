//! Expectations of a test, read from `[expect]` and checked against the scenario.

use config::{Code, FieldPath, suggest};
use ipc_types::messages::world::WorldEvent;
use recorder::{RobotOutcome, status_name};
use robot::team::Role;
use scenario::ResolvedScenario;
use scenario::expect::{Bound, ExpectSpec, Texts};
use statistics::Interval;
use sweep::{Outcome, Part, Reader, ResultColumn, Row};
use tables::{Cell, Type};

use crate::limit::Limit;

/// An expectation, with its text and line in the file.
pub struct Expectation {
    pub text: String,
    pub line: usize,
    pub check: Check,
}

/// Subject of an expectation.
pub enum Check {
    /// Digest of the mission with this seed.
    Digest { seed: u64, digest: String },
    /// No contacts.
    NoContact,
    /// Words of each event.
    Events(Vec<Vec<String>>),
    /// A value of a mission.
    Value(ColumnLimit),
    /// A share over missions.
    Share {
        /// Conditions of each member; one that meets them counts.
        members: Vec<Vec<ColumnLimit>>,
        over: usize,
        within: Interval,
    },
    /// A mean over missions.
    Mean {
        value: Value,
        over: usize,
        within: Interval,
    },
}

/// A value of a mission; empty if it has none.
pub type Value = Box<dyn Fn(&Row) -> Cell + Send + Sync>;

/// A value of a mission, and what it may be.
pub struct ColumnLimit {
    value: Value,
    limit: Limit,
}

impl ColumnLimit {
    /// Returns the value if it is none of those that are allowed.
    pub fn other(&self, row: &Row) -> Option<Cell> {
        Some((self.value)(row)).filter(|cell| !self.limit.contains(cell))
    }
}

/// Reader of the expectations of a test.
pub struct ExpectReader<'a> {
    pub reader: &'a mut Reader,
    /// Path of `expect`.
    pub base: FieldPath,
    pub scenario: &'a ResolvedScenario,
    pub seeds: &'a [u64],
    pub found: Vec<Expectation>,
}

impl ExpectReader<'_> {
    /// Reads all expectations; reports problems.
    pub fn read(&mut self, spec: &ExpectSpec) {
        self.digests(spec);
        self.outcomes(spec);
        if spec.no_contact {
            self.add(&["no_contact"], Check::NoContact);
        }
        if !spec.events.is_empty() {
            let events = spec.events.iter().map(|text| self.event(text)).collect();
            self.add(&["events"], Check::Events(events));
        }
        for (name, bound) in &spec.columns {
            let keys = ["columns", name];
            if let Some(limited) = self.limited(&keys, name, bound, of_mission) {
                self.add(&keys, Check::Value(limited));
            }
        }
        for (robot, bounds) in &spec.robots {
            self.robot(&["robots", robot], robot);
            for (name, bound) in bounds {
                let keys = ["robots", robot, name];
                if let Some(limited) = self.limited(&keys, name, bound, of_robot(robot)) {
                    self.add(&keys, Check::Value(limited));
                }
            }
        }
        let escapes = spec.escape_share.iter();
        let escapes = escapes.map(|share| (vec!["escape_share"], "escaped", share));
        let shares = spec.shares.iter();
        let shares = shares.map(|(name, share)| (vec!["shares", name], name.as_str(), share));
        for (keys, name, share) in escapes.chain(shares) {
            let members = if share.columns.is_empty() {
                self.outcome_members(&keys, name)
            } else {
                let limits = share.columns.iter().filter_map(|(column, bound)| {
                    let keys = [&keys[..], &["columns", column]].concat();
                    self.limited(&keys, column, bound, of_mission)
                });
                vec![limits.collect()]
            };
            if let Some((over, within)) = self.range(&keys, share.within, share.over) {
                let check = Check::Share {
                    members,
                    over,
                    within,
                };
                self.add(&keys, check);
            }
        }
        for (name, mean) in &spec.means {
            let keys = ["means", name.as_str()];
            let column = self.column::<Row>(&keys, name);
            let range = self.range(&keys, mean.within, mean.over);
            if let (Some(column), Some((over, within))) = (column, range) {
                if matches!(column.kind, Type::Bool | Type::Text) {
                    self.refuse(&keys, "this column has no numbers", "a column of numbers");
                }
                let check = Check::Mean {
                    value: of_mission(column),
                    over,
                    within,
                };
                self.add(&keys, check);
            }
        }
        if self.found.is_empty() && self.reader.problems.is_empty() {
            self.refuse(&[], "nothing is expected", "at least one expectation");
        }
    }

    fn path(&self, keys: &[&str]) -> FieldPath {
        keys.iter()
            .fold(self.base.clone(), |path, key| path.then(key))
    }

    fn refuse(&mut self, keys: &[&str], message: &str, expected: &str) {
        let path = self.path(keys);
        self.reader
            .refuse(&path, Code::Requirement, message, expected);
    }

    fn add(&mut self, keys: &[&str], check: Check) {
        let path = self.path(keys);
        let root = &self.reader.root;
        let place = self.reader.sources.place(root.origin_along(&path));
        let value = root.follow(&path).render_short();
        self.found.push(Expectation {
            text: format!("{} = {value}", keys.join(".")),
            line: place.map_or(1, |place| place.line),
            check,
        });
    }

    /// Reports a name that is none of those known.
    fn known(&mut self, keys: &[&str], what: &str, name: &str, known: &[&str]) -> bool {
        let is_known = known.contains(&name);
        if !is_known {
            let message = format!("`{name}` is no {what}");
            let path = self.path(keys);
            let problem = self.reader.problem(&path, Code::UnknownName, message);
            self.reader.problems.push(suggest(problem, name, known, ""));
        }
        is_known
    }

    fn robot(&mut self, keys: &[&str], name: &str) {
        let robots = self.scenario.world.robots.iter();
        let robots: Vec<&str> = robots.map(|robot| robot.name.as_str()).collect();
        self.known(keys, "robot of the scenario", name, &robots);
    }

    fn digests(&mut self, spec: &ExpectSpec) {
        let expected = spec.digest.as_ref().filter(|_| !spec.outcome_only);
        match (expected, self.seeds) {
            (None, _) => {}
            (Some(Texts::One(text)), &[seed]) => self.digest(&["digest"], seed, text),
            (Some(Texts::One(_)), _) => {
                let expected = "digests by seed, such as { 1 = \"\", 2 = \"\" }";
                self.refuse(&["digest"], "one digest for several missions", expected);
            }
            (Some(Texts::ByName(texts)), seeds) => {
                for (key, text) in texts {
                    let keys = ["digest", key.as_str()];
                    if let Some(seed) = key.parse().ok().filter(|seed| seeds.contains(seed)) {
                        self.digest(&keys, seed, text);
                    } else {
                        let message = format!("`{key}` is no seed of this test");
                        self.refuse(&keys, &message, "one of its seeds");
                    }
                }
            }
        }
    }

    fn digest(&mut self, keys: &[&str], seed: u64, text: &str) {
        let has_digits = text.len() == 64 && text.bytes().all(|b| b.is_ascii_hexdigit());
        if !text.is_empty() && !has_digits {
            let expected = "64 hexadecimal digits, or \"\" for `protean test --update`";
            self.refuse(keys, "this is no digest", expected);
        }
        let digest = text.to_ascii_lowercase();
        self.add(keys, Check::Digest { seed, digest });
    }

    /// An outcome is the text of a column.
    fn outcomes(&mut self, spec: &ExpectSpec) {
        match &spec.outcome {
            None => {}
            Some(Texts::One(outcome)) => {
                let keys = ["outcome"];
                self.known(&keys, "outcome of a mission", outcome, &OUTCOMES);
                let outcome = Bound::Text(outcome.clone());
                if let Some(limited) = self.limited(&keys, "outcome", &outcome, of_mission) {
                    self.add(&keys, Check::Value(limited));
                }
            }
            Some(Texts::ByName(texts)) => {
                for (robot, outcome) in texts {
                    let keys = ["outcome", robot];
                    self.robot(&keys, robot);
                    self.known(&keys, "outcome of a robot", outcome, &robot_outcomes());
                    let outcome = Bound::Text(outcome.clone());
                    let limited = self.limited(&keys, "outcome", &outcome, of_robot(robot));
                    if let Some(limited) = limited {
                        self.add(&keys, Check::Value(limited));
                    }
                }
            }
        }
    }

    /// Returns the words of an event.
    fn event(&mut self, text: &str) -> Vec<String> {
        const WHAT: &str = "kind of event, robot or obstacle";
        let obstacles = self.scenario.obstacle_names();
        let robots = self.scenario.world.robots.iter();
        let known: Vec<&str> = WorldEvent::NAMES
            .into_iter()
            .chain(robots.map(|robot| robot.name.as_str()))
            .chain(obstacles.values().map(String::as_str))
            .collect();
        let words: Vec<String> = text.split_whitespace().map(str::to_owned).collect();
        for word in &words {
            self.known(&["events"], WHAT, word, &known);
        }
        words
    }

    fn column<P: Part<Row>>(
        &mut self,
        keys: &[&str],
        name: &str,
    ) -> Option<&'static ResultColumn<P>> {
        let names: Vec<&str> = P::COLUMNS.iter().map(|column| column.name).collect();
        self.known(keys, &format!("column of {}.csv", P::TABLE), name, &names);
        P::COLUMNS.iter().find(|column| column.name == name)
    }

    /// Returns a column with its allowed values; `of` makes a value of a mission of the column.
    fn limited<P: Part<Row>>(
        &mut self,
        keys: &[&str],
        name: &str,
        bound: &Bound,
        of: impl Fn(&'static ResultColumn<P>) -> Value,
    ) -> Option<ColumnLimit> {
        let column = self.column::<P>(keys, name)?;
        let Some(limit) = Limit::from_bound(bound) else {
            self.refuse(keys, "no value meets this", Limit::FORM);
            return None;
        };
        if !limit.fits(column.kind) {
            let expected = format!("a {}", column.kind.name());
            self.refuse(keys, "the column has values of another type", &expected);
        }
        let value = of(column);
        Some(ColumnLimit { value, limit })
    }

    /// Returns the members of a share of an outcome: the missions, or its robots.
    fn outcome_members(&mut self, keys: &[&str], outcome: &str) -> Vec<Vec<ColumnLimit>> {
        let bound = Bound::Text(outcome.to_owned());
        if OUTCOMES.contains(&outcome) {
            let limited = self.limited(keys, "outcome", &bound, of_mission);
            return vec![limited.into_iter().collect()];
        }
        let all = [&OUTCOMES[..], &robot_outcomes()].concat();
        if !self.known(keys, "outcome", outcome, &all) {
            return Vec::new();
        }
        let is_goal = outcome == "goal_reached";
        let scenario = self.scenario;
        let robots = scenario.world.robots.iter().filter(|robot| {
            if is_goal {
                robot.goal.is_some()
            } else {
                robot.role() == Role::Evader
            }
        });
        let members: Vec<Vec<ColumnLimit>> = robots
            .filter_map(|robot| self.limited(keys, "outcome", &bound, of_robot(&robot.name)))
            .map(|limited| vec![limited])
            .collect();
        if members.is_empty() {
            let message = "no robot of the scenario can have this outcome";
            let expected = if is_goal {
                "a scenario with robots that have a goal"
            } else {
                "a scenario with evaders"
            };
            self.refuse(keys, message, expected);
        }
        members
    }

    /// Returns the number of missions and the range of a share or mean.
    fn range(
        &mut self,
        keys: &[&str],
        [low, high]: [f64; 2],
        over: Option<u64>,
    ) -> Option<(usize, Interval)> {
        if low > high {
            let expected = "`within = [low, high]` with low <= high";
            self.refuse(keys, "no value meets this", expected);
            return None;
        }
        let over = over.map_or(self.seeds.len(), |over| over as usize);
        Some((over, Interval { low, high }))
    }
}

fn of_mission(column: &'static ResultColumn<Row>) -> Value {
    Box::new(|row| column.cell(row))
}

fn of_robot(name: &str) -> impl Fn(&'static ResultColumn<RobotOutcome>) -> Value + use<> {
    let name = name.to_owned();
    move |column| {
        let name = name.clone();
        Box::new(move |row| {
            let robot = row.robots.iter().find(|robot| robot.name == name);
            robot.map_or(Cell::Empty, |robot| column.cell(robot))
        })
    }
}

/// Outcomes of missions.
const OUTCOMES: [&str; 3] = [
    Outcome::Ended.name(),
    Outcome::TimeLimit.name(),
    Outcome::Failed.name(),
];

/// Returns the outcomes of robots.
fn robot_outcomes() -> [&'static str; 6] {
    [0, 1, 2, 3, 4, 5].map(status_name)
}
