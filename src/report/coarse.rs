//! Surfaces coarsened to few enough patches for a page.

use std::collections::{BTreeSet, HashMap, HashSet};

/// A surface of few patches: the nodes that represent those around them, and the elements that still have an area.
pub(crate) struct CoarseSurface {
    /// Nodes of the mesh.
    pub(crate) nodes: Vec<u32>,
    /// Corners of each patch, as indices of `nodes`.
    pub(crate) patches: Vec<[u32; 4]>,
    /// The element that each patch shows.
    pub(crate) element: Vec<u32>,
    /// Of each node of the mesh the index in `nodes` of the one that represents it.
    group: Vec<u32>,
}

impl CoarseSurface {
    /// All elements where there are at most `most`, else those that remain when the nodes of each cell of a lattice are
    /// merged. The coarsest lattice, the corners of the bounding box, may leave more than `most`.
    pub(crate) fn from_points(points: &[[f32; 3]], outlines: &[[u32; 4]], most: usize) -> CoarseSurface {
        if outlines.len() <= most {
            let nodes: Vec<u32> = (0..points.len() as u32).collect();
            let element = (0..outlines.len() as u32).collect();
            return CoarseSurface { group: nodes.clone(), nodes, patches: outlines.to_vec(), element };
        }
        let [low, high] = bounds(points.iter().copied());
        let mut extents = [0, 1, 2].map(|axis| high[axis] - low[axis]);
        extents.sort_by(f32::total_cmp);
        // A flat surface, or a strip without width, has about `most` patches of this size; others may need larger ones.
        let mut cell = (extents[2] * extents[1] / most.max(1) as f32).sqrt().max(extents[2] / most.max(1) as f32);
        loop {
            let lattice = Lattice::new([low, high], cell);
            let surface = CoarseSurface::coarse(points, outlines, &lattice);
            if surface.patches.len() <= most || lattice.is_coarsest() {
                return surface;
            }
            cell *= 1.2;
        }
    }

    fn coarse(points: &[[f32; 3]], outlines: &[[u32; 4]], lattice: &Lattice) -> CoarseSurface {
        // For each lattice point its index and the node nearest to it, which preserves the edges of the film.
        let mut nearest: HashMap<[u32; 3], (u32, f32)> = HashMap::new();
        let mut nodes: Vec<u32> = Vec::new();
        let mut number = |(node, point): (usize, &[f32; 3])| {
            let (place, distance) = lattice.nearest(point);
            let next = nodes.len() as u32;
            let (number, least) = nearest.entry(place).or_insert((next, f32::INFINITY));
            if *number == next {
                nodes.push(node as u32);
            }
            if distance < *least {
                *least = distance;
                nodes[*number as usize] = node as u32;
            }
            *number
        };
        let group: Vec<u32> = points.iter().enumerate().map(&mut number).collect();
        let mut seen: HashSet<Vec<u32>> = HashSet::new();
        let (mut patches, mut element) = (Vec::new(), Vec::new());
        for (at, outline) in outlines.iter().enumerate() {
            let patch = outline.map(|node| group[node as usize]);
            let mut corners = patch.to_vec();
            corners.sort_unstable();
            corners.dedup();
            // Elements that were merged onto the same corners would hide one another.
            if corners.len() >= 3 && seen.insert(corners) {
                patches.push(patch);
                element.push(at as u32);
            }
        }
        CoarseSurface { nodes, patches, element, group }
    }

    /// The values of its nodes, from those of all nodes of the mesh.
    pub(crate) fn of_nodes<T: Copy>(&self, values: &[T]) -> Vec<T> {
        self.nodes.iter().map(|node| values[*node as usize]).collect()
    }

    /// The edges of the mesh that have a length still.
    pub(crate) fn edges(&self, edges: &[[u32; 2]]) -> Vec<[u32; 2]> {
        let own = edges.iter().map(|edge| edge.map(|node| self.group[node as usize]));
        own.filter(|[a, b]| a != b).collect::<BTreeSet<_>>().into_iter().collect()
    }
}

/// Points at equal distances along each axis of a box, its corners included.
struct Lattice {
    low: [f32; 3],
    /// Number of steps along each axis, at least one.
    steps: [f32; 3],
    /// Length of a step along each axis.
    step: [f32; 3],
}

impl Lattice {
    /// The lattice in the box from `low` to `high` whose steps are about `cell` long.
    fn new([low, high]: [[f32; 3]; 2], cell: f32) -> Lattice {
        let extent = [0, 1, 2].map(|axis| high[axis] - low[axis]);
        let steps = extent.map(|extent| (extent / cell).round().max(1.0));
        Lattice { low, steps, step: [0, 1, 2].map(|axis| extent[axis] / steps[axis]) }
    }

    /// Whether the lattice points are the corners of the box.
    fn is_coarsest(&self) -> bool {
        self.steps.iter().all(|steps| *steps == 1.0)
    }

    /// Indices of the lattice point nearest to `point`, and the square of the distance in steps.
    fn nearest(&self, point: &[f32; 3]) -> ([u32; 3], f32) {
        // Flat film has no extent along one axis.
        let steps = [0, 1, 2].map(|axis| match self.step[axis] > 0.0 {
            true => (point[axis] - self.low[axis]) / self.step[axis],
            false => 0.0,
        });
        (steps.map(|step| step.round() as u32), steps.iter().map(|step| (step - step.round()).powi(2)).sum())
    }
}

/// Smallest and largest coordinates; zeros without points.
pub(crate) fn bounds(points: impl Iterator<Item = [f32; 3]>) -> [[f32; 3]; 2] {
    let ends = points.map(|point| [point, point]).reduce(|[low, high], [point, _]| {
        let each = |of: fn(f32, f32) -> f32, ends: [f32; 3]| [0, 1, 2].map(|axis| of(ends[axis], point[axis]));
        [each(f32::min, low), each(f32::max, high)]
    });
    ends.unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use crate::film::tests::sheet;

    use super::*;

    #[test]
    fn a_fine_mesh_is_coarsened_within_its_bounds() {
        let (points, film) = sheet(200);
        let outlines: Vec<[u32; 4]> = film.outlines().collect();
        let surface = CoarseSurface::from_points(&points, &outlines, 3000);
        assert!(surface.patches.len() <= 3000 && surface.patches.len() > 1500, "{}", surface.patches.len());
        let [low, high] = bounds(surface.of_nodes(&points).into_iter());
        assert_eq!((low, high), ([0.0; 3], [1.0, 1.0, 0.0]), "its edges stay where they are");
        assert!(surface.patches.iter().flatten().all(|corner| (*corner as usize) < surface.nodes.len()));
        let side: Vec<[u32; 2]> = (0..200).map(|node| [node, node + 1]).collect();
        let held = surface.edges(&side);
        let length = |[a, b]: &[u32; 2]| {
            let [a, b] = [a, b].map(|node| points[surface.nodes[*node as usize] as usize]);
            assert_eq!([a[1], b[1]], [0.0; 2], "on the side");
            (b[0] - a[0]).abs()
        };
        assert!((10..100).contains(&held.len()), "{}", held.len());
        assert!((held.iter().map(length).sum::<f32>() - 1.0).abs() < 1e-5, "without gaps");
    }

    #[test]
    fn a_surface_that_no_lattice_makes_small_enough_still_has_patches() {
        let bent: Vec<[f32; 3]> = (0..9).map(|at| [(at % 3) as f32, (at / 3) as f32, (at % 2) as f32]).collect();
        let corner = |at: u32| at / 2 * 3 + at % 2;
        let outlines: Vec<[u32; 4]> =
            (0..4).map(|at| [corner(at), corner(at) + 1, corner(at) + 4, corner(at) + 3]).collect();
        for most in [0, 1, 2] {
            assert!(!CoarseSurface::from_points(&bent, &outlines, most).patches.is_empty(), "{most}");
        }
    }
}
