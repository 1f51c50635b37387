//! The scene in one state as surfaces and lines in binary glTF 2.0 (Khronos, ISO/IEC 12113), which slides, browsers and Blender
//! show in 3-D.
//!
//! Our z points up, that of glTF y: (x, y, z) becomes (x, z, −y). Lengths are in m in both.

use std::collections::HashMap;

use nalgebra::{Isometry3, Vector3};
use serde_json::{Map, Value, json};

use crate::scene_picture::{CREASES, FRAME, ScenePicture};
use plot::viridis::viridis;
use report::geometry::{SceneBody, SceneFace, Vertices, corner_normals, poses};
use scene::simulate::{FilmState, Image};

/// A surface of patches.
#[derive(Clone, Debug)]
pub struct Surface {
    /// Its name in the file.
    pub name: String,
    /// Points, m, z up; those of no patch are left out.
    pub points: Vec<Vector3<f64>>,
    /// Points at the corners of each patch, counter-clockwise seen from outside; a triangle has its last corner twice.
    pub patches: Vec<[u32; 4]>,
    /// How it looks.
    pub look: Look,
    /// Cosine of the angle between neighbouring patches up to which the edge between them looks smooth.
    pub crease: f64,
}

/// Lines, each of two points; programs draw them one pixel wide and without light.
#[derive(Clone, Debug)]
pub struct Lines {
    /// Their name in the file.
    pub name: String,
    /// Both ends of each, m, z up.
    pub ends: Vec<[[f32; 3]; 2]>,
    /// Colour, sRGB, from 0 to 255.
    pub colour: [f32; 3],
}

/// How a surface looks; colours are sRGB, from 0 to 255.
#[derive(Clone, Debug)]
pub enum Look {
    /// Film: a colour a point, the same on both sides.
    Film(Vec<[f32; 3]>),
    /// A body of one colour, seen from outside.
    Body([f32; 3]),
}

/// Constants of the format.
const LINES: u32 = 1;
const FLOAT: u32 = 5126;
const UNSIGNED_INT: u32 = 5125;
const ARRAY_BUFFER: u32 = 34962;
const ELEMENT_ARRAY_BUFFER: u32 = 34963;

/// The surfaces and lines with anything to show as a `.glb`; `notes` are kept in its `asset.extras`.
pub fn binary(surfaces: &[Surface], lines: &[Lines], notes: Map<String, Value>) -> Vec<u8> {
    let mut file = File::default();
    surfaces.iter().for_each(|surface| file.add(surface));
    lines.iter().for_each(|lines| file.add_lines(lines));
    file.finish(notes)
}

#[derive(Default)]
struct File {
    bytes: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
    materials: Vec<Value>,
    meshes: Vec<Value>,
    nodes: Vec<Value>,
}

impl File {
    fn add(&mut self, surface: &Surface) {
        let drawn = vec![true; surface.patches.len()];
        let normals = corner_normals(&surface.points, &surface.patches, &drawn, surface.crease);
        let Vertices { points, normals, triangles } = Vertices::new(&surface.patches, &normals, |c| c as f32);
        if triangles.is_empty() {
            return;
        }
        let at = |point: &u32| upright(surface.points[*point as usize].map(|c| c as f32).into());
        let positions: Vec<[f32; 3]> = points.iter().map(at).collect();
        let normals: Vec<[f32; 3]> = normals.into_iter().map(upright).collect();
        let mut attributes = json!({
            "POSITION": self.vectors(&positions, true),
            "NORMAL": self.vectors(&normals, false),
        });
        let material = match &surface.look {
            Look::Film(colours) => {
                // glTF wants linear colours; those of the scale are sRGB.
                let colours: Vec<[f32; 3]> = points.iter().map(|point| colours[*point as usize].map(linear)).collect();
                attributes["COLOR_0"] = self.vectors(&colours, false).into();
                json!({
                    "name": surface.name,
                    "doubleSided": true,
                    "pbrMetallicRoughness": { "metallicFactor": 0.0, "roughnessFactor": 0.6 },
                })
            }
            Look::Body(colour) => {
                let [r, g, b] = colour.map(linear);
                json!({
                    "name": surface.name,
                    "pbrMetallicRoughness":
                        { "baseColorFactor": [r, g, b, 1.0], "metallicFactor": 0.4, "roughnessFactor": 0.5 },
                })
            }
        };
        let indices = self.accessor(
            &triangles.concat(),
            u32::to_le_bytes,
            ELEMENT_ARRAY_BUFFER,
            |count| json!({ "componentType": UNSIGNED_INT, "type": "SCALAR", "count": count }),
        );
        let part = json!({ "attributes": attributes, "indices": indices, "material": self.materials.len() });
        self.push(&surface.name, part, material);
    }

    fn add_lines(&mut self, lines: &Lines) {
        let points: Vec<[f32; 3]> = lines.ends.iter().flatten().copied().map(upright).collect();
        if points.is_empty() {
            return;
        }
        let [r, g, b] = lines.colour.map(linear);
        let material = json!({
            "name": lines.name,
            "pbrMetallicRoughness": { "baseColorFactor": [r, g, b, 1.0], "metallicFactor": 0.0 },
        });
        let attributes = json!({ "POSITION": self.vectors(&points, true) });
        let part = json!({ "attributes": attributes, "mode": LINES, "material": self.materials.len() });
        self.push(&lines.name, part, material);
    }

    /// Adds a mesh of one part with a node and a material of its own.
    fn push(&mut self, name: &str, part: Value, material: Value) {
        self.materials.push(material);
        self.nodes.push(json!({ "name": name, "mesh": self.meshes.len() }));
        self.meshes.push(json!({ "name": name, "primitives": [part] }));
    }

    /// Vectors of three numbers; the number of their accessor.
    fn vectors(&mut self, vectors: &[[f32; 3]], with_ends: bool) -> usize {
        self.accessor(&vectors.concat(), f32::to_le_bytes, ARRAY_BUFFER, |count| {
            let mut accessor = json!({ "componentType": FLOAT, "type": "VEC3", "count": count / 3 });
            if with_ends {
                let end = |pick: fn(f32, f32) -> f32| {
                    vectors.iter().copied().reduce(|a, b| [0, 1, 2].map(|axis| pick(a[axis], b[axis])))
                };
                accessor["min"] = json!(end(f32::min));
                accessor["max"] = json!(end(f32::max));
            }
            accessor
        })
    }

    fn accessor<T: Copy>(
        &mut self,
        values: &[T],
        bytes: fn(T) -> [u8; 4],
        target: u32,
        accessor: impl FnOnce(usize) -> Value,
    ) -> usize {
        let offset = self.bytes.len();
        self.bytes.extend(values.iter().flat_map(|value| bytes(*value)));
        let mut accessor = accessor(values.len());
        accessor["bufferView"] = self.views.len().into();
        self.views.push(json!({ "buffer": 0, "byteOffset": offset, "byteLength": 4 * values.len(), "target": target }));
        self.accessors.push(accessor);
        self.accessors.len() - 1
    }

    /// The header, the JSON and the bytes, each filled to four bytes.
    fn finish(self, notes: Map<String, Value>) -> Vec<u8> {
        let generator = concat!("droptower ", env!("CARGO_PKG_VERSION"));
        let mut file = Map::new();
        file.insert("asset".into(), json!({ "version": "2.0", "generator": generator, "extras": notes }));
        // The format knows no empty lists.
        if !self.nodes.is_empty() {
            file.insert("scene".into(), 0.into());
            file.insert("scenes".into(), json!([{ "nodes": (0..self.nodes.len()).collect::<Vec<_>>() }]));
            let lists = [
                ("nodes", self.nodes),
                ("meshes", self.meshes),
                ("materials", self.materials),
                ("accessors", self.accessors),
                ("bufferViews", self.views),
                ("buffers", vec![json!({ "byteLength": self.bytes.len() })]),
            ];
            file.extend(lists.map(|(name, list)| (name.to_owned(), list.into())));
        }
        let mut text = Value::from(file).to_string().into_bytes();
        text.resize(text.len().next_multiple_of(4), b' ');
        let chunks: Vec<(&[u8; 4], &[u8])> = [(b"JSON", &text[..]), (b"BIN\0", &self.bytes[..])]
            .into_iter()
            .filter(|(_, content)| !content.is_empty())
            .collect();
        let length: usize = 12 + chunks.iter().map(|(_, content)| 8 + content.len()).sum::<usize>();
        let mut out = Vec::with_capacity(length);
        out.extend(b"glTF");
        out.extend(2_u32.to_le_bytes());
        out.extend((length as u32).to_le_bytes());
        for (kind, content) in chunks {
            out.extend((content.len() as u32).to_le_bytes());
            out.extend(kind);
            out.extend(content);
        }
        out
    }
}

/// A point whose z points up with y upwards.
fn upright([x, y, z]: [f32; 3]) -> [f32; 3] {
    [x, z, -y]
}

/// A part of a colour in sRGB (0 to 255) as linear light (0 to 1), IEC 61966-2-1.
fn linear(part: f32) -> f32 {
    let part = part / 255.0;
    if part <= 0.04045 { part / 12.92 } else { ((part + 0.055) / 1.055).powf(2.4) }
}

/// Colour of impactors and bars, sRGB.
const BODY: [f32; 3] = [150.0, 154.0, 162.0];

impl ScenePicture<'_> {
    /// The film in the colours of the field, a surface a face, then the impactors and the bars of the frame.
    pub fn surfaces(&self) -> Vec<Surface> {
        let faces = self.scene.faces.iter().zip(&self.state.films);
        let film = (1..).zip(faces).map(|(number, (face, film))| self.film(number, face, film));
        let bodies = self.scene.bodies.iter().zip(poses(self.state));
        film.chain((1..).zip(bodies).map(|(number, (part, pose))| body(number, part, pose))).collect()
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
        let values = self.field.at_nodes(face, film);
        let drawn = face.drawn(film);
        let (mut points, mut colours, mut patches) = (vec![], vec![], vec![]);
        let mut known: HashMap<(u32, [u32; 3]), u32> = HashMap::new();
        for image in self.images(face) {
            let mut point = |node: u32| {
                // Minus zero is zero.
                let place = image.reflect(film.positions[node as usize]).map(|c| c + 0.0);
                *known.entry((node, place.map(f32::to_bits))).or_insert_with(|| {
                    points.push(Vector3::from(place.map(f64::from)));
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
                patches.push(corners);
            }
        }
        Surface { name: format!("film {number}"), points, patches, look: Look::Film(colours), crease: CREASES[0] }
    }
}

fn body(number: usize, body: &SceneBody, pose: Isometry3<f64>) -> Surface {
    Surface {
        name: format!("body {number}"),
        points: body.placed(pose).collect(),
        patches: body.patches.clone(),
        look: Look::Body(BODY),
        crease: CREASES[1],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A square in z = 1 and a triangle that is upright at its edge; the last point is that of neither.
    fn folded(crease: f64) -> Surface {
        let points = vec![
            [0.0, 0.0, 1.0],
            [1.0, 0.0, 1.0],
            [1.0, 1.0, 1.0],
            [0.0, 1.0, 1.0],
            [1.0, 0.5, 2.0],
            [f64::NAN, 0.0, 0.0],
        ];
        let points = points.into_iter().map(Vector3::from).collect();
        let colours = vec![[255.0, 0.0, 0.0]; 6];
        let patches = vec![[0, 1, 2, 3], [1, 4, 2, 2]];
        Surface { name: "film".into(), points, patches, look: Look::Film(colours), crease }
    }

    /// JSON and bytes of a file, whose lengths are those that it states.
    fn parts(file: &[u8]) -> (Value, &[u8]) {
        let number = |at: usize| u32::from_le_bytes(file[at..at + 4].try_into().unwrap()) as usize;
        assert_eq!((&file[..4], number(4), number(8)), (&b"glTF"[..], 2, file.len()));
        let text = &file[20..20 + number(12)];
        let rest = 20 + text.len();
        assert_eq!((&file[16..20], text.len() % 4), (&b"JSON"[..], 0));
        let bytes = if rest < file.len() { &file[rest + 8..] } else { &[] };
        (serde_json::from_slice(text).unwrap(), bytes)
    }

    fn floats(json: &Value, bytes: &[u8], accessor: &Value) -> Vec<f32> {
        let view = &json["bufferViews"]
            [json["accessors"][accessor.as_u64().unwrap() as usize]["bufferView"].as_u64().unwrap() as usize];
        let [from, length] = ["byteOffset", "byteLength"].map(|key| view[key].as_u64().unwrap() as usize);
        bytes[from..][..length].chunks(4).map(|part| f32::from_le_bytes(part.try_into().unwrap())).collect()
    }

    #[test]
    fn a_surface_stands_upright_and_is_split_at_sharp_edges() {
        for (crease, vertices) in [(0.5, 7), (-1.0, 5)] {
            let file = binary(&[folded(crease)], &[], Map::new());
            let (json, bytes) = parts(&file);
            let attributes = &json["meshes"][0]["primitives"][0]["attributes"];
            let positions = floats(&json, bytes, &attributes["POSITION"]);
            assert_eq!(positions.len(), 3 * vertices);
            assert_eq!(json["accessors"][0]["min"], json!([0.0, 1.0, -1.0]));
            assert_eq!(json["accessors"][0]["max"], json!([1.0, 2.0, 0.0]));
            let normals = floats(&json, bytes, &attributes["NORMAL"]);
            assert!(normals.chunks(3).all(|n| (n.iter().map(|c| c * c).sum::<f32>() - 1.0).abs() < 1e-6));
            assert_eq!(normals[..3], [0.0, 1.0, 0.0], "the square faces upwards");
            let colours = floats(&json, bytes, &attributes["COLOR_0"]);
            assert_eq!(colours[..3], [1.0, 0.0, 0.0]);
            assert_eq!(json["materials"][0]["doubleSided"], true);
        }
    }

    #[test]
    fn lines_are_a_mesh_of_their_own_behind_the_surfaces() {
        let lines =
            Lines { name: "springs 1".into(), ends: vec![[[0.0, 2.0, 1.0], [0.0, 1.0, 1.5]]], colour: [255.0; 3] };
        let alone = binary(&[folded(0.5)], &[], Map::new());
        let file = binary(&[folded(0.5)], &[lines], Map::new());
        let ((json, bytes), (without, of_surface)) = (parts(&file), parts(&alone));
        assert!(bytes.starts_with(of_surface) && json["meshes"][0] == without["meshes"][0]);
        assert_eq!(json["nodes"][1], json!({ "name": "springs 1", "mesh": 1 }));
        let part = &json["meshes"][1]["primitives"][0];
        assert_eq!((&part["mode"], &part["material"]), (&json!(LINES), &json!(1)));
        let positions = floats(&json, bytes, &part["attributes"]["POSITION"]);
        assert_eq!(positions, [0.0, 1.0, -2.0, 0.0, 1.5, -1.0]);
        assert_eq!(json["materials"][1]["pbrMetallicRoughness"]["baseColorFactor"], json!([1.0, 1.0, 1.0, 1.0]));
    }

    #[test]
    fn a_scene_without_anything_to_show_is_a_file_still() {
        let nothing = Surface { patches: vec![[0, 0, 1, 1]], ..folded(0.5) };
        let notes = Map::from_iter([("time_s".to_owned(), json!(0.057))]);
        let none = Lines { name: "springs".into(), ends: vec![], colour: [0.0; 3] };
        let file = binary(&[nothing], &[none], notes);
        let (json, bytes) = parts(&file);
        assert!(bytes.is_empty() && json.get("meshes").is_none());
        assert_eq!(json["asset"]["extras"]["time_s"], 0.057);
    }

    #[test]
    fn colours_are_linear_light() {
        for (part, expected) in [(0.0, 0.0), (255.0, 1.0), (128.0, 0.215_860_5), (5.0, 0.001_517_635)] {
            assert!((linear(part) - expected).abs() < 1e-6, "{part}");
        }
    }
}
