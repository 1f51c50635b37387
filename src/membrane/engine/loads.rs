//! Loads and prescribed motion.

use super::cushion::Cushion;
use super::film::Film;
use super::pressure::{Filling, Inflation};

/// Loads and prescribed motion besides contact.
#[derive(Clone, Debug)]
pub struct Loads {
    /// m/s², downward.
    pub gravity: f64,
    /// Mass-proportional damping of the film, 1/s.
    pub damping: f64,
    /// Prescribed motion along x.
    pub jaws: Vec<Jaw>,
    /// Pressure on the lower side of the last film, whose edge is held.
    pub inflation: Option<Inflation>,
    /// Gas let in under the last film, whose edge is held.
    pub filling: Option<Filling>,
    /// Air between the first two faces, whose edges are held.
    pub cushion: Option<Cushion>,
    /// Parts of film of which one is computed; the others are its mirror images.
    pub multiplicity: f64,
    /// Factor on the stable time step, 0 < factor ≤ 1.
    pub step_factor: f64,
}

impl Default for Loads {
    /// No load on a film without symmetry.
    fn default() -> Loads {
        Loads {
            gravity: 0.0,
            damping: 0.0,
            jaws: vec![],
            inflation: None,
            filling: None,
            cushion: None,
            multiplicity: 1.0,
            step_factor: 1.0,
        }
    }
}

impl Loads {
    /// Acceleration of `film` that is free, m/s², downward.
    pub(super) fn film_gravity(&self, film: &Film) -> f64 {
        self.gravity * film.weight_share
    }
}

/// Nodes that move at their initial velocity, held in the other directions.
#[derive(Clone, Debug)]
pub struct Jaw {
    /// Its nodes.
    pub nodes: Vec<u32>,
    /// Along x, m/s.
    pub velocity: f64,
}
