//! Air between two faces of film, which leaves through vents (theory.md, section 19).

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use super::film::Film;
use super::nodes::Nodes;
use super::pressure::{ElementLoad, Gas};

/// Air between the first two faces, whose edges are held. It has one pressure; while film is intact it leaves through
/// vents alone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cushion {
    /// Pressure of the surroundings, Pa.
    pub ambient: f64,
    /// Density of the air there, kg/m³.
    pub density: f64,
    /// Exponent of pressure over density: 1 where the air keeps its temperature, 1.4 where it keeps its heat.
    pub exponent: f64,
    /// Area of the vents of the computed part times their discharge coefficient, m².
    pub vent: f64,
    /// Volume between the faces of the computed part as mounted, m³.
    pub volume: f64,
}

/// Air between the faces at one step.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct CushionState {
    /// Of the computed part, kg.
    mass: f64,
    pub(super) gas: Gas,
    /// Whether a face is torn, so that there is no pressure.
    pub(super) is_open: bool,
}

/// Area of `film` in the plane, m².
pub fn area(film: &Film, nodes: &Nodes) -> f64 {
    let mut area = 0.0;
    film.for_each_intact(|corners| {
        area +=
            ElementLoad::from_corners(corners, &nodes.position).areas[..corners.len()].iter().sum::<Vector3<f64>>().z
    });
    area
}

impl Cushion {
    /// The air after `dt` (s), in a volume of `volume` (m³); at first that of the surroundings.
    pub(super) fn after(&self, before: Option<CushionState>, volume: f64, dt: f64) -> CushionState {
        let Some(before) = before else {
            let gas = Gas { pressure: 0.0, volume };
            return CushionState { mass: self.density * volume, gas, is_open: false };
        };
        if before.is_open {
            return CushionState { gas: Gas { pressure: 0.0, volume }, ..before };
        }
        let mass = self.vented(before.mass, volume, dt);
        CushionState { mass, gas: Gas { pressure: self.pressure(mass, volume), volume }, is_open: false }
    }

    /// Over that of the surroundings, of `mass` (kg) in `volume` (m³), Pa.
    fn pressure(&self, mass: f64, volume: f64) -> f64 {
        let compression = mass / (self.density * volume);
        let ratio = if self.exponent == 1.0 { compression } else { compression.powf(self.exponent) };
        self.ambient * (ratio - 1.0)
    }

    /// Remainder of `mass` (kg) in `volume` (m³) after `dt` (s): an implicit step, so that air does not flow beyond
    /// the equal pressure in one step (theory.md, equation 191).
    fn vented(&self, mass: f64, volume: f64, dt: f64) -> f64 {
        if self.vent == 0.0 {
            return mass;
        }
        let flow = |mass: f64| {
            let pressure = self.pressure(mass, volume);
            let density = if pressure > 0.0 { mass / volume } else { self.density };
            self.vent * (2.0 * density * pressure.abs()).sqrt().copysign(pressure)
        };
        // Between no flow and the density of the surroundings.
        // Bisection with a fixed number of halvings: flow has an infinite slope at equal pressure, where Newton's
        // method fails.
        let (mut a, mut b) = (mass, self.density * volume);
        for _ in 0..64 {
            let middle = 0.5 * (a + b);
            let excess = middle + dt * flow(middle) - mass;
            if (excess > 0.0) == (mass > self.density * volume) { a = middle } else { b = middle }
        }
        0.5 * (a + b)
    }

    /// Bound on the squared angular frequency of film against the air, rad²/s², down to a quarter of the present
    /// `volume` (m³): `gradient` has m² and `inverse_mass` 1/kg a node.
    pub(super) fn squared_frequency(&self, volume: f64, gradient: &[Vector3<f64>], inverse_mass: &[f64]) -> f64 {
        let against: f64 = gradient.iter().zip(inverse_mass).map(|(area, inverse)| area.norm_squared() * inverse).sum();
        4.0 * self.exponent * self.ambient / volume * against
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cushion(exponent: f64, vent: f64) -> Cushion {
        Cushion { ambient: 101_325.0, density: 1.2, exponent, vent, volume: 4.8e-3 }
    }

    /// Closed air returns what it took up, and has the pressure of its polytropic line.
    #[test]
    fn closed_air_is_a_spring() {
        for exponent in [1.0, 1.4] {
            let air = cushion(exponent, 0.0);
            let volume =
                |k: u32| air.volume * (1.0 - 0.5 * (std::f64::consts::PI * f64::from(k) / 1000.0).sin().powi(2));
            let (mut now, mut work) = (air.after(None, volume(0), 0.0), 0.0);
            let mut largest = 0.0_f64;
            for k in 1..=1000 {
                let next = air.after(Some(now), volume(k), 1e-5);
                work += next.gas.work_since(Some(now.gas));
                largest = largest.max(next.gas.pressure);
                now = next;
            }
            assert!((largest / (air.ambient * (2.0_f64.powf(exponent) - 1.0)) - 1.0).abs() < 1e-12, "{largest}");
            assert!(work.abs() < 1e-9 * air.ambient * air.volume, "{work}");
        }
    }

    /// Pushed out at a steady rate, air has the pressure at which Bernoulli's equation lets it pass.
    #[test]
    fn vented_air_has_the_pressure_of_its_flow() {
        let air = cushion(1.0, 3e-3);
        let (rate, dt) = (0.05, 1e-5); // m³/s
        let mut now = air.after(None, air.volume, 0.0);
        let mut volume = air.volume;
        while volume > 0.5 * air.volume {
            volume -= rate * dt;
            now = air.after(Some(now), volume, dt);
        }
        let speed: f64 = rate / air.vent;
        let expected = 0.5 * air.density * speed * speed;
        assert!((now.gas.pressure / expected - 1.0).abs() < 0.01, "{} {expected}", now.gas.pressure);
    }

    #[test]
    fn air_does_not_flow_past_the_equal_pressure() {
        let air = cushion(1.4, 1.0);
        let first = air.after(None, air.volume, 0.0);
        for factor in [0.9, 1.1] {
            let next = air.after(Some(first), factor * air.volume, 1e-3);
            let side = (1.0 - factor) * next.gas.pressure;
            assert!(side >= 0.0 && next.gas.pressure.abs() < 10.0, "{}", next.gas.pressure);
        }
    }
}
