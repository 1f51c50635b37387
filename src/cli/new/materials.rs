//! Materials for which there is a template: one a law, and films by name.

use std::path::PathBuf;

use clap::builder::PossibleValue;
use clap::{Args, ValueEnum};
use serde::Serialize;

use crate::new::Template;
use crate::{Failure, Shared, print, print_json};

#[derive(Debug, Args)]
pub(crate) struct MaterialArgs {
    /// The law of the film, or a film by name
    #[arg(required_unless_present = "list")]
    kind: Option<Material>,
    /// The file to write; an existing file is not replaced
    #[arg(required_unless_present = "list")]
    path: Option<PathBuf>,
    /// List the laws and the films, these with their source, what is assumed, and the dart's mass of their data sheet
    #[arg(long, conflicts_with_all = ["kind", "path"])]
    list: bool,
}

impl MaterialArgs {
    /// The template and where it is written; none where they are to be listed.
    pub(crate) fn template(&self) -> Option<(Template, &PathBuf)> {
        Some((Template { text: self.kind?.text().into(), scripts: &[] }, self.path.as_ref()?))
    }
}

/// A law to fill in, or a film by name.
#[derive(Clone, Copy, Debug, Serialize)]
struct Material {
    name: &'static str,
    about: &'static str,
    /// None of a law.
    #[serde(flatten)]
    film: Option<Film>,
    /// The keys of the material file.
    #[serde(skip)]
    keys: &'static str,
}

/// A film of the library.
#[derive(Clone, Copy, Debug, Serialize)]
struct Film {
    /// Where its values come from.
    source: &'static str,
    /// What is assumed, beside the values that the file marks so.
    assumed: &'static str,
    /// The mass of a falling dart on its data sheet; none where there is none.
    dart: Option<&'static str>,
}

macro_rules! law {
    ($name:literal, $about:literal) => {
        Material {
            name: $name,
            about: $about,
            film: None,
            keys: include_str!(concat!("templates/materials/", $name, ".toml")),
        }
    };
}

/// The laws, and the films by name.
static MATERIALS: [Material; 19] = [
    law!("fabric", "Two fibre sets and shear: stretch film from tensile curves in MD and TD"),
    law!("rates", "The same with a curve for each strain rate"),
    law!("elastic", "Linear elastic"),
    law!("neo-hookean", "Rubber, one modulus"),
    law!("compressible-neo-hookean", "The same with a volume that changes"),
    law!("mooney-rivlin", "Rubber, two moduli"),
    law!("yeoh", "Rubber, three moduli: stiffens at large strain"),
    law!("gent", "Rubber with a largest stretch"),
    law!("ogden", "Rubber, up to six terms"),
    law!("plastic", "Yields and keeps a set: polyethylene, aluminium"),
    law!("viscous", "Relaxes: a Prony series on a law of rubber"),
    law!("tearing", "Tears: a criterion and a fracture energy on a law that yields"),
    Material {
        name: "lldpe",
        about: "LLDPE stretch film, 12 µm",
        film: Some(Film {
            source: "Polymers 2021, 13, 1537: Tables 1, 4, 5 and 7",
            assumed: "the shear curve; the quasi-static curves hold at all rates (without their multipliers)",
            dart: Some("40 g at 12 um (ASTM D1709 A; Table 1 of the study)"),
        }),
        keys: include_str!("templates/films/lldpe.toml"),
    },
    Material {
        name: "ldpe",
        about: "LDPE film, blown, 40 µm",
        film: Some(Film {
            source: "J. Food Sci. Technol. 52 (2015) 5456, doi 10.1007/s13197-014-1682-2, Table 1: LDPE-I",
            assumed: "straight curves from yield to break, the shear curve, the absorption; no rate",
            dart: Some("2.6 g/um, 104 g at 40 um (the same table; its method is not clear from it)"),
        }),
        keys: include_str!("templates/films/ldpe.toml"),
    },
    Material {
        name: "pp",
        about: "PP film, biaxially oriented, 20 µm",
        film: Some(Film {
            source: "Mitsubishi Polyester Film, comparative data for plastic films: BOPP",
            assumed: "the bends of both curves, the shear curve; no rate, no absorption",
            dart: None,
        }),
        keys: include_str!("templates/films/pp.toml"),
    },
    Material {
        name: "pet",
        about: "PET film, biaxially oriented, 23 µm",
        film: Some(Film {
            source: "DuPont Teijin Films, Mylar physical-thermal properties, H-37232-3, Table 1: 92A",
            assumed: "TD is like MD (510 kgf/mm2, 235 MPa at 91 %); no rate; the film keeps its set",
            dart: None,
        }),
        keys: include_str!("templates/films/pet.toml"),
    },
    Material {
        name: "pvc",
        about: "PVC film without a plasticizer, 25 µm",
        film: Some(Film {
            source: "J. Food Sci. Technol. 52 (2015) 5456, doi 10.1007/s13197-014-1682-2, Table 1: PVC-I",
            assumed: "TD is like MD; no rate; the film keeps its set",
            dart: Some("0.76 g/um, 19 g at 25 um (the same table; its method is not clear from it)"),
        }),
        keys: include_str!("templates/films/pvc.toml"),
    },
    Material {
        name: "silicone",
        about: "Silicone rubber without a filler, 0.5 mm",
        film: Some(Film {
            source: "Meunier et al., Polym. Test. 27 (2008) 765: three tests of an unfilled silicone rubber (data/rubber_sheet), \
                     fitted by `droptower fit rubber --law yeoh` to stretches of up to 2.2",
            assumed: "no rate, no absorption, no break",
            dart: None,
        }),
        keys: include_str!("templates/films/silicone.toml"),
    },
    Material {
        name: "natural-rubber",
        about: "Natural rubber, 0.5 mm",
        film: Some(Film {
            source: "Ogden, Proc. R. Soc. A 326 (1972) 565: terms for the tests of Treloar (1944)",
            assumed: "no rate, no absorption, no break",
            dart: None,
        }),
        keys: include_str!("templates/films/natural-rubber.toml"),
    },
];

/// What a virtual dart needs beside the values of a data sheet.
const NEEDED: &str = "Coupons are slower than a dart and pulled in one direction: a virtual dart needs beside them the curves at its rate \
                      (some 100 1/s), the strain at break under biaxial stretch, the shear curve, and the friction of its \
                      head. `droptower new d1709-a dart.toml` is the test, `droptower script failure-mass --scenario dart.toml` \
                      its mass; scripts/dart-data-sheet.rhai has what each of these changes.";

impl ValueEnum for Material {
    fn value_variants<'a>() -> &'a [Material] {
        &MATERIALS
    }

    fn to_possible_value(&self) -> Option<PossibleValue> {
        Some(PossibleValue::new(self.name).help(self.about))
    }
}

impl Material {
    /// The material file: what is known of a film as comments, then its keys.
    fn text(&self) -> String {
        let Some(Film { source, assumed, dart }) = self.film else { return self.keys.to_owned() };
        let lines = [
            Some(format!("Source: {source}.")),
            Some(format!("Assumed: {assumed}; and what is marked so below.")),
            dart.map(|mass| format!("Falling dart on its data sheet: {mass}. {NEEDED}")),
            Some("Films of one name differ: replace the values by your own tests (`droptower reduce coupon`).".into()),
            Some("In a scenario: [specimen] material = \"film.toml\"".into()),
        ];
        let comments: String = lines.into_iter().flatten().flat_map(|line| wrapped(&line)).collect();
        format!("{comments}{}", self.keys)
    }
}

/// Lists the laws and the films.
pub(crate) fn list(shared: &Shared) -> Result<(), Failure> {
    if shared.json {
        return print_json(&MATERIALS.as_slice());
    }
    let width = MATERIALS.iter().map(|material| material.name.len()).max().unwrap_or_default();
    let line = |material: &Material| {
        let head = format!("{:width$}  {}", material.name, material.about);
        let Some(Film { source, assumed, dart }) = material.film else { return head };
        let gap = " ".repeat(width + 2);
        let dart = dart.map_or(String::new(), |dart| format!("\n{gap}dart: {dart}"));
        format!("{head}\n{gap}source: {source}\n{gap}assumed: {assumed}{dart}")
    };
    print(&MATERIALS.iter().map(line).collect::<Vec<_>>().join("\n"))
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
        for (material, film) in MATERIALS.iter().filter_map(|material| Some((material, material.film?))) {
            let text = material.text();
            assert!(text.starts_with("# Source: ") && text.contains("\n# Assumed: "), "{text}");
            assert_eq!(text.contains("a virtual dart needs"), film.dart.is_some(), "{text}");
            let mut comments = text.lines().filter(|line| line.starts_with('#'));
            assert!(comments.all(|line| line.chars().count() <= WIDTH), "{text}");
        }
    }
}
