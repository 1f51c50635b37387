//! What a step costs: `cargo bench --bench step`, or one section of it:
//! `cargo bench --bench step -- impactors`.
//!
//! Prints the tables of docs/performance.md. Every figure is the median of several measurements in this one process.

use std::hint::black_box;
use std::path::Path;
use std::time::Instant;

use droptower::diagnostic;
use droptower::engine::{Engine, Patch, StressFree, ThreadPool, Unobserved, Vectors};
use droptower::lane::Width;
use droptower::material::{
    CompressibleNeoHookean, Elastic, Gent, Hyperelastic, HyperelasticLaw, Law, LawVisitor, MembraneLaw, Ogden,
    OgdenTerm, Polynomial, TensionField,
};
use droptower::mesh;
use droptower::model::{self, Model};
use droptower::scenario::{Assignment, Document};
use droptower::simulate::{self, RunOptions};

/// Measurements of which the median is taken.
const REPEATS: usize = 5;

/// Prints a section.
type Section = fn(&Machine);

fn main() {
    // The name of one section, which is then run alone.
    let only = std::env::args().skip(1).find(|argument| !argument.starts_with('-'));
    let sections: [(&str, Section); 8] = [
        ("kernel", |_| kernel()),
        ("laws", |_| laws()),
        ("drop", drop_test),
        ("parts", |_| parts()),
        ("sizes", |_| sizes()),
        ("faces", |_| faces()),
        ("impactors", |_| impactors()),
        ("threads", |_| threads()),
    ];
    let is_wanted = |name: &str| only.as_deref().is_none_or(|only| only == name);
    let names = sections.map(|(name, _)| name);
    assert!(names.into_iter().any(is_wanted), "there are the sections {}", names.join(", "));
    let machine = machine();
    for (_, section) in sections.iter().filter(|(name, _)| is_wanted(name)) {
        section(&machine);
    }
}

fn shipped(changes: &[&str]) -> Model {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios/drop/1008.toml");
    let changes: Vec<Assignment> = changes.iter().map(|c| sound(Assignment::from_argument(c))).collect();
    let document = sound(Document::read(&path)).with(&changes);
    let mut model = sound(model::check(&document));
    model.post = None;
    model
}

fn sound<T>(read: Result<T, Vec<diagnostic::Diagnostic>>) -> T {
    read.unwrap_or_else(|mistakes| panic!("{}", diagnostic::render(&mistakes, false)))
}

fn median(mut figures: Vec<f64>) -> f64 {
    figures.sort_by(f64::total_cmp);
    figures[figures.len() / 2]
}

/// Seconds that `work` takes.
fn seconds(work: impl FnOnce()) -> f64 {
    let begin = Instant::now();
    work();
    begin.elapsed().as_secs_f64()
}

/// What the machine gives, one thread.
struct Machine {
    /// Hz while it works.
    clock: f64,
}

fn machine() -> Machine {
    // Three shifts and three exclusive ors that wait for each other, a cycle each on every processor of this century.
    const ROUNDS: u32 = 50_000_000;
    let chain = || {
        let mut x = black_box(88_172_645_463_325_252_u64);
        for _ in 0..ROUNDS {
            x ^= x << 13;
            x ^= x >> 7;
            x ^= x << 17;
        }
        black_box(x);
    };
    let clock = 6.0 * f64::from(ROUNDS) / median((0..REPEATS).map(|_| seconds(chain)).collect());
    println!("## The machine, one thread\n");
    println!("| | |\n|---|---|");
    println!("| clock while at work | {:.2} GHz |", clock * 1e-9);
    println!();
    Machine { clock }
}

/// Forces of one face of 40×40 one-point quads, alone: gather, law, scatter.
fn kernel() {
    let model = shipped(&["specimen.symmetry=none"]);
    println!("## The kernel: forces of 1 600 one-point quads of fabric\n");
    println!("| lanes | vector instructions | ns an element | times the scalar build |\n|---|---|---|---|");
    let scalar = pass::<1>(&model, Width::Baseline);
    println!("| 1 | baseline, element by element | {scalar:.1} | 1 |");
    for width in Width::available() {
        let cost = pass::<8>(&model, width);
        println!("| 8 | {width:?} | {cost:.1} | {:.1} |", scalar / cost);
    }
    println!();
}

/// The same of every law, with the widest instructions.
fn laws() {
    struct Pass<'a>(&'a Model);
    impl LawVisitor for Pass<'_> {
        type Output = f64;

        fn visit<M: MembraneLaw + Clone + Send + Sync + 'static>(self, law: &M) -> f64 {
            pass_of::<_, 8>(law, self.0, Width::best())
        }
    }
    let model = shipped(&["specimen.symmetry=none"]);
    let fabric = model.faces[0].material.law.visit(Pass(&model));
    println!("## The laws: forces of 1 600 one-point quads, {:?}\n", Width::best());
    println!("| law | ns an element | over fabric | wrinkling, ns | over fabric |\n|---|---|---|---|---|");
    println!("| fabric | {fabric:.1} | 1 | | |");
    let elastic = |wrinkling: bool| {
        let elastic = Elastic { young: 1e6, poisson: 0.45 };
        if wrinkling { Law::TensionField(TensionField(elastic)) } else { Law::Elastic(elastic) }
    };
    let polynomial = |energy: Polynomial| {
        move |wrinkling: bool| {
            let energy = energy.clone();
            Law::Hyperelastic(HyperelasticLaw::Polynomial(Hyperelastic { energy, wrinkling }))
        }
    };
    let ogden = |wrinkling: bool| {
        let terms = [(0.63e6, 1.3), (0.0012e6, 5.0), (-0.01e6, -2.0)].map(|(mu, alpha)| OgdenTerm { mu, alpha });
        Law::Hyperelastic(HyperelasticLaw::Ogden(Hyperelastic { energy: Ogden::new(&terms), wrinkling }))
    };
    let gent = |wrinkling: bool| {
        Law::Hyperelastic(HyperelasticLaw::Gent(Hyperelastic { energy: Gent { mu: 4e5, jm: 90.0 }, wrinkling }))
    };
    let compressible = |wrinkling: bool| {
        let energy = CompressibleNeoHookean { young: 2e6, poisson: 0.3 };
        Law::Hyperelastic(HyperelasticLaw::CompressibleNeoHookean(Hyperelastic { energy, wrinkling }))
    };
    let neo_hookean = polynomial(Polynomial::neo_hookean(4e5));
    let mooney_rivlin = polynomial(Polynomial::mooney_rivlin(1.6e5, 4e4));
    let yeoh = polynomial(Polynomial::yeoh([1.8e5, -2e3, 50.0]));
    let all: [(&str, &dyn Fn(bool) -> Law); 7] = [
        ("elastic", &elastic),
        ("neo-Hookean", &neo_hookean),
        ("Mooney–Rivlin", &mooney_rivlin),
        ("Yeoh", &yeoh),
        ("Gent", &gent),
        ("Ogden, three terms", &ogden),
        ("compressible neo-Hookean", &compressible),
    ];
    for (name, law) in all {
        let [taut, wrinkling] = [false, true].map(|wrinkling| law(wrinkling).visit(Pass(&model)));
        println!("| {name} | {taut:.1} | {:.2} | {wrinkling:.1} | {:.2} |", taut / fabric, wrinkling / fabric);
    }
    println!();
    laws_in_steps();
    rupture();
}

/// Film that compares every element with the limit of a rupture criterion of its own, and none reaches it.
fn rupture() {
    println!("| drop test 1008, one thread | ns an element step | times |\n|---|---|---|");
    let model = |changes: &[&str]| shipped(&[&["specimen.symmetry=none"], changes].concat());
    let of = |criterion: &str, limit: &str| {
        let rupture = format!(
            "specimen.material.rupture={{ criterion = \"{criterion}\", limit = {limit}, energy = \"8 kJ/m2\" }}"
        );
        whole(&model(&[&rupture]), 1, Width::best())
    };
    let plain = whole(&model(&[]), 1, Width::best());
    println!("| without a criterion of its own | {plain:.1} | 1 |");
    for (criterion, limit) in [("strain", "50"), ("stress", "\"10 GPa\""), ("energy", "\"10 GJ/m3\"")] {
        let cost = of(criterion, limit);
        println!("| {criterion} | {cost:.1} | {:.2} |", cost / plain);
    }
    println!();
}

fn pass<const L: usize>(model: &Model, width: Width) -> f64 {
    let Law::Fabric(law) = &model.faces[0].material.law else { panic!("a fabric") };
    pass_of::<_, L>(law, model, width)
}

/// Forces of the elements of the first face of `model` with `law`, ns an element.
fn pass_of<M: MembraneLaw + Clone, const L: usize>(law: &M, model: &Model, width: Width) -> f64 {
    let face = &model.faces[0];
    let mesh = mesh::build(&model.specimen.shape, model.specimen.symmetry.mirrors(), &face.meshing).expect("a mesh");
    let stress_free = StressFree::new(face.md_angle, face.prestrain);
    let thickness = face.material.thickness * f64::from(face.layers);
    let mut patch = Patch::<_, L>::new(law.clone(), &mesh, &stress_free, thickness).expect("a patch");
    let mut position = Vectors::default();
    position.extend(mesh.nodes.iter().map(|p| [1.3 * p.x, 1.1 * p.y, 0.4 * p.x * p.y]));
    let mut force = Vectors::zero(mesh.nodes.len());
    let passes = 2_000_000 / mesh.quads.len();
    let mut once = || {
        let pass = |_| patch.add_forces(width, &position, 1e-6, black_box(&mut force));
        seconds(|| (0..passes).for_each(pass)) / (passes * mesh.quads.len()) as f64 * 1e9
    };
    once();
    median((0..REPEATS).map(|_| once()).collect())
}

/// Whole steps of a sheet of 10 000 elements that is pulled at 20 m/s, by its law.
fn laws_in_steps() {
    println!(
        "| sheet of 72 × 143 elements, pulled | ns an element step | over fabric | over its base |\n|---|---|---|---|"
    );
    let elastic = "elastic = { young = \"200 MPa\", poisson = 0.45 }";
    let hyperelastic = |law: &str| format!("hyperelastic = {{ law = {law} }}");
    let neo_hookean = hyperelastic("\"neo-hookean\", mu = \"60 MPa\"");
    let plastic =
        |hardening: &str| format!("plastic = {{ young = \"200 MPa\", poisson = 0.45, hardening = {{ {hardening} }} }}");
    let curve = |factor: f64| {
        let points = [[0.0, 8.0], [0.05, 10.0], [0.2, 12.0], [0.5, 20.0]];
        format!("curve = [{}]", points.map(|[p, stress]| format!("[{p}, \"{} MPa\"]", factor * stress)).join(", "))
    };
    let rates = [[0.1, 1.3], [10.0, 1.8], [1000.0, 2.9]];
    let rates = rates.map(|[rate, factor]| format!("{{ rate = \"{rate} 1/s\", {} }}", curve(factor))).join(", ");
    let voce = "voce = { yield = \"8 MPa\", saturation = \"20 MPa\", rate = 6 }";
    let ogden = hyperelastic("\"ogden\", mu = [\"63 MPa\", \"0.12 MPa\", \"-1 MPa\"], alpha = [1.3, 5.0, -2.0]");
    let fibres = "fabric = { md = { yield = [[0.26, \"8.4 MPa\"], [0.84, \"20 MPa\"]], break = [1.39, \"29.3 MPa\"] }, \
                  td = { yield = [[0.33, \"8 MPa\"], [0.69, \"10 MPa\"]], break = [7.01, \"16.2 MPa\"] }, \
                  shear = { curve = [[0.3, \"4 MPa\"], [1.5, \"8 MPa\"]] }, absorption = 0.89 }";
    let fabric = pulled(fibres);
    println!("| fabric | {fabric:.1} | 1 | |");
    for (name, keys) in [
        ("elastic", elastic),
        ("neo-Hookean", &neo_hookean),
        ("Mooney–Rivlin", &hyperelastic("\"mooney-rivlin\", c10 = \"25 MPa\", c01 = \"5 MPa\"")),
        ("Yeoh", &hyperelastic("\"yeoh\", c10 = \"30 MPa\", c20 = \"-0.1 MPa\", c30 = \"10 kPa\"")),
        ("Ogden, three terms", &ogden),
        ("plastic, table of four points", &plastic(&curve(1.0))),
        ("plastic, Voce", &plastic(voce)),
        ("plastic, tables of three rates", &plastic(&format!("rates = [{rates}]"))),
    ] {
        let cost = pulled(keys);
        println!("| {name} | {cost:.1} | {:.2} | |", cost / fabric);
    }
    let terms = (0..5).map(|k| format!("{{ share = 0.1, time = \"{} ms\" }}", 0.1 * 10_f64.powi(k)));
    let prony = format!("prony = [{}]", terms.collect::<Vec<_>>().join(", "));
    for (name, base) in
        [("fabric", fibres), ("elastic", elastic), ("neo-Hookean", &neo_hookean), ("Ogden, three terms", &ogden)]
    {
        let [plain, viscous] = [base.to_owned(), format!("{base}, {prony}")].map(|keys| pulled(&keys));
        let [over_fabric, over_plain] = [fabric, plain].map(|cost| viscous / cost);
        println!("| {name}, Prony series of five terms | {viscous:.1} | {over_fabric:.2} | {over_plain:.2} |");
    }
    println!();
}

/// ns an element step of a sheet of film with the law that `keys` give, one thread, while it is pulled.
fn pulled(keys: &str) -> f64 {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios/stretch/rubber.toml");
    let material = format!("specimen.material={{ density = \"915 kg/m3\", thickness = \"12 um\", {keys} }}");
    let changes = [&material, "specimen.mesh.size=0.7 mm", "loading.stretch.velocity=20 m/s"];
    let changes: Vec<Assignment> = changes.iter().map(|change| sound(Assignment::from_argument(change))).collect();
    let without = sound(Document::read(&path)).with(&[Assignment::unset("specimen.material", "bench")]);
    let model = sound(model::check(&without.with(&changes)));
    let once = || {
        let mut engine = simulate::engine(&model).expect("an engine").with_pool(ThreadPool::new(1));
        stepping(&mut engine, STEPS)
    };
    median((0..3).map(|_| once()).collect())
}

/// Steps over which a law is measured.
const STEPS: usize = 600;

/// The whole drop test of 40×40×2 elements with everything on.
fn drop_test(machine: &Machine) {
    let model = shipped(&["specimen.symmetry=none"]);
    println!("## Drop test 1008, 40 × 40 × 2 elements: contact, friction, hysteresis, audit, signals\n");
    println!(
        "| threads | vector instructions | ns an element step | cycles | as many at 2.5 GHz, ns |\n|---|---|---|---|---|"
    );
    for width in Width::available() {
        row(1, width, whole(&model, 1, width), machine);
    }
    row(2, Width::best(), whole(&model, 2, Width::best()), machine);
    println!();
}

fn row(threads: usize, width: Width, cost: f64, machine: &Machine) {
    let cycles = cost * 1e-9 * machine.clock;
    println!("| {threads} | {width:?} | {cost:.1} | {cycles:.0} | {:.1} |", cycles / 2.5);
}

/// ns an element step of a whole run.
fn whole(model: &Model, threads: usize, width: Width) -> f64 {
    let once = || {
        let options = RunOptions { pool: Some(ThreadPool::new(threads).at_width(width)), ..RunOptions::default() };
        let outcome = simulate::run_with(model, options, &mut |_| {}).expect("a run");
        let element_steps = outcome.elements as f64 * outcome.steps as f64;
        outcome.wall.as_secs_f64() * 1e9 / element_steps
    };
    median((0..3).map(|_| once()).collect())
}

/// ns an element step of `steps` steps.
fn stepping(engine: &mut Engine, steps: usize) -> f64 {
    let elements = engine.elements();
    let all = seconds(|| {
        for _ in 0..steps {
            engine.step(&mut Unobserved).expect("a step");
        }
    });
    all * 1e9 / (steps * elements) as f64
}

/// What contact, audit and sampling take of the whole drop test: the same number of steps with the film alone, then
/// with contact, then with everything. The kernel has no branch on its state, so film that is not hit costs what film
/// that is does. The quickest of several repeats each: differences would drown in the noise of medians.
fn parts() {
    let model = shipped(&["specimen.symmetry=none"]);
    let mut shares = vec![];
    for _ in 0..REPEATS {
        let pool = || ThreadPool::new(1);
        let options = RunOptions { pool: Some(pool()), ..RunOptions::default() };
        let outcome = simulate::run_with(&model, options, &mut |_| {}).expect("a run");
        let steps = outcome.steps as usize;
        let everything = outcome.wall.as_secs_f64() * 1e9 / (outcome.elements * steps) as f64;
        let with_contact = stepping(&mut simulate::engine(&model).expect("an engine").with_pool(pool()), steps);
        let mut alone = model.clone();
        alone.impactors.clear();
        let film = stepping(&mut simulate::engine(&alone).expect("an engine").with_pool(pool()), steps);
        shares.push([film, with_contact, everything]);
    }
    let quickest = |part: usize| shares.iter().map(|share: &[f64; 3]| share[part]).fold(f64::INFINITY, f64::min);
    let [film, with_contact, everything] = [0, 1, 2].map(quickest);
    println!("## Its parts, one thread\n");
    println!("| | ns an element step | share |\n|---|---|---|");
    let line = |name: &str, cost: f64| println!("| {name} | {cost:.1} | {:.0} % |", 100.0 * cost / everything);
    line("film: forces, nodes, time step", film);
    line("contact", with_contact - film);
    line("energy balance, sampling, snapshots", everything - with_contact);
    line("everything", everything);
    println!();
}

/// The same film from coarse to fine.
fn sizes() {
    println!("## From a thousand to a million elements, one thread\n");
    println!("| elements | ns an element step, with contact |\n|---|---|");
    // A quarter, as the whole would be so coarse that there is face contact.
    for (symmetry, size, steps) in
        [("quarter", "9.1mm", 4000), ("none", "5.66mm", 400), ("none", "1.79mm", 60), ("none", "0.566mm", 20)]
    {
        let model = shipped(&[&format!("specimen.symmetry={symmetry}"), &format!("specimen.mesh.size={size}")]);
        let mut engine = simulate::engine(&model).expect("an engine");
        stepping(&mut engine, steps / 4);
        let cost = median((0..REPEATS).map(|_| stepping(&mut engine, steps)).collect());
        println!("| {} | {cost:.1} |", engine.elements());
    }
    println!();
}

/// Faces that meet each other against faces that meet the impactor alone.
fn faces() {
    println!("## Film on film, one thread\n");
    println!("| scene | elements | without, ns an element step | with, ns | times |\n|---|---|---|---|---|");
    let sixteen: Vec<String> = (0..16).map(|k| format!("\"{:.3} mm\"", -0.012 * f64::from(k))).collect();
    let scenes = [
        ("1008: 2 faces of 8 layers, 30 mm apart", vec![]),
        (
            "16 separate layers of 1008 on each other",
            vec!["layers.count=1".to_owned(), format!("layers.faces=[{}]", sixteen.join(", "))],
        ),
    ];
    for (name, changes) in scenes {
        let with = |film: bool| {
            let mut changes = changes.clone();
            changes.extend([format!("contact.film={film}"), "loading.impact.duration=60ms".to_owned()]);
            shipped(&changes.iter().map(String::as_str).collect::<Vec<_>>())
        };
        let [without, with] = [false, true].map(with);
        let elements = simulate::engine(&with).expect("an engine").elements();
        let [plain, meeting] = [without, with].map(|model| whole(&model, 1, Width::best()));
        println!("| {name} | {elements} | {plain:.1} | {meeting:.1} | {:.2} |", meeting / plain);
    }
    println!();
}

/// The drop test with other impactors of the same size, mass and speed against that with the sphere, run by run in
/// turn.
fn impactors() {
    println!("## Impactors, one thread: 1008 over 40 ms, 40 × 40 × 2 elements\n");
    println!("| impactor | steps | s | times the sphere | µs a step | times the sphere's |\n|---|---|---|---|---|---|");
    let folder = std::env::temp_dir().join(format!("droptower-bench-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder");
    let mesh = |cuts: usize| {
        let path = folder.join(format!("sphere-{cuts}.obj"));
        std::fs::write(&path, sphere_of_triangles(cuts)).expect("a file");
        format!("mesh = '{}'", path.display())
    };
    let shapes = [
        ("sphere", "sphere = { radius = \"120 mm\" }".to_owned()),
        ("hemisphere", "hemisphere = { radius = \"120 mm\" }".to_owned()),
        ("capsule", "capsule = { radius = \"120 mm\", length = \"240 mm\" }".to_owned()),
        ("cylinder", "cylinder = { radius = \"120 mm\", length = \"240 mm\" }".to_owned()),
        ("mesh of 5 120 triangles", mesh(4)),
        ("mesh of 81 920 triangles", mesh(6)),
    ];
    let models = shapes.map(|(name, shape)| {
        let shape = format!("impactor.shape={{ {shape} }}");
        (name, shipped(&["specimen.symmetry=none", "loading.impact.duration=40ms", &shape]))
    });
    let mut runs = vec![vec![]; models.len()];
    // Runs of tens of seconds need fewer measurements.
    for _ in 0..3 {
        for ((_, model), runs) in models.iter().zip(&mut runs) {
            let options = RunOptions { pool: Some(ThreadPool::new(1)), ..RunOptions::default() };
            let outcome = simulate::run_with(model, options, &mut |_| {}).expect("a run");
            runs.push((outcome.wall.as_secs_f64(), outcome.steps));
        }
    }
    let times: Vec<f64> = runs.iter().map(|runs| median(runs.iter().map(|(time, _)| *time).collect())).collect();
    let of_step = |k: usize| times[k] / runs[k][0].1 as f64;
    for (k, (name, _)) in models.iter().enumerate() {
        // Film that a sharp edge stretches takes shorter steps, which are no cost of contact.
        let (time, step) = (times[k] / times[0], of_step(k) / of_step(0));
        println!("| {name} | {} | {:.2} | {time:.2} | {:.0} | {step:.2} |", runs[k][0].1, times[k], 1e6 * of_step(k));
    }
    println!();
    let _ = std::fs::remove_dir_all(&folder);
}

/// A sphere of 120 mm radius as an OBJ file in m.
fn sphere_of_triangles(cuts: usize) -> String {
    let triangles = thorough::sphere_of_triangles(cuts);
    let mut vertices: Vec<[f64; 3]> = triangles.iter().flatten().copied().collect();
    let in_order = |p: &[f64; 3], q: &[f64; 3]| p.partial_cmp(q).expect("numbers");
    vertices.sort_by(in_order);
    vertices.dedup();
    let number = |p: &[f64; 3]| vertices.binary_search_by(|q| in_order(q, p)).expect("a vertex") + 1;
    let faces = triangles.iter().map(|[p, q, r]| format!("f {} {} {}\n", number(p), number(q), number(r)));
    vertices.iter().map(|[x, y, z]| format!("v {} {} {}\n", 0.12 * x, 0.12 * y, 0.12 * z)).chain(faces).collect()
}

/// Two threads against one.
fn threads() {
    println!("## Two threads against one, everything on\n");
    println!("| elements | one thread, ns | two threads, ns | times as fast |\n|---|---|---|---|");
    for (size, duration) in [("10mm", "120ms"), ("6.3mm", "30ms"), ("4mm", "15ms")] {
        let changes = [
            "specimen.symmetry=none",
            &format!("specimen.mesh.size={size}"),
            &format!("loading.impact.duration={duration}"),
        ];
        let model = shipped(&changes);
        let [one, two] = [1, 2].map(|threads| whole(&model, threads, Width::best()));
        let elements = simulate::engine(&model).expect("an engine").elements();
        println!("| {elements} | {one:.1} | {two:.1} | {:.2} |", one / two);
    }
}
