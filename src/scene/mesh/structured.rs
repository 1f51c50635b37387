//! Rectangles in even rows and columns; circles of a bulged square block in the middle and rings around it, no degenerate
//! element; better shapes for the elements of a plane mesh whose connectivity stays.

use std::f64::consts::{FRAC_PI_4, PI};

use nalgebra::{Point2, Point3};

use super::quadtree::{self, Grid};
use super::{Element, Grading, Mesh, MeshError, Meshing, directed, elements_per_cell, scaled_jacobian, undirected};

/// A rectangle centred on the origin, `lengths` along x and y in m.
pub(crate) fn rectangle(lengths: [f64; 2], mirrored: [bool; 2], meshing: &Meshing) -> Result<Mesh, MeshError> {
    if let Some(grading) = &meshing.grading {
        return graded_rectangle(lengths, mirrored, meshing, grading);
    }
    quadtree::check(lengths, meshing.size, elements_in_rectangle(lengths, meshing))?;
    let cells = divisions(lengths, mirrored, meshing);
    Ok(whole(lengths, cells, meshing.element).mesh(mirrored, meshing.element))
}

/// Most that the sides of cells differ from those that hold elements of the fine size.
const MISFIT: f64 = 0.15;

/// A rectangle whose elements are fine in some zones.
fn graded_rectangle(
    lengths: [f64; 2],
    mirrored: [bool; 2],
    meshing: &Meshing,
    grading: &Grading,
) -> Result<Mesh, MeshError> {
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
    quadtree::check(lengths, meshing.size, columns.saturating_mul(rows).saturating_mul(4))?;
    let roots = whole(lengths, [columns, rows], Element::Quad4).cut(mirrored);
    let grid = quadtree::refine(roots, grading, meshing.size, meshing.element, &|_, _| {})?;
    Ok(grid.mesh(mirrored, meshing.element))
}

/// Elements in the whole rectangle.
fn elements_in_rectangle(lengths: [f64; 2], meshing: &Meshing) -> usize {
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
            quadtree::alternate(cell, element == Element::Tri3 && (column + row) % 2 == 1)
        }));
    }
    grid
}

/// Position of division mark `index` of `parts` on a length centred on zero: zero in the middle and
/// mirror images exactly.
fn coordinate(index: usize, parts: usize, length: f64) -> f64 {
    (2.0 * index as f64 - parts as f64) * (length / (2.0 * parts as f64))
}

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
        return graded_disc(radius, mirrored, meshing, grading);
    }
    quadtree::check([2.0 * radius; 2], meshing.size, elements_in_disc(radius, meshing))?;
    let pattern = Pattern::new(radius, meshing.size);
    Ok(pattern.whole(radius, meshing.element).mesh(mirrored, meshing.element))
}

/// Bounds of [`Pattern::half`] in a graded circle, whose block has cells of a given side.
const HALVES: [f64; 2] = [0.45, 0.68];

/// A circle whose elements are fine in some zones.
fn graded_disc(radius: f64, mirrored: [bool; 2], meshing: &Meshing, grading: &Grading) -> Result<Mesh, MeshError> {
    grading.check([2.0 * radius; 2], PI * radius * radius, meshing.size)?;
    let fits = |cell: f64| (HALVES[0]..=HALVES[1]).contains(&Pattern::of_cells(radius, cell).half);
    let cell = quadtree::root(grading.fine, meshing.size, fits);
    let pattern = Pattern::of_cells(radius, cell);
    quadtree::check([2.0 * radius; 2], meshing.size, pattern.cells().saturating_mul(4))?;
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
fn elements_in_disc(radius: f64, meshing: &Meshing) -> usize {
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
                quadtree::alternate(cell, turned(column + row))
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
                quadtree::alternate(cell, turned(here + ring))
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

/// Passes over the nodes; later ones change little.
const PASSES: usize = 12;

/// Improvement of the least scaled Jacobian below which a node stays, so that regular parts do.
const WORTH: f64 = 1e-6;

/// Moves nodes towards the mean of their neighbours, in passes, each where this improves the least scaled Jacobian of
/// its elements. Nodes of the outline, whose edges belong to one element, stay.
pub(crate) fn smooth<const N: usize>(nodes: &mut [Point3<f64>], elements: &[[u32; N]]) {
    let around = Around::new(nodes.len(), elements);
    for _ in 0..PASSES {
        // All nodes move at once, so that mirror images do alike.
        let moved: Vec<Option<Point3<f64>>> =
            (0..nodes.len()).map(|node| around.better(node, nodes, elements)).collect();
        let before = nodes.to_vec();
        for (node, to) in nodes.iter_mut().zip(&moved) {
            *node = to.unwrap_or(*node);
        }
        // Neighbours that moved together may have made it worse.
        let worse: Vec<usize> = (0..nodes.len())
            .filter(|node| moved[*node].is_some())
            .filter(|node| around.least(*node, None, nodes, elements) < around.least(*node, None, &before, elements))
            .collect();
        worse.into_iter().for_each(|node| nodes[node] = before[node]);
    }
}

/// Elements and neighbours of each node; none of those that stay.
struct Around {
    elements: Vec<Vec<u32>>,
    neighbours: Vec<Vec<u32>>,
}

impl Around {
    fn new<const N: usize>(nodes: usize, elements: &[[u32; N]]) -> Around {
        let mut around = Around { elements: vec![vec![]; nodes], neighbours: vec![vec![]; nodes] };
        let mut edges = vec![];
        for (element, corners) in (0u32..).zip(elements) {
            corners.iter().for_each(|node| around.elements[*node as usize].push(element));
            edges.extend(directed(corners).map(undirected));
        }
        edges.sort_unstable();
        for uses in edges.chunk_by(|a, b| a == b) {
            let [a, b] = uses[0];
            around.neighbours[a as usize].push(b);
            around.neighbours[b as usize].push(a);
        }
        for uses in edges.chunk_by(|a, b| a == b).filter(|uses| uses.len() == 1) {
            uses[0].iter().for_each(|node| around.elements[*node as usize].clear());
        }
        around
    }

    /// Half-way to the mean of its neighbours, if the elements of the node are better with it there.
    fn better<const N: usize>(&self, node: usize, nodes: &[Point3<f64>], elements: &[[u32; N]]) -> Option<Point3<f64>> {
        if self.elements[node].is_empty() {
            return None;
        }
        let neighbours = &self.neighbours[node];
        let sum: nalgebra::Vector3<f64> = neighbours.iter().map(|other| nodes[*other as usize].coords).sum();
        let to = nalgebra::center(&nodes[node], &Point3::from(sum / neighbours.len() as f64));
        let gain = self.least(node, Some(to), nodes, elements) - self.least(node, None, nodes, elements);
        (gain > WORTH).then_some(to)
    }

    /// Least scaled Jacobian of the elements of a node, with it at `place`.
    fn least<const N: usize>(
        &self,
        node: usize,
        place: Option<Point3<f64>>,
        nodes: &[Point3<f64>],
        elements: &[[u32; N]],
    ) -> f64 {
        let point = |corner: u32| match place {
            Some(place) if corner as usize == node => place,
            _ => nodes[corner as usize],
        };
        let of = |element: &u32| scaled_jacobian(&elements[*element as usize].map(point));
        self.elements[node].iter().map(of).fold(f64::INFINITY, f64::min)
    }
}
