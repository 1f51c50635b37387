//! The state of an engine between two steps: a run resumed from it gives the same bits.

use serde::{Deserialize, Serialize};
use thiserror::Error;

use super::film_contact::FilmContactHistory;
use super::impact::ImpactState;
use super::{Clamp, Engine, Film, Progress, Vectors};

/// State of an engine between two steps. Forces are left out: they follow from the rest.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct State {
    progress: Progress,
    position: Vectors,
    velocity: Vectors,
    /// History variables of the elements of each face.
    films: Vec<Vec<f64>>,
    impacts: Vec<ImpactState>,
    film_contact: Option<FilmContactHistory>,
    clamp: Option<Vec<bool>>,
    /// Elements that failed where the film was mounted, which the first step reports.
    failed: usize,
}

/// A state of another scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[error("the state is of another scene: {found} {what} where there are {expected}")]
pub struct StateMismatch {
    /// The quantity that differs in number.
    pub what: &'static str,
    /// Number in the state.
    pub found: usize,
    /// Number in the engine.
    pub expected: usize,
}

impl State {
    /// Time of the full step, s.
    pub fn time(&self) -> f64 {
        self.progress.time
    }

    /// Steps so far.
    pub fn steps(&self) -> u64 {
        self.progress.steps
    }
}

impl Engine {
    /// The state after the last step.
    pub fn state(&self) -> State {
        let Engine { films, nodes, impacts, film_contact, progress, .. } = self;
        State {
            progress: progress.clone(),
            position: nodes.position.clone(),
            velocity: nodes.velocity.clone(),
            films: films.iter().map(Film::save).collect(),
            impacts: impacts.iter().map(|impact| impact.save()).collect(),
            film_contact: film_contact.as_ref().map(|contact| contact.save()),
            clamp: self.clamp.as_ref().map(|clamp| clamp.save()),
            failed: self.failed,
        }
    }

    /// Restores a state of the same scene; the steps that follow give the same bits as those that followed it.
    ///
    /// # Errors
    /// [`StateMismatch`] where the state has other numbers of nodes, faces, history variables or impactors; then the
    /// engine is unchanged.
    pub fn restore(&mut self, state: State) -> Result<(), StateMismatch> {
        // All checks before any change: a refused state must leave the engine as it was.
        self.check(&state)?;
        // With its countdown to the next update: the step that follows must be the same to the bit.
        let time_step = self.progress.time_step.restored(state.progress.time_step);
        self.progress = Progress { time_step, ..state.progress };
        self.failed = state.failed;
        self.nodes.position = state.position;
        self.nodes.velocity = state.velocity;
        // Films before contacts: these derive their lists and surfaces from the elements that are intact.
        self.films.iter_mut().zip(&state.films).for_each(|(film, history)| film.restore(history));
        for (impact, state) in self.impacts.iter_mut().zip(state.impacts) {
            impact.restore(state, &self.films);
        }
        if let (Some(contact), Some(history)) = (&mut self.film_contact, state.film_contact) {
            contact.restore(history, &self.films);
        }
        if let (Some(clamp), Some(history)) = (&mut self.clamp, state.clamp) {
            clamp.restore(history, &mut self.nodes);
        }
        Ok(())
    }

    fn check(&self, state: &State) -> Result<(), StateMismatch> {
        // A run that cannot advance would never end.
        same("times", usize::from(self.progress.time_step.precedes(&state.progress)), 1)?;
        let nodes = self.nodes.mass.len();
        for vectors in [&state.position, &state.velocity] {
            // A damaged file may have axes of different lengths, which would pass by the length of one.
            same("nodes", if vectors.is_whole() { vectors.len() } else { 0 }, nodes)?;
        }
        same("faces", state.films.len(), self.films.len())?;
        for (history, film) in state.films.iter().zip(&self.films) {
            same("history variables", history.len(), film.save().len())?;
        }
        same("impactors", state.impacts.len(), self.impacts.len())?;
        let listed = state.impacts.iter().all(|impact| impact.contact.0.fits(nodes));
        same("lists of neighbours", usize::from(listed), 1)?;
        let (found, expected) = (&state.film_contact, &self.film_contact);
        same("contacts between faces", usize::from(found.is_some()), usize::from(expected.is_some()))?;
        let tracked = found.as_ref().zip(expected.as_ref()).is_none_or(|(history, contact)| contact.fits(history));
        same("lists of near faces", usize::from(tracked), 1)?;
        let clamped = state.clamp.as_ref().map(Vec::len) == self.clamp.as_ref().map(Clamp::len);
        same("clamps", usize::from(clamped), 1)
    }
}

fn same(what: &'static str, found: usize, expected: usize) -> Result<(), StateMismatch> {
    if found == expected { Ok(()) } else { Err(StateMismatch { what, found, expected }) }
}

#[cfg(test)]
mod tests {
    use nalgebra::Point3;

    use crate::engine::{Engine, Film, Loads, Mesh, Nodes, Section, Unobserved};
    use crate::material::{Curve, Fabric, Law};

    /// An element whose MD fibres break where it is mounted.
    fn broken() -> Engine {
        let curve = |end: f64| Curve::new(vec![[end, 20e6]]).expect("a curve");
        let law = Law::Fabric(Fabric::new(curve(0.1), curve(0.5), curve(0.5), 0.0));
        let corners = [[0.0, 0.0], [0.01, 0.0], [0.01, 0.01], [0.0, 0.01]];
        let places = corners.into_iter().map(|[x, y]| Point3::new(x, y, 0.0)).collect();
        let mesh = Mesh { nodes: places, quads: vec![[0, 1, 2, 3]], ..Mesh::default() };
        let section = Section { prestrain: [0.2, 0.0], ..Section::new(law, 1000.0, 5e-5) };
        let mut nodes = Nodes::default();
        let film = Film::mount(&mesh, &section, 0.0, &mut nodes).expect("a film");
        nodes.hold(0..4, [true; 3]);
        Engine::new(vec![film], nodes, [], Loads::default())
    }

    /// What failed before the first step is reported by it, also from a state between the two, and reduces the step.
    #[test]
    fn film_that_breaks_where_it_is_mounted_is_reported_once() {
        let mut whole = broken();
        let (state, first) = (whole.state(), whole.time_step());
        let mut resumed = broken();
        resumed.step(&mut Unobserved).expect("a step");
        resumed.restore(state).expect("the same scene");
        for engine in [&mut whole, &mut resumed] {
            let failed = [(), ()].map(|()| engine.step(&mut Unobserved).expect("a step"));
            assert_eq!(failed, [1, 0]);
            // Theory.md, section 4: s = 0.5 in place of 0.9.
            assert!((engine.time_step() / first - 0.5 / 0.9).abs() < 1e-12, "{}", engine.time_step() / first);
        }
    }
}
