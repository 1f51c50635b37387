//! Engines set up by hand, and a look at every step.

use droptower::engine::{Contact, Energies, Engine, Fault, Film, Impact, Jaw, Loads, Nodes, Observer, View};
use droptower::mesh::{self, Mesh, MeshError, Side};
use droptower::model::{Face, Hold, Loading, Model, Symmetry};
use droptower::simulate::{falling, section, surface};
use nalgebra::{Isometry3, Vector3};

/// An engine that is stepped by a test.
pub struct Scene {
    pub engine: Engine,
}

impl Scene {
    /// The faces of an impact, whole or a quarter, held at the rim or not at all, under a body in touch with the
    /// first of them.
    pub fn struck(model: &Model) -> Scene {
        Scene::spinning(model, Vector3::zeros())
    }

    /// The same with the body turning at `spin` (rad/s).
    pub fn spinning(model: &Model, spin: Vector3<f64>) -> Scene {
        let Loading::Impact { velocity, gravity, .. } = model.loading else { panic!("{} is no impact", model.name) };
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
        let impactor = model.impactor.as_ref().expect("an impactor");
        let surface = surface(&impactor.shape).expect("a surface");
        let [x, y] = impactor.position;
        let pose = Isometry3::translation(x, y, model.faces[0].height + offset[0] - surface.lowest());
        let mut body = falling(impactor, &surface, pose, velocity);
        body.spin = spin;
        let copies = if model.specimen.symmetry == Symmetry::Quarter { 4.0 } else { 1.0 };
        let contact = Contact::new(surface, impactor.friction, copies, offset);
        let loads = Loads { gravity, multiplicity: copies, ..Loads::default() };
        Scene { engine: Engine::new(films, nodes, Some(Impact { body, contact }), loads) }
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
        Scene { engine: Engine::new(vec![film], nodes, None, loads) }
    }

    /// Advances by one step; how many elements broke in it.
    pub fn step(&mut self) -> usize {
        self.engine.step(&mut Blind).expect("a step")
    }
}

/// An observer that sees nothing.
pub struct Blind;

impl Observer for Blind {
    fn wants(&self, _time: f64) -> bool {
        false
    }

    fn see(&mut self, _view: &View<'_>) -> Result<(), Fault> {
        Ok(())
    }
}

/// Looks at one step.
struct Glance<F, T> {
    look: F,
    seen: Option<T>,
}

impl<T, F: FnMut(&View<'_>) -> T> Observer for Glance<F, T> {
    fn wants(&self, _time: f64) -> bool {
        true
    }

    fn see(&mut self, view: &View<'_>) -> Result<(), Fault> {
        self.seen = Some((self.look)(view));
        Ok(())
    }
}

/// Advances by one step and returns what `look` sees at it.
pub fn watch<T>(engine: &mut Engine, look: impl FnMut(&View<'_>) -> T) -> T {
    let mut glance = Glance { look, seen: None };
    engine.step(&mut glance).expect("a step");
    glance.seen.expect("every step is seen")
}

/// Where the nodes are.
pub fn places(nodes: &Nodes) -> Vec<[f64; 3]> {
    nodes.position.iter().collect()
}

/// Puts every node where `to` says, from its number and place.
pub fn put(nodes: &mut Nodes, mut to: impl FnMut(usize, [f64; 3]) -> [f64; 3]) {
    (0..nodes.position.len()).for_each(|n| nodes.position.set(n, to(n, nodes.position.at(n))));
}

/// The film's forces on its nodes.
pub fn forces(film: &mut Film, nodes: &Nodes) -> Vec<Vector3<f64>> {
    let mut nodes = nodes.clone();
    film.add_forces(&mut nodes, 0.0);
    nodes.force.iter().map(Vector3::from).collect()
}

/// Where the nodes come to rest under `damping` (1/s) within `time` (s), and the energies then.
pub fn relaxed(film: Film, nodes: Nodes, damping: f64, time: f64) -> (Vec<[f64; 3]>, Energies) {
    let loads = Loads { damping, ..Loads::default() };
    let mut engine = Engine::new(vec![film], nodes, None, loads);
    while engine.time() < time {
        engine.step(&mut Blind).expect("a step");
    }
    watch(&mut engine, |view| (places(view.nodes), view.energies()))
}

/// The mesh of a face.
pub fn build(model: &Model, face: &Face) -> Result<Mesh, MeshError> {
    mesh::build(&model.specimen.shape, model.specimen.symmetry.mirrors(), &face.meshing)
}

/// A mesh and the nodes and film that stand on it, before anything moves.
pub fn mounted(mesh: &Mesh, face: &Face) -> (Film, Nodes) {
    let mut nodes = Nodes::default();
    let film = Film::mount(mesh, &section(face, 1.0), face.height, &mut nodes).expect("a film");
    (film, nodes)
}
