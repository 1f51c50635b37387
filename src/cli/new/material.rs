//! Materials for which there is a template: one a law.

use clap::{Args, ValueEnum};

use super::{Target, Template};

#[derive(Debug, Args)]
pub(super) struct MaterialArgs {
    /// The law of the film
    pub kind: MaterialKind,
    #[command(flatten)]
    pub target: Target,
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
        Template { text, scripts: &[] }
    }
}
