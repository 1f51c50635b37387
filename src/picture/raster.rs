//! Triangles in space as pixels, by a depth buffer.

use rayon::prelude::*;

/// Samples of a pixel along each side, which smooth slanted edges, of small and of large pictures.
const SAMPLES: [usize; 2] = [4, 2];

/// Pixels from which on a picture is large.
const LARGE: usize = 3_000_000;

/// Rows of pixels that one task draws.
const ROWS: usize = 32;

/// Share of a translucent triangle's own colour.
const GLASS: f32 = 0.45;

/// Brightness of the drawn edges of a triangle over that of its inside.
const EDGE: f32 = 0.7;

/// A triangle as it is drawn.
#[derive(Clone, Debug)]
pub(super) struct Triangle {
    /// Right and down in pixels, and towards the eye.
    pub(super) corners: [[f32; 3]; 3],
    /// Of the corners: red, green, blue, from 0 to 255.
    pub(super) colours: [[f32; 3]; 3],
    /// Width in pixels of the drawn edges, from the first corner to the second and so on.
    pub(super) edges: [f32; 3],
    /// Whether what is behind it is seen through it.
    pub(super) is_glass: bool,
}

/// A picture of pixels: red, green, blue and opacity, by rows.
#[derive(Clone, Debug)]
pub(super) struct Pixels {
    pub(super) width: usize,
    pub(super) height: usize,
    pub(super) rows: Vec<[u8; 4]>,
}

impl Pixels {
    /// The triangles on a transparent ground. Translucent ones are seen where they are nearer than others by more than
    /// `least`.
    pub(super) fn draw(triangles: &[Triangle], [width, height]: [usize; 2], least: f32) -> Pixels {
        let mut rows = vec![[0; 4]; width * height];
        let samples = SAMPLES[usize::from(width * height > LARGE)];
        // Each band draws all triangles in their order, so the picture is the same with any number of threads.
        rows.par_chunks_mut(ROWS * width.max(1)).enumerate().for_each(|(number, rows)| {
            let mut band = Band::new([width, rows.len() / width], number * ROWS, samples);
            triangles.iter().for_each(|triangle| band.triangle(triangle));
            band.resolve(least, rows);
        });
        Pixels { width, height, rows }
    }
}

/// The nearest colours of samples.
struct Layer {
    depths: Vec<f32>,
    colours: Vec<[u8; 3]>,
}

impl Layer {
    fn new(samples: usize) -> Layer {
        Layer { depths: vec![f32::NEG_INFINITY; samples], colours: vec![[0; 3]; samples] }
    }

    /// Without `map`, whose code would not be inlined (docs/performance.md).
    #[inline]
    fn colour(&self, at: usize) -> [f32; 3] {
        let [r, g, b] = self.colours[at];
        [f32::from(r), f32::from(g), f32::from(b)]
    }
}

/// Some rows of a picture, by samples.
struct Band {
    width: usize,
    height: usize,
    /// Number of the first row of samples.
    top: usize,
    /// Of a pixel along each side.
    samples: usize,
    solid: Layer,
    glass: Layer,
}

/// A quantity that is linear over the picture: its value at the origin and its slopes.
#[derive(Clone, Copy)]
struct Plane([f32; 3]);

impl Plane {
    /// The plane with these values at three corners, whose doubled area is `area`.
    fn through([a, b, c]: [[f32; 2]; 3], values: [f32; 3], area: f32) -> Plane {
        let [u, v] = [values[1] - values[0], values[2] - values[0]];
        let across = (u * (c[1] - a[1]) - v * (b[1] - a[1])) / area;
        let down = (v * (b[0] - a[0]) - u * (c[0] - a[0])) / area;
        Plane([values[0] - across * a[0] - down * a[1], across, down])
    }

    #[inline]
    fn value_at(&self, x: f32, y: f32) -> f32 {
        self.0[0] + self.0[1] * x + self.0[2] * y
    }
}

impl Band {
    /// A band of so many columns and rows of pixels, from the row `first` on.
    fn new(pixels: [usize; 2], first: usize, samples: usize) -> Band {
        let [width, height] = pixels.map(|side| side * samples);
        let [solid, glass] = [(); 2].map(|()| Layer::new(width * height));
        Band { width, height, top: first * samples, samples, solid, glass }
    }

    fn triangle(&mut self, triangle: &Triangle) {
        let scale = self.samples as f32;
        let places = triangle.corners.map(|[x, y, _]| [scale * x, scale * y - self.top as f32]);
        let [a, b, c] = places;
        let area = (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]);
        let [above, below] = [a[1].min(b[1]).min(c[1]), a[1].max(b[1]).max(c[1])];
        // An area that is not a number is none either.
        if area.is_nan() || area.abs() <= 1e-6 || below < 0.0 || above > self.height as f32 {
            return;
        }
        let depth = Plane::through(places, triangle.corners.map(|corner| corner[2]), area);
        let colour = [0, 1, 2].map(|part| Plane::through(places, triangle.colours.map(|colour| colour[part]), area));
        let edges = [0, 1, 2].map(|at| self::edge(places, at, scale * triangle.edges[at], area));
        let layer = if triangle.is_glass { &mut self.glass } else { &mut self.solid };
        let first = (above - 0.5).ceil().max(0.0) as usize;
        let last = ((below - 0.5).floor().max(-1.0) + 1.0).min(self.height as f32) as usize;
        for row in first..last {
            let y = row as f32 + 0.5;
            let [left, right] = span(places, y);
            // Half open, so that a sample on a side that two triangles share belongs to one of them.
            let columns =
                (left - 0.5).ceil().max(0.0) as usize..(right - 0.5).ceil().clamp(0.0, self.width as f32) as usize;
            for column in columns {
                let x = column as f32 + 0.5;
                let (at, near) = (row * self.width + column, depth.value_at(x, y));
                if near <= layer.depths[at] {
                    continue;
                }
                let is_inside = edges.iter().all(|edge| edge.value_at(x, y) > 0.0);
                let light = if is_inside { 1.0 } else { EDGE };
                layer.depths[at] = near;
                for part in 0..3 {
                    layer.colours[at][part] = (light * colour[part].value_at(x, y)).round() as u8;
                }
            }
        }
    }

    /// The pixels of its rows: the mean of their samples.
    fn resolve(&self, least: f32, rows: &mut [[u8; 4]]) {
        let (samples, width) = (self.samples, self.width / self.samples);
        for (at, pixel) in rows.iter_mut().enumerate() {
            let (row, column) = (at / width * samples, at % width * samples);
            let mut sum = [0.0_f32; 4];
            for sample in 0..samples * samples {
                let place = (row + sample / samples) * self.width + column + sample % samples;
                // Weighted by opacity: the empty samples at an outline would else darken it.
                let [colour @ .., opacity] = self.sample(place, least);
                (0..3).for_each(|part| sum[part] += opacity * colour[part]);
                sum[3] += opacity;
            }
            let opacity = sum[3] / (samples * samples) as f32;
            if opacity > 0.0 {
                let [r, g, b] = [0, 1, 2].map(|part| (sum[part] / sum[3]).round() as u8);
                *pixel = [r, g, b, (255.0 * opacity).round() as u8];
            }
        }
    }

    /// Colour and opacity of a sample, the glass over the others.
    #[inline]
    fn sample(&self, at: usize, least: f32) -> [f32; 4] {
        let (under, over) = (self.solid.depths[at], self.glass.depths[at]);
        // Most of a picture is ground.
        if !under.is_finite() && !over.is_finite() {
            return [0.0; 4];
        }
        let (solid, glass) = (self.solid.colour(at), self.glass.colour(at));
        let with = |[r, g, b]: [f32; 3], opacity| [r, g, b, opacity];
        match (under.is_finite(), over.is_finite()) {
            (false, _) => with(glass, GLASS),
            (true, true) if over > under + least => {
                let mixed = |part: usize| GLASS * glass[part] + (1.0 - GLASS) * solid[part];
                with([mixed(0), mixed(1), mixed(2)], 1.0)
            }
            (true, _) => with(solid, 1.0),
        }
    }
}

/// Distance of a place from the edge after the corner `at`, less the width of the edge; positive where there is none.
fn edge(places: [[f32; 2]; 3], at: usize, width: f32, area: f32) -> Plane {
    if width <= 0.0 {
        return Plane([1.0, 0.0, 0.0]);
    }
    let [a, b] = [places[at], places[(at + 1) % 3]];
    let length = (b[0] - a[0]).hypot(b[1] - a[1]) * area.signum();
    let [across, down] = [(a[1] - b[1]) / length, (b[0] - a[0]) / length];
    Plane([-across * a[0] - down * a[1] - width, across, down])
}

/// Where a row enters and leaves a triangle.
fn span(places: [[f32; 2]; 3], y: f32) -> [f32; 2] {
    (0..3).fold([f32::INFINITY, f32::NEG_INFINITY], |[left, right], at| {
        let [a, b] = [places[at], places[(at + 1) % 3]];
        // A corner on the row belongs to one of its edges only, and a level edge has no crossing.
        if (a[1] <= y) == (b[1] <= y) {
            return [left, right];
        }
        let x = a[0] + (y - a[1]) * (b[0] - a[0]) / (b[1] - a[1]);
        [left.min(x), right.max(x)]
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn triangle(corners: [[f32; 3]; 3], colour: [f32; 3], is_glass: bool) -> Triangle {
        Triangle { corners, colours: [colour; 3], edges: [0.0; 3], is_glass }
    }

    /// The lower left half of a square of 64 pixels at this depth.
    fn half(depth: f32, colour: [f32; 3], is_glass: bool) -> Triangle {
        triangle([[0.0, 0.0, depth], [0.0, 64.0, depth], [64.0, 64.0, depth]], colour, is_glass)
    }

    #[test]
    fn the_nearest_is_seen_whatever_the_order() {
        let [red, blue] = [half(1.0, [250.0, 0.0, 0.0], false), half(2.0, [0.0, 0.0, 250.0], false)];
        for order in [vec![red.clone(), blue.clone()], vec![blue, red]] {
            let drawn = Pixels::draw(&order, [64, 64], 0.0);
            assert_eq!(drawn.rows[50 * 64 + 10], [0, 0, 250, 255]);
            assert_eq!(drawn.rows[10 * 64 + 50], [0; 4]);
            let diagonal = drawn.rows[33 * 64 + 33][3];
            assert!((90..=160).contains(&diagonal), "half of the pixel: {diagonal}");
        }
    }

    #[test]
    fn colours_run_from_corner_to_corner() {
        let mut ramp = half(0.0, [0.0; 3], false);
        ramp.colours[2] = [200.0, 100.0, 0.0];
        let drawn = Pixels::draw(&[ramp], [64, 64], 0.0);
        let [red, green, ..] = drawn.rows[60 * 64 + 31];
        assert!(red.abs_diff(98) <= 2 && green.abs_diff(49) <= 2, "{red} {green}");
    }

    #[test]
    fn glass_is_mixed_with_what_is_behind_it_only() {
        let film = half(1.0, [200.0, 0.0, 0.0], false);
        for (depth, expected) in [(2.0, [110, 45, 45, 255]), (0.5, [200, 0, 0, 255]), (1.05, [200, 0, 0, 255])] {
            let drawn = Pixels::draw(&[film.clone(), half(depth, [0.0, 100.0, 100.0], true)], [64, 64], 0.1);
            assert_eq!(drawn.rows[50 * 64 + 10], expected, "{depth}");
        }
    }

    #[test]
    fn edges_are_darker_and_what_is_not_a_number_is_left_out() {
        let mut framed = half(1.0, [100.0, 200.0, 50.0], false);
        framed.edges = [2.0, 0.0, 0.0];
        let drawn = Pixels::draw(&[framed], [64, 64], 0.0);
        assert_eq!(drawn.rows[50 * 64], [70, 140, 35, 255]);
        assert_eq!(drawn.rows[50 * 64 + 4], [100, 200, 50, 255]);
        let lost = triangle([[f32::NAN; 3], [0.0, 64.0, 0.0], [64.0, 64.0, 0.0]], [255.0; 3], false);
        assert!(Pixels::draw(&[lost], [64, 64], 0.0).rows.iter().all(|pixel| pixel[3] == 0));
    }
}
