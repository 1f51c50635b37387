//! Figures beside their bounds.

/// Collects figures, prints each beside its bound, and fails at the end of the test if one was missed.
pub struct Claims {
    test: &'static str,
    missed: Vec<String>,
}

impl Claims {
    /// No claims yet.
    pub fn of(test: &'static str) -> Claims {
        Claims { test, missed: vec![] }
    }

    /// `figure` is at most `bound`; NaN is not.
    pub fn at_most(&mut self, what: &str, figure: f64, bound: f64) {
        self.holds(what, &format!("{figure:.3e}, at most {bound:e}"), figure <= bound);
    }

    /// `figure` lies within `share` of `reference`.
    pub fn near(&mut self, what: &str, figure: f64, reference: f64, share: f64) {
        let off = (figure / reference - 1.0).abs();
        self.holds(what, &format!("{figure:.6e} for {reference:.6e}, off by {off:.2e} of {share:e}"), off <= share);
    }

    /// `errors` on meshes of halved element size decrease with at least `order`.
    pub fn converges(&mut self, what: &str, errors: &[f64], order: f64) {
        let slopes: Vec<f64> = errors.windows(2).map(|e| (e[0] / e[1]).abs().log2()).collect();
        let least = slopes.iter().copied().fold(f64::INFINITY, f64::min);
        let printed: Vec<String> = errors.iter().map(|error| format!("{error:.2e}")).collect();
        let converges = errors.len() > 1 && slopes.iter().all(|slope| *slope >= order);
        self.holds(what, &format!("errors {}, order {least:.2}, at least {order}", printed.join(", ")), converges);
    }

    /// `holds` is true; `figures` are printed.
    pub fn holds(&mut self, what: &str, figures: &str, holds: bool) {
        let line = format!("{} | {what} | {figures}", self.test);
        println!("{line}{}", if holds { "" } else { " | MISSED" });
        if !holds {
            self.missed.push(line);
        }
    }
}

impl Drop for Claims {
    fn drop(&mut self) {
        if !std::thread::panicking() {
            assert!(self.missed.is_empty(), "missed:\n{}", self.missed.join("\n"));
        }
    }
}
