//! Delaunay refinement: circumcentres of triangles that are too large or too narrow become nodes (Ruppert, J.
//! Algorithms 18, 1995), in rounds of those that do not disturb each other.

use std::collections::{BTreeSet, HashMap};

use nalgebra::{Point2, Point3, Vector3};
use spade::{ConstrainedDelaunayTriangulation, InsertionError, Triangulation};

use super::super::{Edge, directed, scaled_jacobian, undirected};
use super::{Boundary, Polygon};

/// Circumradius over the wanted edge length above which a triangle is too large: nodes are then from 0.8 to 1.6 of that
/// length apart. It is 0.58 for an equilateral triangle of the wanted size.
const LARGE: f64 = 0.8;
/// Circumradius over the shortest edge above which a triangle is too narrow: a least angle of 26 degrees.
const NARROW: f64 = 1.14;
/// How often an edge of the outline is halved.
const DEEPEST: u32 = 6;
const ROUNDS: usize = 300;

/// Nodes, and triangles by the numbers of these.
pub(super) type Triangles<P> = (Vec<P>, Vec<[u32; 3]>);

/// Nodes (the boundary's first) and triangles, counter-clockwise, of at most about `most` nodes.
///
/// # Errors
/// A coordinate cannot be triangulated.
pub(super) fn refined(
    mut boundary: Boundary,
    polygon: &Polygon,
    wanted: &dyn Fn(Point2<f64>) -> f64,
    most: usize,
) -> Result<Triangles<Point3<f64>>, InsertionError> {
    let mut inner: Vec<Point2<f64>> = vec![];
    for _ in 0..ROUNDS {
        let (points, triangles) = triangulation(&boundary, &inner)?;
        let bad = bad(&points, &triangles, &boundary, wanted);
        let halved = improve(&boundary, polygon, &bad, &mut inner);
        if bad.is_empty() || halved.is_none() || points.len() > most {
            break;
        }
        halved.into_iter().flatten().for_each(|segment| boundary.split(segment, polygon));
    }
    let (points, triangles) = triangulation(&boundary, &inner)?;
    Ok((points.iter().map(|p| Point3::new(p.x, p.y, 0.0)).collect(), triangles))
}

/// A triangle to be improved: how bad it is, the centre and the radius of its circumcircle.
struct Bad {
    excess: f64,
    centre: Point2<f64>,
    radius: f64,
}

/// Triangles that are too large or too narrow, the worst first.
fn bad(
    points: &[Point2<f64>],
    triangles: &[[u32; 3]],
    boundary: &Boundary,
    wanted: &dyn Fn(Point2<f64>) -> f64,
) -> Vec<Bad> {
    let excess = |triangle: &[u32; 3]| {
        let [a, b, c] = triangle.map(|node| points[node as usize]);
        let (u, v) = (b - a, c - a);
        let twice_area = u.perp(&v);
        let [uu, vv] = [u.norm_squared(), v.norm_squared()];
        let centre = a + nalgebra::Vector2::new(v.y * uu - u.y * vv, u.x * vv - v.x * uu) / (2.0 * twice_area);
        let radius = (centre - a).norm();
        let [i, j, k] = triangle.map(|node| node as usize);
        let edges = [(uu, [i, j]), (vv, [i, k]), ((c - b).norm_squared(), [j, k])];
        let (shortest, ends) =
            edges.into_iter().fold(edges[0], |least, edge| if edge.0 < least.0 { edge } else { least });
        let middle = Point2::from((a.coords + b.coords + c.coords) / 3.0);
        // Between lines that meet at a small angle every triangle is narrow, and refinement would not end.
        let narrow = if boundary.is_across_narrow(ends) { 0.0 } else { radius / (NARROW * shortest.sqrt()) };
        let excess = narrow.max(radius / (LARGE * wanted(middle)));
        (excess > 1.0).then_some(Bad { excess, centre, radius })
    };
    let mut bad: Vec<Bad> = triangles.iter().filter_map(excess).collect();
    bad.sort_by(|a, b| b.excess.total_cmp(&a.excess));
    bad
}

/// Adds the circumcentres of `bad` that lie in the film, apart from each other and from its edges. The edges to be
/// halved in place of others; none where nothing is left to do.
fn improve(
    boundary: &Boundary,
    polygon: &Polygon,
    bad: &[Bad],
    inner: &mut Vec<Point2<f64>>,
) -> Option<BTreeSet<usize>> {
    let largest = bad.iter().map(|bad| bad.radius).fold(0.0, f64::max);
    let mut added = Neighbours { cell: largest.max(f64::MIN_POSITIVE), cells: HashMap::new() };
    let mut halved = BTreeSet::new();
    let before = inner.len();
    for Bad { centre, radius, .. } in bad {
        // Two nodes nearer to each other than a radius would make a triangle as bad as these: one waits for a round.
        if added.has_within(*centre, *radius) {
            continue;
        }
        // Within the circle over an edge as its diameter a node would see the edge at more than a right angle, however
        // often the triangle is refined: the edge is halved instead (Ruppert).
        let is_close = |(_, [a, b]): &(usize, [Point2<f64>; 2])| (a - centre).dot(&(b - centre)) < 0.0;
        let ends = boundary.segments.iter().map(|segment| boundary.ends(segment)).enumerate();
        let close: Vec<(usize, [Point2<f64>; 2])> = ends.filter(is_close).collect();
        for (segment, [a, b]) in &close {
            if boundary.segments[*segment].depth < DEEPEST && halved.insert(*segment) {
                added.add(nalgebra::center(a, b));
            }
        }
        if close.is_empty() && polygon.covers((*centre).into()) {
            added.add(*centre);
            inner.push(*centre);
        }
    }
    (inner.len() > before || !halved.is_empty()).then_some(halved)
}

/// Points in square cells.
struct Neighbours {
    cell: f64,
    cells: HashMap<[i64; 2], Vec<Point2<f64>>>,
}

impl Neighbours {
    fn place(&self, point: Point2<f64>) -> [i64; 2] {
        [0, 1].map(|axis| (point[axis] / self.cell).floor() as i64)
    }

    fn add(&mut self, point: Point2<f64>) {
        self.cells.entry(self.place(point)).or_default().push(point);
    }

    /// Whether there is a point nearer than `radius`, which is at most a cell.
    fn has_within(&self, point: Point2<f64>, radius: f64) -> bool {
        let [x, y] = self.place(point);
        let cells = (-1..=1).flat_map(|i| (-1..=1).map(move |j| [x + i, y + j]));
        cells.filter_map(|cell| self.cells.get(&cell)).flatten().any(|other| (other - point).norm() < radius)
    }
}

type Cdt = ConstrainedDelaunayTriangulation<spade::Point2<f64>>;

/// Nodes and triangles of the constrained Delaunay triangulation that the film covers.
fn triangulation(boundary: &Boundary, inner: &[Point2<f64>]) -> Result<Triangles<Point2<f64>>, InsertionError> {
    let points: Vec<Point2<f64>> = boundary.points.iter().chain(inner).copied().collect();
    let as_spade = |p: &Point2<f64>| spade::mitigate_underflow(spade::Point2::new(p.x, p.y));
    let edges = boundary.segments.iter().map(|segment| segment.ends).collect();
    // The edges were checked not to cross.
    let cdt = Cdt::try_bulk_load_cdt(points.iter().map(as_spade).collect(), edges, |_| {})?;
    let is_covered = covered(&cdt);
    let covered = cdt.inner_faces().filter(|face| is_covered[face.fix().index()]);
    let triangles = covered.map(|face| face.vertices().map(|vertex| vertex.fix().index() as u32)).collect();
    Ok((points, triangles))
}

/// Whether each face is inside the outline and in no hole: reached from outside across an odd number of edges of the
/// boundary.
fn covered(cdt: &Cdt) -> Vec<bool> {
    let mut is_covered: Vec<Option<bool>> = vec![None; cdt.num_all_faces()];
    let outer = cdt.outer_face().fix().index();
    is_covered[outer] = Some(false);
    let mut open: Vec<(usize, bool)> = vec![];
    let mut enter = |face: usize, covers: bool, open: &mut Vec<(usize, bool)>| {
        if is_covered[face].is_none() {
            is_covered[face] = Some(covers);
            open.push((face, covers));
        }
    };
    // Counted by edges that are crossed, a loop is a hole whatever its sense.
    for edge in cdt.convex_hull() {
        enter(edge.rev().face().fix().index(), edge.is_constraint_edge(), &mut open);
    }
    let edges: Vec<[(usize, bool); 3]> = cdt
        .inner_faces()
        .map(|face| face.adjacent_edges().map(|edge| (edge.rev().face().fix().index(), edge.is_constraint_edge())))
        .collect();
    let places: HashMap<usize, usize> =
        cdt.inner_faces().enumerate().map(|(place, face)| (face.fix().index(), place)).collect();
    while let Some((face, covers)) = open.pop() {
        for (next, crosses) in edges[places[&face]] {
            enter(next, covers != crosses, &mut open);
        }
    }
    is_covered.into_iter().map(|covers| covers == Some(true)).collect()
}

/// Least scaled Jacobian of two triangles joined: that of three quadrilaterals in an equilateral triangle is 0.87.
const JOINED: f64 = 0.6;

/// The quadrilaterals in `triangles`, about half as large, and their nodes.
pub(super) fn quadrilaterals(
    mut nodes: Vec<Point3<f64>>,
    triangles: &[[u32; 3]],
    polygon: &Polygon,
) -> (Vec<Point3<f64>>, Vec<[u32; 4]>) {
    let mut uses: HashMap<Edge, u32> = HashMap::new();
    for edge in triangles.iter().flat_map(|triangle| directed(triangle)) {
        *uses.entry(undirected(edge)).or_default() += 1;
    }
    let outlines = joined(&nodes, triangles);
    let mut middles: HashMap<Edge, u32> = HashMap::new();
    let mut out = vec![];
    for outline in &outlines {
        let sum: Vector3<f64> = outline.iter().map(|node| nodes[*node as usize].coords).sum();
        let centre = nodes.len() as u32;
        nodes.push(Point3::from(sum / outline.len() as f64));
        let mut middle = |edge: [u32; 2]| {
            *middles.entry(undirected(edge)).or_insert_with(|| {
                let [a, b] = edge.map(|node| nodes[node as usize]);
                nodes.push(match uses[&undirected(edge)] {
                    // The outline may turn between the two nodes.
                    1 => polygon.middle([a.xy(), b.xy()]).coords.push(0.0).into(),
                    _ => nalgebra::center(&a, &b),
                });
                nodes.len() as u32 - 1
            })
        };
        let halves: Vec<u32> = directed(outline).map(&mut middle).collect();
        let count = outline.len();
        out.extend((0..count).map(|i| [outline[i], halves[i], centre, halves[(i + count - 1) % count]]));
    }
    (nodes, out)
}

/// Triangles, and quadrilaterals of two of them: the best shaped pairs first.
fn joined(nodes: &[Point3<f64>], triangles: &[[u32; 3]]) -> Vec<Vec<u32>> {
    let mut beside: HashMap<Edge, usize> = HashMap::new();
    let mut pairs: Vec<(f64, [usize; 2], [u32; 4])> = vec![];
    for (here, triangle) in triangles.iter().enumerate() {
        for edge in directed(triangle) {
            let Some(other) = beside.insert(undirected(edge), here) else { continue };
            let apex = |of: usize| triangles[of].into_iter().find(|node| !edge.contains(node));
            let (Some(own), Some(far)) = (apex(here), apex(other)) else { continue };
            let quad = [own, edge[0], far, edge[1]];
            let quality = scaled_jacobian(&quad.map(|node| nodes[node as usize]));
            if quality > JOINED {
                pairs.push((quality, [other, here], quad));
            }
        }
    }
    // Greedy in place of a matching: triangles that are left become quadrilaterals by the division into three.
    pairs.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut is_taken = vec![false; triangles.len()];
    let mut out: Vec<Vec<u32>> = vec![];
    for (_, pair, quad) in pairs {
        if pair.iter().all(|triangle| !is_taken[*triangle]) {
            pair.iter().for_each(|triangle| is_taken[*triangle] = true);
            out.push(quad.to_vec());
        }
    }
    let left = triangles.iter().zip(&is_taken).filter(|(_, is_taken)| !**is_taken);
    out.extend(left.map(|(triangle, _)| triangle.to_vec()));
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_cannot_be_triangulated_is_no_empty_mesh() {
        let corners = vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        let boundary = Boundary::from_polygon(&Polygon { outer: corners, holes: vec![] }, &|_| 2.0);
        let found = |inner: f64| triangulation(&boundary, &[Point2::new(inner, 0.5)]).map(|(_, triangles)| triangles);
        assert_eq!(found(0.5).map(|triangles| triangles.len()), Ok(4));
        assert_eq!(found(1e250), Err(InsertionError::TooLarge));
        assert_eq!(found(f64::NAN), Err(InsertionError::NAN));
    }
}
