//! The energy balance of a run, term by term (theory.md, section 7).

use serde::{Deserialize, Serialize};

use super::impact::Impact;
use super::{Engine, Progress, View, film};

/// Energy that is counted step by step in halves, J: lost, or exchanged with what is outside.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub(super) struct StepEnergy {
    total: f64,
    /// Of the last step: that of the half step before the full one, and that of the half step after it.
    last: [f64; 2],
}

impl StepEnergy {
    /// Adds that of a step: of the half step before the full one, and of that after it. An impulse has each with the velocity
    /// there (theory.md, equation 22).
    pub(super) fn add(&mut self, halves: [f64; 2]) {
        self.total += halves[0] + halves[1];
        self.last = halves;
    }

    /// Adds what came before the full step.
    pub(super) fn add_at_once(&mut self, energy: f64) {
        self.total += energy;
    }

    /// With all of the last step.
    pub(super) fn total(&self) -> f64 {
        self.total
    }

    /// Until the full step: energies there leave out what follows (theory.md, equation 23). At the start, where velocities stand at
    /// the full step, both halves follow.
    fn until_full_step(&self, is_start: bool) -> f64 {
        self.total - self.last[1] - if is_start { self.last[0] } else { 0.0 }
    }
}

/// What contact dissipates.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub(super) struct ContactLoss {
    /// Where film comes into contact.
    pub(super) impact: StepEnergy,
    /// By friction.
    pub(super) friction: StepEnergy,
}

/// Running totals of losses and external work, J.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub(super) struct EnergyLedger {
    /// Stored in fibres when they broke, and in film that tore.
    pub(super) rupture: f64,
    /// Absorbed in fibres that broke.
    pub(super) absorbed: f64,
    /// Lost to mass-proportional damping.
    pub(super) damping: StepEnergy,
    /// Work of jaws, of pressure and of what launches impactors, counted negative; that of an impactor with prescribed motion is in
    /// `contact.work`.
    pub(super) external: StepEnergy,
    /// Dissipated by the guide.
    pub(super) guide: StepEnergy,
    /// Dissipated where bodies meet.
    pub(super) collision: StepEnergy,
    /// Dissipated in the frame's clamp.
    pub(super) clamp: StepEnergy,
}

impl View<'_> {
    /// The energy balance at this step.
    pub fn energies(&self) -> Energies {
        let Engine { progress: Progress { ledger, .. }, loads, previous, springs, impacts, film_contact, pool, .. } =
            self.engine;
        let is_start = self.steps == 0;
        let until_now = |energy: &StepEnergy| energy.until_full_step(is_start);
        let multiplicity = loads.multiplicity;
        let g = loads.gravity;
        let mut out = Energies {
            rupture: ledger.rupture,
            absorbed: ledger.absorbed,
            guide: until_now(&ledger.guide),
            collision: until_now(&ledger.collision),
            clamp: until_now(&ledger.clamp),
            springs: springs.as_ref().map_or(0.0, |springs| springs.stored(self.nodes)),
            damping: until_now(&ledger.damping),
            external: until_now(&ledger.external),
            ..Energies::default()
        };
        for energy in film::energies(self.films, pool, self.nodes.position.axes()) {
            out.stored += multiplicity * energy.stored;
            out.absorbed += multiplicity * energy.absorbed;
            out.hourglass += multiplicity * energy.hourglass;
        }
        for film in self.films {
            let of_film = loads.film_gravity(film);
            for (n, mass) in film.nodes.clone().zip(&self.nodes.mass[film.nodes.clone()]) {
                let u = previous.velocity.value_at(n);
                let v = if is_start { u } else { self.nodes.velocity.value_at(n) };
                // Product of both half steps, not the square of their mean: this is what central differences conserve
                // (theory.md, equation 23).
                out.kinetic_film += multiplicity * 0.5 * mass * (v[0] * u[0] + v[1] * u[1] + v[2] * u[2]);
                out.potential += multiplicity * mass * of_film * self.nodes.position.value_at(n)[2];
            }
        }
        for (Impact { body, contact, .. }, before) in impacts.iter().zip(&previous.bodies) {
            out.kinetic_impactor += if is_start { before } else { body }.kinetic_energy(before);
            out.potential += body.potential_energy(g);
            if body.has_prescribed_motion() {
                // A body with prescribed motion has no energy to give: what it does comes from outside.
                out.external -= until_now(&contact.work.on_film);
            }
        }
        let of_bodies = impacts.iter().map(|impact| &impact.contact.work.loss);
        for ContactLoss { impact, friction } in of_bodies.chain(film_contact.iter().map(|own| &own.history.loss)) {
            out.contact += until_now(impact);
            out.friction += until_now(friction);
        }
        out
    }
}

macro_rules! terms {
    ($($(#[doc = $doc:literal])+ $term:ident = $name:literal;)+) => {
        /// Terms of the energy balance, J. Their sum is constant (theory.md, equation 24).
        #[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
        pub struct Energies {
            $($(#[doc = $doc])+ pub $term: f64,)+
        }

        impl Energies {
            /// The terms as channels, in the order of [`Energies::terms`].
            pub const TERMS: &[EnergyTerm] = &[$(EnergyTerm { name: $name, sentence: &[$($doc),+] }),+];

            /// The terms in order.
            pub fn terms(&self) -> [f64; Self::TERMS.len()] {
                [$(self.$term),+]
            }
        }
    };
}

/// A term of the energy balance as a channel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct EnergyTerm {
    /// It ends with the unit.
    pub name: &'static str,
    /// Description, as one or more lines.
    pub sentence: &'static [&'static str],
}

terms! {
    /// Kinetic energy of the film.
    kinetic_film = "kinetic_film_J";
    /// Kinetic energy of the impactors.
    kinetic_impactor = "kinetic_impactor_J";
    /// Potential energy of film and impactors in gravity, over the undeformed state.
    potential = "potential_J";
    /// Elastic energy of the film, returned on unloading.
    stored = "stored_J";
    /// Energy absorbed by the film's law.
    absorbed = "absorbed_J";
    /// Energy that was stored in fibres when they broke, and in film that tore.
    rupture = "rupture_J";
    /// Energy in the stabilisation against hourglass modes.
    hourglass = "hourglass_J";
    /// Energy dissipated where nodes come into contact.
    contact = "contact_J";
    /// Energy dissipated by friction of film on the impactor, on the frame's bars and on film.
    friction = "friction_J";
    /// Energy dissipated by friction of the impactor's guide.
    guide = "guide_J";
    /// Energy dissipated where impactors meet each other or the frame's bars.
    collision = "collision_J";
    /// Energy dissipated by friction of film in the frame's clamp.
    clamp = "clamp_J";
    /// Elastic energy of the frame's springs.
    springs = "springs_J";
    /// Energy dissipated by mass-proportional damping.
    damping = "damping_J";
    /// External work by jaws, pressure, an impactor with prescribed motion or what launches an impactor, counted
    /// negative.
    external = "external_J";
}

impl Energies {
    /// Sum of all terms.
    pub fn total(&self) -> f64 {
        self.terms().iter().sum()
    }

    /// Energy exchanged between the terms since `start`: half the sum of their changes in magnitude.
    pub fn exchanged(&self, start: &Energies) -> f64 {
        let changes = self.terms().iter().zip(start.terms()).map(|(now, then)| (now - then).abs()).sum::<f64>();
        0.5 * changes
    }
}
