//! The snapshots of a run for ParaView: the series `film.pvd`, `impactor.pvd` and, of a frame with bars, `frame.pvd`,
//! of one with springs, `springs.pvd`, one file a snapshot.
//!
//! The film is complete with the mirror images of a part that was computed; elements whose fibres are all broken are left
//! out. Arrays on cells
//!
//! | array | what it is |
//! |---|---|
//! | `strain_md`, `strain_td`, `shear_angle_rad` | engineering strain of the fibres, shear angle between them |
//! | `stress_md_Pa`, `stress_td_Pa`, `stress_shear_Pa` | nominal stresses of one layer, conjugate to those strains |
//! | `resultant_md_N_m`, `resultant_td_N_m`, `resultant_shear_N_m` | forces of all layers per stress-free width |
//! | `largest_strain_md`, `largest_strain_td` | largest strains so far; a fibre below its own is unloading |
//! | `reference_thickness_m` | of all layers, stress-free |
//! | `thickness_m` | present thickness of all layers; only of laws in plane stress, which give it (a fabric's do not) |
//! | `area_ratio` | area over that of stress-free film, without wrinkles; of incompressible film 1 / thickness ratio |
//! | `direction_md`, `direction_td` | unit vectors along the fibres |
//! | `face`, `element`, `layers`, `image` | from 1; from 0 within the face; number; 0 computed, others mirror images |
//!
//! and on points `displacement_m` (from the first snapshot), `velocity_m_s` and `touching` (1 at nodes in contact).
//!
//! Springs are lines from the frame to the film, with its mirror images, in files of their own: no array of elements is
//! that of a spring, and in ParaView a part of its own has its own colours and its own width of lines. Arrays on cells
//!
//! | array | what it is |
//! |---|---|
//! | `elongation_m`, `force_N` | of one spring; force is positive in tension |
//! | `face`, `spring`, `image` | from 1; from 0 within the face; 0 computed, others mirror images |
//!
//! and on points `displacement_m` and `velocity_m_s`, which are zero on the frame.

use std::sync::Arc;

use nalgebra::Isometry3;
use quick_xml::Writer;
use rayon::prelude::*;
use thiserror::Error;
use vtkio::model::{
    Attribute, Attributes, ByteOrder, CellType, Cells, DataArray, DataSet, ElementType, IOBuffer, Piece,
    UnstructuredGridPiece, Version, VertexNumbers, Vtk,
};
use vtkio::xml::Compressor;

use crate::geometry::{SceneBody, SceneFace, corners, poses};
use scene::model::{Face, Model};
use scene::simulate::{Detail, FilmSpring, FilmState, Image, Outcome, Snapshot, SpringDetail};
use study::store::run_files::SNAPSHOTS;

/// Level of compression, 0 to 9: higher levels make files hardly smaller.
const COMPRESSION: u32 = 5;

/// Why a run cannot be written for ParaView.
#[derive(Debug, Error)]
pub enum VtuError {
    /// A data set is inconsistent.
    #[error("VTU: {0}")]
    Vtk(#[from] vtkio::Error),
    /// A data set cannot be written as XML.
    #[error("VTU: {0}")]
    Xml(#[from] vtkio::xml::Error),
    /// A collection cannot be written as XML.
    #[error("PVD: {0}")]
    Collection(#[from] quick_xml::Error),
    /// The snapshots lack their detail.
    #[error("the snapshots have no stresses: the run was made without detail")]
    NoDetail,
}

/// One file of a series.
#[derive(Clone, Debug)]
pub struct File {
    /// Path in the run folder, with `/`.
    pub name: String,
    /// Its content.
    pub content: Vec<u8>,
}

/// Points and cells with their arrays.
struct Grid {
    points: Vec<[f32; 3]>,
    /// Ends of lines, and corners of triangles and quadrilaterals.
    cells: Vec<Vec<u64>>,
    on_points: Vec<Attribute>,
    on_cells: Vec<Attribute>,
}

/// Points and cells in a snapshot.
type OfSnapshot<'a> = dyn Fn(&Snapshot) -> Result<Grid, VtuError> + Send + Sync + 'a;

/// A part of the scene with files of its own: the film, the springs on which it hangs, the impactors or the bars of a
/// frame.
struct Part<'a> {
    /// `film`, `springs`, `impactor`, `frame`.
    name: &'static str,
    grid: Box<OfSnapshot<'a>>,
}

/// The parts of a run that are written.
fn parts<'a>(model: &'a Model, outcome: &'a Outcome) -> Vec<Part<'a>> {
    let faces: Arc<[SceneFace]> = outcome.films.iter().map(SceneFace::from).collect();
    let has_springs = faces.iter().any(|face| !face.springs.is_empty());
    let of_springs = faces.clone();
    let film = Part { name: "film", grid: Box::new(move |snapshot| film_grid(model, outcome, &faces, snapshot)) };
    let springs = Box::new(move |snapshot: &Snapshot| springs_grid(model, outcome, &of_springs, snapshot));
    let springs = has_springs.then(|| Part { name: "springs", grid: springs });
    // The bars come after the impactors.
    let mut impactors = SceneBody::all(&outcome.impactors);
    let frame = impactors.split_off(model.impactors.len().min(impactors.len()));
    let first_of_frame = impactors.len();
    let bodies = |name, bodies: Vec<SceneBody>, first: usize| {
        let is_empty = bodies.is_empty();
        let grid = move |snapshot: &Snapshot| Ok(posed(&bodies, poses(snapshot).skip(first)));
        (!is_empty).then(|| Part { name, grid: Box::new(grid) })
    };
    let bodies = [bodies("impactor", impactors, 0), bodies("frame", frame, first_of_frame)];
    std::iter::once(film).chain(springs).chain(bodies.into_iter().flatten()).collect()
}

/// All files of a run, in their order, made by as many threads as there are.
///
/// # Errors
/// Of each file: snapshots without their [`Detail`], and what the formats refuse.
pub fn files<'a>(model: &'a Model, outcome: &'a Outcome) -> impl ParallelIterator<Item = Result<File, VtuError>> + 'a {
    parts(model, outcome).into_par_iter().flat_map(|part| series(part, &outcome.snapshots))
}

/// A file for each snapshot, then the collection with their times.
fn series<'a>(part: Part<'a>, snapshots: &'a [Snapshot]) -> impl ParallelIterator<Item = Result<File, VtuError>> + 'a {
    let name = part.name;
    let place = move |state: usize| format!("{SNAPSHOTS}/{name}_{state:04}.vtu");
    let state = move |(number, snapshot): (usize, &Snapshot)| {
        Ok(File { name: place(number), content: (part.grid)(snapshot).and_then(unstructured)? })
    };
    let collected = move |()| {
        let times = snapshots.iter().enumerate().map(|(number, snapshot)| (place(number), snapshot.time));
        Ok(File { name: format!("{name}.pvd"), content: collection(times)? })
    };
    snapshots.par_iter().enumerate().map(state).chain(rayon::iter::once(()).map(collected))
}

/// A state in which no element is left: vtkio would write it without their number, and VTK reports an error then.
const NOTHING_LEFT: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<VTKFile type="UnstructuredGrid" version="1.0" byte_order="LittleEndian">
  <UnstructuredGrid>
    <Piece NumberOfPoints="0" NumberOfCells="0"/>
  </UnstructuredGrid>
</VTKFile>
"#;

fn unstructured(grid: Grid) -> Result<Vec<u8>, VtuError> {
    if grid.cells.is_empty() {
        return Ok(NOTHING_LEFT.into());
    }
    let kind = |corners: &Vec<u64>| match corners.len() {
        2 => CellType::Line,
        3 => CellType::Triangle,
        _ => CellType::Quad,
    };
    let ends = grid.cells.iter().scan(0, |end, corners| {
        *end += corners.len() as u64;
        Some(*end)
    });
    let cells = Cells {
        cell_verts: VertexNumbers::XML { offsets: ends.collect(), connectivity: grid.cells.concat() },
        types: grid.cells.iter().map(kind).collect(),
    };
    let data = Attributes { point: grid.on_points, cell: grid.on_cells };
    let piece = UnstructuredGridPiece { points: IOBuffer::F32(grid.points.concat()), cells, data };
    let vtk = Vtk {
        version: Version::new_xml(1, 0),
        title: String::new(),
        byte_order: ByteOrder::LittleEndian,
        data: DataSet::UnstructuredGrid { meta: None, pieces: vec![Piece::Inline(Box::new(piece))] },
        file_path: None,
    };
    let mut out = Vec::new();
    vtk.try_into_xml_format(Compressor::ZLib, COMPRESSION)?.write(&mut out)?;
    Ok(out)
}

/// `.pvd`: which file is at which time (s).
fn collection(states: impl Iterator<Item = (String, f64)>) -> Result<Vec<u8>, quick_xml::Error> {
    let mut writer = Writer::new_with_indent(Vec::new(), b' ', 2);
    let file = writer.create_element("VTKFile");
    let file = file.with_attributes([("type", "Collection"), ("version", "0.1"), ("byte_order", "LittleEndian")]);
    file.write_inner_content(|writer| {
        writer.create_element("Collection").write_inner_content(|writer| {
            for (name, time) in states {
                let state = writer.create_element("DataSet").with_attribute(("timestep", time.to_string().as_str()));
                state.with_attribute(("part", "0")).with_attribute(("file", name.as_str())).write_empty()?;
            }
            Ok::<_, quick_xml::Error>(())
        })?;
        Ok::<_, quick_xml::Error>(())
    })?;
    Ok(writer.into_inner())
}

/// Bodies at their poses; of several, each cell has the number of its body, from 1.
fn posed(bodies: &[SceneBody], poses: impl Iterator<Item = Isometry3<f64>>) -> Grid {
    let mut grid = Grid { points: vec![], cells: vec![], on_points: vec![], on_cells: vec![] };
    let mut of_cells = vec![];
    for ((number, body), pose) in (1..).zip(bodies).zip(poses) {
        let first = grid.points.len() as u64;
        grid.points.extend(body.placed(pose).map(|place| <[f32; 3]>::from(place.map(|c| c as f32))));
        grid.cells.extend(body.patches.iter().map(|patch| cell(patch, first)));
        of_cells.extend(body.patches.iter().map(|_| number));
    }
    if bodies.len() > 1 {
        grid.on_cells.push(numbers("impactor", of_cells.into_iter()));
    }
    grid
}

/// The corners of a patch whose points begin at this number of the file.
fn cell(patch: &[u32; 4], first: u64) -> Vec<u64> {
    corners(patch).iter().map(|node| first + u64::from(*node)).collect()
}

/// One number for each point or cell.
fn scalars(name: &str, values: impl Iterator<Item = f32>) -> Attribute {
    array(name, ElementType::Scalars { num_comp: 1, lookup_table: None }, IOBuffer::F32(values.collect()))
}

/// One integer for each point or cell.
fn numbers(name: &str, values: impl Iterator<Item = u32>) -> Attribute {
    array(name, ElementType::Scalars { num_comp: 1, lookup_table: None }, IOBuffer::U32(values.collect()))
}

/// One vector for each point or cell.
fn vectors(name: &str, values: impl Iterator<Item = [f32; 3]>) -> Attribute {
    array(name, ElementType::Vectors, IOBuffer::F32(values.flatten().collect()))
}

fn array(name: &str, elem: ElementType, data: IOBuffer) -> Attribute {
    Attribute::DataArray(DataArray { name: name.into(), elem, data })
}

/// One face in a snapshot, or a mirror image of it.
struct Sheet<'a> {
    number: u32,
    image: Image,
    face: &'a Face,
    shape: &'a SceneFace,
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

/// The film of `outcome` in a snapshot. An element is left out when both its fibres are broken; others show which.
fn film_grid(model: &Model, outcome: &Outcome, faces: &[SceneFace], snapshot: &Snapshot) -> Result<Grid, VtuError> {
    let sheets = sheets(model, outcome, faces, snapshot)?;
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

fn sheets<'a>(
    model: &'a Model,
    outcome: &'a Outcome,
    faces: &'a [SceneFace],
    snapshot: &'a Snapshot,
) -> Result<Vec<Sheet<'a>>, VtuError> {
    let mut sheets = vec![];
    let mut first = 0;
    let rest = outcome.snapshots.first().unwrap_or(snapshot);
    for (index, ((face, shape), state)) in model.faces.iter().zip(faces).zip(&snapshot.films).enumerate() {
        let detail = state.detail.as_ref().ok_or(VtuError::NoDetail)?;
        for image in shape.images() {
            let (number, rest) = (index as u32 + 1, &rest.films[index].positions);
            sheets.push(Sheet { number, image, face, shape, rest, state, detail, first });
            first += shape.nodes as u64;
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
    sheets.iter().flat_map(|sheet| (0..sheet.shape.nodes).map(move |node| (sheet, node))).map(move |(s, n)| value(s, n))
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

/// Numbers of each element that film has where its law or its surroundings give them.
type Given = fn(&FilmState) -> &[f32];

/// Arrays on cells that are written where a face has them.
const GIVEN: [(&str, Given); 3] = [
    ("plastic_strain", |film| &film.plastic_strain),
    ("damage", |film| &film.damage),
    ("warming_K", |film| &film.warming),
];

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
    for (name, given) in GIVEN {
        if cells.iter().any(|cell| !given(cell.sheet.state).is_empty()) {
            arrays.push(of(name, &|cell| cell.given(given)));
        }
    }
    if with_thickness {
        arrays.push(of("thickness_m", &|cell| cell.thickness() * cell.given(|film| &film.thickness_ratio)));
    }
    arrays
}

impl Cell<'_> {
    /// Indices of its points in the file, in the orientation of the film itself.
    fn corners(&self) -> Vec<u64> {
        let mut corners = cell(&self.sheet.shape.patches[self.element], self.sheet.first);
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

    /// A number that not all film has; NaN where there is none.
    fn given(&self, given: Given) -> f32 {
        given(self.sheet.state).get(self.element).copied().unwrap_or(f32::NAN)
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

/// A spring in a snapshot, or a mirror image of it.
struct Line<'a> {
    sheet: &'a Sheet<'a>,
    /// Its own number within the face.
    number: u32,
    spring: &'a FilmSpring,
    load: &'a SpringDetail,
}

impl Line<'_> {
    /// Its end on the film now and in the first snapshot, m, and the velocity of that end, m/s, whose weights are the same.
    fn on_film(&self) -> [[f32; 3]; 3] {
        let Sheet { state, rest, detail, .. } = self.sheet;
        [&state.positions[..], rest, &detail.velocities].map(|of_nodes| self.spring.end(of_nodes))
    }
}

/// The springs of `outcome` in a snapshot.
fn springs_grid(model: &Model, outcome: &Outcome, faces: &[SceneFace], snapshot: &Snapshot) -> Result<Grid, VtuError> {
    let sheets = sheets(model, outcome, faces, snapshot)?;
    let springs = sheets.iter().flat_map(|sheet| {
        let own = (0..).zip(sheet.shape.springs.iter().zip(&sheet.detail.springs));
        own.map(move |(number, (spring, load))| Line { sheet, number, spring, load })
    });
    let lines: Vec<Line<'_>> = springs.collect();
    // From the frame, which stands still, to the film.
    let ends = |of: &dyn Fn(&Line<'_>) -> [[f32; 3]; 2]| {
        lines.iter().flat_map(|line| of(line).map(|end| line.sheet.image.reflect(end))).collect::<Vec<_>>()
    };
    let displacement = |line: &Line<'_>| {
        let [now, then, _] = line.on_film();
        [[0.0; 3], [0, 1, 2].map(|axis| now[axis] - then[axis])]
    };
    Ok(Grid {
        points: ends(&|line| [line.spring.anchor, line.on_film()[0]]),
        cells: (0..lines.len() as u64).map(|line| vec![2 * line, 2 * line + 1]).collect(),
        on_points: vec![
            vectors("displacement_m", ends(&displacement).into_iter()),
            vectors("velocity_m_s", ends(&|line| [[0.0; 3], line.on_film()[2]]).into_iter()),
        ],
        on_cells: vec![
            scalars("elongation_m", lines.iter().map(|line| line.load.elongation)),
            scalars("force_N", lines.iter().map(|line| line.load.force)),
            numbers("face", lines.iter().map(|line| line.sheet.number)),
            numbers("spring", lines.iter().map(|line| line.number)),
            numbers("image", lines.iter().map(|line| line.sheet.image.number)),
        ],
    })
}
