//! Expectations of a test, read from `[expect]` and checked against the scenario.

use config::{Code, FieldPath, suggest};
use ipc_types::messages::world::WorldEvent;
use recorder::{RobotOutcome, status_name};
use robot::team::Role;
use scenario::ResolvedScenario;
use scenario::expect::{Bound, ExpectSpec, Texts};
use statistics::Interval;
use sweep::{Outcome, Part, Reader, ResultColumn, Row};
use tables::Type;

use crate::limit::Limit;

/// An expectation, with its text and line in the file.
pub(crate) struct Expectation {
    pub text: String,
    pub line: usize,
    pub check: Check,
}

/// Subject of an expectation.
pub(crate) enum Check {
    Digest {
        seed: u64,
        digest: String,
    },
    Outcome(String),
    RobotOutcome {
        robot: String,
        outcome: String,
    },
    NoContact,
    /// Words of each event.
    Events(Vec<Vec<String>>),
    Column(Limited<Row>),
    RobotColumn {
        robot: String,
        column: Limited<RobotOutcome>,
    },
    Share {
        of: ShareOf,
        over: usize,
        within: Interval,
    },
    Mean {
        column: &'static ResultColumn<Row>,
        over: usize,
        within: Interval,
    },
}

/// A column and its allowed values.
pub(crate) struct Limited<R: 'static> {
    pub column: &'static ResultColumn<R>,
    pub limit: Limit,
}

/// Members of a share.
pub(crate) enum ShareOf {
    /// Missions with this outcome.
    Missions(String),
    /// Those of these robots with this outcome.
    Robots {
        robots: Vec<String>,
        outcome: String,
    },
    /// Missions with such values.
    Columns(Vec<Limited<Row>>),
}

/// Outcomes of missions.
const OUTCOMES: [Outcome; 3] = [Outcome::Ended, Outcome::TimeLimit, Outcome::Failed];

/// Reader of the expectations of a test.
pub(crate) struct ExpectReader<'a> {
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
            if let Some(column) = self.limited::<Row>(&["columns", name], name, bound) {
                self.add(&["columns", name], Check::Column(column));
            }
        }
        for (robot, bounds) in &spec.robots {
            self.robot(&["robots", robot], robot);
            for (name, bound) in bounds {
                let keys = ["robots", robot, name];
                if let Some(column) = self.limited::<RobotOutcome>(&keys, name, bound) {
                    let robot = robot.clone();
                    self.add(&keys, Check::RobotColumn { robot, column });
                }
            }
        }
        let escapes = spec.escape_share.as_ref();
        let escapes = escapes.map(|share| (vec!["escape_share"], "escaped", share));
        let shares = spec.shares.iter();
        let shares =
            shares.map(|(name, share)| (vec!["shares", name.as_str()], name.as_str(), share));
        for (keys, name, share) in escapes.into_iter().chain(shares) {
            let of = if share.columns.is_empty() {
                self.outcome_share(&keys, name)
            } else {
                let columns = share.columns.iter().filter_map(|(column, bound)| {
                    let keys = [&keys[..], &["columns", column.as_str()]].concat();
                    self.limited(&keys, column, bound)
                });
                Some(ShareOf::Columns(columns.collect()))
            };
            let range = self.range(&keys, share.within, share.over);
            if let (Some(of), Some((over, within))) = (of, range) {
                self.add(&keys, Check::Share { of, over, within });
            }
        }
        for (name, mean) in &spec.means {
            let keys = ["means", name.as_str()];
            let column = self.column::<Row>(&keys, name);
            let range = self.range(&keys, mean.within, mean.over);
            if let (Some(column), Some((over, within))) = (column, range) {
                if matches!(column.kind(), Type::Bool | Type::Text) {
                    self.refuse(&keys, "this column has no numbers", "a column of numbers");
                }
                self.add(
                    &keys,
                    Check::Mean {
                        column,
                        over,
                        within,
                    },
                );
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
            let problem = self.reader.problem(
                &self.path(keys),
                Code::UnknownName,
                format!("`{name}` is no {what}"),
            );
            self.reader.problems.push(suggest(problem, name, known, ""));
        }
        is_known
    }

    fn robot(&mut self, keys: &[&str], name: &str) -> bool {
        let robots = self.scenario.world.robots.iter();
        let robots: Vec<&str> = robots.map(|robot| robot.name.as_str()).collect();
        self.known(keys, "robot of the scenario", name, &robots)
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

    fn outcomes(&mut self, spec: &ExpectSpec) {
        match &spec.outcome {
            None => {}
            Some(Texts::One(outcome)) => {
                let known = OUTCOMES.map(Outcome::name);
                self.known(&["outcome"], "outcome of a mission", outcome, &known);
                self.add(&["outcome"], Check::Outcome(outcome.clone()));
            }
            Some(Texts::ByName(texts)) => {
                for (robot, outcome) in texts {
                    let keys = ["outcome", robot];
                    let known = self.robot(&keys, robot);
                    if known & self.known(&keys, "outcome of a robot", outcome, &robot_outcomes()) {
                        let (robot, outcome) = (robot.clone(), outcome.clone());
                        self.add(&keys, Check::RobotOutcome { robot, outcome });
                    }
                }
            }
        }
    }

    /// Returns the words of an event.
    fn event(&mut self, text: &str) -> Vec<String> {
        let obstacles = self.scenario.obstacle_names();
        let robots = self.scenario.world.robots.iter();
        let known: Vec<&str> = WorldEvent::NAMES
            .into_iter()
            .chain(robots.map(|robot| robot.name.as_str()))
            .chain(obstacles.values().map(String::as_str))
            .collect();
        let words: Vec<String> = text.split_whitespace().map(str::to_owned).collect();
        for word in &words {
            self.known(
                &["events"],
                "kind of event, robot or obstacle",
                word,
                &known,
            );
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

    fn limited<P: Part<Row>>(
        &mut self,
        keys: &[&str],
        name: &str,
        bound: &Bound,
    ) -> Option<Limited<P>> {
        let column = self.column::<P>(keys, name)?;
        let Some(limit) = Limit::from_bound(bound) else {
            self.refuse(keys, "no value meets this", Limit::FORM);
            return None;
        };
        if !limit.fits(column.kind()) {
            let expected = format!("a {}", column.kind().name());
            self.refuse(keys, "the column has values of another type", &expected);
        }
        Some(Limited { column, limit })
    }

    /// Returns the members of a share of an outcome.
    fn outcome_share(&mut self, keys: &[&str], outcome: &str) -> Option<ShareOf> {
        if OUTCOMES.iter().any(|known| known.name() == outcome) {
            return Some(ShareOf::Missions(outcome.to_owned()));
        }
        let robots = robot_outcomes();
        let all: Vec<&str> = OUTCOMES.iter().map(|o| o.name()).chain(robots).collect();
        if !self.known(keys, "outcome", outcome, &all) {
            return None;
        }
        let is_goal = outcome == "goal_reached";
        let specs = self.scenario.world.robots.iter();
        let members = specs.filter(|r| {
            if is_goal {
                r.goal.is_some()
            } else {
                r.role() == Role::Evader
            }
        });
        let robots: Vec<String> = members.map(|robot| robot.name.clone()).collect();
        if robots.is_empty() {
            let expected = if is_goal {
                "a scenario with robots that have a goal"
            } else {
                "a scenario with evaders"
            };
            self.refuse(
                keys,
                "no robot of the scenario can have this outcome",
                expected,
            );
        }
        let outcome = outcome.to_owned();
        Some(ShareOf::Robots { robots, outcome })
    }

    /// Returns the number of missions and the range of a share or mean.
    fn range(
        &mut self,
        keys: &[&str],
        [low, high]: [f64; 2],
        over: Option<u64>,
    ) -> Option<(usize, Interval)> {
        if low > high {
            self.refuse(
                keys,
                "no value meets this",
                "`within = [low, high]` with low <= high",
            );
            return None;
        }
        let over = over.map_or(self.seeds.len(), |over| over as usize);
        Some((over, Interval { low, high }))
    }
}

/// Returns the outcomes of robots.
fn robot_outcomes() -> [&'static str; 6] {
    [0, 1, 2, 3, 4, 5].map(status_name)
}
