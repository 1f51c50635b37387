//! Rupture by a criterion of the element's own, and the softening that spends a fracture energy (theory.md, section
//! 25).

use serde::{Deserialize, Serialize};

/// When film starts to tear, and what a tear takes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Rupture {
    /// The quantity that is compared with the limit.
    pub criterion: Criterion,
    /// The value at which an element starts to tear, in the unit of the criterion.
    pub limit: f64,
    /// Fracture energy Γ, J per m² of cross-section of stress-free film; where it is zero, an element fails at once.
    pub fracture_energy: f64,
}

/// Quantity of an element that is compared with the limit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Criterion {
    /// Largest principal engineering strain.
    Strain,
    /// Larger engineering strain of the two fibre sets.
    FibreStrain,
    /// Larger strain of a fibre set over that at which its curve ends.
    Break,
    /// Largest principal nominal stress: force over stress-free cross-section, Pa.
    Stress,
    /// Energy stored and absorbed, J per m³ of stress-free film.
    Energy,
}

/// Share of its fracture energy that an element has spent when the elements around it are at the tip.
const OPEN: f64 = 0.25;

/// Share of the film's forces that an element has then at most, whatever it has spent: less than by equation 303 where it is
/// stretched by half from its start on.
const WEAK: f64 = 0.4;

/// By how much the energy of equation 303 is larger than the fracture energy, over itself.
const REST: f64 = 0.1;

/// Tearing of one element: energies are those per stress-free volume of film that does not tear.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Tear {
    /// Share of the film's forces that the element has, at the last position.
    pub share: f64,
    /// Share of the film's forces at the next position.
    pub next: f64,
    /// Energy spent since it started to tear, J/m³.
    pub spent: f64,
    /// Energy that was stored when it started to tear, J/m³; zero before.
    pub start: f64,
    /// Width of the element across the tear, m; zero before it started.
    pub width: f64,
    /// Energy stored at the last position, J/m³.
    pub stored: f64,
    /// Energy absorbed at the last position, J/m³.
    pub absorbed: f64,
    /// Distance of its middle from the line of the tear, along whose left side it is positive, m.
    pub offset: f64,
}

/// Energies of an element at a position, J/m³.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Densities {
    pub stored: f64,
    pub absorbed: f64,
}

impl Tear {
    /// Number of its variables.
    pub(crate) const VARIABLES: usize = 8;

    /// Film that does not tear.
    pub(crate) const NONE: Tear =
        Tear { share: 1.0, next: 1.0, spent: 0.0, start: 0.0, width: 0.0, stored: 0.0, absorbed: 0.0, offset: 0.0 };

    /// Its variables, always in the same order.
    pub(crate) fn variables(&self) -> [f64; Tear::VARIABLES] {
        let Tear { share, next, spent, start, width, stored, absorbed, offset } = *self;
        [share, next, spent, start, width, stored, absorbed, offset]
    }

    /// Tear with these variables, in the order of [`Tear::variables`].
    pub(crate) fn of_variables(variables: [f64; Tear::VARIABLES]) -> Tear {
        let [share, next, spent, start, width, stored, absorbed, offset] = variables;
        Tear { share, next, spent, start, width, stored, absorbed, offset }
    }

    /// Whether the element has started to tear.
    pub(crate) fn has_started(&self) -> bool {
        self.width > 0.0
    }

    /// Whether the element has started to tear and still has forces.
    pub(crate) fn is_tearing(&self) -> bool {
        self.has_started() && self.next > 0.0
    }

    /// Energy stored and absorbed at the last position, J/m³.
    pub(crate) fn work(&self) -> f64 {
        self.stored + self.absorbed
    }

    /// Whether film that tears stores half of what it did when it started: less where the tear went on beside it.
    pub(crate) fn is_loaded(&self) -> bool {
        self.stored > 0.5 * self.start
    }

    /// Whether film that tears stores less than that at which it would go on to lose forces, in film of this fracture
    /// energy (J/m²).
    pub(crate) fn waits(&self, fracture_energy: f64) -> bool {
        self.is_tearing() && self.next * (self.stored / self.start).sqrt() < self.left(fracture_energy).powi(2)
    }

    /// Lets film that waits lose forces from what it stores now on: ψ₀ of equation 303 becomes what it would have been,
    /// had it started at this.
    pub(crate) fn go_on(&mut self, fracture_energy: f64) {
        if self.waits(fracture_energy) {
            self.start =
                (self.stored * (self.next / self.left(fracture_energy).powi(2)).powi(2)).max(f64::MIN_POSITIVE);
        }
    }

    /// Share b of the energy of equation 303 that is left.
    fn left(&self, fracture_energy: f64) -> f64 {
        1.0 - self.spent * self.width * (1.0 - REST) / fracture_energy
    }

    /// Share of the area of its tear that is open, where it takes `fracture_energy` (J/m²).
    pub(crate) fn open(&self, fracture_energy: f64) -> f64 {
        match self.has_started() {
            false => 0.0,
            true if self.next == 0.0 => 1.0,
            true => (self.spent * self.width / fracture_energy).min(1.0),
        }
    }

    /// Whether so much is torn that the elements around it are at the tip.
    pub(crate) fn is_open(&self, fracture_energy: f64) -> bool {
        self.has_started() && (self.next < WEAK || self.open(fracture_energy) > OPEN)
    }

    /// Moves on to the next position, with these energies there. The energies that were lost on the way: the work of
    /// its forces is that of their mean (theory.md, equation 302).
    pub(crate) fn advance(&mut self, now: Densities) -> Densities {
        // Forces between two positions go from one share to the next: their mean is what does the work (theory.md,
        // equation 302).
        let (before, mean) = (self.share, 0.5 * (self.share + self.next));
        self.share = self.next;
        let fallen = before - self.share;
        let stored = 0.5 * (self.stored + now.stored) * fallen;
        let absorbed = 0.5 * (self.absorbed + now.absorbed) * fallen;
        if self.has_started() {
            // What film absorbs while it tears is part of the fracture energy, which is measured as total work.
            self.spent += stored + mean * (now.absorbed - self.absorbed).max(0.0);
        }
        (self.stored, self.absorbed) = (now.stored, now.absorbed);
        Densities { stored, absorbed }
    }

    /// Starts to tear, where the element is `width` (m) across the tear.
    pub(crate) fn start(&mut self, width: f64) {
        // Positive even without stored energy: √(ψ/ψ₀) must stay defined.
        (self.start, self.width) = (self.stored.max(f64::MIN_POSITIVE), width);
    }

    /// Sets the share of the forces at the next position, in film of this fracture energy (J/m²): with g = Γ/w/(1 − r), the
    /// share b of it that is left and the energy ψ stored, the share a follows
    ///
    /// ```text
    /// a √(ψ/ψ₀) = b² ,   g db = ψ da
    /// ```
    ///
    /// from the present share (theory.md, equation 303), until what is stored is the last part of Γ/w. Forces fall with the
    /// square of the energy that is left: steeply at first, so that a tear that starts goes on.
    pub(crate) fn soften(&mut self, fracture_energy: f64) {
        if !self.has_started() || self.next == 0.0 {
            return;
        }
        if fracture_energy == 0.0 {
            self.next = 0.0;
            return;
        }
        // Somewhat more than is taken: with the square of what is left, forces would never reach zero.
        let per_volume = fracture_energy / self.width / (1.0 - REST);
        let left = 1.0 - self.spent / per_volume;
        let (stretched, stored) = ((self.stored / self.start).sqrt(), self.stored / per_volume);
        if self.share * stretched > left * left {
            // Equation 303 with the mean force of the step: a square in the next share, of which the smaller root is taken.
            let least = left - stored * self.share;
            let linear = stretched - 2.0 * least * stored;
            let root = (stretched * (stretched - 4.0 * least * stored)).max(0.0).sqrt();
            // Where nothing is left even without forces, the element snaps through at once.
            let next = if least > 0.0 { 2.0 * least * least / (linear + root) } else { 0.0 };
            // A crack does not heal.
            self.next = next.clamp(0.0, self.share);
        }
        // What it stores is the last part of Γ.
        if (self.spent + self.share * self.stored) * self.width >= fracture_energy {
            self.next = 0.0;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Stretches an elastic element of the stiffness E and width w in steps, with the energy E ε²/2, from the strain at
    /// which it starts. The work of its forces and the energies lost.
    fn stretched(young: f64, start: f64, width: f64, fracture_energy: f64, steps: usize) -> ([f64; 2], Tear) {
        let (mut tear, mut force, mut work, mut lost) = (Tear::NONE, 0.0, 0.0, 0.0);
        let mut strain = 0.0;
        while tear.share > 0.0 && strain < 400.0 * start {
            let step = start / steps as f64;
            strain += step;
            let stored = 0.5 * young * strain * strain;
            let now = tear.next * young * strain;
            work += 0.5 * (force + now) * step;
            force = now;
            lost += tear.advance(Densities { stored, absorbed: 0.0 }).stored;
            if strain >= start && !tear.has_started() {
                tear.start(width);
            }
            tear.soften(fracture_energy);
        }
        ([work, lost], tear)
    }

    #[test]
    fn an_element_takes_its_fracture_energy_whatever_its_width() {
        let fracture_energy = 8e3;
        for width in [1e-4, 1e-3, 5e-3] {
            let ([work, lost], tear) = stretched(2e8, 0.1, width, fracture_energy, 400);
            let asked = fracture_energy / width;
            assert!((lost / asked - 1.0).abs() < 0.011, "{lost} J/m³ for {asked}");
            assert!((work / lost - 1.0).abs() < 1e-3, "work {work} for {lost}");
            assert!(tear.share == 0.0 && tear.open(fracture_energy) == 1.0);
        }
    }

    #[test]
    fn an_element_that_stores_more_fails_at_once() {
        let ([work, lost], tear) = stretched(2e8, 0.1, 20e-3, 8e3, 400);
        assert!((work / 1e6 - 1.0).abs() < 0.01 && (lost / work - 1.0).abs() < 1e-5, "{work}, {lost}");
        assert!(tear.share == 0.0);
    }

    /// An element that stores `stored` (J/m³) when it starts to tear, and `now` at the next position.
    fn swung_back(stored: f64, now: f64, width: f64) -> Tear {
        let mut tear = Tear::NONE;
        tear.advance(Densities { stored, absorbed: 0.0 });
        tear.start(width);
        tear.advance(Densities { stored: now, absorbed: 0.0 });
        tear
    }

    #[test]
    fn an_element_waits_while_it_stores_less_than_at_its_start() {
        let (width, fracture_energy) = (1e-3, 8e3);
        for (now, waits) in [(0.99e6, true), (1.01e6, false)] {
            let mut tear = swung_back(1e6, now, width);
            assert_eq!(tear.waits(fracture_energy), waits, "{now}");
            tear.soften(fracture_energy);
            assert_eq!(tear.next == 1.0, waits, "{now}: {tear:?}");
        }
        let mut whole = Tear::NONE;
        whole.advance(Densities { stored: 1e6, absorbed: 0.0 });
        let torn = Tear { next: 0.0, ..swung_back(1e6, 1e5, width) };
        for mut other in [whole, torn] {
            let before = other;
            other.go_on(fracture_energy);
            assert!(!other.waits(fracture_energy) && other == before, "{other:?}");
        }
    }

    /// It softens as if it had started with what it stores now; one that does not wait is left as it is.
    #[test]
    fn an_element_that_goes_on_starts_anew() {
        let (width, fracture_energy) = (1e-3, 8e3);
        let mut tear = swung_back(1e6, 0.25e6, width);
        tear.go_on(fracture_energy);
        assert_eq!(tear, swung_back(0.25e6, 0.25e6, width));
        let mut stretched = swung_back(1e6, 1.5e6, width);
        stretched.go_on(fracture_energy);
        assert_eq!(stretched, swung_back(1e6, 1.5e6, width));
    }

    /// Stretched until it has spent a part, let back to a third of its strain where it waits for as long as it is held, and
    /// stretched on from there: the force falls from the next position on, and the tear takes its
    /// fracture energy.
    #[test]
    fn an_element_that_goes_on_takes_its_fracture_energy() {
        let (young, start, width, fracture_energy) = (2e8, 0.1, 1e-3, 8e3);
        let density = |strain: f64| Densities { stored: 0.5 * young * strain * strain, absorbed: 0.0 };
        let (mut tear, mut lost) = (Tear::NONE, 0.0);
        let mut move_to = |tear: &mut Tear, strain: f64| {
            lost += tear.advance(density(strain)).stored;
            tear.soften(fracture_energy);
            tear.share
        };
        tear.advance(density(start));
        tear.start(width);
        let mut strain = start;
        while tear.share > 0.5 {
            strain += start / 400.0;
            move_to(&mut tear, strain);
        }
        strain /= 3.0;
        let held: Vec<f64> = (0..10).map(|_| move_to(&mut tear, strain)).collect();
        assert!(tear.waits(fracture_energy) && held[9] == held[1] && held[9] > 0.4, "{held:?}");
        tear.go_on(fracture_energy);
        let shares = [1.0, 2.0, 3.0].map(|step| move_to(&mut tear, strain + step * start / 400.0));
        assert!(shares[0] == held[9] && shares[1] < held[9] && shares[2] < shares[1], "{shares:?} from {}", held[9]);
        strain += 3.0 * start / 400.0;
        while tear.share > 0.0 && strain < 400.0 * start {
            strain += start / 400.0;
            move_to(&mut tear, strain);
        }
        let asked = fracture_energy / width;
        assert!((lost / asked - 1.0).abs() < 0.011, "{lost} J/m³ for {asked}");
    }
}
