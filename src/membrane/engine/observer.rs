//! Observers of a run, and the state that they are shown.

use super::cushion::CushionState;
use super::film_contact::{FilmContact, FilmContactState};
use super::thread_pool::ThreadPool;
use super::{
    Contact, ContactState, ElementStrain, Energies, EnergyLedger, Fault, Film, Loads, Nodes, PreviousStep, RigidBody,
    film,
};

/// Follows a run without changing it.
pub trait Observer {
    /// Whether it needs the state at the full step at `time` (s).
    fn needs_state(&self, time: f64) -> bool;
    /// Is shown the state at that step.
    ///
    /// # Errors
    /// A [`Fault`] ends the run.
    fn observe(&mut self, view: &View<'_>) -> Result<(), Fault>;
    /// Is shown impactor and jaws at every step.
    fn track(&mut self, _track: &Track) {}
}

/// The impactor and the jaws at one step; zero where there is none.
#[derive(Clone, Copy, Debug, Default)]
pub struct Track {
    /// Full step, s.
    pub time: f64,
    /// The step after it, s.
    pub dt: f64,
    /// Centre of mass at the full step, m.
    pub centre: [f64; 3],
    /// Its velocity in the middle of the step after it, m/s.
    pub velocity: [f64; 3],
    /// Kinetic energy there of its motion besides that along z, J; zero where its motion is prescribed.
    pub lateral_energy: f64,
    /// Work of the impactor on the film so far, J.
    pub work: f64,
    /// Impulse on the impactor along z so far, N s.
    pub impulse: f64,
    /// Force of the film on the jaws, mean over all of them, N.
    pub jaw_force: f64,
}

/// The state at a full step, read-only.
pub struct View<'a> {
    /// Time of the full step, s.
    pub time: f64,
    /// Steps so far.
    pub steps: u64,
    /// Faces of film.
    pub films: &'a [Film],
    /// Nodes: positions and forces at `time`, velocities half a step after it.
    pub nodes: &'a Nodes,
    /// The impactor, its velocities half a step after `time`.
    pub body: Option<&'a RigidBody>,
    pub(super) contact: Option<&'a Contact>,
    pub(super) film_contact: Option<&'a FilmContact>,
    pub(super) loads: &'a Loads,
    pub(super) cushion: Option<CushionState>,
    pub(super) ledger: EnergyLedger,
    pub(super) previous: &'a PreviousStep,
    pub(super) pool: &'a ThreadPool,
}

impl View<'_> {
    /// The energy balance at this step.
    pub fn energies(&self) -> Energies {
        let multiplicity = self.loads.multiplicity;
        let (g, of_film) = (self.loads.gravity, self.loads.film_gravity());
        let mut out = Energies {
            rupture: self.ledger.rupture,
            absorbed: self.ledger.absorbed,
            guide: self.ledger.guide - self.ledger.guide_ahead,
            damping: self.ledger.damping,
            external: self.ledger.external - self.ledger.external_ahead,
            ..Energies::default()
        };
        for energy in film::energies(self.films, self.pool, self.nodes.position.axes()) {
            out.stored += multiplicity * energy.stored;
            out.absorbed += multiplicity * energy.absorbed;
            out.hourglass += multiplicity * energy.hourglass;
        }
        for (n, mass) in self.nodes.mass.iter().enumerate() {
            let (v, u) = (self.nodes.velocity.at(n), self.previous.velocity.at(n));
            out.kinetic_film += multiplicity * 0.5 * mass * (v[0] * u[0] + v[1] * u[1] + v[2] * u[2]);
            out.potential += multiplicity * mass * of_film * self.nodes.position.at(n)[2];
        }
        if let (Some(body), Some(before)) = (self.body, &self.previous.body) {
            out.kinetic_impactor = body.kinetic_energy(before);
            out.potential += body.potential_energy(g);
        }
        if let Some(contact) = &self.contact {
            out.contact = contact.work.impact_loss;
            out.friction = contact.work.friction_loss;
            if self.body.is_some_and(RigidBody::has_prescribed_motion) {
                out.external -= contact.work.on_film - contact.work.ahead;
            }
        }
        if let Some(contact) = &self.film_contact {
            out.contact += contact.work.impact_loss;
            out.friction += contact.work.friction_loss;
        }
        out
    }

    /// Strains of every element of each face, quads first, into `out`.
    pub fn strains(&self, out: &mut Vec<Vec<ElementStrain>>) {
        film::strains(self.films, self.pool, self.nodes.position.axes(), out);
    }

    /// Velocity of a node at this step, m/s: the mean of those half a step before and after.
    pub fn velocity(&self, node: usize) -> [f64; 3] {
        let (before, after) = (self.previous.velocity.at(node), self.nodes.velocity.at(node));
        [0, 1, 2].map(|axis| 0.5 * (before[axis] + after[axis]))
    }

    /// Pressure of the air between the first two faces over that of the surroundings, Pa; none where it is not computed.
    pub fn cushion_pressure(&self) -> Option<f64> {
        self.cushion.map(|cushion| cushion.pressure)
    }

    /// State of contact between faces, where it is computed.
    pub fn film_contact_state(&self) -> Option<FilmContactState> {
        Some(self.film_contact?.state(self.nodes, self.pool))
    }

    /// State of contact, if there is an impactor.
    pub fn contact_state(&self) -> Option<ContactState> {
        let (contact, body) = (self.contact?, self.body?);
        Some(contact.state(self.nodes, &body.pose))
    }

    /// Half the smallest extent of the impactor, m.
    pub fn impactor_size(&self) -> Option<f64> {
        self.contact.as_ref().map(|c| c.surface().size())
    }

    /// Nodes in contact with the impactor in this step.
    pub fn nodes_in_contact(&self) -> Vec<usize> {
        self.contact.as_ref().map_or(vec![], |c| c.nodes_in_contact().collect())
    }
}
