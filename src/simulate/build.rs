//! From a checked model to an engine that is ready to step.

use nalgebra::{Isometry3, Vector3};

use super::{Film as FilmTopology, RunError};
use crate::engine::{Contact, Drive, Engine, Film, Impact, Jaw, Nodes, RigidBody, Surface, Team};
use crate::mesh::{self, Mesh, Quality};
use crate::model::{Hold, Impactor, ImpactorShape, Loading, Model, Shape, Side, Symmetry};

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
    /// Distance of the jaws, m, and stress-free cross-section between them, m².
    pub(super) gauge: f64,
    pub(super) section: f64,
}

/// Elements for which another thread is worth its part of waiting.
const WORTH_A_THREAD: usize = 400;

/// Steps of a slow test above which its film is made heavier.
const STEPS_OF_A_SLOW_TEST: f64 = 200_000.0;

/// Sets up the scene; a slow stretch is set up twice, first to learn its time step.
pub(super) fn scene(model: &Model) -> Result<Scene, RunError> {
    let Loading::Stretch { velocity, until, mass_scaling, .. } = model.loading else {
        return mounted(model, 1.0);
    };
    if let Some(scaling) = mass_scaling {
        return mounted(model, scaling);
    }
    let scene = mounted(model, 1.0)?;
    // A factor on the step is to change the step alone, not the mass.
    let stable = scene.engine.time_step() / model.solver.step_factor;
    let steps = until * scene.mounting.gauge / velocity / stable;
    if steps <= STEPS_OF_A_SLOW_TEST { Ok(scene) } else { mounted(model, (steps / STEPS_OF_A_SLOW_TEST).powi(2)) }
}

fn mounted(model: &Model, mass_scaling: f64) -> Result<Scene, RunError> {
    let mut nodes = Nodes::default();
    let mut films = vec![];
    let mut topologies = vec![];
    let mut jaws = [vec![], vec![]];
    let mut meshes = vec![];
    for face in &model.faces {
        let mesh = mesh::build(&model.specimen, face)?;
        let first = nodes.position.len() as u32;
        films.push(Film::mount(&mesh, face, mass_scaling, &mut nodes)?);
        constrain(&mut nodes, &mesh, first, model);
        for (jaw, side) in jaws.iter_mut().zip([Side::XMinus, Side::XPlus]) {
            jaw.extend(mesh.sides[side as usize].iter().map(|n| first + n));
        }
        topologies.push(topology(&mesh, model.specimen.symmetry));
        meshes.push(mesh);
    }
    let multiplicity = model.specimen.symmetry.copies();
    let (damping, step_factor) = (model.specimen.damping, model.solver.step_factor);
    let mut drive = Drive { multiplicity, damping, step_factor, ..Drive::default() };
    let mut mounting = Mounting { films: topologies, start: 0.0, mass_scaling: None, gauge: 0.0, section: 0.0 };
    let mut impact = None;
    match model.loading {
        Loading::Impact { velocity, gravity, .. } => {
            drive.gravity = gravity;
            if let Some(impactor) = &model.impactor {
                let impactor = placed(impactor, model, &films, &nodes, velocity)?;
                mounting.start = impactor.body.centre().z;
                impact = Some(impactor);
            }
        }
        Loading::Stretch { velocity, .. } => {
            mounting.mass_scaling = Some(mass_scaling);
            (mounting.gauge, mounting.section) = gauge_and_section(model, &meshes);
            drive.jaws = grip(&mut nodes, jaws, velocity, mounting.gauge);
        }
    }
    let team = team(films.iter().map(Film::elements).sum());
    Ok(Scene { engine: Engine::new(films, nodes, impact, drive).worked_on_by(team), mounting })
}

/// Threads for a run of so many elements: all that there are, unless the run is one of several that share them.
fn team(elements: usize) -> Team {
    let shared = rayon::current_thread_index().is_some();
    let worth = elements.div_ceil(WORTH_A_THREAD);
    Team::new(if shared { 1 } else { worth.min(rayon::current_num_threads()) })
}

fn topology(mesh: &Mesh, symmetry: Symmetry) -> FilmTopology {
    FilmTopology {
        nodes: mesh.nodes.len(),
        quads: mesh.quads.clone(),
        tris: mesh.tris.clone(),
        mirrored: symmetry.mirrors(),
        quality: Quality::of(mesh),
    }
}

/// Mirror planes, and for an impact the clamped edges.
fn constrain(nodes: &mut Nodes, mesh: &Mesh, first: u32, model: &Model) {
    let of_all = |list: &[u32]| list.iter().map(|n| (first + n) as usize).collect::<Vec<_>>();
    nodes.hold(of_all(&mesh.mirrors[0]), [true, false, false]);
    nodes.hold(of_all(&mesh.mirrors[1]), [false, true, false]);
    if matches!(model.loading, Loading::Stretch { .. }) {
        return;
    }
    match &model.frame.hold {
        Hold::All => nodes.hold(of_all(&mesh.rim), [true; 3]),
        Hold::Sides(sides) => {
            sides.iter().for_each(|side| nodes.hold(of_all(&mesh.sides[*side as usize]), [true; 3]));
        }
        Hold::None => {}
    }
}

/// The impactor in touch with the first face, moving down at `velocity`.
fn placed(
    impactor: &Impactor,
    model: &Model,
    films: &[Film],
    nodes: &Nodes,
    velocity: f64,
) -> Result<Impact, RunError> {
    let triangles = match &impactor.shape {
        ImpactorShape::Mesh(path) => Some(mesh::import::surface(path)?),
        _ => None,
    };
    let surface = Surface::new(&impactor.shape, triangles)?;
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
    let velocity = Vector3::new(0.0, 0.0, -velocity);
    let inertia = surface.inertia_per_mass() * impactor.mass;
    let body = RigidBody::new(pose, velocity, impactor.mass, inertia, impactor.guide);
    let contact = Contact::new(surface, impactor.friction, model.specimen.symmetry.copies(), offset);
    Ok(Impact { body, contact })
}

/// Distance of the jaws and stress-free cross-section of all faces, symmetry completed.
fn gauge_and_section(model: &Model, meshes: &[Mesh]) -> (f64, f64) {
    let (gauge, width) = match model.specimen.shape {
        Shape::Rectangle { x, y } => (x, y),
        _ => meshes.first().map_or((0.0, 0.0), |mesh| {
            let extent = |axis: usize| {
                let values = || mesh.nodes.iter().map(|p| p[axis]);
                values().fold(f64::NEG_INFINITY, f64::max) - values().fold(f64::INFINITY, f64::min)
            };
            let [x, y] = model.specimen.symmetry.mirrors().map(|m| if m { 2.0 } else { 1.0 });
            (x * extent(0), y * extent(1))
        }),
    };
    let section = model
        .faces
        .iter()
        .map(|face| width * face.material.thickness * f64::from(face.layers) / (1.0 + face.prestrain[1]))
        .sum();
    (gauge, section)
}

/// Clamps the jaws' nodes and gives the film between them the velocity of a uniform stretch, so that no wave runs.
fn grip(nodes: &mut Nodes, jaws: [Vec<u32>; 2], velocity: f64, gauge: f64) -> Vec<Jaw> {
    for n in 0..nodes.position.len() {
        nodes.velocity.add(n, [velocity * nodes.position.at(n)[0] / gauge, 0.0, 0.0]);
    }
    let speeds = [-0.5 * velocity, 0.5 * velocity];
    let grip = |(list, speed): (Vec<u32>, f64)| {
        nodes.hold(list.iter().map(|n| *n as usize), [true; 3]);
        list.iter().for_each(|n| nodes.velocity.set(*n as usize, [speed, 0.0, 0.0]));
        Jaw { nodes: list, velocity: speed }
    };
    jaws.into_iter().zip(speeds).map(grip).filter(|jaw| !jaw.nodes.is_empty()).collect()
}
