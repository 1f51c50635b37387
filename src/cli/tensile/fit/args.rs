//! The arguments of `droptower tensile fit`.

use std::path::PathBuf;

use clap::{ArgGroup, Args};

use crate::argument::{number, quantity};
use crate::signal::input::FileArgs;
use base::units::{Density, Length};
use lab::experiment::law_fit::hyperelastic::Energy;
use lab::experiment::law_fit::{TestKind, Weighting};
use lab::experiment::material_file::fitted::FilmKeys;

/// Number of terms of a Prony series where none is given.
const TERMS: usize = 12;

#[derive(Debug, Args)]
#[command(group(ArgGroup::new("what").required(true).args(["law", "relaxation"])))]
pub(crate) struct FitArgs {
    /// Measured data, files or globs. For --law the columns `stretch` (or `strain`) and nominal `stress`, of a biaxial
    /// test `stretch_1`, `stretch_2`, `stress_1`, `stress_2`; for --relaxation one file with `time` and `modulus`
    #[arg(required = true, value_name = "DATA")]
    pub data: Vec<String>,
    /// The law: neo-hookean, compressible-neo-hookean, mooney-rivlin, yeoh, gent or ogden:N
    #[arg(long, value_name = "LAW")]
    pub law: Option<Energy>,
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
    /// Poisson's ratio, for the material file of a relaxation
    #[arg(long, value_name = "RATIO", value_parser = number)]
    pub poisson: Option<f64>,
    #[command(flatten)]
    pub file: FileArgs,
}

impl FitArgs {
    /// The film's keys.
    pub(super) fn film(&self) -> FilmKeys {
        FilmKeys { density: self.density, thickness: self.thickness }
    }
}
