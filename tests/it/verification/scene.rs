//! Engines built without a run, and observers of single steps.

use droptower::engine::{Contact, Energies, Engine, Film, Impact, Jaw, Loads, Nodes, Unobserved, View};
use droptower::mesh::{self, Mesh, MeshError, Side};
use droptower::model::loading;
use droptower::model::{Face, Hold, Impactor, Model, Symmetry};
use droptower::simulate::{rigid_body, section, surface};
use nalgebra::{Isometry3, UnitQuaternion, Vector3};

/// An engine that is stepped by a test.
pub struct Scene {
    pub engine: Engine,
}

impl Scene {
    /// The faces of an impact, whole or a quarter, held at the rim or free, under a body in contact with the first of
    /// them.
    pub fn impact(model: &Model) -> Scene {
        Scene::spinning(model, Vector3::zeros())
    }

    /// The same with a body of angular velocity `spin` (rad/s).
    pub fn spinning(model: &Model, spin: Vector3<f64>) -> Scene {
        let Some(&loading::Impact { velocity, gravity, .. }) = model.loading.impact() else {
            panic!("{} is no impact", model.name)
        };
        let mut nodes = Nodes::default();
        let mut films = vec![];
        let mut offset = vec![];
        let mut between = 0.0;
        for face in &model.faces {
            let mesh = build(model, face).expect("a mesh");
            let first = nodes.position.len();
            films.push(Film::mount(&mesh, &section(face, 1.0), face.height, &mut nodes).expect("a film"));
            for (mirror, held) in mesh.mirrors.iter().zip([[true, false, false], [false, true, false]]) {
                nodes.hold(mirror.iter().map(|n| first + *n as usize), held);
            }
            if model.frame.hold == Hold::All {
                nodes.hold(mesh.rim.iter().map(|n| first + *n as usize), [true; 3]);
            }
            let thickness = face.material.thickness * f64::from(face.layers);
            offset.resize(nodes.position.len(), between + 0.5 * thickness);
            between += thickness;
        }
        let impactor = model.impactor().expect("an impactor");
        let surface = surface(&impactor.shape).expect("a surface");
        let [x, y] = impactor.position;
        let lowest = surface.lowest(&UnitQuaternion::identity());
        let pose = Isometry3::translation(x, y, model.faces[0].height + offset[0] - lowest);
        let impactor = Impactor { velocity: [0.0, 0.0, -velocity], spin: spin.into(), ..impactor.clone() };
        let body = rigid_body(&impactor, &surface, pose);
        let multiplicity = if model.specimen.symmetry == Symmetry::Quarter { 4.0 } else { 1.0 };
        let contact = Contact::new(surface, impactor.friction, multiplicity, offset);
        let loads = Loads { gravity, multiplicity, ..Loads::default() };
        Scene { engine: Engine::new(films, nodes, [Impact::new(body, contact).starting_in_contact(true)], loads) }
    }

    /// The film of a stretch between jaws that part at `velocity` (m/s).
    pub fn stretched(model: &Model, velocity: f64) -> Scene {
        let mesh = build(model, &model.faces[0]).expect("a mesh");
        let mut nodes = Nodes::default();
        let film =
            Film::mount(&mesh, &section(&model.faces[0], 1.0), model.faces[0].height, &mut nodes).expect("a film");
        let jaws = [(Side::XMinus, -0.5), (Side::XPlus, 0.5)].map(|(side, share)| {
            let jaw = Jaw { nodes: mesh.sides[side as usize].clone(), velocity: share * velocity };
            nodes.hold(jaw.nodes.iter().map(|n| *n as usize), [true; 3]);
            jaw.nodes.iter().for_each(|n| nodes.velocity.set(*n as usize, [jaw.velocity, 0.0, 0.0]));
            jaw
        });
        let loads = Loads { jaws: jaws.into(), multiplicity: 1.0, ..Loads::default() };
        Scene { engine: Engine::new(vec![film], nodes, [], loads) }
    }

    /// Advances by one step. Returns the number of elements that failed in it.
    pub fn step(&mut self) -> usize {
        self.engine.step(&mut Unobserved).expect("a step")
    }
}

/// Advances by one step and returns what `read` returns for its state.
pub fn observe_step<T>(engine: &mut Engine, read: impl FnMut(&View<'_>) -> T) -> T {
    engine.read_step(read).expect("a step")
}

/// Positions of all nodes, m.
pub fn positions(nodes: &Nodes) -> Vec<[f64; 3]> {
    nodes.position.iter().collect()
}

/// Sets the position of every node to `to` of its number and position.
pub fn set_positions(nodes: &mut Nodes, mut to: impl FnMut(usize, [f64; 3]) -> [f64; 3]) {
    (0..nodes.position.len()).for_each(|n| nodes.position.set(n, to(n, nodes.position.value_at(n))));
}

/// The film's forces on its nodes.
pub fn forces(film: &mut Film, nodes: &Nodes) -> Vec<Vector3<f64>> {
    let mut nodes = nodes.clone();
    film.add_forces(&mut nodes, 0.0);
    nodes.force.iter().map(Vector3::from).collect()
}

/// −Σ f ⊗ X over the volume: the nominal stresses along x and y of a single element of this thickness (m), with forces on
/// its nodes that were mounted at these `places` (m), Pa.
pub fn nominal(force: &[Vector3<f64>], places: &[[f64; 3]], thickness: f64) -> [f64; 2] {
    let next = |k: usize| places[(k + 1) % places.len()];
    let area = 0.5 * (0..places.len()).map(|k| places[k][0] * next(k)[1] - next(k)[0] * places[k][1]).sum::<f64>();
    [0, 1].map(|axis| -force.iter().zip(places).map(|(f, x)| f[axis] * x[axis]).sum::<f64>() / (area * thickness))
}

/// Positions of the nodes after `time` (s) under `damping` (1/s), and the energies then.
pub fn relaxed(film: Film, nodes: Nodes, damping: f64, time: f64) -> (Vec<[f64; 3]>, Energies) {
    let loads = Loads { damping, ..Loads::default() };
    let mut engine = Engine::new(vec![film], nodes, [], loads);
    while engine.time() < time {
        engine.step(&mut Unobserved).expect("a step");
    }
    observe_step(&mut engine, |view| (positions(view.nodes), view.energies()))
}

/// The mesh of a face.
pub fn build(model: &Model, face: &Face) -> Result<Mesh, MeshError> {
    mesh::build(&model.specimen.shape, model.specimen.symmetry.mirrors(), &face.meshing)
}

/// The film and nodes of a mesh at rest.
pub fn mounted(mesh: &Mesh, face: &Face) -> (Film, Nodes) {
    let mut nodes = Nodes::default();
    let film = Film::mount(mesh, &section(face, 1.0), face.height, &mut nodes).expect("a film");
    (film, nodes)
}
