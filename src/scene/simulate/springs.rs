//! Where the springs on which film hangs are attached to its edges (theory.md, section 29), and what they
//! make of the time step.

use std::collections::BTreeMap;

use nalgebra::{Point3, Vector3};
use serde::{Deserialize, Serialize};

use super::fault::RunError;
use super::mount;
use super::outcome::FilmSpring;
use crate::mesh::{self, Mesh};
use crate::model::{Face, Model, Springs as Written};
use base::number::significant;
use membrane::engine::{Engine, Spring};

/// Share of a spring, of a piece of edge or of the extent of film that is round-off.
const ROUND_OFF: f64 = 1e-6;

/// A part of the held edge from node to node, with the film to its left.
#[derive(Clone, Copy)]
struct Piece {
    nodes: [u32; 2],
    from: Point3<f64>,
    to: Point3<f64>,
}

/// Pieces that follow each other.
struct Run {
    pieces: Vec<Piece>,
    /// Length from its beginning to where springs begin to be counted, m: not zero only where it is closed.
    start: f64,
    is_closed: bool,
}

/// Adds the springs of the last of `faces` of `model`, with `mesh` and the `held` edges, whose first node is the `first` of
/// all, to `springs`, which are those of the faces before it; how they look.
///
/// # Errors
/// [`RunError::Mounting`]: no edge is held, springs cannot be spread evenly, or one is too short.
pub(super) fn mount(
    springs: &mut Vec<Spring>,
    (model, written): (&Model, &Written),
    faces: usize,
    mesh: &Mesh,
    held: &[[u32; 2]],
    first: usize,
) -> Result<Vec<FilmSpring>, RunError> {
    let Some(face) = model.faces.get(faces - 1) else { return Ok(vec![]) };
    let (runs, before) = (runs(pieces(mesh, held), mesh), springs.len());
    if runs.is_empty() {
        let message = format!("face {faces} has no held edge on which springs stand");
        return Err(RunError::at_key("frame.hold", message, "name sides that are edges, or hold \"all\""));
    }
    let (length, stiffness, preload) = (written.length.0, written.stiffness.0, written.preload.map(|force| force.0));
    let count = f64::from(written.count) / model.specimen.symmetry.copies();
    for (run, count) in runs.iter().zip(counts(&runs, count as usize)?) {
        let spacing = run.length() / count as f64;
        for number in 0..count {
            let (place, share) = run.at(run.start + (number as f64 + 0.5) * spacing);
            let (piece, shares) = (&run.pieces[place], [1.0 - share, share]);
            let (outward, pull) = outward(face, run.normals(place, share));
            let force = preload.unwrap_or_else(|| (pull * spacing).max(0.0));
            let elongation = force / stiffness;
            if elongation >= length {
                let (force, elongation) = (significant(force, 4), significant(1e3 * elongation, 4));
                let message = format!(
                    "the pre-strain of face {faces} pulls at a spring of the frame with {force} N, which elongates it by \
                     {elongation} mm: more than its length"
                );
                let hint = "use stiffer or more springs, a larger `length` or less pre-strain, or give a `preload`";
                return Err(RunError::at_key("frame.springs.length", message, hint));
            }
            let lift = Vector3::z() * face.height;
            let end = piece.from.coords * shares[0] + piece.to.coords * shares[1] + lift;
            let anchor = Point3::from(end + outward * length);
            let nodes = piece.nodes.map(|node| first + node as usize);
            springs.push(Spring { nodes, shares, anchor, unstretched: length - elongation });
        }
    }
    let shown = |spring: &Spring| FilmSpring {
        anchor: spring.anchor.coords.map(|x| x as f32).into(),
        nodes: spring.nodes.map(|node| (node - first) as u32),
        shares: spring.shares.map(|share| share as f32),
    };
    Ok(springs[before..].iter().map(shown).collect())
}

/// Direction of a spring with these normals of the edge on either side of it, and the force of the pre-strain of `face`
/// along it over the length of edge, half of it on each side, N/m.
fn outward(face: &Face, normals: [Vector3<f64>; 2]) -> (Vector3<f64>, f64) {
    let [one, other] = normals;
    // Between the nodes of straight edge as that has it, to the bit.
    let bisector = if one == other { one } else { (one + other).try_normalize(0.0).unwrap_or(one) };
    let pulls = normals.map(|normal| mount::line_force(face, &normal.xy()).dot(&bisector.xy()));
    (bisector, 0.5 * (pulls[0] + pulls[1]))
}

/// The `held` edges with their directions, in the order of `held`.
fn pieces(mesh: &Mesh, held: &[[u32; 2]]) -> Vec<Piece> {
    let directed: BTreeMap<[u32; 2], [u32; 2]> =
        mesh::directed_edges(mesh).map(|[from, to]| ([from.min(to), from.max(to)], [from, to])).collect();
    let at = |node: u32| mesh.nodes[node as usize];
    let piece = |edge: &[u32; 2]| {
        let nodes = *directed.get(edge)?;
        Some(Piece { nodes, from: at(nodes[0]), to: at(nodes[1]) })
    };
    held.iter().filter_map(piece).collect()
}

/// Pieces joined to runs: open ones from their first node on, each in the order of its first piece, closed ones from
/// where they cross the positive x axis, or else from their node of the largest x.
fn runs(pieces: Vec<Piece>, mesh: &Mesh) -> Vec<Run> {
    let from: BTreeMap<u32, usize> = pieces.iter().enumerate().map(|(place, piece)| (piece.nodes[0], place)).collect();
    let ends: BTreeMap<u32, usize> = pieces.iter().enumerate().map(|(place, piece)| (piece.nodes[1], place)).collect();
    let mut used = vec![false; pieces.len()];
    let mut follow = |start: usize| {
        let mut run = vec![];
        let mut next = Some(start);
        while let Some(place) = next.filter(|place| !used[*place]) {
            used[place] = true;
            run.push(pieces[place]);
            next = from.get(&pieces[place].nodes[1]).copied();
        }
        run
    };
    let begins = (0..pieces.len()).filter(|place| !ends.contains_key(&pieces[*place].nodes[0]));
    let mut runs: Vec<Run> = begins.map(|place| Run { pieces: follow(place), start: 0.0, is_closed: false }).collect();
    for place in 0..pieces.len() {
        let closed = follow(place);
        if !closed.is_empty() {
            let start = start_of(&closed, ROUND_OFF * mesh::extent(mesh));
            runs.push(Run { pieces: closed, start, is_closed: true });
        }
    }
    runs
}

/// Length along a closed run at which it crosses the positive x axis where it is farthest out; at its node of the largest
/// x where it does not cross it.
fn start_of(closed: &[Piece], near: f64) -> f64 {
    let mut along = 0.0;
    let (mut crossing, mut outermost) = (None, (f64::NEG_INFINITY, 0.0));
    for piece in closed {
        let (from, to) = (piece.from, piece.to);
        if from.x > outermost.0 + near {
            outermost = (from.x, along);
        }
        // Half open, so that a node on the axis counts once; round-off beside it counts as on it.
        let [below, above] = [from.y, to.y].map(|y| if y.abs() <= near { 0.0 } else { y });
        if (below <= 0.0) != (above <= 0.0) {
            let share = below / (below - above);
            let x = from.x + share * (to.x - from.x);
            if x > 0.0 && crossing.is_none_or(|(farthest, _)| x > farthest) {
                crossing = Some((x, along + share * piece.length()));
            }
        }
        along += piece.length();
    }
    crossing.unwrap_or(outermost).1
}

/// Whole numbers of springs on `runs`, `count` together, in proportion to their lengths: the largest remainders are
/// rounded up.
///
/// # Errors
/// [`RunError::Mounting`] where equal runs would have to differ.
fn counts(runs: &[Run], count: usize) -> Result<Vec<usize>, RunError> {
    let length: f64 = runs.iter().map(Run::length).sum();
    let exact: Vec<f64> = runs.iter().map(|run| count as f64 * run.length() / length + ROUND_OFF).collect();
    let mut whole: Vec<usize> = exact.iter().map(|exact| exact.floor() as usize).collect();
    let missing = count - whole.iter().sum::<usize>().min(count);
    let remainder = |run: &usize| exact[*run].fract();
    let mut order: Vec<usize> = (0..runs.len()).collect();
    order.sort_by(|a, b| remainder(b).total_cmp(&remainder(a)).then(a.cmp(b)));
    let is_tie = (1..runs.len()).contains(&missing)
        && (remainder(&order[missing - 1]) - remainder(&order[missing])).abs() < ROUND_OFF;
    if is_tie {
        let edges = runs.len();
        let message = format!("{count} springs cannot be spread evenly over {edges} held edges of the computed part");
        let hint = format!("use a multiple of {edges} springs on the computed part");
        return Err(RunError::at_key("frame.springs.count", message, hint));
    }
    order.iter().take(missing).for_each(|run| whole[*run] += 1);
    Ok(whole)
}

impl Piece {
    /// m.
    fn length(&self) -> f64 {
        (self.to - self.from).norm()
    }

    /// Normal in the plane of the frame, away from the film.
    fn outward(&self) -> Vector3<f64> {
        let along = self.to - self.from;
        Vector3::new(along.y, -along.x, 0.0).normalize()
    }
}

impl Run {
    fn length(&self) -> f64 {
        self.pieces.iter().map(Piece::length).sum()
    }

    /// The place of the piece at a length along it, which begins anew at its end, and the share of the piece up to there.
    fn at(&self, along: f64) -> (usize, f64) {
        let mut rest = along.rem_euclid(self.length());
        let last = self.pieces.len() - 1;
        for (place, piece) in self.pieces[..last].iter().enumerate() {
            if rest < piece.length() {
                return (place, rest / piece.length());
            }
            rest -= piece.length();
        }
        (last, (rest / self.pieces[last].length()).min(1.0))
    }

    /// Outward normals of the edge on either side of a share of a piece: at a node those of the pieces that it joins.
    fn normals(&self, place: usize, share: f64) -> [Vector3<f64>; 2] {
        let count = self.pieces.len();
        let other = if share < ROUND_OFF && (self.is_closed || place > 0) {
            (place + count - 1) % count
        } else if share > 1.0 - ROUND_OFF && (self.is_closed || place + 1 < count) {
            (place + 1) % count
        } else {
            place
        };
        [place, other].map(|place| self.pieces[place].outward())
    }
}

/// The time step of film on springs.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SpringStep {
    /// On its springs, s.
    pub step: f64,
    /// Without them, s.
    pub free: f64,
}

impl SpringStep {
    /// The key that bounds the step.
    pub const KEY: &str = "frame.springs.stiffness";

    /// Step without springs over that with them, above which these are what a run takes long for.
    const MUCH: f64 = 4.0;

    /// That of an engine before its first step; none where its film hangs on no springs.
    pub fn of_engine(engine: &Engine) -> Option<SpringStep> {
        Some(SpringStep { step: engine.time_step(), free: engine.time_step_without_springs()? })
    }

    /// Whether the springs shorten the step much.
    pub fn is_much_shorter(&self) -> bool {
        self.free > SpringStep::MUCH * self.step
    }
}
