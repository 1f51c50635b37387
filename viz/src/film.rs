//! A film as one mesh; what does not change is logged once.

use re_sdk::{RecordingStream, RecordingStreamResult};
use re_sdk_types::AsComponents;
use re_sdk_types::archetypes::{InstancePoses3D, LineStrips3D, Mesh3D, Points3D};
use re_sdk_types::components::{Color, Radius};
use re_sdk_types::external::re_types_core::DynamicArchetype;

use crate::colour;
use crate::eye::Extent;
use crate::normals;
use crate::quantity::Quantity;
use crate::scene::{FilmSnapshot, FilmTrack, SpringTrack};
use crate::series::TIME;

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
        // The viewer keeps what was logged last: indices are sent only when triangles vanish.
        let broke = self.shown.visible != snapshot.visible;
        let mut mesh =
            Mesh3D::update_fields().with_vertex_positions(snapshot.positions.iter().map(|p| rounded(p, self.step)));
        // Normals are as large as positions, and after a tear old ones would shade film that is gone.
        if broke || self.states.is_multiple_of(STATES_PER_NORMALS) {
            mesh = mesh.with_vertex_normals(normals::node_normals(track, snapshot, 0.5 * self.step));
        }
        if broke {
            mesh = mesh.with_triangle_indices(visible(track, snapshot));
            self.shown.visible.clone_from(&snapshot.visible);
        }
        let mut colours = DynamicArchetype::new(COLOURS);
        for (quantity, values) in quantities.iter().zip(&snapshot.values) {
            let shades = colour::colours(quantity.colours, values, quantity.range);
            let shades = shades.map(|[r, g, b]| Color::from_rgb(r, g, b));
            colours = colours.with_component::<Color>(quantity.key, shades);
        }
        stream.log(entity(track), &[&mesh as &dyn AsComponents, &colours])?;
        self.states += 1;
        self.log_held(stream, track, snapshot)?;
        self.log_springs(stream, track, snapshot)?;
        self.log_contact(stream, track, snapshot)
    }

    /// The held edges, where they have moved.
    fn log_held(
        &mut self,
        stream: &RecordingStream,
        track: &FilmTrack,
        snapshot: &FilmSnapshot,
    ) -> RecordingStreamResult<()> {
        let ends = |edge: &[u32; 2]| edge.map(|node| rounded(&snapshot.positions[node as usize], self.step));
        let held: Vec<_> = track.held.iter().map(ends).collect();
        // Compared after rounding: a frame that stands still is logged once.
        if held == self.shown.held {
            return Ok(());
        }
        let whole = images(track).flat_map(|image| held.iter().map(move |edge| edge.map(|end| mirrored(end, image))));
        let lines = LineStrips3D::new(whole).with_colors([FRAME]).with_radii([Radius::new_ui_points(2.0)]);
        stream.log(format!("scene/frame/{}", track.name), &lines)?;
        self.shown.held = held;
        Ok(())
    }

    /// The springs, from the frame to the edge, where they have moved.
    fn log_springs(
        &mut self,
        stream: &RecordingStream,
        track: &FilmTrack,
        snapshot: &FilmSnapshot,
    ) -> RecordingStreamResult<()> {
        let line = |spring: &SpringTrack| {
            let [from, to] = spring.nodes.map(|node| snapshot.positions[node as usize]);
            let end = [0, 1, 2].map(|axis| from[axis] * spring.shares[0] + to[axis] * spring.shares[1]);
            [spring.anchor, end].map(|end| rounded(&end, self.step))
        };
        let springs: Vec<_> = track.springs.iter().map(line).collect();
        if springs == self.shown.springs {
            return Ok(());
        }
        let whole =
            images(track).flat_map(|image| springs.iter().map(move |line| line.map(|end| mirrored(end, image))));
        let lines = LineStrips3D::new(whole).with_colors([FRAME]).with_radii([Radius::new_ui_points(1.0)]);
        stream.log(format!("scene/springs/{}", track.name), &lines)?;
        self.shown.springs = springs;
        Ok(())
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

/// Entity of a film.
pub(crate) fn entity(track: &FilmTrack) -> String {
    format!("scene/{}", track.name)
}

/// Factors on x, y, z that show a film and its mirror images.
fn images(track: &FilmTrack) -> impl Iterator<Item = [f32; 3]> {
    std::iter::once([1.0; 3]).chain(track.images.iter().copied())
}

pub(crate) fn mirrored(point: [f32; 3], image: [f32; 3]) -> [f32; 3] {
    [0, 1, 2].map(|axis| point[axis] * image[axis])
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
    let both = film.triangles.iter().zip(&snapshot.visible);
    let mut left: Vec<_> = both.filter(|(_, v)| **v).map(|(t, _)| *t).collect();
    if left.is_empty() {
        // Without any indices, every three vertices would be drawn as a triangle.
        left.push([0; 3]);
    }
    left
}
