//! Sizes, fonts, lines and resolutions of pictures for a purpose.

use clap::ValueEnum;

/// Size, font, lines and resolution for a purpose.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum Preset {
    /// 1600 x 1000 pixels, a font of 12 pt, with a heading
    #[default]
    Slide,
    /// One column of a journal: 90 mm wide, a font of 8 pt, 600 dpi, no heading
    SingleColumn,
    /// Both columns of a journal: 190 mm wide, a font of 8 pt, 600 dpi, no heading
    DoubleColumn,
}

/// The values of a preset.
pub(super) struct Values {
    /// m.
    pub(super) width: f64,
    /// Size of the font, pt.
    pub(super) font_size: f64,
    /// Width of curves, pt.
    pub(super) line: f64,
    /// Pixels per inch.
    pub(super) dpi: f64,
    /// Height over width of a plot.
    pub(super) plot: f64,
    /// Height over width of a scene.
    pub(super) scene: f64,
}

impl Preset {
    pub(super) fn values(self) -> Values {
        match self {
            Preset::Slide => {
                Values { width: 0.2032, font_size: 12.0, line: 1.8, dpi: 200.0, plot: 0.625, scene: 0.625 }
            }
            Preset::SingleColumn => {
                Values { width: 0.09, font_size: 8.0, line: 1.0, dpi: 600.0, plot: 0.66, scene: 0.75 }
            }
            Preset::DoubleColumn => {
                Values { width: 0.19, font_size: 8.0, line: 1.0, dpi: 600.0, plot: 0.4, scene: 0.5 }
            }
        }
    }
}
