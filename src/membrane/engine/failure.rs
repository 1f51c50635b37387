//! Failure of fibre sets and elements of a film, and faults that end a run.

use thiserror::Error;

use super::element::{Block, Blocks, ElementEnergy, TooWide, energy_at, restart_after_break};
use crate::lane::LANES;
use crate::material::{History, MembraneLaw};

/// Failures in a film.
#[derive(Clone, Copy, Debug, Default)]
pub struct Failures {
    /// Elements in which fibres of a layer broke.
    pub broken: usize,
    /// Elements that failed: they lost the MD or the TD fibres of their last layer.
    pub failed: usize,
    /// The energies that they lost.
    pub energy: ElementEnergy,
    /// Of the elements that started to tear the one that stores most of what its tear takes, where it stores more.
    pub too_wide: Option<TooWide>,
    /// Whether a tear opened.
    pub opened: bool,
    /// Least share of the work done on film around the tip of a tear that it would return, where all work would suffice for
    /// the tear and that share does not.
    pub returned: Option<f64>,
}

impl Failures {
    /// Adds those of other elements.
    pub fn add(&mut self, other: &Failures) {
        self.broken += other.broken;
        self.failed += other.failed;
        self.energy.add(&other.energy);
        self.too_wide = TooWide::worse(self.too_wide, other.too_wide);
        self.opened |= other.opened;
        self.returned = smaller(self.returned, other.returned);
    }
}

/// Breaks the fibres of every layer that is strained past its break strain: the share of layers left is multiplied into
/// the stress of the fibre set. An element without MD and TD fibres is deleted: its volume and its forces become zero.
/// Mass stays at the nodes.
#[cfg_attr(not(test), inline)]
pub(super) fn fail<B, M, const NODES: usize>(
    elements: &mut Blocks<B, NODES>,
    law: &M,
    position: &[&[f64]; 3],
) -> Failures
where
    B: Block<NODES, LANES>,
    M: MembraneLaw<History<LANES> = B::History>,
{
    // With a criterion of its own film softens and is deleted by that alone; break strains of fibres have no effect.
    if elements.tearing.is_some() {
        return open_tears(elements);
    }
    let mut total = Failures::default();
    for (block, lane) in elements.indices() {
        if elements.is_deleted(block, lane) {
            continue;
        }
        let (before, left) = (elements.left(block, lane), elements.blocks[block].layers_left(law, lane));
        if left == before {
            continue;
        }
        // Before and after, with the law itself: what the difference is not stored any more went into rupture.
        let mut lost = energy_at(elements, [block, lane], law, position);
        if left == [0.0; 2] {
            elements.blocks[block].delete(lane);
        } else {
            for (history, _) in elements.blocks[block].history_mut() {
                for fibre in 0..2 {
                    history.left_mut(fibre)[lane] = left[fibre];
                }
            }
            if let Some(viscous) = &mut elements.viscous {
                viscous.break_fibres([block, lane], before, left);
            }
            restart_after_break(elements, [block, lane], law, position);
            lost.subtract(&energy_at(elements, [block, lane], law, position));
        }
        let failed = (0..2).any(|fibre| before[fibre] > 0.0 && left[fibre] == 0.0);
        total.add(&Failures { broken: 1, failed: usize::from(failed), energy: lost, ..Failures::default() });
    }
    total
}

/// Deletes the elements whose tears have taken all of their forces.
fn open_tears<B, const NODES: usize>(elements: &mut Blocks<B, NODES>) -> Failures
where
    B: Block<NODES, LANES>,
{
    let mut total = Failures::default();
    for (block, lane) in elements.indices() {
        let tearing = elements.tearing.as_ref().expect("a tear");
        if !elements.is_deleted(block, lane) && tearing.share(block)[lane] == 0.0 {
            elements.blocks[block].delete(lane);
            total.broken += 1;
            total.failed += 1;
        }
    }
    let lost = elements.tearing.as_mut().expect("a tear").take_lost();
    Failures { energy: lost.energy, too_wide: lost.too_wide, opened: lost.opened, ..total }
}

/// The smaller of two figures.
pub(super) fn smaller(one: Option<f64>, other: Option<f64>) -> Option<f64> {
    match (one, other) {
        (Some(a), Some(b)) => Some(a.min(b)),
        (a, b) => a.or(b),
    }
}

/// Why a run cannot continue.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum Fault {
    /// The motion of the impactor is not finite.
    #[error("the motion of the impactor is not finite at {time:.6} s")]
    ImpactorLost {
        /// Time, s.
        time: f64,
    },
    /// An impactor is released where there is film.
    #[error("impactor {impactor} is released at {time:.6} s {:.3} mm inside the film", 1e3 * depth)]
    ReleasedInFilm {
        /// Time, s.
        time: f64,
        /// Number of the impactor, from 1.
        impactor: usize,
        /// How deep, m.
        depth: f64,
    },
    /// An impactor is released where there is another.
    #[error("impactor {impactor} is released at {time:.6} s {:.3} mm inside impactor {other}", 1e3 * depth)]
    ReleasedInImpactor {
        /// Time, s.
        time: f64,
        /// Number of the impactor, from 1.
        impactor: usize,
        /// Number of the other one.
        other: usize,
        /// How deep, m.
        depth: f64,
    },
    /// A strain is not finite.
    #[error("the strain of element {element} of face {face} is not finite at {time:.6} s")]
    NotFinite {
        /// Time, s.
        time: f64,
        /// Number of the face, from 1.
        face: usize,
        /// Number of the element in the face, from 1, quads first.
        element: usize,
    },
    /// No stable time step, or no force, of a face is a number.
    #[error(
        "the strains of face {face} are not finite at {time:.6} s, or too large for its law to have a stiffness there"
    )]
    FilmLost {
        /// Time, s.
        time: f64,
        /// Number of the face, from 1.
        face: usize,
    },
    /// The stable time step is a small part of the first one.
    #[error("the time step fell from {first:.3e} s to {now:.3e} s at {time:.6} s, limited by face {face}")]
    TimeStepCollapsed {
        /// Time, s.
        time: f64,
        /// The first time step, s.
        first: f64,
        /// The present stable time step, s.
        now: f64,
        /// Number of the face that limits it, from 1.
        face: usize,
    },
    /// A step is so short that it does not change the time.
    #[error(
        "the time step {now:.3e} s, limited by face {face}, is too short to advance the time {time:.6} s: the film is too \
         stiff or too light"
    )]
    StepTooShort {
        /// Time, s.
        time: f64,
        /// The stable time step, s.
        now: f64,
        /// Number of the face that limits it, from 1.
        face: usize,
    },
    /// Film is stretched as far as its law admits.
    #[error("film of face {face} is stretched to the limit of its law at {time:.6} s")]
    StretchLimit {
        /// Time, s.
        time: f64,
        /// Number of the face, from 1.
        face: usize,
    },
    /// The observer ended the run.
    #[error("the observer ended the run")]
    Stopped,
}
