//! The coupling of MD and TD: bulges and wide coupons that show it, and what it changes.

use std::fs;
use std::path::Path;

use serde_json::Value as Json;

use crate::workbench::{droptower, figures, finding_codes, printed, refused, root, summary};

const FILM: &str = "scenarios/materials/lldpe-quasi-static.toml";

/// The figures of a command that runs in the repository.
fn of(arguments: &[&str]) -> Json {
    figures(&droptower(&root(), &[arguments, &["--json"]].concat()))
}

fn number(value: &Json) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("no number: {value}"))
}

/// `signals.csv` of a scenario after changes.
fn signals(folder: &Path, scenario: &str, changes: &[&str]) -> String {
    let out = folder.join("run");
    let out = out.to_str().expect("UTF-8");
    let sets = changes.iter().chain(&["output.frames=4"]).flat_map(|change| ["--set", change]);
    let arguments: Vec<&str> = ["run", scenario, "--out", out, "--force"].into_iter().chain(sets).collect();
    printed(&droptower(&root(), &arguments));
    fs::read_to_string(folder.join("run/signals.csv")).expect("signals")
}

/// A recording with the mark of what nobody measured.
fn recording(folder: &Path, name: &str, signals: &str) -> String {
    let path = folder.join(name);
    fs::write(&path, format!("# VIRTUAL: a run\n{signals}")).expect("writable");
    path.to_str().expect("UTF-8").to_owned()
}

/// Runs of the engine with a coupling, reduced in closed form: within what the cap and the free edges leave.
#[test]
fn bulges_and_wide_coupons_show_the_coupling_of_their_film() {
    let folder = tempfile::tempdir().expect("a folder");
    for coupling in thorough::first(1, [0.79, 0.3]) {
        let biaxial = format!("specimen.material.fabric.biaxial={coupling}");
        let slow = "loading.pressure.mass_scaling=300";
        let coarse = "specimen.mesh.size=5mm";
        let text = signals(folder.path(), "scenarios/inflation/bulge.toml", &[&biaxial, slow, coarse]);
        let bulge = recording(folder.path(), "bulge.csv", &text);
        let size = ["--radius", "50 mm", "--thickness", "12 um"];
        let found = of(&[&["reduce", "bulge", &bulge, "--film", FILM], &size[..]].concat());
        println!("bulge, {coupling}: {}", found["coupling"]["mean"]);
        assert!((number(&found["coupling"]["mean"]) - coupling).abs() < 0.06, "{found}");
        assert!(found["tests"][0]["virtual"] == true && found["findings"][0]["code"] == "cap-assumed", "{found}");

        let wide = ["specimen.shape.rectangle=[\"10 mm\",\"100 mm\"]", "specimen.mesh.size=2.5mm"];
        let changes = [&[&biaxial[..], "loading.stretch.until=0.2", "output.sample_rate=500Hz"], &wide[..]].concat();
        let text = signals(folder.path(), "scenarios/stretch/md-0.02.toml", &changes);
        let coupon = recording(folder.path(), "md-0.02-1.csv", &text);
        let size = ["--gauge", "10 mm", "--width", "100 mm", "--thickness", "12 um"];
        let found = of(&[&["reduce", "wide", &coupon, "--film", FILM], &size[..]].concat());
        let own = &found["tests"][0]["coupling"];
        println!("wide coupon, {coupling}: {} to {}", own["value"], own["high"]);
        let [low, high] = [number(&own["value"]), number(&own["high"])];
        assert!(low < coupling && high > coupling && high < 1.06 * low, "{found}");
        assert_eq!(finding_codes(&found), ["coupon-edges", "width-held"]);
    }
}

/// The curves that are written are tests which `fit rubber` reads, and which a law of rubber follows.
#[test]
fn curves_of_both_directions_can_be_fitted() {
    let folder = tempfile::tempdir().expect("a folder");
    // Caps of a neo-Hookean film with μ = 1 MPa: μ (λ − λ⁻⁵) under equal stretches.
    let rows = (1..=40).map(|row| {
        let height = 1e-3 * f64::from(row);
        let (radius, angle) = ((0.05_f64.powi(2) + height * height) / (2.0 * height), 2.0 * height.atan2(0.05));
        let stretch = radius * angle / 0.05;
        let stress = 1e6 * (stretch - stretch.powi(-5));
        format!("{},{}\n", 2.0 * stress * 1e-3 / (radius * stretch), 1e3 * height)
    });
    let text = format!("pressure [Pa],height [mm]\n{}", rows.collect::<String>());
    fs::write(folder.path().join("rubber.csv"), text).expect("writable");
    let bulge = ["reduce", "bulge", "rubber.csv", "--radius", "50 mm", "--thickness", "1 mm"];
    let shown = printed(&droptower(folder.path(), &[&bulge[..], &["-o", "rubber-curve.csv"]].concat()));
    assert!(shown.contains("wrote rubber-curve.csv") && !shown.contains("coupling of MD and TD"), "{shown}");
    let fit =
        figures(&droptower(folder.path(), &["fit", "rubber", "rubber-curve.csv", "--law", "neo-hookean", "--json"]));
    assert!((number(&fit["coefficients"][0]["value"]) / 1e6 - 1.0).abs() < 1e-9, "{fit}");
    for (name, text) in [
        ("no-units.csv", "pressure,height\n100,0.01\n200,0.02\n"),
        ("negative.csv", "pressure [Pa],height [mm]\n-100,10\n-200,20\n"),
        ("md-0.02-9.csv", "force,displacement\n1,1\n2,2\n3,3\n"),
    ] {
        fs::write(folder.path().join(name), text).expect("writable");
    }
    let of_file = |file| ["reduce", "bulge", file, "--radius", "50 mm", "--thickness", "1 mm"];
    for (arguments, expected) in [
        // Remedies that can be typed.
        (&of_file("no-units.csv")[..], "give it: --unit pressure=Pa"),
        (&of_file("negative.csv")[..], "change the sign"),
        (
            &["reduce", "wide", "md-0.02-9.csv", "--gauge", "5 mm", "--width", "50 mm", "--thickness", "1 mm"],
            "--unit force=N",
        ),
        (&[&bulge[..3], &["--radius", "-50 mm", "--thickness", "1 mm"]].concat(), "radius"),
        (&[&bulge[..], &["--film", "none.toml"]].concat()[..], "none.toml"),
        (&[&bulge[..], &["--pressure", "p"]].concat(), "channel `p`"),
        (&[&bulge[..3], &["--radius", "0 mm", "--thickness", "1 mm"]].concat(), "radius"),
        (&[&bulge[..], &["rubber-curve.csv", "-o", "other.csv"]].concat(), "--out writes the curve of one recording"),
        (
            &["reduce", "wide", "md-0.02-1.csv", "--gauge", "10 mm", "--width", "10 mm", "--thickness", "1 mm"],
            "md-0.02-1.csv",
        ),
    ] {
        refused(&droptower(folder.path(), arguments), expected);
        assert!(!folder.path().join("other.csv").exists());
    }
}

/// Isotropic film and the fabric that its own coupons make: without coupling the drop is a fifth too soft, with the coupling that
/// the film's curve under equal strains shows it is not.
#[test]
fn a_measured_coupling_mends_the_drop_of_isotropic_film() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("out");
    let arguments = ["script", "scripts/coupling.rhai", "--arg", "mesh=40", "--out", out.to_str().expect("UTF-8")];
    printed(&droptower(&root(), &arguments));
    let summary = summary(&out);
    let rows = summary["tables"]["films"].as_array().expect("rows");
    let [of_peak, of_travel] = ["peak_over_first", "travel_over_first"]
        .map(|name| rows.iter().map(|row| number(&row[name])).collect::<Vec<f64>>());
    println!("peak and travel over those of von Mises film: {of_peak:?}, {of_travel:?}");
    assert!(of_peak[1] < 0.85 && of_travel[1] > 1.12, "not coupled: {rows:?}");
    assert!(of_peak[2] > 1.03 && of_travel[2] < 0.96, "coupled as elastic film: {rows:?}");
    assert!((of_peak[3] - 1.0).abs() < 0.04 && (of_travel[3] - 1.0).abs() < 0.03, "as measured: {rows:?}");
}
