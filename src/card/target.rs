//! The solvers that cards are written for.

use serde::Serialize;

/// A solver, or what stands for one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Target {
    /// LS-DYNA.
    LsDyna,
    /// OpenRadioss.
    OpenRadioss,
    /// Abaqus/Explicit.
    Abaqus,
    /// CalculiX.
    CalculiX,
    /// FEBio.
    Febio,
    /// Kratos Multiphysics.
    Kratos,
    /// A table of curves.
    Curves,
}

impl Target {
    /// All of them.
    pub const ALL: [Target; 7] = [
        Target::LsDyna,
        Target::OpenRadioss,
        Target::Abaqus,
        Target::CalculiX,
        Target::Febio,
        Target::Kratos,
        Target::Curves,
    ];

    /// Its name on the command line.
    pub fn key(self) -> &'static str {
        match self {
            Target::LsDyna => "ls-dyna",
            Target::OpenRadioss => "openradioss",
            Target::Abaqus => "abaqus",
            Target::CalculiX => "calculix",
            Target::Febio => "febio",
            Target::Kratos => "kratos",
            Target::Curves => "curves",
        }
    }

    /// Its name in sentences.
    pub fn name(self) -> &'static str {
        match self {
            Target::LsDyna => "LS-DYNA",
            Target::OpenRadioss => "OpenRadioss",
            Target::Abaqus => "Abaqus",
            Target::CalculiX => "CalculiX",
            Target::Febio => "FEBio",
            Target::Kratos => "Kratos",
            Target::Curves => "a table of curves",
        }
    }

    /// End of the name of a card.
    pub fn ending(self) -> &'static str {
        match self {
            Target::LsDyna => "k",
            Target::OpenRadioss => "rad",
            Target::Abaqus | Target::CalculiX => "inp",
            Target::Febio => "feb",
            Target::Kratos => "json",
            Target::Curves => "csv",
        }
    }

    /// What it is written for each kind of film, and what users of its cards should know.
    pub fn about(self) -> About {
        match self {
            Target::LsDyna => About {
                laws: &[
                    ("fabric", "*MAT_FABRIC, FORM -14 with H, or 14 with unloading curves"),
                    ("elastic", "*MAT_ELASTIC"),
                    ("neo-Hookean, Mooney-Rivlin, Yeoh", "*MAT_HYPERELASTIC_RUBBER (077_H)"),
                    ("Ogden", "*MAT_OGDEN_RUBBER (077_O)"),
                    ("plastic", "*MAT_PIECEWISE_LINEAR_PLASTICITY (024), without Hill"),
                    ("Prony series on rubber", "moduli G_i and 1/tau_i"),
                ],
                advice: &[
                    "FORM 4 and 24 of *MAT_FABRIC have other measures of stress and strain: do not change FORM in a card",
                    "100 points are read off a curve unless LCINT is given, which it is in the card",
                    "the material axes are those of the element: AOPT turns them",
                ],
            },
            Target::OpenRadioss => About {
                laws: &[
                    ("fabric", "/MAT/LAW58 (FABR_A), with unloading curves"),
                    ("elastic", "/MAT/LAW19 (FABRI)"),
                    ("neo-Hookean, Mooney-Rivlin, Ogden", "/MAT/LAW42 (OGDEN)"),
                    ("plastic", "/MAT/LAW36 (PLAS_TAB); /MAT/LAW43 (HILL_TAB) with Hill"),
                    ("Prony series on rubber", "moduli G_i and tau_i"),
                ],
                advice: &[
                    "the curves of LAW58 are over engineering strain although its manual says true; shear is over degrees",
                    "its reader of LS-DYNA decks makes the curves of *MAT_034 true, cuts them where they descend and multiplies \
                     shear angles by 57: give it the LAW58",
                    "elements and contacts of your own: Iplas 1 with LAW36 and LAW43, Ismstr 10 with LAW42, Iform 2 for friction, and a \
                     limited contact stiffness (Stmax); `droptower export deck` has them all",
                    "it ends a run normally whose motion is no number: look at the signals",
                ],
            },
            Target::Abaqus => About {
                laws: &[
                    ("fabric", "*FABRIC, *UNIAXIAL; of one rate"),
                    ("elastic", "*ELASTIC"),
                    ("neo-Hookean, Mooney-Rivlin, Yeoh, Ogden", "*HYPERELASTIC"),
                    ("plastic", "*PLASTIC; *POTENTIAL with Hill"),
                    ("Prony series on rubber", "*VISCOELASTIC, TIME=PRONY: shares"),
                ],
                advice: &[
                    "mu of *HYPERELASTIC, OGDEN is mu times alpha over 2 of droptower's",
                    "the order of the data of *FABRIC is from memory: compare it with the manual",
                ],
            },
            Target::CalculiX => About {
                laws: &[
                    ("elastic", "*ELASTIC"),
                    ("neo-Hookean, Mooney-Rivlin, Yeoh, Ogden of up to 3 terms", "*HYPERELASTIC"),
                    ("plastic", "*PLASTIC, without Hill"),
                ],
                advice: &[
                    "a compressibility of zero is taken as nu = 0.475: the card has one of its own",
                    "film whose flow stress is more than a hundredth of its modulus flows at another stress than here: \
                     compare one element with `pull` of a script",
                ],
            },
            Target::Febio => About {
                laws: &[
                    ("elastic", "isotropic elastic"),
                    ("neo-Hookean, Mooney-Rivlin, Ogden", "Ogden"),
                    ("Prony series on rubber", "uncoupled viscoelastic: shares"),
                ],
                advice: &[
                    "c is mu times alpha of droptower's",
                    "use shells: its elastic membrane ignores the modulus and Poisson's ratio",
                ],
            },
            Target::Kratos => About {
                laws: &[("elastic", "LinearElasticPlaneStress2DLaw of membrane elements")],
                advice: &["the thickness is that of all layers; units are as the card says, not SI by themselves"],
            },
            Target::Curves => About {
                laws: &[("fabric", "force per width over engineering strain, by rate")],
                advice: &["for solvers whose card is not known here, material 151 of VPS among them"],
            },
        }
    }
}

/// What a target is written, and what to know of it.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct About {
    /// Kinds of film, each with the keyword that it gets.
    pub laws: &'static [(&'static str, &'static str)],
    /// What users of its cards should know.
    pub advice: &'static [&'static str],
}
