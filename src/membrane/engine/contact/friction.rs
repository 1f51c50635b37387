//! Coulomb coefficients of the surfaces that slip on each other where a body presses on film.

use crate::lane::{LANES, Lane, lanes};

/// The pair of surfaces that slip on each other at a node.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Pair {
    /// The body and the first face.
    BodyOnFilm,
    /// A further face and the one before it, through which the body presses on it.
    FilmOnFilm,
}

/// Coefficient of each pair of surfaces.
#[derive(Clone, Copy, Debug)]
pub(super) struct Friction {
    pub(super) body_on_film: f64,
    film_on_film: f64,
    /// Number of nodes of the first face, which come first.
    first_face: usize,
}

impl Friction {
    /// Friction of a single face on the body.
    pub(super) fn of_body(coefficient: f64) -> Friction {
        Friction { body_on_film: coefficient, film_on_film: coefficient, first_face: usize::MAX }
    }

    /// This friction with the coefficient `film_on_film` at the nodes from `first_face` on.
    pub(super) fn with_faces(self, film_on_film: f64, first_face: usize) -> Friction {
        Friction { film_on_film, first_face, ..self }
    }

    /// The surfaces that slip at a node.
    pub(super) fn pair(&self, node: usize) -> Pair {
        if node < self.first_face { Pair::BodyOnFilm } else { Pair::FilmOnFilm }
    }

    /// Coefficient of a pair of surfaces.
    pub(super) fn coefficient_of(&self, pair: Pair) -> f64 {
        match pair {
            Pair::BodyOnFilm => self.body_on_film,
            Pair::FilmOnFilm => self.film_on_film,
        }
    }

    /// Coefficient at each of some nodes.
    #[inline(always)]
    pub(super) fn lanes(&self, nodes: &[u32; LANES]) -> Lane {
        lanes(|l| self.coefficient_of(self.pair(nodes[l] as usize)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn further_faces_slip_on_film() {
        let one = Friction::of_body(0.3);
        assert!((0..9).all(|node| one.pair(node) == Pair::BodyOnFilm));
        let two = one.with_faces(0.1, 4);
        let coefficients = [3, 4].map(|node| two.coefficient_of(two.pair(node)));
        assert_eq!(coefficients, [0.3, 0.1]);
    }
}
