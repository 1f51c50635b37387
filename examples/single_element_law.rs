//! A law of one's own on a single element: `cargo run --release --example single_element_law`.
//!
//! Incompressible neo-Hookean film in plane stress (Treloar 1943) with the shear modulus μ and C_IJ = f_I·f_J has the
//! energy W = ½ μ (C₁₁ + C₂₂ + 1/det C − 3). Stretched by λ along MD with its width held, its nominal stress is
//! p₁ = μ (λ − λ⁻³).

use droptower::engine::{Patch, StressFree, Vectors};
use droptower::lane::{Lane, Width, lanes, splat};
use droptower::material::{Deformation, Energy, MembraneLaw, PeakStrains, Stiffness, Stress};
use droptower::mesh::Mesh;
use nalgebra::Point3;

/// The film; μ in Pa.
struct NeoHookean(f64);

/// C₁₁, C₂₂, C₁₂ and 1/det C.
fn right_cauchy_green<const L: usize>(d: &Deformation<L>) -> [Lane<L>; 4] {
    let [c11, c22, c12] = d.metric();
    [c11, c22, c12, 1.0 / (c11 * c22 - c12 * c12)]
}

impl MembraneLaw for NeoHookean {
    type History<const L: usize> = PeakStrains<L>;

    fn stress<const L: usize>(&self, d: &Deformation<L>, _: &mut PeakStrains<L>, _dt: f64) -> Stress<L> {
        let [c11, c22, c12, inverse] = right_cauchy_green(d);
        let square = inverse * inverse;
        let tension = [self.0 * (1.0 - c22 * square), self.0 * (1.0 - c11 * square)];
        Stress::of_metric(d, tension, self.0 * c12 * square)
    }

    fn energy<const L: usize>(&self, d: &Deformation<L>, _: &PeakStrains<L>) -> Energy<L> {
        let [c11, c22, _, inverse] = right_cauchy_green(d);
        Energy { stored: 0.5 * self.0 * (c11 + c22 + inverse - 3.0), absorbed: splat(0.0) }
    }

    /// From d²(1/det C) ≤ 6 |b₁ f₂ − b₂ f₁|²/(det C)² along every motion b ⊗ n of unit size.
    fn stiffness<const L: usize>(&self, d: &Deformation<L>, _: &PeakStrains<L>) -> Stiffness<L> {
        let [c11, c22, c12, inverse] = right_cauchy_green(d);
        let square = inverse * inverse;
        let along = [3.0 * self.0 * c22.abs() * square, 3.0 * self.0 * c11.abs() * square];
        let (across, shear) = ([splat(self.0); 2], 3.0 * self.0 * c12.abs() * square);
        Stiffness { along, across, shear, alignment: splat(1.0), ..Stiffness::in_any_direction(splat(0.0)) }
    }

    /// 1/√det C, from the stress alone.
    fn thickness_ratio<const L: usize>(&self, _d: &Deformation<L>, s: &Stress<L>) -> Lane<L> {
        let (t1, t2, cross) = (s.tension[0] / self.0, s.tension[1] / self.0, s.cross / self.0);
        let power = (1.0 - t1) * (1.0 - t2) - cross * cross;
        lanes(|l| power[l].powf(1.0 / 6.0))
    }

    fn moduli(&self) -> [f64; 2] {
        [4.0 * self.0; 2]
    }

    fn break_strains<const L: usize>(&self, _: &PeakStrains<L>) -> [Lane<L>; 2] {
        [splat(f64::INFINITY); 2]
    }
}

fn main() {
    print!("{}", report());
}

/// What the example prints: stress over stretch, of the element and in closed form.
pub fn report() -> String {
    let nodes = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(|[x, y]| Point3::new(x, y, 0.0));
    let mesh = Mesh { nodes: nodes.to_vec(), quads: vec![[0, 1, 2, 3]], ..Mesh::default() };
    let (film, thickness, stress_free) = (NeoHookean(0.4e6), 50e-6, StressFree::new(0.0, [0.0; 2]));
    let mut element = Patch::<_, 1>::new(film, &mesh, &stress_free, thickness).expect("MD lies in the plane");
    let rows = [1.1, 1.5, 2.0, 3.0_f64].map(|stretch| {
        let (mut position, mut force) = (Vectors::default(), Vectors::zero(nodes.len()));
        position.extend(nodes.iter().map(|p| [stretch * p.x, p.y, 0.0]));
        element.add_forces(Width::best(), &position, 0.0, &mut force);
        let (stress, exact) =
            (-(force.value_at(1)[0] + force.value_at(2)[0]) / thickness, 0.4e6 * (stretch - stretch.powi(-3)));
        format!("{stretch:<7.3}  {stress:<12.3}  {exact:.3}\n")
    });
    format!("stretch  stress_Pa     closed_form_Pa\n{}", rows.concat())
}
