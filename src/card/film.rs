//! The film of a card, in the terms of other solvers, and its curves with few points, which are straight between them.

use std::f64::consts::PI;

use super::loss::Loss;
use super::target::{System, Target};
use base::diagnostic::Diagnostic;
use membrane::material::{
    Curve, Elastic, Fabric, FibreLaw, FlowRate, Hardening, HyperelasticLaw, Law, Material, OgdenTerm, Plastic,
    Polynomial, RateCurves,
};

/// What a card has terms of.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Terms {
    /// Of Ogden's energy.
    Ogden,
    /// Of relaxation.
    Prony,
}

/// A film to be written.
#[derive(Clone, Debug)]
pub struct Film<'a> {
    /// Its name, in the head and where a card has a name.
    pub name: &'a str,
    /// Its law, density and thickness of one layer.
    pub material: &'a Material,
    /// What it was made from, a line each.
    pub origin: &'a [String],
}

/// How a film is written.
#[derive(Clone, Debug)]
pub struct Request {
    /// The solver.
    pub target: Target,
    /// The system of units.
    pub system: System,
    /// Layers that one element stands for.
    pub layers: u32,
    /// Number of the material, from which those of curves follow.
    pub id: u32,
    /// Strain rate whose curves are written, 1/s; none for those of all rates.
    pub rate: Option<f64>,
    /// Most points of a curve.
    pub points: usize,
    /// Poisson's ratio of incompressible film in elements that need one; none for one that follows from its stress.
    pub poisson: Option<f64>,
    /// Strain from which unloading curves are written; none for the ends of the curves.
    pub unloading_from: Option<f64>,
    /// Angle from the x axis to MD, rad, where a card names the direction.
    pub md_angle: f64,
}

impl Request {
    /// A film of one layer for `target`, with the usual number of points.
    pub fn new(target: Target, system: System) -> Request {
        Request {
            target,
            system,
            layers: 1,
            id: 1,
            rate: None,
            points: 100,
            poisson: None,
            unloading_from: None,
            md_angle: 0.0,
        }
    }

    /// Poisson's ratio of incompressible film: as asked for, or such that the bulk modulus is large beside the stress of film
    /// that is stretched to three times its size in both directions.
    pub(crate) fn poisson_of(&self, law: &HyperelasticLaw) -> f64 {
        /// Largest mean stress over the bulk modulus: solvers' stress is off by about as much.
        const MOST: f64 = 6e-3;
        const STRETCH: f64 = 3.0;
        const RANGE: [f64; 2] = [0.4995, 0.49999];
        self.poisson.unwrap_or_else(|| {
            let nominal = Law::Hyperelastic(law.clone()).virgin_stress([[STRETCH, 0.0, 0.0], [0.0, STRETCH, 0.0]]);
            let mean = 2.0 / 3.0 * STRETCH * nominal[0][0];
            let (bulk, shear) = (mean / MOST, shear_modulus(law));
            ((3.0 * bulk - 2.0 * shear) / (6.0 * bulk + 2.0 * shear)).clamp(RANGE[0], RANGE[1])
        })
    }

    /// The refusal of a law that the target does not have.
    pub(crate) fn no_law(&self, law: &str) -> Diagnostic {
        let refusal = Diagnostic::new(format!("{} has no law for {law}", self.target.name()));
        refusal.hint("write it for another solver, or fit a law that this one has")
    }

    /// Refuses more terms than the target takes.
    pub(crate) fn at_most(&self, most: usize, terms: usize, of: Terms) -> Result<(), Diagnostic> {
        if terms <= most {
            return Ok(());
        }
        let (what, command) = match of {
            Terms::Ogden => ("Ogden's law", "fit rubber"),
            Terms::Prony => ("relaxation", "fit prony"),
        };
        let message = format!("{} takes {most} terms of {what}, not {terms}", self.target.name());
        Err(Diagnostic::new(message).hint(format!("fit fewer terms: `droptower {command}`")))
    }

    /// The terms of an energy as droptower writes Ogden's law, of which the target takes as many as `most`.
    pub(crate) fn ogden(&self, law: &HyperelasticLaw, most: usize) -> Result<Vec<OgdenTerm>, Diagnostic> {
        let terms = ogden_terms(law).ok_or_else(|| self.no_law(energy(law)))?;
        self.at_most(most, terms.len(), Terms::Ogden).map(|()| terms)
    }

    /// The rate that was asked for, within the `range` of the curves; none is refused unless the target takes curves `by_rate`.
    fn rate_within(&self, range: [f64; 2], by_rate: bool) -> Result<Option<f64>, Diagnostic> {
        let [low, high] = range;
        match self.rate {
            Some(rate) if !(low..=high).contains(&rate) => {
                let message = format!("the curves are of {low} to {high} 1/s, not of {rate} 1/s");
                Err(Diagnostic::new(message).hint("name a rate within"))
            }
            None if !by_rate => {
                let target = self.target.name();
                let message =
                    format!("the curves are by strain rate, {low} to {high} 1/s, and {target} takes those of one");
                Err(Diagnostic::new(message).hint(format!("name one: --rate \"{high} 1/s\"")))
            }
            rate => Ok(rate),
        }
    }

    /// The unit vector of MD; along an axis exactly that.
    pub(crate) fn md(&self) -> [f64; 2] {
        let (sin, cos) = self.md_angle.sin_cos();
        [cos, sin].map(|component| if component.abs() < f64::EPSILON { 0.0 } else { component })
    }
}

/// Points of a curve.
pub type Points = Vec<[f64; 2]>;

/// A curve with its rate, 1/s; none where there is one curve of no rate, or of the one that was asked for.
pub(crate) type Rated<C> = (Option<f64>, C);

/// The curves of a fabric, SI: nominal stress over engineering strain, in shear over the angle (rad).
pub(crate) struct FabricCurves {
    /// MD and TD.
    pub(crate) fibres: [Vec<Rated<Sampled>>; 2],
    pub(crate) shear: Sampled,
    /// Largest slopes along MD, along TD and in shear, Pa.
    pub(crate) slopes: [f64; 3],
    /// Strains at which MD and TD fibres break.
    pub(crate) ends: [f64; 2],
    /// Share of the stored energy that is lost on unloading.
    pub(crate) absorption: f64,
}

impl FabricCurves {
    /// Strains along MD, along TD and in shear from which unloading curves are written.
    pub(crate) fn unloading_from(&self, request: &Request) -> [f64; 3] {
        let asked = request.unloading_from.unwrap_or(f64::INFINITY);
        let shear = self.shear.points.last().map_or(0.0, |point| point[0]);
        [self.ends[0].min(asked), self.ends[1].min(asked), shear]
    }

    /// Curves along MD, along TD (of several rates the slowest) and in shear as solvers take them: loading, and unloading from the
    /// strains `from`, where there is absorption. Every piece rises, both have the point from which film unloads, and shear is
    /// written to both sides of zero.
    pub(crate) fn paths(&self, from: [f64; 3], absorption: f64) -> ([Points; 3], Option<[Points; 3]>) {
        let loading = [0, 1, 2].map(|place| {
            let curve = if place == 2 { &self.shear } else { &self.fibres[place][0].1 };
            let points = rising(curve.points.clone());
            if absorption == 0.0 { points } else { with_point(&points, from[place]) }
        });
        let unloading = || [0, 1, 2].map(|place| rising(unloading(&loading[place], from[place], absorption)));
        let unloading = (absorption > 0.0).then(unloading);
        let both_sides = |[md, td, shear]: [Points; 3]| [md, td, odd(&shear)];
        (both_sides(loading), unloading.map(both_sides))
    }
}

/// Curves that stand behind a material, numbered from a hundred times its number on.
pub(crate) struct CurvesBehind {
    pub(crate) text: String,
    last: i64,
    write: WriteCurve,
}

/// Writes a curve by its number and title; abscissas and ordinates are divided by the units.
pub(crate) type WriteCurve = fn(i64, &str, &[[f64; 2]], [f64; 2]) -> String;

impl CurvesBehind {
    pub(crate) fn new(request: &Request, write: WriteCurve) -> CurvesBehind {
        CurvesBehind { text: String::new(), last: 100 * i64::from(request.id), write }
    }

    /// The next number.
    pub(crate) fn number(&mut self) -> i64 {
        self.last += 1;
        self.last
    }

    /// Adds a curve; its number.
    pub(crate) fn add(&mut self, title: &str, points: &[[f64; 2]], units: [f64; 2]) -> i64 {
        let number = self.number();
        self.text += &(self.write)(number, title, points, units);
        number
    }
}

/// A card that is being written.
pub(crate) struct Draft<'a> {
    /// What is written.
    pub(crate) film: &'a Film<'a>,
    /// How.
    pub(crate) request: &'a Request,
    /// What the card does not say of the film so far.
    pub(crate) losses: Vec<Loss>,
}

impl<'a> Draft<'a> {
    /// Density of the film, in the unit of the card.
    pub(crate) fn density(&self) -> f64 {
        self.film.material.density / self.request.system.density()
    }

    /// A stress (Pa) in the unit of the card.
    pub(crate) fn stress(&self, stress: f64) -> f64 {
        stress / self.request.system.stress()
    }

    /// Linear film of a card that knows no wrinkles; none of another law.
    pub(crate) fn linear(&mut self, law: &'a Law) -> Option<&'a Elastic> {
        match law {
            Law::Elastic(elastic) => Some(elastic),
            Law::TensionField(field) => {
                self.losses.push(Loss::Wrinkling);
                Some(&field.0)
            }
            Law::Fabric(_) | Law::RateFabric(_) | Law::Hyperelastic(_) | Law::Plastic(_) => None,
        }
    }

    /// Share of the stress of rubber that stays when it has relaxed, and shear moduli (Pa) and times (s) of what relaxes: solvers
    /// whose moduli are beside the law add both.
    pub(crate) fn relaxation(&self, law: &HyperelasticLaw) -> (f64, Vec<[f64; 2]>) {
        let Some(viscosity) = &self.film.material.viscosity else { return (1.0, vec![]) };
        let instant = viscosity.instant() * shear_modulus(law);
        let moduli = viscosity.terms().iter().map(|term| [instant * term.share, term.time]).collect();
        (viscosity.instant() * viscosity.long_term(), moduli)
    }

    /// What a card of incompressible film loses.
    pub(crate) fn lose_of_rubber(&mut self, law: &HyperelasticLaw) {
        self.losses.push(Loss::Compressible { poisson: self.request.poisson_of(law) });
        self.losses.extend(wrinkles(law).then_some(Loss::Wrinkling));
    }

    /// What a card loses that has neither rupture nor heat.
    pub(crate) fn lose_rupture_and_heat(&mut self) {
        let material = self.film.material;
        self.losses.extend(material.rupture.as_ref().map(|_| Loss::Rupture));
        self.losses.extend(material.thermal.as_ref().map(|_| Loss::Heating));
    }

    /// What a card loses that has neither rupture nor heat nor relaxation.
    pub(crate) fn lose_beside_the_law(&mut self) {
        self.lose_rupture_and_heat();
        self.losses.extend(self.film.material.viscosity.as_ref().map(|_| Loss::Viscosity));
    }

    /// The curves of the film, which must be a fabric; `by_rate` where the target takes several rates.
    pub(crate) fn fabric_curves(&mut self, by_rate: bool) -> Result<FabricCurves, Diagnostic> {
        let request = self.request;
        match &self.film.material.law {
            Law::Fabric(fabric) => {
                let curves = |curve: &Curve| vec![(None, curve.clone())];
                Ok(self.sampled(fabric, [fabric.md(), fabric.td()].map(curves)))
            }
            law @ Law::RateFabric(fabric) => {
                let fibres = [rated(fabric.md(), request, by_rate)?, rated(fabric.td(), request, by_rate)?];
                if let (Some(rate), Some(_)) = (request.rate, law.rates()) {
                    self.losses.push(Loss::Rates { kept: rate });
                }
                Ok(self.sampled(fabric, fibres))
            }
            Law::Elastic(_) | Law::TensionField(_) | Law::Hyperelastic(_) | Law::Plastic(_) => {
                Err(request.no_law("film that is no fabric"))
            }
        }
    }

    fn sampled<F: FibreLaw>(&mut self, fabric: &Fabric<F>, fibres: [Vec<Rated<Curve>>; 2]) -> FabricCurves {
        let most = self.request.points;
        let with_origin = |curve: &Curve| [&[[0.0, 0.0]], curve.points()].concat();
        let thin = |curve: &Curve| thinned(&with_origin(curve), most);
        let slope = |curve: &Curve| {
            let slopes = with_origin(curve);
            slopes.windows(2).map(|ends| (ends[1][1] - ends[0][1]) / (ends[1][0] - ends[0][0])).fold(0.0, f64::max)
        };
        let stiffest = |curves: &[Rated<Curve>]| curves.iter().map(|(_, curve)| slope(curve)).fold(0.0, f64::max);
        let end = |curves: &[Rated<Curve>]| curves.iter().map(|(_, curve)| curve.end()).fold(f64::INFINITY, f64::min);
        let curves = FabricCurves {
            slopes: [stiffest(&fibres[0]), stiffest(&fibres[1]), slope(fabric.shear())],
            ends: [end(&fibres[0]), end(&fibres[1])],
            fibres: fibres.map(|curves| curves.into_iter().map(|(rate, curve)| (rate, thin(&curve))).collect()),
            shear: thin(fabric.shear()),
            absorption: fabric.absorption(),
        };
        self.losses.extend(fabric.has_biaxial().then_some(Loss::BiaxialCoupling));
        self.losses.extend(fabric.breaks_by_layers().then_some(Loss::LayerBreaks));
        let [md, td] = curves.ends;
        self.losses.push(Loss::BreakStrain { md, td });
        let all = curves.fibres.iter().flatten().map(|(_, curve)| curve).chain([&curves.shear]);
        self.losses.extend(sampling(all));
        curves
    }

    /// Flow curves along MD by rate of plastic strain, SI: true stress over plastic strain. `tables`: whether the target has curves
    /// by rate.
    pub(crate) fn flow_curves(&mut self, law: &Plastic, tables: bool) -> Result<Vec<Rated<Sampled>>, Diagnostic> {
        let (request, factor) = (self.request, along_md(law));
        /// Plastic strain up to which Voce's law, which has no end, is written.
        const LAST: f64 = 3.0;
        let of_points = |points: &mut dyn Iterator<Item = [f64; 2]>| {
            let scaled: Vec<[f64; 2]> = points.map(|[p, stress]| [p, factor * stress]).collect();
            thinned(&scaled, request.points)
        };
        let slow = || match law.hardening() {
            Hardening::Table(curve) => of_points(&mut curve.points()),
            Hardening::Voce(_) => of_function(|p| factor * law.hardening().stress(p), LAST, request.points),
        };
        let rate = law.rates().map_or(Ok(None), |range| request.rate_within(range, tables))?;
        let curves = match (law.rate(), rate) {
            (FlowRate::Independent, _) => vec![(None, slow())],
            (FlowRate::Table(table), None) => {
                let above = table.above().map(|(rate, curve)| (Some(rate), of_points(&mut curve.points())));
                std::iter::once((Some(table.lowest()), slow())).chain(above).collect()
            }
            (FlowRate::Table(_), Some(rate)) => {
                self.losses.push(Loss::Rates { kept: rate });
                let end = if law.hardening().end().is_finite() { law.hardening().end() } else { LAST };
                vec![(None, of_function(|p| factor * law.flow_stress(p, rate), end, request.points))]
            }
        };
        self.losses.extend(sampling(curves.iter().map(|(_, curve)| curve)));
        Ok(curves)
    }
}

/// The finding of curves that are off.
fn sampling<'a>(curves: impl Iterator<Item = &'a Sampled>) -> Option<Loss> {
    let (points, error) =
        curves.fold((0, 0.0_f64), |(points, error), curve| (points.max(curve.points.len()), error.max(curve.error)));
    (error > 0.0).then_some(Loss::Sampled { points, error })
}

fn rated(curves: &RateCurves, request: &Request, by_rate: bool) -> Result<Vec<Rated<Curve>>, Diagnostic> {
    let Some(range) = curves.range() else {
        return Ok(curves.curves().into_iter().map(|(_, curve)| (None, curve)).collect());
    };
    Ok(match request.rate_within(range, by_rate)? {
        Some(rate) => vec![(None, curves.curve_at(rate))],
        None => curves.curves().into_iter().map(|(rate, curve)| (Some(rate), curve)).collect(),
    })
}

/// Least rise of a piece of a curve over its first stress: solvers refuse flat ones.
const RISE: f64 = 1e-5;

/// A curve of which every piece rises.
pub(crate) fn rising(mut points: Points) -> Points {
    let first = points.iter().map(|point| point[1]).find(|stress| *stress > 0.0).unwrap_or_default();
    for place in 1..points.len() {
        points[place][1] = points[place][1].max(points[place - 1][1] + RISE * first);
    }
    points
}

/// A curve with a point at `x`, within its pieces.
fn with_point(points: &[[f64; 2]], x: f64) -> Points {
    let place = points.partition_point(|point| point[0] < x);
    let mut points = points.to_vec();
    if points.get(place).is_some_and(|point| point[0] > x) {
        points.insert(place, [x, at(&points, x)]);
    }
    points
}

/// A curve to both sides of zero.
fn odd(points: &[[f64; 2]]) -> Points {
    let negative = points.iter().rev().filter(|point| point[0] > 0.0).map(|[x, y]| [-x, -y]);
    negative.chain(points.iter().copied()).collect()
}

/// Unloading from the strain `from` of a curve by straight pieces: the curve, compressed towards it (theory.md, equation 8).
pub(crate) fn unloading(curve: &[[f64; 2]], from: f64, absorption: f64) -> Points {
    let below = curve.iter().copied().filter(|point| point[0] < from);
    let top = [from, at(curve, from)];
    let moved = below.chain([top]).map(|[strain, stress]| [from - (from - strain) * (1.0 - absorption), stress]);
    let slack = (absorption > 0.0).then_some([0.0, 0.0]);
    slack.into_iter().chain(moved).collect()
}

/// The value of straight pieces at `x`, the last one continued.
pub(crate) fn at(points: &[[f64; 2]], x: f64) -> f64 {
    let place = points.partition_point(|point| point[0] < x).clamp(1, points.len() - 1);
    let ([x0, y0], [x1, y1]) = (points[place - 1], points[place]);
    y0 + (y1 - y0) * (x - x0) / (x1 - x0)
}

/// The energy, of which a target has no law.
pub(crate) fn energy(law: &HyperelasticLaw) -> &'static str {
    match law {
        HyperelasticLaw::Gent(_) => "Gent's energy",
        HyperelasticLaw::CompressibleNeoHookean(_) => "compressible neo-Hookean film",
        HyperelasticLaw::Polynomial(_) | HyperelasticLaw::Ogden(_) => "Yeoh's energy",
    }
}

/// An isotropic incompressible energy in terms of μ and α, as droptower writes Ogden's law, where it is one.
fn ogden_terms(law: &HyperelasticLaw) -> Option<Vec<OgdenTerm>> {
    match law {
        HyperelasticLaw::Ogden(film) => Some(film.energy.terms().to_vec()),
        // ½μ (I₁ − 3) and c₀₁ (I₂ − 3) are the terms of α = 2 and α = −2.
        HyperelasticLaw::Polynomial(film) => {
            let Polynomial { first: [c10, c20, c30], second } = film.energy;
            let terms = [OgdenTerm { mu: 2.0 * c10, alpha: 2.0 }, OgdenTerm { mu: -2.0 * second, alpha: -2.0 }];
            (c20 == 0.0 && c30 == 0.0).then(|| terms.into_iter().filter(|term| term.mu != 0.0).collect())
        }
        HyperelasticLaw::Gent(_) | HyperelasticLaw::CompressibleNeoHookean(_) => None,
    }
}

/// Shear modulus of small strain of incompressible rubber, Pa.
pub(crate) fn shear_modulus(law: &HyperelasticLaw) -> f64 {
    match law {
        HyperelasticLaw::Polynomial(film) => 2.0 * (film.energy.first[0] + film.energy.second),
        HyperelasticLaw::Gent(film) => film.energy.mu,
        HyperelasticLaw::Ogden(film) => film.energy.shear_modulus(),
        HyperelasticLaw::CompressibleNeoHookean(film) => film.energy.young / (2.0 + 2.0 * film.energy.poisson),
    }
}

/// Bulk modulus of film with this shear modulus and Poisson's ratio.
pub(crate) fn bulk_modulus(shear: f64, poisson: f64) -> f64 {
    2.0 * shear * (1.0 + poisson) / (3.0 - 6.0 * poisson)
}

/// Whether rubber carries no compression.
fn wrinkles(law: &HyperelasticLaw) -> bool {
    match law {
        HyperelasticLaw::Polynomial(film) => film.wrinkling,
        HyperelasticLaw::Gent(film) => film.wrinkling,
        HyperelasticLaw::Ogden(film) => film.wrinkling,
        HyperelasticLaw::CompressibleNeoHookean(film) => film.wrinkling,
    }
}

/// Yield stress along MD over that of the hardening.
pub(crate) fn along_md(law: &Plastic) -> f64 {
    law.hill().stress_ratio(0.0)
}

/// The finding that a card has von Mises' yield function, where the film has another.
pub(crate) fn lost_hill(law: &Plastic) -> Option<Loss> {
    let is_isotropic = [0.0, 0.25 * PI, 0.5 * PI].iter().all(|angle| {
        (law.hill().stress_ratio(*angle) - along_md(law)).abs() < 1e-9
            && (law.hill().strain_ratio(*angle) - 1.0).abs() < 1e-9
    });
    (!is_isotropic).then_some(Loss::Hill)
}

/// A curve of straight pieces, and how far it is off.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Sampled {
    /// Abscissa and ordinate.
    pub(crate) points: Vec<[f64; 2]>,
    /// Largest difference from the curve over its largest ordinate.
    pub(crate) error: f64,
}

/// At most `most` ≥ 2 of the `points` of a curve, its ends among them: each in turn is where the pieces so far are
/// farthest off.
pub(crate) fn thinned(points: &[[f64; 2]], most: usize) -> Sampled {
    let largest = points.iter().map(|point| point[1].abs()).fold(f64::MIN_POSITIVE, f64::max);
    let mut kept = vec![0, points.len() - 1];
    loop {
        let (place, off) = farthest(points, &kept);
        if kept.len() >= most.max(2) || off == 0.0 {
            let points = kept.iter().map(|index| points[*index]).collect();
            return Sampled { points, error: off / largest };
        }
        kept.insert(kept.partition_point(|index| *index < place), place);
    }
}

/// The point that is farthest from the pieces between the kept ones, and how far.
fn farthest(points: &[[f64; 2]], kept: &[usize]) -> (usize, f64) {
    let mut farthest = (0, 0.0);
    for ends in kept.windows(2) {
        let ([x, y], [to_x, to_y]) = (points[ends[0]], points[ends[1]]);
        for (index, point) in points.iter().enumerate().take(ends[1]).skip(ends[0] + 1) {
            let off = (y + (to_y - y) * (point[0] - x) / (to_x - x) - point[1]).abs();
            if off > farthest.1 {
                farthest = (index, off);
            }
        }
    }
    farthest
}

/// A smooth curve `f` from zero to `end` by at most `most` points, chosen as [`thinned`] does among many.
pub(crate) fn of_function(f: impl Fn(f64) -> f64, end: f64, most: usize) -> Sampled {
    const FINE: usize = 4000;
    let fine: Vec<[f64; 2]> = (0..=FINE).map(|i| end * i as f64 / FINE as f64).map(|x| [x, f(x)]).collect();
    thinned(&fine, most)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn corners_are_kept_and_points_between_are_not() {
        let corner = [[0.0, 0.0], [0.5, 1.0], [1.0, 2.0], [1.5, 2.0], [2.0, 2.0]];
        let found = thinned(&corner, 100);
        assert_eq!(found, Sampled { points: vec![[0.0, 0.0], [1.0, 2.0], [2.0, 2.0]], error: 0.0 });
        assert_eq!(thinned(&corner, 2).points, [[0.0, 0.0], [2.0, 2.0]]);
        assert!((thinned(&corner, 2).error - 0.5).abs() < 1e-15);
    }

    /// Pieces of a parabola between n + 1 points are off by h²/8 of its second derivative at best.
    #[test]
    fn a_smooth_curve_is_off_by_the_square_of_the_distance() {
        let parabola = |x: f64| x * x;
        let [few, many] = [17, 65].map(|most| of_function(parabola, 1.0, most));
        assert_eq!((few.points.len(), many.points.len()), (17, 65));
        let least = |points: f64| 0.25 / (points - 1.0).powi(2);
        assert!(few.error >= 0.99 * least(17.0) && few.error < 4.5 * least(17.0), "{}", few.error);
        assert!(many.error >= 0.99 * least(65.0) && many.error < 4.5 * least(65.0), "{}", many.error);
    }
}
