//! Materials for which there is a template: one a law, and films by name.

use std::path::PathBuf;
use std::sync::LazyLock;

use clap::builder::PossibleValue;
use clap::{Args, ValueEnum};
use serde::Serialize;

use crate::new::Template;
use crate::{Failure, Shared, print, print_json};

#[derive(Debug, Args)]
pub(crate) struct MaterialArgs {
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
    pub(crate) fn template(&self) -> Option<(Template, &PathBuf)> {
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
pub(crate) fn list(shared: &Shared) -> Result<(), Failure> {
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
enum MaterialKind {
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
    pub(crate) fn template(self) -> Template {
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

/// Films by name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum FilmKind {
    /// LLDPE stretch film, 12 µm
    Lldpe,
    /// LDPE film, blown, 40 µm
    Ldpe,
    /// PP film, biaxially oriented, 20 µm
    Pp,
    /// PET film, biaxially oriented, 23 µm
    Pet,
    /// PVC film without a plasticizer, 25 µm
    Pvc,
    /// Silicone rubber without a filler, 0.5 mm
    Silicone,
    /// Natural rubber, 0.5 mm
    NaturalRubber,
}

/// A film of the library.
#[derive(Clone, Copy, Debug, Serialize)]
pub(crate) struct Film {
    /// Where its values come from.
    pub source: &'static str,
    /// What is assumed, beside the values that the file marks so.
    pub assumed: &'static str,
    /// The mass of a falling dart on its data sheet; none where there is none.
    pub dart: Option<&'static str>,
    /// The keys of the material file.
    #[serde(skip)]
    keys: &'static str,
}

/// What a virtual dart needs beside the values of a data sheet.
const NEEDED: &str = "Coupons are slower than a dart and pulled in one direction: a virtual dart needs beside them the curves at its rate \
                      (some 100 1/s), the strain at break under biaxial stretch, the shear curve, and the friction of its \
                      head. `droptower new d1709-a dart.toml` is the test, `droptower script failure-mass --scenario dart.toml` \
                      its mass; scripts/dart-data-sheet.rhai has what each of these changes.";

impl FilmKind {
    /// Its entry.
    pub(crate) fn film(self) -> Film {
        match self {
            FilmKind::Lldpe => Film {
                source: "Polymers 2021, 13, 1537: Tables 1, 4, 5 and 7",
                assumed: "the shear curve; the quasi-static curves hold at all rates (without their multipliers)",
                dart: Some("40 g at 12 um (ASTM D1709 A; Table 1 of the study)"),
                keys: include_str!("templates/films/lldpe.toml"),
            },
            FilmKind::Ldpe => Film {
                source: "J. Food Sci. Technol. 52 (2015) 5456, doi 10.1007/s13197-014-1682-2, Table 1: LDPE-I",
                assumed: "straight curves from yield to break, the shear curve, the absorption; no rate",
                dart: Some("2.6 g/um, 104 g at 40 um (the same table; its method is not clear from it)"),
                keys: include_str!("templates/films/ldpe.toml"),
            },
            FilmKind::Pp => Film {
                source: "Mitsubishi Polyester Film, comparative data for plastic films: BOPP",
                assumed: "the bends of both curves, the shear curve; no rate, no absorption",
                dart: None,
                keys: include_str!("templates/films/pp.toml"),
            },
            FilmKind::Pet => Film {
                source: "DuPont Teijin Films, Mylar physical-thermal properties, H-37232-3, Table 1: 92A",
                assumed: "TD is like MD (510 kgf/mm2, 235 MPa at 91 %); no rate; the film keeps its set",
                dart: None,
                keys: include_str!("templates/films/pet.toml"),
            },
            FilmKind::Pvc => Film {
                source: "J. Food Sci. Technol. 52 (2015) 5456, doi 10.1007/s13197-014-1682-2, Table 1: PVC-I",
                assumed: "TD is like MD; no rate; the film keeps its set",
                dart: Some("0.76 g/um, 19 g at 25 um (the same table; its method is not clear from it)"),
                keys: include_str!("templates/films/pvc.toml"),
            },
            FilmKind::Silicone => Film {
                source: "Meunier et al., Polym. Test. 27 (2008) 765: three tests of an unfilled silicone rubber (data/rubber_sheet), \
                         fitted by `droptower fit rubber --law yeoh` to stretches of up to 2.2",
                assumed: "no rate, no absorption, no break",
                dart: None,
                keys: include_str!("templates/films/silicone.toml"),
            },
            FilmKind::NaturalRubber => Film {
                source: "Ogden, Proc. R. Soc. A 326 (1972) 565: terms for the tests of Treloar (1944)",
                assumed: "no rate, no absorption, no break",
                dart: None,
                keys: include_str!("templates/films/natural-rubber.toml"),
            },
        }
    }
}

impl Film {
    /// The material file: what is known of the film as comments, then its keys.
    pub(crate) fn text(&self) -> String {
        let dart = self.dart.map(|mass| format!("Falling dart on its data sheet: {mass}. {NEEDED}"));
        let lines = [
            Some(format!("Source: {}.", self.source)),
            Some(format!("Assumed: {}; and what is marked so below.", self.assumed)),
            dart,
            Some("Films of one name differ: replace the values by your own tests (`droptower reduce coupon`).".into()),
            Some("In a scenario: [specimen] material = \"film.toml\"".into()),
        ];
        let comments: String = lines.into_iter().flatten().flat_map(|line| wrapped(&line)).collect();
        format!("{comments}{}", self.keys)
    }
}

/// Most characters of a line of comments.
const WIDTH: usize = 120;

/// The text as lines of comments.
fn wrapped(text: &str) -> Vec<String> {
    let mut lines = vec![String::from("#")];
    for word in text.split_whitespace() {
        match lines.last_mut() {
            Some(line) if line.chars().count() + 1 + word.chars().count() <= WIDTH => *line += &format!(" {word}"),
            _ => lines.push(format!("# {word}")),
        }
    }
    lines.into_iter().map(|line| line + "\n").collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_film_names_its_source_and_what_a_dart_needs() {
        for kind in FilmKind::value_variants() {
            let film = kind.film();
            let text = film.text();
            assert!(text.starts_with("# Source: ") && text.contains("\n# Assumed: "), "{text}");
            assert_eq!(text.contains("a virtual dart needs"), film.dart.is_some(), "{text}");
            assert!(
                text.lines().filter(|line| line.starts_with('#')).all(|line| line.chars().count() <= WIDTH),
                "{text}"
            );
        }
    }
}
