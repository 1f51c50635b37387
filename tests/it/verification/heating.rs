//! Film that warms up by what it absorbs, and softens by it.

use droptower::model::Model;
use droptower::simulate::{self, Across};

use super::claims::Claims;
use super::solve::zero;
use super::tower::{channel, run, shipped};

/// The printed points of the paper's Table 4: strain, stress (Pa).
const MD: [[f64; 2]; 4] = [[0.0, 0.0], [0.26, 8.4e6], [0.84, 20e6], [1.39, 29.3e6]];
/// kg/m³, J/(kg K) and 1/K: more softening than any film has.
const DENSITY: f64 = 915.0;
const CAPACITY: f64 = 2300.0;
const SOFTENING: f64 = 0.06;
const THERMAL: &str = "specimen.material.thermal={ heat = \"2.3 kJ/(kg K)\", softening = \"6 %/K\" }";

/// Stress (Pa) and energy density (J/m³) of straight lines between the points of MD.
fn md(strain: f64) -> [f64; 2] {
    let mut energy = 0.0;
    for points in MD.windows(2) {
        let ([e, s], [end, last]) = (points[0], points[1]);
        let to = strain.min(end);
        let stress = s + (last - s) * (to - e) / (end - e);
        energy += 0.5 * (s + stress) * (to - e);
        if strain <= end {
            return [stress, energy];
        }
    }
    panic!("{strain} is past the break");
}

/// Share of the stress that film has left after work W of its law, J/m³, of which the share D is absorbed: with
/// β = softening/(density × capacity), β W = 1/a − a^((1 − D)/D) (theory.md, equation 359), by bisection.
fn left(work: f64, absorption: f64) -> f64 {
    let beta = SOFTENING / (DENSITY * CAPACITY);
    zero(1e-6, 1.0, |a| beta * work - 1.0 / a + a.powf((1.0 - absorption) / absorption))
}

fn coupon(absorption: f64, changes: &[&str]) -> Model {
    let absorption = format!("specimen.material.fabric.absorption={absorption}");
    shipped("stretch/md-0.2.toml", &[&[THERMAL, &absorption, "loading.stretch.until=1.38"], changes].concat())
}

#[test]
fn a_coupon_softens_by_its_own_heat() {
    let mut claims = Claims::of("heating, coupon");
    for absorption in [0.3, 0.8896, 0.999] {
        let what = |claim: &str| format!("D {absorption}, {claim}");
        let model = coupon(absorption, &[]);
        let outcome = run(&model);
        let [strain, stress] = ["strain", "stress_Pa"].map(|name| channel(&outcome.signals, name));
        let expected = |strain: f64| {
            let [stress, work] = md(strain);
            stress * left(work, absorption)
        };
        let off = strain.iter().zip(stress).filter(|(strain, _)| **strain > 0.01);
        let off = off.map(|(strain, stress)| (stress / expected(*strain) - 1.0).abs()).fold(0.0, f64::max);
        claims.at_most(&what("stress off the closed form"), off, 1e-3);
        let last = strain[strain.len() - 1];
        let rise = -left(md(last)[1], absorption).ln() / SOFTENING;
        claims.near(&what("rise of the temperature, K"), outcome.warming.expect("film that warms up"), rise, 1e-3);
        claims.at_most(&what("energy balance error"), outcome.energy_balance_error, 1e-3);
        let strains: Vec<f64> = (1..=13).map(|i| 0.1 * f64::from(i)).collect();
        let pulled = simulate::pull(&model, &strains, Across::Held).expect("a coupon");
        let off = strains.iter().zip(pulled).map(|(strain, stress)| (stress / expected(*strain) - 1.0).abs());
        claims.at_most(&what("one element pulled, off the closed form"), off.fold(0.0, f64::max), 1e-3);
    }
}

/// Plastic film of the flow stress σ absorbs all work but the elastic share of the first per cent: a = 1/(1 + β σ p).
#[test]
fn plastic_film_softens_by_its_plastic_work() {
    let mut claims = Claims::of("heating, plastic");
    let plastic = "specimen.material={ density = 915, thickness = \"12 um\", plastic = { young = \"4 GPa\", poisson = 0.4, \
                   hardening = { voce = { yield = \"20 MPa\", saturation = \"20.0001 MPa\", rate = 1 } } } }";
    let keys = [plastic, THERMAL, "loading.stretch.until=1.0"];
    let model = shipped("stretch/md-0.2.toml", &keys);
    let strains = [0.1, 0.3, 0.6, 1.0];
    let pulled = simulate::pull(&model, &strains, Across::Free).expect("a coupon");
    for (strain, stress) in strains.iter().zip(pulled) {
        // Nominal stress of a strip that keeps its volume, but for its elastic strain.
        let beta = SOFTENING / (DENSITY * CAPACITY);
        let expected = 20e6 / (1.0 + beta * 20e6 * (1.0 + strain).ln()) / (1.0 + strain);
        claims.near(&format!("nominal stress at {strain}, Pa"), stress, expected, 5e-3);
    }
}

/// A drop on film of both fibre sets, on viscous film, and on film that tears: energies balance, and film that does not soften
/// has the motion of film that keeps its temperature.
#[test]
fn drops_on_film_that_warms_up_balance() {
    let mut claims = Claims::of("heating, drops");
    let coarse = [thorough::choose("specimen.mesh.size=40mm", "specimen.mesh.size=20mm")];
    let mild = "specimen.material.thermal={ heat = \"2.3 kJ/(kg K)\", softening = \"0 %/K\" }";
    let prony = "specimen.material.prony=[{ share = 0.3, time = \"1 ms\" }, { share = 0.2, time = \"20 ms\" }]";
    let torn = "specimen.material.rupture={ criterion = \"strain\", limit = 0.45, energy = \"20 kJ/m2\" }";
    let cold = run(&shipped("drop/1008.toml", &coarse));
    let peak = |outcome: &simulate::Outcome| {
        channel(&outcome.signals, "acceleration_m_s2").iter().copied().fold(f64::NEG_INFINITY, f64::max)
    };
    let dry = run(&shipped("drop/1008.toml", &[&coarse[..], &[mild]].concat()));
    claims.holds("without softening: the same bits", "", dry.signals.channels == cold.signals.channels);
    claims.holds("it warms up", &format!("{:?} K", dry.warming), dry.warming.is_some_and(|rise| rise > 2.0));
    let few = run(&shipped("drop/1008.toml", &[&coarse[..], &[mild, "output.frames=1"]].concat()));
    claims.holds("by as much whatever states are kept", &format!("{:?} K", few.warming), few.warming == dry.warming);
    let films = [("fabric", &[][..]), ("viscous", &[prony]), ("tearing", &[torn, "specimen.symmetry=none"])];
    for (name, changes) in thorough::first(2, films) {
        let keys = [&coarse[..], changes].concat();
        let warm = run(&shipped("drop/1008.toml", &[&keys[..], &[THERMAL]].concat()));
        let own = (!changes.is_empty()).then(|| run(&shipped("drop/1008.toml", &keys)));
        let cold = own.as_ref().unwrap_or(&cold);
        claims.at_most(&format!("{name}, energy balance error"), warm.energy_balance_error, 2e-3);
        let [soft, hard] = [&warm, cold].map(peak);
        // 6 %/K and 2 K or more.
        let claim = format!("{name}, peak over that of the same film that keeps its temperature");
        claims.at_most(&claim, soft / hard, 0.9);
    }
}
