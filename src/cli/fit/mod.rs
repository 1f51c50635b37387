//! `droptower fit`: laws fitted to measured data, and written as a material.

mod prony;
mod rubber;

use std::path::{Path, PathBuf};

use clap::{Args, Subcommand};

use crate::argument::quantity;
use crate::signal::input::FileArgs;
use crate::{Failure, Shared, output};
use base::diagnostic::{Diagnostic, shown_path};
use base::units::{Density, Length};
use lab::experiment::material_file::fitted::FilmKeys;

#[derive(Debug, Subcommand)]
pub(super) enum FitCommand {
    /// Fit the law of a rubber-like film to measured stresses
    Rubber(rubber::RubberArgs),
    /// Fit a Prony series to a measured relaxation modulus
    Prony(prony::PronyArgs),
}

pub(super) fn run(command: &FitCommand, shared: &Shared) -> Result<(), Failure> {
    match command {
        FitCommand::Rubber(args) => rubber::run(args, shared),
        FitCommand::Prony(args) => prony::run(args, shared),
    }
}

/// What a fit writes, and how its data are read.
#[derive(Debug, Args)]
struct FittedArgs {
    /// The material file to write, FILE.toml; a page with the curves goes beside it, as FILE.html
    #[arg(long, short, value_name = "FILE")]
    out: Option<PathBuf>,
    /// The page to write, FILE.html, in place of one beside the material file
    #[arg(long, value_name = "FILE")]
    page: Option<PathBuf>,
    /// Density of the film, for the material file: "915 kg/m3"
    #[arg(long, value_parser = |text: &str| quantity(Density::DIMENSION, text))]
    density: Option<f64>,
    /// Thickness of one layer, for the material file: "12 um"
    #[arg(long, value_parser = |text: &str| quantity(Length::DIMENSION, text))]
    thickness: Option<f64>,
    #[command(flatten)]
    file: FileArgs,
}

impl FittedArgs {
    /// The film's keys.
    fn film(&self) -> FilmKeys {
        FilmKeys { density: self.density, thickness: self.thickness }
    }
}

/// Where the files of a fit go, checked before anything is computed.
struct Places {
    material: Option<PathBuf>,
    page: Option<PathBuf>,
}

impl Places {
    /// The places that the arguments name.
    fn from_args(args: &FittedArgs) -> Result<Places, Failure> {
        let material = args.out.clone();
        if let Some(path) = material.as_deref().filter(|path| !output::ends_in(path, "toml")) {
            let message = format!("a material file ends in .toml, and {} does not", shown_path(path));
            return Err(Diagnostic::new(message).into());
        }
        let page = args.page.clone().or_else(|| material.as_ref().map(|path| path.with_extension("html")));
        let checked = [
            material.as_deref().map_or(Ok(()), |path| output::check(path, "toml", None, None)),
            page.as_deref().map_or(Ok(()), |path| output::check_page(path, None)),
        ];
        match Failure::all(checked.into_iter().filter_map(Result::err)) {
            Some(failure) => Err(failure),
            None => Ok(Places { material, page }),
        }
    }

    /// Writes the page and then the material, and gives their paths.
    fn write(&self, material: &str, page: &str) -> Result<Vec<String>, Failure> {
        if let Some(path) = &self.page {
            output::write(path, |file| file.write_all(page.as_bytes()))?;
        }
        if let Some(path) = &self.material {
            output::write_sealed(&[(path.clone(), material.to_owned())])?;
        }
        Ok([&self.page, &self.material].into_iter().flatten().map(|path| shown_path(path)).collect())
    }
}

/// The name of a file without its folder.
fn name(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

fn columns<const N: usize>(names: [&str; N]) -> Vec<String> {
    names.map(str::to_owned).into()
}
