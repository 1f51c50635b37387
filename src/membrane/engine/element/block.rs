//! Elements side by side, in blocks of lanes.

use super::heating::Heating;
use super::tearing::Tearing;
use super::viscous::{MovedBlock, ViscousBlock, ViscousPoints};
use crate::lane::{LANES, Lane, Lane3, splat};
use crate::material::{
    Deformation, Densities, Energy, HEAT_VARIABLES, History, MembraneLaw, Rupture, Stiffness, Stresses, Tear, Thermal,
    ViscousLaw, stresses,
};

/// `L` elements of one kind with `NODES` nodes each: what a pass over a film computes of them.
pub(crate) trait Block<const NODES: usize, const L: usize> {
    /// One element, outside of a block.
    type Element;
    /// History variables of an integration point.
    type History: History<L>;

    /// A block of the element and thickness (m, all layers) that `lane` returns for each lane.
    fn new<'a>(lane: impl Fn(usize) -> (&'a Self::Element, f64)) -> Self
    where
        Self::Element: 'a;

    /// Forces on nodes that moved to `x` in `dt` (s), into `out` (theory.md, equations 2 and 14); updates the history
    /// variables, and those of `viscous` film. Whether a fibre is past its break strain.
    fn forces<M>(
        &mut self,
        law: &M,
        viscous: Option<MovedBlock<'_, L>>,
        x: &[Lane3<L>; NODES],
        dt: f64,
        out: &mut [Lane3<L>; NODES],
    ) -> bool
    where
        M: MembraneLaw<History<L> = Self::History>;

    /// Energies of the elements with nodes at `x`.
    fn energies<M>(&self, law: &M, viscous: Option<ViscousBlock<'_, L>>, x: &[Lane3<L>; NODES]) -> BlockEnergies<L>
    where
        M: MembraneLaw<History<L> = Self::History>;

    /// Bound on density × squared angular frequency × volume / nodes, summed over the points (theory.md, equation 17).
    fn stiffness<M>(&self, law: &M, viscous: Option<ViscousBlock<'_, L>>, x: &[Lane3<L>; NODES]) -> Lane<L>
    where
        M: MembraneLaw<History<L> = Self::History>;

    /// Strains, averaged over the points.
    fn strains(&self, x: &[Lane3<L>; NODES]) -> BlockStrains<L>;

    /// Stresses, thickness and fibres, averaged over the points.
    fn details<M>(&self, law: &M, viscous: Option<ViscousBlock<'_, L>>, x: &[Lane3<L>; NODES]) -> BlockDetails<L>
    where
        M: MembraneLaw<History<L> = Self::History>;

    /// Deformation, averaged over the points.
    fn deformation(&self, x: &[Lane3<L>; NODES]) -> Deformation<L>;

    /// Second Piola–Kirchhoff stresses S₁₁, S₂₂ and S₁₂ (Pa of one layer), averaged over the points.
    fn stress<M>(&self, law: &M, viscous: Option<ViscousBlock<'_, L>>, x: &[Lane3<L>; NODES]) -> [Lane<L>; 3]
    where
        M: MembraneLaw<History<L> = Self::History>;

    /// ∂N_a/∂X_I along MD and TD of the stress-free film, averaged over the points, 1/m.
    fn gradients(&self) -> [[Lane<L>; 2]; NODES];

    /// Volume of stress-free film, m³; zero once it is deleted.
    fn volume(&self) -> Lane<L>;

    /// Largest strain of a fibre set so far over that at which its fibres break, in the element in a lane: the largest
    /// of its points.
    fn break_ratio<M>(&self, law: &M, lane: usize) -> f64
    where
        M: MembraneLaw<History<L> = Self::History>,
    {
        let of_point = |(history, _): (&Self::History, &Lane<L>)| {
            let breaks = law.break_strains::<L>(history);
            [0, 1].map(|fibre| history.peak(fibre)[lane] / breaks[fibre][lane])
        };
        self.history().flat_map(of_point).fold(0.0, f64::max)
    }

    /// Share of the layers whose MD and TD fibres are not broken in the element in a lane, at its present largest
    /// strains: the least of its points.
    fn layers_left<M>(&self, law: &M, lane: usize) -> [f64; 2]
    where
        M: MembraneLaw<History<L> = Self::History>;

    /// Deletes the element in a lane: its volume becomes zero.
    fn delete(&mut self, lane: usize);

    /// History variables and volume (m³) of every integration point.
    fn history(&self) -> impl Iterator<Item = (&Self::History, &Lane<L>)>;

    /// History variables and volume (m³) of every integration point, mutable.
    fn history_mut(&mut self) -> impl Iterator<Item = (&mut Self::History, &mut Lane<L>)>;
}

/// Energies of the elements of one block, J.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BlockEnergies<const L: usize> {
    /// Returned on unloading.
    pub stored: Lane<L>,
    /// Absorbed by the law.
    pub absorbed: Lane<L>,
    /// In the stabilisation against hourglass modes.
    pub hourglass: Lane<L>,
}

impl<const L: usize> BlockEnergies<L> {
    /// Of the element in a lane for each of its `volume` (m³), J/m³: a tear, as softening, releases the energy of the
    /// stabilisation, too.
    #[inline(always)]
    pub(super) fn densities(&self, volume: &Lane<L>, lane: usize) -> Densities {
        // Padding and deleted elements: 0/0 would be a NaN in history variables that are saved.
        let density = |energy: f64| if volume[lane] > 0.0 { energy / volume[lane] } else { 0.0 };
        Densities { stored: density(self.stored[lane] + self.hourglass[lane]), absorbed: density(self.absorbed[lane]) }
    }
}

/// Strains of the elements of one block.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BlockStrains<const L: usize> {
    /// Engineering strain along MD and TD, shear angle (rad).
    pub strain: [Lane<L>; 3],
    /// Largest MD and TD strain so far.
    pub peak: [Lane<L>; 2],
    /// Share of the layers whose MD and TD fibres are not broken.
    pub left: [Lane<L>; 2],
}

/// Stress, thickness and fibres of the elements of one block.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BlockDetails<const L: usize> {
    /// Nominal stresses along MD and TD and in shear, Pa of one layer.
    pub stress: [Lane<L>; 3],
    /// Thickness over that of stress-free film; NaN where the law does not define it.
    pub thickness_ratio: Lane<L>,
    /// Equivalent plastic strain; zero of a law without.
    pub plastic_strain: Lane<L>,
    /// f₁ and f₂: the images of unit vectors along MD and TD of the stress-free film.
    pub fibres: [Lane3<L>; 2],
}

impl<const L: usize> BlockDetails<L> {
    /// Zero, to be added to.
    pub(super) const NONE: Self = BlockDetails {
        stress: [splat(0.0); 3],
        thickness_ratio: splat(0.0),
        plastic_strain: splat(0.0),
        fibres: [[splat(0.0); 3]; 2],
    };

    /// Adds `share` of the details of one point with deformation `d` and `history`, the point numbered so where film is
    /// `viscous`.
    pub(super) fn add<M: MembraneLaw>(
        &mut self,
        law: &M,
        d: &Deformation<L>,
        history: &M::History<L>,
        viscous: Option<(ViscousBlock<'_, L>, usize)>,
        share: f64,
    ) {
        let mut response = law.stress_of(d, history);
        // Stress relaxes with a constant Poisson's ratio: the thickness is that of film strained at once.
        let thickness_ratio = law.thickness_ratio(d, &response);
        if let Some((viscous, point)) = viscous {
            response = viscous.stress(point, d);
        }
        let Stresses { md, td, shear } = stresses(d, &response);
        let plastic_strain = law.plastic_strain(history).copied().unwrap_or(splat(0.0));
        for l in 0..L {
            self.thickness_ratio[l] += share * thickness_ratio[l];
            self.plastic_strain[l] += share * plastic_strain[l];
            for (mean, value) in self.stress.iter_mut().zip([md, td, shear]) {
                mean[l] += share * value[l];
            }
            for (mean, value) in self.fibres.iter_mut().flatten().zip(d.f.iter().flatten()) {
                mean[l] += share * value[l];
            }
        }
    }
}

/// Energy of the point numbered `point` with deformation `d` and `history`.
#[inline(always)]
pub(super) fn point_energy<M: MembraneLaw, const L: usize>(
    law: &M,
    viscous: Option<ViscousBlock<'_, L>>,
    point: usize,
    d: &Deformation<L>,
    history: &M::History<L>,
) -> Energy<L> {
    let energy = law.energy(d, history);
    match viscous {
        Some(viscous) => viscous.energy(point, d, &law.stress(d, &mut history.clone(), 0.0), &energy),
        None => energy,
    }
}

/// Bound on the stiffness of the point numbered `point` with deformation `d` and `history`.
#[inline(always)]
pub(super) fn point_stiffness<M: MembraneLaw, const L: usize>(
    law: &M,
    viscous: Option<ViscousBlock<'_, L>>,
    point: usize,
    d: &Deformation<L>,
    history: &M::History<L>,
) -> Stiffness<L> {
    let stiffness = law.stiffness(d, history);
    match viscous {
        Some(viscous) => viscous.stiffness(point, d, stiffness),
        None => stiffness,
    }
}

/// Adds `share` of the deformation `d` to `sum`.
#[inline(always)]
pub(super) fn add_deformation<const L: usize>(sum: &mut Deformation<L>, d: &Deformation<L>, share: f64) {
    for fibre in 0..2 {
        for l in 0..L {
            sum.stretch_variance[fibre][l] += share * d.stretch_variance[fibre][l];
        }
        let (sum, d): (&mut Lane3<L>, &Lane3<L>) = (&mut sum.f[fibre], &d.f[fibre]);
        for axis in 0..3 {
            for l in 0..L {
                sum[axis][l] += share * d[axis][l];
            }
        }
    }
}

/// Adds `share` of S₁₁, S₂₂ and S₁₂ of the point numbered `point` with deformation `d` and `history` to `sum`.
pub(super) fn add_stress<M: MembraneLaw, const L: usize>(
    sum: &mut [Lane<L>; 3],
    law: &M,
    viscous: Option<ViscousBlock<'_, L>>,
    (point, d, history): (usize, &Deformation<L>, &M::History<L>),
    share: f64,
) {
    let stress = match viscous {
        Some(viscous) => viscous.stress(point, d),
        None => law.stress_of(d, history),
    };
    for (mean, value) in sum.iter_mut().zip([&stress.tension[0], &stress.tension[1], &stress.cross]) {
        for l in 0..L {
            mean[l] += share * value[l];
        }
    }
}

impl<const L: usize> BlockEnergies<L> {
    /// Zero, to be added to.
    pub(super) const NONE: Self = BlockEnergies { stored: splat(0.0), absorbed: splat(0.0), hourglass: splat(0.0) };
}

/// Nodes of the elements of a block.
#[derive(Clone, Debug)]
pub(crate) enum Corners<const NODES: usize, const L: usize = LANES> {
    /// The nodes of successive elements are consecutive; those of the first one.
    Row([u32; NODES]),
    /// Any nodes, one row per corner.
    Listed([[u32; L]; NODES]),
}

impl<const NODES: usize, const L: usize> Corners<NODES, L> {
    fn new(lane: impl Fn(usize) -> [u32; NODES]) -> Self {
        let first = lane(0);
        let follows = |l: usize| (0..NODES).all(|a| lane(l)[a] == first[a] + l as u32);
        if (0..L).all(follows) {
            return Corners::Row(first);
        }
        Corners::Listed(std::array::from_fn(|a| std::array::from_fn(|l| lane(l)[a])))
    }

    /// Nodes of the element in a lane.
    pub(crate) fn in_lane(&self, lane: usize) -> [u32; NODES] {
        let mut nodes = [0; NODES];
        for a in 0..NODES {
            nodes[a] = match self {
                Corners::Row(first) => first[a] + lane as u32,
                Corners::Listed(rows) => rows[a][lane],
            };
        }
        nodes
    }
}

/// Elements of one kind, in order.
#[derive(Clone, Debug)]
pub(crate) struct Blocks<B, const NODES: usize, const L: usize = LANES> {
    /// Number of elements; the last block is padded with copies of the last one without volume.
    pub count: usize,
    /// Nodes of each block's elements.
    pub corners: Vec<Corners<NODES, L>>,
    /// Geometry and history of each block's elements.
    pub blocks: Vec<B>,
    /// Mass of each block's elements over that of their film; empty where no mass was added.
    pub mass_factors: Vec<Lane<L>>,
    /// The Prony series of viscous film.
    pub viscous: Option<ViscousPoints<L>>,
    /// Heat of film that warms up by what it absorbs.
    pub heating: Option<Heating<L>>,
    /// Tears of film with a rupture criterion of its own.
    pub tearing: Option<Tearing<L>>,
}

impl<B: Block<NODES, L>, const NODES: usize, const L: usize> Blocks<B, NODES, L> {
    /// Blocks of elements and their nodes, of a film `thickness` (m, all layers) thick.
    pub(crate) fn new(nodes: &[[u32; NODES]], elements: &[B::Element], thickness: f64) -> Self {
        let count = nodes.len();
        let mut out = Blocks {
            count,
            corners: vec![],
            blocks: vec![],
            mass_factors: vec![],
            viscous: None,
            heating: None,
            tearing: None,
        };
        for first in (0..count).step_by(L) {
            let at = |l: usize| (first + l).min(count - 1);
            // Padding repeats the last element without volume: all it computes is finite and multiplied by zero.
            let weight = |l: usize| if first + l < count { thickness } else { 0.0 };
            out.corners.push(Corners::new(|l| nodes[at(l)]));
            out.blocks.push(B::new(|l| (&elements[at(l)], weight(l))));
        }
        out
    }

    /// These elements, of viscous film.
    pub(crate) fn with_viscosity(self, law: ViscousLaw) -> Self {
        let viscous = ViscousPoints::new(law, self.blocks.len(), self.points());
        Blocks { viscous: Some(viscous), ..self }
    }

    /// These elements, of film that warms up by what it absorbs.
    pub(crate) fn with_heating(self, thermal: Thermal) -> Self {
        let heating = Heating::new(thermal, self.blocks.len());
        Blocks { heating: Some(heating), ..self }
    }

    /// These elements with a rupture criterion of their own.
    pub(crate) fn with_rupture(self, rupture: Rupture) -> Self {
        let tearing = Tearing::new(rupture, self.blocks.iter().map(B::volume).collect());
        Blocks { tearing: Some(tearing), ..self }
    }

    /// Viscous points of a block, where film is viscous.
    #[inline(always)]
    pub(crate) fn viscous_block(&self, block: usize) -> Option<ViscousBlock<'_, L>> {
        self.viscous.as_ref().map(|viscous| viscous.block(block))
    }

    /// Block and lane of each element, in order.
    pub(crate) fn indices(&self) -> impl Iterator<Item = (usize, usize)> + use<B, NODES, L> {
        (0..self.count).map(|i| (i / L, i % L))
    }

    /// Integration points of one element.
    pub(crate) fn points(&self) -> usize {
        self.blocks.first().map_or(0, |block| block.history().count())
    }

    /// History variables of one element: those of the law and of the Prony series at all its points, and those of its
    /// heat and of its tear.
    pub(crate) fn variables(&self) -> usize {
        let of_law = self
            .blocks
            .first()
            .map_or(0, |block| block.history().map(|(history, _)| history.variables().count()).sum::<usize>());
        let of_heat = self.heating.as_ref().map_or(0, |_| HEAT_VARIABLES);
        let of_tear = self.tearing.as_ref().map_or(0, |_| Tear::VARIABLES);
        of_law + self.viscous.as_ref().map_or(0, ViscousPoints::per_block) + of_heat + of_tear
    }

    /// Share of the law's forces that the elements of a block had at the last position: what heat and tears left.
    #[inline(always)]
    pub(crate) fn share(&self, block: usize) -> Lane<L> {
        let mut share = splat(1.0);
        let of_heat = self.heating.as_ref().map(|heating| heating.share(block));
        let of_tears = self.tearing.as_ref().map(|tearing| tearing.share(block));
        for factor in of_heat.into_iter().chain(of_tears) {
            for l in 0..L {
                share[l] *= factor[l];
            }
        }
        share
    }

    /// Share of the layers whose MD and TD fibres are not broken in the element at `block`, `lane`; none where it is
    /// deleted.
    pub(crate) fn left(&self, block: usize, lane: usize) -> [f64; 2] {
        let mut points = self.blocks[block].history();
        let alive = points.next().filter(|(_, volume)| volume[lane] > 0.0);
        alive.map_or([0.0; 2], |(history, _)| [0, 1].map(|fibre| history.left(fibre)[lane]))
    }

    /// Whether the element at `block`, `lane` is deleted.
    pub(crate) fn is_deleted(&self, block: usize, lane: usize) -> bool {
        self.blocks[block].volume()[lane] == 0.0
    }
}
