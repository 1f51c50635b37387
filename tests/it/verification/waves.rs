//! Transverse impact on a long strip: the waves of J. C. Smith, F. L. McCrackin and H. F. Schiefer, Text. Res. J. 28
//! (1958).
//!
//! In a strip whose nominal stress is E times its engineering strain, waves of stretch run at c = √(E/ρ) over the
//! unstrained film. Behind the first the strain is ε, until a kink follows at c(√(ε(1+ε)) − ε) in space: from it on the
//! strip moves with the impactor, at V = c√(2ε√(ε(1+ε)) − ε²).

use droptower::simulate::{Outcome, Snapshot};

use super::claims::Claims;
use super::tower::{loading_of_1008, run};

/// Half the strip's length, m.
const HALF: f64 = 0.2;
/// Edge of an element, m.
const EDGE: f64 = 5e-4;
/// Pa, kg/m³.
const YOUNG: f64 = 50e6;
const DENSITY: f64 = 915.0;
/// Radius of the impactor, m: its contact is short relative to the travel of the kink.
const RADIUS: f64 = 2e-3;
/// Snapshots until the first wave reaches the held ends.
const SNAPSHOTS: usize = 101;

fn wave_speed() -> f64 {
    (YOUNG / DENSITY).sqrt()
}

/// Impact speed for the strain `strain`, m/s.
fn impact_speed(strain: f64) -> f64 {
    wave_speed() * (2.0 * strain * (strain * (1.0 + strain)).sqrt() - strain * strain).sqrt()
}

/// The strip under an impactor so heavy that its speed is constant, until the first wave reaches the held ends.
fn struck(speed: f64) -> Outcome {
    let changes = [
        format!("specimen.shape={{ rectangle = [{}, {}] }}", 2.0 * HALF, 2.0 * EDGE),
        format!("specimen.mesh.size={EDGE}"),
        format!(
            "specimen.material={{ density = {DENSITY}, thickness = 12e-6, fabric = {{ scale = {{ k1 = 1, ke = 1, ky = 1 }}, absorption = 0, md = {{ curve = [[2.0, {0}]], yield_strains = [0.5, 1.0] }}, td = {{ curve = [[2.0, {0}]], yield_strains = [0.5, 1.0] }}, shear = {{ curve = [[1.0, 1e6]] }} }} }}",
            2.0 * YOUNG
        ),
        "layers={ count = 1, faces = [0], prestrain = { md = 0, td = 0 } }".to_owned(),
        "frame.hold=[\"x-\", \"x+\"]".to_owned(),
        format!("impactor.shape.sphere.radius={RADIUS}"),
        "impactor.mass=1e3".to_owned(),
        "impactor.friction=0".to_owned(),
        format!("loading.impact.velocity={speed}"),
        "loading.impact.gravity=0".to_owned(),
        format!("loading.impact.duration={}", HALF / wave_speed()),
        format!("output={{ frames = {SNAPSHOTS}, sample_rate = 1e6 }}"),
    ];
    run(&loading_of_1008(&changes.iter().map(String::as_str).collect::<Vec<_>>()))
}

/// Strain of each element along the strip, with its stress-free place, m.
fn strains(snapshot: &Snapshot) -> Vec<[f64; 2]> {
    let strains = snapshot.films[0].strains.iter().enumerate();
    strains.map(|(e, s)| [EDGE * (e as f64 + 0.5), f64::from(s[0])]).collect()
}

/// Mean over the part of the strip between two stress-free coordinates.
fn mean_between(snapshot: &Snapshot, [from, to]: [f64; 2]) -> f64 {
    let inside: Vec<f64> = strains(snapshot).iter().filter(|[x, _]| *x > from && *x < to).map(|s| s[1]).collect();
    inside.iter().sum::<f64>() / inside.len() as f64
}

/// Stress-free coordinate at which the strain falls below `level` towards the held end, m.
fn front(snapshot: &Snapshot, level: f64) -> f64 {
    let strains = strains(snapshot);
    let last = strains.iter().rposition(|s| s[1] > level).expect("a strained part");
    let [a, b] = [strains[last], strains[last + 1]];
    a[0] + (a[1] - level) / (a[1] - b[1]) * (b[0] - a[0])
}

/// Where the straight flank behind the kink intersects the plane of the strip, m.
fn kink(snapshot: &Snapshot) -> f64 {
    let deepest = snapshot.films[0].positions.iter().map(|p| f64::from(p[2])).fold(0.0, f64::min);
    let flank: Vec<[f64; 2]> = snapshot.films[0]
        .positions
        .iter()
        .map(|p| [f64::from(p[0]), f64::from(p[2])])
        .filter(|[_, z]| *z > 0.7 * deepest && *z < 0.3 * deepest)
        .collect();
    let count = flank.len() as f64;
    let [x, z] = [0, 1].map(|i| flank.iter().map(|p| p[i]).sum::<f64>() / count);
    let slope = flank.iter().map(|p| (p[0] - x) * (p[1] - z)).sum::<f64>()
        / flank.iter().map(|p| (p[0] - x).powi(2)).sum::<f64>();
    x - z / slope
}

#[test]
fn waves_of_a_strip_are_those_of_smith() {
    let mut claims = Claims::of("transverse impact");
    for strain in [0.02_f64, 0.05, 0.1] {
        let what = |claim: &str| format!("ε {strain}, {claim}");
        let outcome = struck(impact_speed(strain));
        let [early, late] = [2 * SNAPSHOTS / 5, 9 * SNAPSHOTS / 10].map(|f| &outcome.snapshots[f]);
        let time = late.time - early.time;
        let kinks = (strain * (1.0 + strain)).sqrt() - strain;
        // Stress-free film passes the kink at c√(ε/(1+ε)).
        let passed = wave_speed() * (strain / (1.0 + strain)).sqrt() * late.time;
        let behind = mean_between(late, [1.2 * passed, 0.9 * wave_speed() * late.time]);
        claims.near(&what("strain between both fronts"), behind, strain, 3e-2);
        let beside = mean_between(late, [4.0 * RADIUS, 0.8 * passed]);
        claims.near(&what("strain behind the kink"), beside, strain, 3e-2);
        let first = (front(late, 0.5 * strain) - front(early, 0.5 * strain)) / time;
        claims.near(&what("speed of the first front, m/s"), first, wave_speed(), 3e-2);
        let second = (kink(late) - kink(early)) / time;
        claims.near(&what("speed of the kink, m/s"), second, kinks * wave_speed(), 3e-2);
    }
}
