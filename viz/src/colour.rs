//! Viridis (van der Walt and Smith, 2015): equal steps of the value look like equal steps.

/// Colour of text and guide lines.
pub(crate) const GREY: [u8; 3] = [128, 128, 132];

/// Number of distinct colours: equal neighbours compress.
const STEPS: f32 = 64.0;

/// The map at equal distances from the lowest to the highest value, sRGB.
const VIRIDIS: [[u8; 3]; 9] = [
    [68, 1, 84],
    [71, 45, 123],
    [59, 82, 139],
    [44, 114, 142],
    [33, 145, 140],
    [40, 174, 128],
    [94, 201, 98],
    [173, 220, 48],
    [253, 231, 37],
];

/// Colours of `values`, the first at the lower and the last at the upper end of `range`; what is not a number gets the
/// first.
pub(crate) fn of(values: &[f32], [low, high]: [f32; 2]) -> impl Iterator<Item = [u8; 3]> + '_ {
    let span = (high - low).max(f32::MIN_POSITIVE);
    values.iter().map(move |value| at((value - low) / span))
}

fn at(share: f32) -> [u8; 3] {
    let last = VIRIDIS.len() - 1;
    let share = if share.is_nan() { 0.0 } else { share.clamp(0.0, 1.0) };
    let place = (share * STEPS).round() / STEPS * last as f32;
    let below = (place as usize).min(last - 1);
    let rest = place - below as f32;
    let mix = |i: usize| {
        let [from, to] = [VIRIDIS[below][i], VIRIDIS[below + 1][i]].map(f32::from);
        (from + (to - from) * rest).round() as u8
    };
    [mix(0), mix(1), mix(2)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ends_and_middle_are_the_maps_own() {
        let colours: Vec<_> = of(&[-1.0, 0.0, 1.0, 2.0, 3.0, f32::NAN], [0.0, 2.0]).collect();
        let [first, middle, last] = [VIRIDIS[0], VIRIDIS[4], VIRIDIS[8]];
        assert_eq!(colours, [first, first, middle, last, last, first]);
    }

    #[test]
    fn a_range_of_nothing_is_one_colour() {
        assert_eq!(of(&[0.0], [0.0, 0.0]).collect::<Vec<_>>(), [VIRIDIS[0]]);
    }
}
