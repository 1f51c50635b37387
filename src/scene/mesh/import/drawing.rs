//! Lines of a drawing: closed ones, and open ones that join into loops.

use nalgebra::Point2;
use thiserror::Error;

use base::file::FileError;

/// Distance over the extent of the drawing below which two ends join.
const JOINED: f64 = 1e-6;
/// Most lines of a drawing.
const MOST_LINES: usize = 10_000;

/// Why a file is no drawing of an outline.
#[derive(Debug, Error)]
pub enum DrawingFault {
    /// The file is unreadable.
    #[error("{0}")]
    Read(#[from] FileError),
    /// The extension is unknown.
    #[error("expected a file .dxf or .svg")]
    Format,
    /// The file is binary.
    #[error("the file is binary DXF; save it as ASCII")]
    Binary,
    /// A line has no group code or number where one belongs.
    #[error("line {line}: expected a number, found `{text}`")]
    Number {
        /// Counted from 1.
        line: usize,
        /// The content of the line.
        text: String,
    },
    /// An entity is no line of an outline that is read.
    #[error(
        "the entity {entity} is not supported; draw outlines with LWPOLYLINE, POLYLINE, LINE, ARC and CIRCLE in the x-y plane"
    )]
    Entity {
        /// Its type.
        entity: String,
    },
    /// The file is no XML.
    #[error("{0}")]
    Xml(#[from] roxmltree::Error),
    /// An element of an SVG file is no line of an outline that is read.
    #[error(
        "line {line}: <{element}> is not supported; draw outlines with path, polygon, polyline, line, rect, circle and ellipse"
    )]
    Element {
        /// Its name.
        element: String,
        /// Counted from 1.
        line: u32,
    },
    /// An attribute of an SVG file cannot be read.
    #[error("line {line}: `{attribute}` of <{element}> cannot be read")]
    Attribute {
        /// Name of the element.
        element: String,
        /// Name of the attribute.
        attribute: String,
        /// Counted from 1.
        line: u32,
    },
    /// An element of an SVG file has a coordinate that no drawing has.
    #[error("line {line}: a coordinate is larger than any drawing")]
    Far {
        /// Counted from 1.
        line: u32,
    },
    /// Width and height of an SVG file have other ratios to its view box.
    #[error("width and height of the drawing do not have the ratio of its viewBox")]
    Distorted,
    /// There is no loop.
    #[error("the drawing has no lines")]
    Empty,
    /// Lines do not join into a loop.
    #[error("the lines end at ({}, {}) in units of the drawing, where no other continues", .at[0], .at[1])]
    Open {
        /// Units of the drawing.
        at: [f64; 2],
    },
    /// There are more lines than an outline has.
    #[error("the drawing has {lines} lines; at most {MOST_LINES} are read")]
    TooMany {
        /// Their number.
        lines: usize,
    },
    /// The drawing gives no unit.
    #[error("the drawing gives no unit ({} of the file)", .by)]
    NoUnit {
        /// The entry of the file that would give it.
        by: &'static str,
    },
    /// The drawing gives another unit than the scenario.
    #[error("the drawing has another unit: one is {drawing} m by its {by}")]
    OtherUnit {
        /// m.
        drawing: f64,
        /// The entry of the file that gives it.
        by: &'static str,
    },
}

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
    pub(super) fn loops(self) -> Result<Vec<Vec<Point2<f64>>>, DrawingFault> {
        let Drawing { closed, mut open, .. } = self;
        if closed.len() + open.len() > MOST_LINES {
            return Err(DrawingFault::TooMany { lines: closed.len() + open.len() });
        }
        let extent = closed.iter().chain(&open).flatten().map(|p| p.coords.amax()).fold(0.0, f64::max);
        let near = |a: &Point2<f64>, b: &Point2<f64>| (a - b).norm() <= JOINED * extent;
        let mut loops: Vec<Vec<Point2<f64>>> = closed;
        open.retain(|line| line.len() > 1);
        while let Some(mut line) = open.pop() {
            while !near(&line[0], &line[line.len() - 1]) || line.len() < 3 {
                let end = line[line.len() - 1];
                let next = open.iter().position(|other| near(&other[0], &end) || near(&other[other.len() - 1], &end));
                let mut other = next.map(|next| open.remove(next)).ok_or(DrawingFault::Open { at: end.into() })?;
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
