//! Decks: what interpreters that know the documented fields and nothing of what writes them find in a deck is the test, in all
//! systems of units.

use std::collections::HashMap;
use std::f64::consts::PI;

use super::card;

use card::deck::{Body, Deck, DeckLoss, Face, Shape, Written, stress_free, write};
use card::{Film, Request, System, Target};
use membrane::material::{Elastic, Law, Material};

use super::{fabric, film_of, value_at};

fn elastic() -> Material {
    film_of(Law::Elastic(Elastic { young: 200e6, poisson: 0.4 }))
}

/// Two quadrilaterals and a triangle, held on the left and beside a mirror plane.
fn face(material: &Material, z: f64, angle: f64) -> Face<'_> {
    let mounted: Vec<[f64; 3]> = [[0.0, 0.0], [0.1, 0.0], [0.2, 0.0], [0.0, 0.1], [0.1, 0.1], [0.2, 0.1], [0.3, 0.05]]
        .map(|[x, y]| [x, y, z])
        .into();
    let mut held = vec![[false; 3]; 7];
    held[0] = [true; 3];
    held[3] = [true; 3];
    (0..3).for_each(|node| held[node][1] = true);
    held[6] = [true; 3];
    Face {
        film: Film { name: "film", material, origin: &[] },
        layers: 8,
        stress_free: stress_free(&mounted, angle, [0.1, 0.02]),
        mounted,
        quads: vec![[0, 1, 4, 3], [1, 2, 5, 4]],
        tris: vec![[2, 6, 5]],
        held,
        md_angle: angle,
    }
}

fn deck(material: &Material) -> Deck<'_> {
    Deck {
        title: "*a test, of two faces",
        origin: &[],
        faces: vec![face(material, 0.0, 0.0), face(material, -0.03, 0.3)],
        bodies: vec![Body {
            name: "impactor".into(),
            shape: Shape::Sphere { radius: 0.12 },
            mass: 2.68,
            inertia: [0.0154368; 3],
            position: [0.01, 0.02, 0.120048],
            velocity: [0.0, 0.0, -4.16],
            is_guided: true,
            friction: vec![0.4, 0.3],
        }],
        mirrored: [false, true],
        gravity: 9.81,
        duration: 0.12,
        interval: 1e-4,
        losses: vec![DeckLoss::Bars],
    }
}

fn close(found: f64, expected: f64) {
    assert!((found - expected).abs() <= 2e-6 * expected.abs() + 1e-12, "{found} and {expected}");
}

/// Unit of mass, length and time, written out by hand.
fn units(system: System) -> [f64; 3] {
    match system {
        System::KgMS => [1.0, 1.0, 1.0],
        System::TMmS => [1000.0, 1e-3, 1.0],
        System::GMmMs => [1e-3, 1e-3, 1e-3],
        System::KgMmMs => [1.0, 1e-3, 1e-3],
        System::LbfInS => [4.448_221_615_260_5 / 0.0254, 0.0254, 1.0],
    }
}

fn written(material: &Material, target: Target, system: System) -> Written {
    write(&deck(material), &Request::new(target, system)).unwrap()
}

/// A line with the width of its fields.
type Line<'a> = (usize, &'a str);

/// Keywords of LS-DYNA with their lines, comments left out; fields have ten columns, those of long keywords twenty.
fn keywords(text: &str) -> Vec<(String, Vec<Line<'_>>)> {
    let mut found: Vec<(String, Vec<Line<'_>>)> = vec![];
    let mut width = 10;
    for line in text.lines().filter(|line| !line.starts_with('$')) {
        match line.strip_prefix('*') {
            Some(name) => {
                width = if name.ends_with('+') { 20 } else { 10 };
                found.push((name.trim_end_matches('+').to_owned(), vec![]));
            }
            None => found.last_mut().unwrap().1.push((width, line)),
        }
    }
    found
}

/// The field of a card of LS-DYNA; zero where there is none.
fn field((width, line): Line<'_>, place: usize) -> f64 {
    line.get(place * width..).map_or("", |rest| &rest[..width.min(rest.len())]).trim().parse().unwrap_or(0.0)
}

/// Where moved nodes are at the beginning of the test: places, and motions as node, axis, distance and time of release.
fn check_mounting(places: &HashMap<usize, [f64; 3]>, moved: &HashMap<(usize, usize), f64>, length: f64) {
    for (place, face) in deck(&fabric(0.87)).faces.iter().enumerate() {
        for (node, mounted) in face.mounted.iter().enumerate() {
            let number = 7 * place + node + 1;
            for axis in 0..3 {
                let by = moved.get(&(number, axis)).copied().unwrap_or(0.0);
                let (found, mounted) = ((places[&number][axis] + by) * length, mounted[axis]);
                assert!((found - mounted).abs() < 1e-8, "node {number}, axis {axis}: {found} and {mounted}");
            }
        }
    }
}

#[test]
fn ls_dyna_has_the_test() {
    let film = fabric(0.87);
    for system in System::ALL {
        let deck = written(&film, Target::LsDyna, system);
        let text = &deck.files[0].text;
        let all = keywords(text);
        let [mass, length, time] = units(system);
        let named = |name: &str| {
            all.iter().filter(|(found, _)| found == name).map(|(_, lines)| lines.clone()).collect::<Vec<_>>()
        };
        // The end: mounting, rest and test.
        close(field(named("CONTROL_TERMINATION")[0][0], 0) * time, 0.0105 + 0.12);
        // The body: heading, part, centre and mass, inertia, velocity.
        let part = &named("PART_INERTIA")[0];
        assert_eq!(part[0].1, "impactor");
        close(field(part[2], 3) * mass, 2.68);
        close(field(part[2], 2) * length, 0.120048 + 4.16 * 0.0105);
        close(field(part[3], 0) * mass * length * length, 0.0154368);
        close(field(part[4], 2) * length / time, -4.16);
        // Guided: x and y, and all rotations.
        let rigid = &named("MAT_RIGID")[0];
        assert_eq!([0, 1, 2].map(|place| field(rigid[1], place)), [1.0, 4.0, 7.0]);
        // Thickness, and that of the contacts: half of both is the distance from the mesh of the body.
        let sections = named("SECTION_SHELL");
        close(field(sections[0][1], 0) * length, 96e-6);
        assert_eq!(field(sections[0][0], 1), 9.0);
        for (contact, (offset, friction)) in
            named("CONTACT_AUTOMATIC_NODES_TO_SURFACE").iter().zip([(48e-6, 0.4), (144e-6, 0.3)])
        {
            assert_eq!([2, 3].map(|place| field(contact[0], place)), [3.0, 3.0]);
            close(field(contact[1], 0), friction);
            let half = 0.5 * (field(contact[2], 2) + field(contact[2], 3)) * length;
            close(0.12 - 0.0012 + half, 0.12 + offset);
        }
        // Gravity: none before the test, then all of it.
        let load = &named("LOAD_BODY_Z")[0];
        let curves: HashMap<i64, Vec<[f64; 2]>> = named("DEFINE_CURVE")
            .iter()
            .map(|lines| {
                let points = lines[1..]
                    .iter()
                    .map(|(_, line)| [&line[..20], &line[20..]].map(|text| text.trim().parse().unwrap()));
                (field(lines[0], 0) as i64, points.collect())
            })
            .collect();
        let gravity = &curves[&(field(load[0], 0) as i64)];
        let scale = field(load[0], 1) * length / (time * time);
        close(value_at(gravity, 0.0104 / time) * scale, 0.0);
        close(value_at(gravity, 0.0106 / time) * scale, 9.81);
        // The film: places, and motions that end at the frame.
        let places: HashMap<usize, [f64; 3]> = named("NODE")[..2]
            .iter()
            .flatten()
            .map(|(_, line)| {
                let place = [8, 24, 40].map(|from: usize| line[from..from + 16].trim().parse::<f64>().unwrap());
                (line[..8].trim().parse().unwrap(), place)
            })
            .collect();
        let sets: HashMap<i64, Vec<usize>> = named("SET_NODE_LIST")
            .iter()
            .map(|lines| {
                let nodes =
                    lines[1..].iter().flat_map(|(_, line)| line.split_whitespace()).map(|word| word.parse().unwrap());
                (field(lines[0], 0) as i64, nodes.collect())
            })
            .collect();
        let mut moved = HashMap::new();
        for lines in named("BOUNDARY_PRESCRIBED_MOTION_SET") {
            let value = |place: usize| field(lines[0], place);
            assert_eq!(value(2), 2.0);
            let by = value(4) * value_at(&curves[&(value(3) as i64)], 0.01 / time);
            let death = value(6) * time;
            assert!(death == 0.0 || (death - 0.01).abs() < 1e-9, "{death}");
            for node in &sets[&(value(0) as i64)] {
                assert!(moved.insert((*node, value(1) as usize - 1), by).is_none());
            }
        }
        check_mounting(&places, &moved, length);
        // The fibres of the second face are turned.
        let [first, second] = [0, 1].map(|place| named("MAT_FABRIC_TITLE")[place].clone());
        let vector = |lines: &[Line<'_>]| [3, 4].map(|place| field(lines[4], place));
        assert_eq!(vector(&first), [1.0, 0.0]);
        let [x, y] = vector(&second);
        close(x, 0.3_f64.cos());
        close(y, 0.3_f64.sin());
    }
}

/// Blocks of OpenRadioss with their lines.
fn blocks(text: &str) -> Vec<(String, Vec<&str>)> {
    let mut found: Vec<(String, Vec<&str>)> = vec![];
    for line in text.lines().filter(|line| !line.starts_with('#')) {
        match line.strip_prefix('/') {
            Some(name) => found.push((name.to_owned(), vec![])),
            None => found.last_mut().unwrap().1.push(line),
        }
    }
    found
}

/// The text of columns, from 1 as manuals count them.
fn columns(line: &str, from: usize, to: usize) -> &str {
    line.get(from - 1..).map_or("", |rest| &rest[..(to + 1 - from).min(rest.len())]).trim()
}

fn number(line: &str, from: usize, to: usize) -> f64 {
    columns(line, from, to).parse().unwrap_or(0.0)
}

#[test]
fn openradioss_has_the_test() {
    let film = fabric(0.87);
    for system in System::ALL.into_iter().filter(|system| *system != System::LbfInS) {
        let deck = written(&film, Target::OpenRadioss, system);
        let all = blocks(&deck.files[0].text);
        let [mass, length, time] = units(system);
        let named = |name: &str| -> Vec<Vec<&str>> {
            all.iter().filter(|(found, _)| found.starts_with(name)).map(|(_, lines)| lines.clone()).collect()
        };
        // The body: the mass of its main node and of its shells, whose area is that of a polyhedron.
        let body = &named("RBODY/1")[0];
        let nodes: HashMap<usize, [f64; 3]> = named("NODE")
            .iter()
            .flatten()
            .map(|line| (number(line, 1, 10) as usize, [11, 31, 51].map(|from| number(line, from, from + 19))))
            .collect();
        let area: f64 = named("SH3N/3")[0]
            .iter()
            .map(|line| {
                let [a, b, c] = [11, 21, 31].map(|from| nodes[&(number(line, from, from + 9) as usize)]);
                let (u, v) = ([0, 1, 2].map(|i| b[i] - a[i]), [0, 1, 2].map(|i| c[i] - a[i]));
                let normal = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
                0.5 * normal.iter().map(|n| n * n).sum::<f64>().sqrt()
            })
            .sum();
        let round = 4.0 * PI * 0.1188 * 0.1188;
        assert!((area * length * length / round - 1.0).abs() < 5e-3, "{area}");
        let density = number(named("MAT/LAW1/")[0][1], 1, 20);
        let thickness = number(named("PROP/TYPE1/")[0][3], 21, 40);
        close((number(body[1], 41, 60) + density * thickness * area) * mass, 2.68);
        assert_eq!(columns(body[1], 81, 90), "3");
        let main = number(body[1], 1, 10) as usize;
        close(nodes[&main][2] * length, 0.120048 + 4.16 * 0.0105);
        close(number(named("INIVEL/TRA/1")[0][1], 41, 60) * length / time, -4.16);
        let guide = &named("BCS/1")[0];
        assert_eq!(columns(guide[1], 1, 10), "110 111");
        // Gravity.
        let functions: HashMap<i64, Vec<[f64; 2]>> = all
            .iter()
            .filter_map(|(name, lines)| {
                let function = name.strip_prefix("FUNCT/")?.parse().unwrap();
                let points = lines[1..].iter().map(|line| [number(line, 1, 20), number(line, 21, 40)]);
                Some((function, points.collect()))
            })
            .collect();
        let load = &named("GRAV/1")[0][1];
        assert_eq!(columns(load, 11, 20), "Z");
        let gravity = &functions[&(number(load, 1, 10) as i64)];
        let scale = number(load, 81, 100) * length / (time * time);
        close(value_at(gravity, 0.0104 / time) * scale, 0.0);
        close(value_at(gravity, 0.0106 / time) * scale, -9.81);
        // Contacts at a constant gap, with friction.
        for (contact, (offset, friction)) in named("INTER/TYPE7/").iter().zip([(48e-6, 0.4), (144e-6, 0.3)]) {
            assert_eq!([columns(contact[1], 11, 20), columns(contact[1], 41, 50)], ["3", "1000"]);
            close(number(contact[4], 21, 40), friction);
            close(0.1188 + number(contact[4], 41, 60) * length, 0.12 + offset);
        }
        // The film.
        let property = &named("PROP/TYPE16/1")[0];
        close(number(property[3], 21, 40) * length, 96e-6);
        let turned = &named("PROP/TYPE16/2")[0];
        close(number(turned[4], 21, 40), 0.3_f64.sin());
        let groups: HashMap<i64, Vec<usize>> = all
            .iter()
            .filter_map(|(name, lines)| {
                let group = name.strip_prefix("GRNOD/NODE/")?.parse().unwrap();
                let nodes = lines[1..].iter().flat_map(|line| line.split_whitespace());
                Some((group, nodes.map(|word| word.parse().unwrap()).collect()))
            })
            .collect();
        let mut moved = HashMap::new();
        for motion in named("IMPDISP/") {
            let axis = ["X", "Y", "Z"].iter().position(|name| *name == columns(motion[1], 11, 20)).unwrap();
            let by = number(motion[2], 21, 40) * value_at(&functions[&(number(motion[1], 1, 10) as i64)], 0.01 / time);
            for node in &groups[&(number(motion[1], 41, 50) as i64)] {
                assert!(moved.insert((*node, axis), by).is_none());
            }
        }
        check_mounting(&nodes, &moved, length);
        let engine = &deck.files[1].text;
        let end = engine.lines().skip_while(|line| !line.starts_with("/RUN/")).nth(1).unwrap();
        close(end.parse::<f64>().unwrap() * time, 0.1305);
    }
    let refused = write(&deck(&film), &Request::new(Target::OpenRadioss, System::LbfInS));
    assert_eq!(refused.unwrap_err().message, "OpenRadioss has no name for the units of lbf-in-s");
}

#[test]
fn other_solvers_have_no_decks() {
    let film = elastic();
    for (target, name) in [(Target::CalculiX, "CalculiX"), (Target::Febio, "FEBio")] {
        let refused = write(&deck(&film), &Request::new(target, System::TMmS));
        let message = format!("no decks are written for {name}: for LS-DYNA and OpenRadioss they are");
        assert_eq!(refused.unwrap_err().message, message);
    }
}

#[test]
fn a_deck_says_what_it_lacks_and_film_without_pre_strain_is_not_moved() {
    let film = elastic();
    let mut test = deck(&film);
    test.faces.iter_mut().for_each(|face| face.stress_free = face.mounted.clone());
    let found = write(&test, &Request::new(Target::LsDyna, System::TMmS)).unwrap();
    let text = &found.files[0].text;
    assert!(text.contains("$ lost: the bars of the frame\n") && text.contains("$ no pre-strain"), "{text}");
    assert!(!text.contains("*BOUNDARY_PRESCRIBED_MOTION_SET"));
    assert!(found.losses.contains(&DeckLoss::Bars) && found.losses.contains(&DeckLoss::Part { copies: 2.0 }));
    // A title is no keyword.
    assert!(text.contains("\nfilm *a test, of two faces\n"));
    assert_eq!(keywords(text).iter().filter(|(name, _)| name == "MAT_ELASTIC_TITLE").count(), 2);
}
