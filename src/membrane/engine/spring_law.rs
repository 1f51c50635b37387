//! Force of a spring over its elongation.

/// Force of a spring over its elongation, straight between points (theory.md, equation 341). Its energy is the integral of
/// the force, so that it is elastic.
#[derive(Clone, Debug, PartialEq)]
pub struct SpringLaw {
    pieces: Vec<Piece>,
    /// Last elongation of a curve, m; infinite without one.
    end: f64,
    /// Whether it pushes where it is shorter than without force.
    pushes: bool,
}

/// A straight piece of a curve, up to the next.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Piece {
    /// m.
    elongation: f64,
    /// N.
    force: f64,
    /// N/m.
    stiffness: f64,
    /// Stored up to its beginning, J.
    energy: f64,
}

impl SpringLaw {
    /// A linear spring of this `stiffness` (N/m), which goes slack where it is shorter than without force unless it
    /// `pushes` there.
    pub fn linear(stiffness: f64, pushes: bool) -> SpringLaw {
        let piece = Piece { elongation: 0.0, force: 0.0, stiffness, energy: 0.0 };
        SpringLaw { pieces: vec![piece], end: f64::INFINITY, pushes }
    }

    /// A spring of this curve of elongations (m) and forces (N), both ascending from zero; beyond its last point it goes
    /// on along its last piece. Shorter than without force it is slack.
    ///
    /// # Panics
    /// Where there are less than two points.
    pub fn curve(points: &[[f64; 2]]) -> SpringLaw {
        let mut energy = 0.0;
        let piece = |[[e, f], [next_e, next_f]]: &[[f64; 2]; 2]| {
            let piece = Piece { elongation: *e, force: *f, stiffness: (next_f - f) / (next_e - e), energy };
            energy += 0.5 * (f + next_f) * (next_e - e);
            piece
        };
        let pieces: Vec<Piece> = points.array_windows().map(piece).collect();
        let end = points.last().filter(|_| !pieces.is_empty()).expect("a curve has at least two points")[0];
        SpringLaw { pieces, end, pushes: false }
    }

    /// Force at an `elongation` (m), N; zero where it is slack.
    pub fn force(&self, elongation: f64) -> f64 {
        let Some(piece) = self.piece(elongation) else { return 0.0 };
        piece.force + piece.stiffness * (elongation - piece.elongation)
    }

    /// Energy stored at an `elongation` (m), J.
    pub fn energy(&self, elongation: f64) -> f64 {
        let Some(piece) = self.piece(elongation) else { return 0.0 };
        let further = elongation - piece.elongation;
        piece.energy + (piece.force + 0.5 * piece.stiffness * further) * further
    }

    /// Elongation at which it has a `force` (N) that is not negative, m.
    pub fn elongation_at(&self, force: f64) -> f64 {
        let place = self.pieces.partition_point(|piece| piece.force <= force).max(1) - 1;
        let piece = self.pieces[place];
        piece.elongation + (force - piece.force) / piece.stiffness
    }

    /// Largest stiffness, N/m. A spring across its own direction has less: its force over its length.
    pub fn stiffest(&self) -> f64 {
        self.pieces.iter().map(|piece| piece.stiffness).fold(0.0, f64::max)
    }

    /// Elongation up to which it is given, m; infinite of a linear spring.
    pub fn end(&self) -> f64 {
        self.end
    }

    /// Whether it goes slack where it is shorter than without force.
    pub(super) fn goes_slack(&self) -> bool {
        !self.pushes
    }

    /// The piece at an elongation; none where it is slack.
    fn piece(&self, elongation: f64) -> Option<&Piece> {
        if elongation <= 0.0 && self.goes_slack() {
            return None;
        }
        self.pieces.get(self.pieces.partition_point(|piece| piece.elongation <= elongation).max(1) - 1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CURVE: [[f64; 2]; 4] = [[0.0, 0.0], [0.1, 50.0], [0.3, 70.0], [0.4, 170.0]];

    #[test]
    fn a_curve_is_met_at_its_points_and_goes_on_behind_them() {
        let law = SpringLaw::curve(&CURVE);
        for [elongation, force] in CURVE {
            assert!((law.force(elongation) - force).abs() < 1e-12, "{elongation}");
            assert!((law.elongation_at(force) - elongation).abs() < 1e-12, "{force}");
        }
        assert!((law.force(0.5) - 270.0).abs() < 1e-12);
        assert!((law.elongation_at(270.0) - 0.5).abs() < 1e-12);
        assert_eq!([law.force(-0.1), law.energy(-0.1)], [0.0; 2]);
        assert!((law.stiffest() - 1000.0).abs() < 1e-9);
        assert_eq!(law.end(), 0.4);
    }

    #[test]
    fn force_is_the_derivative_of_energy() {
        for law in [SpringLaw::curve(&CURVE), SpringLaw::linear(300.0, false), SpringLaw::linear(300.0, true)] {
            for elongation in [-0.05, 0.02, 0.17, 0.35, 0.6] {
                let step = 1e-6;
                let slope = (law.energy(elongation + step) - law.energy(elongation - step)) / (2.0 * step);
                assert!((slope - law.force(elongation)).abs() < 1e-6, "{law:?} at {elongation}");
            }
        }
    }

    #[test]
    fn only_a_spring_that_pushes_does() {
        assert_eq!(SpringLaw::linear(300.0, false).force(-0.1), 0.0);
        assert!((SpringLaw::linear(300.0, true).force(-0.1) + 30.0).abs() < 1e-12);
    }
}
