//! How film and impactor are mounted: stresses of pre-strain, pieces into which cuts part a face.

use std::collections::HashMap;

use nalgebra::{Isometry3, Matrix3, Translation3, Unit, UnitQuaternion, Vector2, Vector3};
use serde::{Deserialize, Serialize};

use super::fault::RunError;
use super::frame::{Crest, HeldSides};
use super::outcome::{Film as FilmTopology, FilmSpring};
use super::rows;
use super::springs::SpringStep;
use super::warning::ImpactorName;
use crate::mesh::{self, Element, Mesh};
use crate::model::{Face, Guide, Hinge, Hold, Impactor, ImpactorShape, Model, Part};
use base::number::significant;
use membrane::engine::{self, AddedMass, Contact, Film, Freedom, Jaw, Loads, Nodes, RigidBody, Section, Surface};
use membrane::material::Viscosity;

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
        air: 0.0,
        thickness: face.thickness(),
        md_angle: face.md_angle,
        prestrain: face.prestrain,
        full_integration: face.meshing.element == Element::Quad4Full,
    }
}

/// Adds the air between `films` to `loads`; that which moves with them is in their sections.
pub(super) fn add_cushion(model: &Model, films: &[Film], nodes: &Nodes, loads: &mut Loads) {
    let Some(air) = &model.air else { return };
    loads.cushion = air.cushion.map(|compression| {
        let copies = model.specimen.symmetry.copies();
        let between = model.faces[0].height - model.faces[1].height - 0.5 * (films[0].thickness + films[1].thickness);
        let (ambient, density) = (air.pressure.0, air.density.0);
        let volume = engine::area(&films[0], nodes) * between;
        let vent = air.vent.0 * air.discharge / copies;
        engine::Cushion { ambient, density, exponent: compression.exponent(), vent, volume }
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
        Guide::Hinge(Hinge { axis, at }) => {
            let at = Vector3::from(at.map(|length| length.0)).into();
            Freedom::Hinge { axis: Unit::new_normalize(axis.into()), at }
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
    nodes.hold(hold.nodes(mesh).into_iter().flatten().map(|n| first + *n as usize), [true; 3]);
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
        let message = format!("{} starts below the first of several faces, which is not supported", name());
        let hint = "the faces are stacked below the first: start above it, or mount one face";
        return Err(RunError::at_position(place, message, hint));
    }
    // Only a place that was written can overlap, and only a body that is free from the start would be thrown out of it:
    // a held one meets film that has moved by then.
    if impactor.height.is_some() && impactor.release == 0.0 {
        let gap = contact.smallest_gap(nodes, &pose);
        if gap < -OVERLAP * contact.surface().size() {
            let message = format!("{} starts {} mm inside the film", name(), significant(-1e3 * gap, 3));
            let hint = "change its `position`, or leave out its height";
            return Err(RunError::at_position(place, message, hint));
        }
    }
    Ok((contact, pose))
}

/// Linear interpolation of `K` values onto the times `start + k·step`, while they are added.
#[derive(Serialize, Deserialize)]
pub(super) struct Grid<const K: usize> {
    start: f64,
    step: f64,
    /// Rows that are kept at most.
    most: usize,
    last: Option<Sample<K>>,
    #[serde(with = "rows")]
    pub(super) rows: Vec<[f64; K]>,
}

/// Values at a time, as they were added.
#[derive(Clone, Copy, Serialize, Deserialize)]
struct Sample<const K: usize> {
    time: f64,
    #[serde(with = "rows::one")]
    values: [f64; K],
}

impl<const K: usize> Grid<K> {
    /// A grid of at most so many rows from `start` (s) in steps of `step` (s).
    pub(super) fn new(start: f64, step: f64, most: usize) -> Grid<K> {
        Grid { start, step, most, last: None, rows: vec![] }
    }

    /// Whether it has the same places as the other, whatever its rows.
    pub(super) fn is_like(&self, other: &Grid<K>) -> bool {
        [self.start, self.step] == [other.start, other.step] && self.most == other.most
    }

    /// Whether `time` (s) has reached that of the next row.
    pub(super) fn is_due(&self, time: f64) -> bool {
        self.start + self.rows.len() as f64 * self.step <= time
    }

    /// Adds the values at `time` (s), later than all before.
    pub(super) fn push(&mut self, time: f64, values: [f64; K]) {
        let now = Sample { time, values };
        let Sample { time: before, values: from } = self.last.unwrap_or(now);
        while self.rows.len() < self.most {
            let at = self.start + self.rows.len() as f64 * self.step;
            if at > time {
                break;
            }
            let share = if time > before { ((at - before) / (time - before)).max(0.0) } else { 1.0 };
            self.rows.push(std::array::from_fn(|k| from[k] + share * (values[k] - from[k])));
        }
        self.last = Some(now);
    }
}

/// First Piola–Kirchhoff stress (Pa) along MD and TD of a face that is stretched in all directions by `stretch` beyond
/// its pre-strain; components along MD, TD and its normal. Viscous film has rested.
pub(super) fn of_face(face: &Face, stretch: f64) -> [[f64; 3]; 2] {
    let [md, td] = face.prestrain.map(|prestrain| (1.0 + prestrain) * stretch);
    let stress = face.material.law.virgin_stress([[md, 0.0, 0.0], [0.0, td, 0.0]]);
    let share = face.material.viscosity.as_ref().map_or(1.0, Viscosity::mounted);
    stress.map(|vector| vector.map(|component| share * component))
}

/// Force of the pre-strain of `face` over the length of an edge as mounted with the outward `normal` in the plane of the
/// frame, N/m.
pub(super) fn line_force(face: &Face, normal: &Vector2<f64>) -> Vector2<f64> {
    let [md, td] = face.prestrain.map(|prestrain| 1.0 + prestrain);
    let stress = of_face(face, 1.0);
    let (sin, cos) = face.md_angle.sin_cos();
    let [n1, n2] = [normal.x * cos + normal.y * sin, normal.y * cos - normal.x * sin];
    let [f1, f2] = [0, 1].map(|axis| stress[0][axis] * n1 / td + stress[1][axis] * n2 / md);
    Vector2::new(f1 * cos - f2 * sin, f1 * sin + f2 * cos) * face.thickness()
}

/// The pieces of a face: sets of elements that hold each other by edges, or by two nodes. At one node alone a piece would swing.
pub(super) struct Pieces {
    /// Pieces that each node of the face belongs to, ascending.
    of_node: Vec<Vec<usize>>,
    /// Number of elements, by piece.
    sizes: HashMap<usize, usize>,
    /// The first node of the face among all nodes.
    first: usize,
}

/// Elements in disjoint sets.
struct Sets(Vec<usize>);

impl Sets {
    fn root(&mut self, mut element: usize) -> usize {
        while self.0[element] != element {
            // Halves the way for the next search.
            self.0[element] = self.0[self.0[element]];
            element = self.0[element];
        }
        element
    }

    /// Whether two sets became one.
    fn join(&mut self, one: usize, other: usize) -> bool {
        let [one, other] = [self.root(one), self.root(other)];
        self.0[other] = one;
        one != other
    }
}

impl Pieces {
    /// The pieces of `film`, whose elements on cuts are deleted.
    pub(super) fn new(film: &Film) -> Pieces {
        let first = film.nodes.start;
        let mut elements: Vec<Vec<usize>> = vec![];
        film.for_each_intact(|corners| elements.push(corners.iter().map(|node| *node as usize - first).collect()));
        let mut sets = Sets((0..elements.len()).collect());
        let mut edges: HashMap<[usize; 2], usize> = HashMap::new();
        let mut at_node: Vec<Vec<usize>> = vec![vec![]; film.nodes.len()];
        for (element, corners) in elements.iter().enumerate() {
            for [from, to] in mesh::directed(corners) {
                at_node[from].push(element);
                if let Some(other) = edges.insert([from.min(to), from.max(to)], element) {
                    sets.join(element, other);
                }
            }
        }
        let of_node = loop {
            let of_node: Vec<Vec<usize>> =
                at_node.iter().map(|at| distinct(at, |element| sets.root(element))).collect();
            let mut met: HashMap<[usize; 2], usize> = HashMap::new();
            for pieces in &of_node {
                let pairs = pieces
                    .iter()
                    .enumerate()
                    .flat_map(|(place, one)| pieces[place + 1..].iter().map(move |other| [*one, *other]));
                pairs.for_each(|pair| *met.entry(pair).or_default() += 1);
            }
            let held = met.into_iter().filter(|(_, nodes)| *nodes > 1);
            if !held.fold(false, |joined, ([one, other], _)| sets.join(one, other) || joined) {
                break of_node;
            }
        };
        let mut sizes = HashMap::new();
        (0..elements.len()).for_each(|element| *sizes.entry(sets.root(element)).or_default() += 1);
        Pieces { of_node, sizes, first }
    }

    /// The pieces of these nodes, counted among all nodes; ascending.
    fn of(&self, nodes: impl IntoIterator<Item = usize>) -> Vec<usize> {
        let pieces: Vec<usize> = nodes.into_iter().flat_map(|node| self.of_node[node - self.first].clone()).collect();
        distinct(&pieces, |piece| piece)
    }

    /// Whether a piece of more than one element has no node that is held in all directions, and hangs on none of `springs`. Single
    /// elements that hang on a node are left where a cut runs along the corners of a mesh.
    pub(super) fn is_one_free(&self, nodes: &Nodes, springs: &[FilmSpring]) -> bool {
        let on_springs = springs.iter().flat_map(|spring| spring.nodes).map(|node| self.first + node as usize);
        let own = self.first..self.first + self.of_node.len();
        let held = self.of(own.filter(|node| nodes.is_held(*node)).chain(on_springs));
        self.sizes.iter().any(|(piece, elements)| *elements > 1 && held.binary_search(piece).is_err())
    }

    /// Whether no piece goes from one of these jaws to the other, or of a single one to the mirror plane, whose nodes are `mirrored`.
    pub(super) fn are_jaws_parted(&self, jaws: &[Jaw], mirrored: &[usize]) -> bool {
        let at_jaw = |jaw: &Jaw| self.of(jaw.nodes.iter().map(|node| *node as usize));
        let [one, other] = match jaws {
            [one, other] => [at_jaw(one), at_jaw(other)],
            [one] => [at_jaw(one), self.of(mirrored.iter().copied())],
            _ => return false,
        };
        !one.iter().any(|piece| other.binary_search(piece).is_ok())
    }
}

/// The distinct values of `of`, ascending.
fn distinct(items: &[usize], of: impl FnMut(usize) -> usize) -> Vec<usize> {
    let mut values: Vec<usize> = items.iter().copied().map(of).collect();
    values.sort_unstable();
    values.dedup();
    values
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_straight_line_is_interpolated_exactly() {
        let mut grid = Grid::new(-0.5, 0.25, 7);
        for time in [-0.7, -0.1, 0.0, 0.9, 1.05] {
            grid.push(time, [2.0 * time + 1.0]);
        }
        grid.push(1e300, [0.0]);
        assert_eq!(grid.rows.len(), 7);
        for (k, row) in grid.rows.iter().enumerate() {
            assert!((row[0] - (2.0 * (-0.5 + 0.25 * k as f64) + 1.0)).abs() < 1e-12);
        }
    }
}
