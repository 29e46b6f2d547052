//! Kinds of processes with their types erased, for scenarios, runs and commands.

use core::any::Any;
use core::fmt;
use core::ops::Deref;
use std::path::Path;
use std::process::ExitCode;
use std::sync::Arc;

use config::{Node, ReadError, read_once};
use geometry::map::MapSpec;
use ipc_types::bus::Bus;
use parameters::{ParamsError, Unusual};
use robot::spec::RobotSpec;
use runtime::declaration::Declaration;
use runtime::kind::{Process, ProcessKind, Remark, Task, TaskFault, TaskSketch, ViewSpec};
use runtime::{ProcessConfig, ProcessError};
use schemars::{Schema, SchemaGenerator};
use serde_json::Value as Json;

/// A kind of process: one element of a program's list of kinds.
#[derive(Clone, Copy)]
pub struct Kind {
    /// The name that scenarios use (`kind = "…"`).
    pub name: &'static str,
    /// Description in one line.
    pub summary: &'static str,
    /// Names of the parameters that are paths of files.
    pub(crate) files: &'static [&'static str],
    /// Declaration with default parameters.
    declare: fn() -> Declaration,
    read: fn(&Node) -> Result<ConfiguredKind, ParamsProblem>,
    presets: fn() -> Vec<(&'static str, ConfiguredKind)>,
    run: fn(&Path) -> ExitCode,
    schema: fn(&mut SchemaGenerator) -> Schema,
}

impl Kind {
    /// Returns the kind that a type implements.
    pub const fn from_type<K: ProcessKind>() -> Self {
        Self {
            name: K::NAME,
            summary: K::SUMMARY,
            files: K::FILES,
            declare: || K::declare(&K::Params::default()),
            read: read::<K>,
            presets: presets::<K>,
            run: runtime::run::<K>,
            schema: SchemaGenerator::subschema_for::<K::Params>,
        }
    }

    /// Returns the inputs and outputs of a process with default parameters.
    pub fn declaration(&self) -> Declaration {
        (self.declare)()
    }

    /// Returns the schema of its parameters.
    pub fn schema(&self, generator: &mut SchemaGenerator) -> Schema {
        (self.schema)(generator)
    }

    /// Reads and checks parameters; absent ones have their defaults.
    ///
    /// # Errors
    /// The first unreadable parameter, or all refused parameters.
    pub fn read(&self, params: &Node) -> Result<ConfiguredKind, ParamsProblem> {
        (self.read)(params)
    }

    /// Returns the named sets of parameters that `params.preset` accepts.
    pub fn presets(&self) -> Vec<(&'static str, ConfiguredKind)> {
        (self.presets)()
    }

    /// Runs a process of this kind with the configuration in a file until it ends.
    pub fn run(&self, config: &Path) -> ExitCode {
        (self.run)(config)
    }
}

impl fmt::Debug for Kind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("Kind").field(&self.name).finish()
    }
}

/// Returns the kind with this name.
pub fn find<'k>(kinds: &'k [Kind], name: &str) -> Option<&'k Kind> {
    kinds.iter().find(|k| k.name == name)
}

/// Reason why the parameters of a process are refused.
#[derive(Debug, Clone, PartialEq)]
pub enum ParamsProblem {
    /// They do not fit their type.
    Read(ReadError),
    /// The kind's check refuses them.
    Faults(Vec<ParamsError>),
    /// They cannot be written as JSON.
    Write(String),
}

fn read<K: ProcessKind>(node: &Node) -> Result<ConfiguredKind, ParamsProblem> {
    let params: K::Params = read_once(node).map_err(ParamsProblem::Read)?;
    let faults = parameters::faults(&params);
    if !faults.is_empty() {
        return Err(ParamsProblem::Faults(faults));
    }
    serde_json::to_value(&params).map_err(|e| ParamsProblem::Write(e.to_string()))?;
    Ok(ConfiguredKind::new::<K>(params))
}

fn presets<K: ProcessKind>() -> Vec<(&'static str, ConfiguredKind)> {
    let configured = |(name, params)| (name, ConfiguredKind::new::<K>(params));
    K::presets().into_iter().map(configured).collect()
}

/// A kind of process with the complete, typed parameters of one process.
#[derive(Debug, Clone)]
pub struct ConfiguredKind(Arc<dyn ErasedKind>);

impl ConfiguredKind {
    /// Creates a kind with parameters.
    pub fn new<K: ProcessKind>(params: K::Params) -> Self {
        Self(Arc::new(TypedKind::<K> { params }))
    }

    /// Returns the parameters if they have type `P`.
    pub fn params<P: 'static>(&self) -> Option<&P> {
        self.0.any().downcast_ref()
    }
}

impl Deref for ConfiguredKind {
    type Target = dyn ErasedKind;

    fn deref(&self) -> &Self::Target {
        &*self.0
    }
}

impl PartialEq for ConfiguredKind {
    fn eq(&self, other: &Self) -> bool {
        self.equals(other.any())
    }
}

/// Interface of [`ConfiguredKind`] without its type of parameters.
pub trait ErasedKind: fmt::Debug + Send + Sync {
    /// Returns the kind.
    fn kind(&self) -> Kind;

    /// Returns the parameters.
    fn any(&self) -> &dyn Any;

    /// Returns `true` if these are the same parameters.
    fn equals(&self, params: &dyn Any) -> bool;

    /// Returns the parameters as JSON.
    fn json(&self) -> Json;

    /// See [`ProcessKind::declare`].
    fn declaration(&self) -> Declaration;

    /// See [`ProcessKind::lookout`].
    fn lookout(&self, given: &[usize], robots: &[RobotSpec]) -> Option<ViewSpec>;

    /// See [`ProcessKind::sketch`].
    fn sketch(&self, robot: &RobotSpec, map: &MapSpec) -> TaskSketch;

    /// See [`ProcessKind::check_task`].
    ///
    /// # Errors
    /// The first mismatch between task and parameters.
    fn check_task(&self, task: &Task<'_>) -> Result<(), TaskFault>;

    /// See [`parameters::unusual`].
    fn unusual(&self) -> Vec<Unusual>;

    /// See [`ProcessKind::remarks`].
    fn remarks(&self, task: &Task<'_>) -> Vec<Remark>;

    /// Opens a process in this thread.
    ///
    /// # Errors
    /// See [`runtime::paced::start`].
    fn open(&self, config: &ProcessConfig, bus: &Bus) -> Result<Box<dyn Process>, ProcessError>;
}

/// The parameters of a process of kind `K`.
struct TypedKind<K: ProcessKind> {
    params: K::Params,
}

impl<K: ProcessKind> fmt::Debug for TypedKind<K> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple(K::NAME).field(&self.params).finish()
    }
}

impl<K: ProcessKind> ErasedKind for TypedKind<K> {
    fn kind(&self) -> Kind {
        Kind::from_type::<K>()
    }

    fn any(&self) -> &dyn Any {
        &self.params
    }

    fn equals(&self, params: &dyn Any) -> bool {
        params.downcast_ref() == Some(&self.params)
    }

    fn json(&self) -> Json {
        // Reading them checked that they have a JSON form.
        serde_json::to_value(&self.params).unwrap_or(Json::Null)
    }

    fn declaration(&self) -> Declaration {
        K::declare(&self.params)
    }

    fn lookout(&self, given: &[usize], robots: &[RobotSpec]) -> Option<ViewSpec> {
        K::lookout(&self.params, given, robots)
    }

    fn sketch(&self, robot: &RobotSpec, map: &MapSpec) -> TaskSketch {
        K::sketch(&self.params, robot, map)
    }

    fn check_task(&self, task: &Task<'_>) -> Result<(), TaskFault> {
        K::check_task(&self.params, task)
    }

    fn unusual(&self) -> Vec<Unusual> {
        parameters::unusual(&self.params)
    }

    fn remarks(&self, task: &Task<'_>) -> Vec<Remark> {
        K::remarks(&self.params, task)
    }

    fn open(&self, config: &ProcessConfig, bus: &Bus) -> Result<Box<dyn Process>, ProcessError> {
        runtime::paced::start::<K>(config, &self.params, bus)
    }
}
