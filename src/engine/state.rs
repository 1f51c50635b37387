//! All that one step leaves to the next, as plain numbers: with it a run goes on later as if it had never stopped.

use serde::{Deserialize, Serialize};
use thiserror::Error;

use super::contact::Carried;
use super::film_history::FilmHistory;
use super::pressure::Inflated;
use super::rigid_body::Motion;
use super::{EnergyLedger, Engine, Film, TimeStep, Vectors};

/// State of an engine between two steps. Forces are not in it: they follow from the rest.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct State {
    /// s.
    pub time: f64,
    /// Steps so far.
    pub steps: u64,
    time_step: TimeStep,
    ledger: EnergyLedger,
    inflated: Option<Inflated>,
    position: Vectors,
    velocity: Vectors,
    films: Vec<FilmHistory>,
    impact: Option<(Motion, Carried)>,
}

/// A state that belongs to another scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[error("the state is of another scene: {found} {what} where there are {expected}")]
pub struct StateMismatch {
    /// What there is another number of.
    pub what: &'static str,
    /// In the state.
    pub found: usize,
    /// In the engine.
    pub expected: usize,
}

impl Engine {
    /// The state after the last step.
    pub fn state(&self) -> State {
        let Engine { films, nodes, impact, time_step, time, steps, ledger, inflated, .. } = self;
        State {
            time: *time,
            steps: *steps,
            time_step: time_step.clone(),
            ledger: *ledger,
            inflated: *inflated,
            position: nodes.position.clone(),
            velocity: nodes.velocity.clone(),
            films: films.iter().map(Film::save).collect(),
            impact: impact.as_ref().map(|impact| (impact.body.motion(), impact.contact.carried())),
        }
    }

    /// Puts a state of the same scene back: from here on every step gives the same bits as it would have there.
    ///
    /// # Errors
    /// [`StateMismatch`] where the state has other numbers of nodes, faces, integration points or impactors; the engine is
    /// unchanged then.
    pub fn restore(&mut self, state: State) -> Result<(), StateMismatch> {
        self.check(&state)?;
        self.time = state.time;
        self.steps = state.steps;
        self.time_step.resume(state.time_step);
        self.ledger = state.ledger;
        self.inflated = state.inflated;
        self.failed = 0;
        self.nodes.position = state.position;
        self.nodes.velocity = state.velocity;
        self.films.iter_mut().zip(&state.films).for_each(|(film, history)| film.restore(history));
        if let (Some(impact), Some((motion, carried))) = (&mut self.impact, state.impact) {
            impact.body.resume(&motion);
            impact.contact.restore(carried, &self.films);
        }
        Ok(())
    }

    fn check(&self, state: &State) -> Result<(), StateMismatch> {
        let nodes = self.nodes.mass.len();
        for vectors in [&state.position, &state.velocity] {
            same("nodes", if vectors.is_whole() { vectors.len() } else { 0 }, nodes)?;
        }
        same("faces", state.films.len(), self.films.len())?;
        for (history, film) in state.films.iter().zip(&self.films) {
            same("integration points", history.points(), film.points())?;
            same("history variables", history.variables(), film.variables())?;
        }
        same("impactors", usize::from(state.impact.is_some()), usize::from(self.impact.is_some()))?;
        let listed = state.impact.as_ref().is_none_or(|(_, carried)| carried.is_of(nodes));
        same("lists of neighbours", usize::from(listed), 1)
    }
}

fn same(what: &'static str, found: usize, expected: usize) -> Result<(), StateMismatch> {
    if found == expected { Ok(()) } else { Err(StateMismatch { what, found, expected }) }
}
