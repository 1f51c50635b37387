//! The bounds that a run is checked against while it steps.

use serde::{Deserialize, Serialize};

use super::biaxial::biaxial_share;
use super::channels::Sample;
use super::film::Film;
use super::spring_step::SpringStep;
use super::thinning::thins_from;
use super::warning::{BodySize, ImpactorName, Warning, bounds};
use crate::model::{Face, Loading, Model, SNAPSHOT_MEMORY};
use membrane::engine::{
    self, AddedMass, ContactState, ElementStrain, FilmContactState, Relaxation, SpringsState, TooWide, View,
};
use membrane::material::Law;

/// Figures that are known only at the end of a run.
pub(super) struct Figures<'a> {
    /// Whether each impactor reached the end of the test without contact.
    pub(super) missed: Vec<bool>,
    /// Whether each met other bodies by then, but not the film.
    pub(super) met_others_alone: Vec<bool>,
    /// How the film came to equilibrium.
    pub(super) relaxation: Option<Relaxation>,
    /// Error of the energy balance.
    pub(super) balance: f64,
    /// Share of the strain increments outside the measured rates.
    pub(super) outside: f64,
    /// Largest equivalent plastic strain of each face, where its law has one.
    pub(super) plastic: Vec<Option<f64>>,
    /// Kinetic share of a slow test.
    pub(super) kinetic: Option<f64>,
    /// Mass added to the small elements of each face.
    pub(super) added_mass: &'a [AddedMass],
    /// What springs of the frame make of the time step.
    pub(super) spring_step: Option<SpringStep>,
    /// Snapshots requested and taken.
    pub(super) snapshots: [usize; 2],
    /// Whether each impactor is still in contact at the end.
    pub(super) unfinished: Vec<bool>,
    /// When film first broke.
    pub(super) rupture_time: Option<f64>,
    /// At the end of the run, s.
    pub(super) time: f64,
}

/// Heat that film gives to still air and by radiation through each side, W/(m² K); assumed.
const TO_AIR: f64 = 10.0;

/// Time (s) in which so much (m) of the film of a face gives two thirds of its heat to still air, where it warms up.
fn cooling(face: &Face, thickness: f64) -> Option<f64> {
    Some(face.material.thermal?.capacity * thickness / (2.0 * TO_AIR))
}

/// For each bound, the first time at which it was exceeded, and the largest excess.
#[derive(Serialize, Deserialize)]
pub(super) struct Monitor {
    contacts: Vec<ContactMonitor>,
    localised: Option<(f64, f64, usize)>,
    /// Time (s), share and place of the face whose largest part of too little coupled fabric is under biaxial load.
    biaxial: Option<(f64, f64, usize)>,
    crossed: Option<(f64, f64)>,
    /// First time (s) at which film was farther behind a mirror plane than it is thick, and how far at most (m).
    behind: Option<(f64, f64)>,
    lost: Option<(f64, u64)>,
    /// Steps in which the impulses between faces did not converge, and all steps.
    unresolved: [u64; 2],
    /// First time (s) and largest slip (m) of film in its clamp.
    slip: Option<(f64, f64)>,
    /// First time (s) and share of the held length of film that left its clamp.
    left: Option<(f64, f64)>,
    /// First time (s) and largest share of slack springs.
    slack: Option<(f64, f64)>,
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

/// The bounds on the contact of one impactor.
#[derive(Clone, Default, Serialize, Deserialize)]
struct ContactMonitor {
    edge: Option<(f64, f64)>,
    penetration: Option<(f64, f64)>,
    frame_hit: Option<f64>,
    /// Time (s) and length (m) of the longest travel in one step.
    travel: (f64, f64),
    /// Size of the body, m; zero before the first audit.
    size: f64,
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

impl ContactMonitor {
    /// Records the state of contact at `time` (s) on an impactor of `size` (m).
    fn record(&mut self, time: f64, size: f64, state: &ContactState) {
        self.size = size;
        let (edge, depth) = (state.longest_edge / size, state.penetration / size);
        if edge > bounds::EDGE && self.edge.is_none_or(|(_, worst)| edge > worst) {
            self.edge = Some((self.edge.map_or(time, |c| c.0), edge));
        }
        if depth > bounds::PENETRATION && self.penetration.is_none_or(|(_, worst)| depth > worst) {
            self.penetration = Some((self.penetration.map_or(time, |c| c.0), depth));
        }
        if state.frame_hit {
            self.hits_frame(time);
        }
    }

    fn hits_frame(&mut self, time: f64) {
        self.frame_hit.get_or_insert(time);
    }

    /// The warnings of the impactor `name`, whose size is this one; whether the frame has bars.
    fn warnings(&self, name: &ImpactorName, size: BodySize, has_bars: bool) -> impl Iterator<Item = Warning> {
        let impactor = || name.clone();
        let edge = self.edge.map(|(time, edge)| Warning::CoarseContact { impactor: impactor(), time, edge, size });
        let depth =
            self.penetration.map(|(time, depth)| Warning::Penetration { impactor: impactor(), time, depth, size });
        let hit = self.frame_hit.map(|time| Warning::FrameHit { impactor: name.clone(), time, has_bars });
        let (time, travel) = (self.travel.0, self.travel.1 / self.size);
        let too_fast = (self.size > 0.0 && travel > bounds::TRAVEL).then(|| Warning::TooFast {
            impactor: impactor(),
            time,
            travel,
            size,
        });
        [too_fast, edge, depth, hit].into_iter().flatten()
    }
}

/// Records a `value` at `time` (s) that is a finding where it is positive: when it first is, and the largest.
fn record(recorded: &mut Option<(f64, f64)>, time: f64, value: f64) {
    if value > 0.0 {
        let (first, most) = recorded.unwrap_or((time, 0.0));
        *recorded = Some((first, value.max(most)));
    }
}

impl Monitor {
    /// The monitor of a run of `model`: its impactors, and bars after them.
    pub(super) fn new(model: &Model) -> Monitor {
        let has_bars = model.frame.bars.is_some();
        let contacts = vec![ContactMonitor::default(); model.impactors.len() + usize::from(has_bars)];
        let thickness = |face: &Face| face.material.thickness * f64::from(face.layers);
        Monitor {
            contacts,
            localised: None,
            biaxial: None,
            crossed: None,
            behind: None,
            lost: None,
            unresolved: [0; 2],
            slip: None,
            left: None,
            slack: None,
            too_wide: None,
            returned: None,
            has_bars,
            mirrors: model.specimen.symmetry.mirrors(),
            thickness: model.faces.iter().map(thickness).fold(f64::INFINITY, f64::min),
        }
    }

    /// Records the state of contact at `time` (s) on the body of this index and `size` (m).
    pub(super) fn contact(&mut self, body: usize, time: f64, size: f64, state: &ContactState) {
        // With bars, it is them that an impactor reaches.
        let frame_hit = state.frame_hit && !self.has_bars;
        self.contacts[body].record(time, size, &ContactState { frame_hit, ..*state });
    }

    /// Records that the body of this index travels so far (m) in the step at `time` (s).
    pub(super) fn travel(&mut self, body: usize, time: f64, length: f64) {
        let longest = &mut self.contacts[body].travel;
        if length > longest.1 {
            *longest = (time, length);
        }
    }

    /// Records that the impactor of this index met the frame's bars at `time` (s).
    pub(super) fn frame_hit(&mut self, impactor: usize, time: f64) {
        self.contacts[impactor].hits_frame(time);
    }

    /// Records the film at a sample: its slip in the clamp, its springs, its tears, and contact between its faces.
    pub(super) fn sample(&mut self, Sample { view, clamp, springs, films, torn, .. }: &Sample<'_>) {
        if let Some(clamp) = clamp {
            self.clamp(view.time, *clamp);
        }
        if let Some(SpringsState { slack, .. }) = springs {
            record(&mut self.slack, view.time, *slack);
        }
        if torn.is_some() {
            self.too_wide = view.too_wide;
            self.returned = view.returned;
        }
        if let Some(FilmContactState { distance, lost, unresolved, .. }) = *films {
            self.films(view.time, distance, lost);
            self.unresolved = unresolved;
            self.behind_mirrors(view);
        }
    }

    /// Records film that lies behind a mirror plane, where its image is, which it does not meet.
    fn behind_mirrors(&mut self, view: &View<'_>) {
        let axes = view.nodes.position.axes();
        for (axis, _) in self.mirrors.iter().enumerate().filter(|(_, mirror)| **mirror) {
            let least = axes[axis].iter().copied().fold(0.0, f64::min);
            if -least > self.thickness {
                record(&mut self.behind, view.time, -least);
            }
        }
    }

    /// Records the largest slip (m) in the clamp at `time` (s) and the share of its length that holds film no longer.
    fn clamp(&mut self, time: f64, [slip, left]: [f64; 2]) {
        record(&mut self.slip, time, slip);
        record(&mut self.left, time, left);
    }

    /// Records the least `distance` (m) of two faces at `time` (s), and how often their contact was `lost` so far.
    fn films(&mut self, time: f64, distance: f64, lost: u64) {
        if distance < 0.0 {
            let (first, least) = self.crossed.unwrap_or((time, 0.0));
            self.crossed = Some((first, distance.min(least)));
        }
        if lost > 0 {
            self.lost = Some((self.lost.map_or(time, |(first, _)| first), lost));
        }
    }

    /// Looks for an element that is strained much more than its neighbours.
    pub(super) fn strain(&mut self, view: &View<'_>, strains: &[Vec<ElementStrain>]) {
        if self.localised.is_some() {
            return;
        }
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
                self.localised = Some((view.time, intact[worst], face + 1));
            }
        }
    }

    /// Looks for biaxial load of fabric whose directions are coupled less than those of isotropic film, and nothing says why.
    pub(super) fn biaxial(&mut self, time: f64, strains: &[Vec<ElementStrain>], model: &Model) {
        for (place, (face, strains)) in model.faces.iter().zip(strains).enumerate() {
            let is_doubtful = face.unsourced_coupling.is_some_and(|coupling| coupling < bounds::COUPLING);
            let share = if is_doubtful { biaxial_share(strains) } else { 0.0 };
            if share > bounds::BIAXIAL && self.biaxial.is_none_or(|(_, largest, _)| share > largest) {
                self.biaxial = Some((time, share, place));
            }
        }
    }

    /// Whether both are of scenes with the same bodies in contact, and this one of no more than so many faces.
    pub(super) fn is_like(&self, other: &Monitor, faces: usize) -> bool {
        let places =
            [self.biaxial.map(|(.., place)| place), self.localised.map(|(.., number)| number.saturating_sub(1))];
        let bodies = |monitor: &Monitor| (monitor.contacts.len(), monitor.has_bars);
        bodies(self) == bodies(other) && places.into_iter().flatten().all(|place| place < faces)
    }

    /// The warnings of a run of `model` on `films` that ended with `figures`.
    pub(super) fn finish(self, figures: &Figures<'_>, films: &[Film], model: &Model) -> Vec<Warning> {
        let Figures {
            missed,
            met_others_alone,
            relaxation,
            balance,
            outside,
            plastic,
            kinetic,
            added_mass,
            spring_step,
            snapshots,
            unfinished,
            rupture_time,
            time,
        } = figures;
        let [wanted, taken] = snapshots;
        let impactors = (0..model.impactors.len()).map(|place| ImpactorName::of_impactor(model, place));
        let names: Vec<ImpactorName> = impactors.chain(self.has_bars.then(ImpactorName::bars)).collect();
        let sizes =
            model.impactors.iter().map(|impactor| BodySize::from_shape(&impactor.shape)).chain([BodySize::Radius]);
        let of = |which: &[bool], warning: fn(ImpactorName) -> Warning| -> Vec<Warning> {
            let named = names.iter().zip(which).filter(|(_, is)| **is);
            named.map(|(name, _)| warning(name.clone())).collect()
        };
        let misshapen = films.iter().enumerate().filter(|(_, film)| film.quality.jacobian < bounds::JACOBIAN);
        let mut out: Vec<Warning> = misshapen
            .map(|(face, film)| Warning::MisshapenElements { face: face + 1, quality: film.quality })
            .collect();
        out.extend(relaxation.and_then(|relaxation| match relaxation {
            relaxation if !relaxation.is_in_equilibrium() || relaxation.is_given_up() => {
                Some(Warning::NotInEquilibrium(relaxation))
            }
            relaxation if relaxation.steps > 0 => Some(Warning::Settled(relaxation)),
            _ => None,
        }));
        let heavy = added_mass.iter().enumerate().filter(|(_, added)| added.mass > bounds::ADDED_MASS * added.own);
        out.extend(spring_step.filter(SpringStep::is_much_shorter).map(Warning::StepOfSprings));
        out.extend(heavy.map(|(face, added)| Warning::AddedMass { face: face + 1, share: added.mass / added.own }));
        let without_contact = names.iter().zip(missed).filter(|(_, missed)| **missed);
        out.extend(without_contact.map(|(name, _)| match rupture_time {
            Some(time) => Warning::TornBeforeContact { impactor: name.clone(), time: *time },
            None => Warning::NoContact(name.clone()),
        }));
        out.extend(of(met_others_alone, Warning::NoFilmContact));
        let bodies = self.contacts.iter().zip(&names).zip(sizes);
        out.extend(bodies.flat_map(|((contact, name), size)| contact.warnings(name, size, self.has_bars)));
        out.extend(self.slip.map(|(time, slip)| Warning::ClampSlip { time, slip }));
        out.extend(self.left.map(|(time, share)| Warning::ClampLeft { time, share }));
        out.extend(self.slack.map(|(time, share)| Warning::SpringsSlack { time, share }));
        out.extend(self.localised.map(|(time, strain, face)| Warning::StrainLocalisation { time, strain, face }));
        out.extend(self.biaxial.map(|(time, share, place)| {
            let coupling = model.faces[place].unsourced_coupling.unwrap_or_default();
            Warning::UncoupledBiaxial { time, share, face: place + 1, coupling }
        }));
        out.extend(self.too_wide.map(|TooWide { width, ratio }| Warning::ElementsTooWide { width, ratio }));
        out.extend(self.returned.map(|share| Warning::TearByLimit { share }));
        out.extend(self.behind.map(|(time, depth)| Warning::FilmBehindMirror { time, depth }));
        out.extend(self.crossed.map(|(time, distance)| Warning::FilmCrossing { time, depth: -distance }));
        out.extend(self.lost.map(|(time, times)| Warning::FilmContactLost { time, times }));
        let [steps, all] = self.unresolved;
        if steps as f64 > bounds::UNRESOLVED * all as f64 {
            out.push(Warning::FilmContactUnresolved { steps, of: all });
        }
        out.extend(of(unfinished, Warning::Unfinished));
        let (wanted, taken, balance, outside) = (*wanted, *taken, *balance, *outside);
        let nothing_hit =
            !missed.is_empty() && missed.iter().zip(met_others_alone).all(|(missed, other)| *missed || *other);
        out.extend((taken < wanted).then_some(Warning::FewerSnapshots { wanted, taken, memory: SNAPSHOT_MEMORY }));
        out.extend((balance > bounds::BALANCE).then_some(Warning::EnergyBalance { error: balance }));
        out.extend((outside > bounds::RATES && !nothing_hit).then_some(Warning::StrainRateOutside { share: outside }));
        let of_curves = |face: &Face| {
            face.material.rupture.is_none()
                && !face.break_is_moved
                && matches!(face.material.law, Law::Fabric(_) | Law::RateFabric(_))
        };
        let is_drop = matches!(model.loading, Loading::Impact(_)) && model.faces.iter().all(of_curves);
        out.extend(rupture_time.filter(|_| is_drop).map(|time| Warning::BreakStrainOfCoupons { time }));
        out.extend(plastic.iter().zip(&model.faces).enumerate().filter_map(|(place, (strain, face))| {
            let (Some(strain), Law::Plastic(law)) = (*strain, &face.material.law) else { return None };
            let end = law.hardening().end();
            // Those of snapshots have single precision.
            (strain > end + 1e-6).then_some(Warning::HardeningExceeded { face: place + 1, strain, end })
        }));
        out.extend(plastic.iter().zip(&model.faces).enumerate().filter_map(|(place, (strain, face))| {
            let (Some(strain), Law::Plastic(law)) = (*strain, &face.material.law) else { return None };
            face.material.rupture.as_ref()?;
            let from = thins_from(law.hardening(), strain)?;
            Some(Warning::ThinningBeforeBreak { face: place + 1, strain, from })
        }));
        out.extend(model.faces.iter().enumerate().filter_map(|(place, face)| {
            let layers = face.material.thickness * f64::from(face.layers);
            let cooling = cooling(face, layers).filter(|cooling| *time > bounds::COOLING * cooling)?;
            Some(Warning::HeatLeaves { face: place + 1, time: *time, cooling })
        }));
        out.extend(model.faces.iter().enumerate().filter_map(|(place, face)| {
            let [_, rate] = face.material.measured_rates?;
            let [strain, other] = face.material.break_strains();
            // Coupons are single layers.
            let holds = strain.min(other) < bounds::COOLING * cooling(face, face.material.thickness)? * rate;
            holds.then_some(Warning::HeatTwice { face: place + 1, rate })
        }));
        out.extend(kinetic.and_then(|share| match share {
            share if share > bounds::KINETIC => Some(Warning::NotQuasiStatic { share }),
            share if share > bounds::BARELY => Some(Warning::BarelyQuasiStatic { share }),
            _ => None,
        }));
        out
    }
}
