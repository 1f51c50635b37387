//! A picture that is drawn: an SVG, and the pixels of a scene within it.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;

use super::png::{self, PictureError};
use super::raster::Pixels;
use plot::{Plot, Style, svg_in};

/// Placeholder of the scene in the document.
pub(super) const SCENE: &str = "<g id=\"scene\"/>";

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
pub(super) struct Placed {
    pub(super) pixels: Pixels,
    /// Left and top, pixels.
    pub(super) place: [u32; 2],
}

impl Drawing {
    /// The plot, for so many pixels per inch.
    pub fn of_plot(plot: &Plot, style: &Style, dpi: f64) -> Drawing {
        Drawing { document: svg_in(plot, style), scene: None, size: [style.width, style.height], dpi }
    }

    /// The `scene` in the place that `document` has for it.
    pub(super) fn of_scene(document: String, scene: Placed, style: &Style, dpi: f64) -> Drawing {
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
        png::png(&self.document, scene, self.pixels(), self.dpi)
    }
}
