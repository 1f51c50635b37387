//! Film that yields: load cycles of single elements by hand, coupons of aluminium beside their recordings, and the set that a dart
//! leaves.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

use droptower::experiment::coupon::Curve;
use droptower::material::{Elastic, FlowCurve, FlowRate, Hardening, Hill, Law, Material, Plastic};
use droptower::model::Model;
use droptower::signal::file::{self, ReadOptions};
use droptower::simulate::{self, Across};

use super::claims::Claims;
use super::random::Random;
use super::scene::{forces, mounted, nominal, positions, set_positions};
use super::sheet::{self, ELEMENTS, THICKNESS, distorted_element};
use super::solve::zero;
use super::tower::{channel, run, shipped, written};
use crate::workbench::root;

const YOUNG: f64 = 2e8;
const POISSON: f64 = 0.45;

/// Film of the reference: r₀ = r₉₀, so that film at 45° does not shear.
fn hill() -> Hill {
    Hill::from_strain_ratios([0.7, 1.6, 0.7])
}

fn hardening() -> Hardening {
    Hardening::Table(FlowCurve::new(&[[0.0, 8e6], [0.05, 10e6], [0.5, 20e6]]).expect("a flow curve"))
}

fn material() -> Material {
    let elastic = Elastic { young: YOUNG, poisson: POISSON };
    let law = Plastic::new(elastic, hill(), hardening(), FlowRate::Independent);
    Material { law: Law::Plastic(law), ..sheet::elastic(1.0, 0.0) }
}

/// Uniaxial tension and compression at an angle from MD, by hand: T = Y (E − E_p), |T| ≤ R σ_y(p), dp = R |dE_p|.
struct Strip {
    ratio: f64,
    /// Plastic strain ratio, width over thickness.
    width: f64,
    plastic: f64,
    p: f64,
}

impl Strip {
    fn at(hill: &Hill, angle: f64) -> Strip {
        Strip { ratio: hill.stress_ratio(angle), width: hill.strain_ratio(angle), plastic: 0.0, p: 0.0 }
    }

    /// T and the strain across at the logarithmic strain `along`.
    fn pulled(&mut self, along: f64) -> [f64; 2] {
        let trial = YOUNG * (along - self.plastic);
        let flow = |growth: f64| self.ratio * hardening().stress(self.p + self.ratio * growth);
        let beyond = |growth: f64| flow(growth) - (trial.abs() - YOUNG * growth);
        let growth = zero(0.0, along.abs() + self.plastic.abs(), beyond);
        let growth = if growth < 1e-15 { 0.0 } else { growth };
        self.plastic += growth * trial.signum();
        self.p += self.ratio * growth;
        let stress = YOUNG * (along - self.plastic);
        [stress, -POISSON * stress / YOUNG - self.plastic * self.width / (1.0 + self.width)]
    }
}

/// Logarithmic strains of a cycle: yield, unloading, yield in compression, and farther than before.
const CYCLE: [f64; 10] = [0.02, 0.06, 0.2, 0.18, 0.12, 0.05, 0.0, 0.1, 0.22, 0.35];

/// A distorted element of each kind, MD along x, through the cycle along MD and along TD: P = T/λ.
#[test]
fn an_element_follows_a_load_cycle_by_hand() {
    let mut claims = Claims::of("plastic, one element");
    for (name, axis) in [("MD", 0), ("TD", 1)] {
        let mut off = [0.0_f64; 2];
        for kind in ELEMENTS {
            let mesh = distorted_element(kind, &mut Random::new(5));
            let (mut film, mut nodes) = mounted(&mesh, &sheet::face(material(), kind, [0.0; 2]));
            let places = positions(&nodes);
            let mut strip = Strip::at(&hill(), FRAC_PI_2 * axis as f64);
            for along in CYCLE {
                let [stress, across] = strip.pulled(along);
                let stretch = if axis == 0 { [along, across] } else { [across, along] }.map(f64::exp);
                set_positions(&mut nodes, |n, _| [stretch[0] * places[n][0], stretch[1] * places[n][1], 0.0]);
                let found = nominal(&forces(&mut film, &nodes), &places, THICKNESS);
                off[0] = off[0].max((found[axis] * stretch[axis] - stress).abs() / 8e6);
                off[1] = off[1].max(found[1 - axis].abs() / 8e6);
            }
        }
        claims.at_most(&format!("{name}, stress off the closed form, over the yield stress"), off[0], 1e-9);
        claims.at_most(&format!("{name}, stress across over the yield stress"), off[1], 1e-9);
    }
}

/// The scenario of a single element 5 mm long, pulled at an angle from MD.
fn single(direction: &str, material: &str) -> Model {
    written(&format!(
        "specimen.shape = {{ rectangle = [\"5 mm\", \"10 mm\"] }}
         specimen.mesh = {{ element = \"quad4\", size = \"10 mm\" }}
         specimen.material = {{ density = 920, thickness = 1e-4, plastic = {{ {material} }} }}
         loading.stretch = {{ direction = {direction}, velocity = \"0.02 m/s\", until = 0.4 }}"
    ))
}

const KEYS: &str = "young = \"200 MPa\", poisson = 0.45, hill = { r0 = 0.7, r45 = 1.6, r90 = 0.7 }, \
                    hardening = { curve = [[0, \"8 MPa\"], [0.05, \"10 MPa\"], [0.5, \"20 MPa\"]] }";

/// A strip whose width is free, from the scenario's keys, at 0°, 45° and 90° from MD: stress and, where it is unloaded, the
/// set.
#[test]
fn a_free_strip_follows_the_cycle_in_every_direction() {
    let mut claims = Claims::of("plastic, free strip");
    for (name, direction, angle) in
        [("MD", "\"MD\"", 0.0), ("45°", "\"45 deg\"", FRAC_PI_4), ("TD", "\"TD\"", FRAC_PI_2)]
    {
        let model = single(direction, KEYS);
        let strains = CYCLE.map(f64::exp_m1);
        let found = simulate::pull(&model, &strains, Across::Free).expect("a strip");
        let mut strip = Strip::at(&hill(), angle);
        let off = CYCLE.iter().zip(found).map(|(along, found)| {
            let [stress, _] = strip.pulled(*along);
            (found * along.exp() - stress).abs() / 8e6
        });
        let claim = format!("{name}, stress off the closed form, over the yield stress");
        claims.at_most(&claim, off.fold(0.0, f64::max), 1e-7);
    }
}

/// r₀, r₄₅ and r₉₀ apart: film at 45° shears.
const UNLIKE: [f64; 3] = [0.5, 1.0, 2.0];

/// The keys of film with these ratios.
fn unlike() -> String {
    let [r0, r45, r90] = UNLIKE;
    KEYS.replace("r0 = 0.7, r45 = 1.6, r90 = 0.7", &format!("r0 = {r0}, r45 = {r45}, r90 = {r90}"))
}

/// A strip at 45° of film whose strain ratios along MD and TD differ: it shears, and its stress is that of uniaxial tension,
/// exactly while the shear, which turns MD, is small.
#[test]
fn a_free_strip_shears() {
    let mut claims = Claims::of("plastic, free strip that shears");
    let hill = Hill::from_strain_ratios(UNLIKE);
    let found =
        simulate::pull(&single("\"45 deg\"", &unlike()), &CYCLE.map(f64::exp_m1), Across::Free).expect("a strip");
    let mut strip = Strip::at(&hill, FRAC_PI_4);
    let mut off = [0.0_f64; 2];
    for (place, (along, found)) in CYCLE.iter().zip(found).enumerate() {
        let [stress, _] = strip.pulled(*along);
        let later = usize::from(place > 1);
        off[later] = off[later].max((found * along.exp() - stress).abs() / 8e6);
    }
    claims.at_most("up to 6 %, stress off the closed form, over the yield stress", off[0], 1e-3);
    claims.at_most("through the cycle", off[1], 3e-2);
}

/// Film that is strained in one step and in many: the return of a large step is not that of its path.
#[test]
fn a_large_strain_is_taken_in_steps() {
    let mut claims = Claims::of("plastic, large strain");
    let model = single("\"MD\"", &unlike());
    for (name, across) in [("equibiaxial", Across::Equal), ("width held", Across::Held), ("width free", Across::Free)] {
        let end = |count: u32| {
            let strains: Vec<f64> = (1..=count).map(|i| 0.3 * f64::from(i) / f64::from(count)).collect();
            *simulate::pull(&model, &strains, across).expect("stresses").last().expect("the last")
        };
        claims.near(&format!("{name}, 30 % at once, Pa"), end(1), end(3000), 1e-3);
    }
}

/// Film mounted with equal pre-strains beyond yield: T = R_b σ_y, R_b² = 1/(F + G), and it flows on at once.
#[test]
fn film_yields_under_its_pre_strain() {
    let mut claims = Claims::of("plastic, pre-strain");
    let (plane, ratio) = (YOUNG / (1.0 - POISSON), 1.0 / (hill().f + hill().g).sqrt());
    let level = |strain: f64| {
        let flow = |plastic: f64| ratio * hardening().stress(2.0 * ratio * plastic);
        plane * (strain - zero(0.0, strain, |plastic| flow(plastic) - plane * (strain - plastic)))
    };
    for pre in [0.01, 0.1_f64] {
        let mut off = 0.0_f64;
        for kind in ELEMENTS {
            let mesh = distorted_element(kind, &mut Random::new(3));
            let (mut film, mut nodes) = mounted(&mesh, &sheet::face(material(), kind, [pre; 2]));
            let places = positions(&nodes);
            for more in [1.0, 1.02] {
                set_positions(&mut nodes, |n, _| places[n].map(|x| more * x));
                // Σ f X over the mounted volume is P (1 + e) of the stress-free film over (1 + e)².
                let expected = level(((1.0 + pre) * more).ln()) / ((1.0 + pre) * more) / (1.0 + pre);
                for found in nominal(&forces(&mut film, &nodes), &places, THICKNESS) {
                    off = off.max((found / expected - 1.0).abs());
                }
            }
        }
        claims.at_most(&format!("pre-strain {pre}, stress off the closed form"), off, 1e-9);
    }
}

/// Recordings of 6061 aluminium along MD or TD, from where their elastic line meets zero stress.
fn aluminium(direction: &str) -> [Curve; 2] {
    let names = ["stress [ksi]", "strain [-]"].map(String::from).to_vec();
    let options = ReadOptions { names, ..ReadOptions::default() };
    let code = if direction == "MD" { "RD" } else { "LT" };
    ["01", "02"].map(|number| {
        let path = root().join(format!("data/tension_anisotropic_al6061/cleaned_CA-{code}-{number}.csv"));
        let table = file::columns(&path, &options).expect("a recording");
        let [stress, strain] = [0, 1].map(|place| table.channels[place].series.values().to_vec());
        let curve = Curve::new(strain, stress).expect("a curve");
        let line = curve.modulus([0.001, 0.003]).expect("a modulus");
        curve.toe_compensated(line.slope, line.intercept)
    })
}

/// Mean of two recordings at a strain, Pa, and their difference over it.
fn mean(own: &[Curve; 2], strain: f64) -> [f64; 2] {
    let [a, b] = [0, 1].map(|k| own[k].stress_at(strain).expect("a strain within the recording"));
    [0.5 * (a + b), 2.0 * (a - b).abs() / (a + b)]
}

/// Laws that were fitted to all six recordings (of `scenarios/materials/aluminium.toml` the first).
const ALUMINIUM: [(&str, &str); 2] = [
    ("Voce", "voce = { yield = \"305.521 MPa\", saturation = \"361.188 MPa\", rate = 35.9315 }"),
    (
        "table",
        "curve = [[0, 287.743e6], [0.00231914, 304.224e6], [0.00261271, 306.311e6], [0.0034934, 311.01e6],
            [0.00496122, 315.782e6], [0.00701618, 319.539e6], [0.00965826, 322.958e6], [0.0128875, 326.352e6],
            [0.0167038, 329.856e6], [0.0211073, 333.811e6], [0.0260979, 337.935e6], [0.0316756, 342.237e6],
            [0.0378405, 346.679e6], [0.0445925, 350.837e6]]",
    ),
];

/// One element whose width is free, against the recordings along MD and TD. Sheet metal of Hill's type follows one curve in all
/// directions, these coupons not quite: the bound is the largest difference between two coupons of one direction.
#[test]
fn an_element_of_aluminium_follows_the_recordings() {
    let mut claims = Claims::of("plastic, aluminium");
    let strains = [0.002, 0.004, 0.006, 0.01, 0.02, 0.03, 0.04, 0.05];
    let coupons = ["MD", "TD"].map(|direction| (direction, aluminium(direction)));
    let flowing = || strains.into_iter().filter(|strain| *strain >= 0.006);
    let scatter = coupons.iter().flat_map(|(_, own)| flowing().map(|strain| mean(own, strain)[1])).fold(0.0, f64::max);
    let claim = "coupons of one direction";
    claims.holds(claim, &format!("differ by up to {scatter:.3}"), (0.03..0.064).contains(&scatter));
    for (form, hardening) in ALUMINIUM {
        let keys = format!(
            "young = \"68969.7 MPa\", poisson = 0.33, hill = {{ r11 = 1, r22 = 0.951145, r33 = 0.942851, r12 = 1 }},
             hardening = {{ {hardening} }}"
        );
        for (direction, own) in &coupons {
            let model = single(&format!("\"{direction}\""), &keys);
            let element = simulate::pull(&model, &strains, Across::Free).expect("a strip");
            let pairs = strains.iter().zip(element).filter(|(strain, _)| **strain >= 0.006);
            let off = pairs.map(|(strain, found)| (found / mean(own, *strain)[0] - 1.0).abs()).fold(0.0, f64::max);
            claims.at_most(&format!("{form}, one element along {direction}, off the mean recording"), off, scatter);
        }
    }
}

/// The shipped strip of aluminium, between jaws that hold its ends, against the recordings.
#[test]
fn the_meshed_coupon_of_aluminium_follows_the_recordings() {
    let mut claims = Claims::of("plastic, aluminium strip");
    let outcome = run(&shipped("stretch/aluminium.toml", &[]));
    let [strain, stress] = ["strain", "stress_Pa"].map(|name| channel(&outcome.signals, name));
    let own = aluminium("MD");
    let (mut off, mut scatter) = (0.0_f64, 0.0_f64);
    for (strain, stress) in strain.iter().zip(stress).filter(|(strain, _)| (0.008..0.05).contains(*strain)) {
        let [mean, differs] = mean(&own, *strain);
        off = off.max((stress / mean - 1.0).abs());
        scatter = scatter.max(differs);
    }
    claims.holds("two coupons along MD", &format!("differ by up to {scatter:.3}"), scatter > 0.03);
    claims.at_most("strip off the mean of both coupons", off, scatter);
    claims.at_most("energy balance error", outcome.energy_balance_error, 1e-3);
    claims.at_most("kinetic share", outcome.kinetic_share.expect("a share"), 1e-2);
}

/// A dart is thrown back and leaves a set: energy is conserved, most of it absorbed, and film that was stress-free is
/// longer than before.
#[test]
fn a_dart_leaves_a_set() {
    let mut claims = Claims::of("plastic, dart");
    let outcome = run(&shipped("drop/plastic.toml", &[]));
    claims.at_most("energy balance error", outcome.energy_balance_error, 1e-3);
    let absorbed = channel(&outcome.signals, "absorbed_energy_J");
    claims.holds("absorbed", &format!("{:?} J", absorbed.last()), absorbed.last().is_some_and(|last| *last > 0.1));
    let last = outcome.snapshots.last().expect("a snapshot");
    let plastic = last.films[0].plastic_strain.iter().fold(0.0_f32, |most, p| most.max(*p));
    claims.holds("largest plastic strain", &format!("{plastic}"), (0.05..1.5).contains(&plastic));
    let [first, end] =
        [&outcome.snapshots[0], last].map(|s| s.films[0].thickness_ratio.iter().copied().fold(2.0, f32::min));
    claims.holds("thickness", &format!("{first} {end}"), first > 0.996 && end < 0.97);
}
