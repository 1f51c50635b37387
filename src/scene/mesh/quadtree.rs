//! All-quadrilateral refinement of a grid: quadtrees whose leaves differ by one level at most, joined by templates; grids of
//! cells of a whole outline, before symmetry and triangles; element sizes that grow with the distance from a place.

use std::collections::HashMap;
use std::f64::consts::PI;

use nalgebra::{Point2, Point3, center};
use serde::{Deserialize, Serialize};

use super::structured::smooth;
use super::{Edge, Element, Mesh, MeshError, MeshErrorKind, fault, undirected};
use crate::mesh;

/// Edge length over the wanted one above which a cell is refined. Between two levels sizes then lie around the wanted
/// one; the last digits decide that cells that are mirror images are treated alike.
const TOLERANCE: f64 = 1.25 + 1e-9;

/// Moves the middle of an edge with these ends to where the outline has it.
pub(crate) type Place<'a> = &'a dyn Fn(&mut Point3<f64>, [Point3<f64>; 2]);

/// The cells of `grid`, each four elements, refined to `grading`; no element is larger than `size` (m).
///
/// # Errors
/// More elements than can be numbered.
pub(crate) fn refine(
    grid: Grid,
    grading: &Grading,
    size: f64,
    element: Element,
    place: Place<'_>,
) -> Result<Grid, MeshError> {
    let mut forest = Forest::new(grid, place);
    let mut next = 0;
    while next < forest.cells.len() {
        if forest.is_too_large(next, grading, size) {
            forest.split(next)?;
        }
        next += 1;
    }
    while forest.balance()? {}
    Ok(forest.elements(element))
}

/// Side of the cells to refine (m), two elements long, of which a number of halvings makes elements of the `fine` size:
/// the largest that gives none above `size` and `fits` the outline, or else the finest.
pub(crate) fn root(fine: f64, size: f64, fits: impl Fn(f64) -> bool) -> f64 {
    let levels = (size / fine * (1.0 + 1e-9)).log2().floor().max(0.0) as i32;
    let side = |level: i32| 2.0 * fine * 2.0_f64.powi(level);
    let fitting = (0..=levels).rev().map(side).find(|side| fits(*side));
    fitting.unwrap_or(2.0 * fine)
}

/// Quadtrees of cells that share their nodes.
struct Forest<'a> {
    nodes: Vec<Point3<f64>>,
    cells: Vec<Cell>,
    roots: usize,
    /// Middles of edges of all levels.
    middles: HashMap<Edge, u32>,
    place: Place<'a>,
}

struct Cell {
    corners: [u32; 4],
    /// Middle of the edge that begins at each corner.
    middles: [u32; 4],
    /// The middle of the cell and the first of its four children, one at each corner.
    children: Option<(u32, usize)>,
}

impl<'a> Forest<'a> {
    fn new(grid: Grid, place: Place<'a>) -> Forest<'a> {
        let Grid { nodes, cells } = grid.counter_clockwise();
        let roots = cells.len();
        let mut forest = Forest { nodes, cells: Vec::with_capacity(roots), roots, middles: HashMap::new(), place };
        cells.into_iter().for_each(|corners| forest.add(corners));
        forest
    }

    fn add(&mut self, corners: [u32; 4]) {
        let middles = std::array::from_fn(|i| self.middle([corners[i], corners[(i + 1) % 4]]));
        self.cells.push(Cell { corners, middles, children: None });
    }

    /// The middle of an edge.
    fn middle(&mut self, edge: [u32; 2]) -> u32 {
        let Forest { nodes, middles, place, .. } = self;
        *middles.entry(undirected(edge)).or_insert_with(|| {
            let ends = undirected(edge).map(|node| nodes[node as usize]);
            let mut middle = center(&ends[0], &ends[1]);
            place(&mut middle, ends);
            nodes.push(middle);
            nodes.len() as u32 - 1
        })
    }

    /// The middle of an edge, if it has one.
    fn known(&self, from: u32, to: u32) -> Option<u32> {
        self.middles.get(&undirected([from, to])).copied()
    }

    fn point(&self, node: u32) -> Point2<f64> {
        self.nodes[node as usize].xy()
    }

    /// Whether the four elements of a cell would be larger, by their area, than the least size that is wanted in it.
    fn is_too_large(&self, cell: usize, grading: &Grading, size: f64) -> bool {
        let corners = self.cells[cell].corners.map(|node| self.point(node));
        let area = 0.5 * (corners[2] - corners[0]).perp(&(corners[3] - corners[1]));
        let edge = 0.5 * area.sqrt();
        let from = |at: &[f64; 2]| distance(&corners, Point2::from(*at));
        let nearest = grading.zones.iter().map(|zone| from(&zone.at) - zone.within).fold(f64::INFINITY, f64::min);
        edge > TOLERANCE * grading.size_at(nearest, size)
    }

    fn split(&mut self, cell: usize) -> Result<(), MeshError> {
        let (elements, limit) = (4 * (self.cells.len() + 4), LIMIT);
        if elements > limit {
            return Err(too_many(elements, limit));
        }
        let Cell { corners, middles, .. } = self.cells[cell];
        let centre = self.centre(corners, middles);
        self.cells[cell].children = Some((centre, self.cells.len()));
        for i in 0..4 {
            self.add([corners[i], middles[i], centre, middles[(i + 3) % 4]]);
        }
        Ok(())
    }

    /// A node in the middle of a cell, whose edges may be bent at their middles.
    fn centre(&mut self, corners: [u32; 4], middles: [u32; 4]) -> u32 {
        let sum =
            |nodes: [u32; 4]| nodes.map(|node| self.nodes[node as usize].coords).iter().sum::<nalgebra::Vector3<f64>>();
        self.nodes.push(Point3::from(0.5 * sum(middles) - 0.25 * sum(corners)));
        self.nodes.len() as u32 - 1
    }

    /// Splits every leaf beside one that is two levels finer. Whether there was any.
    fn balance(&mut self) -> Result<bool, MeshError> {
        let mut changed = false;
        for cell in 0..self.cells.len() {
            if self.cells[cell].children.is_none() && self.has_finer_neighbour(cell) {
                self.split(cell)?;
                changed = true;
            }
        }
        Ok(changed)
    }

    fn has_finer_neighbour(&self, cell: usize) -> bool {
        let Cell { corners, middles, .. } = &self.cells[cell];
        let halves = (0..4).flat_map(|i| [[corners[i], middles[i]], [middles[i], corners[(i + 1) % 4]]]);
        halves
            .filter_map(|[from, to]| Some((from, self.known(from, to)?, to)))
            .any(|(from, middle, to)| self.known(from, middle).is_some() || self.known(middle, to).is_some())
    }

    /// The elements of all leaves, tree by tree, so that neighbours have numbers near each other.
    fn elements(mut self, element: Element) -> Grid {
        let mut out = vec![];
        let mut open: Vec<usize> = (0..self.roots).rev().collect();
        while let Some(cell) = open.pop() {
            match self.cells[cell].children {
                Some((_, first)) => open.extend((first..first + 4).rev()),
                None => self.leaf(cell, &mut out),
            }
        }
        smooth(&mut self.nodes, &out);
        if element == Element::Tri3 {
            out.iter_mut().for_each(|quad| *quad = self.across_the_wider_corners(*quad));
        }
        Grid { nodes: self.nodes, cells: out }.in_order_of_use()
    }

    /// The four elements of a leaf; beside finer leaves, templates of three, or of four smaller ones in a corner
    /// between two of them. The third corner of an undivided one is the middle of the leaf.
    fn leaf(&mut self, cell: usize, out: &mut Vec<[u32; 4]>) {
        let Cell { corners, middles, .. } = self.cells[cell];
        let centre = self.centre(corners, middles);
        let is_fine: [bool; 4] = std::array::from_fn(|i| self.known(corners[i], middles[i]).is_some());
        for i in 0..4 {
            let before = (i + 3) % 4;
            let [a, b, c, d] = [corners[i], middles[i], centre, middles[before]];
            if !is_fine[i] && !is_fine[before] {
                out.push([a, b, c, d]);
                continue;
            }
            let inner = self.middle_of([a, b, c, d]);
            let mut half = |from, to| self.middle([from, to]);
            match (is_fine[i], is_fine[before]) {
                (true, true) => {
                    let [ab, bc, cd, da] = [half(a, b), half(b, c), half(c, d), half(d, a)];
                    out.extend([[a, ab, inner, da], [ab, b, bc, inner], [bc, c, cd, inner], [cd, d, da, inner]]);
                }
                (true, false) => {
                    let [ab, bc] = [half(a, b), half(b, c)];
                    out.extend([[ab, b, bc, inner], [a, ab, inner, d], [bc, c, d, inner]]);
                }
                _ => {
                    let [cd, da] = [half(c, d), half(d, a)];
                    out.extend([[cd, d, da, inner], [da, a, b, inner], [c, cd, inner, b]]);
                }
            }
        }
    }

    fn middle_of(&mut self, corners: [u32; 4]) -> u32 {
        let sum: nalgebra::Vector3<f64> = corners.iter().map(|node| self.nodes[*node as usize].coords).sum();
        self.nodes.push(Point3::from(0.25 * sum));
        self.nodes.len() as u32 - 1
    }

    /// The quadrilateral, first the end of the diagonal that leaves the wider least angle; of equal ones that which it
    /// begins with.
    fn across_the_wider_corners(&self, quad: [u32; 4]) -> [u32; 4] {
        let points = quad.map(|node| self.nodes[node as usize]);
        let least = |turn: usize| {
            let p = |i: usize| points[(i + turn) % 4];
            let of = |triangle: [Point3<f64>; 3]| super::scaled_jacobian(&triangle);
            of([p(0), p(1), p(2)]).min(of([p(0), p(2), p(3)]))
        };
        let [a, b, c, d] = quad;
        // Beyond rounding, so that squares of one row are divided alike.
        if least(1) > least(0) + 1e-9 { [b, c, d, a] } else { quad }
    }
}

/// Distance of a point from a convex cell, zero within it.
fn distance(corners: &[Point2<f64>; 4], point: Point2<f64>) -> f64 {
    let edges = || (0..4).map(|i| (corners[i], corners[(i + 1) % 4]));
    if edges().all(|(from, to)| (to - from).perp(&(point - from)) >= 0.0) {
        return 0.0;
    }
    let to_edge = |(from, to): (Point2<f64>, Point2<f64>)| {
        let along = to - from;
        let share = ((point - from).dot(&along) / along.norm_squared()).clamp(0.0, 1.0);
        (point - (from + along * share)).norm()
    };
    edges().map(to_edge).fold(f64::INFINITY, f64::min)
}

/// Node numbers are `u32`, and there is about one node per cell.
const LIMIT: usize = u32::MAX as usize / 4;

/// Cells of a whole outline, in any sense of rotation.
#[derive(Debug, Default)]
pub(crate) struct Grid {
    /// m.
    pub nodes: Vec<Point3<f64>>,
    /// Corners of each cell; a split into triangles follows the diagonal from the first to the third.
    pub cells: Vec<[u32; 4]>,
}

impl Grid {
    /// The mesh of the part on this side of the mirror planes, of one kind of element.
    pub(crate) fn mesh(self, mirrored: [bool; 2], element: Element) -> Mesh {
        let grid = self.cut(mirrored).counter_clockwise();
        let mut mesh = Mesh { nodes: grid.nodes, ..Mesh::default() };
        match element {
            Element::Quad4 | Element::Quad4Full => mesh.quads = grid.cells,
            Element::Tri3 => mesh.tris = grid.cells.into_iter().flat_map(split).collect(),
        }
        mesh::label(&mut mesh, mirrored);
        mesh
    }

    /// The cells at x >= 0 and/or y >= 0; the mirror planes are lines of nodes.
    pub(crate) fn cut(self, mirrored: [bool; 2]) -> Grid {
        let inside = |p: &Point3<f64>| (0..2).all(|axis| !mirrored[axis] || p[axis] >= 0.0);
        let mut renumbered = vec![u32::MAX; self.nodes.len()];
        let mut nodes = Vec::new();
        for (old, point) in self.nodes.iter().enumerate().filter(|(_, p)| inside(p)) {
            renumbered[old] = nodes.len() as u32;
            nodes.push(*point);
        }
        let cells = self
            .cells
            .into_iter()
            .map(|cell| cell.map(|node| renumbered[node as usize]))
            .filter(|cell| !cell.contains(&u32::MAX))
            .collect();
        Grid { nodes, cells }
    }

    /// The nodes numbered as the cells name them first; nodes of no cell are left out.
    pub(crate) fn in_order_of_use(self) -> Grid {
        let mut numbers = vec![u32::MAX; self.nodes.len()];
        let mut nodes = Vec::with_capacity(self.nodes.len());
        let mut number = |node: u32| {
            let number = &mut numbers[node as usize];
            if *number == u32::MAX {
                *number = nodes.len() as u32;
                nodes.push(self.nodes[node as usize]);
            }
            *number
        };
        let cells = self.cells.into_iter().map(|cell| cell.map(&mut number)).collect();
        Grid { nodes, cells }
    }

    /// The cells with their corners counter-clockwise.
    pub(crate) fn counter_clockwise(mut self) -> Grid {
        for cell in &mut self.cells {
            let [a, b, c, d] = cell.map(|node| self.nodes[node as usize]);
            if (c - a).xy().perp(&(d - b).xy()) < 0.0 {
                cell.swap(1, 3);
            }
        }
        self
    }
}

/// More elements than the limit of a mesh.
fn too_many(elements: usize, limit: usize) -> MeshError {
    let message = format!("{elements} elements exceed the {limit} of a mesh; choose a larger element size");
    MeshError::new(MeshErrorKind::Size, message)
}

/// Refuses lengths and sizes that are not positive, and meshes whose nodes cannot be numbered.
pub(crate) fn check(lengths: [f64; 2], size: f64, elements: usize) -> Result<(), MeshError> {
    let positive = |value: f64| value.is_finite() && value > 0.0;
    if !positive(size) {
        let message = format!("expected a positive element size, found {size} m");
        return Err(MeshError::new(MeshErrorKind::Size, message));
    }
    if !lengths.into_iter().all(positive) {
        let [x, y] = lengths;
        return Err(fault!("expected an outline of positive lengths, found {x} m by {y} m"));
    }
    if elements > LIMIT {
        return Err(too_many(elements, LIMIT));
    }
    Ok(())
}

/// The two triangles on either side of the diagonal from the first to the third corner.
pub(crate) fn split([a, b, c, d]: [u32; 4]) -> [[u32; 3]; 2] {
    [[a, b, c], [a, c, d]]
}

/// The cell, with the other diagonal first where `odd`, so that the diagonals of neighbours alternate.
pub(crate) fn alternate([a, b, c, d]: [u32; 4], odd: bool) -> [u32; 4] {
    if odd { [b, c, d, a] } else { [a, b, c, d] }
}

/// Sizes of the elements of a graded mesh: `fine` within the zones, growing beyond them up to the size of the meshing
/// (theory.md, equation 200). Lengths in m.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Grading {
    /// Edge length within the zones.
    pub fine: f64,
    /// Growth of the edge length per distance from the nearest zone.
    pub growth: f64,
    /// Where elements are fine.
    pub zones: Vec<Zone>,
}

/// A circle in which elements are fine.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Zone {
    /// Its centre, x and y.
    pub at: [f64; 2],
    /// Its radius.
    pub within: f64,
}

impl Grading {
    /// Edge length at a distance from the edge of the nearest zone, of elements of at most `size`.
    pub(crate) fn size_at(&self, distance: f64, size: f64) -> f64 {
        size.min(self.fine + self.growth * distance.max(0.0))
    }

    /// Distance of a point from the edge of the nearest zone, m; negative within it.
    pub(crate) fn distance(&self, point: Point2<f64>) -> f64 {
        let from = |zone: &Zone| (point - Point2::from(zone.at)).norm() - zone.within;
        self.zones.iter().map(from).fold(f64::INFINITY, f64::min)
    }

    /// Refuses sizes that are not positive, and meshes of an outline of these `lengths` and this `area` (m, m²) whose
    /// nodes cannot be numbered.
    pub(crate) fn check(&self, lengths: [f64; 2], area: f64, size: f64) -> Result<(), MeshError> {
        if !(self.growth.is_finite() && self.growth > 0.0) {
            let message = format!("expected a positive growth of the elements, found {}", self.growth);
            return Err(MeshError::new(MeshErrorKind::Size, message));
        }
        check(lengths, size, 0)?;
        check(lengths, self.fine, self.cells(area, size) as usize)
    }

    /// Squares of these sizes that fill a plane figure of `area` (m²), at most: a zone may lie beside it.
    pub fn cells(&self, area: f64, size: f64) -> f64 {
        let Grading { fine, growth, .. } = *self;
        // Integral of 2πr (1/h² - 1/size²) from the edge of the zone to where h is the size.
        let (reach, ratio) = ((size - fine) / growth, size / fine);
        let of_zone = |zone: &Zone| {
            let r = zone.within;
            let inside = PI * r * r / (fine * fine);
            let ring = 2.0 * PI / growth * ((r - fine / growth) * (1.0 / fine - 1.0 / size) + ratio.ln() / growth);
            let replaced = PI * (r + reach).powi(2) / (size * size);
            inside + ring - replaced
        };
        (area / (size * size) + self.zones.iter().map(of_zone).sum::<f64>()).min(area / (fine * fine))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_number_of_cells_is_the_integral_of_their_density() {
        let grading = Grading { fine: 0.5, growth: 0.2, zones: vec![Zone { at: [0.0; 2], within: 10.0 }] };
        let (rim, size, rings) = (60.0, 4.0, 60_000);
        let width = rim / f64::from(rings);
        let summed: f64 = (0..rings)
            .map(|ring| (f64::from(ring) + 0.5) * width)
            .map(|r| 2.0 * PI * r * width / grading.size_at(r - 10.0, size).powi(2))
            .sum();
        let closed = grading.cells(PI * rim * rim, size);
        assert!((closed / summed - 1.0).abs() < 1e-4, "{closed} against {summed}");
    }
}
