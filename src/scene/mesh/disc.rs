//! Circles: a bulged square block in the middle and rings around it, no degenerate element.

use std::f64::consts::{FRAC_PI_4, PI};

use nalgebra::{Point2, Point3};

use super::grid::{self, Grid};
use super::{Element, Grading, Mesh, MeshError, Meshing, elements_per_cell, quadtree};

/// Half the width of the central block over the radius: its elements and those at the rim then
/// differ little in size.
const BLOCK: f64 = 0.55;
/// How far the block's sides bulge towards the circle: 0 is a square, 1/2 a circle.
const BULGE: f64 = 0.25;
/// Cells along half the block's side for a radius of one element: 7/3 (2n)² cells fill the circle.
const CELLS: f64 = 0.58;

/// A circle centred on the origin, `radius` in m; the outer nodes lie on the circle.
pub(crate) fn disc(radius: f64, mirrored: [bool; 2], meshing: &Meshing) -> Result<Mesh, MeshError> {
    if let Some(grading) = &meshing.grading {
        return graded(radius, mirrored, meshing, grading);
    }
    grid::check([2.0 * radius; 2], meshing.size, count(radius, meshing))?;
    let pattern = Pattern::new(radius, meshing.size);
    Ok(pattern.whole(radius, meshing.element).mesh(mirrored, meshing.element))
}

/// Bounds of [`Pattern::half`] in a graded circle, whose block has cells of a given side.
const HALVES: [f64; 2] = [0.45, 0.68];

/// A circle whose elements are fine in some zones.
fn graded(radius: f64, mirrored: [bool; 2], meshing: &Meshing, grading: &Grading) -> Result<Mesh, MeshError> {
    grading.check([2.0 * radius; 2], PI * radius * radius, meshing.size)?;
    let fits = |cell: f64| (HALVES[0]..=HALVES[1]).contains(&Pattern::of_cells(radius, cell).half);
    let cell = quadtree::root(grading.fine, meshing.size, fits);
    let pattern = Pattern::of_cells(radius, cell);
    grid::check([2.0 * radius; 2], meshing.size, pattern.cells().saturating_mul(4))?;
    let roots = pattern.whole(radius, Element::Quad4).cut(mirrored);
    let on_rim = |point: &Point3<f64>| point.coords.norm() > radius * (1.0 - 1e-9);
    let onto_rim = |middle: &mut Point3<f64>, ends: [Point3<f64>; 2]| {
        if ends.iter().all(on_rim) {
            middle.coords *= radius / middle.coords.norm();
        }
    };
    let grid = quadtree::refine(roots, grading, meshing.size, meshing.element, &onto_rim)?;
    Ok(grid.mesh(mirrored, meshing.element))
}

/// Elements in the whole circle.
fn count(radius: f64, meshing: &Meshing) -> usize {
    Pattern::new(radius, meshing.size).cells().saturating_mul(elements_per_cell(meshing.element))
}

/// Block of `block` × `block` cells (even, so that both axes are lines of the mesh) inside `rings`
/// rings of `4 block` cells.
struct Pattern {
    block: usize,
    rings: usize,
    /// Half the width of the block over the radius.
    half: f64,
}

impl Pattern {
    fn new(radius: f64, size: f64) -> Pattern {
        let block = ((CELLS * radius / size).round().max(1.0) as usize).saturating_mul(2);
        let rings = (block as f64 / 3.0).round().max(1.0) as usize;
        Pattern { block, rings, half: BLOCK }
    }

    /// A block of square cells with sides of `cell` (m), and rings of about the same.
    fn of_cells(radius: f64, cell: f64) -> Pattern {
        let across = (BLOCK * radius / cell).round().max(1.0);
        let half = across * cell / radius;
        // The block's corners reach further out than the middles of its sides.
        let rings = ((1.0 - 1.1 * half) * radius / cell).round().max(1.0) as usize;
        Pattern { block: 2 * across as usize, rings, half }
    }

    /// Cells in the whole circle.
    fn cells(&self) -> usize {
        self.block.saturating_add(self.rings.saturating_mul(4)).saturating_mul(self.block)
    }

    fn whole(&self, radius: f64, element: Element) -> Grid {
        let mut grid = Grid::default();
        let turned = |index: usize| element == Element::Tri3 && index % 2 == 1;
        self.add_block(&mut grid, radius, turned);
        self.add_rings(&mut grid, radius, turned);
        grid
    }

    fn add_block(&self, grid: &mut Grid, radius: f64, turned: impl Fn(usize) -> bool) {
        let places = || 0..=self.block;
        grid.nodes.extend(
            places()
                .flat_map(|row| places().map(move |column| [column, row]))
                .map(|place| lift(radius * self.block_point(self.parameters(place)))),
        );
        for row in 0..self.block {
            grid.cells.extend((0..self.block).map(|column| {
                let cell = [
                    self.block_node([column, row]),
                    self.block_node([column + 1, row]),
                    self.block_node([column + 1, row + 1]),
                    self.block_node([column, row + 1]),
                ];
                grid::alternate(cell, turned(column + row))
            }));
        }
    }

    fn add_rings(&self, grid: &mut Grid, radius: f64, turned: impl Fn(usize) -> bool) {
        let perimeter = self.perimeter();
        let around = perimeter.len();
        let mut inner: Vec<u32> = perimeter.iter().map(|p| self.block_node(*p)).collect();
        for ring in 1..=self.rings {
            let share = ring as f64 / self.rings as f64;
            let first = grid.nodes.len() as u32;
            grid.nodes.extend(perimeter.iter().map(|place| {
                let [u, v] = self.parameters(*place);
                let (from, to) = (self.block_point([u, v]), circle_point([u, v]));
                lift(radius * (from * (1.0 - share) + to.coords * share))
            }));
            let outer: Vec<u32> = (first..first + around as u32).collect();
            grid.cells.extend((0..around).map(|here| {
                let next = (here + 1) % around;
                let cell = [inner[here], outer[here], outer[next], inner[next]];
                grid::alternate(cell, turned(here + ring))
            }));
            inner = outer;
        }
    }

    /// Columns and rows of the block's outer nodes, counter-clockwise from the lower right.
    fn perimeter(&self) -> Vec<[usize; 2]> {
        let n = self.block;
        let right = (0..n).map(|row| [n, row]);
        let top = (0..n).map(|back| [n - back, n]);
        let left = (0..n).map(|back| [0, n - back]);
        let bottom = (0..n).map(|column| [column, 0]);
        right.chain(top).chain(left).chain(bottom).collect()
    }

    fn block_node(&self, [column, row]: [usize; 2]) -> u32 {
        (row * (self.block + 1) + column) as u32
    }

    /// Position in the block as -1 to 1 along x and y, exactly symmetric.
    fn parameters(&self, place: [usize; 2]) -> [f64; 2] {
        let half = (self.block / 2) as f64;
        place.map(|index| (index as f64 - half) / half)
    }

    /// A point of the bulged block in the unit circle.
    fn block_point(&self, [u, v]: [f64; 2]) -> Point2<f64> {
        let bulged = |along: f64, across: f64| self.half * along * (1.0 - BULGE * across * across).sqrt();
        Point2::new(bulged(u, v), bulged(v, u))
    }
}

/// The point of the unit circle to which the rings lead from a point of the block's outline.
fn circle_point([u, v]: [f64; 2]) -> Point2<f64> {
    if u.abs() >= v.abs() {
        let (sin, cos) = (FRAC_PI_4 * v).sin_cos();
        Point2::new(cos * u.signum(), sin)
    } else {
        let (sin, cos) = (FRAC_PI_4 * u).sin_cos();
        Point2::new(sin, cos * v.signum())
    }
}

fn lift(point: Point2<f64>) -> Point3<f64> {
    Point3::new(point.x, point.y, 0.0)
}
