//! The scene of a run in one state: film coloured by a field, translucent impactors, the frame.

use nalgebra::{Isometry3, Vector3};

use crate::camera::{Camera, View};
use crate::drawing::{self, Drawing, PictureError, Placed};
use crate::raster::{Pixels, Triangle};
use crate::round;
use crate::setting::{Setting, Words};
use plot::Style;
use plot::viridis::viridis;
use report::geometry::{Field, RunScene, SceneBody, SceneFace, corner_normals, poses};
use scene::simulate::{Image, Snapshot};

/// Most patches, mirror images included, whose edges are drawn.
const MOST_OUTLINED: usize = 4_000;

/// Width of the edges of patches, of the held edges of film and of springs, pt.
const EDGE_WIDTHS: [f64; 3] = [0.3, 1.5, 0.8];

/// Most states by which the extent of a scene is found; the others lie between them.
const MOST_OF_EXTENT: usize = 24;

/// How far beside and above the film impactors are in the picture at most, over the extent of the film.
const BESIDE: [f64; 2] = [0.3, 0.8];

/// Offset of faces in contact with each other, over the size of a patch.
const APART: f64 = 0.06;

/// Distance behind film, over its extent, from which on an impactor is behind it.
const BEHIND: f64 = 0.01;

/// Cosines of the angles up to which folds of film and edges of bodies look smooth.
pub(super) const CREASES: [f64; 2] = [0.5, 0.8];

/// Direction of the light: to the right, upwards, towards the eye.
const LIGHT: Vector3<f64> = Vector3::new(0.35, 0.5, 0.79);

/// Colour of the held edges of film and of its springs.
pub(super) const FRAME: [f32; 3] = [48.0, 54.0, 60.0];

/// Drawn part of a film with planes of symmetry.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Part {
    /// The whole film.
    #[default]
    Whole,
    /// The half behind the plane y = 0, or x = 0 where that is the only one.
    Half,
    /// The computed part.
    Computed,
}

/// A scene in one state, as it is to be drawn.
#[derive(Clone, Copy)]
pub struct ScenePicture<'a> {
    /// The scene, whose states together decide the extent of the picture: pictures at several times are alike.
    pub scene: &'a RunScene,
    /// The state.
    pub state: &'a Snapshot,
    /// The field that colours the film.
    pub field: &'a Field,
    /// Colour range, in the unit of the field.
    pub range: [f32; 2],
    /// From where it is seen.
    pub view: View,
    /// Whether what is nearer is larger.
    pub in_perspective: bool,
    /// Drawn part of the film.
    pub part: Part,
    /// Heading.
    pub title: &'a str,
    /// Time, and what happens.
    pub caption: &'a str,
}

impl ScenePicture<'_> {
    /// The picture, for so many pixels per inch.
    ///
    /// # Errors
    /// It has no area or too many pixels, or there is nothing to draw.
    pub fn draw(&self, style: &Style, dpi: f64) -> Result<Drawing, PictureError> {
        drawing::check([style.width, style.height].map(|length| Style::pixels(length, dpi)))?;
        let setting = Setting::new(style);
        let [left, top, right, bottom] = setting.scene;
        let room = [(right - left).max(1.0), (bottom - top).max(1.0)];
        let points = self.extent();
        let camera = Camera::fitting(self.view, self.in_perspective, &points, room).ok_or(PictureError::Nothing)?;
        let factor = dpi / 72.0;
        let [width, height] = room.map(|length| Style::pixels(length, dpi).max(1) as usize);
        let size = points.iter().map(|point| (point - points[0]).norm()).fold(0.0, f64::max);
        let behind = BEHIND * size;
        let stage = Stage { picture: self, camera: camera.scaled(factor), pixels_per_point: factor, behind };
        let pixels = Pixels::draw(&stage.triangles(), [width, height], behind as f32);
        let bar = format!("{} ({})", self.field.title, self.field.unit);
        let words = Words { title: self.title, caption: self.caption, bar: &bar, range: self.range };
        let document = setting.document(&words, &camera);
        let place = [left, top].map(|length| Style::pixels(length, dpi));
        Ok(Drawing::of_scene(document, Placed { pixels, place }, style, dpi))
    }

    /// The images of a face that are drawn.
    pub(super) fn images(&self, face: &SceneFace) -> impl Iterator<Item = Image> + use<> {
        let (part, cut) = (self.part, self.cut());
        face.images().filter(move |image| match part {
            Part::Whole => true,
            Part::Half => image.signs()[cut] > 0.0,
            Part::Computed => image.number == 0,
        })
    }

    /// The axis on whose negative side nothing is drawn of a half.
    fn cut(&self) -> usize {
        usize::from(self.scene.faces.iter().any(|face| face.mirrored[1]))
    }

    /// Points that the picture encloses: the film that is held in the course of the run, and the bodies as far as they are
    /// near to it, not above where they are at first.
    fn extent(&self) -> Vec<Vector3<f64>> {
        let states = some_of(&self.scene.states, MOST_OF_EXTENT);
        let mut points: Vec<Vector3<f64>> = states.iter().flat_map(|state| self.film_points(state)).collect();
        let Some(first) = points.first().copied() else { return points };
        let [mut low, mut high] =
            points.iter().fold([first; 2], |[low, high], point| [low.inf(point), high.sup(point)]);
        let [beside, above] = BESIDE.map(|share| share * (high - low).max());
        let bodies = |state: &Snapshot| -> Vec<Vector3<f64>> {
            self.scene.bodies.iter().zip(poses(state)).flat_map(|(body, pose)| body.placed(pose)).collect()
        };
        let top = bodies(states[0]).iter().map(|point| point.z).fold(high.z, f64::max).min(high.z + above);
        low -= Vector3::from_element(beside);
        high = Vector3::new(high.x + beside, high.y + beside, top);
        points.extend(states.into_iter().flat_map(bodies).map(|point| point.sup(&low).inf(&high)));
        points
    }

    fn film_points(&self, state: &Snapshot) -> impl Iterator<Item = Vector3<f64>> {
        self.scene.faces.iter().zip(&state.films).flat_map(move |(face, film)| {
            let nodes = attached(face, &face.drawn(film));
            let places = film.positions.iter().zip(&nodes).filter(|(_, is_used)| **is_used).map(|(place, _)| *place);
            let places: Vec<[f32; 3]> = places.chain(face.springs.iter().map(|spring| spring.anchor)).collect();
            self.images(face)
                .flat_map(move |image| places.clone().into_iter().map(move |place| point(image.reflect(place))))
        })
    }
}

/// At most so many of `states`, the first and the last among them.
fn some_of(states: &[Snapshot], most: usize) -> Vec<&Snapshot> {
    let step = states.len().div_ceil(most).max(1);
    states.iter().step_by(step).chain(states.last()).collect()
}

fn point(place: [f32; 3]) -> Vector3<f64> {
    Vector3::from(place.map(f64::from))
}

/// Nodes of the film that is drawn and connected to its held edges; of all that is drawn where nothing is held. Scraps fly
/// anywhere.
fn attached(face: &SceneFace, drawn: &[bool]) -> Vec<bool> {
    let mut around: Vec<Vec<u32>> = vec![vec![]; face.nodes];
    for (at, patch) in face.patches.iter().enumerate().filter(|(at, _)| drawn[*at]) {
        patch.iter().for_each(|node| around[*node as usize].push(at as u32));
    }
    if face.held.is_empty() {
        return around.iter().map(|patches| !patches.is_empty()).collect();
    }
    let mut nodes = vec![false; face.nodes];
    let mut next: Vec<u32> =
        face.held.iter().flatten().copied().filter(|node| !around[*node as usize].is_empty()).collect();
    while let Some(node) = next.pop() {
        if !std::mem::replace(&mut nodes[node as usize], true) {
            let patches = around[node as usize].iter().map(|at| face.patches[*at as usize]);
            next.extend(patches.flatten().filter(|other| !nodes[*other as usize]));
        }
    }
    nodes
}

/// A scene before a camera.
struct Stage<'a> {
    picture: &'a ScenePicture<'a>,
    /// In pixels.
    camera: Camera,
    pixels_per_point: f64,
    /// Distance behind film from which on a body is behind it, m.
    behind: f64,
}

impl Stage<'_> {
    fn triangles(&self) -> Vec<Triangle> {
        let ScenePicture { scene, state, .. } = self.picture;
        let mut triangles = vec![];
        let images: usize = scene.faces.iter().map(|face| face.patches.len() * self.picture.images(face).count()).sum();
        let edge = if images <= MOST_OUTLINED { EDGE_WIDTHS[0] * self.pixels_per_point } else { 0.0 };
        for (number, (face, film)) in scene.faces.iter().zip(&state.films).enumerate() {
            let values = self.picture.field.at_nodes(face, film);
            for image in self.picture.images(face) {
                let points: Vec<Vector3<f64>> =
                    film.positions.iter().map(|place| point(image.reflect(*place))).collect();
                let sheet = Sheet { number, face, points: &points, is_reversed: image.is_reversed() };
                self.sheet(&sheet, &face.drawn(film), &values, edge as f32, &mut triangles);
                face.held.iter().for_each(|edge| {
                    self.line(edge.map(|node| points[node as usize]), EDGE_WIDTHS[1], &mut triangles);
                });
                face.spring_lines(film).for_each(|ends| {
                    self.line(ends.map(|end| point(image.reflect(end))), EDGE_WIDTHS[2], &mut triangles);
                });
            }
        }
        for (number, (body, pose)) in scene.bodies.iter().zip(poses(state)).enumerate() {
            self.body(body, pose, !self.moves(number), &mut triangles);
        }
        triangles
    }

    /// One image of a face.
    fn sheet(&self, sheet: &Sheet<'_>, drawn: &[bool], values: &[f32], edge: f32, out: &mut Vec<Triangle>) {
        let Sheet { number, face, points, is_reversed } = *sheet;
        let [low, high] = self.picture.range;
        let normals = corner_normals(points, &face.patches, drawn, CREASES[0]);
        let patches = face.patches.iter().zip(&normals).zip(drawn).filter(|(_, drawn)| **drawn);
        for ((patch, normals), _) in patches {
            let corners = patch.map(|node| &points[node as usize]);
            let size = (corners[2] - corners[0]).norm().max((corners[3] - corners[1]).norm());
            let facing = (corners[2] - corners[0]).cross(&(corners[3] - corners[1])).dot(&self.camera.near());
            let upward = if is_reversed { -facing } else { facing };
            // Of faces in contact with each other the first is the upper one, seen from either side.
            let under = APART * size * (number + 1) as f64 * upward.signum();
            let places = corners.map(|corner| self.place(&(corner - under * self.camera.near())));
            let colours = [0, 1, 2, 3].map(|at| {
                let lit = LIGHT.dot(&self.camera.turned(&normals[at])) * facing.signum();
                let shade = 0.68 + 0.32 * lit.max(0.0) as f32;
                viridis((values[patch[at] as usize] - low) / (high - low)).map(|part| part * shade)
            });
            push_patch(*patch, places, colours, edge, out);
        }
    }

    /// The sides of a body that face the eye, translucent unless it is fixed. A fixed one is behind the film that lies on it.
    fn body(&self, body: &SceneBody, pose: Isometry3<f64>, is_fixed: bool, out: &mut Vec<Triangle>) {
        let points: Vec<Vector3<f64>> = body.placed(pose).collect();
        let normals = corner_normals(&points, &body.patches, &vec![true; body.patches.len()], CREASES[1]);
        let behind = if is_fixed { self.behind } else { 0.0 } * self.camera.near();
        let rounded = body.patches.iter().zip(&normals).flat_map(|(patch, normals)| {
            round::rounded(patch.map(|corner| points[corner as usize]), *normals, patch[2] == patch[3])
        });
        for [p, q, r] in rounded {
            let facing = (q.point - p.point).cross(&(r.point - p.point)).dot(&self.camera.near());
            if facing > 0.0 {
                let corners = [p, q, r].map(|corner| self.place(&(corner.point - behind)));
                let colours = [p, q, r].map(|corner| self.steel(&corner.normal));
                out.push(Triangle { corners, colours, edges: [0.0; 3], is_glass: !is_fixed });
            }
        }
    }

    /// Colour of a body, lit and a little shiny.
    fn steel(&self, normal: &Vector3<f64>) -> [f32; 3] {
        let normal = self.camera.turned(normal);
        let half = (LIGHT + Vector3::z()).normalize();
        let shine = 70.0 * normal.dot(&half).max(0.0).powi(24);
        let shade = (82.0 + 104.0 * LIGHT.dot(&normal).max(0.0) + shine) as f32;
        [shade, shade + 4.0, shade + 12.0].map(|part| part.min(255.0))
    }

    /// Whether a body is elsewhere in another state.
    fn moves(&self, body: usize) -> bool {
        let mut poses = self.picture.scene.states.iter().filter_map(|state| state.impactors.get(body));
        let first = poses.next();
        poses.any(|pose| Some(pose) != first)
    }

    /// A line of a width in pt, slightly before what it is on.
    fn line(&self, ends: [Vector3<f64>; 2], width: f64, out: &mut Vec<Triangle>) {
        let width = width * self.pixels_per_point;
        let before = (0.2 * (ends[1] - ends[0]).norm()).max(2.0 * self.camera.metres(width));
        let [a, b] = ends.map(|end| self.place(&(end + before * self.camera.near())));
        let [across, down] = [b[0] - a[0], b[1] - a[1]];
        let half = 0.5 * width as f32 / across.hypot(down).max(1e-6);
        // Ends overlap, so that corners are closed.
        let (side, on) = ([-down * half, across * half], [across * half, down * half]);
        let corner = |[x, y, depth]: [f32; 3], along: f32, aside: f32| {
            [x + along * on[0] + aside * side[0], y + along * on[1] + aside * side[1], depth]
        };
        let places = [corner(a, -1.0, 1.0), corner(b, 1.0, 1.0), corner(b, 1.0, -1.0), corner(a, -1.0, -1.0)];
        push_patch([0, 1, 2, 3], places, [FRAME; 4], 0.0, out);
    }

    fn place(&self, point: &Vector3<f64>) -> [f32; 3] {
        self.camera.project(point).map(|c| c as f32)
    }
}

/// One image of a face, at its place.
#[derive(Clone, Copy)]
struct Sheet<'a> {
    number: usize,
    face: &'a SceneFace,
    points: &'a [Vector3<f64>],
    is_reversed: bool,
}

/// The triangles of a patch; one that is a triangle has its last corner twice.
fn push_patch(
    patch: [u32; 4],
    [p, q, r, s]: [[f32; 3]; 4],
    [of_p, of_q, of_r, of_s]: [[f32; 3]; 4],
    edge: f32,
    out: &mut Vec<Triangle>,
) {
    let triangle = |corners, colours, edges| Triangle { corners, colours, edges, is_glass: false };
    if patch[2] == patch[3] {
        out.push(triangle([p, q, r], [of_p, of_q, of_r], [edge; 3]));
    } else {
        out.push(triangle([p, q, r], [of_p, of_q, of_r], [edge, edge, 0.0]));
        out.push(triangle([p, r, s], [of_p, of_r, of_s], [0.0, edge, edge]));
    }
}
