//! Equilibrium before a test, by dynamic relaxation with kinetic damping (theory.md, section 18).

use std::ops::Range;

use nalgebra::{Point3, Vector3};
use serde::{Deserialize, Serialize};

use super::film_contact::FilmContact;
use super::nodes::RelaxationStep;
use super::{EnergyLedger, Engine, Fault, Film, Impact, Progress, Vectors, film};

/// Residual below which film counts as mounted in equilibrium.
const MOUNTED: f64 = 1e-3;

/// Residual at which relaxation ends.
const TOLERANCE: f64 = 1e-6;

/// Strain of film whose forces count as round-off.
const ROUND_OFF: f64 = 1e-9;

/// Steps between two updates of the masses against vertical motion, where these are hardly reduced; else every step is.
const LIGHTNESS_INTERVAL: u64 = 10;

/// Vertical stiffness over that along the film, with the reduced mass: well below one, so that the time step is stable.
const VERTICAL_SHARE: f64 = 0.1;

/// Largest factor by which mass against vertical motion is reduced.
const MOST_LIGHTNESS: f64 = 1e3;

/// Gap to a bar over its radius at which a node touches it.
const TOUCHING: f64 = 1e-9;

/// Steps after which it ends without equilibrium.
const MOST_STEPS: u64 = 200_000;

/// How film came to equilibrium before a test. Residuals are forces out of balance over reactions (theory.md,
/// equation 172).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Relaxation {
    /// Residual of the film as mounted.
    pub mounted: f64,
    /// Residual at the start of the test.
    pub residual: f64,
    /// Steps taken; zero where the film was mounted in equilibrium.
    pub steps: u64,
    /// Largest displacement of a node, m.
    pub displacement: f64,
    /// Rise of the highest point of all film, by which impactors in contact with it were lifted, m: slack film may
    /// settle above the plane in which it was mounted.
    pub lift: f64,
}

/// How far film is from equilibrium while it is brought there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settling {
    /// Residual when the film was last at rest.
    pub residual: f64,
    /// Residual at which it counts as settled.
    pub tolerance: f64,
    /// Steps so far.
    pub steps: u64,
}

impl Relaxation {
    /// Whether the test starts from equilibrium.
    pub fn is_in_equilibrium(&self) -> bool {
        self.residual <= MOUNTED
    }

    /// Whether it ended at the most steps, short of the residual that is asked for.
    pub fn is_given_up(&self) -> bool {
        self.steps >= MOST_STEPS && self.residual > TOLERANCE
    }
}

impl Engine {
    /// Brings the films that are `wanted`, one entry each, to equilibrium with their pre-strain and their weight before
    /// the first step; jaws stand still and nothing touches the film but the frame's bars, without friction; the
    /// impactor stays above it. Where the residual of these films as mounted is below 10⁻³, nothing is changed.
    /// Histories and energies count from the equilibrium; initial velocities stay as they are. Nodes without elements, as cuts along
    /// a mirror plane leave them, stay where they are.
    ///
    /// Each step calls `proceed` with its progress, which ends the relaxation by `false`.
    ///
    /// # Errors
    /// The time step collapses, or a force on the film as mounted is not finite.
    pub fn relax(&mut self, wanted: &[bool], proceed: impl FnMut(Settling) -> bool) -> Result<Relaxation, Fault> {
        let loose = self.nodes_without_elements();
        let free: Vec<[bool; 3]> = loose.iter().map(|node| self.nodes.free_axes(*node)).collect();
        self.nodes.hold(loose.iter().copied(), [true; 3]);
        let found = self.relax_elements(wanted, proceed);
        loose.into_iter().zip(free).for_each(|(node, free)| self.nodes.release(node, free));
        found
    }

    /// Nodes that belong to no element: they would fall freely, and film with them would never be at rest.
    fn nodes_without_elements(&self) -> Vec<usize> {
        let mut alone = vec![true; self.nodes.mass.len()];
        let mut used = |corners: &[u32]| corners.iter().for_each(|node| alone[*node as usize] = false);
        self.films.iter().for_each(|film| film.for_each_intact(&mut used));
        (0..alone.len()).filter(|node| alone[*node] && self.nodes.free_axes(*node) != [false; 3]).collect()
    }

    /// [`Engine::relax`] of film whose loose nodes are held. Long, as it is one loop over a few quantities.
    fn relax_elements(
        &mut self,
        wanted: &[bool],
        mut proceed: impl FnMut(Settling) -> bool,
    ) -> Result<Relaxation, Fault> {
        let all = vec![true; self.films.len()];
        self.virgin_forces();
        let mounted = self.residual(&all);
        let mut residual = self.residual(wanted);
        if let Some(face) = self.face_without_forces() {
            // A first step would carry it to the impactor and blame that.
            let (time, has_limit) = (self.progress.time, self.films[face].has_limit());
            let face = face + 1;
            return Err(if has_limit { Fault::StretchLimit { time, face } } else { Fault::FilmLost { time, face } });
        }
        if residual <= MOUNTED {
            self.nodes.clear_forces();
            return Ok(Relaxation { mounted, residual: mounted, steps: 0, displacement: 0.0, lift: 0.0 });
        }
        let (position, velocity) = (self.nodes.position.clone(), self.nodes.velocity.clone());
        self.nodes.stop();
        let ranges: Vec<Range<usize>> = chosen(&self.films, wanted).map(|film| film.nodes.clone()).collect();
        let gravity: Vec<f64> = chosen(&self.films, wanted).map(|film| self.loads.film_gravity(film)).collect();
        let (mut steps, mut kinetic, mut at_rest, mut lightness) = (0, 0.0, true, 1.0);
        while steps < MOST_STEPS && proceed(Settling { residual, tolerance: TOLERANCE, steps }) {
            let (last, dt) = self.progress.time_step.next(&self.films, &self.nodes, &self.pool, self.progress.time)?;
            if at_rest {
                residual = self.residual(wanted);
                if residual <= TOLERANCE {
                    break;
                }
            }
            if at_rest || lightness > 10.0 || steps % LIGHTNESS_INTERVAL == 0 {
                let allowed = self.lightness();
                if at_rest {
                    lightness = allowed;
                } else if allowed < lightness {
                    // Heavier nodes keep their kinetic energy.
                    self.nodes.scale_vertical_velocity((allowed / lightness).sqrt());
                    lightness = allowed;
                }
            }
            // After each stop it starts anew, with the half kick of a first step.
            let over = if at_rest { 0.5 * dt } else { 0.5 * (last + dt) };
            let step = |gravity: &f64| RelaxationStep { last, dt, kick: over, gravity: *gravity, lightness };
            // Kinetic damping: film swings freely and is stopped where its kinetic energy peaks, near the least
            // potential energy. No damping constant has to fit an unknown frequency.
            let parts = || ranges.iter().zip(&gravity);
            let now: f64 = parts().map(|(range, gravity)| self.nodes.relax(range.clone(), &step(gravity))).sum();
            self.settle_on_bars(&ranges);
            steps += 1;
            // Seen one step late, hence the way back to the peak below.
            at_rest = now < kinetic;
            kinetic = if at_rest { 0.0 } else { now };
            if at_rest {
                parts().for_each(|(range, gravity)| self.nodes.return_to_peak(range.clone(), &step(gravity)));
                self.settle_on_bars(&ranges);
                self.nodes.stop();
            }
            self.virgin_forces();
        }
        // Of all films, also of those that were not asked for: it is what the test starts from.
        let residual = self.residual(&all);
        let moved = |n: usize| (self.nodes.position_of(n) - Point3::from(position.value_at(n))).norm();
        let displacement = (0..self.nodes.mass.len()).map(moved).fold(0.0, f64::max);
        let highest = |position: &Vectors| position.axes()[2].iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let rise = (highest(&self.nodes.position) - highest(&position)).max(0.0);
        let mut lift = 0.0;
        for impact in self.impacts.iter_mut().filter(|impact| impact.in_contact) {
            impact.body.pose.translation.vector.z += rise;
            lift = rise;
        }
        self.nodes.velocity = velocity;
        self.start_from_here();
        Ok(Relaxation { mounted, residual, steps, displacement, lift })
    }

    /// Puts nodes of these ranges that penetrate the frame's bars onto them, without velocity into them.
    fn settle_on_bars(&mut self, ranges: &[Range<usize>]) {
        let Some(Impact { body, contact, .. }) = self.impacts.last().filter(|impact| impact.is_frame) else { return };
        for n in ranges.iter().flat_map(Range::clone) {
            let (gap, normal) = contact.gap(&self.nodes, &body.pose, n);
            if gap >= 0.0 || self.nodes.is_held(n) {
                continue;
            }
            let velocity = self.nodes.velocity_of(n);
            self.nodes.position.set(n, (self.nodes.position_of(n).coords - normal * gap).into());
            self.nodes.velocity.set(n, (velocity - normal * velocity.dot(&normal).min(0.0)).into());
        }
    }

    /// Squares of the forces (N²) that the frame's bars take of those on the nodes of `film`, in equilibrium without
    /// friction.
    fn squared_force_on_bars(&self, film: &Film) -> f64 {
        let Some(Impact { body, contact, .. }) = self.bars() else { return 0.0 };
        let touching = TOUCHING * contact.surface().size();
        let of_node = |n: usize| {
            let (gap, normal) = contact.gap(&self.nodes, &body.pose, n);
            let weight = Vector3::z() * (self.nodes.mass[n] * self.loads.film_gravity(film));
            let pressed = (Vector3::from(self.nodes.force.value_at(n)) - weight).dot(&normal);
            if gap < touching { pressed.min(0.0).powi(2) } else { 0.0 }
        };
        film.nodes.clone().filter(|n| !self.nodes.is_held(*n)).map(of_node).sum()
    }

    /// Factor by which mass against vertical motion may be lower: film of small strain and slope has little vertical
    /// stiffness, and its slowest motions are vertical (theory.md, equation 173).
    fn lightness(&self) -> f64 {
        let (mut strains, position) = (vec![], &self.nodes.position);
        film::strains(&self.films, &self.pool, position.axes(), &mut strains);
        let intact = strains.iter().flatten().filter(|element| element.volume > 0.0);
        let strain =
            intact.flat_map(|element| [element.strain[0], element.strain[1]]).fold(0.0, |most, e| e.abs().max(most));
        let mut slope_squared: f64 = 0.0;
        for film in &self.films {
            film.for_each_intact(|corners| {
                for (a, b) in corners.iter().zip(corners.iter().cycle().skip(1)) {
                    let (a, b) = (position.value_at(*a as usize), position.value_at(*b as usize));
                    let [x, y, z] = [b[0] - a[0], b[1] - a[1], b[2] - a[2]];
                    slope_squared = slope_squared.max(z * z / (x * x + y * y));
                }
            });
        }
        let share = strain + slope_squared;
        let share = self.springs.as_ref().map_or(share, |springs| share.max(springs.vertical_share(&self.nodes)));
        (VERTICAL_SHARE / share).clamp(1.0, MOST_LIGHTNESS)
    }

    /// Sets the forces at the nodes to those of virgin film at the present positions.
    fn virgin_forces(&mut self) {
        self.films.iter_mut().for_each(Film::reset);
        self.nodes.clear_forces();
        self.add_forces(0.0);
    }

    /// Largest residual of any `wanted` film with the forces at the nodes (theory.md, equation 172).
    fn residual(&self, wanted: &[bool]) -> f64 {
        let of_film = |film: &Film| {
            let [free, held] = self.nodes.squared_forces(film.nodes.clone(), self.loads.film_gravity(film));
            // A force that bars take is a reaction, like that of a held node: it moves from the one sum to the other.
            let on_bars = self.squared_force_on_bars(film).min(free);
            let (free, held) = (free - on_bars, held + on_bars);
            let held = held + self.springs.as_ref().map_or(0.0, |springs| springs.squared_forces(&film.nodes));
            // Slack film has neither forces nor reactions; below round-off there is nothing to be settled (theory.md,
            // equation 172).
            if free == 0.0 { 0.0 } else { (free / held.max(self.squared_round_off(film))).sqrt() }
        };
        // `max` would drop a NaN, and film that is nowhere would count as settled.
        let larger = |most: f64, residual: f64| if residual > most || residual.is_nan() { residual } else { most };
        chosen(&self.films, wanted).map(of_film).fold(0.0, larger)
    }

    /// The first face with a residual that is not a number.
    fn face_without_forces(&self) -> Option<usize> {
        let only = |face: usize| (0..self.films.len()).map(|other| other == face).collect::<Vec<bool>>();
        (0..self.films.len()).find(|face| self.residual(&only(*face)).is_nan())
    }

    /// Sum of squares of the nodal forces of `film` under a strain of [`ROUND_OFF`], N²: mass over the square of the
    /// step is a stiffness, and the root of a node's area a length.
    fn squared_round_off(&self, film: &Film) -> f64 {
        let per_strain = ROUND_OFF / self.progress.time_step.now().powi(2);
        let force = |mass: &f64| per_strain * mass * (mass / (film.density() * film.thickness)).sqrt();
        self.nodes.mass[film.nodes.clone()].iter().map(|mass| force(mass).powi(2)).sum()
    }

    /// Makes the present positions those at the start.
    fn start_from_here(&mut self) {
        self.films.iter_mut().for_each(Film::reset);
        self.nodes.clear_forces();
        let Progress { ledger, inflated, cushion, .. } = &mut self.progress;
        (*ledger, *inflated, *cushion) = (EnergyLedger::default(), None, None);
        self.forces(0.0);
        self.nodes.clear_forces();
        self.impacts.iter_mut().for_each(|impact| impact.contact.invalidate_neighbours());
        self.film_contact.iter_mut().for_each(FilmContact::invalidate);
        self.progress.time_step = self.first_time_step();
    }
}

/// The `films` that are `wanted`.
fn chosen<'a>(films: &'a [Film], wanted: &'a [bool]) -> impl Iterator<Item = &'a Film> {
    films.iter().zip(wanted).filter_map(|(film, wanted)| wanted.then_some(film))
}
