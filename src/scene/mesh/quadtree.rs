//! All-quadrilateral refinement of a grid: quadtrees whose leaves differ by one level at most, joined by templates.

use std::collections::HashMap;

use nalgebra::{Point2, Point3, center};

use super::grid::{Grid, LIMIT};
use super::smoothing::smooth;
use super::topology::{Edge, undirected};
use super::{Element, Grading, MeshError};

/// Edge length over the wanted one above which a cell is refined. Between two levels sizes then lie around the wanted
/// one; the last digits decide that cells that are mirror images are treated alike.
const TOLERANCE: f64 = 1.25 + 1e-9;

/// Moves the middle of an edge with these ends to where the outline has it.
pub(crate) type Place<'a> = &'a dyn Fn(&mut Point3<f64>, [Point3<f64>; 2]);

/// The cells of `grid`, each four elements, refined to `grading`; no element is larger than `size` (m).
///
/// # Errors
/// [`MeshError::TooMany`].
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
            return Err(MeshError::TooMany { elements, limit });
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
            let of = |triangle: [Point3<f64>; 3]| super::quality::scaled_jacobian(&triangle);
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
