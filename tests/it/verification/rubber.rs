//! Hyperelastic film: single elements by their closed forms, and discs and balloons that gas inflates beyond the
//! largest pressure that they carry.

use droptower::engine::{Engine, Filling, Film, Loads, Nodes, Section};
use droptower::material::{Hyperelastic, HyperelasticLaw, Material, Ogden, Polynomial};
use droptower::mesh::{Element, Mesh};
use droptower::simulate::{self, Outcome};
use nalgebra::{Point3, Vector3};

use super::claims::Claims;
use super::random::Random;
use super::scene::{forces, mounted, nominal, observe_step, positions, set_positions};
use super::sheet::{self, ELEMENTS, THICKNESS, distorted_element, rubbers};
use super::solve::zero;
use super::tower::{channel, last, run, written};

/// ∂w/∂λ_i of an energy w of three stretches, up to the pressure of an incompressible law.
type Slope = Box<dyn Fn([f64; 3], usize) -> f64>;

/// The slopes of the incompressible laws of [`rubbers`], by hand.
fn slopes() -> [(&'static str, Slope); 5] {
    fn first([a, b, c]: [f64; 3]) -> f64 {
        a * a + b * b + c * c
    }
    let mooney = |s: [f64; 3], i: usize| 2.0 * s[i] * (1.6e5 + 4e4 * (first(s) - s[i] * s[i]));
    let yeoh = |s: [f64; 3], i: usize| {
        let x = first(s) - 3.0;
        2.0 * s[i] * (0.18e6 - 2.0 * 0.002e6 * x + 3.0 * 0.000_05e6 * x * x)
    };
    let ogden = |s: [f64; 3], i: usize| Ogden::TRELOAR.iter().map(|t| t.mu * s[i].powf(t.alpha - 1.0)).sum();
    [
        ("neo-Hookean", Box::new(|s, i| 4e5 * s[i])),
        ("Mooney–Rivlin", Box::new(mooney)),
        ("Yeoh", Box::new(yeoh)),
        ("Gent", Box::new(|s, i| 4e5 * s[i] / (1.0 - (first(s) - 3.0) / 97.2))),
        ("Ogden", Box::new(ogden)),
    ]
}

/// Nominal stresses of incompressible film, Pa.
fn incompressible(slope: &Slope, [a, b]: [f64; 2]) -> [f64; 2] {
    let stretches = [a, b, 1.0 / (a * b)];
    let pressure = stretches[2] * slope(stretches, 2);
    [0, 1].map(|i| slope(stretches, i) - pressure / stretches[i])
}

/// The same of the compressible film: Kirchhoff stresses μ(λ_i² − 1) + λ ln J, of which that across the film is zero.
fn compressible([a, b]: [f64; 2]) -> [f64; 2] {
    let (young, poisson) = (1e6, 0.3);
    let (mu, lame) = (young / (2.0 * (1.0 + poisson)), young * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson)));
    let kirchhoff = |stretch: f64, c: f64| mu * (stretch * stretch - 1.0) + lame * (a * b * c).ln();
    let c = zero(1e-3, 1e3, |c| kirchhoff(c, c));
    [a, b].map(|stretch| kirchhoff(stretch, c) / stretch)
}

/// A distorted element of each kind in uniaxial and equibiaxial tension and in pure shear.
#[test]
fn an_element_has_the_stresses_of_the_closed_form() {
    let mut claims = Claims::of("rubber, one element");
    let slopes = slopes();
    for wrinkling in [false, true] {
        for (name, material) in rubbers(wrinkling) {
            let closed = |at: [f64; 2]| match slopes.iter().find(|(law, _)| *law == name) {
                Some((_, slope)) => incompressible(slope, at),
                None => compressible(at),
            };
            let mut off = [0.0_f64; 3];
            for kind in ELEMENTS {
                let (mut film, mut nodes) = mounted(
                    &distorted_element(kind, &mut Random::new(5)),
                    &sheet::face(material.clone(), kind, [0.0; 2]),
                );
                let places = positions(&nodes);
                for stretch in [1.0001, 1.05, 1.3, 2.0, 3.5, 5.0_f64] {
                    let narrow = zero(0.1, 1.0, |width| closed([stretch, width])[1]);
                    for (mode, at) in [[stretch, narrow], [stretch; 2], [stretch, 1.0]].into_iter().enumerate() {
                        set_positions(&mut nodes, |n, _| [at[0] * places[n][0], at[1] * places[n][1], 0.0]);
                        let found = nominal(&forces(&mut film, &nodes), &places, THICKNESS);
                        let expected = closed(at);
                        let error = (0..2).map(|i| (found[i] - expected[i]).abs() / expected[0]).fold(0.0, f64::max);
                        off[mode] = off[mode].max(error);
                    }
                }
            }
            for (mode, off) in ["uniaxial", "equibiaxial", "pure shear"].into_iter().zip(off) {
                let state = if wrinkling { ", wrinkling" } else { "" };
                claims.at_most(&format!("{name}{state}, {mode}, stress off the closed form"), off, 1e-9);
            }
        }
    }
}

/// A clamped disc of radius 1 m and thickness 1 mm that gas inflates.
fn disc(law: &str, volume: f64, size: &str) -> Outcome {
    run(&written(&format!(
        "specimen.shape = {{ circle = {{ radius = 1 }} }}
         specimen.material = {{ density = 1000, thickness = 1e-3, hyperelastic = {{ {law} }} }}
         specimen.mesh = {{ element = \"quad4\", size = \"{size}\" }}
         specimen.symmetry = \"quarter\"
         loading.volume = {{ volume = {volume}, ramp = 20 }}
         output = {{ frames = 2, sample_rate = \"20 Hz\" }}"
    )))
}

/// Pressure at which the apex first is `height` (m) high, from the line between two samples, Pa.
fn pressure_at(outcome: &Outcome, height: f64) -> f64 {
    let [rise, pressure] = ["deflection_m", "pressure_Pa"].map(|name| channel(&outcome.signals, name));
    let next = rise.iter().position(|rise| *rise >= height).expect("a disc that rises as far");
    let share = (height - rise[next - 1]) / (rise[next] - rise[next - 1]);
    pressure[next - 1] + share * (pressure[next] - pressure[next - 1])
}

/// The film has followed the gas, in equilibrium.
fn audit(claims: &mut Claims, name: &str, outcome: &Outcome, volume: f64) {
    claims.near(&format!("{name}, volume at the end, m³"), last(&outcome.signals, "volume_m3"), volume, 1e-9);
    claims.at_most(&format!("{name}, kinetic share"), outcome.kinetic_share.expect("a share"), 1e-2);
    claims.at_most(&format!("{name}, energy balance error"), outcome.energy_balance_error, 1e-3);
    claims.at_most(&format!("{name}, change at the end"), outcome.settling.expect("a rest"), 1e-4);
}

/// code_aster ssns115e, quadratic elements (VALE_CALC), beyond the largest pressure near 1 250 mm.
#[test]
fn a_compressible_disc_follows_that_of_code_aster_beyond_its_limit() {
    let mut claims = Claims::of("rubber, compressible disc");
    let law = "law = \"compressible-neo-hookean\", young = \"2 MPa\", poisson = 0.3";
    let outcome = disc(law, 13.0, "40 mm");
    for (apex, pressure) in [(1.0, 1286.4), (1.25, 1371.3), (1.5, 1348.8), (2.0, 1203.4), (2.5, 1048.1)] {
        claims.near(&format!("pressure at an apex of {apex} m, Pa"), pressure_at(&outcome, apex), pressure, 5e-3);
    }
    audit(&mut claims, "disc", &outcome, 13.0);
}

/// p a/(μ h) over the apex, from the equations of the membrane of revolution (relative tolerance 1e-10): the largest
/// for neo-Hookean film, and rows for the other laws.
#[test]
fn incompressible_discs_rise_as_membranes_of_revolution() {
    let mut claims = Claims::of("rubber, incompressible discs");
    let mu = 0.4225e6;
    let load = |pressure: f64| pressure / (mu * 1e-3);
    let neo_hookean = disc(&format!("law = \"neo-hookean\", mu = {mu}"), 6.0, "40 mm");
    let [rise, pressure] = ["deflection_m", "pressure_Pa"].map(|name| channel(&neo_hookean.signals, name));
    let top = (0..pressure.len()).max_by(|a, b| pressure[*a].total_cmp(&pressure[*b])).expect("samples");
    claims.near("neo-Hookean, largest p a/(μ h)", load(pressure[top]), 1.8791, 5e-3);
    // The vertex of the parabola through the samples near it: the top is flat.
    claims.near("neo-Hookean, its apex over a", vertex(rise, pressure, rise[top], 0.1), 1.179, 1e-2);
    audit(&mut claims, "neo-Hookean", &neo_hookean, 6.0);
    let moduli = Ogden::TRELOAR.map(|term| format!("\"{} Pa\"", term.mu)).join(", ");
    let exponents = Ogden::TRELOAR.map(|term| format!("{:?}", term.alpha)).join(", ");
    let ogden = format!("law = \"ogden\", mu = [{moduli}], alpha = [{exponents}]");
    let mooney = |share: f64| {
        let c10 = 0.5 * mu / (1.0 + share);
        format!("law = \"mooney-rivlin\", c10 = {c10}, c01 = {}", share * c10)
    };
    let cases = [
        ("neo-Hookean", None, vec![(0.6, 1.206428), (1.0, 1.839932), (1.6, 1.763401)]),
        ("Mooney–Rivlin, c01/c10 0.1", Some(mooney(0.1)), vec![(0.6, 1.251661), (1.0, 2.092083), (1.6, 2.460336)]),
        ("Ogden", Some(ogden), vec![(0.6, 1.249896), (1.0, 1.888294), (1.6, 1.728814)]),
    ];
    for (name, law, rows) in thorough::first(2, cases) {
        let outcome = law.map(|law| disc(&law, 6.0, "40 mm"));
        let outcome = outcome.as_ref().unwrap_or(&neo_hookean);
        for (apex, expected) in rows {
            let found = load(pressure_at(outcome, apex));
            claims.near(&format!("{name}, p a/(μ h) at an apex of {apex} a"), found, expected, 5e-3);
        }
    }
}

/// Where the parabola that fits `y` over `x` within `reach` of `at` has its vertex.
fn vertex(x: &[f64], y: &[f64], at: f64, reach: f64) -> f64 {
    let rows: Vec<[f64; 2]> =
        x.iter().zip(y).filter(|(x, _)| (*x - at).abs() < reach).map(|(x, y)| [x - at, *y]).collect();
    let mut normal = nalgebra::Matrix3::zeros();
    let mut right = Vector3::zeros();
    for [x, y] in rows {
        let row = Vector3::new(1.0, x, x * x);
        normal += row * row.transpose();
        right += row * y;
    }
    let c = normal.lu().solve(&right).expect("a parabola");
    at - 0.5 * c[1] / c[2]
}

/// Film of Gent's law ends the run where it is stretched to its limit, with the time and the face.
#[test]
fn film_at_the_limit_of_its_law_ends_the_run() {
    let mut claims = Claims::of("rubber, limit of Gent");
    let film = |loading: &str| {
        written(&format!(
            "specimen.shape = {{ circle = {{ radius = 1 }} }}
             specimen.material = {{ density = 1000, thickness = 1e-3, hyperelastic = {{ law = \"gent\", mu = 4e5, jm = 1.5 }} }}
             specimen.mesh = {{ element = \"quad4\", size = \"0.1 m\" }}
             specimen.symmetry = \"quarter\"
             {loading}
             output = {{ frames = 2, sample_rate = \"20 Hz\" }}"
        ))
    };
    for loading in [
        "loading.volume = { volume = 6, ramp = 20 }",
        "loading.volume = { volume = 60, ramp = 20, mass_scaling = 400 }",
    ] {
        let failed = simulate::run(&film(loading), &mut |_| {}).expect_err("a limit");
        let message = failed.to_string();
        claims.holds(loading, &message, message.contains("film of face 1 is stretched to the limit of its law at"));
    }
}

/// Fabric that gas bursts has the pressure at which it bursts under a given one; the element that fails does not change
/// the volume of the gas.
#[test]
fn film_under_gas_bursts_at_the_pressure_of_the_ramp() {
    let mut claims = Claims::of("burst by gas");
    let burst = |loading: &str| {
        let model = written(&format!(
            "specimen.shape = {{ circle = {{ radius = 0.05 }} }}
             specimen.material = {{ density = 915, thickness = 50e-6, fabric = {{ absorption = 0.5, md.curve = [[0, 0], [0.3, 20e6]], td.curve = [[0, 0], [0.3, 20e6]], shear.curve = [[0, 0], [1, 5e6]] }} }}
             specimen.mesh = {{ element = \"quad4\", size = \"8 mm\" }}
             specimen.symmetry = \"quarter\"
             {loading}
             output = {{ frames = 2, sample_rate = \"5 kHz\" }}"
        ));
        let outcome = simulate::run(&model, &mut |_| {}).expect("a run");
        assert!(outcome.rupture_time.is_some(), "{loading}: no rupture");
        let series = outcome.signals.series("pressure_Pa").expect("a pressure");
        let (values, count) = (series.values(), series.len());
        [values[count - 2], values[count - 1], series.largest().expect("a largest one")[1]]
    };
    let [_, given, _] = burst("loading.pressure = { pressure = 4e4, ramp = 0.2 }");
    let [before, last, largest] = burst("loading.volume = { volume = 5e-4, ramp = 0.2 }");
    claims.near("burst pressure, Pa", last, given, 0.03);
    claims.near("that of the sample before, Pa", before, last, 0.03);
    claims.near("largest pressure, Pa", largest, last, 0.03);
}

/// An eighth of a sphere of radius 1 m: three patches of `n`×`n` quads that meet at its middle.
fn octant(n: usize) -> Mesh {
    let mut mesh = Mesh::default();
    let mut add = |x: Vector3<f64>| {
        let x = x.normalize();
        let known = mesh.nodes.iter().position(|p: &Point3<f64>| (p.coords - x).norm() < 1e-9);
        known.unwrap_or_else(|| {
            mesh.nodes.push(Point3::from(x));
            mesh.nodes.len() - 1
        }) as u32
    };
    let axes = [Vector3::x(), Vector3::y(), Vector3::z()];
    let mut quads = vec![];
    for k in 0..3 {
        let [corner, one, other] = [axes[k], axes[(k + 1) % 3], axes[(k + 2) % 3]];
        let middle = Vector3::new(1.0, 1.0, 1.0).normalize();
        let at = |i: usize, j: usize| {
            let [s, t] = [i, j].map(|i| i as f64 / n as f64);
            let ([a, b], m) = ([(corner + one).normalize(), (corner + other).normalize()], middle);
            corner * (1.0 - s) * (1.0 - t) + a * s * (1.0 - t) + b * (1.0 - s) * t + m * s * t
        };
        for i in 0..n {
            for j in 0..n {
                quads.push([at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)].map(&mut add));
            }
        }
    }
    mesh.quads = quads;
    mesh
}

/// Pressure of a closed balloon of Mooney–Rivlin film at the stretches L: p = 4 (h/r)(1/L − 1/L⁷)(c₁ + c₂ L²).
#[test]
fn a_balloon_has_the_pressure_of_the_sphere() {
    const THICK: f64 = 1e-3;
    const C: [f64; 2] = [0.2e6, 0.02e6];
    let mut claims = Claims::of("rubber, balloon");
    let mesh = octant(8);
    let energy = Polynomial::mooney_rivlin(C[0], C[1]);
    let law = HyperelasticLaw::Polynomial(Hyperelastic { energy, wrinkling: true });
    let material = Material { thickness: THICK, density: 1e3, ..sheet::hyperelastic(law) };
    for kind in [Element::Quad4, Element::Quad4Full] {
        let mut nodes = Nodes::default();
        let section = Section {
            md_angle: 0.2,
            full_integration: kind == Element::Quad4Full,
            ..Section::new(material.law.clone(), material.density, THICK)
        };
        let film = Film::mount(&mesh, &section, 0.0, &mut nodes).expect("a film");
        for axis in 0..3 {
            let on = (0..mesh.nodes.len()).filter(|n| mesh.nodes[*n][axis].abs() < 1e-9);
            nodes.hold(on.collect::<Vec<_>>(), [0, 1, 2].map(|a| a == axis));
        }
        let largest = 2.2_f64;
        let full = std::f64::consts::PI / 6.0;
        let ramp = 40.0;
        let filling = Some(Filling { volume: full * (largest.powi(3) - 1.0), ramp });
        let loads = Loads { filling, damping: 2.0, multiplicity: 8.0, ..Loads::default() };
        let mut engine = Engine::new(vec![film], nodes, [], loads);
        let mut wanted = [1.1, 1.383, 1.7, 2.1].into_iter().peekable();
        while let Some(stretch) = wanted.peek().copied() {
            let (inflated, size, details) = observe_step(&mut engine, |view| {
                let size = view.nodes.position.iter().map(|x| Vector3::from(x).norm()).sum::<f64>();
                let size = size / view.nodes.mass.len() as f64;
                (view.inflated(), size, (size >= stretch).then(|| view.films[0].details(&view.nodes.position)))
            });
            let Some([pressure, _]) = inflated.filter(|_| size >= stretch) else { continue };
            let expected = 4.0 * THICK * (1.0 / size - size.powi(-7)) * (C[0] + C[1] * size * size);
            claims.near(&format!("{kind:?}, pressure at L = {stretch}, Pa"), pressure, expected, 5e-3);
            let thickness = details.iter().flatten().map(|element| element.thickness_ratio).sum::<f64>();
            let thickness = thickness / mesh.quads.len() as f64;
            claims.near(&format!("{kind:?}, thickness at L = {stretch}"), thickness, size.powi(-2), 2e-3);
            wanted.next();
        }
    }
}
