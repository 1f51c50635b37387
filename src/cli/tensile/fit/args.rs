//! The arguments of `droptower tensile fit`.

use std::path::PathBuf;

use clap::{ArgGroup, Args};

use crate::cli::argument::{number, quantity};
use crate::cli::signal::input::FileArgs;
use crate::experiment::law_fit::LawChoice;
use crate::units::{Density, Length};

#[derive(Debug, Args)]
#[command(group(ArgGroup::new("what").required(true).args(["law", "relaxation"])))]
pub(crate) struct FitArgs {
    /// Measured data, files or globs. For --law: columns `stretch` (or `strain`) and nominal `stress`, or `stretch_1`,
    /// `stretch_2`, `stress_1`, `stress_2`. For --relaxation: `time` and `modulus`
    #[arg(required = true, value_name = "DATA")]
    pub data: Vec<String>,
    /// The law: neo-hookean, compressible-neo-hookean, mooney-rivlin, yeoh, gent or ogden:N
    #[arg(long, value_name = "LAW")]
    pub law: Option<LawChoice>,
    /// Fit a Prony series to a relaxation modulus
    #[arg(long)]
    pub relaxation: bool,
    /// The material file to write, FILE.toml; its page goes beside it, as FILE.html
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
    /// Weights of the files in their order, or one for all
    #[arg(long, value_name = "WEIGHTS", value_delimiter = ',', value_parser = number)]
    pub weight: Vec<f64>,
    #[command(flatten)]
    pub file: FileArgs,
}
