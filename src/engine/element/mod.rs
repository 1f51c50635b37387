//! Membrane elements: deformation at their integration points and the nodal forces that follow.
//!
//! Elements of one kind stand in blocks of [`LANES`]. A step runs over the blocks as gather → kernel → scatter.

mod quad4;
mod reference;
mod tri3;

pub use reference::{Frame, UprightElement};

use nalgebra::Point3;

use crate::lane::{LANES, Lane, Lane3, splat};
use crate::material::{Gradient, MembraneLaw, Peaks};

/// Elements with `NODES` nodes and `POINTS` integration points.
#[derive(Clone, Debug)]
pub struct Blocks<const NODES: usize, const POINTS: usize> {
    /// Elements; the last block is filled up with weightless copies of the last one.
    pub count: usize,
    /// Nodes of each element in each lane.
    pub nodes: Vec<[[u32; LANES]; NODES]>,
    /// Integration points, block by block.
    pub points: Vec<[Point<NODES>; POINTS]>,
    /// Stabilisation against hourglass modes, block by block.
    pub hourglass: Vec<Hourglass<NODES>>,
}

/// An integration point of the elements of a block.
#[derive(Clone, Debug)]
pub struct Point<const NODES: usize> {
    /// ∂N_a/∂X_I along MD and TD of the stress-free film, 1/m.
    pub gradient: [[Lane; 2]; NODES],
    /// Volume of stress-free film (all layers), m³; zero once broken.
    pub volume: Lane,
    /// Largest strains so far.
    pub peaks: Peaks,
}

/// The part of a four-node element's motion that its single integration point does not see
/// (theory.md, equations 12–14): amplitude q = Σ γ_a x_a.
#[derive(Clone, Debug)]
pub struct Hourglass<const NODES: usize> {
    /// γ_a, orthogonal to every linear field.
    pub shape: [Lane; NODES],
    /// Mean squares of the mode's gradient along MD and TD over the element, 1/m².
    pub weight: [Lane; 2],
}

/// One element as it is put into a block.
pub(crate) struct Element<const NODES: usize, const POINTS: usize> {
    nodes: [u32; NODES],
    gradient: [[[f64; 2]; NODES]; POINTS],
    /// Area of stress-free film at each point, m².
    area: [f64; POINTS],
    hourglass: ([f64; NODES], [f64; 2]),
}

/// Share of the initial modulus with which hourglass motion along the fibres is resisted.
const IN_PLANE_STABILISATION: f64 = 0.05;

impl<const NODES: usize, const POINTS: usize> Blocks<NODES, POINTS> {
    /// Blocks of `elements` of a film `thickness` (m, all layers) thick.
    pub(crate) fn new(elements: &[Element<NODES, POINTS>], thickness: f64) -> Self {
        let mut out = Blocks { count: elements.len(), nodes: vec![], points: vec![], hourglass: vec![] };
        for chunk in elements.chunks(LANES) {
            let lane = |l: usize| &chunk[l.min(chunk.len() - 1)];
            let weight = |l: usize| if l < chunk.len() { thickness } else { 0.0 };
            out.nodes.push(std::array::from_fn(|a| std::array::from_fn(|l| lane(l).nodes[a])));
            out.points.push(std::array::from_fn(|p| Point {
                gradient: std::array::from_fn(|a| {
                    std::array::from_fn(|i| std::array::from_fn(|l| lane(l).gradient[p][a][i]))
                }),
                volume: std::array::from_fn(|l| weight(l) * lane(l).area[p]),
                peaks: [splat(0.0); 3],
            }));
            out.hourglass.push(Hourglass {
                shape: std::array::from_fn(|a| std::array::from_fn(|l| lane(l).hourglass.0[a])),
                weight: std::array::from_fn(|i| std::array::from_fn(|l| lane(l).hourglass.1[i])),
            });
        }
        out
    }

    /// Block and lane of each element, in order.
    pub fn places(&self) -> impl Iterator<Item = (usize, usize)> + use<NODES, POINTS> {
        (0..self.count).map(|i| (i / LANES, i % LANES))
    }

    /// Nodes of the element at `block`, `lane`.
    pub fn nodes_at(&self, block: usize, lane: usize) -> [u32; NODES] {
        std::array::from_fn(|a| self.nodes[block][a][lane])
    }

    /// Whether the element at `block`, `lane` has broken.
    pub fn is_broken(&self, block: usize, lane: usize) -> bool {
        self.points[block][0].volume[lane] == 0.0
    }
}

/// Positions of a block's nodes.
#[inline(always)]
pub(crate) fn gather<const NODES: usize>(nodes: &[[u32; LANES]; NODES], position: &[[f64; 3]]) -> [Lane3; NODES] {
    let mut x = [[splat(0.0); 3]; NODES];
    for a in 0..NODES {
        for l in 0..LANES {
            let p = position[nodes[a][l] as usize];
            for axis in 0..3 {
                x[a][axis][l] = p[axis];
            }
        }
    }
    x
}

#[inline(always)]
fn scatter<const NODES: usize>(nodes: &[[u32; LANES]; NODES], f: &[Lane3; NODES], force: &mut [[f64; 3]]) {
    for a in 0..NODES {
        for l in 0..LANES {
            let to = &mut force[nodes[a][l] as usize];
            for axis in 0..3 {
                to[axis] += f[a][axis][l];
            }
        }
    }
}

/// f_I = Σ_a ∂N_a/∂X_I x_a (theory.md, equation 1).
#[inline(always)]
pub(crate) fn deformation<const NODES: usize>(x: &[Lane3; NODES], point: &Point<NODES>) -> Gradient {
    let mut f = [[splat(0.0); 3]; 2];
    for fibre in 0..2 {
        for axis in 0..3 {
            for a in 0..NODES {
                for l in 0..LANES {
                    f[fibre][axis][l] += point.gradient[a][fibre][l] * x[a][axis][l];
                }
            }
        }
    }
    f
}

/// Adds the forces of all elements to `force` and raises the largest strains.
/// True if a fibre somewhere is past its break strain.
#[inline(always)]
pub(crate) fn add_forces<L: MembraneLaw, const NODES: usize, const POINTS: usize>(
    blocks: &mut Blocks<NODES, POINTS>,
    law: &L,
    position: &[[f64; 3]],
    force: &mut [[f64; 3]],
) -> bool {
    let limits = law.break_strains();
    let moduli = law.moduli();
    let mut past = false;
    for ((nodes, points), hourglass) in blocks.nodes.iter().zip(&mut blocks.points).zip(&blocks.hourglass) {
        let x = gather(nodes, position);
        let mut out = [[splat(0.0); 3]; NODES];
        for point in points.iter_mut() {
            let f = deformation(&x, point);
            let stress = law.stress(&f, &mut point.peaks);
            subtract_stress(&mut out, point, &stress.p);
            if NODES == 4 && POINTS == 1 {
                hourglass.subtract_force(&mut out, &x, &f, &point.volume, &stress.tension, moduli);
            }
            past |= beyond(point, limits);
        }
        scatter(nodes, &out, force);
    }
    past
}

/// −V Σ_I ∂N_a/∂X_I p_I (theory.md, equation 2).
#[inline(always)]
fn subtract_stress<const NODES: usize>(out: &mut [Lane3; NODES], point: &Point<NODES>, p: &Gradient) {
    for fibre in 0..2 {
        for axis in 0..3 {
            let mut vp = splat(0.0);
            for l in 0..LANES {
                vp[l] = point.volume[l] * p[fibre][axis][l];
            }
            for a in 0..NODES {
                for l in 0..LANES {
                    out[a][axis][l] -= point.gradient[a][fibre][l] * vp[l];
                }
            }
        }
    }
}

#[inline(always)]
fn beyond<const NODES: usize>(point: &Point<NODES>, limits: [f64; 2]) -> bool {
    let mut any = false;
    for l in 0..LANES {
        any |= (point.volume[l] > 0.0) & ((point.peaks[0][l] > limits[0]) | (point.peaks[1][l] > limits[1]));
    }
    any
}

impl<const NODES: usize> Hourglass<NODES> {
    /// q = Σ γ_a x_a; zero in every linear deformation, so also in the undeformed element.
    #[inline(always)]
    fn amplitude(&self, x: &[Lane3; NODES]) -> Lane3 {
        let mut q = [splat(0.0); 3];
        for axis in 0..3 {
            for a in 0..NODES {
                for l in 0..LANES {
                    q[axis][l] += self.shape[a][l] * x[a][axis][l];
                }
            }
        }
        q
    }

    /// −V γ_a Σ_I H_I [ (σ_I/λ_I) q + κ_I (f_I·q) f_I ] (theory.md, equation 14).
    #[inline(always)]
    fn subtract_force(
        &self,
        out: &mut [Lane3; NODES],
        x: &[Lane3; NODES],
        f: &Gradient,
        volume: &Lane,
        tension: &[Lane; 2],
        moduli: [f64; 2],
    ) {
        let q = self.amplitude(x);
        let along = [crate::lane::dot(&f[0], &q), crate::lane::dot(&f[1], &q)];
        for axis in 0..3 {
            let mut h = splat(0.0);
            for l in 0..LANES {
                let mut sum = 0.0;
                for fibre in 0..2 {
                    let resisted = IN_PLANE_STABILISATION * moduli[fibre] * along[fibre][l] * f[fibre][axis][l];
                    sum += self.weight[fibre][l] * (tension[fibre][l] * q[axis][l] + resisted);
                }
                h[l] = volume[l] * sum;
            }
            for a in 0..NODES {
                for l in 0..LANES {
                    out[a][axis][l] -= self.shape[a][l] * h[l];
                }
            }
        }
    }

    /// ½ Σ_I H_I [ (σ_I/λ_I) |q|² + κ_I (f_I·q)² ], J per volume.
    fn energy(&self, x: &[Lane3; NODES], f: &Gradient, tension: &[Lane; 2], moduli: [f64; 2]) -> Lane {
        let q = self.amplitude(x);
        let squared = crate::lane::dot(&q, &q);
        let mut energy = splat(0.0);
        for fibre in 0..2 {
            let along = crate::lane::dot(&f[fibre], &q);
            for l in 0..LANES {
                let resisted = IN_PLANE_STABILISATION * moduli[fibre] * along[l] * along[l];
                energy[l] += 0.5 * self.weight[fibre][l] * (tension[fibre][l] * squared[l] + resisted);
            }
        }
        energy
    }
}

/// Energies of one element, J.
#[derive(Clone, Copy, Debug, Default)]
pub struct ElementEnergy {
    /// Comes back on unloading.
    pub stored: f64,
    /// Lost in the law.
    pub absorbed: f64,
    /// In the stabilisation.
    pub hourglass: f64,
}

/// Energies of the elements of one block, lane by lane.
pub(crate) fn energies<L: MembraneLaw, const NODES: usize, const POINTS: usize>(
    blocks: &Blocks<NODES, POINTS>,
    block: usize,
    law: &L,
    position: &[[f64; 3]],
) -> [ElementEnergy; LANES] {
    let x = gather(&blocks.nodes[block], position);
    let mut out = [ElementEnergy::default(); LANES];
    for point in &blocks.points[block] {
        let f = deformation(&x, point);
        let energy = law.energy(&f, &point.peaks);
        for l in 0..LANES {
            out[l].stored += point.volume[l] * energy.stored[l];
            out[l].absorbed += point.volume[l] * energy.absorbed[l];
        }
        if NODES == 4 && POINTS == 1 {
            let tension = law.stress(&f, &mut point.peaks.clone()).tension;
            let hourglass = blocks.hourglass[block].energy(&x, &f, &tension, law.moduli());
            for l in 0..LANES {
                out[l].hourglass += point.volume[l] * hourglass[l];
            }
        }
    }
    out
}

/// Bound on the squared angular frequency of the elements of one block, rad²/s² (theory.md, equation 17).
pub(crate) fn frequency_bound<L: MembraneLaw, const NODES: usize, const POINTS: usize>(
    blocks: &Blocks<NODES, POINTS>,
    block: usize,
    law: &L,
    density: f64,
    position: &[[f64; 3]],
) -> f64 {
    let x = gather(&blocks.nodes[block], position);
    let points = &blocks.points[block];
    let mut bound = splat(0.0);
    let mut volume = splat(0.0);
    for point in points {
        let k = law.stiffness(&deformation(&x, point), &point.peaks);
        for l in 0..LANES {
            let mut g = [0.0; 2];
            for a in 0..NODES {
                for fibre in 0..2 {
                    g[fibre] += point.gradient[a][fibre][l] * point.gradient[a][fibre][l];
                }
            }
            let first = k.along[0][l] * g[0] + k.across[1][l] * g[1];
            let second = k.along[1][l] * g[1] + k.across[0][l] * g[0];
            bound[l] += point.volume[l] * (first.max(second) + k.shear[l] * (g[0] + g[1]));
            volume[l] += point.volume[l];
        }
    }
    let mut largest = 0.0_f64;
    for l in 0..LANES {
        if volume[l] > 0.0 {
            largest = largest.max(bound[l] * NODES as f64 / (density * volume[l]));
        }
    }
    largest
}

/// Elements of a mesh's quads with one integration point.
pub(crate) fn quads(
    quads: &[[u32; 4]],
    nodes: &[Point3<f64>],
    frame: &Frame,
) -> Result<Vec<Element<4, 1>>, UprightElement> {
    quads.iter().map(|&q| Ok(quad4::one_point(q, frame.reference(q, nodes)?))).collect()
}

/// Elements of a mesh's quads with 2×2 integration points.
pub(crate) fn full_quads(
    quads: &[[u32; 4]],
    nodes: &[Point3<f64>],
    frame: &Frame,
) -> Result<Vec<Element<4, 4>>, UprightElement> {
    quads.iter().map(|&q| Ok(quad4::four_points(q, frame.reference(q, nodes)?))).collect()
}

/// Elements of a mesh's triangles.
pub(crate) fn tris(
    tris: &[[u32; 3]],
    nodes: &[Point3<f64>],
    frame: &Frame,
) -> Result<Vec<Element<3, 1>>, UprightElement> {
    tris.iter().map(|&t| Ok(tri3::constant_strain(t, frame.reference(t, nodes)?))).collect()
}

impl<const NODES: usize, const POINTS: usize> Element<NODES, POINTS> {
    /// Area of stress-free film, m².
    pub(crate) fn area(&self) -> f64 {
        self.area.iter().sum()
    }
}
