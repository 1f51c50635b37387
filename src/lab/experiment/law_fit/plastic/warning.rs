//! Warnings of the fit of a plastic law.

use super::PlasticDirection;
use base::findings;
use base::number::significant;

findings! {
    /// A finding of the fit.
    #[derive(Clone, Debug, PartialEq)]
    pub enum Warning {
        UnloadingNotMeasured = "unloading-not-measured", Warning;
            meaning "the coupons were only stretched, so nothing shows what part of their strain stays as a set: it is \
                taken to be what is beyond the stress over the modulus, as in film that unloads along its first slope";
            remedy "unload some coupons and compare their set with the plastic strain of the law; film that recovers \
                is not plastic";
            message "no coupon was unloaded: the plastic strain is what exceeds the stress over the modulus, assumed";
        RatioAssumed {
            key: &'static str, "its key" => "key";
            direction: PlasticDirection, "the direction of coupons that would show it";
        } = "yield-ratio-assumed", Note;
            meaning "no coupon shows a ratio of yield stress, which is taken as 1, that of isotropic film";
            remedy "measure coupons in this direction, or the width of the others";
            message "no coupon along {direction}: `{key}` is 1, assumed";
        Scatters {
            name: String, "name of the coupon" => "coupon";
            difference: f64, "largest difference over the largest stress" => "difference";
            scatter: f64, "largest difference of coupons of one direction over their stress" => "scatter";
        } = "hardening-scatters", Note;
            meaning "the fitted law differs from a coupon by more than coupons of one direction do from each other";
            remedy "look at the coupon; isotropic hardening has one shape of curve for all directions";
            message "{name}: the law differs by up to {} %, coupons of one direction by up to {} %",
                significant(100.0 * difference, 2), significant(100.0 * scatter, 2);
    }
}
