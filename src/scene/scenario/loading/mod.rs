//! `[loading.…]`: the loading of the specimen; exactly one.

mod impact;
mod indent;
mod pressure;
mod stretch;
mod volume;

pub use impact::Impact;
pub use indent::Indent;
pub use pressure::Inflation;
pub use stretch::{Axis, Direction, Stretch};
pub use volume::Filling;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The loading of the specimen.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Loading {
    /// An impactor falls, flies or swings onto the film, or film falls onto it.
    Impact(Impact),
    /// Two jaws, the edges x- and x+, part along x.
    Stretch(Stretch),
    /// The impactor moves slowly down into the film at a prescribed speed.
    Indent(Indent),
    /// Pressure on the lower side of the film, held all around, inflates it; of several faces it acts on the lowest, which
    /// presses on those above it.
    Pressure(Inflation),
    /// Gas let in under one face of film, held all around, inflates it, also beyond the largest pressure that it carries.
    Volume(Filling),
}
