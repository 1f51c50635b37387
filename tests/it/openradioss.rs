//! Cards and decks of OpenRadioss: what its starter refuses and its engine takes otherwise, checked on what is written, and the card
//! of test 1008 beside the one that ran there (`data/openradioss`).

use std::collections::BTreeMap;
use std::fs;
use std::path::PathBuf;

use crate::workbench::{data, droptower, error, printed, root};

/// A block: its first line without the stroke, and its lines of fields below the names that the comment above them gives.
struct Block {
    keyword: String,
    lines: Vec<(String, String)>,
}

impl Block {
    /// Fields of all named lines: a name and the text of the ten or twenty columns that end where the name does.
    fn fields(&self) -> Vec<(String, String)> {
        let mut found = vec![];
        for (names, line) in self.lines.iter().filter(|(names, _)| !names.is_empty()) {
            let mut from = 0;
            for (end, _) in names.match_indices(|c: char| !c.is_whitespace()).filter(|(at, _)| ends_word(names, *at)) {
                let name = names[..=end].split_whitespace().last().unwrap_or_default().to_owned();
                let end = (end + 1).next_multiple_of(10);
                let begin = from.max(end.saturating_sub(20)).min(line.len());
                let text = &line[begin..end.min(line.len())];
                found.push((name.to_uppercase(), text.trim().to_owned()));
                from = end;
            }
        }
        found
    }

    fn field(&self, name: &str) -> f64 {
        let fields = self.fields();
        let (_, text) = fields
            .iter()
            .find(|(own, _)| own.eq_ignore_ascii_case(name))
            .unwrap_or_else(|| panic!("{name} in {}", self.keyword));
        text.parse().unwrap_or_else(|_| panic!("{name} of {} is {text:?}", self.keyword))
    }

    /// Numbers of all lines without names.
    fn rows(&self) -> Vec<Vec<f64>> {
        // Points of functions and places of nodes, behind their numbers, fill their twenty columns.
        let first = match self.keyword.split('/').next() {
            Some("FUNCT") => 20,
            Some("NODE") => 10,
            _ => usize::MAX,
        };
        let numbers = |line: &str| {
            let (first, rest) = line.split_at(first.min(line.len()));
            let rest = (0..rest.len()).step_by(20).map(|from| &rest[from..(from + 20).min(rest.len())]);
            let fields = std::iter::once(first).chain(rest);
            fields.flat_map(str::split_whitespace).map(|word| word.parse().unwrap_or(f64::NAN)).collect()
        };
        self.lines.iter().map(|(_, line)| numbers(line)).collect()
    }
}

fn ends_word(names: &str, at: usize) -> bool {
    names[at + 1..].chars().next().is_none_or(char::is_whitespace)
}

/// The blocks of a file, each with its number of order where several have one keyword.
fn blocks(text: &str) -> Vec<Block> {
    /// Keywords without a title in the line below.
    const UNTITLED: [&str; 5] = ["NODE", "SHELL", "SH3N", "BEGIN", "END"];
    let mut found: Vec<Block> = vec![];
    let (mut names, mut awaits_title) = (String::new(), false);
    for line in text.lines() {
        if let Some(keyword) = line.strip_prefix('/') {
            awaits_title = !UNTITLED.contains(&keyword.split('/').next().unwrap_or_default());
            found.push(Block { keyword: keyword.to_owned(), lines: vec![] });
            names.clear();
        } else if let Some(comment) = line.strip_prefix('#') {
            names = format!(" {comment}");
        } else if std::mem::take(&mut awaits_title) {
        } else if let Some(block) = found.last_mut() {
            block.lines.push((std::mem::take(&mut names), line.to_owned()));
        }
    }
    found
}

fn named<'a>(all: &'a [Block], prefix: &str) -> impl Iterator<Item = &'a Block> {
    let prefix = prefix.to_owned();
    all.iter().filter(move |block| block.keyword.starts_with(&prefix))
}

/// Fields that may be zero, since zero means zero or nothing is lost by the default: by block, with all that it has.
const MAY_BE_ZERO: &[(&str, &str)] = &[
    // No bending by compression, no damping, no friction between fibres, no sensor.
    ("MAT/LAW58", "B1 B2 ALPHAT DF DS GFROT SENSOR ZEROSTRESS FCT_ID4 FCT_ID5 FCT_ID6"),
    ("MAT/LAW19", "A_R ZEROSTRESS FSCALE_POR SENSOR NU12"),
    // No cut of stress, the J of old versions, no bulk function, no relaxation, the first form; terms that are none.
    ("MAT/LAW42", "SIGMA_CUT J FUNIDBULK M IFORM MU_* ALPHA_* G_* TAU_*"),
    // No filter, no kinematic hardening, no decay of the modulus; quasi-static curves.
    ("MAT/LAW36", "F_SMOOTH C_HARD F_CUT FCT_IDP FCT_IDE EINF CE EPS_DOT_* FUNCT_ID_* FSCALE_*"),
    ("MAT/LAW43", "FCT_IDE EINF CE C_HARD F_CUT F_SMOOTH EPS_DOT"),
    ("MAT/LAW1", ""),
    // Hourglass of other elements, the membrane damping of the law, no rotation about the normal; MD along an axis.
    ("PROP/TYPE16", "Hm Hf Hr Dm Vx Vy Vz Skew_ID Ipos Ip Phi_i Z_i"),
    ("PROP/TYPE9", "Idrill Hm Hf Hr Dm Iskew Vx Vy Vz Phi Ip"),
    ("PROP/TYPE1", "Idrill Hm Hf Hr Dm"),
    // No heat, nothing deleted, no curvature, no added refinement; no limits of gap and penetration, no least stiffness or step.
    (
        "INTER/TYPE7",
        "Ithe Ibag Idel Icurv Iadm Gap_max Fpenmax Itied Stmin Percent_mesh_size dtmin Irem_i2 Fric Tstart Tstop IBC Inacti Bumult \
         Ifric Ifiltr Xfreq sens_ID fct_IDF fric_ID",
    ),
];

/// The rules of OpenRadioss for a card or a deck.
fn check(text: &str, what: &str) {
    let all = blocks(text);
    let curves: BTreeMap<i64, Vec<Vec<f64>>> =
        named(&all, "FUNCT/").map(|block| (block.keyword[6..].parse().expect("a number"), block.rows())).collect();
    for (number, points) in &curves {
        assert!(points.len() >= 2, "{what}: /FUNCT/{number} has {} points", points.len());
        assert!(points.windows(2).all(|ends| ends[0][0] < ends[1][0]), "{what}: abscissas of /FUNCT/{number}");
        assert!(points.iter().flatten().all(|value| value.is_finite()), "{what}: /FUNCT/{number}");
    }
    let mut seen = 0;
    for block in &all {
        let Some((kind, free)) = MAY_BE_ZERO.iter().find(|(kind, _)| block.keyword.starts_with(&format!("{kind}/")))
        else {
            continue;
        };
        seen += 1;
        let free: Vec<&str> = free.split_whitespace().collect();
        for (name, field) in block.fields() {
            let is_free = free.iter().any(|one| match one.strip_suffix('*') {
                Some(stem) => name.starts_with(stem),
                None => name.eq_ignore_ascii_case(one),
            });
            let is_stated = field.parse::<f64>().is_ok_and(|value| value != 0.0);
            assert!(is_free || is_stated, "{what}: {name} of /{kind} is {field:?}, which is a default");
        }
    }
    assert!(seen > 0, "{what}: no material");
    for law in named(&all, "MAT/LAW58/") {
        check_fabric(law, &curves, what);
    }
    for law in named(&all, "MAT/LAW43/") {
        assert_eq!(law.field("I_YIELD0"), 1.0, "{what}: the curve is that along MD");
    }
    for contact in named(&all, "INTER/TYPE7/") {
        assert_eq!(["Iform", "Istf", "Igap"].map(|name| contact.field(name)), [2.0, 4.0, 1000.0], "{what}");
        check_gap(contact, &all, what);
    }
}

fn check_fabric(law: &Block, curves: &BTreeMap<i64, Vec<Vec<f64>>>, what: &str) {
    let curve = |name: &str| curves.get(&(law.field(name) as i64));
    assert!([law.field("S1"), law.field("S2")].iter().all(|crimp| (1e-6..1e-3).contains(crimp)), "{what}: crimp");
    for (up, down) in [("FCT_ID1", "FCT_ID4"), ("FCT_ID2", "FCT_ID5"), ("FCT_ID3", "FCT_ID6")] {
        let loading = curve(up).unwrap_or_else(|| panic!("{what}: {up}"));
        for points in [Some(loading), curve(down)].into_iter().flatten() {
            let rises = points.windows(2).all(|ends| ends[0][1] < ends[1][1]);
            assert!(rises, "{what}: {up} has a piece that does not rise");
            if up == "FCT_ID3" {
                let mirrored = points.iter().rev().flatten().map(|value| -value);
                let is_odd = |(a, b): (f64, &f64)| (a - b).abs() <= 1e-9 * b.abs();
                assert!(mirrored.zip(points.iter().flatten()).all(is_odd), "{what}: shear is not odd");
            } else {
                assert_eq!(points[0], [0.0, 0.0], "{what}: {up}");
            }
        }
        let Some(unloading) = curve(down) else { continue };
        // The end of unloading is a point of loading, and unloading lies below until there.
        let top = unloading.last().expect("points");
        assert!(top[0] > 0.0 && loading.contains(top), "{what}: {down} does not meet {up}");
        let at = |x: f64| {
            let place = loading.partition_point(|point| point[0] < x).clamp(1, loading.len() - 1);
            let (a, b) = (&loading[place - 1], &loading[place]);
            a[1] + (b[1] - a[1]) * (x - a[0]) / (b[0] - a[0])
        };
        let below = unloading.iter().filter(|point| point[0] > 0.0 && point[0] < top[0]);
        let is_below = below.clone().count() > 0 && below.clone().all(|point| point[1] < at(point[0]));
        assert!(is_below, "{what}: {down} crosses {up}");
    }
}

/// The gap is less than half of the shortest edge of the surface, which is no less than a tenth of the film's.
fn check_gap(contact: &Block, all: &[Block], what: &str) {
    let nodes: BTreeMap<i64, [f64; 3]> =
        named(all, "NODE").flat_map(Block::rows).map(|row| (row[0] as i64, [row[1], row[2], row[3]])).collect();
    let shortest = |elements: Vec<Vec<f64>>| {
        let length = |a: f64, b: f64| {
            let [a, b] = [a, b].map(|node| nodes[&(node as i64)]);
            (0..3).map(|axis| (a[axis] - b[axis]).powi(2)).sum::<f64>().sqrt()
        };
        let edges = elements.iter().flat_map(|corners| {
            let corners = &corners[1..];
            (0..corners.len()).map(move |place| length(corners[place], corners[(place + 1) % corners.len()]))
        });
        edges.fold(f64::INFINITY, f64::min)
    };
    let of = |part: &str| {
        ["SHELL", "SH3N"].into_iter().flat_map(|kind| named_exactly(all, &format!("{kind}/{part}"))).collect()
    };
    let surface = shortest(of(&(contact.field("surf_id") as i64).to_string()));
    let film = shortest(of(&(contact.field("grnod_id") as i64).to_string()));
    let gap = contact.field("GAPmin");
    assert!(2.0 * gap < surface, "{what}: a gap of {gap} over edges of {surface}");
    assert!(surface >= 0.099 * film, "{what}: edges of {surface} under film of {film}");
}

fn named_exactly(all: &[Block], keyword: &str) -> Vec<Vec<f64>> {
    all.iter().filter(|block| block.keyword == keyword).flat_map(Block::rows).collect()
}

/// Every law that can be written, in all systems of units.
#[test]
fn cards_follow_the_rules_of_openradioss() {
    let bench = tempfile::tempdir().expect("a folder");
    let run = |arguments: &[&str]| droptower(bench.path(), arguments);
    let mut films: Vec<PathBuf> =
        ["1008", "plastic"].map(|name| root().join(format!("scenarios/drop/{name}.toml"))).into();
    films.push(root().join("scenarios/materials/aluminium.toml"));
    films.push(root().join("scenarios/materials/woven-polypropylene.toml"));
    for law in ["elastic", "neo-hookean", "mooney-rivlin", "ogden", "plastic", "viscous"] {
        let name = format!("{law}.toml");
        if run(&["new", "material", law, &name]).status.success() {
            films.push(bench.path().join(name));
        }
    }
    assert!(films.len() > 8, "{films:?}");
    for film in &films {
        let film = film.to_str().expect("UTF-8");
        for units in ["kg-m-s", "t-mm-s", "g-mm-ms", "kg-mm-ms", "lbf-in-s"] {
            // Of a strain among the points of the curves, too.
            let from: &[&[&str]] = match units {
                "t-mm-s" => &[&[], &["--unloading-from", "0.69"], &["--unloading-from", "0.1"]],
                _ => &[&[]],
            };
            for more in from {
                let card =
                    ["export", "card", film, "--for", "openradioss", "--units", units, "-o", "film.rad", "--force"];
                let written = run(&[&card[..], *more].concat());
                assert!(written.status.success(), "{film}: {}", error(&written));
                let text = fs::read_to_string(bench.path().join("film.rad")).expect("the card");
                check(&text, &format!("{film} in {units}"));
            }
        }
    }
}

/// Every scenario here that can be written.
#[test]
fn decks_follow_the_rules_of_openradioss() {
    let bench = tempfile::tempdir().expect("a folder");
    let mut decks = 0;
    let own = ["rubber", "elastic"].map(|name| data(&format!("openradioss/{name}.toml")));
    let folder = bench.path().join("films");
    fs::create_dir(&folder).expect("a folder");
    for law in ["elastic", "neo-hookean"] {
        printed(&droptower(&folder, &["new", "material", law, &format!("{law}.toml")]));
    }
    let all = glob::glob(&format!("{}/scenarios/**/*.toml", root().display())).expect("a pattern");
    let mut all: Vec<PathBuf> = all.flatten().collect();
    for scenario in own {
        let here = bench.path().join(scenario.file_name().expect("a name"));
        fs::copy(&scenario, &here).expect("copied");
        all.push(here);
    }
    for scenario in all {
        let path = scenario.to_str().expect("UTF-8");
        let arguments = ["export", "deck", path, "--for", "openradioss", "-o", "deck", "--force"];
        if droptower(bench.path(), &arguments).status.success() {
            decks += 1;
            check(&fs::read_to_string(bench.path().join("deck/film_0000.rad")).expect("the deck"), path);
        }
    }
    assert!(decks >= 15, "{decks} decks");
}

/// Line by line, numbers within 1e-9.
#[test]
fn the_deck_of_1008_is_the_one_that_ran() {
    let bench = tempfile::tempdir().expect("a folder");
    let scenario = root().join("scenarios/drop/1008.toml");
    let arguments = ["export", "deck", scenario.to_str().expect("UTF-8"), "--for", "openradioss", "-o", "deck"];
    printed(&droptower(bench.path(), &arguments));
    for file in ["film_0000.rad", "film_0001.rad"] {
        let found = fs::read_to_string(bench.path().join("deck").join(file)).expect("the deck");
        let ran = fs::read_to_string(data(&format!("openradioss/1008/{file}"))).expect("the deck that ran");
        let [found, ran] =
            [&found, &ran].map(|text| text.lines().filter(|line| !line.starts_with('#')).collect::<Vec<_>>());
        assert_eq!(found.len(), ran.len(), "{file}");
        for (found, ran) in found.iter().zip(&ran) {
            assert!(found == ran || is_near(found, ran), "{found} in place of {ran}");
        }
    }
}

/// Whether two lines have the same numbers in their fields of twenty columns, behind a number of ten where they begin with one.
fn is_near(found: &str, expected: &str) -> bool {
    let fields = |line: &str| -> Option<Vec<f64>> {
        let (first, rest) = line.split_at((line.len() % 20).min(line.len()));
        let rest = (0..rest.len()).step_by(20).map(|from| &rest[from..(from + 20).min(rest.len())]);
        std::iter::once(first)
            .filter(|first| !first.is_empty())
            .chain(rest)
            .map(|field| field.trim().parse().ok())
            .collect()
    };
    let (Some(found), Some(expected)) = (fields(found), fields(expected)) else { return false };
    found.len() == expected.len() && found.iter().zip(&expected).all(|(a, b)| (a - b).abs() <= 1e-9 * b.abs().max(1e-9))
}
