//! Warnings of fits of laws, by code.

use base::findings;
use base::number::significant;
use membrane::material::Tension;

findings! {
    /// A doubt about a fit that continues.
    #[derive(Clone, Debug, PartialEq)]
    pub enum Warning {
        UniaxialOnly = "uniaxial-only", Warning;
            meaning "a law was fitted to uniaxial tests alone: many sets of coefficients agree there and differ in \
                biaxial tension, so that film under a dart, a pressure or a head is predicted without any basis";
            remedy "add an equibiaxial test, or one of plane tension (pure shear)";
            message "fitted to uniaxial tests alone: unsafe for film that is stretched in two directions";
        UnstableRejected {
            stable: f64, "norm of the residuals of the fit that was taken" => "residuals";
            unstable: f64, "that of the unstable one" => "unstable_residuals";
            stable_to: f64, "stretch up to which the law is to be stable" => "stable_to_stretch";
        } = "unstable-fit-rejected", Note;
            meaning "coefficients with smaller residuals were found, and the law is unstable with them in the range of \
                stretch; the best stable fit was taken";
            remedy "none is needed; --stable-to changes the range, another law or more tests may fit better";
            message "a fit with residuals of {} in place of {} is unstable below the stretch {} and was not taken",
                significant(*unstable, 3), significant(*stable, 3), significant(*stable_to, 4);
        /// The law is unstable in the range that is asked for.
        UnstableInRange {
            tension: Tension, "kind of tension" => "tension" = tension.to_string();
            stretch: f64, "least stretch" => "stretch";
            stable_to: f64, "stretch up to which the law is to be stable" => "stable_to_stretch";
        } = "unstable-fit" as UNSTABLE_IN_RANGE, Warning;
            meaning "the fitted law is unstable in the range of stretch (Hill's criterion): its stresses fall while \
                film is stretched, and a run tears or collapses there";
            remedy "fit another law, or ask for a smaller range with --stable-to";
            message "the law is unstable in {tension} from the stretch {} on, below {}",
                significant(*stretch, 4), significant(*stable_to, 4);
        /// The law is unstable in a state that was measured.
        UnstableWhereMeasured = code &UNSTABLE_IN_RANGE;
            message "the law is unstable in a state that was measured";
        TermsLeftOut {
            asked: usize, "number of terms that were asked for" => "asked";
            left: usize, "number of terms that are left" => "left";
        } = "terms-left-out", Note;
            meaning "terms of a law have no stress in the best fit and are left out";
            remedy "none is needed; the tests do not show more terms";
            message "{left} of {asked} terms are left: the others have no stress in the best fit";
        OnBound {
            coefficient: String, "name of the coefficient" => "coefficient";
            value: f64, "its value" => "value";
        } = "coefficient-on-bound", Warning;
            meaning "a coefficient of a fit lies on the bound of its range, so that the tests do not determine it";
            remedy "fit a law with fewer coefficients, or add tests of another kind";
            message "{coefficient} = {} lies on the bound of its range: the tests do not determine it",
                significant(*value, 4);
        NoIntervals { why: String, "why" } = "no-intervals", Warning;
            meaning "the coefficients of a fit have no confidence intervals";
            remedy "add measured points, or fit a law with fewer coefficients";
            message "the coefficients have no intervals: {why}";
    }
}
