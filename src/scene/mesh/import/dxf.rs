//! Lines of DXF: closed polylines and circles, and lines and arcs.

use std::f64::consts::{PI, TAU};

use nalgebra::{Point2, Rotation2};

use super::drawing::{Drawing, DrawingFault};

/// Most angle between two corners along an arc, rad.
const STEP: f64 = PI / 90.0;
/// Entities that are no lines of an outline.
const NOTES: [&str; 7] = ["TEXT", "MTEXT", "DIMENSION", "LEADER", "POINT", "VIEWPORT", "ATTDEF"];

/// The lines of a file.
///
/// # Errors
/// [`DrawingFault`].
pub(super) fn read(text: &[u8]) -> Result<Drawing, DrawingFault> {
    if text.starts_with(b"AutoCAD Binary DXF") {
        return Err(DrawingFault::Binary);
    }
    // Texts of notes may be in any encoding; what is read is ASCII.
    Drawing::read(&String::from_utf8_lossy(text))
}

/// Group codes and values of one entity.
struct Entity<'a> {
    kind: &'a str,
    groups: Vec<(i32, &'a str, usize)>,
}

impl Drawing {
    fn read(text: &str) -> Result<Drawing, DrawingFault> {
        let mut drawing = Drawing::default();
        let (mut section, mut variable) = ("", "");
        let mut entities: Vec<Entity<'_>> = vec![];
        let mut lines = text.lines().map(str::trim).enumerate();
        while let (Some((line, code)), Some((_, value))) = (lines.next(), lines.next()) {
            let wrong = || DrawingFault::Number { line: line + 1, text: code.chars().take(40).collect() };
            let code: i32 = code.parse().map_err(|_| wrong())?;
            match (code, value) {
                (0, "EOF") => break,
                (0, "SECTION" | "ENDSEC") => section = "",
                (2, name) if section.is_empty() => section = name,
                (9, name) if section == "HEADER" => variable = name,
                (70, value) if section == "HEADER" && variable == "$INSUNITS" => drawing.unit = metres(value),
                (0, kind) if section == "ENTITIES" => entities.push(Entity { kind, groups: vec![] }),
                _ if section == "ENTITIES" => {
                    entities
                        .iter_mut()
                        .last()
                        .into_iter()
                        .for_each(|entity| entity.groups.push((code, value, line + 2)));
                }
                _ => {}
            }
        }
        drawing.draw(&entities)?;
        Ok(drawing)
    }

    fn draw(&mut self, entities: &[Entity<'_>]) -> Result<(), DrawingFault> {
        let mut entities = entities.iter();
        while let Some(entity) = entities.next() {
            if entity.number(230)?.is_some_and(|along| along < 0.0) {
                return Err(DrawingFault::Entity { entity: format!("{} seen from below", entity.kind) });
            }
            match entity.kind {
                "LINE" => self.open.push(vec![entity.point(10)?, entity.point(11)?]),
                "CIRCLE" => self.closed.push(arc(entity.point(10)?, entity.radius()?, 0.0, TAU, false)),
                "ARC" => {
                    let angle = |code| Ok::<f64, DrawingFault>(entity.number(code)?.unwrap_or(0.0).to_radians());
                    let (from, to) = (angle(50)?, angle(51)?);
                    let turn = (to - from).rem_euclid(TAU);
                    let turn = if turn == 0.0 { TAU } else { turn };
                    self.open.push(arc(entity.point(10)?, entity.radius()?, from, turn, true));
                }
                "LWPOLYLINE" => self.line(entity, entity.vertices()?)?,
                "POLYLINE" => {
                    let mut vertices = vec![];
                    for vertex in entities.by_ref().take_while(|entity| entity.kind != "SEQEND") {
                        vertices.extend(vertex.vertices()?);
                    }
                    self.line(entity, vertices)?;
                }
                note if NOTES.contains(&note) => {}
                other => return Err(DrawingFault::Entity { entity: other.to_owned() }),
            }
        }
        Ok(())
    }

    /// Adds a polyline of vertices with the bulges of the edges that begin there.
    fn line(&mut self, entity: &Entity<'_>, vertices: Vec<(Point2<f64>, f64)>) -> Result<(), DrawingFault> {
        let flags = entity.number(70)?.unwrap_or(0.0) as u32;
        // Meshes and fitted curves are polylines too.
        if flags & !(1 | 128) != 0 {
            return Err(DrawingFault::Entity { entity: format!("{} with flags {flags}", entity.kind) });
        }
        let closed = flags & 1 == 1;
        let count = vertices.len();
        let mut line = vec![];
        for (place, &(from, bulge)) in vertices.iter().enumerate() {
            match vertices.get((place + 1) % count).filter(|_| closed || place + 1 < count) {
                Some(&(to, _)) if bulge != 0.0 => line.extend(bulged(from, to, bulge)),
                _ => line.push(from),
            }
        }
        if closed {
            self.closed.push(line)
        } else {
            self.open.push(line)
        }
        Ok(())
    }
}

impl Entity<'_> {
    /// The first number of a group code.
    fn number(&self, code: i32) -> Result<Option<f64>, DrawingFault> {
        let group = self.groups.iter().find(|group| group.0 == code);
        group.map(|(_, value, line)| number(value, *line)).transpose()
    }

    /// The point whose x has this group code, and whose y the one ten above it.
    fn point(&self, code: i32) -> Result<Point2<f64>, DrawingFault> {
        let missing = || DrawingFault::Entity { entity: format!("{} without coordinates", self.kind) };
        let coordinate = |code| self.number(code)?.ok_or_else(missing);
        Ok(Point2::new(coordinate(code)?, coordinate(code + 10)?))
    }

    fn radius(&self) -> Result<f64, DrawingFault> {
        let missing = || DrawingFault::Entity { entity: format!("{} without a radius", self.kind) };
        self.number(40)?.filter(|radius| *radius > 0.0).ok_or_else(missing)
    }

    /// Vertices and bulges of a polyline.
    fn vertices(&self) -> Result<Vec<(Point2<f64>, f64)>, DrawingFault> {
        let mut vertices: Vec<(Point2<f64>, f64)> = vec![];
        for &(code, value, line) in &self.groups {
            if code == 10 {
                vertices.push((Point2::new(number(value, line)?, 0.0), 0.0));
            }
            let Some(last) = vertices.last_mut() else { continue };
            match code {
                20 => last.0.y = number(value, line)?,
                42 => last.1 = number(value, line)?,
                _ => {}
            }
        }
        Ok(vertices)
    }
}

fn number(text: &str, line: usize) -> Result<f64, DrawingFault> {
    let value: Option<f64> = text.parse().ok().filter(|value: &f64| value.is_finite());
    value.ok_or_else(|| DrawingFault::Number { line, text: text.chars().take(40).collect() })
}

/// Length of the unit that $INSUNITS names, m.
fn metres(code: &str) -> Option<f64> {
    Some(match code {
        "1" => 0.0254,
        "2" => 0.3048,
        "4" => 1e-3,
        "5" => 1e-2,
        "6" => 1.0,
        "13" => 1e-6,
        "14" => 0.1,
        _ => return None,
    })
}

/// Corners along an arc from an angle by a turn (rad); of an open one with its end.
fn arc(centre: Point2<f64>, radius: f64, from: f64, turn: f64, open: bool) -> Vec<Point2<f64>> {
    let parts = (turn.abs() / STEP).ceil().max(1.0);
    let last = parts as u32 + u32::from(open);
    let at = |part: u32| {
        let (sin, cos) = (from + turn * f64::from(part) / parts).sin_cos();
        Point2::new(centre.x + radius * cos, centre.y + radius * sin)
    };
    (0..last).map(at).collect()
}

/// Corners along the edge of a polyline with a bulge, the tangent of a quarter of its turn; without its end.
fn bulged(from: Point2<f64>, to: Point2<f64>, bulge: f64) -> Vec<Point2<f64>> {
    let turn = 4.0 * bulge.atan();
    let chord = to - from;
    let left = nalgebra::Vector2::new(-chord.y, chord.x);
    let centre = from + 0.5 * chord + left * (0.5 / (0.5 * turn).tan());
    let parts = (turn.abs() / STEP).ceil().max(1.0);
    let at = |part: u32| centre + Rotation2::new(turn * f64::from(part) / parts) * (from - centre);
    (0..parts as u32).map(at).collect()
}
