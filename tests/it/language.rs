//! The model of a scenario: SI values, defaults, the order of the faces.

use std::f64::consts::FRAC_PI_2;
use std::fs;
use std::path::Path;

use droptower::material::Law;
use droptower::mesh::{Element, Outline, Side};
use droptower::model::loading::Impact;
use droptower::model::{self, Hold, ImpactorShape, Loading, Model, Symmetry, Window};
use droptower::scenario::{Assignment, Document};
use droptower::units::Time;

use crate::verification::tower::checked;

fn read(path: &Path) -> Model {
    checked(Document::read(path).and_then(|document| model::check(&document)))
}

/// The model of a text as `scenarios/<name>.toml` in a folder of its own, beside the parts that it may extend.
fn model(name: &str, text: &str) -> Model {
    model_with(name, text, &[])
}

fn model_with(name: &str, text: &str, changes: &[&str]) -> Model {
    let folder = tempfile::tempdir().expect("a folder");
    let scenarios = folder.path().join("scenarios");
    let path = scenarios.join(format!("{name}.toml"));
    fs::create_dir_all(path.parent().expect("a folder")).expect("writable");
    for part in glob::glob("tests/it/broken/parts/*").expect("a good pattern").flatten() {
        let copy = scenarios.join(part.file_name().expect("a file"));
        fs::copy(&part, copy).expect("writable");
    }
    fs::write(&path, text).expect("writable");
    let changes: Vec<_> = changes.iter().map(|change| Assignment::from_argument(change).expect("a value")).collect();
    checked(Document::read(&path).and_then(|document| model::check(&document.with(&changes))))
}

#[test]
fn a_diameter_is_twice_the_radius_and_replaces_an_inherited_one() {
    let text = "extends = \"tower.toml\"\nimpactor.shape.sphere.diameter = \"80 mm\"\n\
                specimen.shape = { circle = { diameter = \"0.4 m\" } }\n\
                layers.faces = [\"0 mm\"]\n";
    let model = model("dart", text);
    assert_eq!(model.specimen.shape, Outline::Circle { radius: 0.2 });
    let shape = &model.impactors[0].shape;
    assert!(matches!(shape, ImpactorShape::Sphere { radius } if *radius == 0.04), "{shape:?}");
    let bars = "extends = \"tower.toml\"\nframe.bars = { diameter = \"2 mm\", friction = 0.3 }\n";
    assert_eq!(self::model("bars", bars).frame.bars.map(|bars| bars.radius), Some(0.001));
}

#[test]
fn the_model_is_in_si_units() {
    let tower = read(Path::new("tests/it/broken/parts/tower.toml"));
    assert_eq!((tower.name.as_str(), tower.title.as_str()), ("tower", "Drop tower"));
    assert_eq!(tower.specimen.shape, Outline::Rectangle { x: 0.4, y: 0.4 });
    assert_eq!(tower.specimen.symmetry, Symmetry::Quarter);
    assert_eq!(tower.faces.iter().map(|face| face.height).collect::<Vec<_>>(), [0.0, -0.03]);
    let face = &tower.faces[0];
    assert_eq!((face.layers, face.prestrain, face.md_angle), (8, [0.1, 0.0], 0.0));
    assert_eq!((face.meshing.element, face.meshing.size), (Element::Quad4, 0.01));
    assert_eq!((face.material.density, face.material.thickness), (915.0, 12e-6));
    let Law::Fabric(fabric) = &face.material.law else { panic!("a fabric") };
    assert_eq!(fabric.md().points(), [[0.26, 8.4e6], [0.84, 20e6], [1.39, 29.3e6]]);
    assert_eq!(fabric.shear().points(), [[0.3, 4e6], [1.5, 8e6]]);
    assert_eq!(tower.frame.hold, Hold::All);
    let impactor = tower.impactor().expect("an impactor").clone();
    assert_eq!((impactor.shape, impactor.mass), (ImpactorShape::Sphere { radius: 0.15 }, 10.72));
    assert_eq!(tower.loading, Loading::Impact(Impact { velocity: 4.16, gravity: 9.81, duration: 0.12 }));
    assert_eq!((tower.output.sample_rate, tower.output.frames, tower.output.filter), (10e3, 240, Some(1000.0)));
}

#[test]
fn names_are_paths_below_scenarios() {
    let text = "extends = \"../tower.toml\"";
    assert_eq!(model("drop/1008", text).name, "drop/1008");
    assert_eq!(model("1008", "extends = \"tower.toml\"").name, "1008");
}

#[test]
fn defaults_are_filled_in() {
    let text = "
        [specimen]
        shape = { circle = { radius = \"63.5 mm\" } }
        mesh = { size = \"3 mm\" }
        material = { density = 915, thickness = \"50 um\", elastic = { young = \"200 MPa\", poisson = 0.4 } }
        [impactor]
        shape = { hemisphere = { radius = \"19.05 mm\" } }
        mass = \"100 g\"
        friction = 0.3
        [loading.impact]
        drop_height = \"0.66 m\"
        duration = \"20 ms\"
        [reference]
        signals = \"shear.csv\"
        window = [0, \"10 ms\"]
        ";
    let dart = model("dart", text);
    assert_eq!((dart.title.as_str(), dart.faces.len(), dart.faces[0].layers), ("dart", 1, 1));
    assert_eq!((dart.specimen.symmetry, &dart.frame.hold), (Symmetry::None, &Hold::All));
    let impactor = dart.impactor().expect("an impactor");
    assert_eq!(impactor.shape, ImpactorShape::Hemisphere { radius: 0.01905, length: 4.0 * 0.01905 });
    assert_eq!(dart.loading.impact().expect("an impact").velocity, (2.0 * 9.81 * 0.66_f64).sqrt());
    assert_eq!(dart.output.filter, Some(1000.0));
    let window = Window::Range([Time(0.0), Time(0.01)]);
    assert_eq!(dart.reference.map(|reference| reference.written.window), Some(window));
}

#[test]
fn keys_of_a_layer_replace_those_of_the_specimen() {
    let text = "
        extends = \"tower.toml\"
        [[layer]]
        height = \"10 mm\"
        md_angle = \"90 deg\"
        mesh.size = \"5 mm\"
        [[layer]]
        count = 3
        material = { extends = \"film.toml\", thickness = \"20 um\", name = \"LDPE\" }
        mesh.element = \"tri3\"
        ";
    let two = model("two", text);
    assert_eq!(two.film(), "film", "two films have no common name");
    let faces = two.faces;
    let of = |place: usize| {
        let face = &faces[place];
        (face.height, face.layers, face.md_angle, face.material.thickness, face.meshing.element, face.meshing.size)
    };
    assert_eq!(of(0), (0.01, 1, FRAC_PI_2, 12e-6, Element::Quad4, 0.005));
    assert_eq!(of(1), (0.0, 3, 0.0, 20e-6, Element::Tri3, 0.01));
    assert_eq!(faces[1].film.as_deref(), Some("LDPE"));
    let named = model("named", "extends = \"tower.toml\"\nspecimen.material.name = \"LLDPE\"");
    assert_eq!(named.film(), "LLDPE");
}

#[test]
fn a_stretch_rotates_the_film_and_not_its_axis() {
    for (direction, angle) in [("MD", 0.0), ("TD", FRAC_PI_2), ("90 deg", FRAC_PI_2)] {
        let text = format!("extends = \"coupon.toml\"\nloading.stretch.direction = \"{direction}\"");
        let coupon = model("coupon-td", &text);
        assert_eq!(coupon.loading.md_angle(), Some(-angle));
        assert_eq!(coupon.faces[0].md_angle, -angle);
        assert_eq!(coupon.frame.hold, Hold::Sides(vec![Side::XMinus, Side::XPlus]));
        assert_eq!((coupon.output.filter, coupon.impactors.is_empty()), (None, true));
    }
}

#[test]
fn multipliers_transform_a_general_curve_as_its_yield_points() {
    let named = "
        extends = \"tower.toml\"
        specimen.material.fabric.scale = { k1 = 2.75, ke = 3.41, ky = 1.2 }
        ";
    let general = named.to_owned()
        + "specimen.material.fabric.md = { curve = [[0, 0], [0.26, 8.4e6], [0.84, 20e6], [1.39, 29.3e6]], yield_strains = [0.26, 0.84] }";
    let apart = "
        extends = \"tower.toml\"
        specimen.material.fabric.scale = { k1 = 5, ke = 5, ky = 5 }
        specimen.material.fabric.md.scale = { k1 = 2.75, ke = 3.41, ky = 1.2 }
        specimen.material.fabric.td.scale = { k1 = 2.75, ke = 3.41, ky = 1.2 }
        ";
    let named = &model("b", named).faces[0].material;
    assert_eq!(&model("a", &general).faces[0].material, named);
    assert_eq!(&model("c", apart).faces[0].material, named);
}

/// The break is as written unless it is to move; up to the earlier of both breaks the stress is the same.
#[test]
fn multipliers_move_the_break_only_where_asked() {
    let md = |name: &str, scale: &str| {
        let text = format!("extends = \"tower.toml\"\nspecimen.material.fabric.{scale}");
        let Law::Fabric(fabric) = model(name, &text).faces[0].material.law.clone() else { panic!("one curve") };
        fabric.md().clone()
    };
    let kept = md("kept", "scale = { k1 = 2.75, ke = 3.41 }");
    let moved = md("moved", "scale = { k1 = 2.75, ke = 3.41 }\nspecimen.material.fabric.scale_break = true");
    assert_eq!(kept.end(), 1.39);
    assert!((moved.end() - 0.747814).abs() < 1e-6, "{}", moved.end());
    for strain in [0.01, 0.1, 0.5, 0.7] {
        assert_eq!(kept.stress(strain), moved.stress(strain));
    }
    // Softer curves are longer: the written break cuts them.
    let cut = md("cut", "scale = { ke = 0.7 }");
    assert_eq!((cut.end(), cut.points().len()), (1.39, 3));
}

/// Film that relaxed has the stress of the curve without multipliers on that with them: (0.1, 3.2308 MPa) of MD lies at
/// 0.1/(k₁ k_e) there.
#[test]
fn relaxed_film_is_mounted_with_the_stress_of_the_slow_curve() {
    let prestrain = |mounting: &str| {
        let text = format!(
            "extends = \"tower.toml\"\nlayers.prestrain = {{ md = 0.1, td = -0.01 }}\n[specimen.material.fabric]\n\
             scale = {{ k1 = 2.75, ke = 3.41 }}\nmounting = \"{mounting}\""
        );
        model(mounting, &text).faces[0].prestrain
    };
    assert_eq!(prestrain("dynamic"), [0.1, -0.01]);
    let [md, td] = prestrain("quasi-static");
    assert!((md - 0.1 / (2.75 * 3.41)).abs() < 1e-12 && td == -0.01, "{md} {td}");
}

/// The law of the tower's film whose MD fibres have curves by strain rate, TD fibres one, with changes.
fn by_rate(changes: &[&str]) -> Law {
    let text = "
        extends = \"tower.toml\"
        [specimen.material.fabric]
        md.rates = [
            { rate = \"0.04 1/s\", yield = [[0.2, 1e6], [0.4, 2e6]], break = [1, 4e6], scale = { ky = 1 } },
            { rate = 4, curve = \"shear.csv\", yield_strains = [0.3, 0.5] },
        ]
        td = { yield = [[0.1, 1e6], [0.2, 2e6]], break = [3, 5e6] }
        scale.ky = 2";
    model_with("rates", text, changes).faces[0].material.law.clone()
}

/// Multipliers belong to a curve, its fibre set or the fabric, and the innermost apply; assignments change each.
#[test]
fn curves_by_strain_rate() {
    let stresses = |changes: &[&str]| {
        let Law::RateFabric(fabric) = by_rate(changes) else { panic!("curves by rate") };
        [(0.01, 0.2), (4.0, 0.3), (0.4, 0.2)].map(|(rate, strain)| fabric.md().stress_at(strain, rate))
    };
    let is = |found: [f64; 3], slow: f64, fast: f64, at: f64| {
        let expected = [slow, fast, 0.5 * (slow + at)];
        found.iter().zip(expected).all(|(found, expected)| (found / expected - 1.0).abs() < 1e-12)
    };
    let curve = |strain: f64| 4e6 * strain / 0.3; // the first line of shear.csv
    assert!(is(stresses(&[]), 1e6, 2.0 * curve(0.3), 2.0 * curve(0.2)), "{:?}", stresses(&[]));
    let own = "specimen.material.fabric.md.scale.ky=3";
    assert!(is(stresses(&[own]), 1e6, 3.0 * curve(0.3), 3.0 * curve(0.2)));
    let second = "specimen.material.fabric.md.rates.1.scale={ ky = 0.5 }";
    assert!(is(stresses(&[own, second]), 1e6, 0.5 * curve(0.3), 0.5 * curve(0.2)));
    let first = "specimen.material.fabric.md.rates.0.scale.ky=5";
    assert!(is(stresses(&[first]), 5e6, 2.0 * curve(0.3), 2.0 * curve(0.2)));
    let Law::RateFabric(fabric) = by_rate(&[]) else { panic!("curves by rate") };
    assert_eq!((fabric.md().range(), fabric.td().range()), (Some([0.04, 4.0]), None));
    assert_eq!(fabric.td().stress_at(0.1, 1e3), 2e6);
    let one = "specimen.material.fabric.md={ yield = [[0.2, 1e6], [0.4, 2e6]], break = [1, 4e6] }";
    assert!(matches!(by_rate(&[one]), Law::Fabric(_)));
}

/// `biaxial` changes the law at equal strains.
#[test]
fn what_couples_fibre_sets_is_in_the_law() {
    let law = |change: &str| model_with("changed", "extends = \"tower.toml\"", &[change]).faces[0].material.law.clone();
    let plain = law("specimen.material.fabric.biaxial=0");
    let Law::Fabric(curves) = &plain else { panic!("a fabric") };
    let strained = [[1.2, 0.0, 0.0], [0.0, 1.2, 0.0]];
    let added = 0.25 * (curves.md().stress(0.2) + curves.td().stress(0.2));
    let found = law("specimen.material.fabric.biaxial=0.5").virgin_stress(strained);
    for (axis, curve) in [curves.md(), curves.td()].into_iter().enumerate() {
        let expected = curve.stress(0.2) + added;
        assert!((found[axis][axis] / expected - 1.0).abs() < 1e-12, "{found:?}");
    }
}

#[test]
fn measured_rates_follow_from_curves_by_rate() {
    let read = |changes: &[&str]| {
        let td =
            "specimen.material.fabric.td.rates=[{ rate = 1, curve = [[1, 1e6]] }, { rate = 9, curve = [[1, 1e6]] }]";
        let model = model_with("changed", "extends = \"tower.toml\"", &[&[td], changes].concat());
        model.faces[0].material.measured_rates
    };
    let md = "specimen.material.fabric.md.rates=[{ rate = 0.1, curve = [[1, 1e6]] }, { rate = 5, curve = [[1, 1e6]] }]";
    assert_eq!(read(&[md]), Some([0.1, 9.0]));
    // The ranges of both sets are disjoint: there is no key to be refused.
    let slow =
        "specimen.material.fabric.md.rates=[{ rate = 0.01, curve = [[1, 1e6]] }, { rate = 0.5, curve = [[1, 1e6]] }]";
    assert_eq!(read(&[slow]), Some([0.01, 9.0]));
    assert_eq!(read(&[md, "specimen.material.fabric.measured_rates=[2, 3]"]), Some([2.0, 3.0]));
    // A fibre set with one curve has no rate.
    assert_eq!(read(&[]), Some([1.0, 9.0]));
}

/// Two balls with these coefficients of friction.
fn balls(frictions: [f64; 2]) -> String {
    let ball = |(friction, x): (f64, f64)| {
        format!(
            "[[impactor]]\nname = \"ball_at_{}\"\nshape.sphere.radius = 0.01\nmass = 1\nfriction = {friction}\nposition = [{x}, 0]\n",
            if x < 0.0 { "left" } else { "right" }
        )
    };
    frictions.into_iter().zip([-0.05, 0.05]).map(ball).collect()
}

/// Elements are fine under each of two bodies; `polygon.file` replaces inherited corners with their holes; a loop may
/// repeat its first corner; a mesh of film has a unit.
#[test]
fn outlines_and_refinement_are_what_was_written() {
    let folder = tempfile::tempdir().expect("a folder");
    let write = |name: &str, text: &str| {
        let path = folder.path().join(name);
        fs::write(&path, text).expect("writable");
        path
    };
    let film = "specimen.material = { density = 915, thickness = 20e-6, elastic = { young = 1e6, poisson = 0.3 } }
        loading.impact = { velocity = 1, duration = 0.01 }\n";
    let balls = balls([0.0; 2]) + "guide = \"free\"\nspin = [0, 0, \"60 rpm\"]\n";
    let square = "specimen.shape.polygon = { points = [[-0.1, -0.1], [0.1, -0.1], [0.1, 0.1], [-0.1, 0.1], [-0.1, -0.1]], \
        holes = [[[0.08, 0.08], [0.09, 0.08], [0.09, 0.09]]] }\n\
        specimen.mesh = { size = 0.02, fine = 0.002 }\n";
    let base = write("base.toml", &[film, square, &balls].concat());
    let model = read(&base);
    let zones = &model.faces[0].meshing.grading.as_ref().expect("fine elements").zones;
    assert_eq!(zones.iter().map(|zone| zone.at).collect::<Vec<_>>(), [[-0.05, 0.0], [0.05, 0.0]]);
    assert!((model.impactors[1].spin[2] - std::f64::consts::TAU).abs() < 1e-12);
    let Outline::Polygon(polygon) = &model.specimen.shape else { panic!("a polygon") };
    assert_eq!((polygon.outer.len(), polygon.holes.len()), (4, 1));

    write("disc.svg", "<svg xmlns='http://www.w3.org/2000/svg'><circle r='90'/></svg>");
    let drawn = "extends = \"base.toml\"\nspecimen.shape.polygon = { file = \"disc.svg\", unit = \"mm\" }\n";
    let model = read(&write("drawn.toml", drawn));
    let Outline::Polygon(polygon) = &model.specimen.shape else { panic!("a polygon") };
    assert!(polygon.holes.is_empty() && (polygon.extent() - 0.18).abs() < 1e-4, "{}", polygon.extent());

    write("film.obj", "v 0 0 0\nv 200 0 0\nv 200 100 0\nv 0 100 0\nf 1 2 3 4\n");
    let imported = format!("{film}specimen.shape.mesh = {{ file = \"film.obj\", unit = \"mm\" }}\n{balls}");
    let model = read(&write("imported.toml", &imported));
    let mesh = droptower::mesh::build(&model.specimen.shape, [false; 2], &model.faces[0].meshing).expect("a mesh");
    assert_eq!(mesh.nodes.iter().map(|node| node.x).fold(0.0, f64::max), 0.2);
}

/// What faces have on each other does not depend on the order of the impactors.
#[test]
fn film_on_film_has_the_friction_of_no_impactor_before_another() {
    let folder = tempfile::tempdir().expect("a folder");
    let between = |frictions: [f64; 2], more: &str| {
        let balls = balls(frictions);
        let text = format!(
            "specimen.shape.rectangle = [0.2, 0.2]\nspecimen.mesh.size = 0.02
             specimen.material = {{ density = 915, thickness = 20e-6, elastic = {{ young = 1e6, poisson = 0.3 }} }}
             layers.faces = [0.0, -0.03]\n{more}\nloading.impact = {{ velocity = 1, duration = 0.01 }}\n{balls}"
        );
        let path = folder.path().join("balls.toml");
        fs::write(&path, text).expect("writable");
        let checked = model::check(&Document::read(&path).expect("it reads"));
        checked.map(|model| model.contact.film_friction).map_err(|mistakes| mistakes[0].message.clone())
    };
    for film in ["", "contact.film = true"] {
        let orders = [[0.3, 0.1], [0.1, 0.3]].map(|frictions| between(frictions, film));
        assert_eq!(orders[0], orders[1]);
        assert_eq!(orders[0], Err("missing key `contact.film_friction`".to_owned()));
        assert_eq!(between([0.3, 0.3], film), Ok(Some(0.3)));
    }
    for frictions in [[0.3, 0.1], [0.1, 0.3]] {
        assert_eq!(between(frictions, "contact.film_friction = 0.2"), Ok(Some(0.2)));
    }
}
