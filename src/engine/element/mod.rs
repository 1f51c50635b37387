//! Membrane elements: deformation at their integration points and the nodal forces that follow.
//!
//! Elements of one kind stand in blocks of [`LANES`]. A step runs over the blocks as gather → kernel → scatter.

mod quad4;
mod reference;
mod tri3;

pub use reference::{Frame, UprightElement};

use nalgebra::Point3;

use crate::lane::{LANES, Lane, Lane3, dot, splat};
use crate::material::{Deformation, MembraneLaw, Peaks, Stress};

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

/// The part of a four-node element's motion that its single integration point does not see: the amplitude
/// q = Σ γ_a x_a of the mode ξη (theory.md, equations 12–14).
///
/// Across the element f_I varies by q times the mode's gradient, with mean square H_I |q|². The law sees it as
/// [`Deformation::spread`], so tension resists the mode as full integration would, from the same energy. Along the
/// fibres a small stiffness κ_I is added, ½ κ_I H_I (f_I·q)², because strains that cancel in the mean leave no trace in it.
#[derive(Clone, Debug)]
pub struct Hourglass<const NODES: usize> {
    /// γ_a, orthogonal to every linear field.
    pub shape: [Lane; NODES],
    /// Mean squares of the mode's gradient along MD and TD over the element, 1/m².
    pub mean_square: [Lane; 2],
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
                mean_square: std::array::from_fn(|i| std::array::from_fn(|l| lane(l).hourglass.1[i])),
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

/// f_I = Σ_a ∂N_a/∂X_I x_a (theory.md, equation 1), and how far f_I varies around it.
#[inline(always)]
pub(crate) fn deformation<const NODES: usize>(
    x: &[Lane3; NODES],
    point: &Point<NODES>,
    spread: [Lane; 2],
) -> Deformation {
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
    Deformation { f, spread }
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
    let stabilisation = law.moduli().map(|m| IN_PLANE_STABILISATION * m);
    let mut past = false;
    for ((nodes, points), hourglass) in blocks.nodes.iter().zip(&mut blocks.points).zip(&blocks.hourglass) {
        let x = gather(nodes, position);
        let mut out = [[splat(0.0); 3]; NODES];
        if NODES == 4 && POINTS == 1 {
            let q = hourglass.amplitude(&x);
            let d = deformation(&x, &points[0], hourglass.spread(&q));
            let mut stress = law.stress(&d, &mut points[0].peaks);
            hourglass.subtract_force(&mut out, &q, &d, &points[0].volume, &mut stress, stabilisation);
            subtract_stress(&mut out, &points[0], &stress.p);
            past |= beyond(&points[0], limits);
        } else {
            for point in points.iter_mut() {
                let d = deformation(&x, point, [splat(0.0); 2]);
                let stress = law.stress(&d, &mut point.peaks);
                subtract_stress(&mut out, point, &stress.p);
                past |= beyond(point, limits);
            }
        }
        scatter(nodes, &out, force);
    }
    past
}

/// −V Σ_I ∂N_a/∂X_I p_I (theory.md, equation 2).
#[inline(always)]
fn subtract_stress<const NODES: usize>(out: &mut [Lane3; NODES], point: &Point<NODES>, p: &[Lane3; 2]) {
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

    /// H_I |q|².
    #[inline(always)]
    fn spread(&self, q: &Lane3) -> [Lane; 2] {
        let squared = dot(q, q);
        let mut spread = [splat(0.0); 2];
        for fibre in 0..2 {
            for l in 0..LANES {
                spread[fibre][l] = self.mean_square[fibre][l] * squared[l];
            }
        }
        spread
    }

    /// −V γ_a Σ_I H_I [ 2∂W/∂|f_I|² q + κ_I (f_I·q) f_I ]; adds what the stabilisation gives to ∂W/∂f_I,
    /// κ_I H_I (f_I·q) q, to the stress (theory.md, equation 14).
    #[inline(always)]
    fn subtract_force(
        &self,
        out: &mut [Lane3; NODES],
        q: &Lane3,
        d: &Deformation,
        volume: &Lane,
        stress: &mut Stress,
        stabilisation: [f64; 2],
    ) {
        let mut resisted = [dot(&d.f[0], q), dot(&d.f[1], q)];
        let mut followed = splat(0.0);
        for fibre in 0..2 {
            for l in 0..LANES {
                resisted[fibre][l] *= stabilisation[fibre] * self.mean_square[fibre][l];
                followed[l] += self.mean_square[fibre][l] * stress.tension[fibre][l];
            }
        }
        for axis in 0..3 {
            let mut h = splat(0.0);
            for l in 0..LANES {
                let along = resisted[0][l] * d.f[0][axis][l] + resisted[1][l] * d.f[1][axis][l];
                h[l] = volume[l] * (followed[l] * q[axis][l] + along);
                stress.p[0][axis][l] += resisted[0][l] * q[axis][l];
                stress.p[1][axis][l] += resisted[1][l] * q[axis][l];
            }
            for a in 0..NODES {
                for l in 0..LANES {
                    out[a][axis][l] -= self.shape[a][l] * h[l];
                }
            }
        }
    }

    /// Energy of the stabilisation, ½ Σ_I κ_I H_I (f_I·q)², J/m³.
    fn energy(&self, q: &Lane3, d: &Deformation, stabilisation: [f64; 2]) -> Lane {
        let mut energy = splat(0.0);
        for fibre in 0..2 {
            let along = dot(&d.f[fibre], q);
            for l in 0..LANES {
                energy[l] += 0.5 * stabilisation[fibre] * self.mean_square[fibre][l] * along[l] * along[l];
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
    let stabilisation = law.moduli().map(|m| IN_PLANE_STABILISATION * m);
    let hourglass = &blocks.hourglass[block];
    let q = hourglass.amplitude(&x);
    let mut out = [ElementEnergy::default(); LANES];
    for point in &blocks.points[block] {
        let d = deformation(&x, point, hourglass.spread(&q));
        let energy = law.energy(&d, &point.peaks);
        let stabilised = hourglass.energy(&q, &d, stabilisation);
        for l in 0..LANES {
            out[l].stored += point.volume[l] * energy.stored[l];
            out[l].absorbed += point.volume[l] * energy.absorbed[l];
            out[l].hourglass += point.volume[l] * stabilised[l];
        }
    }
    out
}

/// Deformation at every integration point of a block.
pub(crate) fn deformations<const NODES: usize, const POINTS: usize>(
    blocks: &Blocks<NODES, POINTS>,
    block: usize,
    position: &[[f64; 3]],
) -> [Deformation; POINTS] {
    let x = gather(&blocks.nodes[block], position);
    let hourglass = &blocks.hourglass[block];
    let spread = hourglass.spread(&hourglass.amplitude(&x));
    std::array::from_fn(|p| deformation(&x, &blocks.points[block][p], spread))
}

/// Bound on the squared angular frequency of the elements of one block, rad²/s² (theory.md, equation 17).
pub(crate) fn frequency_bound<L: MembraneLaw, const NODES: usize, const POINTS: usize>(
    blocks: &Blocks<NODES, POINTS>,
    block: usize,
    law: &L,
    density: f64,
    position: &[[f64; 3]],
) -> f64 {
    let mut bound = splat(0.0);
    let mut volume = splat(0.0);
    for (point, d) in blocks.points[block].iter().zip(deformations(blocks, block, position)) {
        let k = law.stiffness(&d, &point.peaks);
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
