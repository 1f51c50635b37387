//! Pieces into which cuts part a face.

use std::collections::HashMap;

use membrane::engine::{Film, Jaw, Nodes};

use super::film::FilmSpring;

/// The pieces of a face: sets of elements that hold each other by edges, or by two nodes. At one node alone a piece would swing.
pub(super) struct Pieces {
    /// Pieces that each node of the face belongs to, ascending.
    of_node: Vec<Vec<usize>>,
    /// Number of elements, by piece.
    sizes: HashMap<usize, usize>,
    /// The first node of the face among all nodes.
    first: usize,
}

/// Elements in disjoint sets.
struct Sets(Vec<usize>);

impl Sets {
    fn root(&mut self, mut element: usize) -> usize {
        while self.0[element] != element {
            // Halves the way for the next search.
            self.0[element] = self.0[self.0[element]];
            element = self.0[element];
        }
        element
    }

    /// Whether two sets became one.
    fn join(&mut self, one: usize, other: usize) -> bool {
        let [one, other] = [self.root(one), self.root(other)];
        self.0[other] = one;
        one != other
    }
}

impl Pieces {
    /// The pieces of `film`, whose elements on cuts are deleted.
    pub(super) fn new(film: &Film) -> Pieces {
        let first = film.nodes.start;
        let mut elements: Vec<Vec<usize>> = vec![];
        film.for_each_intact(|corners| elements.push(corners.iter().map(|node| *node as usize - first).collect()));
        let mut sets = Sets((0..elements.len()).collect());
        let mut edges: HashMap<[usize; 2], usize> = HashMap::new();
        let mut at_node: Vec<Vec<usize>> = vec![vec![]; film.nodes.len()];
        for (element, corners) in elements.iter().enumerate() {
            for (from, to) in corners.iter().zip(corners.iter().cycle().skip(1)) {
                at_node[*from].push(element);
                if let Some(other) = edges.insert([*from.min(to), *from.max(to)], element) {
                    sets.join(element, other);
                }
            }
        }
        let of_node = loop {
            let of_node: Vec<Vec<usize>> =
                at_node.iter().map(|at| distinct(at, |element| sets.root(element))).collect();
            let mut met: HashMap<[usize; 2], usize> = HashMap::new();
            for pieces in &of_node {
                let pairs = pieces
                    .iter()
                    .enumerate()
                    .flat_map(|(place, one)| pieces[place + 1..].iter().map(move |other| [*one, *other]));
                pairs.for_each(|pair| *met.entry(pair).or_default() += 1);
            }
            let held = met.into_iter().filter(|(_, nodes)| *nodes > 1);
            if !held.fold(false, |joined, ([one, other], _)| sets.join(one, other) || joined) {
                break of_node;
            }
        };
        let mut sizes = HashMap::new();
        (0..elements.len()).for_each(|element| *sizes.entry(sets.root(element)).or_default() += 1);
        Pieces { of_node, sizes, first }
    }

    /// The pieces of these nodes, counted among all nodes; ascending.
    fn of(&self, nodes: impl IntoIterator<Item = usize>) -> Vec<usize> {
        let pieces: Vec<usize> = nodes.into_iter().flat_map(|node| self.of_node[node - self.first].clone()).collect();
        distinct(&pieces, |piece| piece)
    }

    /// Whether a piece of more than one element has no node that is held in all directions, and hangs on none of `springs`. Single
    /// elements that hang on a node are left where a cut runs along the corners of a mesh.
    pub(super) fn is_one_free(&self, nodes: &Nodes, springs: &[FilmSpring]) -> bool {
        let on_springs = springs.iter().flat_map(|spring| spring.nodes).map(|node| self.first + node as usize);
        let own = self.first..self.first + self.of_node.len();
        let held = self.of(own.filter(|node| nodes.is_held(*node)).chain(on_springs));
        self.sizes.iter().any(|(piece, elements)| *elements > 1 && held.binary_search(piece).is_err())
    }

    /// Whether no piece goes from one of these jaws to the other, or of a single one to the mirror plane, whose nodes are `mirrored`.
    pub(super) fn are_jaws_parted(&self, jaws: &[Jaw], mirrored: &[usize]) -> bool {
        let at_jaw = |jaw: &Jaw| self.of(jaw.nodes.iter().map(|node| *node as usize));
        let [one, other] = match jaws {
            [one, other] => [at_jaw(one), at_jaw(other)],
            [one] => [at_jaw(one), self.of(mirrored.iter().copied())],
            _ => return false,
        };
        !one.iter().any(|piece| other.binary_search(piece).is_ok())
    }
}

/// The distinct values of `of`, ascending.
fn distinct(items: &[usize], of: impl FnMut(usize) -> usize) -> Vec<usize> {
    let mut values: Vec<usize> = items.iter().copied().map(of).collect();
    values.sort_unstable();
    values.dedup();
    values
}
