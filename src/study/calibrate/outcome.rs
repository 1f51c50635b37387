//! What is known of a drop besides signals: that its film held or broke, when it broke, or the mass at which half of films
//! break (docs/methods.md, equations 335 to 337).
//!
//! The film of such a run does not break. Its largest strains along MD and TD, over the break strains of its curves, are what
//! the drop demands of it, and change smoothly with parameters, which whether film breaks does not. A specimen whose break
//! strain is above the demand along both holds; break strains scatter from specimen to specimen.

use rhai::{Dynamic, Map};
use serde_json::Value;

use crate::post::Run;
use crate::scenario_functions::{Changes, ScenarioHandle};
use crate::script::{HostResult, Options, Session, one_or_several, refuse};
use base::group;
use base::units::{Dimension, Mass, Time};
use lab::signal::Series;
use lab::signal::column::{MAX_STRAIN_MD, MAX_STRAIN_TD};
use membrane::material::Law;
use scene::model::Loading;
use uncertainty::normal;

/// Keys of the break strains along MD and TD, which a parameter of a calibration may have.
pub(super) const BREAK_FACTORS: [&str; 2] =
    ["specimen.material.fabric.md.break_factor", "specimen.material.fabric.td.break_factor"];
/// Break strain, over that of the curves, of film that does not break: no drop strains film to it.
const UNBROKEN: f64 = 10.0;
/// Masses about a failure mass at which film is run, over that mass.
const MASSES: [f64; 2] = [0.9, 1.0 / 0.9];
/// Times about a rupture at which its demand is read, from it, as a share of that time since the run began.
const TIMES: f64 = 0.01;
/// Error of a failure mass, relative, where none is given (assumed).
const USUAL_MASS_ERROR: f64 = 0.05;
/// Least of these that counts.
const LEAST_MASS_ERROR: f64 = 1e-3;
/// Least demand that counts: film that is hardly strained.
const LEAST_DEMAND: f64 = 1e-6;
/// Scatter of the break strain between specimens, relative, where no parameter has one (assumed).
pub(super) const USUAL_SCATTER: f64 = 0.1;
/// Logarithm of the least likelihood of an outcome.
const LEAST: f64 = -1e4;

/// One thing that is known of a test.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Outcome {
    /// The film held.
    Held,
    /// It broke, at a time that is not known.
    Broke,
    /// It broke at this time, known to this error (s).
    RuptureTime { time: f64, error: f64 },
    /// Half of films break under this mass (kg), known to this error, relative.
    FailureMass { mass: f64, error: f64 },
}

/// The outcomes of a test, one a specimen, and the scenario whose film does not break.
#[derive(Clone)]
pub(super) struct Outcomes {
    pub(super) study: ScenarioHandle,
    /// Break strains of the scenario's film over those of its curves, MD and TD.
    pub(super) factors: [f64; 2],
    /// Each with the number of specimens that had it.
    pub(super) all: Vec<(Outcome, usize)>,
}

/// What the outcomes of a test depend on besides its demands: logarithms of the factors on the break strains of MD and TD, and
/// their scatter between specimens.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Breaks {
    pub(super) log_factors: [f64; 2],
    pub(super) scatter: [f64; 2],
}

/// An outcome for a table.
pub(super) struct Described {
    /// What it is called.
    pub(super) outcome: &'static str,
    /// Specimens that had it.
    pub(super) specimens: usize,
    /// How likely it is of one specimen, where it is one of two.
    pub(super) probability: Option<f64>,
    /// A failure mass as it was measured and as it follows (kg).
    pub(super) mass: Option<[f64; 2]>,
    /// Logarithms of what the drop demands of the film along MD and TD, over the break strains of the curves: at its peak, at the
    /// time of rupture or under the failure mass.
    pub(super) demand: [f64; 2],
}

/// A demand at a place and its growth about it: logarithms along MD and TD.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Local {
    below: [f64; 2],
    above: [f64; 2],
}

/// What is known of a test by its options `outcome`, `failure_mass` and `rupture_time`; none where it has none of them.
pub(super) fn read(map: &Map, study: &ScenarioHandle, session: &Session) -> HostResult<Option<Outcomes>> {
    let mut all: Vec<Outcome> = Vec::new();
    let several = |name: &str| match map.get(name).map(one_or_several) {
        Some(list) if list.is_empty() => Err(refuse!("`{name}` is an empty array: what is known of each specimen")),
        list => Ok(list.unwrap_or_default()),
    };
    for one in several("outcome")? {
        all.push(match one.to_string().as_str() {
            "held" => Outcome::Held,
            "broke" => Outcome::Broke,
            other => return Err(refuse!("`outcome` must be \"held\", \"broke\" or an array of them, not \"{other}\"")),
        });
    }
    for one in several("rupture_time")? {
        let (time, error) = with_error(&one, "rupture_time", "time", Time::DIMENSION)?;
        if let Loading::Impact(impact) = &study.model().loading
            && time > impact.duration
        {
            return Err(refuse!(
                "`rupture_time` is {time} s, after the end of the run: `loading.impact.duration` is {} s",
                impact.duration
            ));
        }
        all.push(Outcome::RuptureTime { time, error: error.unwrap_or(0.0) });
    }
    for one in several("failure_mass")? {
        let (mass, error) = with_error(&one, "failure_mass", "mass", Mass::DIMENSION)?;
        all.push(Outcome::FailureMass { mass, error: error.map_or(USUAL_MASS_ERROR, |error| error / mass) });
    }
    if all.is_empty() {
        return Ok(None);
    }
    let (study, factors) = unbroken(study, session)?;
    let counted = group::by_key(all.into_iter().map(|one| (one, ())));
    let all = counted.into_iter().map(|(one, specimens)| (one, specimens.len())).collect();
    Ok(Some(Outcomes { study, factors, all }))
}

/// A quantity above zero, or a map of it and its error, which is not below zero.
fn with_error(
    given: &Dynamic,
    of: &'static str,
    name: &'static str,
    dimension: Dimension,
) -> HostResult<(f64, Option<f64>)> {
    let example = dimension.example;
    let wrong = |given: &Dynamic| -> Box<rhai::EvalAltResult> {
        refuse!("`{of}` must be a string such as \"{example}\" or #{{ {name}: \"{example}\", error: … }}, not {given}")
    };
    let quantity = |value: &Dynamic| -> HostResult<f64> {
        let text = value.clone().into_string().map_err(|_| wrong(value))?;
        dimension.parse(&text).map_err(|error| refuse!("`{of}`: {error}"))
    };
    let (value, error) = match given.read_lock::<Map>().map(|map| map.clone()) {
        None => (quantity(given)?, None),
        Some(map) => {
            Options { of, map: &map }.check(&[name, "error"])?;
            let value = quantity(map.get(name).ok_or_else(|| wrong(given))?)?;
            (value, map.get("error").map(quantity).transpose()?)
        }
    };
    match value > 0.0 && error.is_none_or(|error| error >= 0.0) {
        true => Ok((value, error)),
        false => Err(refuse!("`{of}` and its error are above zero, not {given}")),
    }
}

/// The scenario with film that does not break and without its recording, whose window would end it; and the break strains of its
/// film over those of the curves.
fn unbroken(study: &ScenarioHandle, session: &Session) -> HostResult<(ScenarioHandle, [f64; 2])> {
    let model = study.model();
    if !matches!(model.loading, Loading::Impact(_)) {
        return Err(refuse("`outcome`, `failure_mass` and `rupture_time` are of drop tests: `[loading.impact]`"));
    }
    let not_needed = [("reference", model.reference.is_some()), ("post", model.post.is_some())];
    let unset = not_needed.into_iter().filter(|(_, is_there)| *is_there).map(|(key, _)| (key.to_owned(), Value::Null));
    let own = study.with(unset.collect(), session)?;
    let factors = factors(&own, session)?;
    Ok((own.with(unbreakable(), session)?, factors))
}

/// The keys of film that does not break.
fn unbreakable() -> Changes {
    BREAK_FACTORS.map(|key| (key.to_owned(), Value::from(UNBROKEN))).into()
}

/// The break strains of the film of a scenario along MD and TD over those of its curves.
pub(super) fn factors(study: &ScenarioHandle, session: &Session) -> HostResult<[f64; 2]> {
    let model = study.model();
    for face in &model.faces {
        let missing = match (&face.material.law, &face.material.rupture) {
            (_, Some(_)) => "film with `[rupture]`",
            (Law::Fabric(fabric), None) if fabric.breaks_by_layers() => {
                "layers that break one after another (`break_scatter`)"
            }
            (Law::Fabric(_), None) => continue,
            (Law::RateFabric(_), None) => "break strains that depend on the rate (`rates`)",
            _ => "film without break strains of MD and TD",
        };
        return Err(refuse!(
            "outcomes of {missing} are not supported: they need a `[fabric]` of one curve a direction, whose last strain is \
            its break strain"
        ));
    }
    let longer = study.with(unbreakable(), session)?;
    let [longer, own] = [&longer, study].map(break_strains);
    let factors = [0, 1].map(|along| own[along] / longer[along] * UNBROKEN);
    match factors.iter().all(|factor| *factor < 0.9 * UNBROKEN) {
        true => Ok(factors),
        false => Err(refuse(
            "outcomes need the film in `specimen.material`: layers with a material of their own are not supported",
        )),
    }
}

/// Smallest break strains of all faces along MD and TD.
fn break_strains(study: &ScenarioHandle) -> [f64; 2] {
    let of_faces = |along: usize| study.model().faces.iter().map(move |face| face.material.break_strains()[along]);
    [0, 1].map(|along| of_faces(along).fold(f64::INFINITY, f64::min))
}

impl Outcomes {
    /// The same outcomes with other scenarios, whose film does not break either.
    pub(super) fn with(&self, changes: Changes, session: &Session) -> HostResult<Outcomes> {
        Ok(Outcomes { study: self.study.with(changes, session)?, ..self.clone() })
    }

    /// Whether the largest demand of a run counts.
    fn has_peak(&self) -> bool {
        self.all.iter().any(|(own, _)| matches!(own, Outcome::Held | Outcome::Broke))
    }

    /// How many specimens held, and how many broke.
    pub(super) fn counts(&self) -> [usize; 2] {
        let of = |wanted: Outcome| self.all.iter().filter(|(own, _)| *own == wanted).map(|(_, count)| count).sum();
        [of(Outcome::Held), of(Outcome::Broke)]
    }

    /// Whether the film of all specimens broke.
    pub(super) fn all_broke(&self) -> bool {
        let [held, broke] = self.counts();
        let has_time = self.all.iter().any(|(own, _)| matches!(own, Outcome::RuptureTime { .. }));
        held == 0 && (broke > 0 || has_time)
    }

    /// How many numbers [`Self::residuals`] gives.
    pub(super) fn residual_count(&self) -> usize {
        self.all.iter().map(|(own, _)| if matches!(own, Outcome::RuptureTime { .. }) { 2 } else { 1 }).sum()
    }

    /// How many demands [`Self::run`] gives.
    pub(super) fn numbers(&self) -> usize {
        let local = |(own, _): &&(Outcome, usize)| !matches!(own, Outcome::Held | Outcome::Broke);
        2 * usize::from(self.has_peak()) + 4 * self.all.iter().filter(local).count()
    }

    /// The run of the drop with these values of keys, where outcomes need it or its signals are asked for; and the demands of all
    /// outcomes, logarithms over the break strains of the curves: of this run, MD and TD; then, of each time and mass in order, a
    /// little below and above.
    pub(super) fn run(
        &self,
        changes: Changes,
        has_signals: bool,
        session: &Session,
    ) -> HostResult<(Option<Run>, Vec<f64>)> {
        let study = self.study.with(changes, session)?;
        let needs_run = has_signals || self.all.iter().any(|(own, _)| !matches!(own, Outcome::FailureMass { .. }));
        let whole = if needs_run { Some(study.simulate(session)?) } else { None };
        let run = whole.as_ref().map(|run| History::new(run, &study)).transpose()?;
        let mut found = Vec::new();
        if let Some(run) = run.as_ref().filter(|_| self.has_peak()) {
            found.extend(run.demands(f64::INFINITY));
        }
        for (own, _) in &self.all {
            match own {
                Outcome::Held | Outcome::Broke => {}
                Outcome::RuptureTime { time, .. } => {
                    for factor in [1.0 - TIMES, 1.0 + TIMES] {
                        found.extend(run.iter().flat_map(|run| run.demands(factor * time)));
                    }
                }
                Outcome::FailureMass { mass, .. } => {
                    for factor in MASSES {
                        let heavier = Changes::from([("impactor.mass".to_owned(), Value::from(factor * mass))]);
                        let study = study.with(heavier, session)?;
                        found.extend(History::new(&study.simulate(session)?, &study)?.demands(f64::INFINITY));
                    }
                }
            }
        }
        Ok((whole, found))
    }

    /// Logarithm of the likelihood of all outcomes with these demands and variances of their errors.
    pub(super) fn log_likelihood(&self, demands: &[f64], variances: &[f64], breaks: &Breaks) -> f64 {
        let of_one = |(own, specimens, demand, variance): (&Outcome, usize, Local, Local)| {
            specimens as f64 * own.log_likelihood(demand, variance, breaks)
        };
        self.each(demands, variances).map(of_one).sum()
    }

    /// Residuals of the search, whose squares sum to −2 times these logarithms up to constants. Those of a time are two: how far
    /// the demand is from where half of films break, with its sign, so that they have a slope at the most likely values; and what
    /// is left of the logarithm.
    pub(super) fn residuals(&self, demands: &[f64], breaks: &Breaks) -> Vec<f64> {
        let none = vec![0.0; demands.len()];
        let of_one = |(own, specimens, demand, _): (&Outcome, usize, Local, Local)| {
            let found = own.residuals(demand, breaks).into_iter();
            found.map(move |residual| (specimens as f64).sqrt() * residual)
        };
        self.each(demands, &none).flat_map(of_one).collect()
    }

    /// Each outcome with its demands and their variances.
    fn each<'a>(
        &'a self,
        demands: &'a [f64],
        variances: &'a [f64],
    ) -> impl Iterator<Item = (&'a Outcome, usize, Local, Local)> + 'a {
        let mut next = 2 * usize::from(self.has_peak());
        self.all.iter().map(move |(own, specimens)| {
            let from = match own {
                Outcome::Held | Outcome::Broke => 0,
                _ => {
                    next += 4;
                    next - 4
                }
            };
            let local = |all: &[f64]| match own {
                Outcome::Held | Outcome::Broke => Local { below: [all[0], all[1]], above: [all[0], all[1]] },
                _ => Local { below: [all[from], all[from + 1]], above: [all[from + 2], all[from + 3]] },
            };
            (own, *specimens, local(demands), local(variances))
        })
    }

    /// All outcomes with these demands.
    pub(super) fn described(&self, demands: &[f64], breaks: &Breaks) -> Vec<Described> {
        let none = vec![0.0; demands.len()];
        let of_one = |(own, specimens, demand, variance): (&Outcome, usize, Local, Local)| {
            let probability = || Some(own.log_likelihood(demand, variance, breaks).exp());
            let (outcome, probability, mass) = match own {
                Outcome::Held => ("held", probability(), None),
                Outcome::Broke => ("broke", probability(), None),
                Outcome::RuptureTime { .. } => ("rupture time", None, None),
                Outcome::FailureMass { mass, error } => {
                    let found = FailureMass::new(demand, variance, *error, breaks);
                    ("failure mass", None, Some([*mass, mass * found.logarithm.exp()]))
                }
            };
            Described { outcome, specimens, probability, mass, demand: demand.middle() }
        };
        self.each(demands, &none).map(of_one).collect()
    }
}

impl Local {
    fn middle(&self) -> [f64; 2] {
        [0, 1].map(|along| 0.5 * (self.below[along] + self.above[along]))
    }

    /// Growth of a demand by the logarithm of time.
    fn growth(&self) -> [f64; 2] {
        [0, 1].map(|along| (self.above[along] - self.below[along]) / (2.0 * TIMES))
    }

    /// Deviation of the logarithm of the demand that breaks film, along the direction in which it is nearer to that, where the
    /// time of it has this relative error.
    fn deviation(&self, error: f64, breaks: &Breaks) -> f64 {
        let over = |along: usize| self.middle()[along] - breaks.log_factors[along];
        let along = usize::from(over(1) > over(0));
        breaks.scatter[along].hypot(self.growth()[along] * error)
    }
}

impl Outcome {
    fn log_likelihood(&self, demand: Local, variance: Local, breaks: &Breaks) -> f64 {
        let (middle, variance) = (demand.middle(), variance.middle());
        let deviation = |along: usize, more: f64| (breaks.scatter[along].powi(2) + variance[along] + more).sqrt();
        let standard = |along: usize, deviation: f64| (middle[along] - breaks.log_factors[along]) / deviation;
        let found = match *self {
            Outcome::Held | Outcome::Broke => {
                let z = [0, 1].map(|along| standard(along, deviation(along, 0.0)));
                let holds = log_cumulative(-z[0]) + log_cumulative(-z[1]);
                match *self {
                    Outcome::Held => holds,
                    // Where film hardly ever breaks, 1 − ΠΦ(−z) has no digits left; it is the sum of the two then.
                    _ if holds > -1e-6 => (normal::cumulative(z[0]) + normal::cumulative(z[1])).ln(),
                    _ => (-holds.exp_m1()).ln(),
                }
            }
            Outcome::RuptureTime { time, error } => {
                // Per unit of the logarithm of time, as the growth of a demand is.
                let growth = demand.growth();
                let of_one = |along: usize| {
                    let other = 1 - along;
                    let own = deviation(along, (growth[along] * error / time).powi(2));
                    let density = normal::density(standard(along, own)) * growth[along].max(0.0) / own;
                    density * normal::cumulative(-standard(other, deviation(other, 0.0)))
                };
                (of_one(0) + of_one(1)).ln()
            }
            Outcome::FailureMass { error, .. } => {
                let variance = Local { below: variance, above: variance };
                let found = FailureMass::new(demand, variance, error, breaks);
                -0.5 * (found.logarithm / found.deviation).powi(2) - found.deviation.ln()
            }
        };
        found.max(LEAST)
    }

    /// Residuals of one specimen with exact demands.
    fn residuals(&self, demand: Local, breaks: &Breaks) -> Vec<f64> {
        let exact = Local { below: [0.0; 2], above: [0.0; 2] };
        let square = || 2.0 * (self.largest() - self.log_likelihood(demand, exact, breaks));
        match self {
            Outcome::FailureMass { error, .. } => {
                let found = FailureMass::new(demand, exact, *error, breaks);
                vec![found.logarithm / found.deviation]
            }
            Outcome::RuptureTime { time, error } => {
                let distance = median_demand(demand.middle(), breaks) / demand.deviation(error / time, breaks);
                let left = square() - distance * distance;
                vec![distance, left.max(0.0).sqrt()]
            }
            Outcome::Held | Outcome::Broke => vec![square().max(0.0).sqrt()],
        }
    }

    /// A logarithm of the likelihood that is not exceeded: of a time, that of specimens which are nearly alike.
    fn largest(&self) -> f64 {
        /// Growth of a demand by the logarithm of time, and scatter, at the limit.
        const GROWTH: f64 = 20.0;
        const LEAST_SCATTER: f64 = 0.005;
        match self {
            Outcome::RuptureTime { .. } => (2.0 * normal::density(0.0) * GROWTH / LEAST_SCATTER).ln(),
            _ => 0.0,
        }
    }
}

/// The mass at which half of films break (equation 337).
struct FailureMass {
    /// Logarithm of it over the one that was measured.
    logarithm: f64,
    /// Standard deviation of that logarithm.
    deviation: f64,
}

impl FailureMass {
    /// By the demands below and above the measured mass, with the variances of their errors.
    fn new(demand: Local, variance: Local, error: f64, breaks: &Breaks) -> FailureMass {
        let [below, above] = [demand.below, demand.above].map(|demand| median_demand(demand, breaks));
        // A demand that hardly grows with the mass has no such mass: the limit keeps it finite.
        let growth = ((above - below) / (MASSES[1] / MASSES[0]).ln()).max(0.05);
        let larger = variance.middle()[0].max(variance.middle()[1]);
        FailureMass {
            logarithm: -0.5 * (below + above) / growth,
            deviation: (error.max(LEAST_MASS_ERROR).powi(2) + larger / (growth * growth)).sqrt(),
        }
    }
}

/// Logarithm of the demand over that at which half of films would break: how much smaller both demands would have to be.
fn median_demand(demand: [f64; 2], breaks: &Breaks) -> f64 {
    let holds = |shift: f64| {
        let of_one = |along: usize| {
            log_cumulative((breaks.log_factors[along] + shift - demand[along]) / breaks.scatter[along].max(1e-6))
        };
        of_one(0) + of_one(1)
    };
    let larger = (demand[0] - breaks.log_factors[0]).max(demand[1] - breaks.log_factors[1]);
    let reach = 2.0 * breaks.scatter[0].max(breaks.scatter[1]).max(1e-6);
    let (mut low, mut high) = (larger - reach, larger + reach);
    for _ in 0..50 {
        let middle = 0.5 * (low + high);
        if holds(middle) < 0.5_f64.ln() { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

/// ln Φ(z), by its asymptote where Φ has no digits.
fn log_cumulative(z: f64) -> f64 {
    if z > -30.0 {
        return normal::cumulative(z).ln();
    }
    // Mills' ratio to its third term, off by 15/z⁶.
    let square = z * z;
    -0.5 * square - (-z * std::f64::consts::TAU.sqrt()).ln() + ((3.0 / square - 1.0) / square).ln_1p()
}

/// Largest strains along MD and TD over time, and the break strains of the curves.
struct History {
    strains: [Series; 2],
    breaks: [f64; 2],
}

impl History {
    /// Of a run of a scenario whose film does not break.
    fn new(run: &Run, study: &ScenarioHandle) -> HostResult<History> {
        Ok(History {
            strains: [run.channel(MAX_STRAIN_MD.short)?, run.channel(MAX_STRAIN_TD.short)?],
            breaks: break_strains(study).map(|strain| strain / UNBROKEN),
        })
    }

    /// Logarithms of the demands up to a time.
    fn demands(&self, time: f64) -> [f64; 2] {
        [0, 1].map(|along| {
            let strains = &self.strains[along];
            let before = strains.samples().take_while(|[own, _]| *own <= time).map(|[_, strain]| strain);
            let largest = before.fold(strains.value_at(time).unwrap_or(0.0), f64::max);
            (largest.max(LEAST_DEMAND) / self.breaks[along]).ln()
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn local(md: f64, td: f64) -> Local {
        Local { below: [md, td], above: [md, td] }
    }

    const NONE: Local = Local { below: [0.0; 2], above: [0.0; 2] };

    /// Film that holds with half along MD and nearly always along TD; both outcomes have all of the probability.
    #[test]
    fn holding_and_breaking_are_all_there_is() {
        let breaks = Breaks { log_factors: [0.2, 0.0], scatter: [0.1, 0.3] };
        let of = |own: Outcome, demand| own.log_likelihood(demand, NONE, &breaks).exp();
        assert!((of(Outcome::Held, local(0.2, -5.0)) - 0.5).abs() < 1e-9);
        for (md, td) in [(0.2, 0.0), (0.1, 0.4), (-3.0, -4.0), (2.0, 1.0)] {
            let sum = of(Outcome::Held, local(md, td)) + of(Outcome::Broke, local(md, td));
            assert!((sum - 1.0).abs() < 1e-9, "{md} {td}: {sum}");
        }
        // By hand: Φ(−1) Φ(−0.5) along (0.3 − 0.2)/0.1 and 0.15/0.3.
        let expected = normal::cumulative(-1.0) * normal::cumulative(-0.5);
        assert!((of(Outcome::Held, local(0.3, 0.15)) - expected).abs() < 1e-12);
        // An error of the demand widens the scatter.
        let wide = Outcome::Held.log_likelihood(local(0.3, -9.0), local(0.03, 0.0), &breaks).exp();
        assert!((wide - normal::cumulative(-0.5)).abs() < 1e-9);
    }

    /// Densities of the time of rupture and the probability that film holds to the end sum to one: demands that grow with the
    /// logarithm of time by 2 along MD and 3 along TD.
    #[test]
    fn the_density_of_the_time_of_rupture_is_one_with_that_of_holding() {
        let breaks = Breaks { log_factors: [0.0, 0.1], scatter: [0.15, 0.2] };
        let demand = |logarithm: f64| [2.0 * logarithm, 3.0 * logarithm];
        let (from, to, steps) = (-1.5, 0.06, 4000);
        let width = (to - from) / f64::from(steps);
        let mut sum = 0.0;
        for step in 0..steps {
            let middle = from + (f64::from(step) + 0.5) * width;
            let own = Local { below: demand(middle - TIMES), above: demand(middle + TIMES) };
            sum += width * Outcome::RuptureTime { time: 1.0, error: 0.0 }.log_likelihood(own, NONE, &breaks).exp();
        }
        let [md, td] = demand(to);
        let holds = Outcome::Held.log_likelihood(local(md, td), NONE, &breaks).exp();
        assert!((sum + holds - 1.0).abs() < 1e-3, "{sum} {holds}");
    }

    /// Demands that grow as mass to the power of 0.5: a film at twice the median demand breaks under a quarter of the mass.
    #[test]
    fn the_failure_mass_is_where_half_of_films_break() {
        let breaks = Breaks { log_factors: [0.0, 5.0], scatter: [0.1, 0.1] };
        let demand = |factor: f64| [(2.0_f64).ln() + 0.5 * factor.ln(), -3.0];
        let local = Local { below: demand(MASSES[0]), above: demand(MASSES[1]) };
        let found = FailureMass::new(local, NONE, 0.1, &breaks);
        assert!((found.logarithm - 0.25_f64.ln()).abs() < 1e-6 && (found.deviation - 0.1).abs() < 1e-12);
        // Errors of 0.03 of the demands, which grow by 0.5: 0.06 of the mass beside 0.1 of the staircase.
        let uncertain = Local { below: [9e-4; 2], above: [9e-4; 2] };
        let of = |variance| Outcome::FailureMass { mass: 1.0, error: 0.1 }.log_likelihood(local, variance, &breaks);
        let wide = 0.01_f64 + 0.0036;
        let expected = -0.5 * 0.25_f64.ln().powi(2) * (1.0 / wide - 1.0 / 0.01) - 0.5 * (wide / 0.01).ln();
        assert!((of(uncertain) - of(NONE) - expected).abs() < 1e-4, "{}", of(uncertain) - of(NONE));
    }

    /// A time of rupture: the squares of its residuals are −2 ln p up to a constant, and the first has a slope where it is most
    /// likely, that of a normal measurement of the break strain.
    #[test]
    fn the_residuals_of_a_time_of_rupture_have_its_likelihood_and_a_slope() {
        let outcome = Outcome::RuptureTime { time: 0.04, error: 0.0 };
        let demand = [-TIMES, TIMES].map(|shift| [1.5 * shift, -9.0]);
        let own = Local { below: demand[0], above: demand[1] };
        let at = |log_factor: f64, scatter: f64| {
            let breaks = Breaks { log_factors: [log_factor, 0.0], scatter: [scatter, 0.1] };
            let found = outcome.residuals(own, &breaks);
            assert_eq!(found.len(), 2);
            (found[0], found[0] * found[0] + found[1] * found[1])
        };
        assert!(at(0.0, 0.1).0.abs() < 1e-6);
        let slope = (at(0.001, 0.1).0 - at(-0.001, 0.1).0) / 0.002;
        assert!((slope + 10.0).abs() < 0.01, "{slope}");
        // −2 ln p of a normal density: z² + 2 ln(√(2π) s/g) + 2 c.
        for (log_factor, scatter) in [(0.0, 0.1), (0.15, 0.1), (-0.3, 0.2)] {
            let (distance, square) = at(log_factor, scatter);
            let z: f64 = -log_factor / scatter;
            let expected = z * z + 2.0 * (outcome.largest() - (normal::density(0.0) * 1.5 / scatter).ln());
            assert!((square - expected).abs() < 1e-6 * expected && (distance - z).abs() < 1e-6, "{square} {expected}");
            assert!(square > distance * distance);
            let breaks = Breaks { log_factors: [log_factor, 0.0], scatter: [scatter, 0.1] };
            assert!((square / 2.0 + outcome.log_likelihood(own, NONE, &breaks) - outcome.largest()).abs() < 1e-9);
        }
    }

    #[test]
    fn the_logarithm_of_a_small_probability_goes_on() {
        // d ln Φ/dz is −z to 1/z² far out; on both sides of the change of formula.
        let slope = (log_cumulative(-29.999) - log_cumulative(-30.001)) / 0.002;
        assert!((slope - 30.0333).abs() < 2e-4, "{slope}");
        // Abramowitz and Stegun, equation 26.2.12, with one more term.
        let square = 2500.0_f64;
        let series = 1.0 - 1.0 / square + 3.0 / square.powi(2) - 15.0 / square.powi(3);
        let expected = -0.5 * square - (50.0 * std::f64::consts::TAU.sqrt()).ln() + series.ln();
        assert!((log_cumulative(-50.0) - expected).abs() < 1e-6);
    }
}
