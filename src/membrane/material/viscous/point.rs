//! The history variables of a viscous point, and its stress, energy and stiffness.

use super::{Viscosity, ViscousStep};
use crate::lane::{Lane, splat};
use crate::material::elastic::{Elastic, Plane};
use crate::material::measure::{Measure, Measured, ViscousBase, WithoutCompression};
use crate::material::{Deformation, Energy, Stiffness, Stress};

/// Places of the history variables: instantaneous stress (3), strain (3), work; those of the terms follow, three each.
const STRESS: usize = 0;
const STRAIN: usize = 3;
const WORK: usize = 6;
pub(super) const FIRST_TERM: usize = 7;

/// Stress below which the compliance is that at rest, over the modulus.
const AT_REST: f64 = 1e-9;

/// Radius of Mohr's circle below which stress has no direction, Pa: far below round-off of a stress.
const POINT: f64 = 1e-100;

/// The instantaneous stress of a point.
#[inline(always)]
fn own<const L: usize>(variables: &[Lane<L>]) -> Plane<L> {
    [variables[STRESS], variables[STRESS + 1], variables[STRESS + 2]]
}

/// A Prony series on a law.
#[derive(Clone, Debug, PartialEq)]
pub struct ViscousLaw {
    /// The series.
    pub viscosity: Viscosity,
    base: ViscousBase,
    /// [`Viscosity::instant`], [`Viscosity::long_term`].
    instant: f64,
    long_term: f64,
}

impl ViscousLaw {
    /// `viscosity` on a law that states `base` of itself.
    pub fn new(viscosity: Viscosity, base: ViscousBase) -> ViscousLaw {
        let (instant, long_term) = (viscosity.instant(), viscosity.long_term());
        ViscousLaw { viscosity, base, instant, long_term }
    }

    /// Sets the history variables of a point to those of virgin film.
    pub fn reset<const L: usize>(&self, variables: &mut [Lane<L>]) {
        variables.fill(splat(0.0));
        for (variable, strain) in variables[STRAIN..WORK].iter_mut().zip(self.base.measure.undeformed()) {
            *variable = splat(strain);
        }
    }

    /// Replaces the `stress` of the law at deformation `d` by that of viscous film after `step`, and updates the
    /// history variables (theory.md, equations 280 to 284). `measure` is that of the law, for the compiler to know.
    #[inline(always)]
    pub fn advance<const L: usize>(
        &self,
        measure: Measure,
        step: &ViscousStep<L>,
        d: &Deformation<L>,
        stress: &mut Stress<L>,
        variables: &mut [Lane<L>],
    ) {
        let at = measure.evaluate(d);
        let base = self.base_stress(&at, stress);
        // Fixed sizes for the compiler, which then drops the bounds checks of the innermost loops.
        let Some((head, terms)) = variables.split_first_chunk_mut::<FIRST_TERM>() else { return };
        let (terms, _) = terms.as_chunks_mut::<3>();
        let [mut before, mut now] = [[splat(0.0); 3]; 2];
        // Component by component, so that the sums over the terms stay in registers.
        for k in 0..3 {
            [before[k], now[k]] = self.relax(step, base[k], &mut head[STRESS + k], terms, k);
        }
        if let Some(raised) = self.without_compression(&at, &base, &now) {
            for k in 0..3 {
                // The film is longer than its span: by this its own stress is higher.
                let change = (raised[k] - now[k]) / step.fresh;
                head[STRESS + k] += change;
                for (&[_, taken], overstress) in step.terms.iter().zip(terms.iter_mut()) {
                    overstress[k] += taken * change;
                }
            }
            now = raised;
        }
        self.work(measure, &at, &before, &now, head);
        *stress = Elastic::first_piola(d, at.unmeasured(&now));
    }

    /// Component `k` of the total stress before and after a step in which that of the law changes from `own`, its
    /// history variable, to `base`.
    #[inline(always)]
    fn relax<const L: usize>(
        &self,
        step: &ViscousStep<L>,
        base: Lane<L>,
        own: &mut Lane<L>,
        terms: &mut [[Lane<L>; 3]],
        k: usize,
    ) -> [Lane<L>; 2] {
        let change = base - *own;
        // The stress before the step is summed again from the variables: storing it would be three more of them a point.
        let mut before = self.long_term * *own;
        let mut now = self.long_term * base;
        *own = base;
        for (&[kept, taken], overstress) in step.terms.iter().zip(terms) {
            before += overstress[k];
            // Exact for a stress that changes steadily over the step (theory.md, equation 281), so the step limits
            // accuracy of the loading alone.
            overstress[k] = kept * overstress[k] + taken * change;
            now += overstress[k];
        }
        [before, now]
    }

    /// The law's stress in its measure, of film strained at once.
    #[inline(always)]
    fn base_stress<const L: usize>(&self, at: &Measured<L>, stress: &Stress<L>) -> Plane<L> {
        let mut base = [stress.tension[0], stress.tension[1], stress.cross];
        for k in 0..3 {
            base[k] *= self.instant * at.scale[k];
        }
        base
    }

    /// Adds the work of a step over which the stress changed from `before` to `now`, and stores the strain.
    #[inline(always)]
    fn work<const L: usize>(
        &self,
        measure: Measure,
        at: &Measured<L>,
        before: &Plane<L>,
        now: &Plane<L>,
        head: &mut [Lane<L>; FIRST_TERM],
    ) {
        let inverse = match measure {
            Measure::SecondPiola => splat(1.0),
            // m₁ m₂ of the last step, from the strains that are stored anyway: shear works on f₁·f₂, whose stress is
            // τ/(m₁ m₂).
            Measure::Fibres => 1.0 / (head[STRAIN].max(1.0) * head[STRAIN + 1].max(1.0)),
        };
        // Trapezoid in the strains on which this stress does work; halved once at the end.
        let along = (before[0] + now[0]) * (at.strain[0] - head[STRAIN]);
        let across = (before[1] + now[1]) * (at.strain[1] - head[STRAIN + 1]);
        let shear = before[2] * inverse + now[2] * at.inverse[2];
        head[WORK] += 0.5 * (along + across + shear * (at.strain[2] - head[STRAIN + 2]));
        head[STRAIN..WORK].copy_from_slice(&at.strain);
    }

    /// The stress `total` without what compression the law `base` does not carry, where it has any in a lane.
    #[inline(always)]
    fn without_compression<const L: usize>(
        &self,
        at: &Measured<L>,
        base: &Plane<L>,
        total: &Plane<L>,
    ) -> Option<Plane<L>> {
        match self.base.compression {
            WithoutCompression::Carried => None,
            WithoutCompression::Fibres => Self::without_compressed_fibres(base, total),
            WithoutCompression::AnyDirection => self.taut(at, total),
        }
    }

    /// The stress `total` with no more compression of a fibre than `base`, where a fibre has more.
    #[inline(always)]
    fn without_compressed_fibres<const L: usize>(base: &Plane<L>, total: &Plane<L>) -> Option<Plane<L>> {
        // A law that carries some compression itself keeps that much: only what viscosity adds to it is taken.
        let [md, td] = [base[0].min(0.0), base[1].min(0.0)];
        let is_compressed = md.above(total[0]) | td.above(total[1]);
        is_compressed.any().then_some([md.max(total[0]), td.max(total[1]), total[2]])
    }

    /// The stress `total` without compression in any direction, where there is any.
    #[inline(always)]
    fn taut<const L: usize>(&self, at: &Measured<L>, total: &Plane<L>) -> Option<Plane<L>> {
        let s = at.unmeasured(total);
        let (mean, apart) = (0.5 * (s[0] + s[1]), 0.5 * (s[0] - s[1]));
        let radius = (apart * apart + s[2] * s[2]).sqrt();
        let least = mean - radius;
        let is_taut = least.at_least(0.0);
        // Film is taut for the most part.
        if is_taut.all() {
            return None;
        }
        let poisson = -self.base.compliance[2] / self.base.compliance[0];
        // Wrinkled film is wider by its compression over the modulus, and carries Poisson's ratio of it along the
        // wrinkles.
        let released = poisson * least.min(0.0);
        let (first, second) = ((mean + radius - released).max(0.0), least.max(0.0));
        let inverse = 1.0 / radius.max(POINT);
        let (cosine, sine) = (apart * inverse, s[2] * inverse);
        let (mean, apart) = (0.5 * (first + second), 0.5 * (first - second));
        let mut raised = [mean + apart * cosine, mean - apart * cosine, apart * sine];
        // Taut film keeps its stress to the bit.
        for k in 0..3 {
            raised[k] = is_taut.select(total[k], raised[k] * at.scale[k]);
        }
        Some(raised)
    }

    /// Stress of the point with these history variables, where it is deformed by `d`.
    pub fn stress<const L: usize>(&self, d: &Deformation<L>, variables: &[Lane<L>]) -> Stress<L> {
        Elastic::first_piola(d, self.base.measure.evaluate(d).unmeasured(&self.total(variables)))
    }

    /// (1 − Σg) S° + Σ q, in the measure of the law.
    #[inline(always)]
    fn total<const L: usize>(&self, variables: &[Lane<L>]) -> Plane<L> {
        let mut total = own(variables);
        for k in 0..3 {
            total[k] *= self.long_term;
            for overstress in variables[FIRST_TERM..].as_chunks::<3>().0 {
                total[k] += overstress[k];
            }
        }
        total
    }

    /// Energy of viscous film, where the law has `stress` and `energy` at deformation `d` (theory.md, equations 285,
    /// 286).
    #[inline(always)]
    pub fn energy<const L: usize>(
        &self,
        d: &Deformation<L>,
        stress: &Stress<L>,
        energy: &Energy<L>,
        variables: &[Lane<L>],
    ) -> Energy<L> {
        let base = self.base_stress(&self.base.measure.evaluate(d), stress);
        let (of_base, of_own) = (self.base.complementary(&base), self.base.complementary(&own(variables)));
        let mut springs = splat(0.0);
        for (term, overstress) in self.viscosity.terms.iter().zip(variables[FIRST_TERM..].as_chunks::<3>().0) {
            springs += self.base.complementary(overstress) / term.share;
        }
        let law = self.instant * energy.stored;
        // The compliance of film strained at once is 1/instant of that of the law.
        let per_instant = 1.0 / self.instant;
        let at_rest = 0.5 * AT_REST * AT_REST * self.instant / self.base.compliance[0];
        let ratio = (law + at_rest) / (of_base * per_instant + at_rest) * per_instant;
        let stored = self.long_term * (law + ratio * (of_own - of_base)) + ratio * springs;
        Energy { stored, absorbed: variables[WORK] - stored }
    }

    /// Sets the work of a point up to now, J/m³.
    pub fn set_work<const L: usize>(&self, variables: &mut [Lane<L>], work: Lane<L>) {
        variables[WORK] = work;
    }

    /// Instantaneous energy over that of the law as written.
    pub fn instant(&self) -> f64 {
        self.instant
    }

    /// Bound on the stiffness of viscous film, where that of the law is `stiffness` (theory.md, equation 288).
    #[inline(always)]
    pub fn stiffness<const L: usize>(
        &self,
        d: &Deformation<L>,
        mut stiffness: Stiffness<L>,
        variables: &[Lane<L>],
    ) -> Stiffness<L> {
        let at = self.base.measure.evaluate(d);
        let (total, base) = (at.unmeasured(&self.total(variables)), at.unmeasured(&own(variables)));
        let sheared = (total[2].abs() - base[2].abs()).max(0.0);
        for fibre in 0..2 {
            let tension = (total[fibre] - base[fibre].max(0.0)).max(0.0);
            stiffness.along[fibre] *= self.instant;
            stiffness.across[fibre] = stiffness.across[fibre] * self.instant + (tension + sheared);
        }
        stiffness.shear *= self.instant;
        stiffness.any *= self.instant;
        stiffness
    }

    /// Takes from the point in a lane what the fibres that broke carried, where the shares of the layers whose MD and
    /// TD fibres are not broken fell from `before` to `left`.
    pub fn break_fibres<const L: usize>(
        &self,
        variables: &mut [Lane<L>],
        lane: usize,
        before: [f64; 2],
        left: [f64; 2],
    ) {
        let both = |[md, td]: [f64; 2]| [md, td, md.min(td)];
        let carried = both(left).into_iter().zip(both(before));
        // The variables are those of the layers that were left before.
        let shares = carried.map(|(left, before)| if before > 0.0 { left / before } else { 0.0 });
        for (k, share) in shares.enumerate() {
            for first in std::iter::once(STRESS).chain((FIRST_TERM..variables.len()).step_by(3)) {
                variables[first + k][lane] *= share;
            }
        }
    }
}
