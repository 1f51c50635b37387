//! The snapshots of a run for ParaView: the series `film.pvd`, `impactor.pvd` and, of a frame with bars, `frame.pvd`,
//! of one with springs, `springs.pvd`, one file a snapshot.
//!
//! The film is complete with the mirror images of a part that was computed; failed elements are left out. Arrays on
//! cells
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

mod film;
mod springs;

use quick_xml::Writer;
use rayon::prelude::*;
use thiserror::Error;
use vtkio::model::{
    Attribute, Attributes, ByteOrder, CellType, Cells, DataArray, DataSet, ElementType, IOBuffer, Piece,
    UnstructuredGridPiece, Version, VertexNumbers, Vtk,
};
use vtkio::xml::Compressor;

use scene::model::Model;
use scene::simulate::{Outcome, Snapshot};
use study::store::run_files::SNAPSHOTS;

/// Sides of a round impactor.
const SIDES: u32 = 64;

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

/// Vertices of an impactor about its centre of mass, m, and the indices of its triangles.
type Triangulation = (Vec<nalgebra::Point3<f64>>, Vec<[u32; 3]>);

/// Points and cells with their arrays.
struct Grid {
    pub points: Vec<[f32; 3]>,
    /// Ends of lines, and corners of triangles and quadrilaterals.
    pub cells: Vec<Vec<u64>>,
    pub on_points: Vec<Attribute>,
    pub on_cells: Vec<Attribute>,
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
    let film = Part { name: "film", grid: Box::new(move |snapshot| film::grid(model, outcome, snapshot)) };
    let has_springs = outcome.films.iter().any(|film| !film.springs.is_empty());
    let springs =
        has_springs.then(|| Part { name: "springs", grid: Box::new(|snapshot| springs::grid(outcome, snapshot)) });
    let surfaces: Vec<Triangulation> = outcome.impactors.iter().map(|surface| surface.triangles(SIDES)).collect();
    // The bars come after the impactors.
    let mut impactors = surfaces;
    let frame = impactors.split_off(model.impactors.len().min(impactors.len()));
    let first_of_frame = impactors.len();
    let bodies = |name, surfaces: Vec<Triangulation>, first: usize| {
        let is_empty = surfaces.is_empty();
        let grid = move |snapshot: &Snapshot| Ok(posed(&surfaces, snapshot.impactors.get(first..).unwrap_or_default()));
        (!is_empty).then(|| Part { name, grid: Box::new(grid) })
    };
    let bodies = [bodies("impactor", impactors, 0), bodies("frame", frame, first_of_frame)];
    std::iter::once(film).chain(springs).chain(bodies.into_iter().flatten()).collect()
}

/// All files of a run, in their order, made by as many threads as there are.
///
/// # Errors
/// Of each file: snapshots without their [`Detail`](scene::simulate::Detail), and what the formats refuse.
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

/// Bodies at their poses (position in m, unit quaternion i, j, k, w); of several, each cell has the number of its body,
/// from 1.
fn posed(surfaces: &[Triangulation], poses: &[([f64; 3], [f64; 4])]) -> Grid {
    let mut grid = Grid { points: vec![], cells: vec![], on_points: vec![], on_cells: vec![] };
    let mut of_cells = vec![];
    for (number, ((points, triangles), (position, [i, j, k, w]))) in surfaces.iter().zip(poses).enumerate() {
        let turn = nalgebra::UnitQuaternion::from_quaternion(nalgebra::Quaternion::new(*w, *i, *j, *k));
        let pose = nalgebra::Isometry3::from_parts(nalgebra::Translation3::from(*position), turn);
        let first = grid.points.len() as u64;
        grid.points.extend(points.iter().map(|p| <[f64; 3]>::from((pose * p).coords).map(|c| c as f32)));
        grid.cells.extend(triangles.iter().map(|corners| corners.map(|corner| first + u64::from(corner)).to_vec()));
        of_cells.extend(triangles.iter().map(|_| number as u32 + 1));
    }
    if surfaces.len() > 1 {
        grid.on_cells.push(numbers("impactor", of_cells.into_iter()));
    }
    grid
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
