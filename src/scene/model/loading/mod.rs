//! The loading: its kinds, a file each, and what they answer about themselves.

mod impact;
mod indent;
mod pressure;
mod rules;
mod stretch;
mod volume;

use std::ops::Deref;

use serde::{Deserialize, Serialize};

use super::{Hold, Impactor, Model, ModelDiagnostics};
use crate::mesh::Outline;
use crate::scenario::{self, Scenario};
pub use impact::Impact;
pub use indent::Indent;
pub(super) use indent::depth;
pub use pressure::Pressure;
use rules::{GAS_BARS, GAS_CLAMP, GAS_HOLD, GAS_SPRINGS};
pub use rules::{Impactors, Inertia, MassScaling, Refusal, Test};
pub use stretch::Stretch;
pub use volume::Volume;

/// A kind of loading, with all that differs between kinds. Everything else asks it, so that another kind is written
/// beside these and nowhere else.
pub trait Kind {
    /// Name of its table in `[loading]`.
    fn name(&self) -> &'static str;

    /// Path of a `key` of its table.
    fn key(&self, key: &str) -> String {
        format!("loading.{}.{key}", self.name())
    }

    /// The kind of its test, which decides what is recorded, measured and shown.
    fn test(&self) -> Test;

    /// The part that inertia plays in it.
    fn inertia(&self) -> Inertia;

    /// Where the factor on the film's mass comes from.
    fn mass_scaling(&self) -> MassScaling;

    /// Simulated time on film of this outline, s; NaN where it has none, which is reported separately.
    fn run_time(&self, shape: &Outline) -> f64;

    /// The key of its table from which the simulated time follows.
    fn pace(&self) -> &'static str;

    /// The impactors that it needs.
    fn impactors(&self) -> Impactors {
        Impactors::None
    }

    /// Whether gas presses on the film.
    fn is_by_gas(&self) -> bool {
        false
    }

    /// Angle from the x axis to MD where the loading turns the film, rad.
    fn md_angle(&self) -> Option<f64> {
        None
    }

    /// The edges that are held where the scenario does not say.
    fn default_hold(&self) -> Hold {
        Hold::All
    }

    /// Why the film cannot be held by `hold`.
    fn refuses_hold(&self, hold: &Hold) -> Option<Refusal> {
        (self.is_by_gas() && *hold != Hold::All).then_some(GAS_HOLD)
    }

    /// Why the frame has no bars.
    fn refuses_bars(&self) -> Option<Refusal> {
        self.is_by_gas().then_some(GAS_BARS)
    }

    /// Why film cannot slip in its clamp.
    fn refuses_clamp(&self) -> Option<Refusal> {
        self.is_by_gas().then_some(GAS_CLAMP)
    }

    /// Why film cannot hang on springs.
    fn refuses_springs(&self) -> Option<Refusal> {
        self.is_by_gas().then_some(GAS_SPRINGS)
    }

    /// Why there is one face of film.
    fn refuses_faces(&self) -> Option<&'static str> {
        None
    }

    /// Its action on film that is called `layers`, in one phrase.
    fn subject(&self, model: &Model, layers: &str) -> String;

    /// Its quantities for scripts, SI.
    fn facts(&self) -> Vec<(&'static str, f64)>;
}

/// Writes the list of kinds once: the type of a loading, and what finds the kind of one.
macro_rules! kinds {
    ($($(#[$doc:meta])* $kind:ident,)*) => {
        /// The loading of the specimen.
        #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
        pub enum Loading {
            $($(#[$doc])* $kind($kind),)*
        }

        impl Deref for Loading {
            type Target = dyn Kind;

            fn deref(&self) -> &(dyn Kind + 'static) {
                match self {
                    $(Loading::$kind(kind) => kind,)*
                }
            }
        }

        /// The loading in SI values.
        pub(super) fn check(scenario: &Scenario, mistakes: &mut ModelDiagnostics<'_>) -> Loading {
            match &scenario.loading {
                $(scenario::Loading::$kind(written) => Loading::$kind($kind::check(written, scenario, mistakes)),)*
            }
        }
    };
}

kinds! {
    /// Impactors fall, fly or swing onto the film, or film falls onto them.
    Impact,
    /// The edges x- and x+ are jaws that part along x.
    Stretch,
    /// The impactor starts in contact with the film and moves down.
    Indent,
    /// A pressure on the lower side of the film rises and is then constant for half as long.
    Pressure,
    /// Gas is let in under the film; its volume is then constant for half as long.
    Volume,
}

impl Loading {
    /// The impact, where impactors move freely.
    pub fn impact(&self) -> Option<&Impact> {
        match self {
            Loading::Impact(impact) => Some(impact),
            _ => None,
        }
    }

    /// The loading with the vertical speed that the guide of the impactor admits.
    pub(super) fn with_impactor(self, impactor: Option<&Impactor>) -> Loading {
        match (self, impactor) {
            (Loading::Impact(impact), Some(Impactor { velocity: [_, _, upward], .. })) => {
                Loading::Impact(Impact { velocity: -upward, ..impact })
            }
            (loading, _) => loading,
        }
    }
}

impl Model {
    /// Simulated time, s.
    pub fn run_time(&self) -> f64 {
        self.loading.run_time(&self.specimen.shape)
    }

    /// The action of the test on the film, in one phrase: `sphere 10.72 kg at 4.16 m/s on 2 x 8 layers of LLDPE`.
    pub fn subject(&self) -> String {
        self.loading.subject(self, &self.layers_in_words())
    }
}
