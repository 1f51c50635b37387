//! Lines of SVG: paths and basic shapes with their transforms. The y axis of a film points up, that of SVG down: y
//! changes its sign.

use std::str::FromStr;

use kurbo::{Affine, BezPath, Circle, Ellipse, PathEl, Point, Rect, RoundedRect, Shape};
use nalgebra::Point2;
use roxmltree::{Document, Node};
use svgtypes::{Length, LengthUnit, PointsParser, Transform, ViewBox};

use super::drawing::{Drawing, DrawingFault};

/// Most distance between a curve and its chords over the extent of the path.
const TOLERANCE: f64 = 5e-5;
/// Elements without lines, and those whose content is not drawn.
const NOTES: [&str; 8] = ["title", "desc", "metadata", "style", "defs", "text", "namedview", "script"];

/// The lines of a file.
///
/// # Errors
/// [`DrawingFault`].
pub(super) fn read(text: &[u8]) -> Result<Drawing, DrawingFault> {
    let text = String::from_utf8_lossy(text);
    let options = roxmltree::ParsingOptions { allow_dtd: true, ..roxmltree::ParsingOptions::default() };
    let document = Document::parse_with_options(&text, options)?;
    let root = document.root_element();
    let mut drawing = Drawing { unit: unit(&root)?, ..Drawing::default() };
    elements(&root, Affine::FLIP_Y, &mut drawing)?;
    Ok(drawing)
}

/// Length of a unit of the drawing, m, by its width and height; none where these have no unit of length.
fn unit(root: &Node<'_, '_>) -> Result<Option<f64>, DrawingFault> {
    let view: Option<ViewBox> = attribute(root, "viewBox")?;
    let [width, height] = ["width", "height"].map(|name| attribute::<Length>(root, name));
    let metres = |length: Option<Length>| length.and_then(|length| Some(length.number * metres(length.unit)?));
    let (width, height) = (metres(width?), metres(height?));
    let Some(ViewBox { w, h, .. }) = view else {
        // A unit is a pixel: the width of the page says nothing about it but that pixels have one.
        return Ok(width.or(height).map(|_| PIXEL));
    };
    match (width.map(|width| width / w), height.map(|height| height / h)) {
        (Some(x), Some(y)) if (x / y - 1.0).abs() > 1e-3 => Err(DrawingFault::Distorted),
        (x, y) => Ok(x.or(y)),
    }
}

/// Length of a pixel of CSS, m.
const PIXEL: f64 = 0.0254 / 96.0;

/// Length of a unit, m; none of pixels, which drawings use for any unit, and of what depends on a font or a page.
fn metres(unit: LengthUnit) -> Option<f64> {
    match unit {
        LengthUnit::Mm => Some(1e-3),
        LengthUnit::Cm => Some(1e-2),
        LengthUnit::In => Some(0.0254),
        LengthUnit::Pt => Some(0.0254 / 72.0),
        LengthUnit::Pc => Some(0.0254 / 6.0),
        LengthUnit::None | LengthUnit::Px | LengthUnit::Em | LengthUnit::Ex | LengthUnit::Percent => None,
    }
}

/// Draws the elements in `parent`, whose coordinates `place` transforms.
fn elements(parent: &Node<'_, '_>, place: Affine, drawing: &mut Drawing) -> Result<(), DrawingFault> {
    for element in parent.children().filter(Node::is_element) {
        let own: Option<Transform> = attribute(&element, "transform")?;
        let place = own.map_or(place, |t| place * Affine::new([t.a, t.b, t.c, t.d, t.e, t.f]));
        let name = element.tag_name().name();
        let is_note = NOTES.contains(&name) || is_hidden(&element);
        match name {
            _ if is_note => {}
            "g" | "a" => elements(&element, place, drawing)?,
            _ => lines(place * outline(&element)?, drawing),
        }
    }
    Ok(())
}

/// Whether an element is not shown, by its attribute or its style.
fn is_hidden(element: &Node<'_, '_>) -> bool {
    let in_style = |style: &str| {
        let declarations = style.split(';').filter_map(|declaration| declaration.split_once(':'));
        declarations.into_iter().any(|(property, value)| property.trim() == "display" && value.trim() == "none")
    };
    element.attribute("display") == Some("none") || element.attribute("style").is_some_and(in_style)
}

/// The lines of an element, in its own coordinates.
fn outline(element: &Node<'_, '_>) -> Result<BezPath, DrawingFault> {
    let number = |name: &str| -> Result<f64, DrawingFault> {
        match attribute::<Length>(element, name)? {
            None => Ok(0.0),
            Some(Length { number, unit: LengthUnit::None | LengthUnit::Px }) => Ok(number),
            Some(_) => Err(unreadable(element, name)),
        }
    };
    let centre = || Ok::<Point, DrawingFault>(Point::new(number("cx")?, number("cy")?));
    Ok(match element.tag_name().name() {
        "path" => {
            let data = element.attribute("d").unwrap_or_default();
            BezPath::from_svg(data).map_err(|_| unreadable(element, "d"))?
        }
        name @ ("polygon" | "polyline") => {
            let text = element.attribute("points").unwrap_or_default();
            let mut path = BezPath::new();
            for (place, (x, y)) in PointsParser::from(text).enumerate() {
                let to = Point::new(x, y);
                if place == 0 { path.move_to(to) } else { path.line_to(to) }
            }
            if name == "polygon" && !path.elements().is_empty() {
                path.close_path();
            }
            path
        }
        "line" => {
            let mut path = BezPath::new();
            path.move_to((number("x1")?, number("y1")?));
            path.line_to((number("x2")?, number("y2")?));
            path
        }
        "rect" => {
            let (x, y) = (number("x")?, number("y")?);
            let (width, height) = (number("width")?, number("height")?);
            let rect = Rect::new(x, y, x + width, y + height);
            let [rx, ry] = [number("rx")?, number("ry")?];
            // One that is not written is the other; quarters of an ellipse are not supported.
            if rx > 0.0 && ry > 0.0 && rx != ry {
                return Err(unreadable(element, "ry"));
            }
            let rounding = rx.max(ry).min(0.5 * width).min(0.5 * height);
            // A rounding that does nothing would leave arcs of no length.
            if rounding > 0.0 { curved(&RoundedRect::from_rect(rect, rounding)) } else { rect.to_path(1.0) }
        }
        "circle" => curved(&Circle::new(centre()?, number("r")?)),
        "ellipse" => curved(&Ellipse::new(centre()?, (number("rx")?, number("ry")?), 0.0)),
        other => {
            return Err(DrawingFault::Element { element: other.to_owned(), line: line(element) });
        }
    })
}

/// The path of a shape with curves.
fn curved(shape: &impl Shape) -> BezPath {
    shape.to_path(tolerance(shape.bounding_box()))
}

/// Most distance of chords from a curve within `bounds`.
fn tolerance(bounds: Rect) -> f64 {
    (TOLERANCE * bounds.width().max(bounds.height())).max(f64::MIN_POSITIVE)
}

/// Adds the subpaths of `path` to `drawing`, curves as chords.
fn lines(path: BezPath, drawing: &mut Drawing) {
    let mut line: Vec<Point2<f64>> = vec![];
    let mut open = |line: &mut Vec<Point2<f64>>| {
        let line = std::mem::take(line);
        if line.len() > 1 {
            drawing.open.push(line);
        }
    };
    let mut closed = vec![];
    let point = |p: Point| Point2::new(p.x, p.y);
    kurbo::flatten(path.iter(), tolerance(path.bounding_box()), |element| match element {
        PathEl::MoveTo(to) => {
            open(&mut line);
            line.push(point(to));
        }
        PathEl::ClosePath => {
            let corners = std::mem::take(&mut line);
            // What follows without a move begins where the loop does.
            line.extend(corners.first());
            if corners.len() > 1 {
                closed.push(corners);
            }
        }
        PathEl::LineTo(to) | PathEl::QuadTo(_, to) | PathEl::CurveTo(_, _, to) => line.push(point(to)),
    });
    open(&mut line);
    drawing.closed.append(&mut closed);
}

/// The value of an attribute; none where it is left out.
fn attribute<T: FromStr>(element: &Node<'_, '_>, name: &str) -> Result<Option<T>, DrawingFault> {
    let read = |text: &str| text.trim().parse().map_err(|_| unreadable(element, name));
    element.attribute(name).map(read).transpose()
}

fn unreadable(element: &Node<'_, '_>, attribute: &str) -> DrawingFault {
    let element_name = element.tag_name().name().to_owned();
    DrawingFault::Attribute { element: element_name, attribute: attribute.to_owned(), line: line(element) }
}

/// Line of the file in which an element begins, from 1.
fn line(element: &Node<'_, '_>) -> u32 {
    element.document().text_pos_at(element.range().start).row
}
