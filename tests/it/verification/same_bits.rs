//! The same bits with any number of threads, lanes and vector instructions.

use droptower::engine::{Engine, Patch, StressFree, ThreadPool, Unobserved, Vectors};
use droptower::lane::Width;
use droptower::material::{LawVisitor, MembraneLaw};
use droptower::mesh::Mesh;
use droptower::model::Model;
use droptower::simulate;
use nalgebra::Point3;
use thorough::thorough;

use super::scene::build;
use super::tower::shipped;

/// Coarse, so that a few hundred steps take film and impactor far: a quarter of 1008 with both of its faces.
fn small() -> Model {
    shipped("drop/1008.toml", &["specimen.mesh.size=20mm"])
}

/// A change that makes film viscous.
const PRONY: &str = "specimen.material.prony=[{ share = 0.3, time = \"1 ms\" }, { share = 0.2, time = \"20 ms\" }]";

/// A change that makes film depend on the rate.
const RATES: &str = "specimen.material=scenarios/materials/lldpe-rates.toml";

/// A change that lets film warm up.
const THERMAL: &str = "specimen.material.thermal={ heat = 2300, softening = 0.009 }";

/// A change that hangs film on springs.
const SPRINGS: &str = "frame.springs={ stiffness = \"5 kN/m\", count = 80, length = \"60 mm\" }";

fn after(model: &Model, pool: ThreadPool, steps: usize) -> Vec<u64> {
    let mut engine: Engine = simulate::engine(model).expect("an engine").with_pool(pool);
    for _ in 0..steps {
        engine.step(&mut Unobserved).expect("a step");
    }
    let state = serde_json::to_value(engine.state()).expect("a state");
    let mut bits = vec![];
    collect(&state, &mut bits);
    bits
}

/// Every number of a state, by its bits.
fn collect(value: &serde_json::Value, bits: &mut Vec<u64>) {
    match value {
        serde_json::Value::Number(number) => bits.extend(number.as_f64().map(f64::to_bits)),
        serde_json::Value::Array(items) => items.iter().for_each(|item| collect(item, bits)),
        serde_json::Value::Object(fields) => fields.values().for_each(|field| collect(field, bits)),
        _ => {}
    }
}

/// Compares one thread without vector instructions with three with the widest, or with each number at each width.
fn a_step_has_the_same_bits(model: Model, steps: usize) {
    let expected = after(&model, ThreadPool::new(1).at_width(Width::Baseline), steps);
    assert!(expected.len() > 300 && expected.iter().any(|bits| f64::from_bits(*bits) < 0.0));
    let widths: Vec<Width> = Width::available().collect();
    let compared: Vec<(usize, Width)> = if thorough() {
        [1, 2, 3].into_iter().flat_map(|threads| widths.iter().map(move |width| (threads, *width))).collect()
    } else {
        widths.last().map(|width| (3, *width)).into_iter().collect()
    };
    for (threads, width) in compared {
        let found = after(&model, ThreadPool::new(threads).at_width(width), steps);
        assert!(found == expected, "{threads} threads, {width:?}");
    }
}

fn golden(case: &str, changes: &[&str]) -> Model {
    shipped(&format!("../tests/golden/{case}/scenario.toml"), changes)
}

/// The drop test 1008 on a mesh of this size (mm).
fn drop_on(size: u32, changes: &[&str]) -> Model {
    shipped("drop/1008.toml", &[&[format!("specimen.mesh.size={size}mm").as_str()], changes].concat())
}

const WHOLE: &str = "specimen.symmetry=none";

thorough::cases!(a_step_has_the_same_bits {
    quarter: small(), 400;
    free_impactor: drop_on(20, &[WHOLE, "impactor.guide=free", "impactor.friction=0.1"]), 400;
    // Fine enough for several ranges of nodes and pieces of the neighbour list, with the second face in reach at once.
    fine: drop_on(5, &[WHOLE, "layers.faces=[0.0, -1e-4]"]), 60;
    film_in_contact: drop_on(5, &[WHOLE, "layers.faces=[0.0, -2e-3]", "contact.film=true", "specimen.damping=50"]), 150;
    triangles: drop_on(20, &["specimen.mesh.element=tri3"]), 400;
    full_integration: drop_on(20, &["specimen.mesh.element=quad4-full", "specimen.damping=50"]), 400;
    by_rate: drop_on(20, &[RATES]), 300;
    biaxial: drop_on(20, &["specimen.material.fabric.biaxial=0.79"]), 400;
    viscous: drop_on(20, &[PRONY, "specimen.rest=1 ms"]), 400;
    // So coarse that there is face contact.
    coarse: drop_on(50, &[]), 1500;
    indentation: golden("indent-disc", &[]), 400;
    warm: drop_on(20, &[THERMAL]), 400;
    springs: drop_on(20, &[SPRINGS]), 400;
    // They meet after 5 ms.
    two_impactors: golden("two-impactors", &["impactor.1.at=1ms", "impactor.1.position=[0.035, 0, 0.08]"]), 500;
    inflation: golden("inflation-square", &[]), 400;
    rubber: golden("inflation-rubber", &[]), 400;
    viscous_inflation: golden("inflation-square", &[PRONY]), 400;
    // Until film under the dart flows.
    plastic: golden("drop-plastic", &[WHOLE]), 900;
    // Until the tear runs.
    tear: golden("stretch-tear", &[]), 1800;
});

/// Elements that share no node, so that each node has the force of one element.
fn apart(mesh: &Mesh) -> Mesh {
    let mut out = Mesh::default();
    for quad in &mesh.quads {
        let first = out.nodes.len() as u32;
        out.nodes.extend(quad.map(|n| mesh.nodes[n as usize]));
        out.quads.push([first, first + 1, first + 2, first + 3]);
    }
    out
}

/// The forces of the elements of `mesh` by the law of `model`.
struct Forces<'a, const L: usize>(&'a Mesh, &'a Model, Width);

impl<const L: usize> LawVisitor for Forces<'_, L> {
    type Output = Vec<[u64; 3]>;

    fn visit<M: MembraneLaw + Clone + Send + Sync + 'static>(self, law: &M) -> Vec<[u64; 3]> {
        let Forces(mesh, model, width) = self;
        let face = &model.faces[0];
        let stress_free = StressFree::new(face.md_angle, face.prestrain);
        let thickness = face.material.thickness * f64::from(face.layers);
        let mut patch = Patch::<_, L>::new(law.clone(), mesh, &stress_free, thickness).expect("a patch");
        if let Some(viscosity) = &face.material.viscosity {
            patch = patch.with_viscosity(viscosity.clone());
        }
        let mut force = Vectors::zero(mesh.nodes.len());
        // Up, then part of the way back: on the curve and off it, flowing and not.
        for share in [1.0, 0.97] {
            let moved =
                |p: &Point3<f64>| [p.x * (1.0 + 0.3 * share), p.y * (1.0 + 0.2 * share * p.x), share * p.x * p.y];
            let mut position = Vectors::default();
            position.extend(mesh.nodes.iter().map(moved));
            patch.add_forces(width, &position, 1e-4, &mut force);
        }
        force.iter().map(|f| f.map(f64::to_bits)).collect()
    }
}

/// Laws beside the fabric, each also of film that wrinkles where it has the key.
const LAWS: [&str; 9] = [
    "elastic = { young = 5e7, poisson = 0.44",
    "hyperelastic = { law = \"neo-hookean\", mu = 4e5",
    "hyperelastic = { law = \"compressible-neo-hookean\", young = 2e6, poisson = 0.3",
    "hyperelastic = { law = \"mooney-rivlin\", c10 = 1.6e5, c01 = 4e4",
    "hyperelastic = { law = \"yeoh\", c10 = 1.8e5, c20 = -2e3, c30 = 50",
    "hyperelastic = { law = \"gent\", mu = 4e5, jm = 90",
    "hyperelastic = { law = \"ogden\", mu = [0.63e6, 1200, -1e4], alpha = [1.3, 5.0, -2.0]",
    "plastic = { young = 2e8, poisson = 0.45, hardening = { voce = { yield = 8e6, saturation = 20e6, rate = 6 } }",
    "plastic = { young = 2e8, poisson = 0.45, hardening = { curve = [[0, 8e6], [0.1, 11e6], [0.5, 20e6]] }",
];

#[test]
fn an_element_has_the_same_force_in_any_number_of_lanes() {
    let with = |change: String| shipped("drop/1008.toml", &["specimen.mesh.size=20mm", &change]);
    let fabric = [RATES, "specimen.material.fabric.biaxial=0.79", PRONY].map(str::to_owned);
    let others = LAWS.iter().flat_map(|law| {
        let ends = if law.starts_with("plastic") { &["}"][..] } else { &["}", ", wrinkling = true }"] };
        ends.iter().map(move |end| format!("specimen.material={{ density = 915, thickness = 12e-6, {law} {end} }}"))
    });
    for model in std::iter::once(small()).chain(fabric.into_iter().chain(others).map(with)) {
        let mesh = apart(&build(&model, &model.faces[0]).expect("a mesh"));
        let law = &model.faces[0].material.law;
        let expected = law.visit(Forces::<1>(&mesh, &model, Width::Baseline));
        assert!(expected.iter().flatten().any(|bits| f64::from_bits(*bits).abs() > 1e-3));
        for width in Width::available() {
            assert!(law.visit(Forces::<1>(&mesh, &model, width)) == expected, "1 lane, {width:?}, {law:?}");
            assert!(law.visit(Forces::<4>(&mesh, &model, width)) == expected, "4 lanes, {width:?}, {law:?}");
            assert!(law.visit(Forces::<8>(&mesh, &model, width)) == expected, "8 lanes, {width:?}, {law:?}");
            assert!(law.visit(Forces::<16>(&mesh, &model, width)) == expected, "16 lanes, {width:?}, {law:?}");
        }
    }
}
