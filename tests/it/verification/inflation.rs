//! Inflation of a clamped circular membrane.

use super::axisymmetric::{Sheet, root};
use super::claims::Claims;

/// Hencky's coefficients: Poisson's ratio and W of w0 = W a (q a/(E h))^(1/3) (Z. Math. Phys. 63, 1915).
const HENCKY: [[f64; 2]; 3] = [[0.2, 0.67744], [0.3, 0.65344], [0.4, 0.62626]];

/// W from Föppl's equations N″ = −3N′/r − 1/(8N²), w′ = −r/(2N) with a, q, E h = 1 and no radial displacement at the
/// clamp, (1−ν)N + N′ = 0.
fn coefficient(poisson: f64) -> f64 {
    let integrate = |pole: f64| {
        let steps = 4000;
        let step = 1.0 / f64::from(steps);
        let slope = |r: f64, [n, dn, _]: [f64; 3]| {
            let outward = if r == 0.0 { -1.0 / (32.0 * n * n) } else { -3.0 * dn / r - 0.125 / (n * n) };
            [dn, outward, 0.5 * r / n]
        };
        let mut y = [pole, 0.0, 0.0];
        for i in 0..steps {
            let r = step * f64::from(i);
            let moved = |by: f64, k: [f64; 3]| -> [f64; 3] { std::array::from_fn(|j| y[j] + by * step * k[j]) };
            let a = slope(r, y);
            let b = slope(r + 0.5 * step, moved(0.5, a));
            let c = slope(r + 0.5 * step, moved(0.5, b));
            let d = slope(r + step, moved(1.0, c));
            y = std::array::from_fn(|j| y[j] + step / 6.0 * (a[j] + 2.0 * b[j] + 2.0 * c[j] + d[j]));
        }
        y
    };
    let pole = root(
        |pole| {
            let [n, dn, _] = integrate(pole);
            (1.0 - poisson) * n + dn
        },
        2.0,
    );
    integrate(pole)[2]
}

#[test]
fn the_references_agree_with_one_another() {
    let mut claims = Claims::of("membranes of revolution");
    for [poisson, published] in HENCKY {
        claims.near(&format!("ν {poisson}, W by Föppl's equations"), coefficient(poisson), published, 1e-4);
        let sheet = Sheet { young: 1.0, poisson, thickness: 1.0 };
        let pressure = 1e-7_f64;
        let large = sheet.inflated(1.0, 1.0, pressure).depth() / pressure.cbrt();
        claims.near(&format!("ν {poisson}, W at finite strain, small load"), large, published, 1e-4);
    }
    claims.judge();
}
