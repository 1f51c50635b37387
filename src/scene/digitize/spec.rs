//! A figure: its picture, axes and the colour of its curve, checked.

use std::io::BufReader;
use std::path::{Path, PathBuf};

use image::{DynamicImage, GenericImageView, ImageDecoder, ImageFormat, ImageReader, Limits, Rgb, RgbImage, Rgba};
use thiserror::Error;

use super::axes::{Axes, Axis};
use super::{Fidelity, Ink};
use crate::scenario::{self, Amount, AxisScale, Document};
use base::diagnostic::{Diagnostic, Diagnostics, shown_path};
use base::file::{self, FileError};
use lab::signal::column;

/// Most pixels of a picture: a page of A4 at 600 dots an inch has 35 million. A small file can hold any number of one colour.
const MOST_PIXELS: u64 = 40_000_000;

/// Most bytes of a picture as its decoder gives it.
const MOST_BYTES: u64 = 256 << 20;

/// A figure that can be digitized.
#[derive(Clone, Debug)]
pub struct Figure {
    /// Where the picture is.
    pub path: PathBuf,
    pub(super) picture: RgbImage,
    /// Its axes.
    pub axes: Axes,
    /// Colour of the curve.
    pub ink: Ink,
    /// Left, top, right and bottom of what is looked at, pixels.
    pub area: [usize; 4],
    /// Parts that are left out.
    pub without: Vec<[f64; 4]>,
    /// By how much the pixels of the axes' points may be wrong.
    pub pixel_error: f64,
    /// Least deviation of a line's middle in such a picture, pixels.
    pub least_scatter: f64,
}

/// Least deviation of a line's middle in a picture without loss, pixels: lines are drawn in steps about as large.
const LEAST_SCATTER: f64 = 0.1;

/// The least deviation in a JPEG, whose blocks of pixels have errors in common, which no scatter shows.
const LEAST_SCATTER_JPEG: f64 = 0.3;

/// A picture that cannot be read.
#[derive(Debug, Error)]
pub enum PictureError {
    /// It cannot be opened.
    #[error("cannot read {}: {source}", shown_path(path))]
    Read {
        /// The picture.
        path: PathBuf,
        /// Why.
        source: FileError,
    },
    /// It has too many pixels.
    #[error("{} has {width} × {height} pixels, more than {} million", shown_path(path), MOST_PIXELS / 1_000_000)]
    TooLarge {
        /// The picture.
        path: PathBuf,
        /// Pixels across.
        width: u32,
        /// Pixels down.
        height: u32,
    },
    /// It is no PNG or JPEG, or its content is damaged.
    #[error("{}: {source}", shown_path(path))]
    Decode {
        /// The picture.
        path: PathBuf,
        /// Why.
        source: image::ImageError,
    },
}

impl Figure {
    /// The figure that the file describes.
    ///
    /// # Errors
    /// All mistakes of the file, at once; a picture that cannot be read.
    pub fn check(document: &Document) -> Result<Figure, Vec<Diagnostic>> {
        let (written, mistakes) = document.figure();
        let mut check = Check { document, mistakes: Diagnostics(mistakes) };
        let figure = written.and_then(|written| check.figure(&written));
        match figure {
            Some(figure) if check.mistakes.0.is_empty() => Ok(figure),
            _ => Err(check.mistakes.0),
        }
    }

    /// Colour of a pixel.
    pub fn colour(&self, column: usize, row: usize) -> [u8; 3] {
        self.picture.get_pixel(column as u32, row as u32).0
    }

    /// The picture.
    pub fn picture(&self) -> &RgbImage {
        &self.picture
    }
}

/// The picture, and whether its format is one with loss.
fn read(path: &Path) -> Result<(RgbImage, bool), PictureError> {
    let opened = file::open(path).and_then(|file| {
        // The content tells the format, not the name.
        Ok(ImageReader::new(BufReader::new(file)).with_guessed_format()?)
    });
    let mut reader = opened.map_err(|source| PictureError::Read { path: path.to_owned(), source })?;
    let mut limits = Limits::default();
    limits.max_alloc = Some(MOST_BYTES);
    reader.limits(limits);
    let is_jpeg = reader.format() == Some(ImageFormat::Jpeg);
    let damaged = |source| PictureError::Decode { path: path.to_owned(), source };
    let decoder = reader.into_decoder().map_err(damaged)?;
    let (width, height) = decoder.dimensions();
    if u64::from(width) * u64::from(height) > MOST_PIXELS || decoder.total_bytes() > MOST_BYTES {
        return Err(PictureError::TooLarge { path: path.to_owned(), width, height });
    }
    let picture = DynamicImage::from_decoder(decoder).map_err(damaged)?;
    // Transparent pixels show paper.
    let on_paper = |column, row| {
        let Rgba([parts @ .., alpha]) = picture.get_pixel(column, row);
        let alpha = u16::from(alpha);
        Rgb(parts.map(|part| ((u16::from(part) * alpha + 255 * (255 - alpha)) / 255) as u8))
    };
    let has_paper = picture.color().has_alpha();
    let picture = if has_paper { RgbImage::from_fn(width, height, on_paper) } else { picture.into_rgb8() };
    Ok((picture, is_jpeg))
}

struct Check<'a> {
    document: &'a Document,
    mistakes: Diagnostics,
}

impl Check<'_> {
    fn report(&mut self, keys: &[&str], message: impl Into<String>, hint: &str) {
        self.mistakes.report_with(&self.document.span_of(keys), message, hint);
    }

    fn figure(&mut self, written: &scenario::Figure) -> Option<Figure> {
        let axes = [self.axis("x", &written.x), self.axis("y", &written.y)];
        let curve = &written.curve;
        let [colour, background] = [("colour", &curve.colour), ("background", &curve.background)].map(|(key, text)| {
            let colour = Ink::parse(text);
            if colour.is_none() {
                self.report(
                    &["curve", key],
                    format!("expected a colour, found \"{text}\""),
                    "write it like \"#1f77b4\"",
                );
            }
            colour
        });
        let picture = self.document.file_of(&["picture"]).and_then(|path| match read(&path) {
            Ok((picture, is_jpeg)) => Some((path, picture, is_jpeg)),
            Err(error) => {
                self.report(&["picture"], error.to_string(), "pictures are PNG or JPEG");
                None
            }
        });
        let is_jpeg = picture.as_ref().is_some_and(|(_, _, is_jpeg)| *is_jpeg);
        let (fidelity, least_scatter) =
            if is_jpeg { (Fidelity::JPEG, LEAST_SCATTER_JPEG) } else { (Fidelity::EXACT, LEAST_SCATTER) };
        let ink = Ink::new(colour?, background?, curve.tolerance, fidelity);
        if ink.is_none() {
            self.report(&["curve", "colour"], "the curve and what is behind it have nearly the same colour", "");
        }
        if let Some((_, picture, _)) = &picture {
            self.inside([("x", &written.x), ("y", &written.y)], [picture.width(), picture.height()]);
        }
        let [x, y] = axes;
        let axes = Axes::new([x?, y?]);
        if axes.is_none() {
            let hint = "each axis needs two points apart in picture and value";
            self.report(&["x", "points"], "the points of the axes do not span a plane", hint);
        }
        let (axes, (path, picture, _)) = (axes?, picture?);
        let size = [picture.width() as usize, picture.height() as usize];
        let [left, top, right, bottom] = curve.area.unwrap_or_else(|| axes.area());
        let within = |value: f64, most: usize| (value.max(0.0) as usize).min(most);
        let area = [
            within(left, size[0]),
            within(top, size[1]),
            within(right.ceil(), size[0]),
            within(bottom.ceil(), size[1]),
        ];
        if area[0] + 3 > area[2] || area[1] + 3 > area[3] {
            let message = format!("the area is not in the picture of {} x {} pixels", size[0], size[1]);
            self.report(&["curve", "area"], message, "give left, top, right and bottom");
        }
        let (without, pixel_error) = (curve.without.clone(), curve.pixel_error);
        Some(Figure { path, picture, axes, ink: ink?, area, without, pixel_error, least_scatter })
    }

    /// Reports points of axes beside a picture of this size.
    fn inside(&mut self, axes: [(&str, &scenario::FigureAxis); 2], [width, height]: [u32; 2]) {
        for (key, axis) in axes {
            let is_outside = |[x, y]: [f64; 2]| x > f64::from(width) || y > f64::from(height);
            if let Some([x, y]) = axis.points.iter().map(|point| point.pixel).find(|pixel| is_outside(*pixel)) {
                let message = format!("the pixel [{x}, {y}] is not in the picture of {width} x {height} pixels");
                self.report(&[key, "points"], message, "pixels count from the upper left corner, across and down");
            }
        }
    }

    fn axis(&mut self, key: &str, written: &scenario::FigureAxis) -> Option<Axis> {
        let [from, to] = &written.points[..] else {
            return None;
        };
        let dimension = column::dimension(&written.column);
        let values = [from, to].map(|point| match &point.value {
            Amount::Number(number) => Some(*number),
            Amount::Text(text) => {
                let parsed = match dimension {
                    Some(dimension) => dimension.parse(text).map_err(|error| (error.to_string(), error.hint())),
                    None => text.trim().parse().map_err(|_| {
                        let hint = format!("`{}` has no unit", written.column);
                        (format!("expected a number, found \"{text}\""), hint)
                    }),
                };
                parsed.map_err(|(message, hint)| self.report(&[key, "points"], message, &hint)).ok()
            }
        });
        let name = &written.column;
        if name.is_empty() || name.contains([',', '"', '#']) || name.chars().any(char::is_control) {
            self.report(&[key, "column"], "expected the name of a column", "such as \"time_s\"");
        }
        let [Some(first), Some(second)] = values else {
            return None;
        };
        if written.scale == AxisScale::Log && first.min(second) <= 0.0 {
            let message = format!("expected values above 0 on a logarithmic axis, found {}", first.min(second));
            self.report(&[key, "points"], message, "give other points, or `scale = \"linear\"`");
            return None;
        }
        let (column, scale) = (written.column.clone(), written.scale);
        Some(Axis { column, pixels: [from.pixel, to.pixel], values: [first, second], scale })
    }
}
