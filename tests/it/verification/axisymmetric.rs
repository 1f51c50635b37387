//! Membranes of revolution at any strain, by integrating their equations: the reference for inflation and indentation.
//!
//! A circle of stress-free film has the radius R, the deformed one r(R) and z(R). With λ₁ = √(r′² + z′²),
//! λ₂ = r/R, the slope φ and the first Piola–Kirchhoff stresses P₁, P₂ of St. Venant–Kirchhoff film, forces along r and
//! z on a ring under the pressure q that acts along the normal (−z′, r′) give
//!
//! ```text
//! (R P₁ cos φ)′ = P₂ + q r z′/h ,   (R P₁ sin φ)′ = − q r r′/h .
//! ```
//!
//! On a frictionless ball of radius ϱ the film has r = ϱ sin φ, and along the meridian ϱ φ′ = λ₁, (R P₁)′ = P₂ cos φ.
//! Nothing of droptower is used.

use super::solve::runge_kutta;

/// Isotropic film of St. Venant–Kirchhoff in plane stress.
#[derive(Clone, Copy, Debug)]
pub struct Sheet {
    /// Pa.
    pub young: f64,
    pub poisson: f64,
    /// m.
    pub thickness: f64,
    /// Whether it carries tension only: where S₂ would be negative, it is zero and S₁ = Y E₁.
    pub wrinkling: bool,
}

/// A deformed film at radii R from the pole or inner edge to the outer one.
#[derive(Clone, Debug, Default)]
pub struct Shape {
    /// Stress-free radius, m.
    pub material: Vec<f64>,
    /// Deformed radius and height, m.
    pub place: Vec<[f64; 2]>,
    /// Meridional and hoop stretch.
    pub stretch: Vec<[f64; 2]>,
    /// R P₁ sin φ, N/m per thickness, at the outer edge.
    pub shear: f64,
    /// Elastic energy, J, of the whole circle.
    pub energy: f64,
    /// Least hoop stress S₂ of film that does not wrinkle at these stretches, Pa.
    pub least_hoop: f64,
}

/// Steps of the integration.
const STEPS: usize = 400;

impl Sheet {
    /// Second Piola–Kirchhoff stress along a direction of stretch `own` beside the other, and its slope by `own`, Pa.
    fn second(&self, own: f64, other: f64) -> [f64; 2] {
        let (e, across) = (0.5 * (own * own - 1.0), 0.5 * (other * other - 1.0));
        let plane = self.young / (1.0 - self.poisson * self.poisson);
        let [least, most] = [e.min(across), e.max(across)];
        if self.wrinkling && least + self.poisson * most < 0.0 {
            return if own > other && own > 1.0 { [self.young * e, self.young * own] } else { [0.0; 2] };
        }
        [plane * (e + self.poisson * across), plane * own]
    }

    /// First Piola–Kirchhoff stress along one direction, Pa.
    pub fn first(&self, own: f64, other: f64) -> f64 {
        own * self.second(own, other)[0]
    }

    /// Energy per stress-free volume, J/m³.
    fn energy(&self, stretch: [f64; 2]) -> f64 {
        let [a, b] = stretch.map(|s| 0.5 * (s * s - 1.0));
        0.5 * (a * self.second(stretch[0], stretch[1])[0] + b * self.second(stretch[1], stretch[0])[0])
    }

    /// The stretch that belongs to the first Piola–Kirchhoff stress `stress` (Pa) beside the stretch `other`.
    fn stretch(&self, stress: f64, other: f64) -> f64 {
        // Newton from above on a convex function.
        let mut stretch = 2.0 + (2.0 * stress / self.young).abs().cbrt() + other;
        for _ in 0..60 {
            let [second, slope] = self.second(stretch, other);
            let change = (stretch * second - stress) / (second + stretch * slope);
            stretch -= change;
            if change.abs() < 1e-15 * stretch {
                break;
            }
        }
        stretch
    }

    /// The film in the air: from `start` = [r, z, R P₁ cos φ, R P₁ sin φ] at the material radius `from` to `to`.
    fn free(&self, shape: &mut Shape, start: [f64; 4], from: f64, to: f64, pressure: f64) -> [f64; 4] {
        let slope = |at: f64, [r, _, along, up]: [f64; 4]| {
            let force = along.hypot(up);
            let other = r / at;
            let stretch = self.stretch(force / at, other);
            let [dr, dz] = [stretch * along / force, stretch * up / force];
            let load = pressure * r / self.thickness;
            [dr, dz, self.first(other, stretch) + load * dz, -load * dr]
        };
        let step = (to - from) / STEPS as f64;
        let mut y = start;
        for i in 0..=STEPS {
            let at = from + step * i as f64;
            let other = y[0] / at;
            let stretch = self.stretch(y[2].hypot(y[3]) / at, other);
            shape.add(self, at, [y[0], y[1]], [stretch, other]);
            if i < STEPS {
                y = runge_kutta(&slope, at, y, step);
            }
        }
        shape.shear = y[3];
        y
    }

    /// The film on a ball of radius `ball`, from the pole with the stretch `pole` to the material radius `edge`.
    fn on_ball(&self, shape: &mut Shape, pole: f64, ball: f64, edge: f64) -> [f64; 4] {
        let slope = |at: f64, [angle, force]: [f64; 2]| {
            let other = ball * angle.sin() / at;
            let stretch = self.stretch(force / at, other);
            [stretch / ball, self.first(other, stretch) * angle.cos()]
        };
        let from = 1e-4 * edge;
        let step = (edge - from) / STEPS as f64;
        let mut y = [pole * from / ball, from * self.first(pole, pole)];
        for i in 0..=STEPS {
            let at = from + step * i as f64;
            let other = ball * y[0].sin() / at;
            let place = [ball * y[0].sin(), ball * (1.0 - y[0].cos())];
            shape.add(self, at, place, [self.stretch(y[1] / at, other), other]);
            if i < STEPS {
                y = runge_kutta(&slope, at, y, step);
            }
        }
        let [angle, force] = y;
        [ball * angle.sin(), ball * (1.0 - angle.cos()), force * angle.cos(), force * angle.sin()]
    }

    /// A circle of stress-free radius `radius` (m), clamped at the deformed radius `clamp` (m) under `pressure` (Pa).
    /// Heights count from the clamp.
    pub fn inflated(&self, radius: f64, clamp: f64, pressure: f64) -> Shape {
        let from = 1e-4 * radius;
        let at = |pole: f64| {
            let mut shape = Shape::default();
            let r = pole * from;
            let start = [r, 0.0, from * self.first(pole, pole), -0.5 * pressure * r * r / self.thickness];
            let end = self.free(&mut shape, start, from, radius, pressure);
            (end[0] - clamp, shape)
        };
        let pole = 1.0 + root(|strain| at(1.0 + strain).0, 0.5);
        at(pole).1.above_the_clamp()
    }

    /// Two circles of stress-free radius `radius` (m), clamped at that radius, the second `gap` (m) above the first,
    /// which the `pressure` (Pa) under the first presses on each other without friction: height of the pole over the
    /// clamp of each, m.
    ///
    /// Where they touch both have the slope φ(s) over the arc s, (R P₁)′ = P₂ cos φ/λ₁ for each, and together φ′ Σ R P₁
    /// = −sin φ Σ P₂/λ₁ − q r/h; beyond, each is free. Three figures are found: the stretches at the pole, and the arc
    /// at which they part.
    pub fn pressed_on_another(&self, radius: f64, gap: f64, pressure: f64, guess: [f64; 3]) -> [f64; 2] {
        let ends = |[first, second, arc]: [f64; 3]| {
            let [r, z, angle, one, f, other, g] = self.together([first, second], arc, pressure);
            let away = |from: f64, force: f64, pressure: f64| {
                let start = [r, z, force * angle.cos(), force * angle.sin()];
                self.free(&mut Shape::default(), start, from, radius, pressure)
            };
            [away(one, f, pressure), away(other, g, 0.0)]
        };
        let missing = |x: [f64; 3]| {
            let [[r, z, ..], [s, y, ..]] = ends(x);
            [r - radius, s - radius, y - z - gap]
        };
        ends(newton(missing, guess, 1e-12 * radius)).map(|[_, z, ..]| -z)
    }

    /// Two films that touch, from the pole with the stretches `pole` over `arc` (m): radius, height, slope, and
    /// material radius and R P₁ of each.
    fn together(&self, pole: [f64; 2], arc: f64, pressure: f64) -> [f64; 7] {
        let slope = |_: f64, [r, _, angle, one, f, other, g]: [f64; 7]| {
            let of = |material: f64, force: f64| {
                let across = r / material;
                let stretch = self.stretch(force / material, across);
                [1.0 / stretch, self.first(across, stretch) / stretch]
            };
            let [a, b] = [of(one, f), of(other, g)];
            let bend = (-(a[1] + b[1]) * angle.sin() - pressure * r / self.thickness) / (f + g);
            [angle.cos(), angle.sin(), bend, a[0], a[1] * angle.cos(), b[0], b[1] * angle.cos()]
        };
        let from = 1e-4 * arc;
        let [p, q] = pole.map(|stretch| self.first(stretch, stretch));
        let bend = -pressure / (2.0 * self.thickness * (p / pole[0] + q / pole[1]));
        let [one, other] = pole.map(|stretch| from / stretch);
        let step = (arc - from) / STEPS as f64;
        let mut y = [from, 0.0, bend * from, one, one * p, other, other * q];
        for i in 0..STEPS {
            y = runge_kutta(&slope, from + step * i as f64, y, step);
        }
        y
    }

    /// The same circle under a frictionless ball of radius `ball` (m) in contact up to the material radius `contact`.
    pub fn under_ball(&self, radius: f64, clamp: f64, ball: f64, contact: f64) -> Shape {
        let at = |pole: f64| {
            let mut shape = Shape::default();
            let edge = self.on_ball(&mut shape, pole, ball, contact);
            let end = self.free(&mut shape, edge, contact, radius, 0.0);
            (end[0] - clamp, shape)
        };
        let pole = 1.0 + root(|strain| at(1.0 + strain).0, 0.5);
        at(pole).1.above_the_clamp()
    }

    /// The same with the ball's tip `depth` (m) below the clamp.
    pub fn indented(&self, radius: f64, clamp: f64, ball: f64, depth: f64) -> Shape {
        // A quarter of the ball's circumference, of film that is not shorter than it was.
        let most = radius.min(1.5 * ball);
        let contact =
            between(|contact| self.under_ball(radius, clamp, ball, contact).depth() - depth, 1e-3 * most, most);
        let shape = self.under_ball(radius, clamp, ball, contact);
        assert!((shape.depth() - depth).abs() < 1e-6 * depth, "the film is slack at {depth} m");
        shape
    }

    /// A ring from the material radius `inner` to `outer` (m) whose edges are displaced to `[r, z]` each.
    pub fn ring(&self, [inner, outer]: [f64; 2], edges: [[f64; 2]; 2]) -> Shape {
        let at = |along: f64, up: f64| {
            let mut shape = Shape::default();
            let start = [edges[0][0], edges[0][1], along, up];
            let end = self.free(&mut shape, start, inner, outer, 0.0);
            ([end[0] - edges[1][0], end[1] - edges[1][1]], shape)
        };
        let run = edges[1][0] - edges[0][0];
        let rise = edges[1][1] - edges[0][1];
        let line = run.hypot(rise);
        let force = inner * self.first(line / (outer - inner), edges[0][0] / inner);
        let (mut along, mut up) = (force * run / line, force * rise / line);
        for _ in 0..30 {
            let d = 1e-6 * force;
            let [a, b, c] = [at(along, up).0, at(along + d, up).0, at(along, up + d).0];
            let [[j11, j12], [j21, j22]] = [0, 1].map(|i| [(b[i] - a[i]) / d, (c[i] - a[i]) / d]);
            let determinant = j11 * j22 - j12 * j21;
            along -= (j22 * a[0] - j12 * a[1]) / determinant;
            up -= (j11 * a[1] - j21 * a[0]) / determinant;
        }
        let (off, shape) = at(along, up);
        assert!(off[0].hypot(off[1]) < 1e-9 * outer, "the ring does not close: {off:?}");
        shape
    }
}

impl Shape {
    fn add(&mut self, sheet: &Sheet, at: f64, place: [f64; 2], stretch: [f64; 2]) {
        let hoop = Sheet { wrinkling: false, ..*sheet }.second(stretch[1], stretch[0])[0];
        self.least_hoop = if self.material.is_empty() { hoop } else { self.least_hoop.min(hoop) };
        if let (Some(before), Some(last)) = (self.material.last(), self.stretch.last()) {
            let density = |stretch: [f64; 2], at: f64| sheet.energy(stretch) * at;
            let mean = 0.5 * (density(*last, *before) + density(stretch, at));
            self.energy += 2.0 * std::f64::consts::PI * sheet.thickness * mean * (at - before);
        }
        self.material.push(at);
        self.place.push(place);
        self.stretch.push(stretch);
    }

    fn above_the_clamp(mut self) -> Shape {
        let clamp = self.place[self.place.len() - 1][1];
        self.place.iter_mut().for_each(|p| p[1] -= clamp);
        self
    }

    /// Distance of the pole from the plane of the clamp, m.
    pub fn depth(&self) -> f64 {
        self.place[0][1].abs()
    }

    /// Deformed radius and height of the material radius `at` (m), from a straight line between the integrated ones.
    pub fn at(&self, at: f64) -> [f64; 2] {
        let next = self.material.partition_point(|m| *m < at).clamp(1, self.material.len() - 1);
        let [a, b] = [self.material[next - 1], self.material[next]];
        let share = (at - a) / (b - a);
        [0, 1].map(|i| self.place[next - 1][i] * (1.0 - share) + self.place[next][i] * share)
    }
}

/// Where `f` is below `small` in all components, by Newton's method with differences, from `x`.
fn newton(f: impl Fn([f64; 3]) -> [f64; 3], mut x: [f64; 3], small: f64) -> [f64; 3] {
    for _ in 0..40 {
        let now = nalgebra::Vector3::from(f(x));
        if now.amax() < small {
            return x;
        }
        let column = |k: usize| {
            let mut moved = x;
            moved[k] *= 1.0 + 1e-6;
            (nalgebra::Vector3::from(f(moved)) - now) / (1e-6 * x[k])
        };
        let slope = nalgebra::Matrix3::from_columns(&[column(0), column(1), column(2)]);
        let change = slope.lu().solve(&-now).expect("a slope");
        (0..3).for_each(|k| x[k] += change[k]);
    }
    panic!("no root near {x:?}")
}

/// Where `f`, positive at `high`, becomes negative on the way to zero: bracketed by a geometric scan.
pub fn root(f: impl Fn(f64) -> f64, high: f64) -> f64 {
    let mut high = high;
    let mut low = 0.9 * high;
    while f(low) > 0.0 {
        (high, low) = (low, 0.9 * low);
        assert!(low > 1e-12, "no root");
    }
    between(f, low, high)
}

/// Where `f` becomes positive between `low` and `high`, by false position (Illinois), or by halves where that leaves
/// the interval or `f` is no number.
fn between(f: impl Fn(f64) -> f64, low: f64, high: f64) -> f64 {
    let [mut low, mut high] = [low, high].map(|x| (x, f(x)));
    let (mut last, mut rose) = (f64::NAN, None);
    loop {
        let secant = (low.0 * high.1 - high.0 * low.1) / (high.1 - low.1);
        let inside = secant > low.0 && secant < high.0;
        let x = if inside { secant } else { 0.5 * (low.0 + high.0) };
        if (x - last).abs() < 1e-13 * x || high.0 - low.0 < 1e-13 * high.0 {
            return x;
        }
        last = x;
        let y = f(x);
        let positive = y > 0.0;
        let again = rose == Some(positive);
        rose = Some(positive);
        if positive {
            high = (x, y);
            low.1 *= if again { 0.5 } else { 1.0 };
        } else {
            low = (x, y);
            high.1 *= if again { 0.5 } else { 1.0 };
        }
    }
}
