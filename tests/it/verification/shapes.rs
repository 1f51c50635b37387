//! Impactors of other shapes compared with the sphere, and penetration.

use std::fmt::Write;
use std::fs;

use super::claims::Claims;
use super::tower::{impact, loading_of_1008, measured, peaks, run};

/// Slow enough that only the lower part of the sphere is in contact.
const TIP: [&str; 4] =
    ["layers.faces=[\"0 mm\"]", "loading.impact.velocity=1.5m/s", "impactor.mass=2kg", "loading.impact.duration=45ms"];

#[test]
fn the_tip_of_a_hemisphere_is_a_sphere() {
    let mut claims = Claims::of("hemisphere");
    let changes = [&TIP[..], &["specimen.mesh.size=30mm"]].concat();
    let sphere = peaks(&impact(&loading_of_1008(&changes)));
    let dart = [&changes[..], &[r#"impactor.shape={ hemisphere = { radius = "120 mm" } }"#]].concat();
    let dart = peaks(&impact(&loading_of_1008(&dart)));
    claims.near("peak displacement, m", dart[0], sphere[0], 1e-2);
    claims.near("peak acceleration, m/s2", dart[1], sphere[1], 1e-2);
}

fn stl(triangles: &[[[f64; 3]; 3]], radius: f64) -> String {
    let mut text = String::from("solid sphere\n");
    for triangle in triangles {
        text += "facet normal 0 0 0\nouter loop\n";
        for corner in triangle {
            let [x, y, z] = corner.map(|x| x * radius);
            writeln!(text, "vertex {x:e} {y:e} {z:e}").expect("memory");
        }
        text += "endloop\nendfacet\n";
    }
    text + "endsolid sphere\n"
}

#[test]
fn a_sphere_of_triangles_is_a_sphere() {
    let mut claims = Claims::of("triangulated sphere");
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("sphere.stl");
    let triangles = thorough::sphere_of_triangles(4);
    assert_eq!(triangles.len(), 20 * 256);
    fs::write(&path, stl(&triangles, 0.12)).expect("a file");
    let whole = [&TIP[..], &["specimen.symmetry=none", "specimen.mesh.size=20mm"]].concat();
    let sphere = peaks(&impact(&loading_of_1008(&whole)));
    let shape = format!("impactor.shape={{ mesh = '{}' }}", path.display());
    let model = loading_of_1008(&[&whole[..], &[&shape]].concat());
    let outcome = run(&model);
    let meshed = peaks(&measured(&model, &outcome));
    claims.near("peak displacement, m", meshed[0], sphere[0], 2e-2);
    claims.near("peak acceleration, m/s2", meshed[1], sphere[1], 2e-2);
    claims.at_most("energy balance error", outcome.energy_balance_error, 1e-2);
}

#[test]
fn penetration_is_small() {
    let mut claims = Claims::of("penetration");
    let dart = r#"impactor.shape={ hemisphere = { radius = "60 mm" } }"#;
    let cylinder = r#"impactor.shape={ cylinder = { radius = "60 mm", length = "120 mm" } }"#;
    let light = ["impactor.mass=1kg", "loading.impact.velocity=2m/s", "layers.faces=[\"0 mm\"]"];
    let on = |shape, size| [&light[..], &[shape, size]].concat();
    // Of a sphere over its radius; of a sharp edge over the element.
    let sharp = |element: f64| 1e-2 * element / 0.06;
    let cases: [(&str, &[&str], f64); 5] = [
        ("1008, 10 mm", &[], 1e-2),
        ("dart of 60 mm, 15 mm", &on(dart, "specimen.mesh.size=15mm"), 1e-2),
        ("cylinder of 60 mm, 20 mm", &on(cylinder, "specimen.mesh.size=20mm"), sharp(0.02)),
        ("cylinder of 60 mm, 10 mm", &on(cylinder, "specimen.mesh.size=10mm"), sharp(0.01)),
        ("cylinder of 60 mm, 50 mm", &on(cylinder, "specimen.mesh.size=50mm"), sharp(0.05)),
    ];
    for (what, changes, bound) in cases {
        let model = loading_of_1008(changes);
        let outcome = run(&model);
        claims.at_most(&format!("{what}, depth over radius"), outcome.penetration.expect("a depth"), bound);
        claims.at_most(&format!("{what}, energy balance error"), outcome.energy_balance_error, 1e-3);
        let rebound = measured(&model, &outcome).first().rebound_velocity_m_s;
        claims.holds(&format!("{what}, rebound"), &format!("{rebound:.3?} m/s"), rebound.is_some_and(|v| v > 0.0));
    }
}
