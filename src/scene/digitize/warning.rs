//! Doubts about a curve that was read out of a picture.

use base::findings;

findings! {
    /// A doubt about a curve.
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub enum Warning {
        Interrupted {
            share: f64, "share of its length";
            from: f64, "where the longest gap begins, in the unit of the x axis";
            to: f64, "where it ends";
        } = "curve-interrupted", Warning;
            meaning "the curve is missing over a part of its length; values there are interpolated by whoever reads \
                the table";
            remedy "look at --overlay: another curve may cover it, or `colour` and `tolerance` may not be those of the \
                picture";
            message "the curve is missing over {:.1} % of its length, at most between {from:.4} and {to:.4}",
                100.0 * share;
        Elsewhere { share: f64, "share of the coloured pixels" } = "colour-elsewhere", Warning;
            meaning "much of what has the colour of the curve is not on it, so that the curve may be another one";
            remedy "leave legends and letters out by `curve.without`, narrow `curve.area`, or lower `curve.tolerance`; \
                look at --overlay";
            message "{:.0} % of what has the colour of the curve is not on it", 100.0 * share;
        Short { share: f64, "share of the width that is looked at" } = "curve-short", Warning;
            meaning "the curve covers a small part of the axis";
            remedy "look at --overlay: `colour`, `tolerance` and `area` may not be those of the curve";
            message "the curve covers {:.0} % of the x axis", 100.0 * share;
    }
}
