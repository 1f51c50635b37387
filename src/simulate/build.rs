//! From a checked model to an engine that is ready to step.

use nalgebra::{Isometry3, Vector3};

use super::frame_force::HeldSides;
use super::stretch::Coupon;
use super::{Film as FilmTopology, RunError, indent, slow, stretch};
use crate::engine::{Contact, Engine, Film, Impact, Inflation, Loads, Nodes, RigidBody, Surface, ThreadPool};
use crate::mesh::{self, Mesh, Quality};
use crate::model::{Hold, Impactor, ImpactorShape, Loading, Model};

/// An engine and what has to be remembered of how it was set up.
pub(super) struct Scene {
    pub(super) engine: Engine,
    pub(super) mounting: Mounting,
}

/// How the specimen was mounted.
pub(super) struct Mounting {
    pub(super) films: Vec<FilmTopology>,
    /// Height of the impactor's centre of mass at the start, m.
    pub(super) start: f64,
    pub(super) mass_scaling: Option<f64>,
    pub(super) coupon: Coupon,
    pub(super) held: HeldSides,
}

/// Elements for which another thread is worth its part of waiting.
const WORTH_A_THREAD: usize = 400;

/// Sets up the scene; a slow test may be set up twice, first to learn its time step.
pub(super) fn scene(model: &Model) -> Result<Scene, RunError> {
    let asked_for = match model.loading {
        Loading::Impact { .. } => None,
        Loading::Stretch { mass_scaling, .. }
        | Loading::Indent { mass_scaling, .. }
        | Loading::Pressure { mass_scaling, .. } => mass_scaling,
    };
    if let Some(scaling) = asked_for {
        return mounted(model, scaling);
    }
    let scene = mounted(model, 1.0)?;
    // A factor on the step is to change the step alone, not the mass.
    let stable = scene.engine.time_step() / model.solver.step_factor;
    let scaling = slow::mass_scaling(model, model.run_time() / stable);
    if scaling == 1.0 { Ok(scene) } else { mounted(model, scaling) }
}

fn mounted(model: &Model, mass_scaling: f64) -> Result<Scene, RunError> {
    let mut nodes = Nodes::default();
    let mut films = vec![];
    let mut topologies = vec![];
    let multiplicity = model.specimen.symmetry.copies();
    let (damping, step_factor) = (slow::damping(model), model.solver.step_factor);
    let mut loads = Loads { multiplicity, damping, step_factor, ..Loads::default() };
    let coupon = Coupon::of(model);
    let mut held = HeldSides::of(model);
    let scaled = (!matches!(model.loading, Loading::Impact { .. })).then_some(mass_scaling);
    for face in &model.faces {
        let mesh = mesh::build(&model.specimen, face)?;
        let first = nodes.position.len();
        films.push(Film::mount(&mesh, face, mass_scaling, &mut nodes)?);
        mirror(&mut nodes, &mesh, first);
        held.mount(&mesh, first);
        match model.loading {
            Loading::Stretch { velocity, .. } => {
                loads.jaws.extend(stretch::grip(&mut nodes, &mesh, first, velocity, coupon.gauge));
            }
            Loading::Impact { .. } | Loading::Indent { .. } | Loading::Pressure { .. } => {
                clamp(&mut nodes, &mesh, first, &model.frame.hold);
            }
        }
        topologies.push(topology(&mesh, model));
    }
    let mut mounting = Mounting { films: topologies, start: 0.0, mass_scaling: scaled, coupon, held };
    let mut impact = None;
    match model.loading {
        Loading::Impact { velocity, gravity, .. } => {
            loads.gravity = gravity;
            if let Some(impactor) = &model.impactor {
                let (contact, pose) = over_film(impactor, model, &films, &nodes)?;
                let inertia = contact.surface().inertia_per_mass() * impactor.mass;
                let velocity = Vector3::new(0.0, 0.0, -velocity);
                let body = RigidBody::new(pose, velocity, impactor.mass, inertia, impactor.guide);
                mounting.start = body.centre().z;
                impact = Some(Impact { body, contact });
            }
        }
        Loading::Stretch { .. } => {}
        Loading::Indent { velocity, .. } => {
            if let Some(impactor) = &model.impactor {
                let (contact, mut pose) = over_film(impactor, model, &films, &nodes)?;
                pose.translation.vector.z -= indent::way_to_touch(&contact, &pose, &nodes).ok_or(RunError::Missed)?;
                impact = Some(Impact { body: RigidBody::driven(pose, -velocity), contact });
            }
        }
        Loading::Pressure { pressure, ramp, .. } => loads.inflation = Some(Inflation { pressure, ramp }),
    }
    Ok(Scene { engine: Engine::new(films, nodes, impact, loads), mounting })
}

/// The surface of the impactor about its centre of mass.
///
/// # Errors
/// Its mesh cannot be read, or is no closed surface.
fn impactor_surface(impactor: &Impactor) -> Result<Surface, RunError> {
    let triangles = match &impactor.shape {
        ImpactorShape::Mesh(path) => Some(mesh::import::surface(path)?),
        _ => None,
    };
    Ok(Surface::new(&impactor.shape, triangles)?)
}

/// Threads for a run of so many elements: all that there are, unless the run is one of several that share them.
pub(super) fn pool(elements: usize) -> ThreadPool {
    let shared = rayon::current_thread_index().is_some();
    let worth = elements.div_ceil(WORTH_A_THREAD);
    ThreadPool::new(if shared { 1 } else { worth.min(rayon::current_num_threads()) })
}

fn topology(mesh: &Mesh, model: &Model) -> FilmTopology {
    FilmTopology {
        nodes: mesh.nodes.len(),
        quads: mesh.quads.clone(),
        tris: mesh.tris.clone(),
        held: held_edges(mesh, &model.frame.hold),
        mirrored: model.specimen.symmetry.mirrors(),
        quality: Quality::of(mesh),
    }
}

/// Edges of which both nodes are held.
fn held_edges(mesh: &Mesh, hold: &Hold) -> Vec<[u32; 2]> {
    let on = |edge: &[u32; 2], side: &[u32]| edge.iter().all(|node| side.binary_search(node).is_ok());
    let is_held = |edge: &[u32; 2]| match hold {
        Hold::All => true,
        Hold::Sides(sides) => sides.iter().any(|side| on(edge, &mesh.sides[*side as usize])),
        Hold::None => false,
    };
    mesh::outer_edges(mesh).filter(is_held).collect()
}

/// Keeps the nodes on mirror planes on them. `first` is the first of all nodes that belongs to `mesh`.
fn mirror(nodes: &mut Nodes, mesh: &Mesh, first: usize) {
    for (plane, axes) in mesh.mirrors.iter().zip([[true, false, false], [false, true, false]]) {
        nodes.hold(plane.iter().map(|n| first + *n as usize), axes);
    }
}

/// Clamps the held edges.
fn clamp(nodes: &mut Nodes, mesh: &Mesh, first: usize, hold: &Hold) {
    let mut clamp = |edge: &[u32]| nodes.hold(edge.iter().map(|n| first + *n as usize), [true; 3]);
    match hold {
        Hold::All => clamp(&mesh.rim),
        Hold::Sides(sides) => sides.iter().for_each(|side| clamp(&mesh.sides[*side as usize])),
        Hold::None => {}
    }
}

/// The impactor with its lowest point on the highest of the first face.
fn over_film(
    impactor: &Impactor,
    model: &Model,
    films: &[Film],
    nodes: &Nodes,
) -> Result<(Contact, Isometry3<f64>), RunError> {
    let surface = impactor_surface(impactor)?;
    let mut offset = vec![0.0; nodes.position.len()];
    let mut between = 0.0;
    for film in films {
        offset[film.nodes.clone()].fill(between + 0.5 * film.thickness);
        between += film.thickness;
    }
    let top = films.first().map_or(0.0, |film| {
        let heights = nodes.position.range(film.nodes.clone())[2].iter().copied();
        heights.fold(f64::NEG_INFINITY, f64::max) + 0.5 * film.thickness
    });
    let [x, y] = impactor.position;
    let pose = Isometry3::translation(x, y, top - surface.lowest());
    Ok((Contact::new(surface, impactor.friction, model.specimen.symmetry.copies(), offset), pose))
}
