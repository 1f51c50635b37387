//! The differences between kinds of loading, and the rules that several of them share.

use crate::model::ModelDiagnostics;

/// The kind of a test; those of one kind record, measure and show the same signals, figures and plots.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Test {
    /// The motion of impactors.
    Impact,
    /// The force of jaws over their travel.
    Stretch,
    /// The force on an impactor over its depth.
    Indent {
        /// Speed of the impactor, m/s.
        velocity: f64,
    },
    /// Pressure, rise and volume of film on gas.
    Inflation,
}

/// The part that inertia plays in a test.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Inertia {
    /// It is what the test is about.
    Dynamic,
    /// It should not matter; how much it does is reported.
    Reported,
    /// It must not matter: the film is in equilibrium throughout, and its failure ends the test.
    Negligible,
}

/// Where the factor on the film's mass comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MassScaling {
    /// The film has its own mass.
    Unscaled,
    /// From the scenario.
    Given(f64),
    /// From the duration of the test.
    Chosen,
}

impl From<Option<f64>> for MassScaling {
    fn from(written: Option<f64>) -> MassScaling {
        written.map_or(MassScaling::Chosen, MassScaling::Given)
    }
}

/// The impactors that a loading needs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Impactors {
    /// None.
    None,
    /// One, whose motion it prescribes.
    Prescribed,
    /// At least one, which moves by its mass.
    Free,
}

/// Why something is not possible under a loading.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Refusal {
    /// It is not allowed, for this reason.
    NotAllowed(&'static str),
    /// It is not supported or not sensible.
    Unsupported {
        /// The fact.
        message: &'static str,
        /// The remedy.
        hint: &'static str,
    },
}

impl Refusal {
    /// Reports what is written at the key path.
    pub(in crate::model) fn report(self, path: &str, mistakes: &mut ModelDiagnostics<'_>) {
        match self {
            Refusal::NotAllowed(why) => mistakes.out_of_place(path, why),
            Refusal::Unsupported { message, hint } => mistakes.report_with(path, message, hint),
        }
    }
}

/// Film on gas is held all around.
pub(super) const GAS_HOLD: Refusal = Refusal::Unsupported {
    message: "pressure escapes past an edge that is not held",
    hint: "leave the key out, or hold \"all\"",
};

/// Film on gas touches no bars.
pub(super) const GAS_BARS: Refusal = Refusal::Unsupported {
    message: "bars under film with pressure are not supported",
    hint: "leave them out: pressure lifts film off the bars below it",
};

/// Film on gas does not slip.
pub(super) const GAS_CLAMP: Refusal = Refusal::Unsupported {
    message: "film that slips in its clamp under pressure is not supported",
    hint: "leave it out; the edge of film under pressure is held without slip",
};

/// Film on gas hangs on no springs.
pub(super) const GAS_SPRINGS: Refusal = Refusal::Unsupported {
    message: "film on springs under pressure is not supported",
    hint: "leave them out; the edge of film under pressure is fixed",
};

/// Time at constant pressure or volume over the time in which it rises.
const GAS_REST: f64 = 0.5;

/// Simulated time of a test by gas that is let in over `ramp`, s.
pub(super) fn gas_time(ramp: f64) -> f64 {
    (1.0 + GAS_REST) * ramp
}

/// Keys that are allowed under an impact alone, and why.
pub(super) const OF_IMPACTS: [(&str, &str); 2] = [
    ("reference.signals", "only an impact is compared with recorded signals"),
    ("output.filter", "only an impact has a filtered channel"),
];

/// The key of a damping that a quasi-static test chooses, and why.
pub(super) const DAMPED: (&str, &str) =
    ("specimen.damping", "the damping of a quasi-static test follows from its duration");

/// Reports those of the keys that are written.
pub(super) fn out_of_place(keys: &[(&str, &str)], mistakes: &mut ModelDiagnostics<'_>) {
    for (path, why) in keys {
        if mistakes.is_written(path) {
            mistakes.out_of_place(path, *why);
        }
    }
}
