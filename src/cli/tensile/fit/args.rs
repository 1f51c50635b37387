//! The arguments of `droptower tensile fit`.

use std::path::PathBuf;
use std::str::FromStr;

use clap::{ArgGroup, Args, ValueEnum};

use crate::argument::{number, quantity};
use crate::signal::input::FileArgs;
use base::units::{Density, Length};
use lab::experiment::coupon::WINDOW;
use lab::experiment::law_fit::plastic::{HardeningForm, PlasticDirection};
use lab::experiment::law_fit::{LawChoice, TestKind, Weighting};
use lab::experiment::material_file::fitted::FilmKeys;
use lab::experiment::relaxation::ZERO_CELSIUS;

/// Number of terms of a Prony series where none is given.
const TERMS: usize = 12;

#[derive(Debug, Args)]
#[command(group(ArgGroup::new("what").required(true).args(["law", "relaxation"])))]
pub(crate) struct FitArgs {
    /// Measured data, files or globs. For --law the columns `stretch` (or `strain`) and nominal `stress`, of a biaxial
    /// test `stretch_1`, `stretch_2`, `stress_1`, `stress_2`, of plastic laws `strain` and `stress`; for --relaxation one file with `time` and `modulus` and,
    /// of several temperatures, `temperature_degC`
    #[arg(required = true, value_name = "DATA")]
    pub data: Vec<String>,
    /// The law: neo-hookean, compressible-neo-hookean, mooney-rivlin, yeoh, gent, ogden:N, plastic:voce or plastic:table
    #[arg(long, value_name = "LAW")]
    pub law: Option<FittedLaw>,
    /// Fit a Prony series to a relaxation modulus
    #[arg(long)]
    pub relaxation: bool,
    /// The material file to write, FILE.toml; a page with the curves goes beside it, as FILE.html
    #[arg(long, short, value_name = "FILE")]
    pub out: Option<PathBuf>,
    /// The page to write, FILE.html, in place of one beside the material file
    #[arg(long, value_name = "FILE")]
    pub page: Option<PathBuf>,
    /// Density of the film, for the material file: "915 kg/m3"
    #[arg(long, value_parser = |text: &str| quantity(Density::DIMENSION, text))]
    pub density: Option<f64>,
    /// Thickness of one layer, for the material file: "12 um"
    #[arg(long, value_parser = |text: &str| quantity(Length::DIMENSION, text))]
    pub thickness: Option<f64>,
    /// Kinds of the tests in the order of the files, or one for all, in place of what the files state: uniaxial (ut),
    /// equibiaxial (et), plane (ps) or biaxial
    #[arg(long, value_name = "KINDS", value_delimiter = ',', conflicts_with = "relaxation")]
    pub test: Vec<TestKind>,
    /// Weights of the files in their order, or one for all
    #[arg(long, value_name = "WEIGHTS", value_delimiter = ',', value_parser = number, conflicts_with = "relaxation")]
    pub weight: Vec<f64>,
    /// Whether differences of stress count as they are or over the measured stress: absolute or relative
    #[arg(long, value_name = "HOW", default_value_t, conflicts_with = "relaxation")]
    pub residual: Weighting,
    /// A test to predict with the fitted law, several times; its kind as that of the data
    #[arg(long, value_name = "FILE", conflicts_with = "relaxation")]
    pub predict: Vec<String>,
    /// Stretch up to which the law must be stable in uniaxial, equibiaxial and plane tension [default: the largest of
    /// the data]
    #[arg(long, value_name = "STRETCH", value_parser = number, conflicts_with = "relaxation")]
    pub stable_to: Option<f64>,
    /// Most terms of the Prony series
    #[arg(long, value_name = "N", default_value_t = TERMS, conflicts_with = "law")]
    pub terms: usize,
    /// Poisson's ratio, for the material file of a relaxation or of a plastic law
    #[arg(long, value_name = "RATIO", value_parser = number)]
    pub poisson: Option<f64>,
    /// Shift factors of the temperatures: columns `temperature_degC` and `log_shift` (decades) [default: by overlap]
    #[arg(long, value_name = "FILE", conflicts_with = "law")]
    pub shift_factors: Option<PathBuf>,
    /// The law of the shift factors to write [default: the one that follows them more closely]
    #[arg(long, value_name = "LAW", conflicts_with = "law")]
    pub shift: Option<ShiftWord>,
    /// Reference temperature of the master curve: "20 degC" [default: that of given factors, or the middle one]
    #[arg(long, value_name = "TEMPERATURE", value_parser = temperature, conflicts_with = "law")]
    pub reference: Option<f64>,
    #[command(flatten)]
    pub plastic: PlasticArgs,
    #[command(flatten)]
    pub file: FileArgs,
}

/// What only plastic laws need.
#[derive(Clone, Debug, Args)]
pub(crate) struct PlasticArgs {
    /// Directions of the coupons in the order of their files, for plastic laws: MD, TD, D3 (45°) or ND (normal)
    #[arg(long, value_name = "DIRECTIONS", value_delimiter = ',', conflicts_with = "relaxation")]
    pub directions: Vec<PlasticDirection>,
    /// Strains between which the modulus is fitted, for plastic laws
    #[arg(long, num_args = 2, value_names = ["FROM", "TO"], default_values_t = WINDOW, value_parser = number)]
    pub window: Vec<f64>,
    /// Plastic strain from which on the hardening is fitted, for plastic laws
    #[arg(long, value_name = "STRAIN", default_value_t = 0.002, value_parser = number)]
    pub offset: f64,
}

/// A law that the command fits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum FittedLaw {
    /// Of stresses over stretches.
    Stresses(LawChoice),
    /// Of film that yields.
    Plastic(HardeningForm),
}

impl FromStr for FittedLaw {
    type Err = String;

    fn from_str(word: &str) -> Result<FittedLaw, String> {
        match HardeningForm::named(word) {
            Some(form) => Ok(FittedLaw::Plastic(form)),
            None => {
                let choice = word.parse().map(FittedLaw::Stresses);
                choice.map_err(|error| format!("{error}; of film that yields {}", HardeningForm::WORDS))
            }
        }
    }
}

/// A law of shift factors.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum ShiftWord {
    /// Williams, Landel and Ferry's
    Wlf,
    /// Arrhenius'
    Arrhenius,
}

impl FitArgs {
    /// The film's keys.
    pub(super) fn film(&self) -> FilmKeys {
        FilmKeys { density: self.density, thickness: self.thickness }
    }
}

/// A temperature in K of `20 degC` or `293.15 K`.
fn temperature(text: &str) -> Result<f64, String> {
    let (value, zero) = match (text.strip_suffix("degC").or(text.strip_suffix("°C")), text.strip_suffix('K')) {
        (Some(celsius), _) => (celsius, ZERO_CELSIUS),
        (None, Some(kelvin)) => (kelvin, 0.0),
        (None, None) => {
            return Err(format!("expected a temperature such as \"20 degC\" or \"293.15 K\", found \"{text}\""));
        }
    };
    let kelvin = number(value)? + zero;
    if kelvin > 0.0 { Ok(kelvin) } else { Err(format!("\"{text}\" is below absolute zero")) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn temperatures_have_their_unit() {
        assert_eq!(temperature("20 degC"), Ok(293.15));
        assert_eq!(temperature("-10°C"), Ok(263.15));
        assert_eq!(temperature("300 K"), Ok(300.0));
        for wrong in ["20", "20 F", "-300 degC", "warm degC"] {
            assert!(temperature(wrong).is_err(), "{wrong}");
        }
    }
}
