//! Roots, paths and straight lines of the closed forms. Nothing of droptower is used.

/// Where `f`, negative at `low` and positive at `high`, is zero, by halves.
pub fn zero(mut low: f64, mut high: f64, f: impl Fn(f64) -> f64) -> f64 {
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if f(middle) < 0.0 { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

/// One step of the classical method of fourth order. Loops are inlined, `map` and `from_fn` are not (docs/performance.md).
pub fn runge_kutta<const N: usize>(
    slope: &impl Fn(f64, [f64; N]) -> [f64; N],
    at: f64,
    y: [f64; N],
    step: f64,
) -> [f64; N] {
    let moved = |by: f64, k: &[f64; N]| {
        let mut moved = y;
        for i in 0..N {
            moved[i] += by * step * k[i];
        }
        moved
    };
    let a = slope(at, y);
    let b = slope(at + 0.5 * step, moved(0.5, &a));
    let c = slope(at + 0.5 * step, moved(0.5, &b));
    let d = slope(at + step, moved(1.0, &c));
    let mut next = y;
    for i in 0..N {
        next[i] += step / 6.0 * (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]);
    }
    next
}

/// Straight lines from the origin through `points`, of which the last goes on.
pub fn line(points: &[[f64; 2]], at: f64) -> f64 {
    let next = points.iter().position(|point| at <= point[0]).unwrap_or(points.len() - 1);
    let (a, b) = (if next == 0 { [0.0; 2] } else { points[next - 1] }, points[next]);
    a[1] + (b[1] - a[1]) * (at - a[0]) / (b[0] - a[0])
}
