//! Material files of coupon tests: what is written, and that it is read.

use droptower::experiment::coupon::{Coupon, Curve, Direction, Reduction, Rules, Sample, ShearMethod};
use droptower::experiment::material_file::coupon::{CouponMaterial, GivenShear, Texts};
use droptower::scenario::Document;

/// A film that yields twice.
const DOUBLE: [[f64; 2]; 3] = [[0.26, 8.4], [0.84, 20.0], [1.39, 29.3]];

/// Coupons of the three directions that follow straight lines through `points` (strain, stress in MPa).
fn reduction(points: &[[f64; 2]]) -> Reduction {
    let law: (Vec<f64>, Vec<f64>) = [[0.0, 0.0]].iter().chain(points).map(|[e, s]| (*e, s * 1e6)).unzip();
    let law = Curve::new(law.0, law.1).unwrap();
    let end = law.range()[1];
    let strain: Vec<f64> = (0..=700).map(|i| (end * f64::from(i) / 700.0).min(end)).collect();
    let stress = strain.iter().map(|strain| law.stress_at(*strain).unwrap()).collect();
    let curve = Curve::new(strain, stress).unwrap();
    let sample = |direction| Sample::new(direction, 0.02, &curve, &Rules::default()).unwrap();
    Reduction::from_samples(&[Direction::Md, Direction::Td, Direction::D3].map(sample), &Rules::default()).unwrap()
}

/// The material of `reduction` for coupons of 5 mm by 10 mm.
fn material(reduction: &Reduction) -> CouponMaterial<'_> {
    let coupon = Coupon::new(5e-3, 10e-3, 12e-6).unwrap();
    let (density, shear_by) = (Some(915.0), ShearMethod::default());
    let (shear_file, elastic_corner, shear) = ("film-shear.csv", None, None);
    CouponMaterial { reduction, coupon, density, shear_file, elastic_corner, shear_by, shear }
}

/// What the reader of materials says of the texts as files.
fn mistakes(texts: &Texts) -> Vec<String> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("film.toml");
    std::fs::write(&path, &texts.material).unwrap();
    std::fs::write(folder.path().join("film-shear.csv"), &texts.shear).unwrap();
    Document::read_material(&path).err().unwrap_or_default().iter().map(|mistake| mistake.render(false)).collect()
}

#[test]
fn a_double_yield_point_is_written_as_such() {
    let texts = material(&reduction(&DOUBLE)).texts().unwrap();
    let expected = "md = { yield = [[0.26, \"8.4 MPa\"], [0.84, \"20 MPa\"]], break = [1.39, \"29.3 MPa\"] }\n";
    assert!(texts.material.contains(expected), "{}", texts.material);
    assert_eq!(mistakes(&texts), [""; 0]);
}

#[test]
fn a_corner_keeps_the_modulus() {
    let reduction = reduction(&[[0.04, 2.0], [0.26, 8.4], [0.84, 20.0], [1.39, 29.3]]);
    let texts = CouponMaterial { elastic_corner: Some(0.04), ..material(&reduction) }.texts().unwrap();
    let expected = "md = { curve = [[0.04, \"2 MPa\"], [0.26, \"8.4 MPa\"], [0.84, \"20 MPa\"], [1.39, \"29.3 MPa\"]], \
                    yield_strains = [0.26, 0.84] }\n";
    assert!(texts.material.contains(expected), "{}", texts.material);
    assert_eq!(mistakes(&texts), [""; 0]);
}

#[test]
fn a_curve_without_one_is_written_point_by_point() {
    let texts = material(&reduction(&[[0.3, 9.0], [1.2, 13.0]])).texts().unwrap();
    assert!(texts.material.contains("no second yield point"), "{}", texts.material);
    // Past the bend the width shrinks faster than the stress grows.
    assert!(texts.material.contains(", beyond which the stress falls"), "{}", texts.material);
    assert_eq!(mistakes(&texts), [""; 0]);
}

#[test]
fn a_given_shear_curve_is_copied_with_its_source() {
    let mut reduction = reduction(&DOUBLE);
    reduction.directions.retain(|along| along.direction != Direction::D3);
    let given = |text| {
        let shear = Some(GivenShear { source: "lab/shear.csv", text });
        CouponMaterial { density: None, shear, ..material(&reduction) }.texts().unwrap()
    };
    let texts = given("\u{feff}strain,stress_MPa\n0.5,4\n");
    assert_eq!(texts.shear, "# Written by droptower: a copy of lab/shear.csv.\nstrain,stress_MPa\n0.5,4\n");
    assert!(texts.material.contains("# Given, not measured with these coupons: a copy of lab/shear.csv.\n"));
    assert_eq!(mistakes(&texts), [""; 0]);
    let marked = given("# Virtual: guessed\nstrain,stress_MPa\n0.5,4\n");
    assert!(marked.shear.starts_with("# Written by droptower: a copy of lab/shear.csv, which is marked as VIRTUAL.\n"));
    assert!(marked.material.contains("which is marked as VIRTUAL"));
}

#[test]
fn virtual_coupons_mark_both_files() {
    let mut reduction = reduction(&DOUBLE);
    assert!(!material(&reduction).texts().unwrap().material.contains("VIRTUAL"));
    reduction.directions.iter_mut().for_each(|along| along.virtual_recordings = 1);
    let texts = material(&reduction).texts().unwrap();
    let [material, shear] = [&texts.material, &texts.shear].map(|text| text.lines().next().unwrap());
    let written = "# Written by droptower from coupon tests";
    assert_eq!(material, format!("{written}: 3 recordings, 3 of them VIRTUAL: nothing was pulled."));
    assert_eq!(shear, format!("{written} of D3: 1 recordings, 1 of them VIRTUAL: nothing was pulled."));
}

#[test]
fn what_no_material_can_be_is_refused() {
    let good = reduction(&DOUBLE);
    for density in [-5.0, 0.0, f64::INFINITY] {
        let refused = CouponMaterial { density: Some(density), ..material(&good) }.texts().unwrap_err().to_string();
        assert_eq!(refused, format!("expected a density above zero, found {density} kg/m3"));
    }
    let falling = material(&reduction(&[[0.3, 9.0], [0.8, 10.0], [1.2, 7.0]])).texts().unwrap_err().to_string();
    assert!(falling.starts_with("MD: stress falls between the points (0."), "{falling}");
    let mut no_td = reduction(&DOUBLE);
    no_td.directions.remove(1);
    let missing = material(&no_td).texts().unwrap_err().to_string();
    assert!(missing.ends_with("and there is none of TD"), "{missing}");
}
