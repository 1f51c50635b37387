//! Lines of SVG: paths and basic shapes with their transforms. The y axis of a film points up, that of SVG down: y
//! changes its sign.

use std::str::FromStr;

use kurbo::{Affine, BezPath, Circle, Ellipse, PathEl, Point, Rect, RoundedRect, Shape};
use nalgebra::Point2;
use roxmltree::{Document, Node};
use svgtypes::{Length, LengthUnit, PathParser, PathSegment, PointsParser, Transform, ViewBox};

use super::drawing::Drawing;
use crate::mesh::{MeshError, fault};

/// Most distance between a curve and its chords over the extent of the path.
const TOLERANCE: f64 = 5e-5;
/// Largest coordinate, in units of the drawing.
const FARTHEST: f64 = 1e12;
/// Least distance of chords from a curve over the largest coordinate: what is smaller is lost in the rounding of numbers.
const ROUNDING: f64 = 1e-15;
/// Elements without lines, and those whose content is not drawn.
const NOTES: [&str; 8] = ["title", "desc", "metadata", "style", "defs", "text", "namedview", "script"];

/// The lines of a file.
///
/// # Errors
/// [`MeshError`].
pub(super) fn read(text: &[u8]) -> Result<Drawing, MeshError> {
    let text = String::from_utf8_lossy(text);
    let options = roxmltree::ParsingOptions { allow_dtd: true, ..roxmltree::ParsingOptions::default() };
    let document = Document::parse_with_options(&text, options)?;
    let root = document.root_element();
    let mut drawing = Drawing { unit: unit(&root)?, ..Drawing::default() };
    elements(&root, Affine::FLIP_Y, &mut drawing)?;
    Ok(drawing)
}

/// Length of a unit of the drawing, m, by its width and height; none where these have no unit of length.
fn unit(root: &Node<'_, '_>) -> Result<Option<f64>, MeshError> {
    let view: Option<ViewBox> = attribute(root, "viewBox")?;
    let [width, height] = ["width", "height"].map(|name| attribute::<Length>(root, name));
    let metres = |length: Option<Length>| length.and_then(|length| Some(length.number * metres(length.unit)?));
    let (width, height) = (metres(width?), metres(height?));
    let Some(ViewBox { w, h, .. }) = view else {
        // A unit is a pixel: the width of the page says nothing about it but that pixels have one.
        return Ok(width.or(height).map(|_| PIXEL));
    };
    match (width.map(|width| width / w), height.map(|height| height / h)) {
        (Some(x), Some(y)) if (x / y - 1.0).abs() > 1e-3 => {
            Err(fault!("width and height of the drawing do not have the ratio of its viewBox"))
        }
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

/// Draws the elements in `root`, whose coordinates `place` transforms.
fn elements(root: &Node<'_, '_>, place: Affine, drawing: &mut Drawing) -> Result<(), MeshError> {
    // The groups around the present element, each with the rest of its content: a file may nest more of them than a stack
    // has room for calls.
    let mut groups = vec![(root.children(), place)];
    while let Some((content, place)) = groups.last_mut() {
        let Some(element) = content.find(Node::is_element) else {
            groups.pop();
            continue;
        };
        let own: Option<Transform> = attribute(&element, "transform")?;
        let place = own.map_or(*place, |t| *place * Affine::new([t.a, t.b, t.c, t.d, t.e, t.f]));
        let name = element.tag_name().name();
        let is_note = NOTES.contains(&name) || is_hidden(&element);
        match name {
            _ if is_note => {}
            "g" | "a" => groups.push((element.children(), place)),
            _ => {
                let path = place * outline(&element)?;
                if !reach(&path).is_some_and(|reach| reach <= FARTHEST) {
                    return Err(fault!("line {}: a coordinate is larger than any drawing", line(&element)));
                }
                lines(path, drawing);
            }
        }
    }
    Ok(())
}

/// Largest coordinate of a path and its control points; none where one is no number.
fn reach(path: &BezPath) -> Option<f64> {
    let points = path.iter().flat_map(|element| match element {
        PathEl::MoveTo(a) | PathEl::LineTo(a) => [Some(a), None, None],
        PathEl::QuadTo(a, b) => [Some(a), Some(b), None],
        PathEl::CurveTo(a, b, c) => [Some(a), Some(b), Some(c)],
        PathEl::ClosePath => [None; 3],
    });
    points.flatten().try_fold(0.0, |most: f64, p| (!p.is_nan()).then(|| most.max(p.x.abs()).max(p.y.abs())))
}

/// Whether the numbers of a path reach no further than [`FARTHEST`]: the parts of an arc grow with its radius, and kurbo lists
/// them all.
fn is_near(data: &str) -> bool {
    PathParser::from(data).all(|segment| {
        let numbers = match segment {
            Ok(PathSegment::MoveTo { x, y, .. } | PathSegment::LineTo { x, y, .. }) => vec![x, y],
            Ok(PathSegment::SmoothQuadratic { x, y, .. }) => vec![x, y],
            Ok(PathSegment::HorizontalLineTo { x, .. }) => vec![x],
            Ok(PathSegment::VerticalLineTo { y, .. }) => vec![y],
            Ok(PathSegment::CurveTo { x1, y1, x2, y2, x, y, .. }) => vec![x1, y1, x2, y2, x, y],
            Ok(PathSegment::SmoothCurveTo { x2, y2, x, y, .. }) => vec![x2, y2, x, y],
            Ok(PathSegment::Quadratic { x1, y1, x, y, .. }) => vec![x1, y1, x, y],
            Ok(PathSegment::EllipticalArc { rx, ry, x, y, .. }) => vec![rx, ry, x, y],
            Ok(PathSegment::ClosePath { .. }) => vec![],
            // kurbo says so too, or reads what no other program does.
            Err(_) => return false,
        };
        numbers.iter().all(|number| number.abs() <= FARTHEST)
    })
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
fn outline(element: &Node<'_, '_>) -> Result<BezPath, MeshError> {
    let number = |name: &str| -> Result<f64, MeshError> {
        match attribute::<Length>(element, name)? {
            None => Ok(0.0),
            Some(Length { number, unit: LengthUnit::None | LengthUnit::Px }) => Ok(number),
            Some(_) => Err(unreadable(element, name)),
        }
    };
    let centre = || Ok::<Point, MeshError>(Point::new(number("cx")?, number("cy")?));
    Ok(match element.tag_name().name() {
        "path" => {
            let data = element.attribute("d").unwrap_or_default();
            if !is_near(data) {
                return Err(unreadable(element, "d"));
            }
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
            return Err(fault!(
                "line {}: <{other}> is not supported; draw outlines with path, polygon, polyline, line, rect, circle and ellipse",
                line(element)
            ));
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
    let tolerance = tolerance(path.bounding_box()).max(ROUNDING * reach(&path).unwrap_or(0.0));
    kurbo::flatten(path.iter(), tolerance, |element| match element {
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
fn attribute<T: FromStr>(element: &Node<'_, '_>, name: &str) -> Result<Option<T>, MeshError> {
    let read = |text: &str| text.trim().parse().map_err(|_| unreadable(element, name));
    element.attribute(name).map(read).transpose()
}

fn unreadable(element: &Node<'_, '_>, attribute: &str) -> MeshError {
    fault!("line {}: `{attribute}` of <{}> cannot be read", line(element), element.tag_name().name())
}

/// Line of the file in which an element begins, from 1.
fn line(element: &Node<'_, '_>) -> u32 {
    element.document().text_pos_at(element.range().start).row
}

#[cfg(test)]
mod tests {
    use super::*;

    fn drawn(elements: &str) -> Result<Drawing, MeshError> {
        read(
            format!("<svg xmlns='http://www.w3.org/2000/svg' width='1mm' viewBox='0 0 1 1'>{elements}</svg>")
                .as_bytes(),
        )
    }

    #[test]
    fn groups_are_nested_as_deeply_as_they_are() {
        let count = 100_000;
        let circle = "<circle r='2'/>";
        let drawing = drawn(&format!("{}{circle}{}{circle}", "<g>".repeat(count), "</g>".repeat(count))).unwrap();
        assert_eq!(drawing.closed.len(), 2);
    }

    #[test]
    fn coordinates_beyond_all_drawings_are_refused() {
        for element in [
            "<path d='M0 0 C1e308 0 -1e308 1e308 5 5 Z'/>",
            "<path d='M0 0 A1e100 1e100 0 0 1 5 5 Z'/>",
            "<path d='M0 0 A1 1 0 0 1 1e100 5 Z'/>",
            "<path d='M0 0 q1 2 3 4 5 6 7 1e13'/>",
            "<g transform='scale(1e300)'><path transform='scale(1e300)' d='M0 0 C1 0 0 1 5 5 Z'/></g>",
            "<circle r='1e308' cx='1e308'/>",
            "<ellipse rx='1e308' ry='1e-300'/>",
        ] {
            let fault = drawn(element).err().map(|fault| fault.to_string()).unwrap_or_default();
            let is_expected = fault.ends_with("larger than any drawing") || fault.ends_with("cannot be read");
            assert!(is_expected, "{element}: {fault:?}");
        }
        let drawing = drawn("<path d='M9e11 1 c1e-4 0 0 1e-4 1e-4 1e-4 q1 1 -1 1 z'/>").unwrap();
        assert!(drawing.closed.iter().flatten().count() < 1000);
    }
}
