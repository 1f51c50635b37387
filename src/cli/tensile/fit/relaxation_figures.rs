//! The figures of a fitted relaxation, as text and as JSON.

use serde::Serialize;

use crate::{findings, table};
use base::finding::Finding;
use base::number::{figure, plain, rounded, significant};
use lab::experiment::relaxation::PronyFit;

/// All figures; SI.
#[derive(Serialize)]
pub(super) struct RelaxationFigures {
    source: String,
    moduli: usize,
    #[serde(rename = "instantaneous_modulus_Pa")]
    instantaneous_modulus_pa: f64,
    #[serde(rename = "equilibrium_modulus_Pa")]
    equilibrium_modulus_pa: f64,
    terms: Vec<TermFigures>,
    r_squared: f64,
    relative_rms: f64,
    largest_relative_error: f64,
    largest_error_at_time_s: f64,
    findings: Vec<Finding>,
    written: Vec<String>,
}

#[derive(Serialize)]
struct TermFigures {
    share: f64,
    time_s: f64,
}

impl RelaxationFigures {
    pub(super) fn new(source: &str, fit: &PronyFit, findings: Vec<Finding>, written: Vec<String>) -> RelaxationFigures {
        RelaxationFigures {
            source: source.into(),
            moduli: fit.measured.len(),
            instantaneous_modulus_pa: fit.prony.instantaneous,
            equilibrium_modulus_pa: fit.prony.equilibrium(),
            terms: fit.prony.terms.iter().map(|term| TermFigures { share: term.share, time_s: term.time }).collect(),
            r_squared: fit.r_squared,
            relative_rms: fit.relative_rms,
            largest_relative_error: fit.largest_error,
            largest_error_at_time_s: fit.at_time,
            findings,
            written,
        }
    }

    pub(super) fn text(&self) -> String {
        let cells = |share: String, time: String| vec![share, time];
        let header = cells("share".into(), "time (s)".into());
        let rows = self.terms.iter().map(|term| cells(figure(term.share, 5), plain(rounded(term.time_s, 5))));
        let lines: Vec<Vec<String>> = std::iter::once(header).chain(rows).collect();
        format!(
            "{}: {} moduli, {} terms\n{}  instantaneous {} MPa, in the end {} MPa\n  R2 {:.6}, error {} % rms, {} % at most, at {} s\n{}{}",
            self.source,
            self.moduli,
            self.terms.len(),
            table::aligned(&lines, 0),
            figure(self.instantaneous_modulus_pa * 1e-6, 5),
            figure(self.equilibrium_modulus_pa * 1e-6, 5),
            self.r_squared,
            significant(self.relative_rms * 100.0, 3),
            significant(self.largest_relative_error * 100.0, 3),
            plain(rounded(self.largest_error_at_time_s, 3)),
            findings::lines("", &self.findings),
            self.written.iter().map(|file| format!("wrote {file}\n")).collect::<String>()
        )
    }
}
