//! Doubts about confidence intervals.

use base::{findings, number};

findings! {
    /// A warning about a confidence interval.
    #[derive(Clone, Debug, PartialEq)]
    pub enum Warning {
        NoEffect {
            combination: String, "the combination, such as `k1·ke^-0.8`" => "combination";
        } = "no-effect", Warning;
            meaning "the residuals do not depend on a combination of parameters, which is structurally not \
                identifiable";
            remedy "fix one parameter of the combination, or add data that depend on it";
            message "{combination} is not identifiable: it has no effect on the residuals";
        PoorlyDetermined {
            combination: String, "the combination" => "combination";
            factor: f64, "half-width of its interval of 95 %, as a factor" => "factor";
        } = "poorly-determined", Warning;
            meaning "the confidence interval of a combination of parameters reaches a factor of 1.5 in the linear \
                model";
            remedy "fix one parameter of the combination, or add signals or tests to the objective";
            message "{combination} is poorly determined: in the linear model its interval of 95 % reaches a factor {}",
                number::figure(*factor, 2);
        WeaklyIdentifiable {
            combination: String, "the combination" => "combination";
            ratio: f64, "largest singular value over its own" => "ratio";
        } = "weakly-identifiable", Warning;
            meaning "the effect of a combination of parameters on the residuals is below 1 % of the largest: errors of \
                model and sensor determine it";
            remedy "add data on which the combination has more effect";
            message "{combination} is weakly identifiable: its effect on the residuals is {} times smaller than that \
                of the best-determined combination, and small errors of model or sensor change it",
                number::figure(*ratio, 2);
        Correlated {
            parameters: [String; 2], "the two" => "parameters";
            correlation: f64, "their coefficient of correlation" => "correlation";
        } = "correlated", Warning;
            meaning "the correlation of two parameters exceeds 0.95: a change of one is compensated by the other";
            remedy "report both together, or add data that separate them";
            message "{} and {} are correlated by {}", parameters[0], parameters[1], number::figure(*correlation, 3);
        FewIndependentResiduals {
            samples: usize, "number of residuals" => "samples";
            effective_samples: f64, "effective number of independent residuals" => "effective_samples";
            parameters: usize, "number of parameters" => "parameters";
        } = "few-independent-residuals", Warning;
            meaning "the residuals are so strongly correlated that they count as few independent ones: they show model \
                error rather than noise";
            remedy "improve the model; the intervals do not cover its error";
            message "the {samples} residuals are correlated and count as {} independent ones for {parameters} \
                parameters: they show model error rather than noise, which the intervals do not cover",
                number::significant(*effective_samples, 3);
        ResidualsBelowRoughness {
            norm: f64, "norm of the residuals" => "norm";
            roughness: f64, "largest second difference of the residuals" => "roughness";
        } = "residuals-below-roughness", Warning;
            meaning "the residuals are no larger than the roughness or the curvature of the model over the step of the \
                differences";
            remedy "do not read the intervals as scatter of measurements; change `difference` if the objective is \
                rough";
            message "the residuals ({}) are no larger than the roughness of the model or its curvature over the step \
                of the differences ({}): the intervals do not show the scatter of measurements",
                number::figure(*norm, 3), number::figure(*roughness, 3);
        OneSided { parameter: String, "the parameter" => "parameter" } = "one-sided", Warning;
            meaning "the derivative along a parameter is a one-sided difference, since the other side lies beyond a \
                bound or failed";
            remedy "move the bound";
            message "the derivative along {parameter} is one-sided (bound or failed trial): its interval is valid on \
                that side at best";
        NotAtMinimum {
            parameter: String, "the parameter" => "parameter";
            standard_errors: f64, "length of the step, standard errors" => "standard_errors";
        } = "not-at-minimum", Warning;
            meaning "a Gauss-Newton step from the estimate moves a parameter by more than half a standard error";
            remedy "search again from the estimate with tighter tolerances";
            message "{parameter} is not at its minimum: a Gauss-Newton step would move it by {} standard errors",
                number::figure(*standard_errors, 2);
    }
}
