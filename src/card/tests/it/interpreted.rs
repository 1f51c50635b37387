//! Cards, read by interpreters that know the documented meaning of fields and nothing of what writes them: the curves that they
//! find, on one element, against the law of the film.

use std::collections::BTreeMap;

use super::card;

use card::{Film, Loss, Request, System, Target};
use membrane::material::{
    Curve, Elastic, Fabric, FlowCurve, FlowRate, Gent, Hardening, Hill, Hyperelastic, HyperelasticLaw, Law, Material,
    Ogden, OgdenTerm, Plastic, Polynomial, PronyTerm, RateCurves, Thermal, Viscosity, Voce,
};

use super::{close, fabric, film_of, lldpe, polynomial, value_at};

fn rubber(terms: &[OgdenTerm]) -> Material {
    film_of(Law::Hyperelastic(HyperelasticLaw::Ogden(Hyperelastic { energy: Ogden::new(terms), wrinkling: false })))
}

fn plastic(hill: Hill, rate: FlowRate) -> Material {
    let voce = Voce { initial: 10e6, saturation: 30e6, rate: 8.0 };
    film_of(Law::Plastic(Plastic::new(Elastic { young: 300e6, poisson: 0.4 }, hill, Hardening::Voce(voce), rate)))
}

fn written(material: &Material, request: &Request) -> card::Card {
    let origin = ["from film.toml, SHA-256 0123".to_owned()];
    card::write(&Film { name: "LLDPE", material, origin: &origin }, request).unwrap()
}

/// Nominal stresses P₁₁, P₂₂ and P₁₂ of the law at F = [[a, s], [0, b]].
fn nominal(law: &Law, [a, b]: [f64; 2], s: f64) -> [f64; 3] {
    let p = law.virgin_stress([[a, 0.0, 0.0], [s, b, 0.0]]);
    [p[0][0], p[1][1], p[1][0]]
}

/// Keywords of LS-DYNA: names, and their cards as fields of ten columns, or of twenty where the name ends with `+`.
fn keywords(text: &str) -> Vec<(String, Vec<Vec<String>>)> {
    let mut found: Vec<(String, Vec<Vec<String>>)> = vec![];
    let (mut width, mut is_title) = (10, false);
    for line in text.lines().filter(|line| !line.starts_with('$')) {
        if std::mem::take(&mut is_title) {
            continue;
        }
        if let Some(name) = line.strip_prefix('*') {
            width = if name.ends_with('+') { 20 } else { 10 };
            let name = name.trim_end_matches('+');
            is_title = name.ends_with("_TITLE");
            found.push((name.trim_end_matches("_TITLE").to_owned(), vec![]));
            continue;
        }
        let (name, cards) = found.last_mut().expect("a keyword");
        // Points of curves have twenty columns in both formats.
        let width = if name == "DEFINE_CURVE" && !cards.is_empty() { 20 } else { width };
        assert!(line.len() <= 8 * width, "{line}");
        let fields = line.as_bytes().chunks(width).map(|field| String::from_utf8_lossy(field).trim().to_owned());
        cards.push(fields.collect());
    }
    found
}

fn number(field: &str) -> f64 {
    if field.is_empty() { 0.0 } else { field.parse().unwrap_or_else(|_| panic!("a number: {field}")) }
}

/// The curves of LS-DYNA by their numbers, scaled and shifted as their cards say.
fn ls_dyna_curves(keywords: &[(String, Vec<Vec<String>>)]) -> BTreeMap<i64, Vec<[f64; 2]>> {
    let of = |(_, cards): &(String, Vec<Vec<String>>)| {
        let head: Vec<f64> = cards[0].iter().map(|field| number(field)).collect();
        let [sfa, sfo, offa, offo] = [head[2], head[3], head[4], head[5]];
        let points = cards[1..].iter().map(|card| [sfa * (number(&card[0]) + offa), sfo * (number(&card[1]) + offo)]);
        (head[0] as i64, points.collect())
    };
    keywords.iter().filter(|(name, _)| name == "DEFINE_CURVE").map(of).collect()
}

/// *MAT_FABRIC with FORM ±14: engineering stress over engineering strain.
#[test]
fn ls_dyna_reads_the_curves_of_fabric() {
    for system in System::ALL {
        let film = fabric(0.4);
        let text = written(&film, &Request::new(Target::LsDyna, system)).text;
        let keywords = keywords(&text);
        let (_, cards) = keywords.iter().find(|(name, _)| name == "MAT_FABRIC").expect("the material");
        let curves = ls_dyna_curves(&keywords);
        close(number(&cards[0][1]) * system.density(), 917.3456789, 1e-6, "density");
        assert_eq!((number(&cards[2][5]), number(&cards[6][2])), (-14.0, 0.4));
        let curve = |place: usize| &curves[&(number(&cards[5][place]) as i64)];
        for strain in [0.01, 0.05, 0.3, 0.7] {
            let [md, _, _] = nominal(&film.law, [1.0 + strain, 1.0], 0.0);
            let [_, td, _] = nominal(&film.law, [1.0, 1.0 + strain], 0.0);
            close(value_at(curve(0), strain) * system.stress(), md, 2e-6, "MD");
            close(value_at(curve(1), strain) * system.stress(), td, 2e-6, "TD");
        }
        // Simple shear keeps the first fibre: with γ = atan s, P₁₂ is τ dγ/ds beside the tension of the second fibre.
        close(value_at(curve(2), 0.1) * system.stress(), 1.3e6, 2e-6, "shear");
        // The largest slope, for time step and contact.
        close(number(&cards[0][2]) * system.stress(), 8.4e6 / 0.0277257, 2e-6, "EA");
    }
}

#[test]
fn unloading_curves_lose_the_share_of_the_energy() {
    let request = Request { unloading_from: Some(0.5), ..Request::new(Target::LsDyna, System::TMmS) };
    let film = fabric(0.4);
    let found = written(&film, &request);
    let keywords = keywords(&found.text);
    let (_, cards) = keywords.iter().find(|(name, _)| name == "MAT_FABRIC").expect("the material");
    assert_eq!(number(&cards[2][5]), 14.0);
    let curves = ls_dyna_curves(&keywords);
    let work = |points: &[[f64; 2]], to: f64| {
        let steps = 20_000;
        let stress = |i: usize| value_at(points, to * (i as f64 + 0.5) / steps as f64).max(0.0);
        (0..steps).map(stress).sum::<f64>() * to / steps as f64
    };
    for (loading, unloading) in [(0, 3), (1, 4)] {
        let [up, down] = [loading, unloading].map(|place| &curves[&(number(&cards[5][place]) as i64)]);
        close(work(down, 0.5), 0.6 * work(up, 0.5), 1e-4, "energy that comes back");
        close(value_at(down, 0.5), value_at(up, 0.5), 1e-6, "the stress from which it unloads");
    }
    assert!(found.losses.iter().any(|loss| matches!(loss, Loss::UnloadingFrom { md, .. } if *md == 0.5)));
}

/// Curves by rate are a table, whose curves follow it in the order of its rates.
#[test]
fn ls_dyna_reads_curves_by_rate_as_a_table() {
    let [md, td, shear] = lldpe();
    let faster = Curve::new(md.points().iter().map(|[strain, stress]| [*strain, 1.5 * stress]).collect()).unwrap();
    let rates = RateCurves::new(vec![(0.002, md.clone()), (50.0, faster)], 0.01).unwrap();
    let film =
        film_of(Law::RateFabric(Fabric::new(rates, RateCurves::new(vec![(1.0, td)], 0.01).unwrap(), shear, 0.0)));
    let text = written(&film, &Request::new(Target::LsDyna, System::GMmMs)).text;
    let keywords = keywords(&text);
    let place = keywords.iter().position(|(name, _)| name == "DEFINE_TABLE").expect("a table");
    let rates: Vec<f64> = keywords[place].1[1..].iter().map(|card| number(&card.concat())).collect();
    // Per millisecond.
    assert_eq!(rates, [2e-6, 0.05]);
    let stress = |place: usize| number(&keywords[place].1[4][1]);
    close(stress(place + 1), 29.3, 1e-6, "slow");
    close(stress(place + 2), 1.5 * 29.3, 1e-6, "fast");
    // OpenRadioss takes one.
    let refused = |request: &Request| {
        card::write(&Film { name: "a", material: &film, origin: &[] }, request).unwrap_err().in_line()
    };
    let request = Request::new(Target::OpenRadioss, System::TMmS);
    let many = "the curves are by strain rate, 0.002 to 50 1/s, and OpenRadioss takes those of one (name one: --rate \"50 1/s\")";
    assert_eq!(refused(&request), many);
    let named = Request { rate: Some(500.0), ..request.clone() };
    assert_eq!(refused(&named), "the curves are of 0.002 to 50 1/s, not of 500 1/s (name a rate within)");
    let one = written(&film, &Request { rate: Some(50.0), ..request });
    assert!(one.losses.contains(&Loss::Rates { kept: 50.0 }));
}

/// Uniaxial nominal stress of incompressible rubber, Σ μ (λ^(α−1) − λ^(−α/2−1)).
fn uniaxial(terms: &[[f64; 2]], stretch: f64) -> f64 {
    let of = |[mu, alpha]: &[f64; 2]| mu * (stretch.powf(alpha - 1.0) - stretch.powf(-0.5 * alpha - 1.0));
    terms.iter().map(of).sum()
}

/// Stress of the law in uniaxial tension: the width is that of incompressible film.
fn tension(material: &Material, stretch: f64) -> f64 {
    nominal(&material.law, [stretch, 1.0 / stretch.sqrt()], 0.0)[0]
}

fn ogdens() -> Vec<(Material, usize)> {
    vec![
        (rubber(&Ogden::TRELOAR), 3),
        (rubber(&[OgdenTerm { mu: 0.9e6, alpha: 1.7 }]), 1),
        (polynomial(Polynomial::neo_hookean(4.2e5)), 1),
        (polynomial(Polynomial::mooney_rivlin(1.6e5, 2.1e4)), 2),
    ]
}

/// The solvers write Ogden's energy in three ways: Σ μ/α (…), Σ 2μ/α² (…) and Σ c/m² (…).
#[test]
fn rubber_has_the_same_stress_in_every_card() {
    let system = System::TMmS;
    for (film, terms) in ogdens() {
        let text = |target: Target| written(&film, &Request::new(target, system)).text;
        let check = |found: Vec<[f64; 2]>, solver: &str| {
            assert_eq!(found.iter().filter(|term| term[0] != 0.0).count(), terms, "{solver}");
            for stretch in [1.1, 1.5, 3.0] {
                close(uniaxial(&found, stretch) * system.stress(), tension(&film, stretch), 5e-6, solver);
            }
        };
        // OpenRadioss, LAW42: lines of five numbers in twenty columns.
        let law42 = text(Target::OpenRadioss);
        let lines: Vec<&str> = law42.lines().filter(|line| !line.starts_with('#')).collect();
        let numbers = |line: &str| -> Vec<f64> {
            line.as_bytes().chunks(20).map(|field| number(String::from_utf8_lossy(field).trim())).collect()
        };
        assert_eq!(lines[0], "/MAT/LAW42/1");
        assert!(lines[5].is_empty() && lines[7].is_empty());
        check(numbers(lines[4]).into_iter().zip(numbers(lines[6])).map(|(mu, alpha)| [mu, alpha]).collect(), "LAW42");
        // FEBio: c and m.
        let feb = text(Target::Febio);
        let element = |name: &str| -> Option<f64> {
            feb.split_once(&format!("<{name}>")).map(|(_, rest)| number(rest.split('<').next().unwrap()))
        };
        let of = |i: usize| Some([element(&format!("c{i}"))? / element(&format!("m{i}"))?, element(&format!("m{i}"))?]);
        check((1..=6).filter_map(of).collect(), "FEBio");
    }
    // Abaqus and CalculiX.
    for target in [Target::Abaqus, Target::CalculiX] {
        let film = rubber(&Ogden::TRELOAR);
        let text = written(&film, &Request::new(target, system)).text;
        let (_, data) = text.split_once("*HYPERELASTIC, OGDEN, N=3\n").expect("the keyword");
        let row: Vec<f64> =
            data.lines().take(2).flat_map(|line| line.split(',')).map(|field| number(field.trim())).collect();
        let terms: Vec<[f64; 2]> = (0..3).map(|i| [2.0 * row[2 * i] / row[2 * i + 1], row[2 * i + 1]]).collect();
        close(uniaxial(&terms, 3.0) * system.stress(), tension(&film, 3.0), 5e-6, "*HYPERELASTIC");
        // D = 2/K with the Poisson's ratio that is asked for.
        let shear: f64 = terms.iter().map(|[mu, alpha]| 0.5 * mu * alpha).sum();
        let bulk = 2.0 / row[6];
        close((3.0 * bulk - 2.0 * shear) / (6.0 * bulk + 2.0 * shear), 0.4995, 1e-9, "Poisson's ratio");
    }
    // LS-DYNA: 077_O as ours, 077_H by coefficients.
    for (film, _) in ogdens() {
        let text = written(&film, &Request::new(Target::LsDyna, system)).text;
        let keywords = keywords(&text);
        let terms: Vec<[f64; 2]> = match &keywords[1] {
            (name, cards) if name == "MAT_OGDEN_RUBBER" => {
                cards[1].iter().zip(&cards[2]).map(|(mu, alpha)| [number(mu), number(alpha)]).collect()
            }
            (name, cards) => {
                assert_eq!(name, "MAT_HYPERELASTIC_RUBBER");
                vec![[2.0 * number(&cards[1][0]), 2.0], [-2.0 * number(&cards[1][1]), -2.0]]
            }
        };
        close(uniaxial(&terms, 2.0) * system.stress(), tension(&film, 2.0), 5e-6, "077");
    }
}

/// Moduli of a Prony series relax from the instantaneous stress to that of relaxed film.
#[test]
fn prony_moduli_add_up_to_instantaneous_film() {
    let terms = vec![PronyTerm { share: 0.3, time: 0.01 }, PronyTerm { share: 0.2, time: 2.0 }];
    let mut film = polynomial(Polynomial::neo_hookean(4e5));
    film.viscosity = Some(Viscosity::new(terms).unwrap());
    let text = written(&film, &Request::new(Target::LsDyna, System::TMmS)).text;
    let (_, cards) = &keywords(&text)[1];
    close(2.0 * number(&cards[1][0]), 0.5 * 0.4, 1e-6, "relaxed");
    let prony: Vec<[f64; 2]> = cards[2..].iter().map(|card| [number(&card[0]), number(&card[1])]).collect();
    for ([modulus, decay], expected) in prony.iter().zip([[0.3 * 0.4, 100.0], [0.2 * 0.4, 0.5]]) {
        close(*modulus, expected[0], 1e-12, "modulus");
        close(*decay, expected[1], 1e-12, "decay");
    }
    let text = written(&film, &Request::new(Target::Abaqus, System::TMmS)).text;
    assert!(text.contains("*HYPERELASTIC, NEO HOOKE, MODULI=INSTANTANEOUS\n0.2, "), "{text}");
    assert!(text.contains("*VISCOELASTIC, TIME=PRONY\n0.3, 0.0, 0.01\n0.2, 0.0, 2.0\n"), "{text}");
    let lost = written(&film, &Request::new(Target::OpenRadioss, System::TMmS)).losses;
    assert!(lost.contains(&Loss::ShellRelaxation), "{lost:?}");
}

/// Flow curves along MD, Lankford values and ratios of yield stress.
#[test]
fn plastic_film_keeps_its_flow_and_where_it_can_its_anisotropy() {
    let hill = Hill::from_strain_ratios([0.8, 1.4, 2.1]);
    let film = plastic(hill, FlowRate::Independent);
    let flow = |p: f64| 30e6 - 20e6 * (-8.0 * p).exp();
    let dyna = written(&film, &Request::new(Target::LsDyna, System::TMmS));
    let keywords = keywords(&dyna.text);
    let (_, cards) = &keywords[1];
    let curve = &ls_dyna_curves(&keywords)[&(number(&cards[1][2]) as i64)];
    assert!(curve.len() <= 100);
    for p in [0.0, 0.03, 0.2, 1.0] {
        close(value_at(curve, p) * 1e6, flow(p), 5e-3, "flow stress");
    }
    assert!(dyna.losses.contains(&Loss::Hill));
    let rad = written(&film, &Request::new(Target::OpenRadioss, System::TMmS));
    assert!(!rad.losses.contains(&Loss::Hill));
    // Elastic strain of the largest flow stress changes the volume.
    let Law::Plastic(law) = &film.law else { panic!("no plastic film") };
    let Elastic { young, poisson } = *law.elastic();
    let of_volume = rad.losses.iter().find_map(|loss| match loss {
        Loss::StressOfVolume { uniaxial } => Some(*uniaxial),
        _ => None,
    });
    close(of_volume.expect("the finding"), (1.0 - 2.0 * poisson) * flow(3.0) / young, 1e-3, "change of volume");
    let line = rad.text.lines().skip_while(|line| !line.contains("R00")).nth(1).expect("Lankford values");
    let values: Vec<f64> = (0..3).map(|i| number(line[20 * i..20 * i + 20].trim())).collect();
    values.iter().zip([0.8, 1.4, 2.1]).for_each(|(found, r)| close(*found, r, 1e-12, "Lankford value"));
    let inp = written(&film, &Request::new(Target::Abaqus, System::TMmS)).text;
    let (_, data) = inp.split_once("*POTENTIAL\n").expect("ratios");
    let ratios: Vec<f64> = data.lines().next().unwrap().split(',').map(|field| number(field.trim())).collect();
    let again = Hill::from_stress_ratios([ratios[0], ratios[1], ratios[2]], ratios[3]);
    for angle in [0.0, 0.4, 1.57] {
        close(again.stress_ratio(angle), hill.stress_ratio(angle), 1e-9, "yield");
    }
}

#[test]
fn every_card_says_what_it_is_and_holds_its_columns() {
    let films = [
        fabric(0.3),
        rubber(&Ogden::TRELOAR),
        plastic(Hill::from_strain_ratios([1.0; 3]), FlowRate::Independent),
        film_of(Law::Elastic(Elastic { young: 2e8, poisson: 0.3 })),
    ];
    let mut written_cards = 0;
    for material in &films {
        for target in Target::ALL {
            for system in System::ALL {
                let origin = ["from film.toml -- \u{202e}µ".to_owned()];
                let request = Request { layers: 8, ..Request::new(target, system) };
                let Ok(found) =
                    card::write(&Film { name: "*END -- 'x' <b>\n*END", material, origin: &origin }, &request)
                else {
                    continue;
                };
                written_cards += 1;
                let text = &found.text;
                assert!(text.is_ascii() && text.ends_with('\n') && text.contains(system.name()), "{text}");
                for loss in &found.losses {
                    let begin: String = loss.to_string().chars().take_while(char::is_ascii).collect();
                    assert!(text.replace("- -", "--").contains(&begin), "{loss} in {text}");
                }
                // A name is no keyword.
                assert_eq!(text.lines().filter(|line| *line == "*END").count(), usize::from(target == Target::LsDyna));
                assert!(!text.contains("NaN") && !text.contains("inf"), "{text}");
            }
        }
    }
    assert_eq!(written_cards, (4 + 5 + 4 + 6) * System::ALL.len());
}

#[test]
fn a_target_without_the_law_refuses_it() {
    let gent = HyperelasticLaw::Gent(Hyperelastic { energy: Gent { mu: 4e5, jm: 80.0 }, wrinkling: false });
    let film = film_of(Law::Hyperelastic(gent));
    for target in [Target::LsDyna, Target::OpenRadioss, Target::Abaqus, Target::CalculiX, Target::Febio, Target::Kratos]
    {
        let refused =
            card::write(&Film { name: "a", material: &film, origin: &[] }, &Request::new(target, System::KgMS));
        let begin = format!("{} has no law for", target.name());
        assert!(refused.is_err_and(|refusal| refusal.message.starts_with(&begin)), "{target:?}");
    }
    let table = FlowCurve::new(&[[0.0, 1e7], [0.5, 2e7]]).unwrap();
    assert_eq!(table.initial(), 1e7);
}

/// No solver's card has the heat of what film absorbs, whatever the law: each says so.
#[test]
fn cards_say_that_heat_is_lost() {
    let viscous = Viscosity::new(vec![PronyTerm { share: 0.3, time: 0.01 }]).unwrap();
    let rubber = Material { viscosity: Some(viscous), ..polynomial(Polynomial::neo_hookean(4e5)) };
    let elastic = film_of(Law::Elastic(Elastic { young: 2e8, poisson: 0.3 }));
    for cold in [fabric(0.4), plastic(Hill::from_strain_ratios([1.0; 3]), FlowRate::Independent), rubber, elastic] {
        let film = Material { thermal: Some(Thermal { capacity: 2e6, softening: 8e-3 }), ..cold };
        let mut cards = 0;
        for target in Target::ALL {
            let origin = [];
            let film = Film { name: "LLDPE", material: &film, origin: &origin };
            // Not every target has every law.
            if let Ok(card) = card::write(&film, &Request::new(target, System::TMmS)) {
                assert!(card.losses.contains(&Loss::Heating), "{target:?}: {:?}", card.losses);
                cards += 1;
            }
        }
        assert!(cards >= 2, "{cards} cards");
    }
}
