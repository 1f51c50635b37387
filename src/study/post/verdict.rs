//! Whether film held: the one verdict of a run, which pages, sweeps, comparisons and scripts take.

use serde::{Serialize, Serializer};
use serde_json::Value;

use super::impact::BodyFigures;
use super::{Measures, RunFindings, lowest_point};
use base::finding::Finding;
use base::words;
use lab::signal::Recording;
use scene::model::{Face, Model};
use scene::simulate::Outcome;

words! {
    /// Whether film held.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum Verdict {
        /// It broke.
        Ruptured = "ruptured",
        /// It has no break criterion.
        CannotBreak = "cannot break",
        /// It had not broken when the run ended, before the lowest point of an impactor.
        Descending = "still descending",
        /// It did not break, but on elements that are too coarse for a break.
        TooCoarse = "too coarse to tell",
        /// It did not break.
        Held = "held",
    }
}

/// The name of the figure.
pub const VERDICT: &str = "verdict";

impl Serialize for Verdict {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        to.collect_str(self)
    }
}

impl Verdict {
    /// That of a run of `model`.
    pub(super) fn of_run(
        model: &Model,
        outcome: &Outcome,
        measures: &Measures,
        signals: &Recording,
        findings: &RunFindings,
    ) -> Verdict {
        let descends =
            |body: &BodyFigures| body.peak_displacement_m.is_some() && lowest_point(signals, &body.prefix).is_none();
        match measures {
            _ if outcome.rupture_time.is_some() => Verdict::Ruptured,
            _ if !model.faces.iter().any(can_break) => Verdict::CannotBreak,
            Measures::Impact(impact) if impact.bodies.iter().any(descends) => Verdict::Descending,
            _ if is_too_coarse(findings) => Verdict::TooCoarse,
            _ => Verdict::Held,
        }
    }

    /// Of a film that did not break: what its sentence begins with.
    pub fn sentence(self) -> &'static str {
        match self {
            Verdict::Ruptured => "The film ruptured",
            Verdict::CannotBreak => "The film cannot break, as it has no break criterion",
            Verdict::Descending => "No film broke until the run ended, before the lowest point",
            Verdict::TooCoarse => "No film broke, but its elements are too coarse to tell whether it holds",
            Verdict::Held => "The film held",
        }
    }

    /// Of a film that did not break: what its tile says, and what stands beside.
    pub fn tile(self) -> [&'static str; 2] {
        match self {
            Verdict::Ruptured => ["ruptured", ""],
            Verdict::CannotBreak => ["cannot break", "no break criterion"],
            Verdict::Descending => ["not told", "the run ends before the lowest point"],
            Verdict::TooCoarse => ["not told", "elements too coarse"],
            Verdict::Held => ["held", ""],
        }
    }
}

fn can_break(face: &Face) -> bool {
    face.material.rupture.is_some() || face.material.break_strains().iter().any(|strain| strain.is_finite())
}

/// Elements over the radius of a sphere from which three of them span it.
const COARSE: f64 = 0.67;

fn is_too_coarse(findings: &RunFindings) -> bool {
    let edge = |finding: &Finding| finding.figures.get("edge_over_radius").and_then(Value::as_f64);
    findings.iter().filter_map(edge).any(|edge| edge > COARSE)
}
