//! Warnings of fits of relaxation, by code.

use base::findings;

findings! {
    /// A doubt about a fit that continues.
    #[derive(Clone, Debug, PartialEq)]
    pub enum Warning {
        TermsLeftOut {
            asked: usize, "number of terms that were asked for" => "asked";
            left: usize, "number of terms that are left" => "left";
        } = "prony-terms-left-out", Note;
            meaning "terms of a Prony series have no share in the best fit and are left out";
            remedy "none is needed; runs cost less with fewer terms";
            message "{left} of {asked} terms are left: the others have no share in the best fit";
    }
}
