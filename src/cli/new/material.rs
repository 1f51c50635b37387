//! Materials for which there is a template: one a law, and films by name.

use std::path::PathBuf;
use std::sync::LazyLock;

use clap::builder::PossibleValue;
use clap::{Args, ValueEnum};
use serde::Serialize;

use super::Template;
use super::films::{Film, FilmKind};
use crate::{Failure, Shared, print, print_json};

#[derive(Debug, Args)]
pub(super) struct MaterialArgs {
    /// The law of the film, or a film by name
    #[arg(required_unless_present = "list")]
    kind: Option<Choice>,
    /// The file to write; an existing file is not replaced
    #[arg(required_unless_present = "list")]
    path: Option<PathBuf>,
    /// List the laws and the films, these with their source, what is assumed, and the dart's mass of their data sheet
    #[arg(long, conflicts_with_all = ["kind", "path"])]
    list: bool,
}

/// A law or a film.
#[derive(Clone, Copy, Debug)]
enum Choice {
    Law(MaterialKind),
    Film(FilmKind),
}

impl ValueEnum for Choice {
    fn value_variants<'a>() -> &'a [Choice] {
        static ALL: LazyLock<Vec<Choice>> = LazyLock::new(|| {
            let laws = MaterialKind::value_variants().iter().map(|law| Choice::Law(*law));
            laws.chain(FilmKind::value_variants().iter().map(|film| Choice::Film(*film))).collect()
        });
        &ALL
    }

    fn to_possible_value(&self) -> Option<PossibleValue> {
        match self {
            Choice::Law(law) => law.to_possible_value(),
            Choice::Film(film) => film.to_possible_value(),
        }
    }
}

impl MaterialArgs {
    /// The template and where it is written; none where they are to be listed.
    pub(super) fn template(&self) -> Option<(Template, &PathBuf)> {
        let template = match self.kind? {
            Choice::Law(law) => law.template(),
            Choice::Film(film) => Template { text: film.film().text().into(), scripts: &[] },
        };
        Some((template, self.path.as_ref()?))
    }
}

/// An entry of the list.
#[derive(Serialize)]
struct Entry {
    name: String,
    about: String,
    #[serde(flatten)]
    film: Option<Film>,
}

fn entries() -> Vec<Entry> {
    let entry = |choice: &Choice| {
        let value = choice.to_possible_value()?;
        let film = match choice {
            Choice::Law(_) => None,
            Choice::Film(film) => Some(film.film()),
        };
        let about = value.get_help().map(ToString::to_string).unwrap_or_default();
        Some(Entry { name: value.get_name().to_owned(), about, film })
    };
    Choice::value_variants().iter().filter_map(entry).collect()
}

/// Lists the laws and the films.
pub(super) fn list(shared: &Shared) -> Result<(), Failure> {
    let entries = entries();
    if shared.json {
        return print_json(&entries);
    }
    let width = entries.iter().map(|entry| entry.name.len()).max().unwrap_or_default();
    let line = |entry: &Entry| {
        let head = format!("{:width$}  {}", entry.name, entry.about);
        let Some(film) = &entry.film else { return head };
        let gap = " ".repeat(width + 2);
        let dart = film.dart.map_or(String::new(), |dart| format!("\n{gap}dart: {dart}"));
        format!("{head}\n{gap}source: {}\n{gap}assumed: {}{dart}", film.source, film.assumed)
    };
    print(&entries.iter().map(line).collect::<Vec<_>>().join("\n"))
}

/// Laws of film.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub(super) enum MaterialKind {
    /// Two fibre sets and shear: stretch film from tensile curves in MD and TD
    Fabric,
    /// The same with a curve for each strain rate
    Rates,
    /// Linear elastic
    Elastic,
    /// Rubber, one modulus
    NeoHookean,
    /// The same with a volume that changes
    CompressibleNeoHookean,
    /// Rubber, two moduli
    MooneyRivlin,
    /// Rubber, three moduli: stiffens at large strain
    Yeoh,
    /// Rubber with a largest stretch
    Gent,
    /// Rubber, up to six terms
    Ogden,
    /// Yields and keeps a set: polyethylene, aluminium
    Plastic,
    /// Relaxes: a Prony series on a law of rubber
    Viscous,
    /// Tears: a criterion and a fracture energy on a law that yields
    Tearing,
}

impl MaterialKind {
    /// Its material file.
    pub(super) fn template(self) -> Template {
        let text = match self {
            MaterialKind::Fabric => include_str!("templates/materials/fabric.toml"),
            MaterialKind::Rates => include_str!("templates/materials/rates.toml"),
            MaterialKind::Elastic => include_str!("templates/materials/elastic.toml"),
            MaterialKind::NeoHookean => include_str!("templates/materials/neo-hookean.toml"),
            MaterialKind::CompressibleNeoHookean => {
                include_str!("templates/materials/compressible-neo-hookean.toml")
            }
            MaterialKind::MooneyRivlin => include_str!("templates/materials/mooney-rivlin.toml"),
            MaterialKind::Yeoh => include_str!("templates/materials/yeoh.toml"),
            MaterialKind::Gent => include_str!("templates/materials/gent.toml"),
            MaterialKind::Ogden => include_str!("templates/materials/ogden.toml"),
            MaterialKind::Plastic => include_str!("templates/materials/plastic.toml"),
            MaterialKind::Viscous => include_str!("templates/materials/viscous.toml"),
            MaterialKind::Tearing => include_str!("templates/materials/tearing.toml"),
        };
        Template { text: text.into(), scripts: &[] }
    }
}
