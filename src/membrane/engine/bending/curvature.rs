//! Curvatures at the nodes of a film and their stiffness (theory.md, equations 351 to 355).

use super::fit::{self, Terms};
use super::outline::{Outline, Place, Reach, behind};
use super::plate::Plate;

/// Curvatures at a node as sums over the positions of nodes around it, and what they store.
#[derive(Clone, Debug)]
pub(super) struct Curvature {
    /// Nodes of the outline, the one itself first, then ascending.
    pub(super) nodes: Vec<u32>,
    /// Of each node in the curvatures κ₁₁, κ₂₂ and 2κ₁₂, or in those of an edge, 1/m².
    pub(super) weights: Vec<[f64; 3]>,
    /// Moments over curvatures times the area of the node, N m³.
    pub(super) stiffness: [[f64; 3]; 3],
    /// Elements of the film on which it rests.
    pub(super) elements: Vec<u32>,
}

/// How stress-free film was mounted.
#[derive(Clone, Copy, Debug)]
pub(super) struct Mounted {
    /// Cosine and sine of the angle from x to MD.
    pub(super) md: [f64; 2],
    /// 1 + pre-strain along MD and TD.
    pub(super) stretch: [f64; 2],
}

impl Mounted {
    /// Stress-free coordinates along MD and TD of a mounted vector, m.
    pub(super) fn stress_free(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let [c, s] = self.md;
        [(x * c + y * s) / self.stretch[0], (y * c - x * s) / self.stretch[1]]
    }
}

/// A node around another, or its image behind a held edge.
struct Point {
    node: u32,
    /// Stress-free, from the node in the middle, m.
    at: [f64; 2],
}

impl Curvature {
    /// The curvatures at a `node`; none where no element is bent by it.
    pub(super) fn at_node(
        outline: &Outline,
        node: u32,
        mounted: &Mounted,
        plate: &Plate,
        own_elements: usize,
    ) -> Option<Curvature> {
        let area: f64 =
            outline.around[node as usize].iter().map(|element| share(outline, *element, node, mounted)).sum();
        // Wider where the nodes next to it do not decide the curvatures: four triangles around a node.
        let reaches = [Reach::Next, Reach::Near, Reach::Second];
        let of_reach = |reach| Some((reach, fitted(outline, node, reach, mounted, plate)?));
        let (reach, (points, weights, stiffness)) = reaches.into_iter().find_map(of_reach)?;
        let mut nodes = vec![node];
        nodes.extend(outline.neighbours(node, reach));
        let mut sums = vec![[0.0; 3]; nodes.len()];
        for (Point { node: of, .. }, weight) in points.iter().zip(&weights) {
            // An image behind a held edge moves as the node itself does; how the film is mounted there is in the
            // difference to the mounted positions alone.
            let place = 1 + nodes[1..].binary_search(of).expect("a neighbour");
            for k in 0..3 {
                sums[place][k] += weight[k];
                sums[0][k] -= weight[k];
            }
        }
        let mut elements: Vec<u32> = outline.around[node as usize].clone();
        if reach != Reach::Next {
            let rings = outline.neighbours(node, Reach::Next);
            elements.extend(rings.iter().flat_map(|other| outline.around[*other as usize].iter().copied()));
        }
        elements.iter_mut().for_each(|element| *element %= own_elements as u32);
        elements.sort_unstable();
        elements.dedup();
        Some(Curvature { nodes, weights: sums, stiffness: stiffness.map(|row| row.map(|d| d * area)), elements })
    }

    /// Stiffness between two of its nodes, N/m, by their places.
    pub(super) fn between(&self, one: usize, other: usize) -> f64 {
        let (a, b) = (&self.weights[one.min(other)], &self.weights[one.max(other)]);
        let moment = |k: usize| (0..3).map(|j| self.stiffness[k][j] * b[j]).sum::<f64>();
        (0..3).map(|k| a[k] * moment(k)).sum()
    }
}

/// The points around a node, their weights, and the moments over the curvatures that these give, N m.
type Fitted = (Vec<Point>, Vec<[f64; 3]>, [[f64; 3]; 3]);

fn fitted(outline: &Outline, node: u32, reach: Reach, mounted: &Mounted, plate: &Plate) -> Option<Fitted> {
    let place = outline.place(node);
    let mut points = vec![];
    for other in outline.neighbours(node, reach) {
        let offset = outline.between(node, other);
        points.push(Point { node: other, at: mounted.stress_free(offset) });
        if let Place::BuiltIn { inward } | Place::FreeAtBuiltIn { inward, .. } = place
            && let Some(image) = behind(offset, inward)
        {
            points.push(Point { node: other, at: mounted.stress_free(image) });
        }
    }
    match place {
        Place::Corner => None,
        Place::Inside | Place::BuiltIn { .. } => {
            let at: Vec<[f64; 2]> = points.iter().map(|point| point.at).collect();
            let weights = fit::weights(&at, Terms::All)?;
            Some((points, weights, plate.0))
        }
        Place::Free { along } | Place::FreeAtBuiltIn { along, .. } => {
            let [x, y] = mounted.stress_free(along);
            let length = (x * x + y * y).sqrt();
            let along @ [c, s] = [x / length, y / length];
            let at: Vec<[f64; 2]> =
                points.iter().map(|Point { at: [x, y], .. }| [x * c + y * s, y * c - x * s]).collect();
            // No moment acts across a free edge: the curvature there follows from the others.
            if let Some(weights) = fit::weights(&at, Terms::AlongAndTwist) {
                let [[tt, ts], [_, ss]] = plate.at_edge(along);
                return Some((points, weights, [[tt, ts, 0.0], [ts, ss, 0.0], [0.0; 3]]));
            }
            let weights = fit::weights(&at, Terms::Along).filter(|_| reach == Reach::Second)?;
            let tt = plate.along_edge(along);
            Some((points, weights, [[tt, 0.0, 0.0], [0.0; 3], [0.0; 3]]))
        }
    }
}

/// Stress-free area of an element that belongs to one of its nodes, m²: of a triangle what is nearer to it than to the others
/// (Meyer, Desbrun, Schröder and Barr, Discrete differential-geometry operators for triangulated 2-manifolds, 2003), a
/// quarter of a quadrilateral. Thirds of triangles would give a node with four of them half of what one with eight has,
/// and the same moment in both would be out of balance.
fn share(outline: &Outline, element: u32, node: u32, mounted: &Mounted) -> f64 {
    let corners = &outline.elements[element as usize];
    let at: Vec<[f64; 2]> = corners.iter().map(|corner| mounted.stress_free(outline.between(node, *corner))).collect();
    let cross = |a: [f64; 2], b: [f64; 2]| a[0] * b[1] - b[0] * a[1];
    let dot = |a: [f64; 2], b: [f64; 2]| a[0] * b[0] + a[1] * b[1];
    let twice: f64 = at.iter().zip(at.iter().cycle().skip(1)).map(|(a, b)| cross(*a, *b)).sum();
    if corners.len() != 3 {
        return 0.5 * twice / corners.len() as f64;
    }
    let own = corners.iter().position(|corner| *corner == node).expect("a node of the element");
    let (a, b) = (at[(own + 1) % 3], at[(own + 2) % 3]);
    let edge = [b[0] - a[0], b[1] - a[1]];
    let (at_node, at_a, at_b) = (dot(a, b), -dot(a, edge), dot(b, edge));
    if at_node < 0.0 {
        0.25 * twice
    } else if at_a < 0.0 || at_b < 0.0 {
        0.125 * twice
    } else {
        // The cotangents of the angles opposite to both edges at the node.
        0.125 * (dot(a, a) * at_b + dot(b, b) * at_a) / twice
    }
}
