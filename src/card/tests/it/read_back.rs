//! Cards that are read: those that were written give the film again, those of others what their fields mean, and those that
//! cannot be read a mistake at its place.

use super::card;

use card::read::{FoundLaw, Mistake, Place, Reading, Warning};
use card::{Film, Request, System, Target};
use membrane::material::{
    Curve, Elastic, Fabric, FlowCurve, FlowRate, Hardening, Hill, Hyperelastic, HyperelasticLaw, Law, Material, Ogden,
    Plastic, Polynomial, PronyTerm, RateCurves, RateTable, Viscosity,
};

use super::{curve, fabric, film_of, lldpe, polynomial};

fn again(material: &Material, target: Target, system: System) -> Reading {
    let request = Request::new(target, system);
    let written = card::write(&Film { name: "film", material, origin: &[] }, &request).unwrap();
    card::read::read(&written.text, system, None).unwrap_or_else(|mistake| panic!("{mistake:?} in\n{}", written.text))
}

fn close(found: f64, expected: f64) {
    super::close(found, expected, 2e-6, "a card");
}

fn same(found: &[[f64; 2]], expected: &[[f64; 2]]) {
    assert_eq!(found.len(), expected.len(), "{found:?} and {expected:?}");
    found.iter().flatten().zip(expected.iter().flatten()).for_each(|(found, expected)| close(*found, *expected));
}

/// Both solvers whose cards are read, in all systems.
fn both() -> impl Iterator<Item = (Target, System)> {
    [Target::LsDyna, Target::OpenRadioss].into_iter().flat_map(|target| System::ALL.map(|system| (target, system)))
}

#[test]
fn a_fabric_that_was_written_is_read() {
    let [md, td, shear] = lldpe();
    for (target, system) in both() {
        let found = again(&fabric(0.87), target, system);
        close(found.film.density, 917.3456789);
        let FoundLaw::Fabric { fibres, shear: found_shear, absorption } = found.film.law else { panic!("no fabric") };
        let with_origin = |curve: &Curve| [&[[0.0, 0.0]], curve.points()].concat();
        same(&fibres[0][0].1, &with_origin(&md));
        same(&fibres[1][0].1, &with_origin(&td));
        same(&found_shear, &with_origin(&shear));
        // By H, or by unloading curves.
        close(absorption, 0.87);
        assert_eq!(found.warnings, vec![]);
    }
}

/// Unloading curves from one strain stand for an absorption; paths of another kind are named.
#[test]
fn unloading_curves_are_read_as_an_absorption_where_they_are_one() {
    let md = curve(&[[0.1, 8e6], [0.7, 20e6]]);
    let shear = curve(&[[0.1, 1.3e6], [0.6, 5.1e6]]);
    let film = film_of(Law::Fabric(Fabric::new(md.clone(), md.clone(), shear, 0.6)));
    for (target, system) in both() {
        let request = Request { unloading_from: Some(0.45), ..Request::new(target, system) };
        let text = card::write(&Film { name: "film", material: &film, origin: &[] }, &request).unwrap().text;
        let found = card::read::read(&text, system, None).unwrap();
        let FoundLaw::Fabric { fibres, absorption, .. } = found.film.law else { panic!("no fabric") };
        close(absorption, 0.6);
        // With a point where unloading begins.
        assert_eq!(fibres[0][0].1.len(), 4);
        assert_eq!(found.warnings, vec![]);
        // The unloading curve of MD is that of another strain: 0.27 is 0.6 times 0.45.
        let other = text.replacen("0.27", "0.21", 1);
        assert_ne!(other, text);
        let found = card::read::read(&other, system, None).unwrap();
        let FoundLaw::Fabric { absorption, .. } = found.film.law else { panic!("no fabric") };
        assert_eq!((absorption, found.warnings.len()), (0.0, 3), "{target:?}: {:?}", found.warnings);
    }
}

#[test]
fn curves_by_rate_that_were_written_are_read() {
    let slow = curve(&[[0.1, 8e6], [1.0, 20e6]]);
    let fast = curve(&[[0.1, 12e6], [1.0, 30e6]]);
    let rates = RateCurves::new(vec![(0.002, slow.clone()), (50.0, fast.clone())], 0.01).unwrap();
    let film = film_of(Law::RateFabric(Fabric::new(rates.clone(), rates, slow.clone(), 0.0)));
    let FoundLaw::Fabric { fibres, .. } = again(&film, Target::LsDyna, System::GMmMs).film.law else {
        panic!("no fabric")
    };
    let found: Vec<f64> = fibres[1].iter().map(|(rate, _)| rate.unwrap()).collect();
    found.iter().zip([0.002, 50.0]).for_each(|(found, expected)| close(*found, expected));
    same(&fibres[0][1].1, &[&[[0.0, 0.0]], fast.points()].concat());
}

#[test]
fn rubber_and_its_relaxation_that_were_written_are_read() {
    let terms = [PronyTerm { share: 0.25, time: 0.01 }, PronyTerm { share: 0.15, time: 3.0 }];
    for (target, system) in both() {
        let ogden = Hyperelastic { energy: Ogden::new(&Ogden::TRELOAR), wrinkling: false };
        let mut film = film_of(Law::Hyperelastic(HyperelasticLaw::Ogden(ogden)));
        film.viscosity = Some(Viscosity::new(terms.to_vec()).unwrap());
        let found = again(&film, target, system).film;
        same(&found.prony, &[[0.25, 0.01], [0.15, 3.0]]);
        let FoundLaw::Ogden(found) = found.law else { panic!("no Ogden") };
        same(&found, &Ogden::TRELOAR.map(|term| [term.mu, term.alpha]));
        let mut film = polynomial(Polynomial::yeoh([1.847e5, -1464.6, 40.215]));
        film.viscosity = Some(Viscosity::new(terms.to_vec()).unwrap());
        let found = again(&film, Target::LsDyna, system).film;
        let FoundLaw::Polynomial([c10, c01, c20, c30]) = found.law else { panic!("no polynomial") };
        assert_eq!(c01, 0.0);
        same(&[[c10, c20], [c30, 0.0]], &[[1.847e5, -1464.6], [40.215, 0.0]]);
        same(&found.prony, &[[0.25, 0.01], [0.15, 3.0]]);
    }
}

#[test]
fn plastic_and_elastic_film_that_were_written_are_read() {
    let elastic = Elastic { young: 2.034e8, poisson: 0.45 };
    let points = [[0.0, 8e6], [0.05, 10e6], [0.5, 20e6]];
    let hardening = || Hardening::Table(FlowCurve::new(&points).unwrap());
    let hill = Hill::from_strain_ratios([1.0; 3]);
    let film = film_of(Law::Plastic(Plastic::new(elastic.clone(), hill, hardening(), FlowRate::Independent)));
    for (target, system) in both() {
        let law = again(&film, target, system).film.law;
        let FoundLaw::Plastic { young, poisson, curves, hill } = law else { panic!("not plastic") };
        assert_eq!(hill, None);
        close(young, 2.034e8);
        close(poisson, 0.45);
        same(&curves[0].1, &points);
        let found = again(&film_of(Law::Elastic(elastic.clone())), target, system).film.law;
        let FoundLaw::Elastic { young, .. } = found else { panic!("not elastic") };
        close(young, 2.034e8);
    }
}

/// LAW43, and tables by rate with it.
#[test]
fn lankford_values_and_tables_by_rate_that_were_written_are_read() {
    let curve =
        |factor: f64| FlowCurve::new(&[[0.0, factor * 8e6], [0.05, factor * 10e6], [0.5, factor * 20e6]]).unwrap();
    let rates = [0.01, 1.0, 10.0, 100.0, 1000.0, 5000.0];
    let curves: Vec<_> = rates.iter().enumerate().map(|(i, rate)| (*rate, curve(1.0 + 0.1 * i as f64))).collect();
    for r in [[1.0; 3], [0.8, 1.4, 2.1]] {
        let (slow, table) = RateTable::new(curves.clone()).unwrap();
        let elastic = Elastic { young: 2e8, poisson: 0.45 };
        let plastic =
            Plastic::new(elastic, Hill::from_strain_ratios(r), Hardening::Table(slow), FlowRate::Table(table));
        let found = again(&film_of(Law::Plastic(plastic)), Target::OpenRadioss, System::TMmS).film.law;
        let FoundLaw::Plastic { curves, hill, .. } = found else { panic!("not plastic") };
        assert_eq!(hill.is_some(), r[0] != 1.0);
        if let Some(found) = hill {
            found.into_iter().zip(r).for_each(|(found, r)| close(found, r));
        }
        assert_eq!(curves.len(), 6);
        for (i, (rate, points)) in curves.iter().enumerate() {
            close(rate.unwrap(), rates[i]);
            close(points[2][1], (1.0 + 0.1 * i as f64) * 20e6);
        }
    }
}

/// Written by hand, in free format, with Fortran's exponents, a title, other keywords and lines of another system.
const BY_HAND: &str = include_str!("../cards/by-hand.k");

#[test]
fn a_card_by_hand_is_read_with_what_it_has_besides() {
    let found = card::read::read(BY_HAND, System::TMmS, Some("PA fabric")).unwrap();
    assert_eq!(found.film.name, "PA fabric");
    close(found.film.density, 780.0);
    let FoundLaw::Fabric { fibres, shear, absorption } = &found.film.law else { panic!("no fabric") };
    // Abscissas times 2, ordinates times 10.
    same(&fibres[0][0].1, &[[0.0, 0.0], [0.1, 8e6], [0.2, 10e6]]);
    same(&fibres[1][0].1, &[[0.0, 0.0], [0.3, 60e6]]);
    same(shear, &[[0.0, 0.0], [0.6, 3e6]]);
    assert_eq!(*absorption, 0.0);
    let expected = [
        Warning::Keyword { line: 3, name: "*PART".into() },
        Warning::Field { line: 8, name: "PRBA".into(), value: "0.1".into() },
    ];
    assert_eq!(found.warnings, expected);
    assert_eq!(card::read::read(BY_HAND, System::TMmS, Some("7")).unwrap().film, found.film);
}

#[test]
fn hardening_by_points_and_by_a_tangent_modulus() {
    let by_points = "*MAT_PIECEWISE_LINEAR_PLASTICITY\n1,1e-9,200.,.4,8.\n\n0,.1,.5\n8.,10.,20.\n";
    let by_tangent = "*MAT_024\n1,1e-9,200.,.4,8.,40.\n\n\n\n";
    for (text, expected) in
        [(by_points, vec![[0.0, 8e6], [0.1, 10e6], [0.5, 20e6]]), (by_tangent, vec![[0.0, 8e6], [1.0, 58e6]])]
    {
        let found = card::read::read(text, System::TMmS, None).unwrap();
        let FoundLaw::Plastic { curves, .. } = found.film.law else { panic!("not plastic") };
        same(&curves[0].1, &expected);
    }
}

/// Both kinds of tables have twenty columns a field; one names its curves.
#[test]
fn curves_by_rate_are_read_from_either_table() {
    for (keyword, named) in [("DEFINE_TABLE", ["", ""]), ("DEFINE_TABLE_2D", ["11", "12"])] {
        let material =
            "*MAT_024\n         1      1e-9      200.        .4        8.\n                           101\n\n\n";
        let table = format!("*{keyword}\n       101\n{:>20}{:>20}\n{:>20}{:>20}\n", 0.001, named[0], 1.0, named[1]);
        let curve = |number: u8, stress: f64| format!("*DEFINE_CURVE\n{number:>10}\n{:>20}{stress:>20}\n", 0.0);
        let text = format!("{material}{table}{}{}", curve(11, 8.0), curve(12, 10.0));
        let FoundLaw::Plastic { curves, .. } = card::read::read(&text, System::TMmS, None).unwrap().film.law else {
            panic!("not plastic")
        };
        assert_eq!(curves, [(Some(0.001), vec![[0.0, 8e6]]), (Some(1.0), vec![[0.0, 1e7]])]);
    }
}

#[test]
fn what_cannot_be_read_is_a_mistake_at_its_place() {
    let fabric = |form: &str, curve: &str| {
        format!("*MAT_FABRIC\n1,1e-9\n\n,,,,,{form}\n\n\n2,2,2\n,,1.5\n*DEFINE_CURVE\n2\n{curve}\n")
    };
    let good = "0,0\n1,5";
    for (text, line, column, expected) in [
        (String::from("solid\n"), 1, 1, "this is no card"),
        ("*NODE\n1,2\n".into(), 1, 1, "no material"),
        ("*MAT_ELASTIC\n1,,200.,.3\n".into(), 2, 3, "RO is missing"),
        ("*MAT_ELASTIC\n1,1e-9,2oo,.3\n".into(), 2, 8, "E is not a number: `2oo`"),
        ("*MAT_ELASTIC\n1,1e-9,200,.7\n".into(), 2, 12, "PR is 0.7"),
        ("*MAT_ELASTIC\n1,1e-9,&young,.3\n".into(), 2, 8, "`&young` is a parameter"),
        ("*MAT_ELASTIC\n".into(), 1, 1, "*MAT_ELASTIC ends before its card 1"),
        ("*MAT_ELASTIC\n1\t1e-9\n".into(), 2, 2, "a tab"),
        ("*INCLUDE\nfilm.k\n".into(), 1, 1, "*INCLUDE would read another file"),
        (fabric("4", good), 4, 6, "FORM 4 is not read"),
        (fabric("-14", good), 8, 3, "H is 1.5"),
        (fabric("14", "0,0\n1,5\n2,4"), 7, 1, "its stress falls"),
        (fabric("14", "0,0\n0,5"), 7, 1, "do not increase"),
        (fabric("14", "-1,-3\n0,0\n1,5"), 7, 1, "compression"),
        (fabric("14", "0,0"), 7, 1, "too few points"),
        (fabric("14", "0,0\n1,five"), 12, 3, "O is not a number"),
        ("*MAT_FABRIC\n1,1e-9\n\n,,,,,14\n\n\n2,2,2\n".into(), 7, 1, "there is no curve or table 2"),
        ("*MAT_OGDEN_RUBBER\n1,1e-9,.4999,2\n1.\n2.\n".into(), 2, 14, "N is not 0"),
        ("*MAT_OGDEN_RUBBER\n1,1e-9,.4999,0\n1.\n-2.\n".into(), 3, 1, "a shear modulus above zero is missing"),
        ("*MAT_HYPERELASTIC_RUBBER\n1,1e-9,.4999,0\n.5,.2,,,,.01\n".into(), 3, 4, "C01 is of an energy"),
        ("/UNIT/5\nlocal\n/MAT/LAW42/1/5\nrubber\n".into(), 3, 1, "in the units of /UNIT/5"),
    ] {
        let Err(Mistake { place, message }) = card::read::read(&text, System::TMmS, None) else {
            panic!("read: {text}")
        };
        assert!(message.contains(expected), "{message}");
        assert_eq!(place, Place { line, column }, "{message} in {text}");
    }
    let other = card::read::read(BY_HAND, System::TMmS, Some("8")).unwrap_err();
    assert_eq!(other.message, "there is no material 8");
}
