//! Colours of values, from a map that the caller gives.

/// Colour of text and guide lines.
pub(crate) const GREY: [u8; 3] = [128, 128, 132];

/// Number of distinct colours: equal neighbours compress.
const STEPS: f32 = 64.0;

/// Colours of `values` from those of `map`, at equal distances from the lower to the upper end of `range`; what is not a
/// number gets the first.
pub(crate) fn colours<'v>(
    map: &'v [[u8; 3]],
    values: &'v [f32],
    [low, high]: [f32; 2],
) -> impl Iterator<Item = [u8; 3]> + 'v {
    // One value has no span; all get the first colour instead of a NaN.
    let span = (high - low).max(f32::MIN_POSITIVE);
    values.iter().map(move |value| colour_at(map, (value - low) / span))
}

fn colour_at(map: &[[u8; 3]], share: f32) -> [u8; 3] {
    let last = map.len() - 1;
    let share = if share.is_nan() { 0.0 } else { share.clamp(0.0, 1.0) };
    let place = (share * STEPS).round() / STEPS * last as f32;
    // The upper end itself has no colour above it.
    let below = (place as usize).min(last - 1);
    let rest = place - below as f32;
    let mix = |i: usize| {
        let [from, to] = [map[below][i], map[below + 1][i]].map(f32::from);
        (from + (to - from) * rest).round() as u8
    };
    [mix(0), mix(1), mix(2)]
}

#[cfg(test)]
mod tests {
    use super::*;

    const MAP: [[u8; 3]; 3] = [[68, 1, 84], [33, 145, 140], [253, 231, 37]];

    #[test]
    fn ends_and_middle_are_the_maps_own() {
        let colours: Vec<_> = colours(&MAP, &[-1.0, 0.0, 1.0, 2.0, 3.0, f32::NAN], [0.0, 2.0]).collect();
        let [first, middle, last] = MAP;
        assert_eq!(colours, [first, first, middle, last, last, first]);
    }

    #[test]
    fn a_range_of_nothing_is_one_colour() {
        assert_eq!(colours(&MAP, &[0.0], [0.0, 0.0]).collect::<Vec<_>>(), [MAP[0]]);
    }
}
