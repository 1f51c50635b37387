//! The scene in one state as surfaces and lines, for programs that show it in 3-D.

use std::collections::HashMap;

use nalgebra::Isometry3;

use super::scene_picture::{CREASES, FRAME, ScenePicture, drawn, posed, poses};
use crate::gltf::{Lines, Look, Surface};
use plot::viridis::viridis;
use report::{SceneBody, SceneFace};
use scene::simulate::{FilmState, Image};

/// Colour of impactors and bars, sRGB.
const BODY: [f32; 3] = [150.0, 154.0, 162.0];

impl ScenePicture<'_> {
    /// The film in the colours of the field, a surface a face, then the impactors and the bars of the frame.
    pub fn surfaces(&self) -> Vec<Surface> {
        let faces = self.scene.faces.iter().zip(&self.state.films);
        let film = (1..).zip(faces).map(|(number, (face, film))| self.film(number, face, film));
        let bodies = self.scene.bodies.iter().zip(poses(self.state));
        film.chain((1..).zip(bodies).map(|(number, (part, pose))| body(number, part, &pose))).collect()
    }

    /// The springs of the frame, a set of lines a face.
    pub fn lines(&self) -> Vec<Lines> {
        let faces = self.scene.faces.iter().zip(&self.state.films);
        (1..).zip(faces).map(|(number, (face, film))| self.springs(number, face, film)).collect()
    }

    fn springs(&self, number: usize, face: &SceneFace, film: &FilmState) -> Lines {
        let is_finite = |ends: &[[f32; 3]; 2]| ends.iter().flatten().all(|c| c.is_finite());
        let own: Vec<[[f32; 3]; 2]> = face.spring_lines(film).filter(is_finite).collect();
        // Minus zero is zero.
        let place = |image: Image, place: [f32; 3]| image.reflect(place).map(|c| c + 0.0);
        let ends = self.images(face).flat_map(|image| own.iter().map(move |ends| ends.map(|end| place(image, end))));
        Lines { name: format!("springs {number}"), ends: ends.collect(), colour: FRAME }
    }

    /// A face and its mirror images, which share the nodes on the planes between them.
    fn film(&self, number: usize, face: &SceneFace, film: &FilmState) -> Surface {
        let [low, high] = self.range;
        let values = self.field.at_nodes(face.nodes, face.patches.iter().copied(), film);
        let drawn = drawn(face, film);
        let (mut points, mut colours, mut triangles) = (vec![], vec![], vec![]);
        let mut known: HashMap<(u32, [u32; 3]), u32> = HashMap::new();
        for image in self.images(face) {
            let mut point = |node: u32| {
                // Minus zero is zero.
                let place = image.reflect(film.positions[node as usize]).map(|c| c + 0.0);
                *known.entry((node, place.map(f32::to_bits))).or_insert_with(|| {
                    points.push(place);
                    colours.push(viridis((values[node as usize] - low) / (high - low)));
                    points.len() as u32 - 1
                })
            };
            for (patch, _) in face.patches.iter().zip(&drawn).filter(|(_, drawn)| **drawn) {
                let mut corners = patch.map(&mut point);
                if image.is_reversed() {
                    corners.swap(0, 1);
                    corners.swap(2, 3);
                }
                triangles.extend(halves(corners));
            }
        }
        let crease = CREASES[0] as f32;
        Surface { name: format!("film {number}"), points, triangles, look: Look::Film(colours), crease }
    }
}

fn body(number: usize, body: &SceneBody, pose: &Isometry3<f64>) -> Surface {
    let points = body.points.iter().map(|place| <[f64; 3]>::from(posed(pose, place)).map(|c| c as f32));
    let triangles = body.patches.iter().flat_map(|patch| halves(*patch));
    Surface {
        name: format!("body {number}"),
        points: points.collect(),
        triangles: triangles.collect(),
        look: Look::Body(BODY),
        crease: CREASES[1] as f32,
    }
}

/// The triangles of a patch, of which one has no area where the patch is a triangle.
fn halves([p, q, r, s]: [u32; 4]) -> [[u32; 3]; 2] {
    [[p, q, r], [p, r, s]]
}
