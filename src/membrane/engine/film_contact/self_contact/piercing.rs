//! Edges of a face that pass through its triangles, which the distances of single pairs do not tell: each has its own side.

use super::SelfContact;
use super::pairs::Parts;
use crate::engine::film_contact::surface::Surface;
use crate::engine::nodes::Vectors;

impl SelfContact {
    /// Largest depth by which an edge passes through a triangle without a common node, m: the distance of the nearer one of
    /// its ends from the plane of the triangle. Zero where none does.
    ///
    /// A point inside a triangle is at most the radius of the inscribed circle from one of its edges, 0.29 of an edge; so
    /// the two edges are a pair, but on triangles that are larger than the mean.
    pub(super) fn largest_depth(&self, surface: &Surface, position: &Vectors) -> f64 {
        let mut largest = 0.0_f64;
        for place in self.pairs.places() {
            let Parts::Edges([one, other]) = self.pairs.known(place).parts else { continue };
            for [edge, beside] in [[one, other], [other, one]] {
                for triangle in self.topology.triangles_at(beside) {
                    let corners = surface.corners[triangle as usize];
                    if surface.edges[edge as usize].iter().all(|node| !corners.contains(node)) {
                        largest = largest.max(depth(surface, position, edge, triangle));
                    }
                }
            }
        }
        largest
    }
}

/// Distance of the nearer end of an edge from the plane of a triangle through which it passes, m; zero where it does not.
fn depth(surface: &Surface, position: &Vectors, edge: u32, triangle: u32) -> f64 {
    let [a, b, c] = surface.corners_at(position, triangle);
    let [p, q] = surface.ends_at(position, edge);
    let (u, v) = (b - a, c - a);
    let across = u.cross(&v);
    let (above, below) = (across.dot(&(p - a)), across.dot(&(q - a)));
    // Nor what is not a number.
    if (above * below).is_nan() || above * below >= 0.0 {
        return 0.0;
    }
    let r = p + (q - p) * (above / (above - below)) - a;
    let (of_b, of_c) = (r.cross(&v).dot(&across), u.cross(&r).dot(&across));
    let squared = across.norm_squared();
    let is_inside = of_b >= 0.0 && of_c >= 0.0 && of_b + of_c <= squared;
    if is_inside { above.abs().min(below.abs()) / squared.sqrt() } else { 0.0 }
}
