//! Viridis (van der Walt and Smith, 2015): equal steps of the value look like equal steps.

/// The map at equal distances from the lowest to the highest value, sRGB.
pub const VIRIDIS: [[u8; 3]; 9] = [
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

/// The colour of a share of the range, from 0 to 255; the ends outside of it, the first of what is not a number.
pub fn viridis(share: f32) -> [f32; 3] {
    let last = VIRIDIS.len() - 1;
    let place = if share.is_nan() { 0.0 } else { share.clamp(0.0, 1.0) } * last as f32;
    let below = (place as usize).min(last - 1);
    let rest = place - below as f32;
    [0, 1, 2].map(|part| {
        let [from, to] = [VIRIDIS[below][part], VIRIDIS[below + 1][part]].map(f32::from);
        from + (to - from) * rest
    })
}

/// The colours of the map with their shares of the range, `#rrggbb`.
pub fn stops() -> impl Iterator<Item = (f64, String)> {
    let last = (VIRIDIS.len() - 1) as f64;
    let stop = move |(at, [r, g, b]): (usize, [u8; 3])| (at as f64 / last, format!("#{r:02x}{g:02x}{b:02x}"));
    VIRIDIS.into_iter().enumerate().map(stop)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ends_and_middle_are_the_maps_own() {
        let found = [-1.0, 0.0, 0.5, 1.0, 2.0, f32::NAN].map(viridis);
        let [first, middle, last] = [0, 4, 8].map(|at| VIRIDIS[at].map(f32::from));
        assert_eq!(found, [first, first, middle, last, last, first]);
        assert_eq!(stops().last(), Some((1.0, "#fde725".into())));
    }
}
