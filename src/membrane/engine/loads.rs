//! Loads and prescribed motion.

use super::pressure::Inflation;

/// Loads and prescribed motion besides contact.
#[derive(Clone, Debug)]
pub struct Loads {
    /// m/s², downward.
    pub gravity: f64,
    /// Mass-proportional damping of the film, 1/s.
    pub damping: f64,
    /// Prescribed motion along x.
    pub jaws: Vec<Jaw>,
    /// Pressure on the lower side of the film, whose edge is held.
    pub inflation: Option<Inflation>,
    /// Parts of film of which one is computed; the others are its mirror images.
    pub multiplicity: f64,
    /// Factor on the stable time step, 0 < factor ≤ 1.
    pub step_factor: f64,
}

impl Default for Loads {
    /// No load on a film without symmetry.
    fn default() -> Loads {
        Loads { gravity: 0.0, damping: 0.0, jaws: vec![], inflation: None, multiplicity: 1.0, step_factor: 1.0 }
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
