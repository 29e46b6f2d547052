//! Parameters of a policy.

use network::Network;
use observation::action::{ACTION_LENGTH, ActionKind};
use observation::parts::Parts;
use parameters::{Parameters, ParamsError, at_least, between};
use runtime::files;

parameters::table! {
    /// Parameters of a [`Policy`](crate::Policy).
    pub struct PolicyParams {
        /// ONNX file of the policy: its path, relative to the scenario's folder. A log has the contents of the file instead,
        /// as a `data:` URL, so that it can be executed again without the file.
        pub model: String,
        /// Contents of the observation: `state`, `scan`, `belief`, `path`, `potential`, or several of them as in
        /// `state+path`.
        pub observation: String = "state".to_owned(),
        /// Meaning of the network's output: `twist` (forward speed and turning rate) or, for evaders, `tune` (parameters of an
        /// `evader_potential` that steers in every tick) or `residual` (what is added to its action).
        pub action: String = "twist".to_owned(),
        /// Number of ticks from one action to the next; it holds in between.
        pub ticks_per_action: u32 [at_least(1)] = 1,
        /// Standard deviation of what each action differs by from that of the network: random, for each of its numbers in −1
        /// to 1, which are limited to that range afterwards. With 0, the policy does not explore.
        pub exploration: f64 [between(0.0, 2.0)] = 0.0,
    }
}

impl Parameters for PolicyParams {
    fn check_relations(&self) -> Result<(), ParamsError> {
        self.parts()?;
        self.action_kind()?;
        self.network().map(|_| ())
    }
}

impl PolicyParams {
    /// Returns the contents of the observation.
    ///
    /// # Errors
    /// [`ParamsError`] for unknown contents.
    pub fn parts(&self) -> Result<Parts, ParamsError> {
        let parts = self.observation.parse();
        parts.map_err(|_| {
            let expected =
                "state, scan, belief, path, potential, or several of them as in state+path";
            ParamsError::new("observation", &format!("{:?}", self.observation), expected)
        })
    }

    /// Returns the meaning of the actions.
    ///
    /// # Errors
    /// [`ParamsError`] for an unknown one.
    pub fn action_kind(&self) -> Result<ActionKind, ParamsError> {
        let kind = self.action.parse();
        kind.map_err(|_| {
            ParamsError::new(
                "action",
                &format!("{:?}", self.action),
                "twist, tune or residual",
            )
        })
    }

    /// Returns the network of the file.
    ///
    /// # Errors
    /// [`ParamsError`] names what is not supported in the file.
    pub fn network(&self) -> Result<Network, ParamsError> {
        let refused =
            |message: String| ParamsError::refused("model", format!("`model`: {message}"));
        if self.model.is_empty() {
            let message = "`model` is missing: expected the path of an ONNX file";
            return Err(ParamsError::refused("model", message));
        }
        let contents = files::contents(&self.model).ok_or_else(|| {
            refused("expected the contents of an ONNX file, which a scenario inserts".to_owned())
        })?;
        let network = Network::from_onnx(&contents).map_err(|error| refused(error.to_string()))?;
        let length = network.output_length();
        if length != ACTION_LENGTH {
            return Err(refused(format!(
                "the output has {length} numbers: expected {ACTION_LENGTH}, in −1..1"
            )));
        }
        Ok(network)
    }
}
