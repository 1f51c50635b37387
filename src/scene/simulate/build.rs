//! From a checked model to an engine that is ready to step.

use super::fault::RunError;
use super::frame::{self, HeldSides};
use super::loading::{self, LoadCase};
use super::mount::{self, BodyMounting, Mounting, Pieces};
use super::outcome::Film as FilmTopology;
use super::springs::{self, SpringStep};
use crate::mesh::{self, Mesh, Quality};
use crate::model::loading::{Inertia, MassScaling};
use crate::model::{Hold, Model};
use membrane::engine::{self, Clamp, Engine, Film, Impact, Loads, Nodes, Springs, ThreadPool};

/// An engine and how its scene was mounted.
pub(super) struct Scene {
    pub(super) engine: Engine,
    pub(super) mounting: Mounting,
}

/// Elements for which one more thread saves more time than its synchronisation costs.
const ELEMENTS_A_THREAD: usize = 400;

/// Builds the scene of `model`; twice where the factor on the mass follows from the time step.
///
/// # Errors
/// Film or impactor cannot be meshed or mounted.
pub(super) fn scene(model: &Model) -> Result<Scene, RunError> {
    let loading = loading::load_case(model);
    let factor = match model.loading.mass_scaling() {
        MassScaling::Given(factor) => return mounted(model, &*loading, factor),
        MassScaling::Unscaled => return mounted(model, &*loading, 1.0),
        MassScaling::Chosen => 1.0,
    };
    let scene = mounted(model, &*loading, factor)?;
    // A factor on the step changes the step alone, not the mass.
    let stable = scene.engine.time_step() / model.solver.step_factor;
    let excess = loading.excess(model.run_time() / stable);
    if excess > 1.0 { mounted(model, &*loading, excess * excess) } else { Ok(scene) }
}

/// The scene with this factor on the film's mass. One sequence: nodes are numbered, and held, in the order in which parts are added.
fn mounted(model: &Model, loading: &dyn LoadCase, mass_scaling: f64) -> Result<Scene, RunError> {
    let mut nodes = Nodes::default();
    let mut films = vec![];
    let mut topologies = vec![];
    let mut added_mass = vec![];
    let mut clamped = vec![];
    let multiplicity = model.specimen.symmetry.copies();
    let (damping, step_factor) = (loading.damping(), model.solver.step_factor);
    let mut loads = Loads { multiplicity, damping, step_factor, ..Loads::default() };
    let mut held = HeldSides::from_model(model);
    let mut crest = frame::Crest::from_model(model);
    let mut springs = vec![];
    for face in &model.faces {
        let mesh = mesh::build(&model.specimen.shape, model.specimen.symmetry.mirrors(), &face.meshing)?;
        let first = nodes.position.len();
        let mut section = mount::section(face, mass_scaling);
        section.air = model.air.map_or(0.0, |air| air.added_mass.0);
        let mut film = Film::mount(&mesh, &section, face.height, &mut nodes)?;
        for (cut, points) in model.specimen.cuts.iter().enumerate() {
            if film.cut(&nodes, points) == 0 {
                let message = format!("a cut passes through no element of face {}", films.len() + 1);
                let hint = "give points on the film, with symmetry on its computed part, further apart than an element";
                return Err(RunError::at_key(&format!("specimen.cuts.{cut}"), message, hint));
            }
        }
        if let Some(step) = model.solver.smallest_step {
            added_mass.push(engine::add_mass(&mut film, &mut nodes, step.0));
        }
        let mut topology = topology(&mesh, model);
        let pieces = (!model.specimen.cuts.is_empty()).then(|| Pieces::new(&film));
        films.push(film);
        mount::mirror(&mut nodes, &mesh, first);
        held.mount(&mesh, first);
        crest.mount(&topology.held, first);
        frame::check_clamp(model, films.len(), &mesh, &topology.held)?;
        clamped.extend(frame::clamped(model, &nodes, &mesh, &topology.held, first));
        match &model.frame.springs {
            // Their ends on the frame are held, and no node is.
            Some(written) => {
                let of = (model, written);
                topology.springs = springs::mount(&mut springs, of, films.len(), &mesh, &topology.held, first)?;
            }
            None => {
                let jaws = loading.hold(&mut nodes, &mesh, first, &model.frame.hold);
                let mirrored: Vec<usize> = mesh.mirrors[0].iter().map(|node| first + *node as usize).collect();
                if pieces.as_ref().is_some_and(|pieces| pieces.are_jaws_parted(&jaws, &mirrored)) {
                    let face = films.len();
                    let message = format!("the cuts part face {face} in two: nothing is stretched between the jaws");
                    let hint = "end the cut further from an edge of the film, or from another cut";
                    return Err(RunError::at_key("specimen.cuts", message, hint));
                }
                loads.jaws.extend(jaws);
            }
        }
        let is_held = model.frame.hold != Hold::None || !loads.jaws.is_empty();
        // Nothing would keep it from falling, also while film settles.
        if is_held && pieces.is_some_and(|pieces| pieces.is_one_free(&nodes, &topology.springs)) {
            let message = format!("the cuts free a piece of face {}, which nothing holds", films.len());
            let hint = "leave a part between the ends of a cut; a hole is one of `specimen.shape.polygon.holes`";
            return Err(RunError::at_key("specimen.cuts", message, hint));
        }
        topologies.push(topology);
    }
    mount::add_cushion(model, &films, &nodes, &mut loads);
    let impacts = loading.apply(&films, &nodes, &mut loads)?;
    let body = |impact: &Impact| BodyMounting {
        start: impact.body.centre().z,
        in_contact: impact.in_contact,
        approach: match (loading.approach(&impact.launched()), impact.is_held()) {
            ([speed, _], true) => [speed, 0.0],
            (approach, _) => approach,
        },
    };
    let bodies = impacts.iter().map(body).collect();
    let energy_scale = impacts.iter().map(|impact| loading.energy_scale(&impact.launched())).sum();
    let springs = model.frame.springs.as_ref().map(|written| Springs::new(springs, written.stiffness.0, multiplicity));
    if let Some(springs) = &springs {
        held.tie(springs)?;
    }
    let mass_scaling = (model.loading.inertia() != Inertia::Dynamic).then_some(mass_scaling);
    let clamp = model.frame.clamp.map(|clamp| {
        let width = clamp.width.map_or(f64::INFINITY, |width| width.0);
        Clamp::new(clamped, &nodes, width, multiplicity)
    });
    // After the impactors, because bodies are numbered in this order and the frame is told by being the last.
    let bars = frame::bars(model, &films)?;
    let engine = Engine::new(films, nodes, impacts.into_iter().chain(bars), loads);
    let engine = with(engine, clamp, Engine::with_clamp);
    let engine = with(engine, springs, Engine::with_springs);
    let spring_step = SpringStep::of_engine(&engine);
    let friction = model.contact.film_friction;
    let engine = with(engine, friction.filter(|_| model.contact.film), Engine::with_film_contact);
    let engine = with(engine, friction.filter(|_| model.contact.itself), Engine::with_self_contact);
    let mounting =
        Mounting { films: topologies, bodies, energy_scale, mass_scaling, added_mass, spring_step, held, crest };
    Ok(Scene { engine, mounting })
}

/// The engine with a `part`, where the scene has it.
fn with<P>(engine: Engine, part: Option<P>, add: fn(Engine, P) -> Engine) -> Engine {
    match part {
        Some(part) => add(engine, part),
        None => engine,
    }
}

/// The thread pool of a run of so many elements: at most the threads of the processor, one where runs are simulated in
/// parallel.
pub(super) fn pool(elements: usize) -> ThreadPool {
    let shared = rayon::current_thread_index().is_some();
    let useful = elements.div_ceil(ELEMENTS_A_THREAD);
    ThreadPool::new(if shared { 1 } else { useful.min(rayon::current_num_threads()) })
}

fn topology(mesh: &Mesh, model: &Model) -> FilmTopology {
    FilmTopology {
        nodes: mesh.nodes.len(),
        quads: mesh.quads.clone(),
        tris: mesh.tris.clone(),
        held: held_edges(mesh, &model.frame.hold),
        springs: vec![],
        mirrored: model.specimen.symmetry.mirrors(),
        quality: Quality::from_mesh(mesh),
    }
}

/// Edges of which both nodes are held.
fn held_edges(mesh: &Mesh, hold: &Hold) -> Vec<[u32; 2]> {
    let held = hold.nodes(mesh);
    let on = |edge: &[u32; 2], nodes: &[u32]| edge.iter().all(|node| nodes.binary_search(node).is_ok());
    mesh::outer_edges(mesh).filter(|edge| held.iter().any(|nodes| on(edge, nodes))).collect()
}
