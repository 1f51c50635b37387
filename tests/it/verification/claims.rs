//! Figures beside their bounds.

/// Gathers figures, prints each beside its bound, and fails once all are known.
pub struct Claims {
    test: &'static str,
    missed: Vec<String>,
}

impl Claims {
    /// No claims yet.
    pub fn of(test: &'static str) -> Claims {
        Claims { test, missed: vec![] }
    }

    /// `figure` is at most `bound`; a figure that is not a number is not.
    pub fn at_most(&mut self, what: &str, figure: f64, bound: f64) {
        self.line(what, &format!("{figure:.3e}, at most {bound:.0e}"), figure <= bound);
    }

    /// `figure` lies within `share` of `reference`.
    pub fn near(&mut self, what: &str, figure: f64, reference: f64, share: f64) {
        let off = (figure / reference - 1.0).abs();
        self.line(what, &format!("{figure:.6e} for {reference:.6e}, off by {off:.2e} of {share:.0e}"), off <= share);
    }

    /// `truth` holds; `seen` is what was found.
    pub fn holds(&mut self, what: &str, seen: &str, truth: bool) {
        self.line(what, seen, truth);
    }

    fn line(&mut self, what: &str, seen: &str, truth: bool) {
        let line = format!("{} | {what} | {seen}", self.test);
        println!("{line}{}", if truth { "" } else { " | MISSED" });
        if !truth {
            self.missed.push(line);
        }
    }

    /// Fails if any claim was missed.
    pub fn judge(self) {
        assert!(self.missed.is_empty(), "missed:\n{}", self.missed.join("\n"));
    }
}
