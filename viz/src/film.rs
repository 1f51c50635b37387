//! Films, bodies and points in a recording; what does not change is logged once.

use nalgebra::Vector3;
use re_sdk::{RecordingStream, RecordingStreamResult};
use re_sdk_types::AsComponents;
use re_sdk_types::archetypes::{InstancePoses3D, LineStrips3D, Mesh3D, Points3D, Transform3D};
use re_sdk_types::components::{Color, Radius};
use re_sdk_types::datatypes::{Quaternion, Rgba32};
use re_sdk_types::external::re_types_core::DynamicArchetype;

use crate::quantity::{self, Quantity, TIME};
use crate::scene::{Body, Extent, PointTrack, triangles};
use report::geometry::{SceneFace, Vertices, corner_normals};
use scene::simulate::{FilmState, Image};

/// Name of the colours of one quantity among the components of a film.
pub(crate) const COLOURS: &str = "Colours";

/// Positions are rounded to about so many steps along the longest side of the films: random last digits do not
/// compress.
const STEPS: f32 = 16_384.0;

/// Marks at the nodes in contact are rounded to so many steps of positions.
const STEPS_PER_MARK: f32 = 8.0;

/// Snapshots between two updates of the normals: shading changes more slowly than shape.
const STATES_PER_NORMALS: usize = 4;

const FRAME: [u8; 3] = [120, 124, 134];
const CONTACT: [u8; 3] = [240, 90, 40];

/// Logs the states of a face.
pub(crate) struct Film {
    name: String,
    /// Steps that positions are rounded to, a power of two, m.
    step: f32,
    states: usize,
    /// State that was logged last.
    shown: Shown,
}

#[derive(Default)]
struct Shown {
    drawn: Vec<bool>,
    held: Vec<[[f32; 3]; 2]>,
    springs: Vec<[[f32; 3]; 2]>,
    in_contact: bool,
}

impl Film {
    /// Logs what does not change of the face of this number, in a scene of this extent.
    pub(crate) fn begin(
        stream: &RecordingStream,
        number: usize,
        face: &SceneFace,
        extent: &Extent,
    ) -> RecordingStreamResult<Film> {
        let name = name(number);
        stream.log_static(entity("", &name), &InstancePoses3D::new().with_scales(face.images().map(Image::signs)))?;
        Ok(Film { name, step: step(extent.size()), states: 0, shown: Shown::default() })
    }

    /// Logs a state at the present time of the stream.
    pub(crate) fn log(
        &mut self,
        stream: &RecordingStream,
        face: &SceneFace,
        film: &FilmState,
        quantities: &[Quantity],
    ) -> RecordingStreamResult<()> {
        // The viewer keeps what was logged last: indices are sent only when elements vanish.
        let drawn = face.drawn(film);
        let broke = self.shown.drawn != drawn;
        let mut mesh =
            Mesh3D::update_fields().with_vertex_positions(film.positions.iter().map(|p| rounded(*p, self.step)));
        // Normals are as large as positions, and after a tear old ones would shade film that is gone.
        if broke || self.states.is_multiple_of(STATES_PER_NORMALS) {
            mesh = mesh.with_vertex_normals(node_normals(face, film, &drawn, 0.5 * self.step));
        }
        if broke {
            mesh = mesh.with_triangle_indices(left(face, &drawn));
            self.shown.drawn = drawn;
        }
        let mut colours = DynamicArchetype::new(COLOURS);
        for Quantity { field, range } in quantities {
            let values = field.at_nodes(face, film);
            let shades = quantity::colours(&values, *range).map(|[r, g, b]| Color::from_rgb(r, g, b));
            colours = colours.with_component::<Color>(field.key, shades);
        }
        stream.log(entity("", &self.name), &[&mesh as &dyn AsComponents, &colours])?;
        self.states += 1;
        let line = |ends: [[f32; 3]; 2]| ends.map(|end| rounded(end, self.step));
        let held = face.held.iter().map(|edge| line(edge.map(|node| film.positions[node as usize]))).collect();
        let springs = face.spring_lines(film).map(line).collect();
        if let Some(lines) = changed(&mut self.shown.held, held) {
            stream.log(entity("frame/", &self.name), &strips(face, lines, 2.0))?;
        }
        if let Some(lines) = changed(&mut self.shown.springs, springs) {
            stream.log(entity("springs/", &self.name), &strips(face, lines, 1.0))?;
        }
        self.log_contact(stream, face, film)
    }

    /// The nodes in contact, until there are none.
    fn log_contact(
        &mut self,
        stream: &RecordingStream,
        face: &SceneFace,
        film: &FilmState,
    ) -> RecordingStreamResult<()> {
        // One empty list must be logged, or the last marks would stay.
        if film.in_contact.is_empty() && !self.shown.in_contact {
            return Ok(());
        }
        let step = STEPS_PER_MARK * self.step;
        let points: Vec<_> = film.in_contact.iter().map(|node| rounded(film.positions[*node as usize], step)).collect();
        let whole = face.images().flat_map(|image| points.iter().map(move |point| image.reflect(*point)));
        let contact = Points3D::new(whole).with_colors([CONTACT]).with_radii([Radius::new_ui_points(2.0)]);
        stream.log(entity("contact/", &self.name), &contact)?;
        self.shown.in_contact = !film.in_contact.is_empty();
        Ok(())
    }
}

/// Entity of a part of a face.
fn entity(part: &str, name: &str) -> String {
    format!("scene/{part}{name}")
}

/// The lines, where they are not those that are shown: a frame that stands still is logged once. Compared after rounding.
fn changed(shown: &mut Vec<[[f32; 3]; 2]>, lines: Vec<[[f32; 3]; 2]>) -> Option<&[[[f32; 3]; 2]]> {
    if lines == *shown {
        return None;
    }
    *shown = lines;
    Some(shown)
}

/// Lines of a face and its mirror images.
fn strips(face: &SceneFace, lines: &[[[f32; 3]; 2]], width: f32) -> LineStrips3D {
    let whole = face.images().flat_map(|image| lines.iter().map(move |line| line.map(|end| image.reflect(end))));
    LineStrips3D::new(whole).with_colors([FRAME]).with_radii([Radius::new_ui_points(width)])
}

/// Name of the face of this number in entity paths.
pub(crate) fn name(number: usize) -> String {
    format!("face-{}", number + 1)
}

/// The power of two nearest to the length that divides a size into [`STEPS`]; of no size, to that of a metre.
fn step(size: f32) -> f32 {
    let size = if size.is_normal() { size } else { 1.0 };
    // A power of two, so that rounded coordinates end in zero bits, which compress.
    (size / STEPS).log2().round().exp2()
}

fn rounded(point: [f32; 3], step: f32) -> [f32; 3] {
    point.map(|coordinate| (coordinate / step).round() * step)
}

/// The triangles that are drawn.
fn left(face: &SceneFace, drawn: &[bool]) -> Vec<[u32; 3]> {
    let mut left: Vec<_> = triangles(face, drawn).collect();
    if left.is_empty() {
        // Without any indices, every three vertices would be drawn as a triangle.
        left.push([0; 3]);
    }
    left
}

/// Translucent steel, so that the film behind it is visible.
const STEEL: [u8; 4] = [170, 178, 190, 100];

/// Logs the shape.
pub(crate) fn log_shape(stream: &RecordingStream, body: &Body) -> RecordingStreamResult<()> {
    let patches = &body.surface.patches;
    let points: Vec<Vector3<f64>> = body.surface.points.iter().map(|point| Vector3::from(*point)).collect();
    let normals = corner_normals(&points, patches, &vec![true; patches.len()], EDGE);
    let vertices = Vertices::new(patches, &normals, |c| (c as f32 * NORMAL_STEPS).round() / NORMAL_STEPS);
    let places = vertices.points.iter().map(|point| points[*point as usize].map(|c| c as f32));
    let surface = Mesh3D::new(places.map(<[f32; 3]>::from))
        .with_triangle_indices(vertices.triangles)
        .with_vertex_normals(vertices.normals)
        .with_albedo_factor(Rgba32::from_unmultiplied_rgba(STEEL[0], STEEL[1], STEEL[2], STEEL[3]));
    stream.log_static(body_entity(body), &surface)
}

/// Logs position and rotation (unit quaternion i, j, k, w) of the body at the present time of the stream.
pub(crate) fn log_pose(
    stream: &RecordingStream,
    body: &Body,
    (position, rotation): &([f64; 3], [f64; 4]),
) -> RecordingStreamResult<()> {
    let moved = Transform3D::update_fields()
        .with_translation(position.map(|c| c as f32))
        .with_quaternion(Quaternion::from_xyzw(rotation.map(|c| c as f32)));
    stream.log(body_entity(body), &moved)
}

fn body_entity(body: &Body) -> String {
    format!("scene/{}", body.name)
}

/// Logs all states.
pub(crate) fn log_points(stream: &RecordingStream, track: &PointTrack) -> RecordingStreamResult<()> {
    for state in &track.states {
        stream.set_duration_secs(TIME, state.time);
        let colours = state.colours.iter().map(|[r, g, b]| Color::from_rgb(*r, *g, *b));
        let points = Points3D::new(state.positions.iter().copied())
            .with_colors(colours)
            .with_radii([Radius::from(track.radius)]);
        stream.log(format!("scene/{}", track.name), &points)?;
    }
    Ok(())
}

/// Normals are rounded to 1/32: enough for light, and they compress.
const NORMAL_STEPS: f32 = 32.0;

/// Cosine of the angle between two patches from which there is an edge between them: 30°.
const EDGE: f64 = 0.866;

/// One normal a node, weighted by the area of what is left around it; on a mirror
/// plane, which nodes nearer than `near` stand on, it lies in that plane, so that no crease shows.
fn node_normals(face: &SceneFace, film: &FilmState, drawn: &[bool], near: f32) -> Vec<[f32; 3]> {
    let mut normals: Vec<Vector3<f32>> = vec![Vector3::zeros(); film.positions.len()];
    for triangle in triangles(face, drawn) {
        let [a, b, c] = triangle.map(|node| Vector3::from(film.positions[node as usize]));
        // Not made a unit: a longer cross product gives a larger triangle its larger weight.
        let area = (b - a).cross(&(c - a));
        for node in triangle {
            normals[node as usize] += area;
        }
    }
    for (normal, position) in normals.iter_mut().zip(&film.positions) {
        for axis in (0..2).filter(|axis| face.mirrored[*axis] && position[*axis].abs() < near) {
            normal[axis] = 0.0;
        }
    }
    // Upward where no triangle is left: the viewer needs some direction.
    let unit = |normal: Vector3<f32>| normal.try_normalize(0.0).unwrap_or(Vector3::z());
    normals.into_iter().map(|normal| unit(normal).map(|c| (c * NORMAL_STEPS).round() / NORMAL_STEPS).into()).collect()
}
