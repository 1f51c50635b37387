//! What the tests of all packages share: a switch for thorough runs, cases that are tests of their own, numbers, and a sphere of
//! triangles.

/// Whether `DROPTOWER_THOROUGH=1` asks for what repeats a proof: on more meshes, angles and scenes, with more seeds and kills.
pub fn thorough() -> bool {
    std::env::var_os("DROPTOWER_THOROUGH").is_some_and(|value| value == "1")
}

/// `usual`, or what a thorough run takes in its place.
pub fn choose<T>(usual: T, of_thorough: T) -> T {
    if thorough() { of_thorough } else { usual }
}

/// The first `few` of the cases of a test, or all of them.
pub fn first<T, const N: usize>(few: usize, cases: [T; N]) -> impl Iterator<Item = T> {
    cases.into_iter().take(if thorough() { N } else { few })
}

/// Numbers in 0..1 in general position, the same in every run.
pub fn random(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed;
    move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// Triangles of the unit sphere, counter-clockwise from outside: an icosahedron, every triangle cut in four `times` over.
pub fn sphere_of_triangles(times: usize) -> Vec<[[f64; 3]; 3]> {
    let on_sphere = |p: [f64; 3]| p.map(|x| x / p.iter().map(|x| x * x).sum::<f64>().sqrt());
    let golden = 0.5 * (1.0 + 5.0_f64.sqrt());
    let signs = [(-1.0, -golden), (1.0, -golden), (-1.0, golden), (1.0, golden)];
    let corners = signs.into_iter().flat_map(|(a, b)| [[a, b, 0.0], [0.0, a, b], [b, 0.0, a]]);
    let corners: Vec<[f64; 3]> = corners.map(on_sphere).collect();
    let near = |p: &[f64; 3], q: &[f64; 3]| (0..3).map(|k| (p[k] - q[k]).powi(2)).sum::<f64>() < 1.2;
    let mut triangles = vec![];
    for (k, p) in corners.iter().enumerate() {
        for (l, q) in corners.iter().enumerate().skip(k + 1) {
            for r in corners[l + 1..].iter().filter(|r| near(p, q) && near(q, r) && near(r, p)) {
                let volume: f64 = (0..3)
                    .map(|i| (i, (i + 1) % 3, (i + 2) % 3))
                    .map(|(i, j, k)| p[i] * (q[j] * r[k] - q[k] * r[j]))
                    .sum();
                triangles.push(if volume > 0.0 { [*p, *q, *r] } else { [*p, *r, *q] });
            }
        }
    }
    for _ in 0..times {
        let middle = |p: [f64; 3], q: [f64; 3]| on_sphere([0, 1, 2].map(|k| p[k] + q[k]));
        let quarters = |[p, q, r]: [[f64; 3]; 3]| {
            let (pq, qr, rp) = (middle(p, q), middle(q, r), middle(r, p));
            [[p, pq, rp], [pq, q, qr], [rp, qr, r], [pq, qr, rp]]
        };
        triangles = triangles.into_iter().flat_map(quarters).collect();
    }
    triangles
}

/// Makes a test of each case of a function `check`: `name: arguments;`. Those behind `thorough` run where [`thorough`] does.
///
/// ```ignore
/// thorough::cases!(tears_at_its_energy { squares: 0.005, 0.0; } thorough { turned: 0.005, 22.5; });
/// ```
#[macro_export]
macro_rules! cases {
    (
        $check:ident { $($name:ident: $($argument:expr),+ $(,)?;)* }
        $(thorough { $($more:ident: $($further:expr),+ $(,)?;)+ })?
    ) => {
        mod $check {
            #[allow(unused_imports)]
            use super::*;
            $(
                #[test]
                fn $name() {
                    super::$check($($argument),+);
                }
            )*
            $($(
                #[test]
                fn $more() {
                    if $crate::thorough() {
                        super::$check($($further),+);
                    }
                }
            )+)?
        }
    };
}
