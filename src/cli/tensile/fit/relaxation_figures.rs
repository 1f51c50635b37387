//! The figures of a fitted relaxation, as text and as JSON.

use serde::Serialize;

use super::fitted::Fitted;
use crate::{findings, table};
use base::finding::Finding;
use base::number::{figure, plain, rounded, significant};
use lab::experiment::relaxation::{ShiftLaw, ShiftLawFit, ZERO_CELSIUS};

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
    shift: Option<ShiftFigures>,
    findings: Vec<Finding>,
    written: Vec<String>,
}

#[derive(Serialize)]
struct TermFigures {
    share: f64,
    time_s: f64,
}

#[derive(Serialize)]
struct ShiftFigures {
    #[serde(rename = "reference_K")]
    reference_k: f64,
    factors: Vec<FactorFigures>,
    wlf: Option<ShiftLawFigures>,
    arrhenius: Option<ShiftLawFigures>,
}

#[derive(Serialize)]
struct FactorFigures {
    #[serde(rename = "temperature_K")]
    temperature_k: f64,
    log_shift: f64,
}

#[derive(Serialize)]
struct ShiftLawFigures {
    #[serde(flatten)]
    constants: ShiftConstants,
    rms_decades: f64,
    largest_error_decades: f64,
    #[serde(rename = "largest_error_at_K")]
    largest_error_at_k: f64,
}

#[derive(Serialize)]
#[serde(untagged)]
enum ShiftConstants {
    Wlf {
        c1: f64,
        #[serde(rename = "c2_K")]
        c2_k: f64,
    },
    Arrhenius {
        #[serde(rename = "energy_J_mol")]
        energy_j_mol: f64,
    },
}

impl RelaxationFigures {
    pub(super) fn new(fitted: &Fitted, findings: Vec<Finding>, written: Vec<String>) -> RelaxationFigures {
        let fit = &fitted.fit;
        let shift = fitted.master.as_ref().map(|(master, fits)| ShiftFigures {
            reference_k: master.reference,
            factors: master
                .factors
                .iter()
                .map(|factor| FactorFigures { temperature_k: factor.temperature, log_shift: factor.log_shift })
                .collect(),
            wlf: fits.wlf.as_ref().map(shift_law),
            arrhenius: fits.arrhenius.as_ref().map(shift_law),
        });
        RelaxationFigures {
            source: fitted.source.clone(),
            moduli: fit.measured.len(),
            instantaneous_modulus_pa: fit.prony.instantaneous,
            equilibrium_modulus_pa: fit.prony.equilibrium(),
            terms: fit.prony.terms.iter().map(|term| TermFigures { share: term.share, time_s: term.time }).collect(),
            r_squared: fit.r_squared,
            relative_rms: fit.relative_rms,
            largest_relative_error: fit.largest_error,
            largest_error_at_time_s: fit.at_time,
            shift,
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
            "{}: {} moduli, {} terms\n{}  instantaneous {} MPa, in the end {} MPa\n  R2 {:.6}, error {} % rms, {} % at most, at {} s\n{}{}{}",
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
            self.shift.as_ref().map(ShiftFigures::text).unwrap_or_default(),
            findings::lines("", &self.findings),
            self.written.iter().map(|file| format!("wrote {file}\n")).collect::<String>()
        )
    }
}

impl ShiftFigures {
    fn text(&self) -> String {
        let celsius = |kelvin: f64| significant(kelvin - ZERO_CELSIUS, 4);
        let laws = [("WLF", &self.wlf), ("Arrhenius", &self.arrhenius)].map(|(name, law)| match law {
            Some(law) => format!("  {name}: {}\n", law.text()),
            None => format!("  {name}: not determined\n"),
        });
        format!(
            "  shift factors of {} temperatures, reference {} degC\n{}",
            self.factors.len(),
            celsius(self.reference_k),
            laws.concat()
        )
    }
}

impl ShiftLawFigures {
    fn text(&self) -> String {
        let constants = match self.constants {
            ShiftConstants::Wlf { c1, c2_k } => format!("C1 {}, C2 {} K", figure(c1, 5), figure(c2_k, 5)),
            ShiftConstants::Arrhenius { energy_j_mol } => format!("energy {} kJ/mol", figure(energy_j_mol * 1e-3, 5)),
        };
        format!(
            "{constants}; error {} decades rms, {} at most, at {} degC",
            significant(self.rms_decades, 3),
            significant(self.largest_error_decades, 3),
            significant(self.largest_error_at_k - ZERO_CELSIUS, 3)
        )
    }
}

fn shift_law(fit: &ShiftLawFit) -> ShiftLawFigures {
    ShiftLawFigures {
        constants: match fit.law {
            ShiftLaw::Wlf(law) => ShiftConstants::Wlf { c1: law.c1, c2_k: law.c2 },
            ShiftLaw::Arrhenius(law) => ShiftConstants::Arrhenius { energy_j_mol: law.energy },
        },
        rms_decades: fit.rms,
        largest_error_decades: fit.largest_error,
        largest_error_at_k: fit.at_temperature,
    }
}
