//! The bounds that a run is checked against while it steps, and the findings that it has at its end.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::outcome::Outcome;
use super::springs::SpringStep;
use super::tracks::Sample;
use super::warning::{BodySize, ImpactorName, Warning, bounds};
use crate::model::{Face, Loading, Model, SNAPSHOT_MEMORY};
use lab::signal::column::{self, Column};
use membrane::engine::{self, ContactState, ElementStrain, FilmContactState, TooWide, View};
use membrane::material::{Hardening, Law};

/// What a run ends with besides its outcome.
pub(super) struct End {
    /// Whether each impactor reached the end of the test without contact.
    pub(super) missed: Vec<bool>,
    /// Whether each met other bodies by then, but not the film.
    pub(super) met_others_alone: Vec<bool>,
    /// Whether each impactor is still in contact at the end.
    pub(super) unfinished: Vec<bool>,
    /// What springs of the frame make of the time step.
    pub(super) spring_step: Option<SpringStep>,
    /// Snapshots that the mesh allows.
    pub(super) snapshots: usize,
    /// Simulated time, s.
    pub(super) time: f64,
}

/// Heat that film gives to still air and by radiation through each side, W/(m² K); assumed.
const TO_AIR: f64 = 10.0;

/// Time (s) in which so much (m) of the film of a face gives two thirds of its heat to still air, where it warms up.
fn cooling(face: &Face, thickness: f64) -> Option<f64> {
    Some(face.material.thermal?.capacity * thickness / (2.0 * TO_AIR))
}

/// A bound that is watched while a run steps, in the order of the findings: of a body, then of film.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
enum Watch {
    /// Travel of a body in one step, m.
    Travel,
    /// Longest edge in contact over the size of the body.
    Edge,
    /// Penetration over that size.
    Penetration,
    /// Whether the body met the frame.
    FrameHit,
    /// Slip of film in its clamp, m.
    Slip,
    /// Share of the held length of film that left its clamp.
    Left,
    /// Share of slack springs.
    Slack,
    /// Strain of an element that is strained much more than its neighbours.
    Localised,
    /// Share of a face under biaxial load whose directions nothing couples.
    Biaxial,
    /// Shear angle of an element that is not broken, rad.
    Sheared,
    /// Equivalent plastic strain of an element that does not tear.
    Plastic,
    /// Whether the law gave no thickness of an element that is not broken.
    WithoutThickness,
    /// Depth of film behind a mirror plane, m.
    Behind,
    /// Depth of film in film, m.
    Crossed,
    /// How often contact of film with film was lost.
    Lost,
}

/// What the bounds on film as a whole are compared with at each sample; they are exceeded above zero.
type OfFilm = fn(&Sample<'_>) -> Option<f64>;

const OF_FILM: [(Watch, OfFilm); 5] = [
    (Watch::Slip, |sample| sample.clamp.map(|[slip, _]| slip)),
    (Watch::Left, |sample| sample.clamp.map(|[_, left]| left)),
    (Watch::Slack, |sample| sample.springs.as_ref().map(|springs| springs.slack)),
    (Watch::Crossed, |sample| sample.films.map(|films| -films.distance)),
    (Watch::Lost, |sample| sample.films.map(|films| films.lost as f64)),
];

impl Watch {
    /// Whether it is one of each body, and not of each face or of the film.
    fn is_of_bodies(self) -> bool {
        self <= Watch::FrameHit
    }

    /// Whether the time of its largest value is kept, and not that of the first.
    fn is_timed_by_largest(self) -> bool {
        matches!(self, Watch::Travel | Watch::Biaxial)
    }
}

/// A bound that was exceeded.
#[derive(Clone, Copy, Serialize, Deserialize)]
struct Excess {
    /// When it first was, or when it was exceeded most, s.
    time: f64,
    /// The largest value.
    most: f64,
}

/// The bounds that were exceeded so far.
#[derive(Serialize, Deserialize)]
pub(super) struct Monitor {
    /// By their body or face.
    exceeded: BTreeMap<(Watch, usize), Excess>,
    /// Size of each body, m; zero before the first audit.
    sizes: Vec<f64>,
    /// Steps in which the impulses between faces did not converge, and all steps.
    unresolved: [u64; 2],
    /// Of the elements that started to tear the one that stored most of what its tear takes, where it stored more.
    too_wide: Option<TooWide>,
    /// Share of its work that film at a tip would have returned, where that decided.
    returned: Option<f64>,
    has_bars: bool,
    /// Whether there is a mirror plane across x and across y.
    mirrors: [bool; 2],
    /// Of the thinnest face, m.
    thickness: f64,
}

/// Intact elements, by their number among such, that share a node with the one of number `element`.
fn neighbours(film: &engine::Film, element: usize) -> Vec<usize> {
    let (mut corners, mut place) = (vec![], 0);
    film.for_each_intact(|c| {
        if place == element {
            corners.extend_from_slice(c);
        }
        place += 1;
    });
    let (mut beside, mut place) = (vec![], 0);
    film.for_each_intact(|c| {
        if place != element && c.iter().any(|n| corners.contains(n)) {
            beside.push(place);
        }
        place += 1;
    });
    beside
}

impl Monitor {
    /// The monitor of a run of `model`: its impactors, and bars after them.
    pub(super) fn new(model: &Model) -> Monitor {
        let has_bars = model.frame.bars.is_some();
        Monitor {
            exceeded: BTreeMap::new(),
            sizes: vec![0.0; model.impactors.len() + usize::from(has_bars)],
            unresolved: [0; 2],
            too_wide: None,
            returned: None,
            has_bars,
            mirrors: model.specimen.symmetry.mirrors(),
            thickness: model.faces.iter().map(Face::thickness).fold(f64::INFINITY, f64::min),
        }
    }

    /// Records a `value` at `time` (s) of the body or face at a place where it is above its `bound`.
    fn record(&mut self, watch: Watch, place: usize, time: f64, value: f64, bound: f64) {
        if value > bound {
            let excess = self.exceeded.entry((watch, place)).or_insert(Excess { time, most: value });
            if value > excess.most {
                excess.most = value;
                if watch.is_timed_by_largest() {
                    excess.time = time;
                }
            }
        }
    }

    /// Records the state of contact at `time` (s) on the body of this index and `size` (m). Edges count while the film `is_whole`: those
    /// of torn film are as long as its pieces.
    pub(super) fn contact(&mut self, body: usize, time: f64, size: f64, state: &ContactState, is_whole: bool) {
        self.sizes[body] = size;
        if is_whole {
            self.record(Watch::Edge, body, time, state.longest_edge / size, bounds::EDGE);
        }
        self.record(Watch::Penetration, body, time, state.penetration / size, bounds::PENETRATION);
        // With bars, it is them that an impactor reaches.
        if state.frame_hit && !self.has_bars {
            self.frame_hit(body, time);
        }
    }

    /// Records that the body of this index travels so far (m) in the step at `time` (s).
    pub(super) fn travel(&mut self, body: usize, time: f64, length: f64) {
        self.record(Watch::Travel, body, time, length, 0.0);
    }

    /// Records that the body of this index met the frame, or its bars, at `time` (s).
    pub(super) fn frame_hit(&mut self, body: usize, time: f64) {
        self.record(Watch::FrameHit, body, time, 1.0, 0.0);
    }

    /// Records the film at a sample: its slip in the clamp, its springs, its tears, and contact between its faces.
    pub(super) fn sample(&mut self, sample: &Sample<'_>) {
        let view = sample.view;
        for (watch, value) in OF_FILM {
            self.record(watch, 0, view.time, value(sample).unwrap_or(0.0), 0.0);
        }
        if sample.torn.is_some() {
            self.too_wide = view.too_wide;
            self.returned = view.returned;
        }
        if let Some(FilmContactState { unresolved, .. }) = sample.films {
            self.unresolved = unresolved;
            self.behind_mirrors(view);
        }
    }

    /// Records film that lies behind a mirror plane, where its image is, which it does not meet.
    fn behind_mirrors(&mut self, view: &View<'_>) {
        let axes = view.nodes.position.axes();
        let (mirrors, thickness) = (self.mirrors, self.thickness);
        for axis in (0..2).filter(|axis| mirrors[*axis]) {
            let least = axes[axis].iter().copied().fold(0.0, f64::min);
            self.record(Watch::Behind, 0, view.time, -least, thickness);
        }
    }

    /// Looks for an element that is strained much more than its neighbours.
    pub(super) fn strain(&mut self, view: &View<'_>, strains: &[Vec<ElementStrain>]) {
        if self.exceeded.keys().any(|(watch, _)| *watch == Watch::Localised) {
            return;
        }
        let mut found = None;
        // Film that can tear is strained most where it does, and takes the same energy there on any mesh.
        let films = view.films.iter().zip(strains).enumerate();
        for (face, (film, strains)) in films.filter(|(_, (film, _))| !film.takes_fracture_energy()) {
            let of_fibre = |s: &ElementStrain, fibre: usize| if s.left[fibre] > 0.0 { s.strain[fibre] } else { 0.0 };
            let largest = |s: &ElementStrain| of_fibre(s, 0).max(of_fibre(s, 1));
            let intact: Vec<f64> = strains.iter().filter(|s| s.volume > 0.0).map(largest).collect();
            let Some(worst) = (0..intact.len()).max_by(|a, b| intact[*a].total_cmp(&intact[*b])) else { continue };
            if intact[worst] < bounds::LOCALISED_STRAIN {
                continue;
            }
            // Elements without volume, as a forged checkpoint may have them, are not among the strains.
            let around: Vec<f64> = neighbours(film, worst).into_iter().filter_map(|k| intact.get(k).copied()).collect();
            let mean = around.iter().sum::<f64>() / around.len().max(1) as f64;
            if !around.is_empty() && intact[worst] > bounds::LOCALISATION * mean {
                found = Some((face, intact[worst]));
            }
        }
        if let Some((face, strain)) = found {
            self.record(Watch::Localised, face, view.time, strain, 0.0);
        }
    }

    /// Looks for biaxial load of fabric whose directions are coupled less than those of isotropic film, and nothing says why.
    pub(super) fn biaxial(&mut self, time: f64, strains: &[Vec<ElementStrain>], model: &Model) {
        for (place, (face, strains)) in model.faces.iter().zip(strains).enumerate() {
            let is_doubtful = face.unsourced_coupling.is_some_and(|coupling| coupling < bounds::COUPLING);
            if is_doubtful {
                self.record(Watch::Biaxial, place, time, biaxial_share(strains), bounds::BIAXIAL);
            }
        }
    }

    /// Records how far film is sheared and flowed, and film whose law gives no thickness.
    pub(super) fn beyond_data(&mut self, view: &View<'_>, strains: &[Vec<ElementStrain>], model: &Model) {
        for (place, (film, strains)) in view.films.iter().zip(strains).enumerate() {
            let law = &model.faces[place].material.law;
            self.record(Watch::Sheared, place, view.time, largest_shear(strains), end_of_shear(law));
            // An element that tears is drawn out within its row: its strain is not that of film.
            let whole = strains.iter().filter(|strain| strain.damage == 0.0);
            self.record(Watch::Plastic, place, view.time, whole.map(|strain| strain.plastic).fold(0.0, f64::max), 0.0);
            if may_lose_thickness(law, strains) && !self.exceeded.contains_key(&(Watch::WithoutThickness, place)) {
                let details = film.details(&view.nodes.position);
                let mut intact = details.iter().zip(strains).filter(|(_, strain)| !strain.has_failed());
                let is_lost = intact.any(|(element, _)| element.thickness_ratio.is_nan());
                self.record(Watch::WithoutThickness, place, view.time, f64::from(is_lost), 0.0);
            }
        }
    }

    /// Whether both are of scenes with the same bodies in contact, and this one of no more than so many faces.
    pub(super) fn is_like(&self, other: &Monitor, faces: usize) -> bool {
        let bodies = |monitor: &Monitor| (monitor.sizes.len(), monitor.has_bars);
        let is_place =
            |(watch, place): &(Watch, usize)| *place < if watch.is_of_bodies() { self.sizes.len() } else { faces };
        bodies(self) == bodies(other) && self.exceeded.keys().all(is_place)
    }

    /// The warning of a bound that the body of this `name` and shape exceeded.
    fn of_body(&self, watch: Watch, body: usize, name: &ImpactorName, size: BodySize) -> Option<Warning> {
        let Excess { time, most } = *self.exceeded.get(&(watch, body))?;
        let impactor = name.clone();
        match watch {
            Watch::Travel => {
                let travel = most / self.sizes[body];
                let is_fast = self.sizes[body] > 0.0 && travel > bounds::TRAVEL;
                is_fast.then_some(Warning::TooFast { impactor, time, travel, size })
            }
            Watch::Edge => Some(Warning::CoarseContact { impactor, time, edge: most, size }),
            Watch::Penetration => Some(Warning::Penetration { impactor, time, depth: most, size }),
            Watch::FrameHit => Some(Warning::FrameHit { impactor, time, has_bars: self.has_bars }),
            _ => None,
        }
    }

    /// The warning of a bound that film exceeded.
    fn of_film(&self, watch: Watch, model: &Model) -> Option<Warning> {
        let of_watch = self.exceeded.iter().filter(|((of, _), _)| *of == watch);
        let by_size = |a: &Excess, b: &Excess| a.most.total_cmp(&b.most).then(b.time.total_cmp(&a.time));
        // Of faces that are alike the first.
        let (&(_, place), &Excess { time, most }) = of_watch.rev().max_by(|a, b| by_size(a.1, b.1))?;
        match watch {
            Watch::Slip => Some(Warning::ClampSlip { time, slip: most }),
            Watch::Left => Some(Warning::ClampLeft { time, share: most }),
            Watch::Slack => Some(Warning::SpringsSlack { time, share: most }),
            Watch::Localised => Some(Warning::StrainLocalisation { time, strain: most, face: place + 1 }),
            Watch::Biaxial => {
                let coupling = model.faces[place].unsourced_coupling.unwrap_or_default();
                Some(Warning::UncoupledBiaxial { time, share: most, face: place + 1, coupling })
            }
            Watch::Behind => Some(Warning::FilmBehindMirror { time, depth: most }),
            Watch::Crossed => Some(Warning::FilmCrossing { time, depth: most }),
            Watch::Lost => Some(Warning::FilmContactLost { time, times: most as u64 }),
            _ => None,
        }
    }

    /// The findings of film beyond the data of its law.
    fn of_laws(&self, model: &Model) -> Vec<Warning> {
        let of = |watch: Watch| {
            let of_watch = self.exceeded.iter().filter(move |((of, _), _)| *of == watch);
            of_watch.map(|((_, place), excess)| (place + 1, &model.faces[*place].material, excess.most))
        };
        let sheared = of(Watch::Sheared).map(|(face, material, angle)| Warning::ShearExceeded {
            face,
            angle,
            end: end_of_shear(&material.law),
        });
        let yielded = || {
            of(Watch::Plastic).filter_map(|(face, material, strain)| match &material.law {
                Law::Plastic(law) => Some((face, material.rupture.is_some(), law.hardening(), strain)),
                _ => None,
            })
        };
        let hardened = yielded().filter(|(.., hardening, strain)| *strain > hardening.end());
        let hardened = hardened.map(|(face, _, hardening, strain)| Warning::HardeningExceeded {
            face,
            strain,
            end: hardening.end(),
        });
        let without = of(Watch::WithoutThickness).map(|(face, ..)| Warning::ThicknessLost { face });
        let thinned = yielded().filter(|(_, can_tear, ..)| *can_tear).filter_map(|(face, _, hardening, strain)| {
            Some(Warning::ThinningBeforeBreak { face, strain, from: thins_from(hardening, strain)? })
        });
        sheared.chain(hardened).chain(without).chain(thinned).collect()
    }

    /// The warnings of a run of `model` with this `outcome` so far: one list, in the order of the page.
    pub(super) fn finish(self, outcome: &Outcome, end: &End, model: &Model) -> Vec<Warning> {
        let End { missed, met_others_alone, unfinished, spring_step, snapshots: taken, time } = end;
        let (wanted, taken, time) = (model.output.frames, *taken, *time);
        let (rupture_time, balance, outside) =
            (outcome.rupture_time, outcome.energy_balance_error, outcome.rates.outside);
        let impactors = (0..model.impactors.len()).map(|place| ImpactorName::of_impactor(model, place));
        let names: Vec<ImpactorName> = impactors.chain(self.has_bars.then_some(ImpactorName::Bars)).collect();
        let sizes =
            model.impactors.iter().map(|impactor| BodySize::from_shape(&impactor.shape)).chain([BodySize::Radius]);
        let of = |which: &[bool], warning: fn(ImpactorName) -> Warning| -> Vec<Warning> {
            let named = names.iter().zip(which).filter(|(_, is)| **is);
            named.map(|(name, _)| warning(name.clone())).collect()
        };
        let mut out = of_mounting(outcome, *spring_step);
        let without_contact = names.iter().zip(missed).filter(|(_, missed)| **missed);
        out.extend(without_contact.map(|(name, _)| match rupture_time {
            Some(time) => Warning::TornBeforeContact { impactor: name.clone(), time },
            None => Warning::NoContact(name.clone()),
        }));
        out.extend(of(met_others_alone, Warning::NoFilmContact));
        for (body, (name, size)) in names.iter().zip(sizes).enumerate() {
            let watches = [Watch::Travel, Watch::Edge, Watch::Penetration, Watch::FrameHit];
            let found = watches.into_iter().filter_map(|watch| self.of_body(watch, body, name, size));
            out.extend(found);
        }
        let of_film = |watches: &[Watch]| -> Vec<Warning> {
            watches.iter().filter_map(|watch| self.of_film(*watch, model)).collect()
        };
        out.extend(of_film(&[Watch::Slip, Watch::Left, Watch::Slack, Watch::Localised, Watch::Biaxial]));
        out.extend(self.too_wide.map(|TooWide { width, ratio }| Warning::ElementsTooWide { width, ratio }));
        out.extend(self.returned.map(|share| Warning::TearByLimit { share }));
        out.extend(of_film(&[Watch::Behind, Watch::Crossed, Watch::Lost]));
        let [steps, all] = self.unresolved;
        if steps as f64 > bounds::UNRESOLVED * all as f64 {
            out.push(Warning::FilmContactUnresolved { steps, of: all });
        }
        if rupture_time.is_none() {
            out.extend(of(unfinished, Warning::Unfinished));
        }
        let nothing_hit =
            !missed.is_empty() && missed.iter().zip(met_others_alone).all(|(missed, other)| *missed || *other);
        out.extend((taken < wanted).then_some(Warning::FewerSnapshots { wanted, taken, memory: SNAPSHOT_MEMORY }));
        out.extend((balance > bounds::BALANCE).then_some(Warning::EnergyBalance { error: balance }));
        out.extend((outside > bounds::RATES && !nothing_hit).then_some(Warning::StrainRateOutside { share: outside }));
        out.extend(break_strain_of_coupons(outcome, model));
        out.extend(self.of_laws(model));
        out.extend(of_heat(model, time));
        out.extend(outcome.kinetic_share.and_then(|share| match share {
            share if share > bounds::KINETIC => Some(Warning::NotQuasiStatic { share }),
            share if share > bounds::BARELY => Some(Warning::BarelyQuasiStatic { share }),
            _ => None,
        }));
        out
    }
}

/// The findings of film as mounted.
fn of_mounting(outcome: &Outcome, spring_step: Option<SpringStep>) -> Vec<Warning> {
    let films = outcome.films.iter().zip(1..).filter(|(film, _)| film.quality.jacobian < bounds::JACOBIAN);
    let misshapen = films.map(|(film, face)| Warning::MisshapenElements { face, quality: film.quality });
    let settled = outcome.relaxation.and_then(|relaxation| match relaxation {
        relaxation if !relaxation.is_in_equilibrium() || relaxation.is_given_up() => {
            Some(Warning::NotInEquilibrium(relaxation))
        }
        relaxation if relaxation.steps > 0 => Some(Warning::Settled(relaxation)),
        _ => None,
    });
    let springs = spring_step.filter(SpringStep::is_much_shorter).map(Warning::StepOfSprings);
    let heavy = outcome.added_mass.iter().zip(1..).filter(|(added, _)| added.mass > bounds::ADDED_MASS * added.own);
    let heavy = heavy.map(|(added, face)| Warning::AddedMass { face, share: added.mass / added.own });
    misshapen.chain(settled).chain(springs).chain(heavy).collect()
}

/// The finding of a drop on film that came near the break strain of its curves.
fn break_strain_of_coupons(outcome: &Outcome, model: &Model) -> Option<Warning> {
    let of_curves = |face: &Face| {
        face.material.rupture.is_none()
            && !face.break_is_moved
            && matches!(face.material.law, Law::Fabric(_) | Law::RateFabric(_))
    };
    let is_drop = matches!(model.loading, Loading::Impact(_)) && model.faces.iter().all(of_curves);
    let (broke, share) = (outcome.rupture_time.is_some(), if is_drop { share_of_break(outcome, model) } else { 0.0 });
    (share > bounds::OF_BREAK).then_some(Warning::BreakStrainOfCoupons { broke, share })
}

/// The findings of heat that leaves film in a test of this time (s), or that its curves hold already.
fn of_heat(model: &Model, time: f64) -> Vec<Warning> {
    let faces = || model.faces.iter().zip(1..);
    let leaves = faces().filter_map(|(face, number)| {
        let cooling = cooling(face, face.thickness()).filter(|cooling| time > bounds::COOLING * cooling)?;
        Some(Warning::HeatLeaves { face: number, time, cooling })
    });
    let twice = faces().filter_map(|(face, number)| {
        // Coupons are single layers.
        let cooling = cooling(face, face.material.thickness)?;
        let ([_, rate], [strain, other]) = (face.material.measured_rates?, face.material.break_strains());
        (strain.min(other) < bounds::COOLING * cooling * rate).then_some(Warning::HeatTwice { face: number, rate })
    });
    leaves.chain(twice).collect()
}

/// Largest strain of the film over the least break strain of its direction.
fn share_of_break(outcome: &Outcome, model: &Model) -> f64 {
    let least = |fibre: usize| {
        model.faces.iter().map(|face| face.material.break_strains()[fibre]).fold(f64::INFINITY, f64::min)
    };
    let largest =
        |column: Column| outcome.signals.channel(column.name).into_iter().flatten().copied().fold(0.0, f64::max);
    f64::max(largest(column::MAX_STRAIN_MD) / least(0), largest(column::MAX_STRAIN_TD) / least(1))
}

/// Shear angle at which the curve of a law ends, rad; one straight piece is a modulus, and ends nowhere.
fn end_of_shear(law: &Law) -> f64 {
    let curve = match law {
        Law::Fabric(fabric) => fabric.shear(),
        Law::RateFabric(fabric) => fabric.shear(),
        _ => return f64::INFINITY,
    };
    if curve.points().len() > 1 { curve.end() } else { f64::INFINITY }
}

/// Elements that are not broken: others carry no load.
fn intact(strains: &[ElementStrain]) -> impl Iterator<Item = &ElementStrain> {
    strains.iter().filter(|strain| strain.volume > 0.0 && !strain.has_failed())
}

/// Largest shear angle, rad.
fn largest_shear(strains: &[ElementStrain]) -> f64 {
    intact(strains).map(|strain| strain.strain[2].abs()).fold(0.0, f64::max)
}

/// Whether film is strained so far that its law may give no thickness, for which 1 + 2E₃₃ of linear elastic film, and so
/// 1 − 2 (E₁₁ + E₂₂), must be below zero at a point: no fibre of other film has 0.22.
fn may_lose_thickness(law: &Law, strains: &[ElementStrain]) -> bool {
    /// That with room for what the mean over an element leaves out.
    const STRAIN: f64 = 0.1;
    matches!(law, Law::Elastic(_) | Law::TensionField(_))
        && intact(strains).any(|strain| strain.strain[0].max(strain.strain[1]) > STRAIN)
}

/// Larger principal strain from which an element counts.
const STRAINED: f64 = 0.02;

/// Smaller principal strain over the larger one from which an element is under biaxial load.
const RATIO: f64 = 0.2;

/// Part of the volume of all that is not broken.
fn biaxial_share(strains: &[ElementStrain]) -> f64 {
    let volume = |strain: &ElementStrain| strain.volume;
    let biaxial: f64 = intact(strains).filter(|strain| is_biaxial(strain)).map(volume).sum();
    let all: f64 = intact(strains).map(volume).sum();
    if all > 0.0 { biaxial / all } else { 0.0 }
}

fn is_biaxial(strain: &ElementStrain) -> bool {
    let [md, td, shear] = strain.strain;
    let [c11, c22, c12] = [(1.0 + md).powi(2), (1.0 + td).powi(2), (1.0 + md) * (1.0 + td) * shear.sin()];
    let (mean, half) = (0.5 * (c11 + c22), (0.5 * (c11 - c22)).hypot(c12));
    let [larger, smaller] = [mean + half, mean - half].map(|square| square.max(0.0).sqrt() - 1.0);
    larger > STRAINED && smaller > RATIO * larger
}

/// Steps in which a flow curve is searched.
const STEPS: u32 = 2000;

/// Equivalent plastic strain up to `most` from which film thins by itself even in equibiaxial tension, where it does so
/// last: dσ/dp = σ/2 (Swift, J. Mech. Phys. Solids 1, 1952).
pub(super) fn thins_from(hardening: &Hardening, most: f64) -> Option<f64> {
    let step = most / f64::from(STEPS);
    let thins = |strain: &f64| {
        let [stress, next] = [*strain, strain + step].map(|strain| hardening.stress(strain));
        2.0 * (next - stress) < stress * step
    };
    (0..STEPS).map(|place| step * f64::from(place)).find(thins)
}

#[cfg(test)]
mod tests {
    use super::*;
    use membrane::material::{FlowCurve, Voce};

    fn strained(strain: [f64; 3], volume: f64) -> ElementStrain {
        ElementStrain { strain, volume, left: [1.0; 2], ..ElementStrain::default() }
    }

    #[test]
    fn the_share_is_that_of_both_principal_strains() {
        let cases = [
            ([0.1, 0.1, 0.0], true),
            ([0.1, 0.01, 0.0], false),
            ([0.01, 0.01, 0.0], false),
            ([0.3, -0.1, 0.0], false),
            // A strip that is pulled at 45 degrees: its fibres are strained alike, but by shear.
            ([0.1, 0.1, 0.19], false),
        ];
        for (strain, expected) in cases {
            assert_eq!(is_biaxial(&strained(strain, 1.0)), expected, "{strain:?}");
        }
        let film = [strained([0.1, 0.1, 0.0], 1.0), strained([0.1, 0.0, 0.0], 3.0), strained([0.5, 0.5, 0.0], 0.0)];
        assert!((biaxial_share(&film) - 0.25).abs() < 1e-12);
        assert_eq!(biaxial_share(&[]), 0.0);
    }

    #[test]
    fn broken_elements_are_not_sheared() {
        let broken = ElementStrain { left: [0.0, 1.0], ..strained([0.1, 0.0, 0.9], 1.0) };
        let film =
            [broken, strained([0.0, 0.1, 0.25], 1.0), strained([0.0, 0.1, -0.5], 1.0), strained([0.0, 0.0, 0.8], 0.0)];
        assert_eq!([&film[..], &film[..2], &film[..1]].map(largest_shear), [0.5, 0.25, 0.0]);
    }

    #[test]
    fn a_saturating_film_thins_where_swift_says() {
        let (initial, saturation, rate) = (8e6, 20e6, 8.0);
        let found = thins_from(&Hardening::Voce(Voce { initial, saturation, rate }), 1.0).unwrap();
        let expected = (2.0 * (saturation - initial) * (rate + 0.5) / saturation).ln() / rate;
        assert!((found - expected).abs() < 2e-3, "{found} for {expected}");
    }

    #[test]
    fn film_that_stiffens_does_not() {
        let curve = FlowCurve::new(&[[0.0, 8e6], [0.5, 20e6], [1.0, 40e6]]).unwrap();
        assert_eq!(thins_from(&Hardening::Table(curve), 0.9), None);
    }
}
