//! The pass over elements that compares them with the limit of their rupture and softens what tears (theory.md, section
//! 25).

use super::block::{Block, Blocks};
use super::kernel::{gather, warm_energies};
use super::mean_state::{gradients_of, largest, width_across};
use crate::lane::{Lane, Lane3, Width, at_width, lanes, larger, splat};
use crate::material::{Criterion, MembraneLaw, Rupture, Tear};

at_width! {
    /// Advances the tears of elements that moved to `position` in `dt` (s), after their forces. Whether energy was
    /// lost.
    pub(crate) fn tear[B: Block<NODES, L>, M: MembraneLaw<History<L> = B::History>, const NODES: usize, const L: usize](
        elements: &mut Blocks<B, NODES, L>, law: &M, position: &[&[f64]; 3], dt: f64,
    ) -> bool = tear_lanewise, up to AVX2
}

#[inline(always)]
fn tear_lanewise<B: Block<NODES, L>, M: MembraneLaw<History<L> = B::History>, const NODES: usize, const L: usize>(
    elements: &mut Blocks<B, NODES, L>,
    law: &M,
    position: &[&[f64]; 3],
    dt: f64,
) -> bool {
    // Taken out, since tears are written while blocks and their viscous points are read.
    let Some(mut tearing) = elements.tearing.take() else { return false };
    let mut x = [[splat(0.0); 3]; NODES];
    let mut changed = false;
    let fracture_energy = tearing.rupture.fracture_energy;
    for b in 0..elements.blocks.len() {
        let (block, volume) = (&elements.blocks[b], elements.blocks[b].volume());
        gather(&elements.corners[b], position, &mut x);
        let metric = block.deformation(&x).metric();
        let values = values(&tearing.rupture, block, law, &metric, || stress(elements, b, law, &x));
        // Most blocks are far from a tear, and energies cost more than forces.
        if values.is_some_and(|values| tearing.stays_whole(b, &values)) {
            continue;
        }
        let strains = strains(&metric);
        let energies = warm_energies(Width::best(), elements, b, law, &x);
        for l in (0..L).filter(|l| volume[*l] > 0.0) {
            let mut tear = tearing.element_tear(b, l);
            let had_started = tear.has_started();
            let was_open = tear.is_open(fracture_energy);
            let lost = tear.advance(energies.densities(&volume, l));
            tearing.lost.energy.stored += volume[l] * lost.stored;
            tearing.lost.energy.absorbed += volume[l] * lost.absorbed;
            if dt > 0.0 && !tear.has_started() {
                let value = values.map(|values| values[l]);
                let element = Element { block, metric: metric.map(|c| c[l]), strain: strains[l], value, lane: l };
                let starts = element.starts(&tearing.rupture, &tear, tearing.is_beside_open(b, l));
                if let Some(width) = starts {
                    tear.start(width);
                    tearing.lost.note_start(&tear, fracture_energy);
                }
            }
            tear.soften(fracture_energy);
            tearing.lost.opened |= !was_open && tear.is_open(fracture_energy);
            // Also while a share falls: stiffness and time step change with it.
            changed |= tear.has_started() != had_started || tear.share == 0.0 || tear.share != tear.next;
            changed |= lost.stored != 0.0 || lost.absorbed != 0.0;
            tearing.set(b, l, &tear);
        }
    }
    elements.tearing = Some(tearing);
    changed
}

/// Second Piola–Kirchhoff stresses S₁₁, S₂₂ and S₁₂ of the elements of a block, without what their tears took, Pa of one layer.
#[inline(always)]
fn stress<B: Block<NODES, L>, M: MembraneLaw<History<L> = B::History>, const NODES: usize, const L: usize>(
    elements: &Blocks<B, NODES, L>,
    block: usize,
    law: &M,
    x: &[Lane3<L>; NODES],
) -> [Lane<L>; 3] {
    let mut stress = elements.blocks[block].stress(law, elements.viscous_block(block), x);
    if let Some(heating) = &elements.heating {
        let share = heating.share(block);
        for component in &mut stress {
            for l in 0..L {
                component[l] *= share[l];
            }
        }
    }
    stress
}

/// The quantity that the criterion compares with its limit, in each element of a block; none where it is an energy.
#[inline(always)]
fn values<B: Block<NODES, L>, M: MembraneLaw<History<L> = B::History>, const NODES: usize, const L: usize>(
    rupture: &Rupture,
    block: &B,
    law: &M,
    metric: &[Lane<L>; 3],
    stress: impl FnOnce() -> [Lane<L>; 3],
) -> Option<Lane<L>> {
    let [c11, c22, c12] = metric;
    Some(match rupture.criterion {
        Criterion::Strain => strains(metric),
        Criterion::FibreStrain => lanes(|l| larger(c11[l], c22[l]).sqrt() - 1.0),
        Criterion::Break => lanes(|l| block.break_ratio(law, l)),
        Criterion::Stress => {
            let s = stress();
            lanes(|l| largest(squared_stress([s[0][l], s[1][l], s[2][l]], [c11[l], c22[l], c12[l]])).sqrt())
        }
        Criterion::Energy => return None,
    })
}

/// Largest principal nominal strain in each element of a block.
#[inline(always)]
fn strains<const L: usize>(metric: &[Lane<L>; 3]) -> Lane<L> {
    let [c11, c22, c12] = metric;
    lanes(|l| largest([c11[l], c22[l], c12[l]]).sqrt() - 1.0)
}

/// One element of a block.
struct Element<'a, B> {
    block: &'a B,
    /// C₁₁, C₂₂ and C₁₂.
    metric: [f64; 3],
    /// Largest principal nominal strain.
    strain: f64,
    /// The quantity that the criterion compares with its limit, where it is no energy.
    value: Option<f64>,
    lane: usize,
}

impl<B> Element<'_, B> {
    /// Width across the tear, m, where it starts to tear.
    #[inline(always)]
    fn starts<const NODES: usize, const L: usize>(
        &self,
        rupture: &Rupture,
        tear: &Tear,
        beside_open: bool,
    ) -> Option<f64>
    where
        B: Block<NODES, L>,
    {
        let strain = self.strain;
        let value = self.value.unwrap_or(tear.stored + tear.absorbed);
        let reaches = value >= rupture.limit;
        let energy = rupture.fracture_energy;
        // Film beside a tear may be compressed, which does not open it.
        let may_grow = beside_open && energy > 0.0 && strain > 0.0;
        if !reaches && !may_grow {
            return None;
        }
        // Kept from now on: across the largest stretch at this moment, whatever the element does later.
        let width = width_across(&gradients_of(self.block, self.lane), self.metric);
        // Film that stores more than its tear takes tears whatever the film around it does.
        (reaches || tear.stored * width >= energy).then_some(width)
    }
}

/// S C S: its eigenvalues are the squares of the principal nominal stresses.
#[inline(always)]
fn squared_stress([s11, s22, s12]: [f64; 3], [c11, c22, c12]: [f64; 3]) -> [f64; 3] {
    let (a11, a12) = (s11 * c11 + s12 * c12, s11 * c12 + s12 * c22);
    let (a21, a22) = (s12 * c11 + s22 * c12, s12 * c12 + s22 * c22);
    [a11 * s11 + a12 * s12, a21 * s12 + a22 * s22, a11 * s12 + a12 * s22]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn principal_stress_of_a_stretch() {
        // S of a stretch λ along MD, with the engineering stress λ S.
        let (lambda, s) = (1.5, 3e6);
        assert!(
            (largest(squared_stress([s, 0.0, 0.0], [lambda * lambda, 1.0, 0.0])).sqrt() / (lambda * s) - 1.0).abs()
                < 1e-12
        );
    }
}
