//! How film and impactor are mounted.

use nalgebra::{Isometry3, Matrix3, Translation3, Unit, UnitQuaternion, Vector3};

use super::fault::RunError;
use super::film::Film as FilmTopology;
use super::frame::Crest;
use super::frame_force::HeldSides;
use super::spring_step::SpringStep;
use super::warning::ImpactorName;
use crate::mesh::{self, Element, Mesh};
use crate::model::{Face, Guide, Hold, Impactor, ImpactorShape, Model, Part};
use membrane::engine::{self, AddedMass, Contact, Film, Freedom, Loads, Nodes, RigidBody, Section, Surface};

/// How the specimen was mounted.
pub(super) struct Mounting {
    /// Topology of the faces.
    pub(super) films: Vec<FilmTopology>,
    /// The impactors.
    pub(super) bodies: Vec<BodyMounting>,
    /// Energy that the run exchanges at least, J.
    pub(super) energy_scale: f64,
    /// Factor on the film's mass; none under a dynamic loading.
    pub(super) mass_scaling: Option<f64>,
    /// Mass added to small elements of each face; empty where none was asked for.
    pub(super) added_mass: Vec<AddedMass>,
    /// What springs of the frame make of the time step, where film hangs on some.
    pub(super) spring_step: Option<SpringStep>,
    /// Sides whose force on the frame is recorded.
    pub(super) held: HeldSides,
    /// The held edge on the crest of the frame's bars.
    pub(super) crest: Crest,
}

/// How an impactor was mounted.
pub(super) struct BodyMounting {
    /// Height of its centre of mass at the start, m.
    pub(super) start: f64,
    /// Whether it starts in contact with the film.
    pub(super) in_contact: bool,
    /// Its speed at the start (m/s, downward) and its downward acceleration (m/s²) before contact.
    pub(super) approach: [f64; 2],
}

/// Depth of film inside an impactor at the start over its size that is round-off.
const OVERLAP: f64 = 1e-9;

/// The membrane section of `face`; `mass_scaling` multiplies its density.
pub fn section(face: &Face, mass_scaling: f64) -> Section {
    Section {
        law: face.material.law.clone(),
        viscosity: face.material.viscosity.clone(),
        rupture: face.material.rupture,
        thermal: face.material.thermal,
        density: face.material.density * mass_scaling,
        thickness: face.material.thickness * f64::from(face.layers),
        md_angle: face.md_angle,
        prestrain: face.prestrain,
        full_integration: face.meshing.element == Element::Quad4Full,
    }
}

/// Adds the air around `films` to `loads`; its mass that moves with them is in their sections.
pub(super) fn add_air(model: &Model, films: &[Film], nodes: &Nodes, loads: &mut Loads) {
    let Some(air) = &model.air else { return };
    let mass: f64 = nodes.mass.iter().sum();
    let own = |(face, film): (&Face, &Film)| {
        let mass: f64 = nodes.mass[film.nodes.clone()].iter().sum();
        let per_area = face.material.density * film.thickness;
        mass * per_area / (per_area + air.added_mass)
    };
    loads.weight_share = model.faces.iter().zip(films).map(own).sum::<f64>() / mass;
    loads.cushion = air.cushion.map(|cushion| {
        let copies = model.specimen.symmetry.copies();
        let between = model.faces[0].height - model.faces[1].height - 0.5 * (films[0].thickness + films[1].thickness);
        let (ambient, density) = (air.pressure, air.density);
        let volume = engine::area(&films[0], nodes) * between;
        engine::Cushion { ambient, density, exponent: cushion.exponent, vent: cushion.vent / copies, volume }
    });
}

/// The surface of an impactor of this shape about its centre of mass.
///
/// # Errors
/// Its mesh cannot be read, or is no closed surface.
pub fn surface(shape: &ImpactorShape) -> Result<Surface, RunError> {
    Ok(match shape {
        ImpactorShape::Sphere { radius } => Surface::sphere(*radius),
        ImpactorShape::Hemisphere { radius, length } | ImpactorShape::Capsule { radius, length } => {
            Surface::capsule(*radius, *length)
        }
        ImpactorShape::Cylinder { radius, length, edge } => Surface::cylinder(*radius, *length, *edge),
        ImpactorShape::Cone { radius, length, edge } => Surface::cone(*radius, *length, *edge),
        ImpactorShape::Box { size, edge } => Surface::cuboid(*size, *edge),
        ImpactorShape::Mesh { path, scale } => {
            let (mut points, triangles) = mesh::import::surface(path)?;
            points.iter_mut().for_each(|point| *point *= *scale);
            Surface::closed_mesh((points, triangles))
        }
        ImpactorShape::Compound(parts) => {
            let place = |part: &Part| Isometry3::new(part.at.into(), part.orientation.into());
            let parts = parts.iter().map(|part| Ok((place(part), surface(&part.shape)?)));
            Surface::compound(parts.collect::<Result<_, RunError>>()?)
        }
    }?)
}

/// The impactor at `pose` with its velocity at the start.
pub fn rigid_body(impactor: &Impactor, surface: &Surface, pose: Isometry3<f64>) -> RigidBody {
    let velocity = Vector3::from(impactor.velocity);
    let freedom = match impactor.guide {
        Guide::Fixed => return RigidBody::prescribed(pose, 0.0),
        Guide::Z => {
            let guided = RigidBody::guided(pose, velocity.z, impactor.mass);
            return guided.with_guide_friction(impactor.guide_friction.clone());
        }
        Guide::Free => Freedom::All,
        Guide::Line(line) => Freedom::Line(Unit::new_normalize(line.into())),
        Guide::Hinge { axis, at } => {
            Freedom::Hinge { axis: Unit::new_normalize(axis.into()), at: Vector3::from(at).into() }
        }
    };
    let homogeneous = || surface.inertia_per_mass() * impactor.mass;
    let inertia = impactor.inertia.map_or_else(homogeneous, |moments| Matrix3::from_diagonal(&moments.into()));
    RigidBody::free(pose, velocity, impactor.mass, inertia).spinning(impactor.spin.into()).with_freedom(freedom)
}

/// Constrains the nodes on mirror planes to stay on them. `first` is the first of all nodes that belongs to `mesh`.
pub(super) fn mirror(nodes: &mut Nodes, mesh: &Mesh, first: usize) {
    for (plane, axes) in mesh.mirrors.iter().zip([[true, false, false], [false, true, false]]) {
        nodes.hold(plane.iter().map(|n| first + *n as usize), axes);
    }
}

/// Clamps the held edges.
pub(super) fn clamp(nodes: &mut Nodes, mesh: &Mesh, first: usize, hold: &Hold) {
    let mut clamp = |edge: &[u32]| nodes.hold(edge.iter().map(|n| first + *n as usize), [true; 3]);
    match hold {
        Hold::All => clamp(&mesh.rim),
        Hold::Sides(sides) => sides.iter().for_each(|side| clamp(&mesh.sides[*side as usize])),
        Hold::None => {}
    }
}

/// Contact and pose of the impactor at this place among those of `model`: at its height, or with its lowest point on
/// the highest point of the first face.
pub(super) fn above_film(
    place: usize,
    model: &Model,
    films: &[Film],
    nodes: &Nodes,
) -> Result<(Contact, Isometry3<f64>), RunError> {
    let impactor = &model.impactors[place];
    let name = || ImpactorName::of_impactor(model, place);
    let surface = surface(&impactor.shape)?;
    let mut offset = vec![0.0; nodes.position.len()];
    // Layers without a gap lie on each other: the impactor meets the first at half its thickness, and each further one
    // beyond all that lie between.
    let mut between = 0.0;
    for film in films {
        offset[film.nodes.clone()].fill(between + 0.5 * film.thickness);
        between += film.thickness;
    }
    let top = films.first().map_or(0.0, |film| {
        let heights = nodes.position.range(film.nodes.clone())[2].iter().copied();
        heights.fold(f64::NEG_INFINITY, f64::max) + 0.5 * film.thickness
    });
    let rotation = UnitQuaternion::new(impactor.orientation.into());
    let [x, y] = impactor.position;
    let z = impactor.height.unwrap_or_else(|| top - surface.lowest(&rotation));
    let pose = Isometry3::from_parts(Translation3::new(x, y, z), rotation);
    let mut contact = Contact::new(surface, impactor.friction, model.specimen.symmetry.copies(), offset);
    if let (Some(friction), Some(first)) = (model.contact.film_friction, films.first()) {
        contact = contact.with_film_friction(friction, first.nodes.len());
    }
    let first = model.faces.first().map_or(0.0, |face| face.height);
    if model.faces.len() > 1 && z < first {
        return Err(RunError::Below { impactor: place, name: name() });
    }
    // Only a place that was written can overlap, and only a body that is free from the start would be thrown out of it:
    // a held one meets film that has moved by then.
    if impactor.height.is_some() && impactor.release == 0.0 {
        let gap = contact.smallest_gap(nodes, &pose);
        if gap < -OVERLAP * contact.surface().size() {
            return Err(RunError::Overlap { impactor: place, name: name(), depth: -gap });
        }
    }
    Ok((contact, pose))
}
