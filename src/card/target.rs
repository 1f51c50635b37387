//! The solvers that cards are written for.

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
}
