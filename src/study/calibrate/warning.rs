//! Findings of calibrations.

use base::findings;
use base::number::significant;

findings! {
    /// A finding of a calibration.
    #[derive(Clone, Debug, PartialEq)]
    pub enum Warning {
        NotDetermined {
            parameter: String, "the parameter" => "parameter";
            half_width: f64, "half width of its interval of 95 %, relative to its value" => "half_width";
            prior_share: f64, "its standard deviation over that before the tests" => "prior_share";
            basis: String, "what that rests on" => "basis";
        } = "not-determined", Warning;
            meaning "the tests of a calibration do not determine a parameter, whatever the others are: its interval is \
                wider than `precision`, or nearly as wide as its bounds or its prior";
            remedy "add a test or a signal that depends on it (`settles` of the result compares candidates), or give it a \
                prior or a fixed value from elsewhere";
            message "{parameter} is not determined by these tests: 95 % half width {} of its value, {} of the width that was \
                known before ({basis})", percent(*half_width), percent(*prior_share);
        DeterminedTogether {
            parameter: String, "the parameter" => "parameter";
            others: Vec<String>, "those that it depends on" => "others";
            half_width: f64, "half width of its interval of 95 %, relative to its value" => "half_width";
            half_width_alone: f64, "the same if the others were known" => "half_width_alone";
            basis: String, "what that rests on" => "basis";
        } = "determined-together", Warning;
            meaning "the tests determine a combination of parameters, not this one: a change of one is made up for by the \
                others";
            remedy "add a test that separates them (`settles` of the result compares candidates), or fix one of them";
            message "{parameter} is determined only together with {}: 95 % half width {} of its value, {} if they were known ({basis})",
                others.join(" and "), percent(*half_width), percent(*half_width_alone);
        MeasureNext {
            candidate: String, "the candidate" => "candidate";
            parameter: String, "the parameter that it tells most of" => "parameter";
            now: f64, "half width of its interval of 95 %, relative to its value" => "half_width_now";
            then: f64, "the same with the candidate" => "half_width_then";
        } = "measure-next", Note;
            meaning "of the candidates that were compared, this one narrows an interval most: of parameters that the tests do not determine where \
                there are any";
            remedy "make that test, and add its recording to the tests";
            message "measure {candidate} next: it narrows the 95 % interval of {parameter} from ±{} to ±{} of its value", percent(*now), percent(*then);
        MeshLimited {
            parameter: String, "the parameter" => "parameter";
            moved: f64, "what the correction for the elements moves it by: of its value, of a parameter that is no factor in its unit" => "moved";
            half_width: f64, "half width of its interval of 95 %, relative to its value" => "half_width";
            coarse: Vec<String>, "its tests whose elements are coarse in contact" => "coarse";
            sizes: Vec<String>, "sizes that the elements of its tests should have" => "sizes";
            basis: String, "what that rests on" => "basis";
        } = "mesh-limited", Warning;
            meaning "the elements of the tests are so coarse that they move a parameter by more than its interval, or are coarse in contact: \
                signals are corrected for that to the first order, which such a difference is beyond";
            remedy "refine `specimen.mesh.size` as the finding says, and start from the values found; `mesh: \"exact\"` is for virtual \
                recordings on the same elements";
            message "{parameter} is limited by the mesh: {}, and its interval does not hold ({basis}); take elements of {}",
                if coarse.is_empty() {
                    format!("correcting for the elements moves it by {} where its 95 % half width is {}", signed(*moved), percent(*half_width))
                } else {
                    format!("elements are coarse in contact in {}, beyond what a correction reaches", coarse.join(", "))
                },
                sizes.join(", ");
        MeshNotChecked {
            test: String, "the test" => "test";
            cause: String, "why" => "cause";
        } = "mesh-not-checked" as MESH_NOT_CHECKED, Warning;
            meaning "a test cannot be run on elements of half the size, or its film breaks there, so that nobody knows what its mesh moves the parameters by";
            remedy "run it on a finer mesh by hand, and compare";
            message "{test} was not run on finer elements, {cause}: intervals know nothing of the mesh";
        /// It fails where the posterior is.
        MeshNotFollowed {
            test: String, "the test" => "test";
            cause: String, "why" => "cause";
        } = code &MESH_NOT_CHECKED;
            message "{test} was not run on finer elements at two points of the posterior, {cause}: the error of its mesh counts as \
                that at the best point";
        AnglesDoNotFollow {
            angles: Vec<String>, "angles of these coupons from MD, degrees" => "angles";
            least: f64, "least mean difference of the law from such a coupon, relative" => "least";
            most: f64, "largest mean difference of the law from such a coupon, relative" => "most";
            error: f64, "largest relative error over the strains of such a coupon" => "error";
            of_modulus: f64, "largest relative difference of a modulus between, beyond that of the moduli at 0, 45 and 90 degrees" => "of_modulus";
            needs: String, "what a law that follows them needs" => "needs";
        } = "angles-do-not-follow", Warning;
            meaning "a law that is fitted to coupons at 0, 45 and 90 degrees does not predict the coupons at the angles between: fibre \
                curves and a shear curve that know nothing of each other make film too stiff there once it yields in more than \
                one of them";
            remedy "do not trust the law beyond that error where film is strained at an angle to its fibres; a plastic law with Hill's \
                ratios yields in all directions together";
            message "fitted to 0, 45 and 90 degrees, the law is {} to {} off at {} degrees (modulus {}): {needs}",
                signed(*least), signed(*most), angles.join(", "), signed(*of_modulus);
        Misfit {
            test: String, "the test" => "test";
            signal: String, "its signal" => "signal";
            error: f64, "its relative error with the best values" => "error";
            others: f64, "median of the others' errors" => "others";
        } = "misfit", Warning;
            meaning "with the best values a test is off by four times as much as the others, and by more than 2 %: the law cannot follow it \
                together with them, or something about it is wrong";
            remedy "look at its plot: is it the recording of this scenario, in the right unit and window; `left_out` of the result says what \
                the others give without it";
            message "{test}: its {signal} is off by {}, {} times as much as the others", percent(*error),
                significant(*error / *others, 2);
        TablesReplaced = "tables-replaced", Warning;
            meaning "a script calibrates twice under one name, or without one, so that the tables of the first result are replaced";
            remedy "give each calibration a `name`: its tables begin with it";
            message "the tables of a calibration before this one are replaced: give each a `name`";
        ModelError {
            share: f64, "the error, as a share of each signal" => "share";
            correlation: String, "its most likely correlations" => "correlation";
        } = "model-error", Note;
            meaning "a calibration estimated the error of the model from what the best parameters leave: intervals contain it, over \
                every length of correlation where none is given";
            remedy "none is needed; `discrepancy` gives it another size or correlation";
            message "the model's error is estimated as {} of each signal, correlated over {correlation} (most likely)", percent(*share);
        ModelErrorShape {
            test: String, "the test" => "test";
            shape: String, "the likeliest correlation" => "shape";
            gain: f64, "logarithm of the mean likelihood of all correlations over that of the one that is given" => "gain";
        } = "model-error-shape", Warning;
            meaning "what the best parameters leave of a test is correlated otherwise than `correlation` says, so that intervals may be far too \
                narrow or too wide";
            remedy "leave `correlation` out: the posterior then counts all lengths that are likely";
            message "{test}: errors correlated otherwise, most likely over {shape}, are likelier than the correlation that is given, by {} \
                in the logarithm",
                significant(*gain, 2);
        OfRuns {
            tests: Vec<String>, "the tests" => "tests";
            of: String, "the code of the warning of their runs" => "of";
            message: String, "that of the first" => "of_message";
        } = "runs-warn", Warning;
            meaning "the runs of tests with the best values have a warning of their own: parameters that were found with it may be \
                those of a mesh or a law rather than of the film, whatever their intervals are";
            remedy "`droptower explain` with that code says what to do; a mesh that is coarse in contact is refined by \
                `specimen.mesh.size`";
            message "{}: {of}, {message}", tests.join(", ");
        RunFailed {
            test: String, "the test" => "test";
            cause: String, "why its run failed" => "cause";
        } = "best-run-failed", Warning;
            meaning "a test runs with the best values as long as its recording is compared, and fails behind: its whole run has no figures";
            remedy "run the test with the values found, as `study.test(…)` gives it, to see what it does there";
            message "{test}: its whole run with the best values failed behind what is compared, {cause}";
        ErrorsNotSettled {
            change: f64, "last relative change of a noise or of the model's error" => "change";
            rounds: usize, "searches so far" => "rounds";
        } = "errors-not-settled", Warning;
            meaning "the noise of the signals or the model's error, which follow from what the best parameters leave, still changed by \
                more than 15 % after the last search that they weigh";
            remedy "give `discrepancy` a size, or refine the mesh where contact makes the signals rough";
            message "noise or model error still changed by {} in the last of {rounds} searches", percent(*change);
        CorrelationOverTravel {
            tests: Vec<String>, "tests whose signals are over a travel, a depth or a strain" => "tests";
        } = "correlation-over-travel", Note;
            meaning "the correlation of the model's error is given as a time, which says nothing of signals over a travel: there it is \
                3 % of the window";
            remedy "none is needed; a `correlation` that is a number is a share of every window";
            message "the model's error of {} is correlated over 3 % of the window (assumed): a time says nothing of a travel",
                tests.join(", ");
        PosteriorNotConverged {
            parameter: String, "the parameter" => "parameter";
            r_hat: f64, "its R-hat" => "r_hat";
            effective: f64, "its effective size" => "effective";
        } = "posterior-not-converged", Warning;
            meaning "the ensembles that sample a posterior do not agree yet, or their samples are few for its tails";
            remedy "raise `steps`, or tighten `within` of what is not determined";
            message "the posterior of {parameter} is not converged: R-hat {}, effective size {}",
                significant(*r_hat, 4), significant(*effective, 3);
        SurrogateError {
            test: String, "the test" => "test";
            error: f64, "root mean square error of its surrogate at new points, in standard deviations of a residual" => "error";
            runs: usize, "runs that it rests on" => "runs";
        } = "surrogate-error", Warning;
            meaning "a posterior is sampled on a surrogate of each test, whose error at new points of the posterior is as large as \
                what the test can tell; that error is in the likelihood, so that the posterior is wider than the tests allow";
            remedy "raise `rounds` or `runs` of `posterior`, or refine the mesh where contact makes the signals rough";
            message "the surrogate of {test} is off by {} standard deviations of a residual after {runs} runs; the posterior contains \
                that", significant(*error, 3);
        PosteriorCut { rounds: usize, "rounds so far" => "rounds" } = "posterior-cut", Warning;
            meaning "the samples of a posterior still reach the face of a surrogate's region after the last round, so that the \
                posterior is wider, or elsewhere, than it is shown";
            remedy "raise `rounds`; search from more `starts`, since the best point may be a local minimum; tighten `within` of what is \
                not determined";
            message "the posterior still reaches the region of its surrogates after {rounds} rounds";
        PosteriorRuns {
            test: String, "the test" => "test";
            failed: usize, "runs without a value" => "failed";
            runs: usize, "all of them" => "runs";
            cause: String, "why the first failed" => "cause";
        } = "posterior-runs-failed", Warning;
            meaning "runs of a posterior have no value: the film broke, or the simulation failed. They are left out, so that the \
                posterior does not know that region";
            remedy "tighten `within` where many failed";
            message "{failed} of {runs} runs of {test} have no value, the first: {cause}";
        PosteriorElsewhere {
            parameter: String, "the parameter" => "parameter";
            value: f64, "its value at the end of the search" => "value";
            low: f64, "lower end of the posterior's interval of 95 %" => "low";
            high: f64, "upper end of it" => "high";
            unit: String, "the unit of these" => "unit";
        } = "posterior-elsewhere", Warning;
            meaning "the best point of a search lies outside of the posterior: the search ended in a local minimum, as contact of coarse \
                elements makes them, and its linear intervals are those of that minimum";
            remedy "take the posterior's values; a finer mesh or more `starts` bring the search nearer";
            message "the search ended at {parameter} = {}, outside of the posterior's 95 %, {} to {}{}: its intervals do not count",
                significant(*value, 4), significant(*low, 4), significant(*high, 4),
                if unit.is_empty() { String::new() } else { format!(" {unit}") };
        PredictionWithout {
            scenario: String, "the scenario" => "scenario";
            parameter: String, "the parameter" => "parameter";
            why: String, "why" => "why";
        } = "prediction-without-parameter", Note;
            meaning "a parameter has no part in a prediction: the scenario lacks its key, each test has a value of its own, two \
                parameters write that key in different tests, or the break strains of its film cannot be set";
            remedy "none is needed where the scenario does not depend on it; otherwise set its key in the scenario";
            message "{parameter} has no part in the prediction of {scenario}: {why}";
        LeftOutNotConverged { test: String, "what was left out" => "test" } = "left-out-not-converged", Warning;
            meaning "a search without tests stopped at its limit of evaluations or at a bound, so that the error of what was left out \
                may be that of the search";
            remedy "raise `max_evaluations`, widen `within`, or fix what the other tests do not determine";
            message "the search without {test} has not converged";
        NothingToLeaveOut = "nothing-to-leave-out", Warning;
            meaning "no test of a calibration can be left out: each has an unknown that no other test has, or it is the only one";
            remedy "share parameters that tests have of their `own`, or name several tests to leave out together";
            message "no test can be left out: each has an unknown that no other test has, or it is the only one";
        LeftOutFailed {
            test: String, "the test" => "test";
            cause: String, "why" => "cause";
        } = "left-out-failed", Warning;
            meaning "a test cannot be run with the parameters that the others give, so that its error when left out is not known";
            remedy "that is a result: the others do not tell enough of it; narrow `within`, or give a prior";
            message "{test} has no run with the parameters of the others: {cause}";
        PredictionOutside {
            scenario: String, "the scenario" => "scenario";
            signal: String, "the signal" => "signal";
            share: f64, "share of the recording that lies in the band of 95 %" => "share";
        } = "prediction-outside-band", Warning;
            meaning "a recording of a scenario that was predicted lies outside of its band far oftener than in one place of twenty: the \
                model is further off there than the tests of the calibration show";
            remedy "count that test in the calibration, refine the mesh, or give the tests more freedom (`hierarchy`, a larger \
                `discrepancy`)";
            message "{scenario}: only {} of its recorded {signal} lie in the band of 95 % that was predicted", percent(*share);
        PredictionOfFewRuns {
            scenario: String, "the scenario" => "scenario";
            runs: usize, "its runs" => "runs";
            held: f64, "what their least and largest value hold" => "held";
        } = "prediction-of-few-runs", Warning;
            meaning "the least and the largest of n values hold (n - 1)/(n + 1) of further ones: below 39 runs no interval of the runs alone \
                holds 95 %, so that what is shown as 95 % reaches from the least to the largest value and holds less";
            remedy "raise `samples` to 39 at least";
            message "intervals of 95 % of {scenario} hold {}: they rest on {runs} runs", percent(*held);
        PredictionFailed {
            scenario: String, "the scenario" => "scenario";
            failed: usize, "runs without a value" => "failed";
            runs: usize, "all of them" => "runs";
            cause: String, "why the first failed" => "cause";
        } = "prediction-runs-failed", Warning;
            meaning "runs of a prediction have no value; its quantiles are of the others";
            remedy "find out why they fail: a band without them may be too narrow";
            message "{failed} of {runs} runs of {scenario} have no value, the first: {cause}";
    }
}

impl Warning {
    /// Whether both say the same of one parameter, by whatever basis.
    pub(super) fn is_of_the_same(&self, other: &Warning) -> bool {
        match (self, other) {
            (Warning::NotDetermined { parameter: one, .. }, Warning::NotDetermined { parameter: two, .. })
            | (
                Warning::DeterminedTogether { parameter: one, .. },
                Warning::DeterminedTogether { parameter: two, .. },
            )
            | (Warning::MeshLimited { parameter: one, .. }, Warning::MeshLimited { parameter: two, .. }) => one == two,
            _ => false,
        }
    }
}

fn signed(share: f64) -> String {
    format!("{}{} %", if share > 0.0 { "+" } else { "" }, significant(100.0 * share, 2))
}

fn percent(share: f64) -> String {
    let percent = 100.0 * share;
    if percent > 1000.0 { "more than 1000 %".into() } else { format!("{} %", significant(percent, 2)) }
}
