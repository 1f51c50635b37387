//! Loads by gas: pressure under film, gas that is let in, air between faces.

use super::Engine;
use super::cushion::Enclosed;
use super::nodes::Kick;
use super::pressure::{self, GasStep};

impl Engine {
    /// Adds the load of the pressure, if there is one, and its work to the ledger.
    pub(super) fn inflate(&mut self) {
        let Some(inflation) = &self.loads.inflation else { return };
        let now = pressure::inflate(&self.films, &mut self.nodes, inflation.pressure_at(self.time));
        self.ledger.external -= self.loads.multiplicity * now.work_since(self.inflated);
        self.inflated = Some(now);
    }

    /// Adds the load of the gas that is let in, if there is any, to the other forces of a step that kicks the nodes
    /// over `over` (s) and moves them by `dt` (s), and its work to the ledger.
    pub(super) fn fill(&mut self, over: f64, dt: f64) {
        let Some(filling) = &self.loads.filling else { return };
        if self.failed > 0 {
            // The space that elements deleted in this step enclosed stays filled: the run ends with it.
            let flat = pressure::volume(&self.films, &self.nodes) - filling.volume_at(self.time);
            self.inflated.iter_mut().for_each(|before| before.volume += flat - self.flat_volume);
            self.flat_volume = flat;
        }
        let step = GasStep {
            target: self.flat_volume + filling.volume_at(self.time + dt),
            kick: Kick::new(over, self.loads.damping),
            dt,
            gravity: self.loads.film_gravity(),
        };
        let now = pressure::fill(&self.films, &mut self.nodes, &step);
        self.ledger.external -= self.loads.multiplicity * now.work_since(self.inflated);
        self.inflated = Some(now);
    }

    /// Adds the load of the air between the first two faces `dt` (s) after the last step, if it is computed, and its
    /// work to the ledger.
    pub(super) fn press(&mut self, dt: f64) {
        let Some(air) = &self.loads.cushion else { return };
        let enclosed = Enclosed::between(&self.films, &self.nodes);
        let now = air.after(self.cushion, air.volume + enclosed.volume - self.mounted_volume, dt);
        for (n, gradient) in enclosed.gradient.iter().enumerate() {
            self.nodes.force.add(n, (now.pressure * gradient).into());
        }
        self.ledger.external -= self.loads.multiplicity * now.work_since(self.cushion);
        self.cushion = Some(now);
    }
}
