//! From pixels to the values of two axes.

use nalgebra::{Matrix2, Vector2};

use crate::scenario::AxisScale;

/// An axis by two of its points.
#[derive(Clone, Debug)]
pub struct Axis {
    /// Column of the table.
    pub column: String,
    /// Pixels of the points, across and down.
    pub pixels: [[f64; 2]; 2],
    /// Values at the points, SI.
    pub values: [f64; 2],
    /// Scale.
    pub scale: AxisScale,
}

/// The axes of a figure: an affine map from pixels to values, or to their logarithms.
#[derive(Clone, Debug)]
pub struct Axes {
    /// Across and up.
    pub axes: [Axis; 2],
    /// A pixel's places along both axes, 0 at their first points and 1 at their second ones.
    places: Matrix2<f64>,
}

impl Axes {
    /// `None` where the points of an axis coincide in the picture or in value, where a logarithmic axis has a value that is
    /// not above zero, or where the axes are parallel.
    pub fn new(axes: [Axis; 2]) -> Option<Axes> {
        let directions = axes.each_ref().map(|axis| {
            let [from, to] = axis.pixels.map(Vector2::from);
            to - from
        });
        let lengths = directions.map(|direction| direction.norm());
        let matrix = Matrix2::from_columns(&directions);
        let is_spread = lengths.iter().all(|length| *length >= 1.0);
        let is_flat = matrix.determinant().abs() < 0.1 * lengths[0] * lengths[1];
        let is_scaled = axes.iter().all(|axis| {
            let [from, to] = axis.values;
            from != to && (axis.scale == AxisScale::Linear || (from > 0.0 && to > 0.0))
        });
        let places = matrix.try_inverse().filter(|_| is_spread && !is_flat && is_scaled)?;
        Some(Axes { axes, places })
    }

    /// Places along both axes, 0 at their first points and 1 at their second ones.
    pub fn places(&self, pixel: [f64; 2]) -> [f64; 2] {
        let place = |index: usize| {
            let from = Vector2::from(self.axes[index].pixels[0]);
            (self.places * (Vector2::from(pixel) - from))[index]
        };
        [place(0), place(1)]
    }

    /// Values at a pixel, SI.
    pub fn values(&self, pixel: [f64; 2]) -> [f64; 2] {
        let places = self.places(pixel);
        [0, 1].map(|index| self.axes[index].value(places[index]))
    }

    /// Change of the values with a pixel across and down: rows are axes.
    pub fn slopes(&self, pixel: [f64; 2]) -> [[f64; 2]; 2] {
        let places = self.places(pixel);
        [0, 1].map(|index| {
            let slope = self.axes[index].slope(places[index]);
            [slope * self.places[(index, 0)], slope * self.places[(index, 1)]]
        })
    }

    /// The smallest upright rectangle around the points of both axes: left, top, right, bottom.
    pub fn area(&self) -> [f64; 4] {
        let pixels = || self.axes.iter().flat_map(|axis| axis.pixels);
        let least = |index: usize| pixels().map(|pixel| pixel[index]).fold(f64::INFINITY, f64::min);
        let most = |index: usize| pixels().map(|pixel| pixel[index]).fold(f64::NEG_INFINITY, f64::max);
        [least(0), least(1), most(0), most(1)]
    }
}

impl Axis {
    fn value(&self, place: f64) -> f64 {
        let [from, to] = self.values;
        match self.scale {
            AxisScale::Linear => from + place * (to - from),
            AxisScale::Log => from * (to / from).powf(place),
        }
    }

    /// Change of the value with the place.
    fn slope(&self, place: f64) -> f64 {
        let [from, to] = self.values;
        match self.scale {
            AxisScale::Linear => to - from,
            AxisScale::Log => self.value(place) * (to / from).ln(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn axes(x: [[f64; 2]; 2], y: [[f64; 2]; 2], values: [f64; 2], scale: AxisScale) -> Option<Axes> {
        let axis = |pixels, values, scale| Axis { column: "x".into(), pixels, values, scale };
        Axes::new([axis(x, [0.0, 10.0], AxisScale::Linear), axis(y, values, scale)])
    }

    #[test]
    fn pixels_of_turned_and_sheared_axes_have_values() {
        // The picture is turned by 90 degrees and its axes meet at 45 degrees.
        let found = axes([[100.0, 200.0], [100.0, 0.0]], [[100.0, 200.0], [0.0, 100.0]], [0.0, 4.0], AxisScale::Linear);
        let found = found.unwrap();
        let [x, y] = found.values([50.0, 50.0]);
        assert!((x - 5.0).abs() < 1e-12 && (y - 2.0).abs() < 1e-12, "{x} {y}");
        let step = 1e-3;
        let [[across, down], _] = found.slopes([50.0, 50.0]);
        assert!((found.values([50.0 + step, 50.0])[0] - x - across * step).abs() < 1e-12);
        assert!((found.values([50.0, 50.0 + step])[0] - x - down * step).abs() < 1e-12);
        assert_eq!(found.area(), [0.0, 0.0, 100.0, 200.0]);
    }

    #[test]
    fn logarithmic_axes_have_equal_ratios() {
        let found = axes([[0.0, 0.0], [9.0, 0.0]], [[0.0, 100.0], [0.0, 0.0]], [1.0, 1e4], AxisScale::Log).unwrap();
        let [_, value] = found.values([3.0, 75.0]);
        assert!((value - 10.0).abs() < 1e-12, "{value}");
        let step = 1e-6;
        let [_, [_, down]] = found.slopes([3.0, 75.0]);
        assert!(((found.values([3.0, 75.0 + step])[1] - value) / step - down).abs() < 1e-5);
    }

    #[test]
    fn axes_that_lead_nowhere_are_refused() {
        let up = [[0.0, 100.0], [0.0, 0.0]];
        let across = [[0.0, 100.0], [100.0, 100.0]];
        assert!(axes(across, up, [0.0, 1.0], AxisScale::Linear).is_some());
        assert!(axes(up, up, [0.0, 1.0], AxisScale::Linear).is_none(), "parallel");
        assert!(axes([[1.0, 1.0]; 2], up, [0.0, 1.0], AxisScale::Linear).is_none(), "one point");
        assert!(axes(across, up, [1.0, 1.0], AxisScale::Linear).is_none(), "one value");
        assert!(axes(across, up, [0.0, 1.0], AxisScale::Log).is_none(), "no logarithm of 0");
    }
}
