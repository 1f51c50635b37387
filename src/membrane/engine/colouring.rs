//! Colours of the parts of a mesh: parts of one colour share no node.

use thiserror::Error;

/// Parts of a mesh by colour, with the proof that no two parts of one colour have a node in common.
///
/// [`Colouring::new`] is the only constructor and checks every node of every part. Threads that add to the nodes of
/// different parts of one colour therefore never write to the same entry; `unsafe` code relies on it.
#[derive(Debug)]
pub(super) struct Colouring {
    colours: Vec<Vec<usize>>,
}

/// Two parts of one colour have a node in common.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[error("parts {} and {} of one colour share node {node}", parts[0], parts[1])]
pub(super) struct SharedNode {
    parts: [usize; 2],
    node: u32,
}

impl Colouring {
    /// The parts whose nodes are `nodes`, each with its colour in `colours`.
    ///
    /// # Errors
    /// [`SharedNode`] where `colours` is no colouring of these parts.
    ///
    /// # Panics
    /// Where there is not one colour for each part.
    pub(super) fn new(colours: &[usize], nodes: &[Vec<u32>]) -> Result<Colouring, SharedNode> {
        assert_eq!(colours.len(), nodes.len(), "a colour for each part");
        let mut by_colour = vec![vec![]; colours.iter().max().map_or(0, |largest| largest + 1)];
        for (part, colour) in colours.iter().enumerate() {
            by_colour[*colour].push(part);
        }
        // The last part that has each node, in the order of the colours.
        let mut last = vec![None; nodes.iter().flatten().max().map_or(0, |largest| *largest as usize + 1)];
        for part in by_colour.iter().flatten().copied() {
            for &node in &nodes[part] {
                match last[node as usize].replace(part) {
                    Some(other) if other != part && colours[other] == colours[part] => {
                        return Err(SharedNode { parts: [other, part], node });
                    }
                    _ => {}
                }
            }
        }
        Ok(Colouring { colours: by_colour })
    }

    /// The parts of each colour, ascending; every part is in one of them, once.
    pub(super) fn colours(&self) -> impl Iterator<Item = &[usize]> {
        self.colours.iter().map(Vec::as_slice)
    }
}

/// Colours that a mask can hold.
const MASK: usize = u64::BITS as usize;

/// First-fit colours of parts, in their order: the first colour that no earlier part with a node in common has.
pub(super) fn first_fit(nodes: &[Vec<u32>]) -> Vec<usize> {
    // The colours at each node, a bit each.
    let mut taken = vec![0_u64; nodes.iter().flatten().max().map_or(0, |largest| *largest as usize + 1)];
    let mut count = 0;
    let colour = |part: &Vec<u32>| {
        // Masks instead of sets: the next free colour is the number of trailing ones.
        let around = part.iter().fold(0, |around, node| around | taken[*node as usize]);
        let free = around.trailing_ones() as usize;
        // Elements in any order can need more colours than the mask has bits: then the part has a colour of its own.
        let colour = if free < MASK { free } else { count.max(MASK) };
        let bit = 1_u64.checked_shl(colour as u32).unwrap_or(0);
        part.iter().for_each(|node| taken[*node as usize] |= bit);
        count = count.max(colour + 1);
        colour
    };
    nodes.iter().map(colour).collect()
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use proptest::collection::vec;
    use proptest::prelude::*;

    use super::*;

    /// Whether two parts of one colour share a node, by comparing all pairs.
    fn shares(colours: &[usize], nodes: &[Vec<u32>]) -> bool {
        let sets: Vec<BTreeSet<u32>> = nodes.iter().map(|part| part.iter().copied().collect()).collect();
        (0..nodes.len()).any(|a| (0..a).any(|b| colours[a] == colours[b] && !sets[a].is_disjoint(&sets[b])))
    }

    proptest! {
        #[test]
        fn a_colouring_is_accepted_exactly_where_no_node_is_shared(
            parts in vec((vec(0_u32..30, 0..6), 0_usize..4), 0..10)
        ) {
            let (nodes, colours): (Vec<_>, Vec<_>) = parts.into_iter().unzip();
            match Colouring::new(&colours, &nodes) {
                Ok(_) => prop_assert!(!shares(&colours, &nodes)),
                Err(SharedNode { parts: [a, b], node }) => {
                    prop_assert!(a != b && colours[a] == colours[b]);
                    prop_assert!(nodes[a].contains(&node) && nodes[b].contains(&node));
                }
            }
        }

        #[test]
        fn first_fit_colours_are_a_colouring_of_every_part(nodes in vec(vec(0_u32..12, 0..8), 0..90)) {
            let colouring = Colouring::new(&first_fit(&nodes), &nodes).expect("a colouring");
            let mut parts: Vec<usize> = colouring.colours().flatten().copied().collect();
            parts.sort_unstable();
            prop_assert_eq!(parts, (0..nodes.len()).collect::<Vec<_>>());
        }
    }

    /// More parts around one node than the mask has bits.
    #[test]
    fn parts_beyond_the_mask_have_colours_of_their_own() {
        let nodes = vec![vec![0]; 70];
        let colours = first_fit(&nodes);
        assert_eq!(colours, (0..70).collect::<Vec<_>>());
        assert!(Colouring::new(&colours, &nodes).is_ok());
    }
}
