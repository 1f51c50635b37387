//! A picture that is drawn: an SVG, the pixels of a scene within it, and both as PNG with this program's typeface.

use std::sync::{Arc, LazyLock};

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use png::{BitDepth, ColorType, Encoder, EncodingError, PixelDimensions, Unit};
use resvg::tiny_skia::{Color, Pixmap, PremultipliedColorU8, Transform};
use resvg::usvg::fontdb::Database;
use resvg::usvg::{self, Options, Tree};
use thiserror::Error;

use crate::raster::Pixels;
use plot::{Plot, Style, svg_in};

/// Placeholder of the scene in the document.
pub(crate) const SCENE: &str = "<g id=\"scene\"/>";

/// A picture that is drawn and can be written.
#[derive(Clone, Debug)]
pub struct Drawing {
    document: String,
    scene: Option<Placed>,
    /// Points.
    size: [f64; 2],
    /// Pixels per inch.
    dpi: f64,
}

/// Pixels in a picture.
#[derive(Clone, Debug)]
pub(crate) struct Placed {
    pub(crate) pixels: Pixels,
    /// Left and top, pixels.
    pub(crate) place: [u32; 2],
}

impl Drawing {
    /// The plot, for so many pixels per inch.
    pub fn of_plot(plot: &Plot, style: &Style, dpi: f64) -> Drawing {
        Drawing { document: svg_in(plot, style), scene: None, size: [style.width, style.height], dpi }
    }

    /// The `scene` in the place that `document` has for it.
    pub(crate) fn of_scene(document: String, scene: Placed, style: &Style, dpi: f64) -> Drawing {
        Drawing { document, scene: Some(scene), size: [style.width, style.height], dpi }
    }

    /// Width and height in pixels.
    pub fn pixels(&self) -> [u32; 2] {
        self.size.map(|length| Style::pixels(length, self.dpi))
    }

    /// As SVG; the scene in it is an image.
    ///
    /// # Errors
    /// The image cannot be encoded.
    pub fn svg(&self) -> Result<String, PictureError> {
        let Some(Placed { pixels, place }) = &self.scene else {
            return Ok(self.document.clone());
        };
        let points = |pixels: f64| pixels * 72.0 / self.dpi;
        let [x, y] = place.map(|at| points(f64::from(at)));
        let [width, height] = [pixels.width, pixels.height].map(|side| points(side as f64));
        let content = STANDARD.encode(pixels.encoded()?);
        let image = format!(
            "<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n<image x=\"{x:.3}\" y=\"{y:.3}\" width=\"{width:.3}\" \
             height=\"{height:.3}\" href=\"data:image/png;base64,{content}\"/>"
        );
        Ok(self.document.replacen(SCENE, &image, 1))
    }

    /// As PNG, which states its size on paper.
    ///
    /// # Errors
    /// It has no area or too many pixels.
    pub fn png(&self) -> Result<Vec<u8>, PictureError> {
        let scene = self.scene.as_ref().map(|scene| (&scene.pixels, scene.place));
        png(&self.document, scene, self.pixels(), self.dpi)
    }
}

/// Arimo, which has the widths of Arial, under the SIL Open Font License: Latin, Greek and Cyrillic letters, mathematical
/// signs; the others were left out.
const ARIMO: &[u8] = include_bytes!("font/Arimo-Regular.ttf");

/// Families of letters that a PNG has.
pub const FAMILIES: [&str; 4] = ["Arial", "Arimo", "Helvetica", "sans-serif"];

/// Most pixels of a PNG.
const MOST_PIXELS: u64 = 100_000_000;

/// Inches per metre.
const INCHES: f64 = 1.0 / 0.0254;

/// Why a picture is not drawn.
#[derive(Debug, Error)]
pub enum PictureError {
    /// The picture has no area, or too many pixels.
    #[error("a picture of {width} x {height} pixels is not drawn")]
    Size {
        /// Pixels.
        width: u32,
        /// Pixels.
        height: u32,
    },
    /// The scene has no intact element.
    #[error("the scene has nothing to draw: all film has failed")]
    Nothing,
    /// The drawing is not SVG.
    #[error("the drawing cannot be read: {0}")]
    Svg(#[from] usvg::Error),
    /// The pixels cannot be encoded.
    #[error("PNG: {0}")]
    Png(#[from] EncodingError),
}

static FONTS: LazyLock<Arc<Database>> = LazyLock::new(|| {
    let mut fonts = Database::new();
    fonts.load_font_data(ARIMO.to_vec());
    fonts.set_sans_serif_family("Arimo");
    fonts.set_serif_family("Arimo");
    Arc::new(fonts)
});

/// Checks that a picture has an area and not too many pixels.
pub(crate) fn check([width, height]: [u32; 2]) -> Result<(), PictureError> {
    let is_drawn = width > 0 && height > 0 && u64::from(width) * u64::from(height) <= MOST_PIXELS;
    if is_drawn { Ok(()) } else { Err(PictureError::Size { width, height }) }
}

/// The SVG `document` over an image at a place, on white, in so many pixels at this number per inch.
fn png(
    document: &str,
    image: Option<(&Pixels, [u32; 2])>,
    [width, height]: [u32; 2],
    dpi: f64,
) -> Result<Vec<u8>, PictureError> {
    check([width, height])?;
    let mut pixmap = Pixmap::new(width, height).ok_or(PictureError::Size { width, height })?;
    pixmap.fill(Color::WHITE);
    if let Some((pixels, place)) = image {
        put(&mut pixmap, pixels, place);
    }
    let tree = Tree::from_str(document, &Options { fontdb: FONTS.clone(), ..Options::default() })?;
    let [across, down] = [width as f32 / tree.size().width(), height as f32 / tree.size().height()];
    resvg::render(&tree, Transform::from_scale(across, down), &mut pixmap.as_mut());
    let colours: Vec<u8> = pixmap.pixels().iter().flat_map(|p| [p.red(), p.green(), p.blue()]).collect();
    let density = (dpi * INCHES).round() as u32;
    let on_paper = PixelDimensions { xppu: density, yppu: density, unit: Unit::Meter };
    encoded(ColorType::Rgb, [width, height], &colours, Some(on_paper))
}

/// Puts pixels on a white ground.
fn put(pixmap: &mut Pixmap, pixels: &Pixels, [left, top]: [u32; 2]) {
    let (width, height) = (pixmap.width() as usize, pixmap.height() as usize);
    let ground = pixmap.pixels_mut();
    for (row, colours) in pixels.rows.chunks(pixels.width.max(1)).enumerate() {
        for (column, [r, g, b, opacity]) in colours.iter().enumerate().filter(|(_, colour)| colour[3] > 0) {
            let (x, y) = (left as usize + column, top as usize + row);
            let over = |part: &u8| {
                let opacity = u16::from(*opacity);
                ((u16::from(*part) * opacity + 255 * (255 - opacity) + 127) / 255) as u8
            };
            if let Some(colour) = PremultipliedColorU8::from_rgba(over(r), over(g), over(b), 255)
                && x < width
                && y < height
            {
                ground[y * width + x] = colour;
            }
        }
    }
}

/// Pixels of a byte a colour as PNG, which may state their size on paper.
fn encoded(
    colours: ColorType,
    [width, height]: [u32; 2],
    bytes: &[u8],
    on_paper: Option<PixelDimensions>,
) -> Result<Vec<u8>, PictureError> {
    let mut content = Vec::new();
    let mut encoder = Encoder::new(&mut content, width, height);
    encoder.set_color(colours);
    encoder.set_depth(BitDepth::Eight);
    encoder.set_pixel_dims(on_paper);
    encoder.write_header()?.write_image_data(bytes)?;
    Ok(content)
}

impl Pixels {
    /// As PNG with opacity.
    fn encoded(&self) -> Result<Vec<u8>, PictureError> {
        encoded(ColorType::Rgba, [self.width as u32, self.height as u32], self.rows.as_flattened(), None)
    }
}
