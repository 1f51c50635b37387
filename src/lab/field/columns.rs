//! Which columns of an export hold places, displacements and the quality of the correlation.

use crate::signal::csv::Column;

/// How a program names its columns.
pub struct Naming {
    /// The program.
    pub program: &'static str,
    /// Columns of the undeformed places.
    places: [&'static str; 3],
    /// Columns of the displacements.
    displacements: [&'static str; 3],
    /// Whether the second three are deformed places instead.
    pub deformed: bool,
}

const fn naming(program: &'static str, places: [&'static str; 3], displacements: [&'static str; 3]) -> Naming {
    Naming { program, places, displacements, deformed: false }
}

/// The namings, those of the most particular names first.
const NAMINGS: [Naming; 8] = [
    naming(
        "DICe",
        ["MODEL_COORDINATES_X", "MODEL_COORDINATES_Y", "MODEL_COORDINATES_Z"],
        ["MODEL_DISPLACEMENT_X", "MODEL_DISPLACEMENT_Y", "MODEL_DISPLACEMENT_Z"],
    ),
    naming("MatchID", ["X", "Y", "Z"], ["Horizontal Displacement U", "Vertical Displacement V", "Out-Of-Plane: W"]),
    naming(
        "MatchID",
        ["X", "Y", "Z"],
        ["Horizontal Displacement U", "Vertical Displacement V", "Out-Of-Plane Displacement W"],
    ),
    naming("ARAMIS", ["x_undef", "y_undef", "z_undef"], ["ux", "uy", "uz"]),
    naming("ARAMIS", ["x", "y", "z"], ["dx", "dy", "dz"]),
    Naming { deformed: true, ..naming("ARAMIS", ["x", "y", "z"], ["x+dx", "y+dy", "z+dz"]) },
    Naming { deformed: true, ..naming("ARAMIS", ["x_undef", "y_undef", "z_undef"], ["x_def", "y_def", "z_def"]) },
    naming("VIC-3D", ["X", "Y", "Z"], ["U", "V", "W"]),
];

/// Name of the standard deviation of the match, negative where there was none: of VIC-3D, and of DICe in capitals.
const SIGMA: &str = "sigma";

/// Columns of a file, by their places in it.
pub struct Found {
    pub naming: &'static Naming,
    pub places: [usize; 3],
    pub displacements: [usize; 3],
    pub sigma: Option<usize>,
}

/// What a file lacks.
#[derive(Debug, PartialEq)]
pub enum Lack {
    /// It has displacements in a plane alone, in columns of these labels.
    OutOfPlane([String; 2]),
    /// It has no columns of the names of any program.
    All,
}

/// The columns of a field among those of a file.
pub fn find(columns: &[Column]) -> Result<Found, Lack> {
    let three = |names: [&str; 3]| names.map(|name| place(columns, name));
    let mut planar = None;
    for naming in &NAMINGS {
        match (three(naming.places), three(naming.displacements)) {
            ([Some(x), Some(y), Some(z)], [Some(u), Some(v), Some(w)]) => {
                let sigma = place(columns, SIGMA);
                return Ok(Found { naming, places: [x, y, z], displacements: [u, v, w], sigma });
            }
            ([Some(_), Some(_), _], [Some(u), Some(v), None]) => {
                planar.get_or_insert([u, v].map(|place| columns[place].label.clone()));
            }
            _ => {}
        }
    }
    Err(planar.map_or(Lack::All, Lack::OutOfPlane))
}

/// The place of a column of this name, in these letters or else in any case: VIC-3D has `X` in space and `x` in the image.
fn place(columns: &[Column], name: &str) -> Option<usize> {
    let wanted = plain(name);
    let exact = columns.iter().position(|column| plain(&column.name) == wanted);
    let wanted = wanted.to_lowercase();
    exact.or_else(|| columns.iter().position(|column| plain(&column.name).to_lowercase() == wanted))
}

/// A name without its group (`coor.X`), blanks and signs but for a plus.
fn plain(name: &str) -> String {
    let own = name.rsplit('.').next().unwrap_or(name);
    own.chars().filter(|letter| letter.is_alphanumeric() || *letter == '+').collect()
}
