//! Outlines from DXF and SVG. Of DXF closed polylines and circles, and lines and arcs are read.

use std::f64::consts::{PI, TAU};
use std::path::Path;

use nalgebra::{Point2, Rotation2};

use super::svg;
use crate::mesh::{MeshError, MeshErrorKind, Polygon, fault};
use base::file;

/// Distance over the extent of the drawing below which two ends join.
const JOINED: f64 = 1e-6;
/// Most lines of a drawing.
const MOST_LINES: usize = 10_000;

/// Lines of a drawing, in its units.
#[derive(Default)]
pub(super) struct Drawing {
    /// m.
    pub(super) unit: Option<f64>,
    /// Corners of closed lines.
    pub(super) closed: Vec<Vec<Point2<f64>>>,
    /// Points of open ones.
    pub(super) open: Vec<Vec<Point2<f64>>>,
}

impl Drawing {
    /// The loops, of closed lines and of open ones that join.
    pub(super) fn loops(self) -> Result<Vec<Vec<Point2<f64>>>, MeshError> {
        let Drawing { closed, mut open, .. } = self;
        if closed.len() + open.len() > MOST_LINES {
            let lines = closed.len() + open.len();
            return Err(fault!("the drawing has {lines} lines; at most {MOST_LINES} are read"));
        }
        let extent = closed.iter().chain(&open).flatten().map(|p| p.coords.amax()).fold(0.0, f64::max);
        let near = |a: &Point2<f64>, b: &Point2<f64>| (a - b).norm() <= JOINED * extent;
        let mut loops: Vec<Vec<Point2<f64>>> = closed;
        open.retain(|line| line.len() > 1);
        while let Some(mut line) = open.pop() {
            while !near(&line[0], &line[line.len() - 1]) || line.len() < 3 {
                let end = line[line.len() - 1];
                let next = open.iter().position(|other| near(&other[0], &end) || near(&other[other.len() - 1], &end));
                let [x, y] = end.into();
                let mut other = next.map(|next| open.remove(next)).ok_or_else(|| {
                    fault!("the lines end at ({x}, {y}) in units of the drawing, where no other continues")
                })?;
                if !near(&other[0], &end) {
                    other.reverse();
                }
                line.extend(other.into_iter().skip(1));
            }
            loops.push(line);
        }
        for corners in &mut loops {
            corners.dedup_by(|a, b| near(a, b));
            while corners.len() > 1 && near(&corners[0], &corners[corners.len() - 1]) {
                corners.pop();
            }
        }
        Ok(loops)
    }
}

/// Most angle between two corners along an arc, rad.
const STEP: f64 = PI / 90.0;
/// Entities that are no lines of an outline.
const NOTES: [&str; 7] = ["TEXT", "MTEXT", "DIMENSION", "LEADER", "POINT", "VIEWPORT", "ATTDEF"];

/// The lines of a file.
///
/// # Errors
/// [`MeshError`].
pub(super) fn read(text: &[u8]) -> Result<Drawing, MeshError> {
    if text.starts_with(b"AutoCAD Binary DXF") {
        return Err(fault!("the file is binary DXF; save it as ASCII"));
    }
    // Texts of notes may be in any encoding; what is read is ASCII.
    Drawing::read(&String::from_utf8_lossy(text))
}

/// A line of the file that has no group code or number where one belongs.
fn no_number(line: usize, text: &str) -> MeshError {
    fault!("line {line}: expected a number, found `{}`", text.chars().take(40).collect::<String>())
}

/// An entity that is no line of an outline that is read.
fn unsupported(entity: &str) -> MeshError {
    fault!(
        "the entity {entity} is not supported; draw outlines with LWPOLYLINE, POLYLINE, LINE, ARC and CIRCLE in the x-y plane"
    )
}

/// Group codes and values of one entity.
struct Entity<'a> {
    kind: &'a str,
    groups: Vec<(i32, &'a str, usize)>,
}

impl Drawing {
    fn read(text: &str) -> Result<Drawing, MeshError> {
        let mut drawing = Drawing::default();
        let (mut section, mut variable) = ("", "");
        let mut entities: Vec<Entity<'_>> = vec![];
        let mut lines = text.lines().map(str::trim).enumerate();
        while let (Some((line, code)), Some((_, value))) = (lines.next(), lines.next()) {
            let wrong = || no_number(line + 1, code);
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

    fn draw(&mut self, entities: &[Entity<'_>]) -> Result<(), MeshError> {
        let mut entities = entities.iter();
        while let Some(entity) = entities.next() {
            if entity.number(230)?.is_some_and(|along| along < 0.0) {
                return Err(unsupported(&format!("{} seen from below", entity.kind)));
            }
            match entity.kind {
                "LINE" => self.open.push(vec![entity.point(10)?, entity.point(11)?]),
                "CIRCLE" => self.closed.push(arc(entity.point(10)?, entity.radius()?, 0.0, TAU, false)),
                "ARC" => {
                    let angle = |code| Ok::<f64, MeshError>(entity.number(code)?.unwrap_or(0.0).to_radians());
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
                other => return Err(unsupported(other)),
            }
        }
        Ok(())
    }

    /// Adds a polyline of vertices with the bulges of the edges that begin there.
    fn line(&mut self, entity: &Entity<'_>, vertices: Vec<(Point2<f64>, f64)>) -> Result<(), MeshError> {
        let flags = entity.number(70)?.unwrap_or(0.0) as u32;
        // Meshes and fitted curves are polylines too.
        if flags & !(1 | 128) != 0 {
            return Err(unsupported(&format!("{} with flags {flags}", entity.kind)));
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
    fn number(&self, code: i32) -> Result<Option<f64>, MeshError> {
        let group = self.groups.iter().find(|group| group.0 == code);
        group.map(|(_, value, line)| number(value, *line)).transpose()
    }

    /// The point whose x has this group code, and whose y the one ten above it.
    fn point(&self, code: i32) -> Result<Point2<f64>, MeshError> {
        let missing = || unsupported(&format!("{} without coordinates", self.kind));
        let coordinate = |code| self.number(code)?.ok_or_else(missing);
        Ok(Point2::new(coordinate(code)?, coordinate(code + 10)?))
    }

    fn radius(&self) -> Result<f64, MeshError> {
        let missing = || unsupported(&format!("{} without a radius", self.kind));
        self.number(40)?.filter(|radius| *radius > 0.0).ok_or_else(missing)
    }

    /// Vertices and bulges of a polyline.
    fn vertices(&self) -> Result<Vec<(Point2<f64>, f64)>, MeshError> {
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

fn number(text: &str, line: usize) -> Result<f64, MeshError> {
    let value: Option<f64> = text.parse().ok().filter(|value: &f64| value.is_finite());
    value.ok_or_else(|| no_number(line, text))
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

/// Reads the bytes of a drawing.
type Reader = fn(&[u8]) -> Result<Drawing, MeshError>;

/// Longest file that is read, bytes.
const MOST_BYTES: u64 = 64 << 20;
/// Coordinates are whole numbers over this, 1/m: a power of two, 0.001 nm apart.
const ROUNDED: f64 = (1_u64 << 40) as f64;

/// The outline drawn in a DXF or SVG file, with the drawing's own unit, or `unit` (m) where it gives none. The largest
/// loop is the outline, the others are its holes.
///
/// # Errors
/// [`MeshError`].
pub fn polygon(path: &Path, unit: Option<f64>) -> Result<Polygon, MeshError> {
    let (read, by): (Reader, _) = match super::extension(path).as_str() {
        "dxf" => (read, "$INSUNITS"),
        "svg" => (svg::read, "width and height"),
        _ => return Err(fault!("expected a file .dxf or .svg")),
    };
    let drawing = read(&file::read(path, MOST_BYTES)?)?;
    let unit = match (drawing.unit, unit) {
        (Some(own), Some(given)) if (own / given - 1.0).abs() > 1e-9 => {
            let message = format!("the drawing has another unit: one is {own} m by its {by}");
            return Err(MeshError::new(MeshErrorKind::OtherUnit, message));
        }
        (own, given) => own.or(given).ok_or_else(|| {
            MeshError::new(MeshErrorKind::NoUnit, format!("the drawing gives no unit ({by} of the file)"))
        })?,
    };
    let mut loops = drawing.loops()?;
    let area = |corners: &[Point2<f64>]| {
        let next = corners.iter().cycle().skip(1);
        corners.iter().zip(next).map(|(a, b)| a.coords.perp(&b.coords)).sum::<f64>().abs()
    };
    loops.sort_by(|a, b| area(b).total_cmp(&area(a)));
    let mut loops =
        loops.into_iter().map(|corners| corners.iter().map(|p| [p.x, p.y].map(|c| rounded(c * unit))).collect());
    let outer = loops.next().ok_or_else(|| fault!("the drawing has no lines"))?;
    Ok(Polygon { outer, holes: loops.collect() })
}

/// A coordinate without its last digits, in which the sines of machines differ: meshes of one drawing are the same.
fn rounded(coordinate: f64) -> f64 {
    (coordinate * ROUNDED).round() / ROUNDED
}
