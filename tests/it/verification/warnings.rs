//! Warnings of runs outside the valid range, and none of others.

use droptower::finding::Report;

use super::claims::Claims;
use super::tower::{run, shipped};

#[test]
fn runs_outside_the_valid_range_have_warnings() {
    let mut claims = Claims::of("warnings");
    // MD as it was measured, so that it does not break before TD runs away.
    let flat_td = [
        "impactor.shape.sphere.radius=30mm",
        "impactor.friction=0",
        "loading.impact.duration=40ms",
        "specimen.material.fabric.scale_break=false",
    ];
    let voce = &[
        "specimen.mesh.size=4mm",
        "impactor.mass=600g",
        r#"specimen.material.plastic.hardening={ voce = { yield = "8 MPa", saturation = "20 MPa", rate = 8 } }"#,
        r#"specimen.material.rupture={ criterion = "strain", limit = 1.0, energy = "30 kJ/m2" }"#,
    ][..];
    let warm = &["specimen.material.thermal={ heat = 2300, softening = 0.009 }"][..];
    let slow = &[r#"specimen.material.fabric.measured_rates=["0.001 1/s", "0.04 1/s"]"#][..];
    let drop = "drop/1008.toml";
    let md = "stretch/md-0.02.toml";
    let shipped_mesh = "specimen.mesh.size=10mm";
    let told: &[&str] = &["specimen.mesh.size=40mm", r#"specimen.material.fabric.biaxial_source="a wide coupon""#];
    let fast: &[&str] = &["specimen.mesh.size=50mm", "loading.impact.velocity=6"];
    let cases: [(&str, &str, &[&str], bool); 26] = [
        ("coarse-contact", drop, &["specimen.mesh.size=40mm"], true),
        ("coarse-contact", drop, &[shipped_mesh, "loading.impact.duration=40ms"], false),
        ("strain-localisation", drop, &[&flat_td[..], &[shipped_mesh]].concat(), true),
        ("strain-localisation", drop, &["specimen.mesh.size=20mm"], false),
        ("uncoupled-biaxial", drop, &["specimen.mesh.size=40mm"], true),
        ("uncoupled-biaxial", drop, &["specimen.mesh.size=40mm", "specimen.material.fabric.biaxial=0.79"], false),
        ("uncoupled-biaxial", drop, &["specimen.mesh.size=40mm", "specimen.material.fabric.biaxial=0.01"], true),
        ("uncoupled-biaxial", drop, &["specimen.mesh.size=40mm", "specimen.material.fabric.biaxial=0.49"], true),
        ("uncoupled-biaxial", drop, &["specimen.mesh.size=40mm", "specimen.material.fabric.biaxial=0.5"], false),
        ("uncoupled-biaxial", drop, &[told, &["specimen.material.fabric.biaxial=0.2"]].concat(), false),
        ("uncoupled-biaxial", drop, told, false),
        (
            "uncoupled-biaxial",
            "stretch/45deg-0.02.toml",
            &["specimen.mesh.size=1mm", "loading.stretch.until=0.2"],
            false,
        ),
        ("break-strain-of-coupons", "drop/1508.toml", fast, true),
        ("break-strain-of-coupons", drop, &["specimen.mesh.size=40mm"], false),
        ("break-strain-of-coupons", "drop/1508-tear.toml", fast, false),
        (
            "break-strain-of-coupons",
            "drop/1508.toml",
            &[fast, &["specimen.material.fabric.md.break_factor=0.6"]].concat(),
            false,
        ),
        ("thinning-before-break", "drop/plastic.toml", voce, true),
        ("thinning-before-break", "drop/plastic.toml", &voce[..3], false),
        ("heat-leaves", "stretch/md-0.0002.toml", warm, true),
        ("heat-leaves", "stretch/md-0.2.toml", warm, false),
        ("heat-twice", "stretch/md-0.2.toml", warm, true),
        ("heat-twice", "stretch/md-0.2.toml", &[warm, slow].concat(), false),
        ("strain-rate-outside", md, &["loading.stretch.velocity=0.00002", "output.sample_rate=2"], true),
        ("strain-rate-outside", md, &["loading.stretch.velocity=2", "output.sample_rate=200kHz"], true),
        ("strain-rate-outside", md, &[], false),
        ("not-quasi-static", md, &["loading.stretch.mass_scaling=1e8"], true),
    ];
    for (code, scenario, changes, expected) in cases {
        let warnings = run(&shipped(scenario, changes)).warnings;
        let warned = warnings.iter().any(|warning| warning.code().name == code);
        let seen: Vec<String> = warnings.iter().map(ToString::to_string).collect();
        let seen = if seen.is_empty() { "no warning".to_owned() } else { seen.join("; ") };
        claims.holds(&format!("{code}, {scenario} {}", changes.join(" ")), &seen, warned == expected);
    }
    claims.judge();
}

#[test]
fn the_histogram_has_the_rate_of_a_constant_speed() {
    let mut claims = Claims::of("strain rates");
    for (speed, rate) in [("0.0002", 0.04), ("0.02", 4.0), ("0.2", 40.0)] {
        let outcome = run(&shipped(&format!("stretch/md-{speed}.toml"), &[]));
        let rates = &outcome.rates;
        let bin = |rate: f64| rates.edges.partition_point(|edge| *edge <= rate) - 1;
        let near: f64 = (bin(0.98 * rate)..=bin(1.02 * rate)).map(|k| rates.shares[k]).sum();
        claims.at_most(&format!("{speed} m/s, share of strain increments not at {rate} 1/s"), 1.0 - near, 1e-2);
    }
    claims.judge();
}
