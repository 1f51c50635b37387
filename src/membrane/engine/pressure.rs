//! Pressure: a follower load on the present area, along the present normal.
//!
//! With the volume `V` between the film and any fixed surface through its edge, the load is the gradient
//! `F_a = p ∂V/∂x_a`, so its work is exactly `∫ p dV` as long as the edge is held (theory.md, equation 29). The
//! pressure is given, or that under which `V` follows the gas that is let in (equation 227).

use std::ops::Range;

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use super::Engine;
use super::film::Film;
use super::nodes::{Kick, Nodes, Vectors};

/// A pressure that rises smoothly and is then constant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Inflation {
    /// Final value, Pa.
    pub pressure: f64,
    /// Rise time, s.
    pub ramp: f64,
}

impl Inflation {
    /// Pressure at `time` (s), Pa: `s³(10 − 15s + 6s²)` of the final value at the share `s` of the ramp (theory.md,
    /// equation 30). Flat film rises with the cube root of the pressure, and so at a steady rate at first; at the end
    /// of the ramp the rate and its derivative are zero.
    pub fn pressure_at(&self, time: f64) -> f64 {
        rise(self.pressure, time / self.ramp)
    }
}

/// Gas that is let in smoothly, and whose volume is then constant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Filling {
    /// Final volume under the computed part of the film, over that as mounted, m³.
    pub volume: f64,
    /// Time in which it is let in, s.
    pub ramp: f64,
}

impl Filling {
    /// Volume at `time` (s), m³, by the same function of time as that of a pressure.
    pub(super) fn volume_at(&self, time: f64) -> f64 {
        rise(self.volume, time / self.ramp)
    }
}

/// Value of a smooth rise to `last` at the share `s` of its time.
fn rise(last: f64, s: f64) -> f64 {
    let s = s.clamp(0.0, 1.0);
    last * s * s * s * (10.0 + s * (6.0 * s - 15.0))
}

/// Gas that film encloses at one step.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Gas {
    /// Over that of the surroundings, Pa.
    pub(super) pressure: f64,
    /// Of the computed part, up to a constant, m³.
    pub(super) volume: f64,
}

impl Gas {
    /// Work on the film since `before`, J, by the trapezoidal rule.
    pub(super) fn work_since(&self, before: Option<Gas>) -> f64 {
        before.map_or(0.0, |before| 0.5 * (before.pressure + self.pressure) * (self.volume - before.volume))
    }
}

/// Volume that film encloses and its gradient at the nodes.
pub(super) struct Enclosed {
    /// Of the computed part, up to a constant, m³.
    pub(super) volume: f64,
    /// Its derivative by the position of each of these nodes, m².
    pub(super) gradient: Vec<Vector3<f64>>,
    nodes: Range<usize>,
}

impl Enclosed {
    fn nothing(nodes: Range<usize>) -> Enclosed {
        Enclosed { volume: 0.0, gradient: vec![Vector3::zeros(); nodes.len()], nodes }
    }

    /// Volume under a film.
    pub(super) fn under(film: &Film, nodes: &Nodes) -> Enclosed {
        let mut out = Enclosed::nothing(film.nodes.clone());
        out.add(film, &nodes.position, 1.0);
        out
    }

    /// Volume between the first two of `films`, whose nodes come first.
    pub(super) fn between(films: &[Film], nodes: &Nodes) -> Enclosed {
        let count = films.iter().take(2).map(|film| film.nodes.end).max().unwrap_or(0);
        let mut out = Enclosed::nothing(0..count);
        films.iter().zip([1.0, -1.0]).for_each(|(film, sign)| out.add(film, &nodes.position, sign));
        out
    }

    /// Adds `sign` times the volume under a film.
    fn add(&mut self, film: &Film, position: &Vectors, sign: f64) {
        film.for_each_intact(|corners| {
            let load = ElementLoad::from_corners(corners, position);
            for (n, area) in corners.iter().zip(load.areas) {
                self.gradient[*n as usize - self.nodes.start] += sign * area;
            }
            self.volume += sign * load.volume;
        });
    }

    /// Adds the load of `pressure` (Pa) to the forces of the nodes.
    fn press(&self, pressure: f64, nodes: &mut Nodes) {
        for (n, gradient) in self.nodes.clone().zip(&self.gradient) {
            nodes.force.add(n, (pressure * gradient).into());
        }
    }
}

/// Volume under the last of `films`, up to a constant, m³.
pub(super) fn volume(films: &[Film], nodes: &Nodes) -> f64 {
    films.last().map_or(0.0, |film| Enclosed::under(film, nodes).volume)
}

/// The load on an element under unit pressure.
pub(super) struct ElementLoad {
    /// Vector area that belongs to each node, m²; the last one of a triangle does not count.
    pub(super) areas: [Vector3<f64>; 4],
    /// Volume of the cone from the origin to the element, m³.
    pub(super) volume: f64,
}

impl ElementLoad {
    /// Load on the element with these nodes.
    pub(super) fn from_corners(corners: &[u32], position: &Vectors) -> ElementLoad {
        let place = |a: usize| Vector3::from(position.value_at(corners[a] as usize));
        match corners.len() {
            3 => triangle([place(0), place(1), place(2)]),
            _ => quad([place(0), place(1), place(2), place(3)]),
        }
    }
}

fn triangle(x: [Vector3<f64>; 3]) -> ElementLoad {
    let area = (x[1] - x[0]).cross(&(x[2] - x[0])) / 2.0;
    // The cone from the origin: another origin changes the volume by a constant as long as the rim is held.
    ElementLoad { areas: [area / 3.0; 4], volume: x[0].dot(&area) / 3.0 }
}

/// ∫ N_a ∂x/∂ξ × ∂x/∂η dξdη (theory.md, equation 29) over the bilinear surface x = c + ξ a + η b + ξη h, in closed
/// form.
fn quad(x: [Vector3<f64>; 4]) -> ElementLoad {
    const CORNERS: [[f64; 2]; 4] = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
    let a = (x[1] + x[2] - x[0] - x[3]) / 4.0;
    let b = (x[2] + x[3] - x[0] - x[1]) / 4.0;
    // Warped quads bulge: with flat areas, work of the pressure would not be p dV.
    let h = (x[0] + x[2] - x[1] - x[3]) / 4.0;
    let (flat, along, across) = (a.cross(&b), a.cross(&h) / 3.0, h.cross(&b) / 3.0);
    let areas = CORNERS.map(|[xi, eta]| flat + along * xi + across * eta);
    ElementLoad { areas, volume: (x[0] + x[1] + x[2] + x[3]).dot(&flat) / 3.0 }
}

impl Engine {
    /// Adds the load of the pressure on the lower side of the last film, if there is one, and its work to the ledger.
    pub(super) fn inflate(&mut self) {
        let (Some(inflation), Some(film)) = (&self.loads.inflation, self.films.last()) else { return };
        let nodes = &mut self.nodes;
        let mut now = Gas { pressure: inflation.pressure_at(self.progress.time), volume: 0.0 };
        film.for_each_intact(|corners| {
            let load = ElementLoad::from_corners(corners, &nodes.position);
            for (n, area) in corners.iter().zip(load.areas) {
                nodes.force.add(*n as usize, (now.pressure * area).into());
            }
            now.volume += load.volume;
        });
        self.count_inflation(now);
    }

    /// Adds the work of the gas under the last film since the last step to the ledger.
    fn count_inflation(&mut self, now: Gas) {
        self.progress.ledger.external.add_at_once(-self.loads.multiplicity * now.work_since(self.progress.inflated));
        self.progress.inflated = Some(now);
    }

    /// Adds the load of the gas that is let in under the last film, if there is any, to the other forces of a step that
    /// kicks the nodes over `over` (s) and moves them by `dt` (s), and its work to the ledger. Its pressure is that under
    /// which the volume is the target after the step, to first order (theory.md, equation 227). What the order leaves is
    /// made up in the next step.
    pub(super) fn fill(&mut self, over: f64, dt: f64) {
        let Some(filling) = &self.loads.filling else { return };
        if self.failed > 0 {
            // The space that elements deleted in this step enclosed stays filled: the run ends with it.
            let flat = volume(&self.films, &self.nodes) - filling.volume_at(self.progress.time);
            self.progress.inflated.iter_mut().for_each(|before| before.volume += flat - self.flat_volume);
            self.flat_volume = flat;
        }
        let Some(film) = self.films.last() else { return };
        let nodes = &mut self.nodes;
        let enclosed = Enclosed::under(film, nodes);
        let kick = Kick::new(over, self.loads.damping);
        // Growth of the volume without gas, and by a pressure of 1 Pa.
        let (mut growth, mut response) = (0.0, 0.0);
        for (area, n) in enclosed.gradient.iter().zip(film.nodes.clone()) {
            let (inverse_mass, velocity, force) =
                (nodes.effective_inverse_mass().value_at(n), nodes.velocity.value_at(n), nodes.force.value_at(n));
            for axis in 0..3 {
                let field = if axis == 2 { -self.loads.film_gravity(film) } else { 0.0 };
                // Held nodes with a velocity, as at jaws, change the volume too.
                let is_free = inverse_mass[axis] > 0.0;
                let after = kick.after(velocity[axis], force[axis] * inverse_mass[axis] + field);
                growth += area[axis] * if is_free { after } else { velocity[axis] };
                response += area[axis] * area[axis] * kick.after(0.0, inverse_mass[axis]);
            }
        }
        let target = self.flat_volume + filling.volume_at(self.progress.time + dt);
        // Linear in the pressure, since it acts on velocities by one kick: no iteration (theory.md, equation 227).
        let pressure = ((target - enclosed.volume) / dt - growth) / response;
        enclosed.press(pressure, nodes);
        self.count_inflation(Gas { pressure, volume: enclosed.volume });
    }

    /// Adds the load of the air between the first two faces `dt` (s) after the last step, if it is computed, and its
    /// work to the ledger.
    pub(super) fn press(&mut self, dt: f64) {
        let Some(air) = &self.loads.cushion else { return };
        let enclosed = Enclosed::between(&self.films, &self.nodes);
        let now = air.after(self.progress.cushion, air.volume + enclosed.volume - self.mounted_volume, dt);
        enclosed.press(now.gas.pressure, &mut self.nodes);
        let before = self.progress.cushion.map(|before| before.gas);
        self.progress.ledger.external.add_at_once(-self.loads.multiplicity * now.gas.work_since(before));
        self.progress.cushion = Some(now);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A cube's surface of warped quads whose corners are shared, in general position.
    fn box_corners() -> [Vector3<f64>; 8] {
        std::array::from_fn(|k| {
            let [i, j, l] = [k & 1, (k >> 1) & 1, (k >> 2) & 1].map(|bit| bit as f64);
            let warp = 0.2 * ((3 * k) as f64).sin();
            Vector3::new(i + warp, j - 0.5 * warp, l + 0.3 * warp * warp + 5.0)
        })
    }

    const SIDES: [[usize; 4]; 6] = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];

    fn volume(x: &[Vector3<f64>; 8]) -> f64 {
        SIDES.iter().map(|side| quad(side.map(|n| x[n])).volume).sum()
    }

    /// Around a closed surface, the load of unit pressure is the gradient of the volume, wherever the origin lies.
    #[test]
    fn the_load_on_quads_is_the_gradient_of_the_volume() {
        let x = box_corners();
        let mut load = [Vector3::zeros(); 8];
        for side in SIDES {
            let element = quad(side.map(|n| x[n]));
            side.iter().zip(element.areas).for_each(|(n, area)| load[*n] += area);
        }
        let step = 1e-5;
        for node in 0..8 {
            for axis in 0..3 {
                let moved = |sign: f64| {
                    let mut x = x;
                    x[node][axis] += sign * step;
                    volume(&x)
                };
                let difference = (moved(1.0) - moved(-1.0)) / (2.0 * step);
                assert!(
                    (difference - load[node][axis]).abs() < 1e-9,
                    "{node} {axis}: {difference} {}",
                    load[node][axis]
                );
            }
        }
        assert!(load.iter().sum::<Vector3<f64>>().norm() < 1e-14, "there is no resultant on a closed surface");
    }

    #[test]
    fn a_flat_quad_and_its_two_triangles_have_the_same_load() {
        let x = [[0.0, 0.0, 2.0], [1.0, 0.2, 2.0], [1.3, 1.1, 2.0], [-0.1, 0.8, 2.0]].map(Vector3::from);
        let whole = quad(x);
        let halves = [triangle([x[0], x[1], x[2]]), triangle([x[0], x[2], x[3]])];
        let area: Vector3<f64> = halves.iter().flat_map(|half| &half.areas[..3]).sum();
        assert!((whole.areas.iter().sum::<Vector3<f64>>() - area).norm() < 1e-15);
        assert!((whole.volume - halves[0].volume - halves[1].volume).abs() < 1e-15);
        assert!(area.z > 0.0, "the load on a counter-clockwise element acts upwards");
    }

    #[test]
    fn pressure_rises_along_the_ramp_and_is_constant_after_it() {
        let inflation = Inflation { pressure: 10e3, ramp: 0.05 };
        assert_eq!([0.0, 0.025, 0.05, 0.08].map(|time| inflation.pressure_at(time)), [0.0, 5e3, 10e3, 10e3]);
        let early = inflation.pressure_at(1e-3 * inflation.ramp) / inflation.pressure;
        assert!((early / 1e-8 - 1.0).abs() < 2e-3, "{early}");
    }
}
