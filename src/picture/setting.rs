//! The surroundings of a scene: heading, caption, colour bar, directions of the axes.

use std::fmt::Write;

use nalgebra::Vector3;
use quick_xml::escape::escape;

use super::camera::Camera;
use super::drawing::SCENE;
use plot::{Along, Style, viridis};

const INK: &str = "#1c2126";
const PALE: &str = "#56616b";

/// Most numbers beside a colour bar.
const NUMBERS: usize = 8;

/// The places of the parts of a picture, pt.
pub(super) struct Setting<'a> {
    style: &'a Style,
    /// Left, top, right and bottom of the scene.
    pub(super) scene: [f64; 4],
}

/// Texts around a scene.
pub(super) struct Words<'a> {
    pub(super) title: &'a str,
    pub(super) caption: &'a str,
    /// Field and unit.
    pub(super) bar: &'a str,
    /// Ends of the colour bar, in the unit of the field.
    pub(super) range: [f32; 2],
}

impl Setting<'_> {
    pub(super) fn new(style: &Style) -> Setting<'_> {
        let em = style.letters;
        let top = if style.has_title { 4.2 * em } else { 2.4 * em };
        let scene = [em, top, style.width - 7.2 * em, style.height - em];
        Setting { style, scene }
    }

    /// The picture as SVG, with a place for the scene, that `camera` projects in pt.
    pub(super) fn document(&self, words: &Words<'_>, camera: &Camera) -> String {
        let Style { width, height, letters: em, family, .. } = self.style;
        let [wide, high] = [*width, *height].map(Style::millimetres);
        let mut text = format!(
            "<svg width=\"{wide}\" height=\"{high}\" viewBox=\"0 0 {width:.3} {height:.3}\" \
             xmlns=\"http://www.w3.org/2000/svg\" font-family=\"{family}\" font-size=\"{em}\" fill=\"{INK}\">\n{SCENE}\n"
        );
        let below = if self.style.has_title {
            self.text(&mut text, [1.0, 1.9], 1.3, "font-weight=\"bold\"", words.title);
            3.5
        } else {
            1.6
        };
        self.text(&mut text, [1.0, below], 1.0, &format!("fill=\"{PALE}\""), words.caption);
        self.bar(&mut text, words);
        self.triad(&mut text, camera);
        text + "</svg>\n"
    }

    /// A line of text from a place in units of the height of letters.
    fn text(&self, out: &mut String, [x, y]: [f64; 2], size: f64, how: &str, words: &str) {
        let em = self.style.letters;
        let [x, y, size] = [x, y, size].map(|length| length * em);
        let _ = writeln!(out, "<text x=\"{x:.2}\" y=\"{y:.2}\" font-size=\"{size:.2}\" {how}>{}</text>", escape(words));
    }

    /// The colour bar with its numbers, and what it shows.
    fn bar(&self, out: &mut String, Words { bar, range, .. }: &Words<'_>) {
        let em = self.style.letters;
        let [_, top, right, bottom] = self.scene;
        let high = (bottom - top) * 0.72;
        let (x, y, wide) = (right + 1.4 * em, top + 0.5 * (bottom - top - high), 0.9 * em);
        let stops: String = viridis::stops()
            .map(|(share, colour)| format!("<stop offset=\"{share}\" stop-color=\"{colour}\"/>"))
            .collect();
        let _ = writeln!(
            out,
            "<defs><linearGradient id=\"bar\" x1=\"0\" y1=\"1\" x2=\"0\" y2=\"0\">{stops}</linearGradient></defs>\n\
             <rect x=\"{x:.2}\" y=\"{y:.2}\" width=\"{wide:.2}\" height=\"{high:.2}\" fill=\"url(#bar)\"/>"
        );
        let [low, most] = range.map(f64::from);
        for (share, number) in Along::between(low, most, NUMBERS).ticks() {
            let at = y + high * (1.0 - share);
            let (from, to) = (x + wide, x + wide + 0.35 * em);
            let number = number.replace('-', "−");
            let _ = writeln!(
                out,
                "<path d=\"M{from:.2} {at:.2}H{to:.2}\" stroke=\"{PALE}\" stroke-width=\"{:.2}\"/>\n\
                 <text x=\"{:.2}\" y=\"{:.2}\">{number}</text>",
                em / 12.0,
                to + 0.25 * em,
                at + 0.35 * em
            );
        }
        let (label, middle) = (self.style.width - 0.9 * em, y + 0.5 * high);
        let _ = writeln!(
            out,
            "<text transform=\"translate({label:.2} {middle:.2}) rotate(-90)\" text-anchor=\"middle\">{}</text>",
            escape(bar)
        );
    }

    /// The directions of x, y and z, at the lower left.
    fn triad(&self, out: &mut String, camera: &Camera) {
        let em = self.style.letters;
        let [left, _, _, bottom] = self.scene;
        let (x, y, long) = (left + 2.2 * em, bottom - 2.2 * em, 1.9 * em);
        for (name, axis) in [("x", Vector3::x()), ("y", Vector3::y()), ("z", Vector3::z())] {
            let turned = camera.turned(&axis);
            // An axis towards the eye is a point.
            if turned.x.hypot(turned.y) < 0.15 {
                continue;
            }
            let [across, down] = [long * turned.x, -long * turned.y];
            let _ = writeln!(
                out,
                "<path d=\"M{x:.2} {y:.2}l{across:.2} {down:.2}\" stroke=\"{PALE}\" stroke-width=\"{:.2}\"/>\n\
                 <text x=\"{:.2}\" y=\"{:.2}\" text-anchor=\"middle\" fill=\"{PALE}\">{name}</text>",
                em / 9.0,
                x + 1.3 * across,
                y + 1.3 * down + 0.3 * em
            );
        }
    }
}
