//! Rectangles in even rows and columns.

use nalgebra::Point3;

use super::grid::{self, Grid};
use super::{Element, Grading, Mesh, MeshError, Meshing, elements_per_cell, quadtree};

/// A rectangle centred on the origin, `lengths` along x and y in m.
pub(crate) fn rectangle(lengths: [f64; 2], mirrored: [bool; 2], meshing: &Meshing) -> Result<Mesh, MeshError> {
    if let Some(grading) = &meshing.grading {
        return graded(lengths, mirrored, meshing, grading);
    }
    grid::check(lengths, meshing.size, count(lengths, meshing))?;
    let cells = divisions(lengths, mirrored, meshing);
    Ok(whole(lengths, cells, meshing.element).mesh(mirrored, meshing.element))
}

/// Most that the sides of cells differ from those that hold elements of the fine size.
const MISFIT: f64 = 0.15;

/// A rectangle whose elements are fine in some zones.
fn graded(lengths: [f64; 2], mirrored: [bool; 2], meshing: &Meshing, grading: &Grading) -> Result<Mesh, MeshError> {
    grading.check(lengths, lengths[0] * lengths[1], meshing.size)?;
    let parts = |cell: f64| {
        [0, 1].map(|axis| match mirrored[axis] {
            true => 2 * nearest(0.5 * lengths[axis], cell),
            false => nearest(lengths[axis], cell),
        })
    };
    let fits = |cell: f64| {
        let misfit = |axis: usize| (lengths[axis] / (parts(cell)[axis] as f64 * cell) - 1.0).abs();
        misfit(0) <= MISFIT && misfit(1) <= MISFIT
    };
    let cell = quadtree::root(grading.fine, meshing.size, fits);
    let [columns, rows] = parts(cell);
    grid::check(lengths, meshing.size, columns.saturating_mul(rows).saturating_mul(4))?;
    let roots = whole(lengths, [columns, rows], Element::Quad4).cut(mirrored);
    let grid = quadtree::refine(roots, grading, meshing.size, meshing.element, &|_, _| {})?;
    Ok(grid.mesh(mirrored, meshing.element))
}

/// Elements in the whole rectangle.
fn count(lengths: [f64; 2], meshing: &Meshing) -> usize {
    let [columns, rows] = divisions(lengths, [false; 2], meshing);
    columns.saturating_mul(rows).saturating_mul(elements_per_cell(meshing.element))
}

/// Columns and rows of the whole rectangle.
fn divisions(lengths: [f64; 2], mirrored: [bool; 2], meshing: &Meshing) -> [usize; 2] {
    [0, 1].map(|axis| division(lengths[axis], mirrored[axis], meshing))
}

/// Number of cells along one whole side. A mirror plane needs an even one, and so do triangles
/// whose diagonals shall alternate symmetrically, unless one single cell is asked for.
fn division(length: f64, mirrored: bool, meshing: &Meshing) -> usize {
    let any = nearest(length, meshing.size);
    let even = mirrored || (meshing.element == Element::Tri3 && any > 1);
    if even { nearest(length / 2.0, meshing.size).saturating_mul(2) } else { any }
}

/// The number of equal parts of `length` whose size is nearest to `size`, at least one.
fn nearest(length: f64, size: f64) -> usize {
    let fewer = (length / size).floor().max(1.0);
    let more = fewer + 1.0;
    let miss = |parts: f64| (length / parts - size).abs();
    if miss(more) < miss(fewer) { more as usize } else { fewer as usize }
}

fn whole(lengths: [f64; 2], [columns, rows]: [usize; 2], element: Element) -> Grid {
    let mut grid = Grid::default();
    for row in 0..=rows {
        let y = coordinate(row, rows, lengths[1]);
        let x = |column| coordinate(column, columns, lengths[0]);
        grid.nodes.extend((0..=columns).map(|column| Point3::new(x(column), y, 0.0)));
    }
    let number = |column: usize, row: usize| (row * (columns + 1) + column) as u32;
    for row in 0..rows {
        grid.cells.extend((0..columns).map(|column| {
            let cell =
                [number(column, row), number(column + 1, row), number(column + 1, row + 1), number(column, row + 1)];
            grid::alternate(cell, element == Element::Tri3 && (column + row) % 2 == 1)
        }));
    }
    grid
}

/// Position of division mark `index` of `parts` on a length centred on zero: zero in the middle and
/// mirror images exactly.
fn coordinate(index: usize, parts: usize, length: f64) -> f64 {
    (2.0 * index as f64 - parts as f64) * (length / (2.0 * parts as f64))
}
