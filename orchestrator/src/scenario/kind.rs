//! What a kind of process is, to the scenarios that name it.

use config::{Node, read_once};
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::Value as Json;

use super::params_fault::ParamsFault;

/// Something that a process needs and another part of the scenario must provide.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Need {
    /// Beliefs about the opponents: a `perception` process.
    Belief,
    /// A `scan` sensor on every robot that the process drives.
    Scan,
    /// Trajectories on request: an `optimiser` process.
    Plans,
    /// A `goal` of every robot that the process drives.
    Goal,
}

/// A name and the parameters that it stands for.
pub type Preset = (&'static str, fn() -> Json);

/// Something that a kind of process makes for others.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Product {
    /// The beliefs that [`Need::Belief`] asks for.
    Beliefs,
    /// The plans that [`Need::Plans`] asks for.
    Plans,
    /// What becomes of waypoints (`robot/waypoint`).
    Waypoints,
}

/// A kind of process.
pub struct KindInfo {
    /// The name that scenarios use (`kind = "…"`).
    pub name: &'static str,
    /// What it does, in one line.
    pub summary: &'static str,
    /// Whether it remembers what it saw, so that its memory rises, up to a bound, while it runs.
    pub remembers: bool,
    /// Whether it commands robots (and then must be given some).
    pub drives_robots: bool,
    /// What it makes for others.
    pub makes: &'static [Product],
    /// Reads and checks `params`, and gives them back complete: every default filled in.
    pub check_params: fn(&Node) -> Result<Json, ParamsFault>,
    /// What it needs, given its complete parameters.
    pub needs: fn(&Json) -> Vec<Need>,
    /// Sets of parameters that `params.preset` names; keys beside it change single values.
    pub presets: &'static [Preset],
}

/// Reads parameters into `P`, checks them, and writes them back complete; the body of most
/// [`KindInfo::check_params`]:
///
/// ```text
/// check_params: |node| check_params(node, PursuerParams::validate),
/// ```
///
/// # Errors
/// What does not fit `P`, or what `validate` refuses.
pub fn check_params<P, E>(
    node: &Node,
    validate: impl FnOnce(&P) -> Result<(), E>,
) -> Result<Json, ParamsFault>
where
    P: DeserializeOwned + Serialize,
    E: Into<ParamsFault>,
{
    let params: P = read_once(node).map_err(ParamsFault::Read)?;
    validate(&params).map_err(E::into)?;
    serde_json::to_value(&params).map_err(|e| ParamsFault::Write(e.to_string()))
}

impl KindInfo {
    /// A kind that drives no robots, needs nothing and makes nothing for others.
    pub const fn new(
        name: &'static str,
        summary: &'static str,
        check_params: fn(&Node) -> Result<Json, ParamsFault>,
    ) -> Self {
        Self {
            name,
            summary,
            remembers: false,
            drives_robots: false,
            makes: &[],
            check_params,
            needs: |_| Vec::new(),
            presets: &[],
        }
    }

    /// A kind that drives robots.
    pub const fn driver(
        name: &'static str,
        summary: &'static str,
        check_params: fn(&Node) -> Result<Json, ParamsFault>,
    ) -> Self {
        Self {
            drives_robots: true,
            ..Self::new(name, summary, check_params)
        }
    }

    /// A kind that drives robots from waypoint to waypoint and says what becomes of these.
    pub const fn planner(
        name: &'static str,
        summary: &'static str,
        check_params: fn(&Node) -> Result<Json, ParamsFault>,
    ) -> Self {
        Self {
            makes: &[Product::Waypoints],
            ..Self::driver(name, summary, check_params)
        }
    }

    /// Whether it makes something for others.
    pub fn makes(&self, product: Product) -> bool {
        self.makes.contains(&product)
    }
}

/// The kind with this name.
pub fn find<'k>(kinds: &'k [KindInfo], name: &str) -> Option<&'k KindInfo> {
    kinds.iter().find(|k| k.name == name)
}
