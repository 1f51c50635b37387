//! A sheet stretched along x, free to contract along y.

use super::claims::Claims;
use super::scene::{mounted, relaxed, set_positions};
use super::sheet::{DENSITY, ELEMENTS, elastic, face, nodes_where, sheet};
use super::tower::shipped;

const YOUNG: f64 = 50e6;
const SIDE: f64 = 0.03;
const CELLS: [usize; 2] = [3, 3];

/// A′/A of a sheet stretched by `stretch` on distorted elements, and how far its nodes are off a uniform deformation
/// over its side.
fn contracted(material: droptower::material::Material, element: droptower::mesh::Element, stretch: f64) -> [f64; 2] {
    let mesh = sheet(CELLS, element, 0.25, |[u, v]| [SIDE * u, SIDE * v]);
    let (film, mut nodes) = mounted(&mesh, &face(material, element, [0.0; 2]));
    set_positions(&mut nodes, |_, [x, y, _]| [stretch * x, y, 0.0]);
    nodes.hold(nodes_where(CELLS, |column, _| column == 0 || column == CELLS[0]), [true, false, true]);
    nodes.hold(nodes_where(CELLS, |_, row| row == 0), [false, true, true]);
    let frequency = (YOUNG / DENSITY).sqrt() / SIDE;
    let (rest, _) = relaxed(film, nodes, 2.0 * frequency, 60.0 / frequency);
    let corner = rest[rest.len() - 1];
    let across = corner[1] / SIDE;
    let off = rest.iter().zip(&mesh.nodes).map(|(x, at)| (x[0] - stretch * at.x).hypot(x[1] - across * at.y) / SIDE);
    [corner[0] * corner[1] / (SIDE * SIDE), off.fold(0.0, f64::max)]
}

/// No stress across, S₂₂ = 0, means E₂₂ = −ν E₁₁: λ₂² = 1 − ν(λ² − 1).
fn of_saint_venant(stretch: f64, poisson: f64) -> f64 {
    stretch * (1.0 - poisson * (stretch * stretch - 1.0)).sqrt()
}

#[test]
fn a_sheet_contracts_as_its_law() {
    let mut claims = Claims::of("Poisson sheet");
    for element in ELEMENTS {
        for (poisson, stretch) in [(0.3, 1.05), (0.3, 1.4), (0.44, 1.2)] {
            let what = |claim: &str| format!("{element:?}, ν {poisson}, λ {stretch}, {claim}");
            let [area, off] = contracted(elastic(YOUNG, poisson), element, stretch);
            claims.near(&what("A/A0 = λ√(1 − ν(λ² − 1))"), area, of_saint_venant(stretch, poisson), 1e-9);
            claims.at_most(&what("nodes off a uniform stretch over the side"), off, 1e-9);
        }
        let fabric = shipped("stretch/md-0.02.toml", &[]).faces[0].material.clone();
        let [area, _] = contracted(fabric, element, 1.4);
        claims.near(&format!("{element:?}, fabric, λ 1.4, A/A0 = λ"), area, 1.4, 1e-9);
    }
}

/// A/A0 = 2λ²/((1−ν) + (1+ν)λ²) is the area of another law, the plane neo-Hookean sheet W = ½μ(λ₁ − λ₂)² + ½K(J − 1)²,
/// K/μ = (1+ν)/(1−ν): ∂W/∂λ₂ = 0 is linear in λ₂. droptower does not have that law; its own agrees with it to first
/// order in the strain, A/A0 = 1 + (1−ν)(λ−1).
#[test]
fn the_area_of_a_neo_hookean_sheet_agrees_to_first_order() {
    let mut claims = Claims::of("Poisson sheet, neo-Hookean");
    let formula = |stretch: f64, poisson: f64| {
        let square = stretch * stretch;
        2.0 * square / ((1.0 - poisson) + (1.0 + poisson) * square)
    };
    for poisson in [0.0, 0.3, 0.44] {
        for stretch in [1.05, 1.4] {
            let bulk = (1.0 + poisson) / (1.0 - poisson);
            let slope = |across: f64| across - stretch + bulk * (stretch * across - 1.0) * stretch;
            let across = slope(0.0) / (slope(0.0) - slope(1.0));
            let what = format!("ν {poisson}, λ {stretch}, its A/A0 from ∂W/∂λ2 = 0");
            claims.near(&what, stretch * across, formula(stretch, poisson), 1e-12);
        }
        let apart = |strain: f64| formula(1.0 + strain, poisson) - of_saint_venant(1.0 + strain, poisson);
        let what = format!("ν {poisson}, difference of both laws at strains of 4, 2, 1 per mille");
        claims.converges(&what, &[4e-3, 2e-3, 1e-3].map(apart), 1.9);
    }
}
