//! A scenario as written, before defaults are filled in and values are checked.

use config::{Code, Diagnostic, Diagnostics, FieldPath, Node, Sources};

use super::context::Context;
use super::files::Base;
use super::kind::Kind;
use super::overrides;
use super::resolve::resolve;
use super::resolved::ResolvedScenario;
use super::starts::Placement;
use super::template::{MapCache, Template};

/// Text of a scenario with the overrides applied so far.
///
/// Cloning a draft avoids reading and parsing a scenario again for each of its variants.
#[derive(Clone)]
pub struct Draft<'k> {
    pub(super) sources: Sources,
    pub(super) root: Node,
    pub(super) problems: Diagnostics,
    pub(super) kinds: &'k [Kind],
    pub(super) base: Base,
    pub(super) stem: String,
}

impl Draft<'_> {
    /// Applies one `key=value`; errors name its origin by `label` (`--set`).
    ///
    /// Returns the path of the changed value, with elements of arrays by index. Returns `None` after an
    /// error, which [`Draft::resolve`] reports.
    pub fn apply(&mut self, label: &str, argument: &str) -> Option<FieldPath> {
        overrides::apply(
            &mut self.root,
            &mut self.sources,
            label,
            argument,
            &mut self.problems,
        )
    }

    /// Applies the arguments of `--set` and then the seed.
    pub(super) fn apply_all(&mut self, overrides: &[String], seed: Option<u64>) {
        for argument in overrides {
            self.apply("--set", argument);
        }
        if let Some(seed) = seed {
            self.apply("--seed", &format!("run.seed={seed}"));
        }
    }

    /// Returns the value at a key in the form of `--set`; `None` if the key is invalid or has no value.
    pub fn find(&self, key: &str) -> Option<&Node> {
        overrides::find(&self.root, key)
    }

    /// Fills in the defaults and checks everything.
    ///
    /// # Errors
    /// All problems, each with its place.
    pub fn resolve(self) -> Result<ResolvedScenario, Diagnostics> {
        Ok(self.resolve_all()?.0)
    }

    /// Does the same as [`Draft::resolve`] for many runs that differ only in their seed. The seed of the
    /// scenario is ignored.
    ///
    /// # Errors
    /// As [`Draft::resolve`].
    pub fn template(mut self, map_cache: &mut MapCache) -> Result<Template, Diagnostics> {
        self.apply("seed", "run.seed=0");
        let (scenario, placements) = self.resolve_all()?;
        Template::new(scenario, placements, map_cache)
    }

    fn resolve_all(self) -> Result<(ResolvedScenario, Vec<Placement>), Diagnostics> {
        let Self {
            sources,
            root,
            problems,
            kinds,
            base,
            stem,
        } = self;
        let mut ctx = Context {
            sources,
            root,
            kinds,
            problems,
        };
        let Some(resolved) = resolve(&mut ctx, &base, &stem) else {
            let unexplained = || Diagnostic::new(Code::Requirement, "the scenario is incomplete");
            ctx.problems.push_if_empty(unexplained);
            return Err(ctx.problems.sorted());
        };
        ctx.problems.into_result(resolved)
    }
}

impl core::fmt::Debug for Draft<'_> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("Draft")
            .field("stem", &self.stem)
            .field("root", &self.root)
            .finish_non_exhaustive()
    }
}
