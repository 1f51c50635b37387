//! The film in one snapshot, with the arrays of its elements and nodes.

use vtkio::model::Attribute;

use super::{Grid, VtuError, numbers, scalars, vectors};
use scene::model::{Face, Model};
use scene::simulate::{Detail, Film, FilmState, Image, Outcome, Snapshot};

/// One face in a snapshot, or a mirror image of it.
struct Sheet<'a> {
    number: u32,
    image: Image,
    face: &'a Face,
    film: &'a Film,
    /// Positions in the first snapshot.
    rest: &'a [[f32; 3]],
    state: &'a FilmState,
    detail: &'a Detail,
    /// Number of its first point in the file.
    first: u64,
}

/// An element with fibres that are not broken.
#[derive(Clone, Copy)]
struct Cell<'a> {
    sheet: &'a Sheet<'a>,
    element: usize,
}

/// The film of `outcome` in a snapshot.
pub(super) fn grid(model: &Model, outcome: &Outcome, snapshot: &Snapshot) -> Result<Grid, VtuError> {
    let sheets = sheets(model, outcome, snapshot)?;
    let held = |sheet: &Sheet<'_>, element: &usize| sheet.detail.left[*element] != [0.0; 2];
    let cells: Vec<Cell<'_>> = sheets
        .iter()
        .flat_map(|sheet| {
            (0..sheet.state.failed.len()).filter(|e| held(sheet, e)).map(move |element| Cell { sheet, element })
        })
        .collect();
    Ok(Grid {
        points: points(&sheets, |sheet, node| sheet.image.reflect(sheet.state.positions[node])).collect(),
        cells: cells.iter().map(Cell::corners).collect(),
        on_points: on_points(&sheets),
        on_cells: on_cells(&cells, has_thickness(outcome)),
    })
}

fn sheets<'a>(model: &'a Model, outcome: &'a Outcome, snapshot: &'a Snapshot) -> Result<Vec<Sheet<'a>>, VtuError> {
    let mut sheets = vec![];
    let mut first = 0;
    let rest = outcome.snapshots.first().unwrap_or(snapshot);
    for (index, ((face, film), state)) in model.faces.iter().zip(&outcome.films).zip(&snapshot.films).enumerate() {
        let detail = state.detail.as_ref().ok_or(VtuError::NoDetail)?;
        for image in film.images() {
            let (number, rest) = (index as u32 + 1, &rest.films[index].positions);
            sheets.push(Sheet { number, image, face, film, rest, state, detail, first });
            first += film.nodes as u64;
        }
    }
    Ok(sheets)
}

/// Whether a law of the run gives the thickness of its film.
fn has_thickness(outcome: &Outcome) -> bool {
    let states = outcome.snapshots.iter().flat_map(|snapshot| &snapshot.films);
    states.flat_map(|state| &state.thickness_ratio).any(|thickness_ratio| thickness_ratio.is_finite())
}

fn points<'a, T>(sheets: &'a [Sheet<'a>], value: impl Fn(&Sheet<'_>, usize) -> T + 'a) -> impl Iterator<Item = T> + 'a {
    sheets.iter().flat_map(|sheet| (0..sheet.film.nodes).map(move |node| (sheet, node))).map(move |(s, n)| value(s, n))
}

fn on_points(sheets: &[Sheet<'_>]) -> Vec<Attribute> {
    let displacement = |sheet: &Sheet<'_>, node: usize| {
        let (now, then) = (sheet.state.positions[node], sheet.rest[node]);
        sheet.image.reflect([0, 1, 2].map(|axis| now[axis] - then[axis]))
    };
    let touching =
        |sheet: &Sheet<'_>, node: usize| u32::from(sheet.state.in_contact.binary_search(&(node as u32)).is_ok());
    vec![
        vectors("displacement_m", points(sheets, displacement)),
        vectors("velocity_m_s", points(sheets, |sheet, node| sheet.image.reflect(sheet.detail.velocities[node]))),
        numbers("touching", points(sheets, touching)),
    ]
}

fn on_cells(cells: &[Cell<'_>], with_thickness: bool) -> Vec<Attribute> {
    let of = |name: &str, value: &dyn Fn(&Cell<'_>) -> f32| scalars(name, cells.iter().map(value));
    let count = |name: &str, value: &dyn Fn(&Cell<'_>) -> u32| numbers(name, cells.iter().map(value));
    let mut arrays = vec![
        of("strain_md", &|cell| cell.strain()[0]),
        of("strain_td", &|cell| cell.strain()[1]),
        of("shear_angle_rad", &|cell| cell.strain()[2]),
        of("stress_md_Pa", &|cell| cell.stress()[0]),
        of("stress_td_Pa", &|cell| cell.stress()[1]),
        of("stress_shear_Pa", &|cell| cell.stress()[2]),
        of("resultant_md_N_m", &|cell| cell.stress()[0] * cell.thickness()),
        of("resultant_td_N_m", &|cell| cell.stress()[1] * cell.thickness()),
        of("resultant_shear_N_m", &|cell| cell.stress()[2] * cell.thickness()),
        of("largest_strain_md", &|cell| cell.sheet.detail.peaks[cell.element][0]),
        of("largest_strain_td", &|cell| cell.sheet.detail.peaks[cell.element][1]),
        of("layers_left_md", &|cell| cell.sheet.detail.left[cell.element][0]),
        of("layers_left_td", &|cell| cell.sheet.detail.left[cell.element][1]),
        of("reference_thickness_m", &|cell| cell.thickness()),
        of("area_ratio", &|cell| cell.area_ratio()),
        vectors("direction_md", cells.iter().map(|cell| cell.direction(0))),
        vectors("direction_td", cells.iter().map(|cell| cell.direction(1))),
        count("face", &|cell| cell.sheet.number),
        count("element", &|cell| cell.element as u32),
        count("layers", &|cell| cell.sheet.face.layers),
        count("image", &|cell| cell.sheet.image.number),
    ];
    if cells.iter().any(|cell| !cell.sheet.state.plastic_strain.is_empty()) {
        arrays.push(of("plastic_strain", &|cell| cell.plastic_strain()));
    }
    if cells.iter().any(|cell| !cell.sheet.state.damage.is_empty()) {
        arrays.push(of("damage", &|cell| cell.damage()));
    }
    if cells.iter().any(|cell| !cell.sheet.state.warming.is_empty()) {
        arrays.push(of("warming_K", &|cell| cell.warming()));
    }
    if with_thickness {
        arrays.push(of("thickness_m", &|cell| cell.thickness() * cell.thickness_ratio()));
    }
    arrays
}

impl Cell<'_> {
    /// Indices of its points in the file, in the orientation of the film itself.
    fn corners(&self) -> Vec<u64> {
        let Film { quads, tris, .. } = self.sheet.film;
        let mut corners: Vec<u64> = match quads.get(self.element) {
            Some(quad) => quad.iter().map(|n| self.sheet.first + u64::from(*n)).collect(),
            None => tris[self.element - quads.len()].iter().map(|n| self.sheet.first + u64::from(*n)).collect(),
        };
        if self.sheet.image.is_reversed() {
            corners.reverse();
        }
        corners
    }

    fn strain(&self) -> [f32; 3] {
        self.mirrored(self.sheet.state.strains[self.element])
    }

    fn stress(&self) -> [f32; 3] {
        self.mirrored(self.sheet.detail.stresses[self.element])
    }

    /// Values of a mirror image: those along MD and TD are kept, that in shear may change its sign.
    fn mirrored(&self, [md, td, shear]: [f32; 3]) -> [f32; 3] {
        [md, td, if self.sheet.image.is_reversed() { -shear } else { shear }]
    }

    /// Of all layers, stress-free, m.
    fn thickness(&self) -> f32 {
        let Face { material, layers, .. } = self.sheet.face;
        (material.thickness * f64::from(*layers)) as f32
    }

    /// NaN where its law does not give it.
    fn thickness_ratio(&self) -> f32 {
        self.sheet.state.thickness_ratio.get(self.element).copied().unwrap_or(f32::NAN)
    }

    /// NaN where its law has none.
    fn plastic_strain(&self) -> f32 {
        self.sheet.state.plastic_strain.get(self.element).copied().unwrap_or(f32::NAN)
    }

    /// NaN where film has no rupture criterion of its own.
    fn damage(&self) -> f32 {
        self.sheet.state.damage.get(self.element).copied().unwrap_or(f32::NAN)
    }

    /// K; NaN where film does not warm up.
    fn warming(&self) -> f32 {
        self.sheet.state.warming.get(self.element).copied().unwrap_or(f32::NAN)
    }

    fn area_ratio(&self) -> f32 {
        let [a, b] = self.sheet.detail.fibres[self.element].map(nalgebra::Vector3::from);
        a.cross(&b).norm()
    }

    /// Unit vector along the MD (0) or TD (1) fibres.
    fn direction(&self, fibre: usize) -> [f32; 3] {
        let image = nalgebra::Vector3::from(self.sheet.detail.fibres[self.element][fibre]);
        // Only films whose fibres lie along the axes have mirror planes.
        let md_axis = usize::from(self.sheet.face.md_angle.cos().abs() < 0.5);
        let axis = if fibre == 0 { md_axis } else { 1 - md_axis };
        self.sheet.image.of_fibre(image.normalize().into(), axis)
    }
}
