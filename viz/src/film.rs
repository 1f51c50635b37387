//! A film as one mesh: what does not change is logged once.

use re_sdk::{RecordingStream, RecordingStreamResult};
use re_sdk_types::archetypes::{InstancePoses3D, Mesh3D};
use re_sdk_types::components::Color;

use crate::scene::{FilmFrame, FilmTrack};
use crate::series::Moment;
use crate::{colour, normals};

/// Positions are rounded to 2^-18 m, four micrometres: random last digits do not compress.
const STEPS_PER_METRE: f32 = 262_144.0;

/// Logs all frames of `film`.
pub fn log(stream: &RecordingStream, film: &FilmTrack) -> RecordingStreamResult<()> {
    let entity = format!("scene/{}", film.name);
    let poses = InstancePoses3D::new().with_scales(mirror_images(film.mirrored));
    stream.log_static(entity.as_str(), &poses)?;
    let breaks = film.frames.iter().any(|frame| frame.visible.contains(&false));
    if !breaks {
        let whole = Mesh3D::update_fields().with_triangle_indices(film.triangles.iter().copied());
        stream.log_static(entity.as_str(), &whole)?;
    }
    let mut shown: Option<&[bool]> = None;
    for frame in &film.frames {
        let mut state = state(film, frame);
        if breaks && shown != Some(&frame.visible) {
            state = state.with_triangle_indices(visible(film, frame));
            shown = Some(&frame.visible);
        }
        Moment::Time(frame.time).set(stream);
        stream.log(entity.as_str(), &state)?;
    }
    Ok(())
}

/// Factors on x, y, z that show the film and its mirror images.
fn mirror_images(mirrored: [bool; 2]) -> Vec<[f32; 3]> {
    let signs = |mirrored: bool| if mirrored { &[1.0, -1.0][..] } else { &[1.0] };
    let [along_x, along_y] = mirrored.map(signs);
    let row = |y: &f32| along_x.iter().map(|x| [*x, *y, 1.0]).collect::<Vec<_>>();
    along_y.iter().flat_map(row).collect()
}

fn state(film: &FilmTrack, frame: &FilmFrame) -> Mesh3D {
    let positions = frame.positions.iter().map(|p| p.map(rounded));
    let colours = colour::of(&frame.values, film.range);
    Mesh3D::update_fields()
        .with_vertex_positions(positions)
        .with_vertex_normals(normals::of(film, frame))
        .with_vertex_colors(colours.map(|[r, g, b]| Color::from_rgb(r, g, b)))
}

fn rounded(coordinate: f32) -> f32 {
    (coordinate * STEPS_PER_METRE).round() / STEPS_PER_METRE
}

/// The triangles that are left.
fn visible(film: &FilmTrack, frame: &FilmFrame) -> Vec<[u32; 3]> {
    let both = film.triangles.iter().zip(&frame.visible);
    let mut left: Vec<_> = both.filter(|(_, v)| **v).map(|(t, _)| *t).collect();
    if left.is_empty() {
        // Without any indices, every three vertices would be drawn as a triangle.
        left.push([0; 3]);
    }
    left
}
