//! Consistent systems of units, as cards are written in: they have none of their own.

/// A system of units: mass, length and time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum System {
    /// kg, m, s: N, Pa.
    KgMS,
    /// t, mm, s: N, MPa.
    TMmS,
    /// g, mm, ms: N, MPa.
    GMmMs,
    /// kg, mm, ms: kN, GPa.
    KgMmMs,
    /// lbf s²/in, in, s: lbf, psi.
    LbfInS,
}

/// Pound-force, N.
const POUND_FORCE: f64 = 4.448_221_615_260_5;

/// Inch, m.
const INCH: f64 = 0.0254;

impl System {
    /// All of them.
    pub const ALL: [System; 5] = [System::KgMS, System::TMmS, System::GMmMs, System::KgMmMs, System::LbfInS];

    /// Its name on the command line and in cards.
    pub fn name(self) -> &'static str {
        match self {
            System::KgMS => "kg-m-s",
            System::TMmS => "t-mm-s",
            System::GMmMs => "g-mm-ms",
            System::KgMmMs => "kg-mm-ms",
            System::LbfInS => "lbf-in-s",
        }
    }

    /// The system of this name.
    pub fn from_name(name: &str) -> Option<System> {
        System::ALL.into_iter().find(|system| system.name() == name)
    }

    /// Units of mass, length, time, force and stress, as words.
    pub fn words(self) -> [&'static str; 5] {
        match self {
            System::KgMS => ["kg", "m", "s", "N", "Pa"],
            System::TMmS => ["t", "mm", "s", "N", "MPa"],
            System::GMmMs => ["g", "mm", "ms", "N", "MPa"],
            System::KgMmMs => ["kg", "mm", "ms", "kN", "GPa"],
            System::LbfInS => ["lbf s^2/in", "in", "s", "lbf", "psi"],
        }
    }

    /// Units of mass (kg), length (m) and time (s).
    fn base(self) -> [f64; 3] {
        match self {
            System::KgMS => [1.0, 1.0, 1.0],
            System::TMmS => [1e3, 1e-3, 1.0],
            System::GMmMs => [1e-3, 1e-3, 1e-3],
            System::KgMmMs => [1.0, 1e-3, 1e-3],
            System::LbfInS => [POUND_FORCE / INCH, INCH, 1.0],
        }
    }

    /// One unit of length, m.
    pub fn length(self) -> f64 {
        self.base()[1]
    }

    /// One unit of time, s.
    pub fn time(self) -> f64 {
        self.base()[2]
    }

    /// One unit of density, kg/m³.
    pub fn density(self) -> f64 {
        let [mass, length, _] = self.base();
        mass / length.powi(3)
    }

    /// One unit of stress, Pa.
    pub fn stress(self) -> f64 {
        let [mass, length, time] = self.base();
        mass / (length * time * time)
    }

    /// One unit of force per width, N/m.
    pub fn resultant(self) -> f64 {
        self.stress() * self.length()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 915 kg/m³, 8.4 MPa, 12 µm: in each system by hand.
    #[test]
    fn one_film_in_all_systems() {
        for (system, density, stress, length) in [
            (System::KgMS, 915.0, 8.4e6, 12e-6),
            (System::TMmS, 915e-12, 8.4, 0.012),
            (System::GMmMs, 915e-6, 8.4, 0.012),
            (System::KgMmMs, 915e-9, 8.4e-3, 0.012),
            // 1 psi = 6894.757293168361 Pa, 1 lbf s²/in⁴ = 10686896.9 kg/m³.
            (System::LbfInS, 915.0 / 10_686_895.98, 8.4e6 / 6_894.757_293_168, 12e-6 / 0.0254),
        ] {
            let near =
                |value: f64, expected: f64| assert!((value / expected - 1.0).abs() < 1e-6, "{system:?}: {value}");
            near(915.0 / system.density(), density);
            near(8.4e6 / system.stress(), stress);
            near(12e-6 / system.length(), length);
            assert_eq!(System::from_name(system.name()), Some(system));
        }
        assert_eq!(System::from_name("mm"), None);
    }
}
