//! Pieces into which cuts part a face.

use membrane::engine::{Film, Jaw, Nodes};

use super::film::FilmSpring;

/// The pieces of a face: sets of nodes that elements connect.
pub(super) struct Pieces {
    /// A node of the same piece, by node of the face; at last one that is its own.
    towards: Vec<usize>,
    /// Nodes of an element.
    used: Vec<bool>,
    /// The first node of the face among all nodes.
    first: usize,
}

impl Pieces {
    /// The pieces of `film`, whose elements on cuts are deleted.
    pub(super) fn new(film: &Film) -> Pieces {
        let count = film.nodes.len();
        let mut pieces = Pieces { towards: (0..count).collect(), used: vec![false; count], first: film.nodes.start };
        film.for_each_intact(|corners| {
            let of_face = |node: &u32| *node as usize - film.nodes.start;
            let root = pieces.root(of_face(&corners[0]));
            for node in corners.iter().map(of_face) {
                let other = pieces.root(node);
                pieces.towards[other] = root;
                pieces.used[node] = true;
            }
        });
        pieces
    }

    fn root(&mut self, mut node: usize) -> usize {
        while self.towards[node] != node {
            // Halves the way for the next search.
            self.towards[node] = self.towards[self.towards[node]];
            node = self.towards[node];
        }
        node
    }

    /// The pieces of these nodes, counted among all nodes; ascending.
    fn of(&mut self, nodes: impl IntoIterator<Item = usize>) -> Vec<usize> {
        let nodes: Vec<usize> =
            nodes.into_iter().map(|node| node - self.first).filter(|node| self.used[*node]).collect();
        let mut roots: Vec<usize> = nodes.into_iter().map(|node| self.root(node)).collect();
        roots.sort_unstable();
        roots.dedup();
        roots
    }

    fn own(&self) -> std::ops::Range<usize> {
        self.first..self.first + self.used.len()
    }

    /// Whether a piece has no node that is held in all directions, and hangs on none of `springs`.
    pub(super) fn is_one_free(&mut self, nodes: &Nodes, springs: &[FilmSpring]) -> bool {
        let first = self.first;
        let on_springs = springs.iter().flat_map(|spring| spring.nodes).map(|node| first + node as usize);
        let held: Vec<usize> = self.own().filter(|node| nodes.is_held(*node)).chain(on_springs).collect();
        self.of(held) != self.of(self.own())
    }

    /// Whether no piece goes from one of these jaws to the other, or of a single one to the mirror plane, whose nodes are `mirrored`.
    pub(super) fn are_jaws_parted(&mut self, jaws: &[Jaw], mirrored: &[usize]) -> bool {
        let jaw = |pieces: &mut Pieces, jaw: &Jaw| pieces.of(jaw.nodes.iter().map(|node| *node as usize));
        let [one, other] = match jaws {
            [one, other] => [jaw(self, one), jaw(self, other)],
            [one] => [jaw(self, one), self.of(mirrored.iter().copied())],
            _ => return false,
        };
        !one.iter().any(|piece| other.binary_search(piece).is_ok())
    }
}
