//! The solvers that cards are written for, and the consistent systems of units of cards, which have none of their own.

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

    /// Its name on the command line, its name in sentences, and the end of the name of a card.
    fn names(self) -> [&'static str; 3] {
        match self {
            Target::LsDyna => ["ls-dyna", "LS-DYNA", "k"],
            Target::OpenRadioss => ["openradioss", "OpenRadioss", "rad"],
            Target::Abaqus => ["abaqus", "Abaqus", "inp"],
            Target::CalculiX => ["calculix", "CalculiX", "inp"],
            Target::Febio => ["febio", "FEBio", "feb"],
            Target::Kratos => ["kratos", "Kratos", "json"],
            Target::Curves => ["curves", "a table of curves", "csv"],
        }
    }

    /// Its name on the command line.
    pub fn key(self) -> &'static str {
        self.names()[0]
    }

    /// Its name in sentences.
    pub fn name(self) -> &'static str {
        self.names()[1]
    }

    /// End of the name of a card.
    pub fn ending(self) -> &'static str {
        self.names()[2]
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
                    ("Prony series on rubber", "moduli G_i and tau_i; shells relax too little"),
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

/// A system of units: mass, length and time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum System {
    /// kg, m, s: N, Pa.
    KgMS,
    /// t, mm, s: N, MPa.
    TMmS,
    /// g, mm, ms: N, MPa.
    GMmMs,
    /// kg, mm, ms: kN, GPa.
    KgMmMs,
    /// lbf s²/in, in, s: lbf, psi.
    LbfInS,
}

/// Pound-force, N.
const POUND_FORCE: f64 = 4.448_221_615_260_5;

/// Inch, m.
const INCH: f64 = 0.0254;

impl System {
    /// All of them.
    pub const ALL: [System; 5] = [System::KgMS, System::TMmS, System::GMmMs, System::KgMmMs, System::LbfInS];

    /// Its name; units of mass, length, time, force and stress as words; units of mass (kg), length (m) and time (s).
    fn row(self) -> (&'static str, [&'static str; 5], [f64; 3]) {
        match self {
            System::KgMS => ("kg-m-s", ["kg", "m", "s", "N", "Pa"], [1.0, 1.0, 1.0]),
            System::TMmS => ("t-mm-s", ["t", "mm", "s", "N", "MPa"], [1e3, 1e-3, 1.0]),
            System::GMmMs => ("g-mm-ms", ["g", "mm", "ms", "N", "MPa"], [1e-3, 1e-3, 1e-3]),
            System::KgMmMs => ("kg-mm-ms", ["kg", "mm", "ms", "kN", "GPa"], [1.0, 1e-3, 1e-3]),
            System::LbfInS => ("lbf-in-s", ["lbf s^2/in", "in", "s", "lbf", "psi"], [POUND_FORCE / INCH, INCH, 1.0]),
        }
    }

    /// Its name on the command line and in cards.
    pub fn name(self) -> &'static str {
        self.row().0
    }

    /// The system of this name.
    pub fn from_name(name: &str) -> Option<System> {
        System::ALL.into_iter().find(|system| system.name() == name)
    }

    /// Units of mass, length, time, force and stress, as words.
    pub fn words(self) -> [&'static str; 5] {
        self.row().1
    }

    /// Units of mass (kg), length (m) and time (s).
    fn base(self) -> [f64; 3] {
        self.row().2
    }

    /// One unit of length, m.
    pub fn length(self) -> f64 {
        self.base()[1]
    }

    /// One unit of time, s.
    pub fn time(self) -> f64 {
        self.base()[2]
    }

    /// One unit of density, kg/m³.
    pub fn density(self) -> f64 {
        let [mass, length, _] = self.base();
        mass / length.powi(3)
    }

    /// One unit of stress, Pa.
    pub fn stress(self) -> f64 {
        let [mass, length, time] = self.base();
        mass / (length * time * time)
    }

    /// One unit of force per width, N/m.
    pub fn resultant(self) -> f64 {
        self.stress() * self.length()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 915 kg/m³, 8.4 MPa, 12 µm: in each system by hand.
    #[test]
    fn one_film_in_all_systems() {
        for (system, density, stress, length) in [
            (System::KgMS, 915.0, 8.4e6, 12e-6),
            (System::TMmS, 915e-12, 8.4, 0.012),
            (System::GMmMs, 915e-6, 8.4, 0.012),
            (System::KgMmMs, 915e-9, 8.4e-3, 0.012),
            // 1 psi = 6894.757293168361 Pa, 1 lbf s²/in⁴ = 10686896.9 kg/m³.
            (System::LbfInS, 915.0 / 10_686_895.98, 8.4e6 / 6_894.757_293_168, 12e-6 / 0.0254),
        ] {
            let near =
                |value: f64, expected: f64| assert!((value / expected - 1.0).abs() < 1e-6, "{system:?}: {value}");
            near(915.0 / system.density(), density);
            near(8.4e6 / system.stress(), stress);
            near(12e-6 / system.length(), length);
            assert_eq!(System::from_name(system.name()), Some(system));
        }
        assert_eq!(System::from_name("mm"), None);
    }
}
