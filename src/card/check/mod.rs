//! One element of a film in another solver, beside the same element here.
//!
//! [`element`] gives the input files of a solver and the calls that run them; [`Element::compared`] reads what the solver left. The
//! element is stretched along and, in two of three tests, across, in plane stress. This module runs nothing and knows
//! no folder.

mod calculix;
mod element;
mod python;

use std::fmt;

use serde::Serialize;
use thiserror::Error;

pub use element::Mode;

use crate::{Film, Loss, Refusal, Request, System, Target, write};
use membrane::material::Law;

/// A solver that a film is checked in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Solver {
    /// CalculiX: a solid of eight nodes.
    CalculiX,
    /// FElupe: a solid of eight nodes.
    Felupe,
    /// Kratos Multiphysics: a membrane of four nodes.
    Kratos,
}

impl Solver {
    /// All of them.
    pub const ALL: [Solver; 3] = [Solver::CalculiX, Solver::Felupe, Solver::Kratos];

    /// Its name on the command line.
    pub fn key(self) -> &'static str {
        match self {
            Solver::CalculiX => "calculix",
            Solver::Felupe => "felupe",
            Solver::Kratos => "kratos",
        }
    }

    /// Its name in sentences.
    pub fn name(self) -> &'static str {
        match self {
            Solver::CalculiX => "CalculiX",
            Solver::Felupe => "FElupe",
            Solver::Kratos => "Kratos",
        }
    }

    /// The program that is called.
    pub fn program(self) -> &'static str {
        match self {
            Solver::CalculiX => "ccx",
            Solver::Felupe | Solver::Kratos => "python3",
        }
    }

    /// How it is installed.
    pub fn installation(self) -> &'static str {
        match self {
            Solver::CalculiX => {
                "install CalculiX (Debian: apt install calculix-ccx), or name its program: --program ccx_2.21"
            }
            Solver::Felupe => {
                "install it (python3 -m pip install felupe tensortrax), or name the Python that has it: --program \
                 env/bin/python"
            }
            Solver::Kratos => {
                "install it (python3 -m pip install KratosStructuralMechanicsApplication), or name the Python that has it: \
                 --program env/bin/python"
            }
        }
    }

    fn is_solid(self) -> bool {
        self != Solver::Kratos
    }
}

/// How an element is compared.
#[derive(Clone, Debug)]
pub struct Options {
    /// The tests.
    pub modes: Vec<Mode>,
    /// Stretch up to which it is pulled; as far as the law is valid and the target goes where none is given.
    pub stretch: Option<f64>,
    /// Poisson's ratio of incompressible film.
    pub poisson: f64,
    /// Most points of a curve.
    pub points: usize,
}

/// Units of the input files.
const SYSTEM: System = System::TMmS;

/// A test of the element: its mode and growing stretches.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Pull {
    pub(crate) mode: Mode,
    pub(crate) stretches: Vec<f64>,
}

impl Pull {
    fn new(law: &Law, solver: Solver, mode: Mode, stretch: Option<f64>) -> Pull {
        const STEPS: usize = 60;
        /// Of rubber and linear film, and of plastic film.
        const USUAL: [f64; 2] = [3.0, 2.0];
        let [usual, of_plastic] = USUAL;
        let wanted = stretch.unwrap_or(if matches!(law, Law::Plastic(_)) { of_plastic } else { usual });
        let most = wanted.min(element::valid_to(law, mode, solver.is_solid()));
        let stretches = (1..=STEPS).map(|step| 1.0 + (most - 1.0) * step as f64 / STEPS as f64).collect();
        Pull { mode, stretches }
    }
}

/// What a solver is given.
#[derive(Clone, Debug)]
pub struct Input {
    /// Names and texts of files in the folder in which the solver runs.
    pub files: Vec<(String, String)>,
    /// Arguments of the calls of the solver's program, each with the name of the test.
    pub calls: Vec<(&'static str, Vec<String>)>,
}

/// An element of film for a solver, and here.
#[derive(Clone, Debug)]
pub struct Element {
    /// What the solver is given.
    pub input: Input,
    /// What the card does not say of the film.
    pub losses: Vec<Loss>,
    solver: Solver,
    law: Law,
    pulls: Vec<Pull>,
}

/// An element of `film` for `solver`.
///
/// # Errors
/// [`Refusal`]: the solver cannot hold its law.
pub fn element(film: &Film<'_>, solver: Solver, options: &Options) -> Result<Element, Refusal> {
    let law = film.material.law.clone();
    let pulls: Vec<Pull> = options.modes.iter().map(|mode| Pull::new(&law, solver, *mode, options.stretch)).collect();
    let request = |target| Request { poisson: options.poisson, points: options.points, ..Request::new(target, SYSTEM) };
    let (input, losses) = match solver {
        Solver::CalculiX => {
            let card = write(film, &request(Target::CalculiX))?;
            (calculix::input(&card.text, &pulls), card.losses)
        }
        Solver::Felupe => {
            let mut losses = Vec::new();
            let input = python::felupe(film, options.poisson, SYSTEM, &pulls, &mut losses)?;
            (input, losses)
        }
        Solver::Kratos => {
            let card = write(film, &request(Target::Kratos))?;
            (python::kratos(&card.text, &pulls), card.losses)
        }
    };
    Ok(Element { input, losses, solver, law, pulls })
}

/// Why there is nothing to compare.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum NoResult {
    /// A file is missing or not what the solver writes.
    #[error("{name}: {what}")]
    File {
        /// Of the file.
        name: String,
        /// What is wrong with it.
        what: String,
    },
    /// It stopped before the last stretch.
    #[error("{} tension: the solver found {found} of {expected} states", mode.key())]
    Stopped {
        /// The test.
        mode: Mode,
        /// States.
        found: usize,
        /// States.
        expected: usize,
    },
}

impl Element {
    /// The names of the files that the solver leaves.
    pub fn results(&self) -> Vec<String> {
        match self.solver {
            Solver::CalculiX => self.pulls.iter().map(|pull| calculix::result(pull.mode)).collect(),
            Solver::Felupe | Solver::Kratos => vec![python::RESULT.to_owned()],
        }
    }

    /// The element of the solver beside that of droptower; `text` gives the text of a file of [`Element::results`].
    ///
    /// # Errors
    /// [`NoResult`]: the solver stopped, or left something else.
    pub fn compared(&self, text: impl Fn(&str) -> Result<String, String>) -> Result<Vec<Comparison>, NoResult> {
        let read = |name: &str| text(name).map_err(|what| NoResult::File { name: name.to_owned(), what });
        let compare = |pull: &Pull| {
            let theirs = match self.solver {
                Solver::CalculiX => {
                    let name = calculix::result(pull.mode);
                    calculix::read(&read(&name)?).map_err(|what| NoResult::File { name, what })?
                }
                Solver::Felupe | Solver::Kratos => {
                    let name = python::RESULT;
                    python::read(&read(name)?, pull.mode).map_err(|what| NoResult::File { name: name.into(), what })?
                }
            };
            let (mode, expected, found) = (pull.mode, pull.stretches.len(), theirs.len());
            if found != expected {
                return Err(NoResult::Stopped { mode, found, expected });
            }
            let ours = element::stresses(&self.law, mode, &pull.stretches);
            let theirs = theirs.into_iter().map(|row| row.map(|stress| stress * SYSTEM.stress())).collect();
            Ok(Comparison { mode, stretches: pull.stretches.clone(), ours, theirs })
        };
        self.pulls.iter().map(compare).collect()
    }
}

/// One test in both.
#[derive(Clone, Debug, PartialEq)]
pub struct Comparison {
    /// How the element is stretched.
    pub mode: Mode,
    /// Along.
    pub stretches: Vec<f64>,
    /// Nominal stresses along and across here, Pa.
    pub ours: Vec<[f64; 2]>,
    /// The same in the other solver.
    pub theirs: Vec<[f64; 2]>,
}

/// Largest difference of a test.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Difference {
    /// Over the larger of the stresses along and across here.
    pub share: f64,
    /// Where.
    pub stretch: f64,
}

impl fmt::Display for Difference {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:.3} % at the stretch {:.3}", 100.0 * self.share, self.stretch)
    }
}

impl Comparison {
    /// The largest difference, over the stress here at the same stretch; below a hundredth of the largest stress, over that
    /// hundredth. One that is not a number is infinite.
    pub fn difference(&self) -> Difference {
        let size = |row: &[f64; 2]| row[0].abs().max(row[1].abs());
        let least = 0.01 * self.ours.iter().map(size).fold(f64::MIN_POSITIVE, f64::max);
        let shares = self.ours.iter().zip(&self.theirs).map(|(ours, theirs)| {
            let off = (ours[0] - theirs[0]).abs().max((ours[1] - theirs[1]).abs());
            let share = off / size(ours).max(least);
            if ours.iter().chain(theirs).all(|stress| stress.is_finite()) { share } else { f64::INFINITY }
        });
        let worst = shares.zip(&self.stretches).max_by(|one, other| one.0.total_cmp(&other.0));
        let (share, stretch) = worst.map_or((f64::INFINITY, f64::NAN), |(share, stretch)| (share, *stretch));
        Difference { share, stretch }
    }
}
