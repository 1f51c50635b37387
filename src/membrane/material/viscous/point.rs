//! The history variables of a viscous point, and its stress, energy and stiffness.

use super::{Viscosity, ViscousStep};
use crate::lane::{Lane, larger, smaller, splat};
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
        let (mut before, mut now) = ([splat::<L>(0.0); 3], [splat::<L>(0.0); 3]);
        // Component by component, so that the sums over the terms stay in registers.
        for k in 0..3 {
            [before[k], now[k]] = self.relax(step, &base[k], &mut head[STRESS + k], terms, k);
        }
        if let Some(raised) = self.without_compression(&at, &base, &now) {
            for k in 0..3 {
                let mut change = splat::<L>(0.0);
                for l in 0..L {
                    // The film is longer than its span: by this its own stress is higher.
                    change[l] = (raised[k][l] - now[k][l]) / step.fresh;
                    head[STRESS + k][l] += change[l];
                }
                for ([_, taken], overstress) in step.terms.iter().zip(terms.iter_mut()) {
                    for l in 0..L {
                        overstress[k][l] += taken[l] * change[l];
                    }
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
        base: &Lane<L>,
        own: &mut Lane<L>,
        terms: &mut [[Lane<L>; 3]],
        k: usize,
    ) -> [Lane<L>; 2] {
        let (mut change, mut before, mut now) = (splat::<L>(0.0), splat::<L>(0.0), splat::<L>(0.0));
        for l in 0..L {
            change[l] = base[l] - own[l];
            // The stress before the step is summed again from the variables: storing it would be three more of them a
            // point.
            before[l] = self.long_term * own[l];
            now[l] = self.long_term * base[l];
        }
        *own = *base;
        for ([kept, taken], overstress) in step.terms.iter().zip(terms) {
            let mut overstress_now = splat::<L>(0.0);
            for l in 0..L {
                let old = overstress[k][l];
                // Exact for a stress that changes steadily over the step (theory.md, equation 281), so the step limits
                // accuracy of the loading alone.
                overstress_now[l] = kept[l] * old + taken[l] * change[l];
                before[l] += old;
                now[l] += overstress_now[l];
            }
            overstress[k] = overstress_now;
        }
        [before, now]
    }

    /// The law's stress in its measure, of film strained at once.
    #[inline(always)]
    fn base_stress<const L: usize>(&self, at: &Measured<L>, stress: &Stress<L>) -> Plane<L> {
        let mut base = [stress.tension[0], stress.tension[1], stress.cross];
        for k in 0..3 {
            for l in 0..L {
                base[k][l] *= self.instant * at.scale[k][l];
            }
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
        for l in 0..L {
            let mut work = 0.0;
            for k in 0..2 {
                // Trapezoid in the strains on which this stress does work; halved once at the end.
                work += (before[k][l] + now[k][l]) * (at.strain[k][l] - head[STRAIN + k][l]);
            }
            let inverse = match measure {
                Measure::SecondPiola => 1.0,
                // m₁ m₂ of the last step, from the strains that are stored anyway: shear works on f₁·f₂, whose stress
                // is τ/(m₁ m₂).
                Measure::Fibres => 1.0 / (larger(head[STRAIN][l], 1.0) * larger(head[STRAIN + 1][l], 1.0)),
            };
            let shear = before[2][l] * inverse + now[2][l] * at.inverse[2][l];
            work += shear * (at.strain[2][l] - head[STRAIN + 2][l]);
            head[WORK][l] += 0.5 * work;
        }
        for k in 0..3 {
            head[STRAIN + k] = at.strain[k];
        }
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
        let mut out = *total;
        let mut is_compressed = false;
        for k in 0..2 {
            for l in 0..L {
                // A law that carries some compression itself keeps that much: only what viscosity adds to it is taken.
                let least = smaller(base[k][l], 0.0);
                is_compressed |= least > total[k][l];
                out[k][l] = larger(least, total[k][l]);
            }
        }
        is_compressed.then_some(out)
    }

    /// The stress `total` without compression in any direction, where there is any.
    #[inline(always)]
    fn taut<const L: usize>(&self, at: &Measured<L>, total: &Plane<L>) -> Option<Plane<L>> {
        let s = at.unmeasured(total);
        let (mut mean, mut apart, mut radius) = (splat::<L>(0.0), splat::<L>(0.0), splat::<L>(0.0));
        let mut is_taut = true;
        for l in 0..L {
            mean[l] = 0.5 * (s[0][l] + s[1][l]);
            apart[l] = 0.5 * (s[0][l] - s[1][l]);
            radius[l] = (apart[l] * apart[l] + s[2][l] * s[2][l]).sqrt();
            is_taut &= mean[l] - radius[l] >= 0.0;
        }
        // Film is taut for the most part.
        if is_taut {
            return None;
        }
        let poisson = -self.base.compliance[2] / self.base.compliance[0];
        let mut out = *total;
        for l in 0..L {
            let least = mean[l] - radius[l];
            // Wrinkled film is wider by its compression over the modulus, and carries Poisson's ratio of it along the
            // wrinkles.
            let released = poisson * smaller(least, 0.0);
            let (first, second) = (larger(mean[l] + radius[l] - released, 0.0), larger(least, 0.0));
            let inverse = 1.0 / larger(radius[l], POINT);
            let (cosine, sine) = (apart[l] * inverse, s[2][l] * inverse);
            let (mean_left, apart_left) = (0.5 * (first + second), 0.5 * (first - second));
            let raised = [mean_left + apart_left * cosine, mean_left - apart_left * cosine, apart_left * sine];
            // Taut film keeps its stress to the bit.
            for k in 0..3 {
                let raised = raised[k] * at.scale[k][l];
                out[k][l] = if least >= 0.0 { total[k][l] } else { raised };
            }
        }
        Some(out)
    }

    /// Stress of the point with these history variables, where it is deformed by `d`.
    pub fn stress<const L: usize>(&self, d: &Deformation<L>, variables: &[Lane<L>]) -> Stress<L> {
        Elastic::first_piola(d, self.base.measure.evaluate(d).unmeasured(&self.total(variables)))
    }

    /// (1 − Σg) S° + Σ q, in the measure of the law.
    #[inline(always)]
    fn total<const L: usize>(&self, variables: &[Lane<L>]) -> Plane<L> {
        let mut total = [splat(0.0); 3];
        for k in 0..3 {
            for l in 0..L {
                total[k][l] = self.long_term * variables[STRESS + k][l];
            }
            for overstress in variables[FIRST_TERM..].chunks_exact(3) {
                for l in 0..L {
                    total[k][l] += overstress[k][l];
                }
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
        let own = [0, 1, 2].map(|k| variables[STRESS + k]);
        let (of_base, of_own) = (self.base.complementary(&base), self.base.complementary(&own));
        let mut springs = splat::<L>(0.0);
        for (term, overstress) in self.viscosity.terms.iter().zip(variables[FIRST_TERM..].as_chunks::<3>().0) {
            let spring = self.base.complementary(&overstress);
            for l in 0..L {
                springs[l] += spring[l] / term.share;
            }
        }
        let at_rest = 0.5 * AT_REST * AT_REST * self.instant / self.base.compliance[0];
        let mut out = Energy { stored: splat(0.0), absorbed: splat(0.0) };
        for l in 0..L {
            let law = self.instant * energy.stored[l];
            // The compliance of film strained at once is 1/instant of that of the law, here and in `at_rest`.
            let per_instant = 1.0 / self.instant;
            let ratio = (law + at_rest) / (of_base[l] * per_instant + at_rest) * per_instant;
            out.stored[l] = self.long_term * (law + ratio * (of_own[l] - of_base[l])) + ratio * springs[l];
            out.absorbed[l] = variables[WORK][l] - out.stored[l];
        }
        out
    }

    /// Sets the work of a point up to now, J/m³.
    pub fn set_work<const L: usize>(&self, variables: &mut [Lane<L>], work: &Lane<L>) {
        variables[WORK] = *work;
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
        let (total, base) =
            (at.unmeasured(&self.total(variables)), at.unmeasured(&[0, 1, 2].map(|k| variables[STRESS + k])));
        for l in 0..L {
            let sheared = larger(total[2][l].abs() - base[2][l].abs(), 0.0);
            for fibre in 0..2 {
                let tension = larger(total[fibre][l] - larger(base[fibre][l], 0.0), 0.0);
                stiffness.along[fibre][l] *= self.instant;
                stiffness.across[fibre][l] = stiffness.across[fibre][l] * self.instant + (tension + sheared);
            }
            stiffness.shear[l] *= self.instant;
            stiffness.any[l] *= self.instant;
        }
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
