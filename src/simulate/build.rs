//! From a checked model to an engine that is ready to step.

use nalgebra::{Isometry3, Vector3};

use super::frame_force::HeldSides;
use super::stretch::Coupon;
use super::{Film as FilmTopology, RunError, indent, slow, stretch};
use crate::engine::{Contact, Engine, Film, Impact, Inflation, Loads, Nodes, RigidBody, Section, Surface, ThreadPool};
use crate::mesh::{self, Element, Mesh, Quality};
use crate::model::{Face, Guide, Hold, Impactor, ImpactorShape, Loading, Model};

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
        let mesh = mesh::build(&model.specimen.shape, model.specimen.symmetry.mirrors(), &face.meshing)?;
        let first = nodes.position.len();
        films.push(Film::mount(&mesh, &section(face, mass_scaling), face.height, &mut nodes)?);
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
                let body = falling(impactor, contact.surface(), pose, velocity);
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

/// The membrane section of `face`; `mass_scaling` multiplies its density.
pub fn section(face: &Face, mass_scaling: f64) -> Section {
    Section {
        law: face.material.law.clone(),
        density: face.material.density * mass_scaling,
        thickness: face.material.thickness * f64::from(face.layers),
        md_angle: face.md_angle,
        prestrain: face.prestrain,
        full_integration: face.meshing.element == Element::Quad4Full,
    }
}

/// The surface of an impactor of this shape about its centre of mass.
///
/// # Errors
/// Its mesh cannot be read, or is no closed surface.
pub fn surface(shape: &ImpactorShape) -> Result<Surface, RunError> {
    Ok(match shape {
        ImpactorShape::Sphere { radius } => Surface::sphere(*radius),
        ImpactorShape::Hemisphere { radius, length } => Surface::hemisphere(*radius, *length),
        ImpactorShape::Cylinder { radius, length } => Surface::cylinder(*radius, *length),
        ImpactorShape::Mesh(path) => Surface::closed_mesh(mesh::import::surface(path)?),
    }?)
}

/// The impactor at `pose`, falling at `velocity` (m/s, downward positive).
pub fn falling(impactor: &Impactor, surface: &Surface, pose: Isometry3<f64>, velocity: f64) -> RigidBody {
    match impactor.guide {
        Guide::Z => RigidBody::guided(pose, -velocity, impactor.mass),
        Guide::Free => {
            let inertia = surface.inertia_per_mass() * impactor.mass;
            RigidBody::free(pose, Vector3::new(0.0, 0.0, -velocity), impactor.mass, inertia)
        }
    }
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
    let surface = surface(&impactor.shape)?;
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
