//! Warnings of a run.

use std::fmt;

use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use crate::mesh::Quality;
use crate::model::{ImpactorShape, Model};
use base::codes;
use base::finding::{Code, Report};
use base::number;
use membrane::engine::Relaxation;

codes! {
    MISSHAPEN_ELEMENTS = "misshapen-elements", Warning,
        "an element of the mesh has a small scaled Jacobian: it is far from a square or an equilateral triangle, and \
         its strains and its stable time step are poor",
        "mesh the outline again with better shaped elements; `droptower check` names the worst of them";
    ADDED_MASS = "added-mass", Warning,
        "`solver.smallest_step` added more than 5 % to the mass of a face: waves in it and its inertia are not those of \
         the film",
        "set a shorter `solver.smallest_step`, or leave it out";
    SETTLED = "settled", Note,
        "the film was not mounted in equilibrium with its pre-strain and its weight, and was brought to it before the \
         test, without impactor; strains and energies count from there",
        "nothing; `settle = false` in `[layers]` or a `[[layer]]` starts from film as mounted";
    NOT_IN_EQUILIBRIUM = "not-in-equilibrium", Warning,
        "the film is out of balance with its pre-strain or its weight when the test starts, so that it moves by itself",
        "leave out `settle = false`; where the film has no equilibrium, such as slack film under its weight, give \
         it a pre-strain";
    NO_CONTACT = "no-contact", Warning,
        "the impactor passed the film, or did not reach it, without touching it: its signals are those of a free fall",
        "correct `impactor.position` or the outline of the film, or use a longer duration";
    FILM_NOT_MET = "no-film-contact", Note,
        "the impactor met other impactors or the frame's bars, but never the film: its displacement counts from its \
         start, and it has no lowest point, no rebound and no energy absorption",
        "nothing, where that is meant; otherwise correct `impactor.position` or use a longer duration";
    COARSE_CONTACT = "coarse-contact", Warning,
        "elements in contact are large compared with the impactor, so that the film takes its shape only approximately",
        "use a smaller `specimen.mesh.size`";
    PENETRATION = "penetration", Warning,
        "elements penetrate the impactor between nodes in contact",
        "use a smaller `specimen.mesh.size`";
    FRAME_HIT = "frame-hit", Warning,
        "the impactor hit the frame: with `frame.bars` it meets them with its own restitution, rigidly, so that peaks from \
         then on are those of a rigid frame; without them the frame is not modelled, so that the motion from then on is not \
         that of a test",
        "shorten the test, use a stiffer film or a lower impact energy, or model the frame with `frame.bars`";
    CLAMP_SLIP = "clamp-slip", Warning,
        "film slipped in the frame's clamp: its pull exceeded the force of friction there; its edge stays at its height, \
         or on its bar, wherever it slips to, so that the run holds for a slip that is small against the opening and the \
         arc on the bar",
        "use a larger `frame.clamp.force`, or `frame.clamp.width`, after which film is free";
    CLAMP_LEFT = "clamp-left", Warning,
        "film slipped out of the frame's clamp by more than `frame.clamp.width`: there nothing holds it any more",
        "use a larger `frame.clamp.force`, or a stiffer film or a lower impact energy";
    STRAIN_LOCALISATION = "strain-localisation", Warning,
        "one element is strained much more than its neighbours; with a softening law or a coarse mesh the result from \
         then on depends on the mesh",
        "compare with a finer `specimen.mesh.size` and do not use figures from after that time";
    ELEMENTS_TOO_WIDE = "elements-too-wide", Warning,
        "an element that reached its limit away from a tear stored more energy than its tear takes: the rest was lost with \
         it, so that where and when a tear starts depends on the mesh",
        "use a smaller `specimen.mesh.size`, or a lower limit: an element stores at its limit less than \
         `specimen.material.rupture.energy` over its width";
    FILM_CROSSING = "film-crossing", Warning,
        "one face of film passed through another, which film does not",
        "use a smaller `specimen.mesh.size` or `solver.step_factor`, and do not use what follows";
    FILM_CONTACT_LOST = "film-contact-lost", Note,
        "contact between faces was given up at a node or at two edges and found again later: where film folds sharply or \
         leaves the outline of another face, its side is no longer known",
        "look at these places in the recording; a smaller `specimen.mesh.size` resolves folds";
    FILM_CONTACT_UNRESOLVED = "film-contact-unresolved", Note,
        "the impulses between faces did not converge in many steps, so that faces come closer there than their thickness",
        "look at `film_distance_m`; a larger `specimen.mesh.size` or fewer faces on each other converge sooner";
    UNFINISHED = "unfinished", Warning,
        "the run ends while the impactor is still in contact, so that rebound and energy absorption are not final",
        "use a longer `loading.impact.duration`";
    FEWER_SNAPSHOTS = "fewer-snapshots", Warning,
        "the recording has fewer snapshots than `output.frames`, because more of so fine a mesh would take too much \
         memory; signals and figures are not affected",
        "use a lower `output.frames` or a larger `specimen.mesh.size`";
    ENERGY_BALANCE = "energy-balance", Warning,
        "the sum of all energies changed by more than 1 % of the energy exchanged; above 10 % the run stops",
        "use a smaller `solver.step_factor` or a finer mesh";
    STRAIN_RATE_OUTSIDE = "strain-rate-outside", Warning,
        "more than 5 % of the film's strain increments lie outside the strain rates at which its curves were measured",
        "use curves that were measured at the rates of the test (`strain_rates` in the summary)";
    HARDENING_EXCEEDED = "hardening-exceeded", Warning,
        "plastic film flowed beyond the last point of its flow curve, from which on the flow stress is taken as constant",
        "measure the hardening up to the plastic strain of the test (`specimen.material.plastic.hardening.curve`), or give \
         Voce's law";
    NOT_QUASI_STATIC = "not-quasi-static", Warning,
        "the kinetic energy of the film exceeds 1 % of the energy that it took up: inertia affects the force",
        "load more slowly or set a lower `mass_scaling`";
    BARELY_QUASI_STATIC = "barely-quasi-static", Warning,
        "the kinetic energy of the film exceeds 0.2 % of the energy that it took up; the bound is 1 %",
        "load more slowly or set a lower `mass_scaling` where accuracy matters";
}

/// The body that a warning is about: the only impactor, one of several by its name, or the bars of the frame.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ImpactorName(Name);

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
enum Name {
    Only,
    OfSeveral(String),
    Bars,
}

impl ImpactorName {
    /// The only one of a scene.
    pub fn only() -> ImpactorName {
        ImpactorName(Name::Only)
    }

    /// The bars of the frame.
    pub(super) fn bars() -> ImpactorName {
        ImpactorName(Name::Bars)
    }

    /// That at this place among the impactors of `model`.
    pub(super) fn of(model: &Model, place: usize) -> ImpactorName {
        ImpactorName::named(model.names().get(place).copied().flatten())
    }

    /// The only one, or that of this name.
    pub(super) fn named(name: Option<&str>) -> ImpactorName {
        ImpactorName(name.map_or(Name::Only, |name| Name::OfSeveral(name.to_owned())))
    }

    /// Its name among the figures.
    fn figure(&self) -> Option<(&'static str, Value)> {
        match &self.0 {
            Name::Only => None,
            Name::OfSeveral(name) => Some(("impactor", Value::from(name.as_str()))),
            Name::Bars => Some(("body", Value::from("frame.bars"))),
        }
    }

    /// As the owner of something.
    fn possessive(&self) -> String {
        match &self.0 {
            Name::Only => "the impactor's".to_owned(),
            Name::OfSeveral(name) => format!("the \"{name}\" impactor's"),
            Name::Bars => "the frame's bars'".to_owned(),
        }
    }

    /// In the possessive form of a pronoun.
    fn its(&self) -> &'static str {
        if self.0 == Name::Bars { "their" } else { "its" }
    }
}

impl fmt::Display for ImpactorName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.0 {
            Name::Only => f.write_str("the impactor"),
            Name::OfSeveral(name) => write!(f, "the impactor \"{name}\""),
            Name::Bars => f.write_str("the frame's bars"),
        }
    }
}

/// The length of a body with which elements and penetrations are compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum BodySize {
    /// Of a body that is round, or of bars.
    Radius,
    /// Half the smallest extent of any other.
    HalfExtent,
}

impl BodySize {
    /// That of a body of this shape.
    pub(super) fn of(shape: &ImpactorShape) -> BodySize {
        match shape {
            ImpactorShape::Sphere { .. } | ImpactorShape::Hemisphere { .. } | ImpactorShape::Capsule { .. } => {
                BodySize::Radius
            }
            ImpactorShape::Cylinder { .. }
            | ImpactorShape::Cone { .. }
            | ImpactorShape::Box { .. }
            | ImpactorShape::Mesh { .. }
            | ImpactorShape::Compound(_) => BodySize::HalfExtent,
        }
    }
}

impl fmt::Display for BodySize {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            BodySize::Radius => "radius",
            BodySize::HalfExtent => "half smallest extent",
        })
    }
}

/// What puts figures of a run in doubt. Faces are counted from one.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Warning {
    /// The mesh of a face has an element with a small scaled Jacobian.
    MisshapenElements {
        /// The face.
        face: usize,
        /// Shape of its elements, the worst of them.
        quality: Quality,
    },
    /// Much mass was added to a face.
    AddedMass {
        /// The face.
        face: usize,
        /// Added mass over its own.
        share: f64,
    },
    /// The film was brought to equilibrium before the test.
    Settled(Relaxation),
    /// The test starts with film out of balance.
    NotInEquilibrium(Relaxation),
    /// The impactor did not touch the film.
    NoContact(ImpactorName),
    /// The impactor met other bodies alone.
    NoFilmContact(ImpactorName),
    /// Elements in contact are large compared with the impactor.
    CoarseContact {
        /// Which one.
        impactor: ImpactorName,
        /// When the bound was exceeded first, s.
        time: f64,
        /// Longest edge in contact over the size of the impactor.
        edge: f64,
        /// What that size is.
        size: BodySize,
    },
    /// Elements penetrate the impactor.
    Penetration {
        /// Which one.
        impactor: ImpactorName,
        /// When the bound was exceeded first, s.
        time: f64,
        /// Largest penetration over the size of the impactor.
        depth: f64,
        /// What that size is.
        size: BodySize,
    },
    /// The impactor reached the frame.
    FrameHit {
        /// Which one.
        impactor: ImpactorName,
        /// When it did first, s.
        time: f64,
        /// Whether the frame has bars, which it met.
        has_bars: bool,
    },
    /// Film slipped in the clamp.
    ClampSlip {
        /// When it was seen first, s.
        time: f64,
        /// Largest slip, m.
        slip: f64,
    },
    /// Film slipped out of the clamp.
    ClampLeft {
        /// When it was seen first, s.
        time: f64,
        /// Share of the held length.
        share: f64,
    },
    /// One element is strained much more than its neighbours.
    StrainLocalisation {
        /// When it was found first, s.
        time: f64,
        /// Largest engineering strain of the element.
        strain: f64,
        /// Its face.
        face: usize,
    },
    /// One face passed through another.
    FilmCrossing {
        /// When it did first, s.
        time: f64,
        /// Largest depth, m.
        depth: f64,
    },
    /// Contact between faces was given up somewhere.
    FilmContactLost {
        /// When it was first, s.
        time: f64,
        /// How often.
        times: u64,
    },
    /// The impulses between faces did not converge in many steps.
    FilmContactUnresolved {
        /// In how many.
        steps: u64,
        /// All steps.
        of: u64,
    },
    /// The impactor is still in contact at the end.
    Unfinished(ImpactorName),
    /// Fewer snapshots than requested.
    FewerSnapshots {
        /// Requested.
        wanted: usize,
        /// Taken.
        taken: usize,
        /// Memory that all snapshots may take, bytes.
        memory: f64,
    },
    /// The energy balance is off.
    EnergyBalance {
        /// Largest error over the energy exchanged.
        error: f64,
    },
    /// Strain increments outside the measured strain rates.
    StrainRateOutside {
        /// Share of the strain increments.
        share: f64,
    },
    /// An element stored more than its tear takes.
    ElementsTooWide {
        /// Its width across the tear, m.
        width: f64,
        /// What it stored over what its tear takes.
        ratio: f64,
    },
    /// Plastic film flowed beyond its flow curve.
    HardeningExceeded {
        /// Number of the face, from one.
        face: usize,
        /// Largest equivalent plastic strain.
        strain: f64,
        /// Equivalent plastic strain at the end of the curve.
        end: f64,
    },
    /// A slow test whose inertia matters.
    NotQuasiStatic {
        /// Largest share of kinetic energy in the energy that the film took up.
        share: f64,
    },
    /// A slow test whose inertia nearly matters.
    BarelyQuasiStatic {
        /// Largest share of kinetic energy in the energy that the film took up.
        share: f64,
    },
}

/// Bounds above which a run has a warning.
pub(super) mod bounds {
    /// Scaled Jacobian of an element, a lower bound.
    pub(in crate::simulate) const JACOBIAN: f64 = 0.3;
    /// Added mass over that of a face.
    pub(in crate::simulate) const ADDED_MASS: f64 = 0.05;
    /// Edge of an element in contact over the radius of the impactor.
    pub(in crate::simulate) const EDGE: f64 = 0.25;
    /// Penetration over the radius of the impactor.
    pub(in crate::simulate) const PENETRATION: f64 = 0.01;
    /// Strain of one element over the mean of its neighbours.
    pub(in crate::simulate) const LOCALISATION: f64 = 2.0;

    /// Share of the steps in which the impulses between faces may not converge.
    pub(in crate::simulate) const UNRESOLVED: f64 = 0.01;
    /// Strain below which localisation is not looked for.
    pub(in crate::simulate) const LOCALISED_STRAIN: f64 = 0.5;
    /// Error of the energy balance.
    pub(in crate::simulate) const BALANCE: f64 = 0.01;
    /// Share of the strain increments outside the measured rates.
    pub(in crate::simulate) const RATES: f64 = 0.05;
    /// Kinetic share of a quasi-static test.
    pub(in crate::simulate) const KINETIC: f64 = 0.01;
    /// Kinetic share of a test that is barely quasi-static.
    pub(in crate::simulate) const BARELY: f64 = 0.2 * KINETIC;
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let percent = |share: &f64| number::significant(100.0 * share, 2);
        match self {
            Warning::MisshapenElements { face, quality } => write!(f, "misshapen elements in face {face}: {quality}"),
            Warning::AddedMass { face, share } => write!(
                f,
                "added mass: small elements of face {face} got {} % of its mass (bound {} %)",
                percent(share),
                percent(&bounds::ADDED_MASS)
            ),
            Warning::Settled(Relaxation { mounted, residual, steps, displacement, .. }) => {
                let [mounted, residual] = [mounted, residual].map(|residual| number::figure(*residual, 2));
                write!(
                    f,
                    "settled before the test: forces out of balance fell from {mounted} to {residual} of the reactions \
                     in {} steps, in which the film moved by up to {} mm",
                    number::grouped(*steps),
                    number::figure(1e3 * displacement, 3)
                )
            }
            Warning::NotInEquilibrium(Relaxation { residual, .. }) => write!(
                f,
                "not in equilibrium: at the start forces out of balance are {} of the reactions",
                number::figure(*residual, 2)
            ),
            Warning::NoContact(impactor) => {
                write!(f, "no contact: {impactor} did not touch the film during the whole test")
            }
            Warning::NoFilmContact(impactor) => {
                write!(f, "no contact with the film: {impactor} touched other bodies only")
            }
            Warning::CoarseContact { impactor, time, edge, size } => write!(
                f,
                "coarse contact: from {} edges in contact are up to {} of {} {size} (bound {})",
                number::duration(*time),
                number::figure(*edge, 2),
                impactor.possessive(),
                bounds::EDGE
            ),
            Warning::Penetration { impactor, time, depth, size } => write!(
                f,
                "penetration: from {} elements penetrate {impactor} by up to {} % of {} {size} (bound {} %)",
                number::duration(*time),
                percent(depth),
                impactor.its(),
                percent(&bounds::PENETRATION)
            ),
            Warning::FrameHit { impactor, time, has_bars: false } => write!(
                f,
                "{impactor} reached the clamped edge at {}: the frame itself is not modelled",
                number::duration(*time)
            ),
            Warning::FrameHit { impactor, time, has_bars: true } => {
                write!(f, "{impactor} hit the bars of the frame at {}", number::duration(*time))
            }
            Warning::ClampSlip { time, slip } => write!(
                f,
                "clamp slip: from {} film slips in its clamp, by up to {} mm",
                number::duration(*time),
                number::figure(1e3 * slip, 3)
            ),
            Warning::ClampLeft { time, share } => write!(
                f,
                "film left its clamp: from {} on, in the end along {} % of the held length",
                number::duration(*time),
                percent(share)
            ),
            Warning::StrainLocalisation { time, strain, face } => write!(
                f,
                "strain localisation: at {} one element of face {face} is strained to {}, over {} times its \
                 neighbours; the result depends on the mesh from there on",
                number::duration(*time),
                number::figure(*strain, 2),
                number::figure(bounds::LOCALISATION, 2)
            ),
            Warning::FilmCrossing { time, depth } => write!(
                f,
                "film crossing: from {} one face passes through another by up to {} mm",
                number::duration(*time),
                number::figure(1e3 * depth, 2)
            ),
            Warning::FilmContactLost { time, times } => write!(
                f,
                "film contact lost: from {} contact between faces was given up {times} times at a node or at two edges",
                number::duration(*time)
            ),
            Warning::FilmContactUnresolved { steps, of } => {
                write!(
                    f,
                    "film contact unresolved: the impulses between faces did not converge in {steps} of {of} steps"
                )
            }
            Warning::Unfinished(impactor) => write!(
                f,
                "the run ends while {impactor} is still in contact: rebound and energy absorption are not final",
            ),
            Warning::FewerSnapshots { wanted, taken, memory } => write!(
                f,
                "the recording has {taken} snapshots instead of {wanted}: more of so fine a mesh would take more than \
                 {} GB",
                number::figure(1e-9 * memory, 2)
            ),
            Warning::EnergyBalance { error } => {
                write!(f, "energy balance error {} % of the energy exchanged", percent(error))
            }
            Warning::StrainRateOutside { share } => write!(
                f,
                "strain rate: {} % of the strain increments lie outside the rates at which the curves were measured",
                percent(share)
            ),
            Warning::HardeningExceeded { face, strain, end } => write!(
                f,
                "face {face} reached the equivalent plastic strain {}, its flow curve ends at {}",
                number::significant(*strain, 3),
                number::significant(*end, 3)
            ),
            Warning::ElementsTooWide { width, ratio } => write!(
                f,
                "elements too wide for the fracture energy: one of {} mm stored {} times what its tear takes; the widest \
                 that fits is {} mm",
                number::significant(1e3 * width, 3),
                number::significant(*ratio, 3),
                number::significant(1e3 * width / ratio, 2)
            ),
            Warning::NotQuasiStatic { share } => {
                write!(
                    f,
                    "not quasi-static: kinetic energy is up to {} % of the energy that the film took up",
                    percent(share)
                )
            }
            Warning::BarelyQuasiStatic { share } => write!(
                f,
                "barely quasi-static: kinetic energy is up to {} % of the energy that the film took up (bound {} %)",
                percent(share),
                percent(&bounds::KINETIC)
            ),
        }
    }
}

impl Report for Warning {
    fn code(&self) -> &'static Code {
        match self {
            Warning::MisshapenElements { .. } => &MISSHAPEN_ELEMENTS,
            Warning::AddedMass { .. } => &ADDED_MASS,
            Warning::Settled(_) => &SETTLED,
            Warning::NotInEquilibrium(_) => &NOT_IN_EQUILIBRIUM,
            Warning::NoContact(_) => &NO_CONTACT,
            Warning::NoFilmContact(_) => &FILM_NOT_MET,
            Warning::CoarseContact { .. } => &COARSE_CONTACT,
            Warning::Penetration { .. } => &PENETRATION,
            Warning::FrameHit { .. } => &FRAME_HIT,
            Warning::ClampSlip { .. } => &CLAMP_SLIP,
            Warning::ClampLeft { .. } => &CLAMP_LEFT,
            Warning::StrainLocalisation { .. } => &STRAIN_LOCALISATION,
            Warning::FilmCrossing { .. } => &FILM_CROSSING,
            Warning::FilmContactLost { .. } => &FILM_CONTACT_LOST,
            Warning::FilmContactUnresolved { .. } => &FILM_CONTACT_UNRESOLVED,
            Warning::Unfinished(_) => &UNFINISHED,
            Warning::FewerSnapshots { .. } => &FEWER_SNAPSHOTS,
            Warning::EnergyBalance { .. } => &ENERGY_BALANCE,
            Warning::StrainRateOutside { .. } => &STRAIN_RATE_OUTSIDE,
            Warning::ElementsTooWide { .. } => &ELEMENTS_TOO_WIDE,
            Warning::HardeningExceeded { .. } => &HARDENING_EXCEEDED,
            Warning::NotQuasiStatic { .. } => &NOT_QUASI_STATIC,
            Warning::BarelyQuasiStatic { .. } => &BARELY_QUASI_STATIC,
        }
    }

    fn figures(&self) -> Map<String, Value> {
        let about = match self {
            Warning::NoContact(impactor)
            | Warning::NoFilmContact(impactor)
            | Warning::Unfinished(impactor)
            | Warning::CoarseContact { impactor, .. }
            | Warning::Penetration { impactor, .. }
            | Warning::FrameHit { impactor, .. } => Some(impactor),
            _ => None,
        };
        let figures: &[(&str, Value)] = match *self {
            Warning::MisshapenElements { face, quality } => {
                &[("face", face.into()), ("scaled_jacobian", quality.jacobian.into())]
            }
            Warning::Settled(relaxation) | Warning::NotInEquilibrium(relaxation) => {
                let Relaxation { mounted, residual, steps, displacement, .. } = relaxation;
                &[
                    ("mounted_residual", mounted.into()),
                    ("residual", residual.into()),
                    ("steps", steps.into()),
                    ("displacement_m", displacement.into()),
                ]
            }
            Warning::CoarseContact { time, edge, .. } => &[("time_s", time.into()), ("edge_over_radius", edge.into())],
            Warning::Penetration { time, depth, .. } => {
                &[("time_s", time.into()), ("penetration_over_radius", depth.into())]
            }
            Warning::FrameHit { time, has_bars, .. } => &[("time_s", time.into()), ("bars", has_bars.into())],
            Warning::ClampSlip { time, slip } => &[("time_s", time.into()), ("slip_m", slip.into())],
            Warning::ClampLeft { time, share } => &[("time_s", time.into()), ("share", share.into())],
            Warning::FilmCrossing { time, depth } => &[("time_s", time.into()), ("depth_m", depth.into())],
            Warning::FilmContactLost { time, times } => &[("time_s", time.into()), ("times", times.into())],
            Warning::FilmContactUnresolved { steps, of } => &[("steps", steps.into()), ("of", of.into())],
            Warning::StrainLocalisation { time, strain, face } => {
                &[("time_s", time.into()), ("strain", strain.into()), ("face", face.into())]
            }
            Warning::AddedMass { face, share } => &[("face", face.into()), ("added_mass_share", share.into())],
            Warning::NoContact(_) | Warning::NoFilmContact(_) | Warning::Unfinished(_) => &[],
            Warning::FewerSnapshots { wanted, taken, .. } => &[("wanted", wanted.into()), ("taken", taken.into())],
            Warning::EnergyBalance { error } => &[("energy_balance_error", error.into())],
            Warning::StrainRateOutside { share } => &[("share", share.into())],
            Warning::ElementsTooWide { width, ratio } => {
                &[("width_m", width.into()), ("stored_over_fracture_energy", ratio.into())]
            }
            Warning::HardeningExceeded { face, strain, end } => {
                &[("face", face.into()), ("plastic_strain", strain.into()), ("curve_end", end.into())]
            }
            Warning::NotQuasiStatic { share } | Warning::BarelyQuasiStatic { share } => {
                &[("kinetic_share", share.into())]
            }
        };
        let named = about.into_iter().flat_map(ImpactorName::figure);
        named.chain(figures.iter().cloned()).map(|(name, value)| (name.to_owned(), value)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use base::finding::Finding;

    #[test]
    fn a_warning_states_the_fact_and_its_figures() {
        let size = BodySize::Radius;
        let finding =
            Finding::new(&Warning::CoarseContact { impactor: ImpactorName::only(), time: 0.0123, edge: 0.4, size });
        let size = BodySize::HalfExtent;
        let of_box = Warning::Penetration { impactor: ImpactorName::only(), time: 0.0123, depth: 0.02, size };
        assert!(of_box.to_string().contains("by up to 2 % of its half smallest extent"), "{of_box}");
        let message =
            "coarse contact: from 12.3 ms edges in contact are up to 0.40 of the impactor's radius (bound 0.25)";
        assert_eq!((finding.code.as_str(), finding.message.as_str()), ("coarse-contact", message));
        for (warning, expected) in [
            (
                Warning::StrainLocalisation { time: 0.0412, strain: 0.687, face: 1 },
                "strain localisation: at 41.2 ms one element of face 1 is strained to 0.69, over 2.0 times its \
                 neighbours; the result depends on the mesh from there on",
            ),
            (
                Warning::BarelyQuasiStatic { share: 0.00213 },
                "barely quasi-static: kinetic energy is up to 0.21 % of the energy that the film took up (bound 1 %)",
            ),
        ] {
            assert_eq!(warning.to_string(), expected);
        }
        assert_eq!(serde_json::to_string(&finding.figures).unwrap(), r#"{"time_s":0.0123,"edge_over_radius":0.4}"#);
    }
}
