//! Warnings of searches.

use super::options::Point;
use super::options::Side;
use base::findings;
use base::number;

findings! {
    /// A warning about a search. `start` counts starts from zero.
    #[derive(Clone, Debug, PartialEq)]
    pub enum Warning {
        StartsLeftOut {
            count: usize, "how many" => "count";
            starts: usize, "number of starts" => "starts";
            first: Point, "the first of them" => "first";
            cause: String, "why its trial failed" => "cause";
        } = "starts-left-out", Note;
            meaning "the objective has no value at some of the starts that are spread over the bounds; the search has \
                the others";
            remedy "none is needed where enough starts are left; otherwise tighten the bounds, or give the starts as a \
                list";
            message "{count} of {starts} starts have no value and are left out, the first at {first}: {cause}";
        StartOnBound {
            start: usize, "number of the start" => "start";
            parameter: String, "the unknown" => "parameter";
            side: Side, "which bound" => "side";
        } = "start-on-bound", Note;
            meaning "a start of a search lies on a bound of an unknown, where the initial simplex and the transform of \
                bounds are one-sided";
            remedy "move the start inside the bounds";
            message "start {} lies on the {side} bound of {parameter}", start + 1;
        FailedTrials {
            count: usize, "how many" => "count";
            first: Point, "the first of them" => "first";
            cause: String, "why the first failed" => "cause";
        } = "failed-trials", Warning;
            meaning "trials of a search had no value: the objective threw, was not finite, or the film ruptured; they \
                count as worse than all others";
            remedy "tighten the bounds if many failed; use on_rupture \"keep\" for tests that rupture";
            message "{count} {} failed and counted as worst, the first at {first}: {cause}",
                if *count == 1 { "trial" } else { "trials" };
        NotConverged { reason: String, "why it stopped" => "reason" } = "not-converged", Warning;
            meaning "a search stopped before its tolerances were met";
            remedy "raise max_iterations and max_evaluations, or loosen tol_x and tol_f if the objective is rough";
            message "not converged: {reason}";
        OnBound {
            parameter: String, "the unknown" => "parameter";
            value: f64, "its value" => "value";
            side: Side, "which bound" => "side";
            falls_beyond: Option<bool>, "whether the gradient points outwards, where it is known: a minimum within the \
                bounds" => "falls_beyond";
        } = "on-bound", Warning;
            meaning "the best point of a search lies on a bound: without it the minimum may lie beyond, so that the \
                search counts as not converged. Levenberg-Marquardt tells by the gradient whether the objective still \
                falls beyond the bound: the point is then the minimum within the bounds";
            remedy "widen the bound if larger or smaller values are physical; otherwise search from another start or \
                from several";
            message "not converged: {parameter} = {} lies on its {side} bound{}",
                number::significant(*value, 5), match falls_beyond {
                    Some(true) => ", and the objective still falls beyond it",
                    Some(false) => ", and the objective does not fall beyond it",
                    None => "",
                };
        StartsDisagree {
            starts: usize, "number of starts" => "starts";
            best: f64, "the lowest objective value" => "best";
            values: Vec<f64>, "the higher values" => "values";
        } = "starts-disagree", Warning;
            meaning "some starts of a search ended at a higher objective value than the best: there are local minima";
            remedy "use more starts, and compare the points at which they ended";
            message "{} of {starts} starts ended higher than {}, at {}: there are local minima",
                values.len(), number::significant(*best, 5), listed(values);
        NotUnique {
            count: usize, "how many" => "count";
            starts: usize, "number of starts" => "starts";
        } = "not-unique", Warning;
            meaning "some starts of a search ended at the same objective value as the best and at another point: the \
                data do not determine the unknowns";
            remedy "fix some unknowns, or add signals or tests to the objective";
            message "{count} of {starts} starts ended at the same value elsewhere: the minimum is not unique";
    }
}

fn listed(values: &[f64]) -> String {
    values.iter().map(|value| number::significant(*value, 5)).collect::<Vec<_>>().join(", ")
}
