//! Films, bodies and points in a recording; what does not change is logged once.

use std::collections::HashMap;

use re_sdk::{RecordingStream, RecordingStreamResult};
use re_sdk_types::AsComponents;
use re_sdk_types::archetypes::{InstancePoses3D, LineStrips3D, Mesh3D, Points3D, Transform3D};
use re_sdk_types::components::{Color, Radius};
use re_sdk_types::datatypes::{Quaternion, Rgba32};
use re_sdk_types::external::re_types_core::DynamicArchetype;

use crate::quantity::{self, Quantity, TIME};
use crate::scene::{BodyTrack, Extent, FilmSnapshot, FilmTrack, PointTrack, Pose, SpringTrack, mirrored, triangles};

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

/// Logs the snapshots of a film.
pub(crate) struct Film {
    /// Steps that positions are rounded to, a power of two, m.
    step: f32,
    states: usize,
    /// State that was logged last.
    shown: Shown,
}

#[derive(Default)]
struct Shown {
    visible: Vec<bool>,
    held: Vec<[[f32; 3]; 2]>,
    springs: Vec<[[f32; 3]; 2]>,
    in_contact: bool,
}

impl Film {
    /// Logs what does not change of a film, in a scene of this extent.
    pub(crate) fn begin(stream: &RecordingStream, track: &FilmTrack, extent: &Extent) -> RecordingStreamResult<Film> {
        let poses = InstancePoses3D::new().with_scales(images(track));
        stream.log_static(entity(track), &poses)?;
        Ok(Film { step: step(extent.size()), states: 0, shown: Shown::default() })
    }

    /// Logs a snapshot that has passed the check of its track.
    pub(crate) fn log(
        &mut self,
        stream: &RecordingStream,
        track: &FilmTrack,
        snapshot: &FilmSnapshot,
        quantities: &[Quantity],
    ) -> RecordingStreamResult<()> {
        stream.set_duration_secs(TIME, snapshot.time);
        // The viewer keeps what was logged last: indices are sent only when elements vanish.
        let broke = self.shown.visible != snapshot.visible;
        let mut mesh =
            Mesh3D::update_fields().with_vertex_positions(snapshot.positions.iter().map(|p| rounded(p, self.step)));
        // Normals are as large as positions, and after a tear old ones would shade film that is gone.
        if broke || self.states.is_multiple_of(STATES_PER_NORMALS) {
            mesh = mesh.with_vertex_normals(node_normals(track, snapshot, 0.5 * self.step));
        }
        if broke {
            mesh = mesh.with_triangle_indices(visible(track, snapshot));
            self.shown.visible.clone_from(&snapshot.visible);
        }
        let mut colours = DynamicArchetype::new(COLOURS);
        for (quantity, values) in quantities.iter().zip(&snapshot.values) {
            let shades = quantity::colours(values, quantity.range);
            let shades = shades.map(|[r, g, b]| Color::from_rgb(r, g, b));
            colours = colours.with_component::<Color>(quantity.key, shades);
        }
        stream.log(entity(track), &[&mesh as &dyn AsComponents, &colours])?;
        self.states += 1;
        let at = |node: u32| snapshot.positions[node as usize];
        let edge = |edge: &[u32; 2]| edge.map(|node| rounded(&at(node), self.step));
        let held = track.held.iter().map(edge).collect();
        log_lines(stream, track, ("frame", 2.0), held, &mut self.shown.held)?;
        // From the frame to the edge.
        let spring = |SpringTrack { anchor, nodes, shares }: &SpringTrack| {
            let [from, to] = nodes.map(at);
            let end = [0, 1, 2].map(|axis| from[axis] * shares[0] + to[axis] * shares[1]);
            [*anchor, end].map(|end| rounded(&end, self.step))
        };
        let springs = track.springs.iter().map(spring).collect();
        log_lines(stream, track, ("springs", 1.0), springs, &mut self.shown.springs)?;
        self.log_contact(stream, track, snapshot)
    }

    /// The nodes in contact, until there are none.
    fn log_contact(
        &mut self,
        stream: &RecordingStream,
        track: &FilmTrack,
        snapshot: &FilmSnapshot,
    ) -> RecordingStreamResult<()> {
        // One empty list must be logged, or the last marks would stay.
        if snapshot.in_contact.is_empty() && !self.shown.in_contact {
            return Ok(());
        }
        let step = STEPS_PER_MARK * self.step;
        let points = snapshot.in_contact.iter().map(|node| rounded(&snapshot.positions[*node as usize], step));
        let points: Vec<_> = points.collect();
        let whole = images(track).flat_map(|image| points.iter().map(move |point| mirrored(*point, image)));
        let contact = Points3D::new(whole).with_colors([CONTACT]).with_radii([Radius::new_ui_points(2.0)]);
        stream.log(format!("scene/contact/{}", track.name), &contact)?;
        self.shown.in_contact = !snapshot.in_contact.is_empty();
        Ok(())
    }
}

/// Lines of a film and its mirror images, of a name and a width, where they are not those that are shown.
fn log_lines(
    stream: &RecordingStream,
    track: &FilmTrack,
    (name, width): (&str, f32),
    lines: Vec<[[f32; 3]; 2]>,
    shown: &mut Vec<[[f32; 3]; 2]>,
) -> RecordingStreamResult<()> {
    // Compared after rounding: a frame that stands still is logged once.
    if lines == *shown {
        return Ok(());
    }
    let whole = images(track).flat_map(|image| lines.iter().map(move |line| line.map(|end| mirrored(end, image))));
    let strips = LineStrips3D::new(whole).with_colors([FRAME]).with_radii([Radius::new_ui_points(width)]);
    stream.log(format!("scene/{name}/{}", track.name), &strips)?;
    *shown = lines;
    Ok(())
}

/// Entity of a film.
pub(crate) fn entity(track: &FilmTrack) -> String {
    format!("scene/{}", track.name)
}

/// Factors on x, y, z that show a film and its mirror images.
fn images(track: &FilmTrack) -> impl Iterator<Item = [f32; 3]> {
    std::iter::once([1.0; 3]).chain(track.images.iter().copied())
}

/// The power of two nearest to the length that divides a size into [`STEPS`]; of no size, to that of a metre.
fn step(size: f32) -> f32 {
    let size = if size.is_normal() { size } else { 1.0 };
    // A power of two, so that rounded coordinates end in zero bits, which compress.
    (size / STEPS).log2().round().exp2()
}

fn rounded(point: &[f32; 3], step: f32) -> [f32; 3] {
    point.map(|coordinate| (coordinate / step).round() * step)
}

/// The intact triangles.
fn visible(film: &FilmTrack, snapshot: &FilmSnapshot) -> Vec<[u32; 3]> {
    let mut left: Vec<_> = film.visible(snapshot).collect();
    if left.is_empty() {
        // Without any indices, every three vertices would be drawn as a triangle.
        left.push([0; 3]);
    }
    left
}

/// Translucent steel, so that the film behind it is visible.
const STEEL: [u8; 4] = [170, 178, 190, 100];

/// Logs the shape.
pub(crate) fn log_shape(stream: &RecordingStream, body: &BodyTrack) -> RecordingStreamResult<()> {
    let Corners { points, normals, triangles } = Corners::from_body(body);
    let surface = Mesh3D::new(points)
        .with_triangle_indices(triangles)
        .with_vertex_normals(normals)
        .with_albedo_factor(Rgba32::from_unmultiplied_rgba(STEEL[0], STEEL[1], STEEL[2], STEEL[3]));
    stream.log_static(body_entity(body), &surface)
}

/// Logs the pose of the body.
pub(crate) fn log_pose(stream: &RecordingStream, body: &BodyTrack, pose: &Pose) -> RecordingStreamResult<()> {
    stream.set_duration_secs(TIME, pose.time);
    let moved = Transform3D::update_fields()
        .with_translation(pose.position)
        .with_quaternion(Quaternion::from_xyzw(pose.rotation));
    stream.log(body_entity(body), &moved)
}

fn body_entity(body: &BodyTrack) -> String {
    format!("scene/{}", body.name)
}

/// A surface with a vertex for each normal of a point: several at edges.
struct Corners {
    points: Vec<[f32; 3]>,
    normals: Vec<[f32; 3]>,
    triangles: Vec<[u32; 3]>,
}

impl Corners {
    fn from_body(body: &BodyTrack) -> Corners {
        let mut corners = Corners { points: vec![], normals: vec![], triangles: vec![] };
        let mut known = HashMap::new();
        let triangles: Vec<[u32; 3]> = triangles(body.patches.iter().copied()).collect();
        for (triangle, normals) in triangles.iter().zip(corner_normals(&body.points, &triangles)) {
            corners.triangles.push([0, 1, 2].map(|corner| {
                let (point, normal): (u32, [f32; 3]) = (triangle[corner], normals[corner]);
                // By the bits of the rounded normal, which faces around a smooth point share; a float is no key.
                *known.entry((point, normal.map(f32::to_bits))).or_insert_with(|| {
                    corners.points.push(body.points[point as usize]);
                    corners.normals.push(normal);
                    corners.points.len() as u32 - 1
                })
            }));
        }
        corners
    }
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

/// Cosine of the angle between two triangles from which there is an edge between them: 30°.
const EDGE: f32 = 0.866;

/// One normal a node, weighted by the area of what is left around it; on a mirror
/// plane, which nodes nearer than `near` stand on, it lies in that plane, so that no crease shows.
fn node_normals(film: &FilmTrack, snapshot: &FilmSnapshot, near: f32) -> Vec<[f32; 3]> {
    let mut normals = sums(&snapshot.positions, film.visible(snapshot));
    for (normal, position) in normals.iter_mut().zip(&snapshot.positions) {
        for axis in (0..2).filter(|axis| film.images.iter().any(|image| image[*axis] < 0.0)) {
            if position[axis].abs() < near {
                normal[axis] = 0.0;
            }
        }
    }
    normals.into_iter().map(rounded_unit).collect()
}

/// The normals at the corners of each triangle of a closed surface, weighted by the area of those around the corner
/// that do not turn away from it by more than an edge does.
fn corner_normals(points: &[[f32; 3]], triangles: &[[u32; 3]]) -> Vec<[[f32; 3]; 3]> {
    let areas: Vec<[f32; 3]> = triangles.iter().map(|triangle| area(points, triangle)).collect();
    let mut around: Vec<Vec<usize>> = vec![vec![]; points.len()];
    for (index, triangle) in triangles.iter().enumerate() {
        triangle.iter().for_each(|node| around[*node as usize].push(index));
    }
    let is_smooth = |one: &[f32; 3], other: &[f32; 3]| dot(one, other) > EDGE * length(one) * length(other);
    // A normal a corner, not a node: at an edge of a body the faces keep their own.
    let normal = |index: usize, node: u32| {
        let smooth = around[node as usize].iter().map(|other| areas[*other]).filter(|o| is_smooth(&areas[index], o));
        rounded_unit(smooth.fold([0.0; 3], plus))
    };
    triangles.iter().enumerate().map(|(index, triangle)| triangle.map(|node| normal(index, node))).collect()
}

fn sums(points: &[[f32; 3]], triangles: impl Iterator<Item = [u32; 3]>) -> Vec<[f32; 3]> {
    let mut normals = vec![[0.0; 3]; points.len()];
    for triangle in triangles {
        // Not made a unit: a longer cross product gives a larger triangle its larger weight.
        let area = area(points, &triangle);
        for node in triangle {
            let normal = &mut normals[node as usize];
            *normal = plus(*normal, area);
        }
    }
    normals
}

/// Along its normal, twice as long as its area.
fn area(points: &[[f32; 3]], triangle: &[u32; 3]) -> [f32; 3] {
    let [a, b, c] = triangle.map(|node| points[node as usize]);
    cross(minus(b, a), minus(c, a))
}

fn rounded_unit(normal: [f32; 3]) -> [f32; 3] {
    let length = length(&normal);
    // Upward where no triangle is left: the viewer needs some direction.
    if length > 0.0 { normal.map(|c| (c / length * NORMAL_STEPS).round() / NORMAL_STEPS) } else { [0.0, 0.0, 1.0] }
}

fn length(a: &[f32; 3]) -> f32 {
    dot(a, a).sqrt()
}

fn dot(a: &[f32; 3], b: &[f32; 3]) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn plus(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    [0, 1, 2].map(|i| a[i] + b[i])
}

fn minus(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    [0, 1, 2].map(|i| a[i] - b[i])
}

fn cross(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    [[1, 2], [2, 0], [0, 1]].map(|[i, j]| a[i] * b[j] - a[j] * b[i])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Eight corners with three normals each; a slanted one of a flat pyramid, one for all around.
    #[test]
    fn edges_are_sharp_and_what_is_round_is_smooth() {
        let body = |points: Vec<[f32; 3]>, patches: Vec<[u32; 4]>| BodyTrack {
            name: "body".to_owned(),
            points,
            patches,
            poses: vec![],
        };
        let cube = (0..8).map(|corner| [corner & 1, corner >> 1 & 1, corner >> 2].map(|c| c as f32)).collect();
        let sides = vec![[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let corners = Corners::from_body(&body(cube, sides));
        assert_eq!((corners.points.len(), corners.triangles.len()), (24, 12));
        for triangle in &corners.triangles {
            let normals = triangle.map(|corner| corners.normals[corner as usize]);
            assert!(normals.iter().all(|normal| *normal == normals[0]), "{normals:?}");
        }

        let pyramid = vec![[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 0.1]];
        let corners = Corners::from_body(&body(pyramid, vec![[0, 1, 4, 4], [1, 2, 4, 4], [2, 3, 4, 4], [3, 0, 4, 4]]));
        let tip: Vec<_> = corners.points.iter().zip(&corners.normals).filter(|(point, _)| point[2] > 0.0).collect();
        assert_eq!(tip.iter().map(|(_, normal)| **normal).collect::<Vec<_>>(), [[0.0, 0.0, 1.0]]);
    }
}
