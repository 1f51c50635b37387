//! A strip of wrinkling film under tension and in-plane bending: its wrinkled share in closed form (Stein and Hedgepeth,
//! NASA TN D-813, 1961).

use droptower::engine::{Engine, Loads};
use droptower::material::Material;
use droptower::mesh::Element;

use super::claims::Claims;
use super::scene::{mounted, observe_step, positions, set_positions};
use super::sheet::{self, ELEMENTS, THICKNESS, sheet};

const YOUNG: f64 = 2e9;
const POISSON: f64 = 0.3;
/// Short: its stress is the same all along.
const LENGTH: f64 = 0.005;
const HEIGHT: f64 = 0.1;
/// Elements along and across.
const CELLS: [usize; 2] = [2, 40];
/// Strain of the tensioned edge: small, as in the closed form.
const EDGE_STRAIN: f64 = 1e-3;

/// A strip in equilibrium whose ends are turned so that the strain along it is zero at the height `slack` (share) and
/// [`EDGE_STRAIN`] at the upper edge.
struct Bent {
    /// Tension, N.
    tension: f64,
    /// Moment about the middle, N m.
    moment: f64,
    /// Share of the rows in the middle of the strip without stress along it.
    wrinkled: f64,
}

impl Bent {
    fn new(material: Material, element: Element, slack: f64) -> Bent {
        let mesh = sheet(CELLS, element, 0.0, |[a, b]| [LENGTH * (a - 0.5), HEIGHT * b]);
        let (film, mut nodes) = mounted(&mesh, &sheet::face(material, element, [0.0; 2]));
        let flat = positions(&nodes);
        let strain = |y: f64| EDGE_STRAIN * (y / HEIGHT - slack) / (1.0 - slack);
        let ends = sheet::nodes_where(CELLS, |column, _| column == 0 || column == CELLS[0]);
        nodes.hold(ends.iter().copied(), [true, false, true]);
        let middle = sheet::nodes_where(CELLS, |column, row| column % CELLS[0] == 0 && row == CELLS[1] / 2);
        nodes.hold(middle, [true; 3]);
        set_positions(&mut nodes, |_, [x, y, z]| [x * (1.0 + strain(y)), y, z]);
        let mut engine = Engine::new(vec![film], nodes, [], Loads { multiplicity: 1.0, ..Loads::default() });
        let relaxation = engine.relax(&[true], |_| true).expect("equilibrium");
        assert!(relaxation.is_in_equilibrium(), "{relaxation:?}");
        let end = sheet::nodes_where(CELLS, |column, _| column == CELLS[0]);
        observe_step(&mut engine, |view| {
            let pull = |n: &usize| -view.nodes.force.value_at(*n)[0];
            let tension = end.iter().map(pull).sum();
            let moment = end.iter().map(|n| pull(n) * (flat[*n][1] - 0.5 * HEIGHT)).sum();
            let details = view.films[0].details(&view.nodes.position);
            let row = details.len() / CELLS[1];
            let along = |k: usize| details[k * row + row / 2].stress[0];
            let slack = (0..CELLS[1]).filter(|k| along(*k) < 1e-3 * YOUNG * EDGE_STRAIN).count();
            Bent { tension, moment, wrinkled: slack as f64 / CELLS[1] as f64 }
        })
    }

    /// Moment over tension and height.
    fn eccentricity(&self) -> f64 {
        self.moment / (self.tension * HEIGHT)
    }
}

/// Where film carries no compression, the stress along the strip rises from zero at the edge of the wrinkles, b above the
/// lower edge, to E κ (h − b) at the upper one: P = E t κ (h − b)²/2 and b/h = 3 M/(P h) − 1/2 for M/(P h) from 1/6 to 1/2.
#[test]
fn a_bent_strip_wrinkles_over_the_share_of_stein_and_hedgepeth() {
    let mut claims = Claims::of("bending");
    for element in ELEMENTS {
        for share in thorough::first(1, [0.6, 0.2, 0.4, 0.8]) {
            let bent = Bent::new(sheet::wrinkling(YOUNG, POISSON), element, share);
            let what = |claim: &str| format!("{element:?}, wrinkled over {share}, {claim}");
            let tension = 0.5 * YOUNG * THICKNESS * EDGE_STRAIN * HEIGHT * (1.0 - share);
            claims.near(&what("tension, N"), bent.tension, tension, 1e-2);
            claims.at_most(&what("3 M/(P h) − 1/2 off it"), (3.0 * bent.eccentricity() - 0.5 - share).abs(), 5e-3);
            let claim = what("rows without stress off it, rows");
            claims.at_most(&claim, (bent.wrinkled - share).abs() * CELLS[1] as f64, 1.001);
        }
        // Without wrinkles the moment is that of the section's stiffness; film that carries compression has it always.
        let edge = Bent::new(sheet::wrinkling(YOUNG, POISSON), element, -1.0);
        claims.near(&format!("{element:?}, taut, 6 M/(P h)"), 6.0 * edge.eccentricity(), 1.0 / 3.0, 5e-3);
        let plate = Bent::new(sheet::elastic(YOUNG, POISSON), element, 0.4);
        claims.near(&format!("{element:?}, with compression, 6 M/(P h)"), 6.0 * plate.eccentricity(), 5.0, 5e-3);
    }
}
