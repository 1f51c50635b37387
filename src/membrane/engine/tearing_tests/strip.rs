//! Wide strips with a cut between jaws, of elastic, viscous and plastic film.

use nalgebra::Point3;

use super::mesh::halves;
use super::{FRACTURE_ENERGY, POISSON, THICKNESS, YOUNG, cells, section};
use crate::engine::{ElementStrain, Energies, Engine, Film, Jaw, Loads, Nodes, Section, Torn, Unobserved, View};
use crate::material::{
    Criterion, Elastic, FlowRate, Hardening, Hill, Hyperelastic, HyperelasticLaw, Law, Plastic, Polynomial, PronyTerm,
    Rupture, Viscosity, Voce,
};

/// Elements of a strip.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    /// Quadrilaterals of one point.
    Quads,
    /// Quadrilaterals of 2×2 points.
    Full,
    Triangles,
}

/// Where the cuts of a strip start.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Cuts {
    /// At one side.
    One,
    /// At both sides.
    Both,
    /// At both sides, of which the half up to a mirror plane across the tears is computed.
    Mirrored,
}

/// A strip between jaws along x, cut in the middle between them.
struct Strip {
    section: Section,
    kind: Kind,
    cuts: Cuts,
    /// Edge of an element, m.
    size: f64,
    /// Distance of the jaws, length of the strip, length of a cut, m.
    lengths: [f64; 3],
    /// Strain per s.
    rate: f64,
    /// Strain at which a test ends at the latest.
    most: f64,
    step_factor: f64,
}

impl Strip {
    /// Of elastic film, cut from one side.
    fn new(kind: Kind, size: f64, lengths: [f64; 3], rate: f64) -> Strip {
        let section = Section { full_integration: kind == Kind::Full, ..section() };
        Strip { section, kind, cuts: Cuts::One, size, lengths, rate, most: 0.05, step_factor: 1.0 }
    }

    /// Cross-section of the film that is not cut, m².
    fn whole(&self) -> f64 {
        let [_, length, cut] = self.lengths;
        (length - if self.cuts == Cuts::One { cut } else { 2.0 * cut }) * self.section.thickness
    }

    /// The strip before the first step.
    fn mounted(&self) -> Engine {
        let Strip { cuts, size, lengths: [height, length, cut], rate, .. } = *self;
        let length = if cuts == Cuts::Mirrored { 0.5 * length } else { length };
        let (columns, rows) = ((height / size).round() as u32 | 1, (length / size).round() as u32);
        let size_x = height / f64::from(columns);
        let at = |k: u32, size: f64| f64::from(k) * size;
        let mut mesh = cells(columns, rows, |i, j| Point3::new(at(i, size_x) - 0.5 * height, at(j, size), 0.0));
        if self.kind == Kind::Triangles {
            mesh.tris = halves(&std::mem::take(&mut mesh.quads));
        }
        if cuts == Cuts::Mirrored {
            mesh.mirrors[1] = (0..=columns).map(|i| rows * (columns + 1) + i).collect();
        }
        let mut nodes = Nodes::default();
        let mut film = Film::mount(&mesh, &self.section, 0.0, &mut nodes).unwrap();
        film.cut(&nodes, &[[0.0, 0.0], [0.0, cut]]);
        match cuts {
            Cuts::One => {}
            Cuts::Both => _ = film.cut(&nodes, &[[0.0, length], [0.0, length - cut]]),
            Cuts::Mirrored => {
                nodes.hold((0..=columns).map(|i| (rows * (columns + 1) + i) as usize), [false, true, false])
            }
        }
        let speed = 0.5 * rate * height;
        let jaw = |side: u32, velocity: f64| Jaw {
            nodes: (0..=rows).map(|j| j * (columns + 1) + side * columns).collect(),
            velocity,
        };
        let jaws = vec![jaw(0, -speed), jaw(1, speed)];
        for n in 0..nodes.mass.len() {
            nodes.velocity.set(n, [2.0 * speed * nodes.position.value_at(n)[0] / height, 0.0, 0.0]);
        }
        for jaw in &jaws {
            nodes.hold(jaw.nodes.iter().map(|n| *n as usize), [true; 3]);
            jaw.nodes.iter().for_each(|n| nodes.velocity.set(*n as usize, [jaw.velocity, 0.0, 0.0]));
        }
        let multiplicity = if cuts == Cuts::Mirrored { 2.0 } else { 1.0 };
        let loads = Loads { jaws, damping: 300.0, multiplicity, step_factor: self.step_factor, ..Loads::default() };
        Engine::new(vec![film], nodes, [], loads)
    }

    /// Pulls the strip until it is torn through.
    fn torn(&self) -> Outcome {
        let mut engine = self.mounted();
        let (mut start, mut imbalance, mut first, mut history) = (f64::NAN, 0.0_f64, None, vec![]);
        loop {
            let read = |view: &View<'_>| {
                let (time, torn) = (view.time, view.torn().unwrap());
                let ends = torn.area / self.whole() > 0.98 || time * self.rate > self.most;
                (time, view.energies(), torn, ends.then(|| PlasticElements::from_view(view)))
            };
            let (time, energies, torn, plastic) = engine.read_step(read).unwrap();
            let first = *first.get_or_insert(energies);
            let exchanged = energies.exchanged(&first);
            if exchanged > 0.0 {
                imbalance = imbalance.max((energies.total() - first.total()).abs() / exchanged);
            }
            history.push([self.rate * time, torn.length]);
            if start.is_nan() && torn.area / self.whole() > 0.02 {
                start = self.rate * time;
            }
            if let Some(plastic) = plastic {
                return Outcome { start, torn, energies, plastic, imbalance, history };
            }
            for _ in 0..20 {
                engine.step(&mut Unobserved).unwrap();
            }
        }
    }
}

/// Result of a test of a strip.
#[derive(Debug)]
struct Outcome {
    /// Strain at which the tear started.
    start: f64,
    /// Of the tear as it went through.
    torn: Torn,
    /// Energies then.
    energies: Energies,
    /// Of its elements then.
    plastic: PlasticElements,
    /// Largest error of the energy balance over the energy exchanged.
    imbalance: f64,
    /// Strain and length of the tear (m).
    history: Vec<[f64; 2]>,
}

impl Outcome {
    /// Energy taken for the area of the tear over Γ, less one.
    fn excess(&self, section: &Section) -> f64 {
        self.torn.energy / self.torn.area / section.rupture.as_ref().unwrap().fracture_energy - 1.0
    }
}

/// Strain at which the energy W of wide film of this Young's modulus (Pa) between jaws `height` (m) apart suffices:
/// W H = Γ (Rivlin and Thomas, J. Polym. Sci. 10, 1953).
fn griffith(young: f64, height: f64) -> f64 {
    let modulus = young / (1.0 - POISSON * POISSON);
    // ½ modulus E² with Green's strain E.
    let green = (2.0 * FRACTURE_ENERGY / height / modulus).sqrt();
    (1.0 + 2.0 * green).sqrt() - 1.0
}

fn a_wide_strip_tears_at_its_fracture_energy(kind: Kind, size: f64) {
    let lengths @ [height, length, cut] = [0.2, 0.4, 0.15];
    let Outcome { start, torn, energies: Energies { rupture, .. }, imbalance, .. } =
        Strip::new(kind, size, lengths, 0.2).torn();
    let expected = griffith(YOUNG, height);
    let energy = rupture / ((length - cut) * THICKNESS);
    println!("{kind:?} {size}: strain {start:.5} for {expected:.5}, {energy:.0} J/m2, {torn:?}, {imbalance:.1e}");
    assert!((torn.energy / rupture - 1.0).abs() < 1e-6 && torn.length > 0.97 * (length - cut));
    assert!((start / expected - 1.0).abs() < 0.03, "{kind:?} {size} m: start {start} for {expected}");
    assert!((energy / FRACTURE_ENERGY - 1.0).abs() < 0.05, "{kind:?} {size} m: {energy} J/m2");
    assert!(imbalance < 0.01, "{kind:?} {size} m: imbalance {imbalance}");
}

thorough::cases!(a_wide_strip_tears_at_its_fracture_energy {
    squares_of_10_mm: Kind::Quads, 10e-3;
} thorough {
    squares_of_5_mm: Kind::Quads, 5e-3;
    triangles: Kind::Triangles, 5e-3;
    squares_of_2_5_mm: Kind::Quads, 2.5e-3;
    full_integration: Kind::Full, 5e-3;
});

/// Film whose stress relaxes by this share.
const RELAXING: f64 = 0.4;

/// The tear takes Γ within the hundredth that an element loses with its rest, and what the law absorbs in its elements
/// is part of it. Film that relaxes much faster or much slower than it is strained tears at the strain of Griffith's
/// balance for its long-term or its instantaneous modulus; all other film takes more than with the latter. The balance
/// errs by the square of the step, most where the tear runs as fast as waves let it; 2·10⁻⁴ is the error of the first steps,
/// which exchange next to nothing.
fn a_viscous_strip_takes_its_fracture_energy_besides_what_it_absorbs(kind: Kind, time: f64, expected: Option<f64>) {
    let lengths @ [height, ..] = [0.06, 0.1, 0.03];
    let viscosity = Viscosity::new(vec![PronyTerm { share: RELAXING, time }]).unwrap();
    let strip = |step_factor: f64| {
        let mut strip = Strip { step_factor, ..Strip::new(kind, 5e-3, lengths, 1.0) };
        strip.section.viscosity = Some(viscosity.clone());
        strip
    };
    let whole = strip(1.0);
    let outcome = whole.torn();
    let (excess, Outcome { start, torn, energies, imbalance, .. }) = (outcome.excess(&whole.section), outcome);
    let of_law = torn.energy - energies.rupture;
    println!(
        "{kind:?} {time} s: strain {start:.5}, energy {excess:.4} over Γ, of it {:.4} by the law, {:.3} absorbed, \
         balance {imbalance:.1e}",
        of_law / torn.energy,
        energies.absorbed / torn.energy,
    );
    // The width of triangles is larger where J points aside, by some percent where it does so by a few degrees: these are
    // pulled on until what is torn through stores nothing.
    let is_through = match kind {
        Kind::Triangles if torn.area < 0.98 * whole.whole() => {
            torn.area > 0.97 * whole.whole() && energies.stored < 1e-4 * torn.energy
        }
        _ => torn.area > 0.98 * whole.whole(),
    };
    assert!(excess.abs() < 0.01 && is_through, "{kind:?} {time} s: {excess}, {torn:?}, {energies:?}");
    assert!(of_law > 0.0 && of_law < energies.absorbed, "{kind:?} {time} s: {of_law} J");
    assert!(imbalance < 0.01, "{kind:?} {time} s: {imbalance}");
    if thorough::thorough() {
        let of_half = strip(0.5).torn().imbalance;
        println!("balance {of_half:.1e} with half the step");
        assert!(of_half < 0.5 * imbalance + 2e-4, "{kind:?} {time} s: {imbalance}, {of_half} with half the step");
    }
    assert!(start > 0.97 * griffith(YOUNG, height), "{kind:?} {time} s: {start}");
    if let Some(modulus) = expected {
        let expected = griffith(modulus, height);
        assert!((start / expected - 1.0).abs() < 0.03, "{kind:?} {time} s: {start} for {expected}");
    }
}

thorough::cases!(a_viscous_strip_takes_its_fracture_energy_besides_what_it_absorbs {
    relaxed: Kind::Quads, 5e-5, Some((1.0 - RELAXING) * YOUNG);
    at_once: Kind::Quads, 1.0, Some(YOUNG);
    triangles: Kind::Triangles, 2e-3, None;
} thorough {
    full_integration: Kind::Full, 2e-3, None;
});

/// Flow stress of the plastic strip.
const VOCE: Voce = Voce { initial: 20e6, saturation: 40e6, rate: 10.0 };

/// Plastic work for the volume (J/m³) up to the plastic strain `p`: the integral of Voce's flow stress.
fn plastic_work(p: f64) -> f64 {
    VOCE.saturation * p - (VOCE.saturation - VOCE.initial) / VOCE.rate * (1.0 - (-VOCE.rate * p).exp())
}

/// Elements of a plastic strip: how they strained and tore.
#[derive(Debug)]
struct PlasticElements {
    /// Plastic work in those that do not tear, J.
    intact: f64,
    /// Number of those that do.
    tearing: usize,
}

impl PlasticElements {
    fn from_view(view: &View<'_>) -> PlasticElements {
        let mut strains = vec![];
        view.strains(&mut strains);
        let (tearing, intact): (Vec<&ElementStrain>, Vec<_>) =
            strains[0].iter().partition(|strain| strain.damage > 0.0);
        let work = intact.iter().map(|strain| strain.volume * plastic_work(strain.plastic));
        PlasticElements { intact: work.sum(), tearing: tearing.len() }
    }
}

/// The criterion is the energy stored and absorbed, 4 MJ/m³: of the work on the strip, Γ for the area of the tear, the
/// plastic work in elements that do not tear, by the integral of Voce's law over their plastic strain, and 4 MJ/m³ of
/// each that does are lost. Of the last, what was stored elastically does not count twice: with the flow stress σ at 4
/// MJ/m³ at most (1 − ν) σ²/Y, which equal stresses in both directions store, and what hourglass modes store.
fn a_plastic_strip_takes_its_fracture_energy_besides_plastic_work(kind: Kind, in_hourglass: f64, halves: f64) {
    let (limit, fracture_energy, young) = (4e6, 3e4, 5e9);
    let elastic = Elastic { young, poisson: POISSON };
    let lengths = [0.06, 0.06, 0.02];
    let flow_stress = VOCE.saturation - (VOCE.saturation - VOCE.initial) * (-VOCE.rate * 0.13_f64).exp();
    assert!(plastic_work(0.13) < limit && plastic_work(0.14) > limit);
    let stored = (1.0 - POISSON) * flow_stress * flow_stress / young / limit;
    let mut strip = Strip { most: 1.2, ..Strip::new(kind, 5e-3, lengths, 20.0) };
    let (hill, voce) = (Hill::default(), Hardening::Voce(VOCE));
    strip.section.law = Law::Plastic(Plastic::new(elastic.clone(), hill, voce, FlowRate::Independent));
    strip.section.rupture = Some(Rupture { criterion: Criterion::Energy, limit, fracture_energy });
    let outcome = strip.torn();
    let Outcome { torn, energies, plastic, imbalance, .. } = &outcome;
    // 13 columns of elements, of which one tears.
    let volume = plastic.tearing as f64 * strip.size * lengths[0] / 13.0 * THICKNESS / halves;
    let before = energies.absorbed + energies.rupture - torn.energy - plastic.intact;
    let (excess, share) = (outcome.excess(&strip.section), before / (limit * volume));
    println!(
        "{kind:?}: energy {excess:.4} over Γ, {:.3} J of {:.3} J absorbed in film that does not tear, {share:.4} of the \
         limit before the tear, at most {stored:.4} stored, balance {imbalance:.1e}",
        plastic.intact, energies.absorbed
    );
    assert!(excess.abs() < 0.01 && torn.area > 0.98 * strip.whole(), "{kind:?}: {excess}");
    assert!(share > 1.0 - stored - in_hourglass && share < 1.0, "{kind:?}: {share}");
    assert!(*imbalance < 1e-3, "{kind:?}: balance {imbalance}");
}

thorough::cases!(a_plastic_strip_takes_its_fracture_energy_besides_plastic_work {
    squares: Kind::Quads, 0.05, 1.0;
    triangles: Kind::Triangles, 0.0, 2.0;
} thorough {
    full_integration: Kind::Full, 0.0, 1.0;
});

/// A strip that is cut from both sides, and its half up to the mirror plane on which its tears meet.
fn a_tear_across_a_mirror_plane_is_half_of_the_whole(kind: Kind) {
    let strip = |cuts: Cuts| Strip { cuts, ..Strip::new(kind, 5e-3, [0.06, 0.2, 0.05], 1.0) };
    let [whole, half] = [Cuts::Both, Cuts::Mirrored].map(|cuts| strip(cuts).torn());
    println!("{kind:?}: strain {:.5}, {:.5} of the half; {:?}, {:?}", whole.start, half.start, whole.torn, half.torn);
    assert_eq!(whole.history.len(), half.history.len());
    for ([strain, length], [of_half, other]) in whole.history.iter().zip(&half.history) {
        assert!((strain - of_half).abs() < 1e-9, "{kind:?}: strain {strain} and {of_half}");
        assert!((length - other).abs() < 1e-9, "{kind:?} at the strain {strain}: {length} m and {other} m");
    }
    assert!(
        (whole.torn.length / 0.1 - 1.0).abs() < 0.02 && whole.history.iter().any(|[_, l]| (0.02..0.08).contains(l))
    );
    let ends =
        [&whole, &half].map(|outcome| [outcome.torn.energy, outcome.energies.rupture, outcome.energies.external]);
    for (one, other) in ends[0].iter().zip(ends[1]) {
        assert!((one / other - 1.0).abs() < 1e-9, "{kind:?}: {ends:?}");
    }
}

thorough::cases!(a_tear_across_a_mirror_plane_is_half_of_the_whole {
    squares: Kind::Quads;
} thorough {
    full_integration: Kind::Full;
});

/// Rubber of scenarios/stretch/tear.toml, 0.1 m between the jaws: its tear starts where W H = Γ, and its tip runs on to the
/// outer edge, whose film contracts. By energies of standing cuts (elements of 10 and 5 mm) it releases 0.956 W H at the
/// least on the way, so that W H = 1.046 Γ suffices where the pull is slow. Film behind the tip still holds then.
fn the_tip_of_a_tear_runs_to_the_outer_edge(kind: Kind, size: f64) {
    let (mu, fracture_energy, [height, length, cut]) = (4e5, 25e3, [0.1, 0.24, 0.08]);
    let law = Hyperelastic { energy: Polynomial::neo_hookean(mu), wrinkling: true };
    let mut strip = Strip { most: 0.76, ..Strip::new(kind, size, [height, length, cut], 1.0) };
    strip.section = Section {
        law: Law::Hyperelastic(HyperelasticLaw::Polynomial(law)),
        rupture: Some(Rupture { criterion: Criterion::Strain, limit: 5.0, fracture_energy }),
        density: 930.0,
        thickness: 0.5e-3,
        ..strip.section
    };
    // Pure shear of the sheet (theory.md, equation 305).
    let released = |strain: f64| {
        let square = (1.0 + strain).powi(2);
        0.5 * mu * (square + 1.0 / square - 2.0) * height / fracture_energy
    };
    let outcome = strip.torn();
    let Outcome { start, plastic: PlasticElements { tearing, .. }, torn, .. } = &outcome;
    let (start, end) = (released(*start), released(strip.most));
    println!("{kind:?} {size}: start at {start:.3} Γ, {tearing} elements at {end:.3} Γ, {torn:?}");
    assert!((start - 1.0).abs() < 0.05, "{kind:?} {size} m: start at {start}");
    let across = ((length - cut) / size).round() as usize * if kind == Kind::Triangles { 2 } else { 1 };
    assert!(*tearing >= across, "{kind:?} {size} m: {tearing} of {across} elements");
}

thorough::cases!(the_tip_of_a_tear_runs_to_the_outer_edge {
    squares_of_10_mm: Kind::Quads, 10e-3;
} thorough {
    triangles: Kind::Triangles, 5e-3;
    squares_of_5_mm: Kind::Quads, 5e-3;
    squares_of_2_5_mm: Kind::Quads, 2.5e-3;
});
