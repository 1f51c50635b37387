//! The snapshots of a run for ParaView 5.12 and later, all of them in one file a part: `film.vtkhdf`, `impactor.vtkhdf` and, of
//! a frame with bars, `frame.vtkhdf`, of one with springs, `springs.vtkhdf`, in VTKHDF 2.2 (Kitware, *VTK File Formats*) as unstructured grids over time.
//!
//! The arrays are those of the [series](super::vtu). What does not change from one state to the next, such as the mesh
//! until an element fails, is written once.

use hdf5_pure::{AttrValue, DatasetBuilder, FileBuilder, GroupBuilder};
use rayon::prelude::*;
use vtkio::model::{Attribute, DataArray, ElementType, IOBuffer};

use super::vtu::{File, Grid, Part, VtuError, parts};
use scene::model::Model;
use scene::simulate::{Outcome, Snapshot};

/// Level of compression, 0 to 9: higher levels make files hardly smaller.
const COMPRESSION: u32 = 5;

/// Values of a chunk, the least that is read and compressed at once.
const CHUNK: usize = 1 << 16;

/// Major and minor number of the format.
const VERSION: [i64; 2] = [2, 2];

/// Kinds of cells in VTK.
const LINE: u8 = 3;
const TRIANGLE: u8 = 5;
const QUAD: u8 = 9;

/// A file for each part, made by as many threads as there are.
///
/// # Errors
/// Of each file: snapshots without their [`Detail`](scene::simulate::Detail), and what the format refuses.
pub fn files<'a>(model: &'a Model, outcome: &'a Outcome) -> impl ParallelIterator<Item = Result<File, VtuError>> + 'a {
    parts(model, outcome).into_par_iter().map(|part| {
        let content = States::from_snapshots(&part, &outcome.snapshots)?.written()?;
        Ok(File { name: format!("{}.vtkhdf", part.name), content })
    })
}

/// The states of a part, as the format stores them: one behind the other.
#[derive(Default)]
struct States {
    times: Vec<f64>,
    points: Array,
    meshes: Meshes,
    on_points: Vec<(String, Array)>,
    on_cells: Vec<(String, Array)>,
}

impl States {
    fn from_snapshots(part: &Part<'_>, snapshots: &[Snapshot]) -> Result<States, VtuError> {
        let mut states = States::default();
        for snapshot in snapshots {
            let grid = part.grid(snapshot)?;
            states.push(snapshot.time, &grid);
        }
        Ok(states)
    }

    fn push(&mut self, time: f64, grid: &Grid) {
        self.times.push(time);
        self.points.push(3, &IOBuffer::F32(grid.points.concat()));
        self.meshes.push(grid.points.len(), &grid.cells);
        let earlier = self.times.len() - 1;
        push_all(&mut self.on_points, &grid.on_points, earlier);
        push_all(&mut self.on_cells, &grid.on_cells, earlier);
    }

    /// The file. Each array is dropped once the builder has a copy of it, so that they are not held twice.
    fn written(self) -> Result<Vec<u8>, VtuError> {
        let mut file = FileBuilder::new();
        let mut root = file.create_group("VTKHDF");
        root.set_attr("Version", AttrValue::I64Array(VERSION.to_vec()));
        // VTK takes a string of fixed length only.
        root.set_attr("Type", AttrValue::AsciiString("UnstructuredGrid".into()));
        let point_offsets = self.points.write(root.create_dataset("Points"));
        self.meshes.write(&mut root);
        let mut steps = root.create_group("Steps");
        steps.set_attr("NSteps", AttrValue::I64(self.times.len() as i64));
        steps.create_dataset("Values").with_f64_data(&self.times);
        steps.create_dataset("NumberOfParts").with_i64_data(&vec![1; self.times.len()]);
        steps.create_dataset("PointOffsets").with_i64_data(&point_offsets);
        self.meshes.write_steps(&mut steps);
        for (name, arrays) in [("PointData", self.on_points), ("CellData", self.on_cells)] {
            let mut data = root.create_group(name);
            let mut offsets = steps.create_group(&format!("{name}Offsets"));
            for (name, array) in arrays {
                let firsts = array.write(data.create_dataset(&name));
                offsets.create_dataset(&name).with_i64_data(&firsts);
            }
            root.add_group(data.finish());
            steps.add_group(offsets.finish());
        }
        root.add_group(steps.finish());
        file.add_group(root.finish());
        Ok(file.finish()?)
    }
}

/// Adds the arrays of the next state, which `earlier` others precede. Where no cell is left, arrays may be missing.
fn push_all(arrays: &mut Vec<(String, Array)>, state: &[Attribute], earlier: usize) {
    for attribute in state {
        let Attribute::DataArray(DataArray { name, elem, data }) = attribute else { continue };
        let components = if matches!(elem, ElementType::Vectors) { 3 } else { 1 };
        let place = arrays.iter().position(|(known, _)| known == name).unwrap_or_else(|| {
            arrays.push((name.clone(), Array { offsets: vec![0; earlier], ..Array::default() }));
            arrays.len() - 1
        });
        arrays[place].1.push(components, data);
    }
    for (_, array) in arrays.iter_mut().filter(|(_, array)| array.offsets.len() == earlier) {
        array.offsets.push(array.offsets.last().copied().unwrap_or_default());
    }
}

/// The values of an array in all states, those of equal consecutive states once.
#[derive(Default)]
struct Array {
    components: usize,
    values: Values,
    /// First row of each state.
    offsets: Vec<i64>,
    /// First value of the latest state.
    latest: usize,
}

enum Values {
    Floats(Vec<f32>),
    Counts(Vec<u32>),
}

impl Default for Values {
    fn default() -> Values {
        Values::Floats(vec![])
    }
}

impl Array {
    fn push(&mut self, components: usize, state: &IOBuffer) {
        if self.components == 0 {
            self.components = components;
            if matches!(state, IOBuffer::U32(_)) {
                self.values = Values::Counts(vec![]);
            }
        }
        self.latest = match (&mut self.values, state) {
            (Values::Floats(values), IOBuffer::F32(state)) => appended(values, state, self.latest, f32::to_bits),
            (Values::Counts(values), IOBuffer::U32(state)) => appended(values, state, self.latest, |count| count),
            _ => unreachable!("an array is of one kind in all states"),
        };
        self.offsets.push((self.latest / components) as i64);
    }

    /// Puts the values into a data set; the first row of each state.
    fn write(self, dataset: &mut DatasetBuilder) -> Vec<i64> {
        let length = match &self.values {
            Values::Floats(values) => {
                dataset.with_f32_data(values);
                values.len()
            }
            Values::Counts(values) => {
                dataset.with_u32_data(values);
                values.len()
            }
        };
        let components = self.components.max(1);
        let rows = length / components;
        let shape = |rows: usize| match components {
            1 => vec![rows as u64],
            _ => vec![rows as u64, components as u64],
        };
        dataset.with_shape(&shape(rows));
        // HDF5 refuses a chunk longer than a data set of fixed size.
        compress(dataset, rows, &shape(rows.min(CHUNK)));
        self.offsets
    }
}

/// Appends the values of a state unless they are those from `latest` on, bit by bit; the place of the first.
fn appended<T: Copy>(values: &mut Vec<T>, state: &[T], latest: usize, bits: impl Fn(T) -> u32) -> usize {
    let before = &values[latest..];
    // By bits, since a value that is not a number equals nothing.
    if before.len() == state.len() && before.iter().zip(state).all(|(a, b)| bits(*a) == bits(*b)) {
        return latest;
    }
    let first = values.len();
    values.extend_from_slice(state);
    first
}

/// The cells of all states, those of equal consecutive states once.
#[derive(Default)]
struct Meshes {
    points: Vec<i64>,
    cells: Vec<i64>,
    corners: Vec<i64>,
    connectivity: Vec<i64>,
    /// Of each mesh the end of every cell in its connectivity, after a zero.
    ends: Vec<i64>,
    types: Vec<u8>,
    /// Number of the mesh of each state, of its first cell and its first corner.
    of_state: Vec<[i64; 3]>,
    latest: Option<(usize, Vec<Vec<u64>>)>,
}

impl Meshes {
    fn push(&mut self, points: usize, cells: &[Vec<u64>]) {
        if let Some((known, latest)) = &self.latest
            && let Some(state) = self.of_state.last()
            && *known == points
            && latest == cells
        {
            self.of_state.push(*state);
            return;
        }
        self.of_state.push([self.points.len(), self.types.len(), self.connectivity.len()].map(|first| first as i64));
        let first = self.connectivity.len();
        self.ends.push(0);
        for corners in cells {
            self.connectivity.extend(corners.iter().map(|corner| *corner as i64));
            self.ends.push((self.connectivity.len() - first) as i64);
            self.types.push(match corners.len() {
                2 => LINE,
                3 => TRIANGLE,
                _ => QUAD,
            });
        }
        self.points.push(points as i64);
        self.cells.push(cells.len() as i64);
        self.corners.push((self.connectivity.len() - first) as i64);
        self.latest = Some((points, cells.to_vec()));
    }

    fn write(&self, root: &mut GroupBuilder) {
        for (name, numbers) in [
            ("NumberOfPoints", &self.points),
            ("NumberOfCells", &self.cells),
            ("NumberOfConnectivityIds", &self.corners),
            ("Connectivity", &self.connectivity),
            ("Offsets", &self.ends),
        ] {
            let dataset = root.create_dataset(name);
            dataset.with_i64_data(numbers);
            compress(dataset, numbers.len(), &[numbers.len().min(CHUNK) as u64]);
        }
        let types = root.create_dataset("Types");
        types.with_u8_data(&self.types);
        compress(types, self.types.len(), &[self.types.len().min(CHUNK) as u64]);
    }

    fn write_steps(&self, steps: &mut GroupBuilder) {
        let states = self.of_state.len() as u64;
        let column = |place: usize| self.of_state.iter().map(|state| state[place]).collect::<Vec<i64>>();
        steps.create_dataset("PartOffsets").with_i64_data(&column(0));
        // One topology, so one column.
        steps.create_dataset("CellOffsets").with_i64_data(&column(1)).with_shape(&[states, 1]);
        steps.create_dataset("ConnectivityIdOffsets").with_i64_data(&column(2)).with_shape(&[states, 1]);
    }
}

/// Compresses a data set of `rows` by chunks; an empty one has none.
fn compress(dataset: &mut DatasetBuilder, rows: usize, chunk: &[u64]) {
    if rows > 0 {
        // Shuffled, the high bytes of neighbouring values stand together and compress better.
        dataset.with_chunks(chunk).with_shuffle().with_deflate(COMPRESSION);
    }
}
