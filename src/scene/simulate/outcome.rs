//! The outcome of a run: its films, snapshots with their mirror images, and the motion of a face.

use std::ops::Range;
use std::time::Duration;

use serde::{Deserialize, Serialize};

use super::energy_check::RateHistogram;
use super::warning::Warning;
use crate::mesh::Quality;
use crate::model::{self, DETAIL_BYTES, SNAPSHOT_BYTES, SNAPSHOT_MEMORY};
use lab::signal::Recording;
use membrane::engine::{self, AddedMass, ElementDetail, ElementStrain, Relaxation, SpringLoad, Surface, Torn, View};
use membrane::lane::Width;

/// The outcome of a run. It is serialized without its pictures: snapshots, topology and surfaces.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Outcome {
    /// Channels of `signals.csv`, in its order, without the filtered one (that is post-processing).
    pub signals: Recording,
    /// The energy audit, sampled with the signals: one channel a term, J.
    pub energies: Recording,
    /// States of films and impactors over time.
    #[serde(skip)]
    pub snapshots: Vec<Snapshot>,
    /// Topology of the films, one entry a face.
    pub films: Vec<Film>,
    /// The motion of the face that is compared with a field.
    pub motion: Option<FaceMotion>,
    /// Surfaces of the impactors that move in the snapshots, and after them that of the frame's bars, if there are any.
    #[serde(skip)]
    pub impactors: Vec<Surface>,
    /// Strain increments by strain rate.
    pub rates: RateHistogram,
    /// Findings that put figures in doubt.
    pub warnings: Vec<Warning>,
    /// Time at which the first element failed, s.
    pub rupture_time: Option<f64>,
    /// Largest |ΣE − E₀| over the energy exchanged.
    pub energy_balance_error: f64,
    /// Largest ratio of the film's kinetic energy to the energy that it took up, from a tenth of its maximum on (only
    /// quasi-static loadings).
    pub kinetic_share: Option<f64>,
    /// Energy lost to damping over the energy that the film took up (only quasi-static loadings).
    pub damping_share: Option<f64>,
    /// Change of an inflated film's deflection over the last tenth of the test, over the deflection; none after a
    /// rupture.
    pub settling: Option<f64>,
    /// How the film came to equilibrium before the test; none where nothing holds it.
    pub relaxation: Option<Relaxation>,
    /// Factor on the film's mass that the run used (only quasi-static loadings).
    pub mass_scaling: Option<f64>,
    /// Mass added to the small elements of each face; empty where none was asked for.
    pub added_mass: Vec<AddedMass>,
    /// Largest penetration over the radius of an impactor.
    pub penetration: Option<f64>,
    /// Tears at the end; only of film with a rupture criterion of its own.
    pub torn: Option<Torn>,
    /// Largest growth of the temperature of film that does not tear, before it first breaks, K; only of film that warms up.
    pub warming: Option<f64>,
    /// Number of elements.
    pub elements: usize,
    /// Number of threads.
    pub threads: usize,
    /// Vector instructions of its kernels.
    pub instructions: Width,
    /// Number of steps.
    pub steps: u64,
    /// Mean time step, s.
    pub time_step: f64,
    /// Wall time, of all parts where the run was interrupted.
    pub wall: Duration,
}

/// Topology of one face, for pictures of it; it is serialized without its elements and edges.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Film {
    /// Number of nodes.
    pub nodes: usize,
    /// Corners of the quadrilaterals, counted among the nodes of the face.
    #[serde(skip)]
    pub quads: Vec<[u32; 4]>,
    /// Corners of the triangles.
    #[serde(skip)]
    pub tris: Vec<[u32; 3]>,
    /// Edges by which the frame or the jaws hold it, as pairs of nodes.
    #[serde(skip)]
    pub held: Vec<[u32; 2]>,
    /// Springs of the frame on which it hangs.
    #[serde(skip)]
    pub springs: Vec<FilmSpring>,
    /// Whether x = 0 and y = 0 are mirror planes.
    pub mirrored: [bool; 2],
    /// Shape of its elements.
    pub quality: Quality,
}

/// A spring between the frame and the edge of a face.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FilmSpring {
    /// Its end on the frame, m.
    pub anchor: [f32; 3],
    /// Nodes between which its other end is, counted among those of the face.
    pub nodes: [u32; 2],
    /// Their weights.
    pub shares: [f32; 2],
}

impl FilmSpring {
    /// A spring whose end on the film is a node.
    pub fn at_node(node: u32, anchor: [f32; 3]) -> FilmSpring {
        FilmSpring { anchor, nodes: [node; 2], shares: [1.0, 0.0] }
    }

    /// Its end on the film, from the positions of the nodes of the face (m).
    pub fn end(&self, positions: &[[f32; 3]]) -> [f32; 3] {
        let [from, to] = self.nodes.map(|node| positions[node as usize]);
        [0, 1, 2].map(|axis| self.shares[0] * from[axis] + self.shares[1] * to[axis])
    }
}

impl Film {
    /// Corners of the elements, quadrilaterals and then triangles; a triangle has its last one twice.
    pub fn outlines(&self) -> impl Iterator<Item = [u32; 4]> {
        self.quads.iter().copied().chain(self.tris.iter().map(|&[a, b, c]| [a, b, c, c]))
    }
}

/// State of the whole scene at one time.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Snapshot {
    /// Time, s.
    pub time: f64,
    /// The faces of film.
    pub films: Vec<FilmState>,
    /// Position (m) and rotation (unit quaternion i, j, k, w) of the impactors, and after them of the frame's bars.
    pub impactors: Vec<([f64; 3], [f64; 4])>,
}

/// State of one face at one time.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct FilmState {
    /// m, one entry a node.
    pub positions: Vec<[f32; 3]>,
    /// Engineering strain of the MD and TD fibres and shear angle, one entry an element (quads, then triangles).
    pub strains: Vec<[f32; 3]>,
    /// Whether the MD or TD fibres of all layers are broken in an element, one entry an element.
    pub failed: Vec<bool>,
    /// Thickness over that of stress-free film, one entry an element; empty where the law does not give it.
    pub thickness_ratio: Vec<f32>,
    /// Equivalent plastic strain, one entry an element; empty where the law has none.
    pub plastic_strain: Vec<f32>,
    /// Share of its forces that an element lost by tearing, one entry an element; empty where film has no rupture criterion
    /// of its own.
    pub damage: Vec<f32>,
    /// Growth of the temperature since film was mounted, K, one entry an element; empty where film does not warm up.
    pub warming: Vec<f32>,
    /// Nodes of the face in contact with an impactor or the frame's bars, ascending.
    pub in_contact: Vec<u32>,
    /// Stresses and more, where the run takes detailed snapshots
    /// ([`RunOptions::detailed`](super::RunOptions::detailed)).
    pub detail: Option<Detail>,
}

impl FilmState {
    /// A copy without its detail, which is not copied.
    pub fn without_detail(&self) -> FilmState {
        FilmState {
            positions: self.positions.clone(),
            strains: self.strains.clone(),
            failed: self.failed.clone(),
            thickness_ratio: self.thickness_ratio.clone(),
            plastic_strain: self.plastic_strain.clone(),
            damage: self.damage.clone(),
            warming: self.warming.clone(),
            in_contact: self.in_contact.clone(),
            detail: None,
        }
    }
}

/// Velocities, stresses and more of the state of a face.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Detail {
    /// m/s, one entry a node.
    pub velocities: Vec<[f32; 3]>,
    /// Nominal stresses along MD and TD and in shear, Pa of one layer on its stress-free cross-section, one entry
    /// an element, as all that follow.
    pub stresses: Vec<[f32; 3]>,
    /// Largest MD and TD strain so far.
    pub peaks: Vec<[f32; 2]>,
    /// Share of the layers whose MD and TD fibres are not broken.
    pub left: Vec<[f32; 2]>,
    /// Images of unit vectors along MD and TD of the stress-free film: their directions are those of the fibres, their
    /// lengths the stretches.
    pub fibres: Vec<[[f32; 3]; 2]>,
    /// The springs of the frame on which the face hangs, in the order of [`Film::springs`].
    pub springs: Vec<SpringDetail>,
}

/// State of a spring between the frame and a face.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SpringDetail {
    /// m.
    pub elongation: f32,
    /// N; positive in tension.
    pub force: f32,
}

/// Number of snapshots of `films` where `wanted` are requested: as many as fit into [`SNAPSHOT_MEMORY`], at least the
/// first and the last.
pub(super) fn count(wanted: usize, films: &[Film], detailed: bool) -> usize {
    let elements: usize = films.iter().map(|film| film.quads.len() + film.tris.len()).sum();
    let per_element = if detailed { SNAPSHOT_BYTES + DETAIL_BYTES } else { SNAPSHOT_BYTES };
    wanted.min(((SNAPSHOT_MEMORY / (per_element * elements as f64)) as usize).max(2))
}

/// The scene as `view` shows it, `detailed` or not; `strains` are those of its faces.
pub(super) fn snapshot(view: &View<'_>, strains: &[Vec<ElementStrain>], detailed: bool) -> Snapshot {
    let in_contact = view.nodes_in_contact();
    let film = |(film, strains): (&engine::Film, &Vec<ElementStrain>)| {
        let is_needed = detailed || film.has_thickness() || film.warms_up();
        let details = if is_needed { film.details(&view.nodes.position) } else { vec![] };
        let thickness = details.iter().filter(|_| film.has_thickness()).map(|of| of.thickness_ratio as f32);
        let plastic = strains.iter().filter(|_| film.is_plastic()).map(|of| of.plastic as f32);
        let damage = strains.iter().filter(|_| film.has_rupture()).map(|of| of.damage as f32);
        let warming = details.iter().filter(|_| film.warms_up()).map(|of| of.warming as f32);
        FilmState {
            positions: film.nodes.clone().map(|n| view.nodes.position.value_at(n).map(|x| x as f32)).collect(),
            strains: strains.iter().map(|s| s.strain.map(|x| x as f32)).collect(),
            failed: strains.iter().map(ElementStrain::has_failed).collect(),
            thickness_ratio: thickness.collect(),
            plastic_strain: plastic.collect(),
            damage: damage.collect(),
            warming: warming.collect(),
            in_contact: of_face(&in_contact, &film.nodes),
            detail: detailed.then(|| detail(view, film, strains, &details)),
        }
    };
    let poses = view.bodies().map(|body| {
        let (position, rotation) = (body.pose.translation.vector, body.pose.rotation.coords);
        ([position.x, position.y, position.z], [rotation.x, rotation.y, rotation.z, rotation.w])
    });
    Snapshot { time: view.time, films: view.films.iter().zip(strains).map(film).collect(), impactors: poses.collect() }
}

fn detail(view: &View<'_>, film: &engine::Film, strains: &[ElementStrain], details: &[ElementDetail]) -> Detail {
    let springs = view.springs().map_or(vec![], |springs| springs.loads(view.nodes, &film.nodes));
    let mut out = Detail {
        velocities: film.nodes.clone().map(|n| view.velocity(n).map(|v| v as f32)).collect(),
        peaks: strains.iter().map(|s| s.peak.map(|e| e as f32)).collect(),
        left: strains.iter().map(|s| s.left.map(|e| e as f32)).collect(),
        springs: springs.into_iter().map(spring).collect(),
        ..Detail::default()
    };
    for ElementDetail { stress, fibres, .. } in details {
        out.stresses.push(stress.map(|s| s as f32));
        out.fibres.push(fibres.map(|f| f.map(|x| x as f32)));
    }
    out
}

fn spring(SpringLoad { elongation, force }: SpringLoad) -> SpringDetail {
    SpringDetail { elongation: elongation as f32, force: force as f32 }
}

/// The nodes in contact that belong to one face, counted from its first, ascending.
fn of_face(in_contact: &[usize], nodes: &Range<usize>) -> Vec<u32> {
    let mut own: Vec<u32> =
        in_contact.iter().filter(|node| nodes.contains(*node)).map(|node| (node - nodes.start) as u32).collect();
    own.sort_unstable();
    own
}

/// A film itself or one of its mirror images.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Image {
    /// 0 is the film itself.
    pub number: u32,
    /// Planes that it is mirrored in: x = 0, y = 0.
    mirrored: [bool; 2],
}

impl Film {
    /// The film and its mirror images.
    pub fn images(&self) -> impl Iterator<Item = Image> + use<> {
        Image::all(self.mirrored)
    }
}

impl Image {
    /// The film itself and its images where x = 0 and y = 0 are mirror planes or not.
    pub fn all([x, y]: [bool; 2]) -> impl Iterator<Item = Image> {
        (0..4)
            .map(|number| Image { number, mirrored: [number & 1 == 1, number & 2 == 2] })
            .filter(move |Image { mirrored, .. }| (x || !mirrored[0]) && (y || !mirrored[1]))
    }

    /// Factors on x, y and z.
    pub fn signs(self) -> [f32; 3] {
        let sign = |mirrored: bool| if mirrored { -1.0 } else { 1.0 };
        [sign(self.mirrored[0]), sign(self.mirrored[1]), 1.0]
    }

    /// Whether it reverses orientation: the order of an element's corners and the sign of shear.
    pub fn is_reversed(self) -> bool {
        self.mirrored[0] != self.mirrored[1]
    }

    /// The image of a point or a vector.
    pub fn reflect(self, place: [f32; 3]) -> [f32; 3] {
        let signs = self.signs();
        [0, 1, 2].map(|axis| signs[axis] * place[axis])
    }

    /// The image of the direction of fibres that lie along `axis` (0 x, 1 y) in stress-free film. The sign of a fibre's
    /// direction is arbitrary; it is the one of the film itself.
    pub fn of_fibre(self, direction: [f32; 3], axis: usize) -> [f32; 3] {
        let sign = self.signs()[axis];
        self.reflect(direction).map(|c| sign * c)
    }
}

/// The motion of one face at given times. Unlike snapshots it is stored with a run whose figures are kept.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FaceMotion {
    /// Index of the face.
    pub face: usize,
    /// Nodes at the corners of each element; a triangle has its last corner twice.
    pub corners: Vec<[u32; 4]>,
    /// Whether x = 0 and y = 0 are mirror planes.
    pub mirrored: [bool; 2],
    /// Positions of the nodes in the reference configuration, the state in which the test starts, m.
    pub reference: Vec<[f64; 3]>,
    /// The states that the run has reached, ascending in time.
    pub states: Vec<FaceState>,
}

/// A face at one time.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FaceState {
    /// Time, s.
    pub time: f64,
    /// Displacements of the nodes from the reference configuration, m.
    pub displacements: Vec<[f32; 3]>,
}

/// Positions of a face as they are recorded: the part of a checkpoint.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct MotionRecord {
    reference: Vec<[f64; 3]>,
    states: Vec<FaceState>,
}

impl MotionRecord {
    /// Whether a state is wanted at `time` (s).
    pub(super) fn is_due(&self, wanted: &model::Motion, time: f64) -> bool {
        self.reference.is_empty() || wanted.times.get(self.states.len()).is_some_and(|due| *due <= time)
    }

    /// Records what is due. A wanted time lies within the step before that of `view`, from whose state it is extrapolated by
    /// the velocity: the error is one of the second order in the time step.
    pub(super) fn record(&mut self, wanted: &model::Motion, view: &View<'_>) {
        let Some(film) = view.films.get(wanted.face) else { return };
        if self.reference.is_empty() {
            self.reference = film.nodes.clone().map(|node| view.nodes.position.value_at(node)).collect();
        }
        while let Some(due) = wanted.times.get(self.states.len()).filter(|due| **due <= view.time) {
            let back = view.time - due;
            let displacement = |(node, reference): (usize, &[f64; 3])| {
                let (position, velocity) = (view.nodes.position.value_at(node), view.velocity(node));
                [0, 1, 2].map(|axis| (position[axis] - reference[axis] - back * velocity[axis]) as f32)
            };
            let displacements = film.nodes.clone().zip(&self.reference).map(displacement).collect();
            self.states.push(FaceState { time: *due, displacements });
        }
    }

    /// The motion of its face, whose topology is in `films`.
    pub(super) fn finish(self, wanted: &model::Motion, films: &[Film]) -> Option<FaceMotion> {
        let film = films.get(wanted.face).filter(|_| !self.reference.is_empty())?;
        Some(FaceMotion {
            face: wanted.face,
            corners: film.outlines().collect(),
            mirrored: film.mirrored,
            reference: self.reference,
            states: self.states,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{Mesh, Quality};

    #[test]
    fn a_quarter_has_four_images_a_half_two_and_a_whole_one() {
        for (mirrored, numbers) in [
            ([true, true], &[0, 1, 2, 3][..]),
            ([true, false], &[0, 1]),
            ([false, true], &[0, 2]),
            ([false, false], &[0]),
        ] {
            let quality = Quality::from_mesh(&Mesh::default());
            let film = Film { nodes: 0, quads: vec![], tris: vec![], held: vec![], springs: vec![], mirrored, quality };
            let found: Vec<u32> = film.images().map(|image| image.number).collect();
            assert_eq!(found, numbers);
            for image in film.images() {
                assert_eq!(image.reflect([1.0, 2.0, 3.0])[2], 3.0);
                assert_eq!(image.is_reversed(), image.signs().iter().product::<f32>() < 0.0);
                assert_eq!(image.of_fibre([1.0, 0.0, 0.0], 0), [1.0, 0.0, 0.0], "with the sign of the film itself");
            }
        }
    }
}
