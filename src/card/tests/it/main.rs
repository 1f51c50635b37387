//! The one binary of the tests of cards and decks, and what they share: films, and readers that know the documented fields and
//! nothing of what writes them.

mod deck;
mod interpreted;
mod read_back;

use droptower_card as card;
use membrane::material::{Curve, Fabric, Hyperelastic, HyperelasticLaw, Law, Material, Polynomial};

fn film_of(law: Law) -> Material {
    Material::new(law, 917.3456789, 12e-6)
}

fn curve(points: &[[f64; 2]]) -> Curve {
    Curve::new(points.to_vec()).unwrap()
}

/// Curves of MD, TD and shear.
fn lldpe() -> [Curve; 3] {
    [
        curve(&[[0.0277257, 8.4e6], [0.197814, 20.123456789e6], [0.747814, 29.3e6]]),
        curve(&[[0.035191, 8e6], [0.140763, 10e6], [6.460763, 16.2e6]]),
        curve(&[[0.1, 1.3e6], [0.6, 5.1e6]]),
    ]
}

fn fabric(absorption: f64) -> Material {
    let [md, td, shear] = lldpe();
    film_of(Law::Fabric(Fabric::new(md, td, shear, absorption)))
}

fn polynomial(energy: Polynomial) -> Material {
    film_of(Law::Hyperelastic(HyperelasticLaw::Polynomial(Hyperelastic { energy, wrinkling: false })))
}

fn close(found: f64, expected: f64, within: f64, what: &str) {
    assert!((found - expected).abs() <= within * expected.abs(), "{what}: {found} and {expected}");
}

/// The value of straight pieces at `x`, as solvers read their curves.
fn value_at(points: &[[f64; 2]], x: f64) -> f64 {
    let place = points.partition_point(|point| point[0] < x).clamp(1, points.len() - 1);
    let ([x0, y0], [x1, y1]) = (points[place - 1], points[place]);
    y0 + (y1 - y0) * (x - x0) / (x1 - x0)
}
