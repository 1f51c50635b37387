//! Plots of a page: the data that its script draws, a description for screen readers, and values with their intervals.

use serde::{Deserialize, Serialize};

use crate::html::{data, escape, kept_together};
use base::number::{ends, plain, rounded, significant};
use base::written;
use plot::{Axis, Curve, Look, Mark, Plot, Scale, Window};
use scene::simulate::RateHistogram;

/// Most points of one curve; a longer one is reduced to the extremes of its intervals.
const MOST_POINTS: usize = 2000;

/// Significant digits of a point: finer than the pixels of a screen.
pub(crate) const DIGITS: usize = 6;

/// The plot as an HTML figure that the page's script draws; empty where no curve has a point.
pub(crate) fn figure(plot: &Plot) -> String {
    block(plot, false)
}

/// The plot as a figure whose curves are filled down to zero, such as a histogram.
pub(crate) fn filled(plot: &Plot) -> String {
    block(plot, true)
}

/// Plots side by side, where the page is wide enough.
pub fn figures<'a>(plots: impl IntoIterator<Item = &'a Plot>) -> String {
    side_by_side(plots.into_iter().map(figure))
}

/// Plots side by side, so small that four fit beside each other on a desktop.
pub(crate) fn small<'a>(plots: impl IntoIterator<Item = &'a Plot>) -> String {
    small_figures(plots.into_iter().map(figure))
}

/// Plots side by side, three on a desktop.
pub(crate) fn medium<'a>(plots: impl IntoIterator<Item = &'a Plot>) -> String {
    of_size("medium", &figures(plots))
}

/// Figures (HTML) side by side, as small as those of [`small`]; empty without figures.
pub(crate) fn small_figures(figures: impl IntoIterator<Item = String>) -> String {
    of_size("small", &side_by_side(figures))
}

/// Figures side by side in the size of a class of the style.
fn of_size(class: &str, plots: &str) -> String {
    plots.replacen("<div class=\"plots\">", &format!("<div class=\"plots {class}\">"), 1)
}

/// Figures (HTML) side by side; empty without figures.
pub(crate) fn side_by_side(figures: impl IntoIterator<Item = String>) -> String {
    let figures: String = figures.into_iter().collect();
    if figures.is_empty() { figures } else { format!("<div class=\"plots\">\n{figures}</div>\n") }
}

/// The histogram of strain rates over decades with the measured range marked; empty without strain increments.
pub(crate) fn rates(title: &str, histogram: &RateHistogram) -> String {
    let bins = histogram.edges.windows(2).zip(&histogram.shares);
    let shown: Vec<_> = bins.filter(|(_, share)| **share > LEAST_SHARE).collect();
    let (Some((first, _)), Some((last, _))) = (shown.first(), shown.last()) else {
        return String::new();
    };
    let ends = [[first[0], 0.0], [last[1], 0.0]];
    let outline = shown.iter().flat_map(|(edges, share)| edges.iter().map(|edge| [*edge, **share * 100.0]));
    let points = [ends[0]].into_iter().chain(outline).chain([ends[1]]);
    let label = "range in which the curves were measured".into();
    let plot = Plot {
        x: Axis { label: "strain rate (1/s)".into(), scale: Scale::Logarithmic },
        window: histogram.measured.map(|range| Window { label, range }),
        ..Plot::new(title, ["", "share (%)"], vec![Curve::line("share of the strain increments", points)])
    };
    filled(&plot)
}

/// Least share of a bin at the ends of the axis.
const LEAST_SHARE: f64 = 1e-3;

/// Class of the figures that the page's script draws.
pub(crate) const PLOT: &str = "plot";

fn block(plot: &Plot, filled: bool) -> String {
    let shown = |point: &&[f64; 2]| plot.has_place(point);
    if !plot.curves.iter().any(|curve| curve.points.iter().any(|point| shown(&point))) {
        return String::new();
    }
    let title = escape(&plot.title);
    let words = escape(&description(plot));
    let data = data(&PlotData::of_plot(plot, filled));
    format!(
        "<figure class=\"{PLOT}\">\n<h3>{title}</h3>\n{data}<figcaption class=\"unseen\">{words}</figcaption>\n\
         </figure>\n"
    )
}

/// The description for screen readers.
fn description(plot: &Plot) -> String {
    let range = |ends: [f64; 2]| ends.map(|end| plain(rounded(end, 4))).join(" to ");
    let curve = |curve: &Curve| {
        let places = curve.points.iter().filter(|point| plot.has_place(point));
        Some(format!("{}: {}", curve.name, range(ends(places.map(|point| point[1]))?)))
    };
    let curves: Vec<String> = plot.curves.iter().filter_map(curve).collect();
    let window = plot.window.as_ref().map(|window| format!("; marked: {}, {}", window.label, range(window.range)));
    let marks: Vec<String> =
        plot.marks.iter().map(|mark| format!("{} at {}", mark.label, significant(mark.at, 4))).collect();
    let marks = if marks.is_empty() { String::new() } else { format!("; {}", marks.join(", ")) };
    format!("{} over {}; {}{}{marks}", plot.y.label, plot.x.label, curves.join("; "), window.unwrap_or_default())
}

/// The data that the script reads.
#[derive(Serialize, Deserialize)]
pub(crate) struct PlotData {
    x: Axis,
    y: Axis,
    window: Option<Window>,
    #[serde(default)]
    marks: Vec<Mark>,
    #[serde(default)]
    filled: bool,
    curves: Vec<CurveData>,
}

/// A curve; gaps have no value.
#[derive(Serialize, Deserialize)]
struct CurveData {
    name: String,
    look: Look,
    x: Abscissae,
    y: Vec<Option<f64>>,
}

/// Abscissae of the curve, or the index of an earlier one that has the same.
#[derive(Serialize, Deserialize)]
#[serde(untagged)]
enum Abscissae {
    Own(Vec<Option<f64>>),
    Of(usize),
}

impl PlotData {
    fn of_plot(plot: &Plot, filled: bool) -> PlotData {
        let number = |value: f64| Some(rounded(value, DIGITS)).filter(|value| value.is_finite());
        let mut abscissae: Vec<Vec<Option<f64>>> = Vec::new();
        let mut curve = |curve: &Curve| {
            let points = curve.thinned(MOST_POINTS).points;
            // A gap keeps its abscissa, so that curves with other gaps can share the abscissae.
            let x: Vec<Option<f64>> = points.iter().map(|point| number(point[0])).collect();
            let same = abscissae.iter().position(|known| *known == x);
            abscissae.push(x.clone());
            let y = points.iter().map(|point| plot.has_place(point).then(|| number(point[1])).flatten()).collect();
            CurveData {
                name: curve.name.clone(),
                look: curve.look,
                x: same.map_or(Abscissae::Own(x), Abscissae::Of),
                y,
            }
        };
        PlotData {
            curves: plot.curves.iter().map(&mut curve).collect(),
            x: plot.x.clone(),
            y: plot.y.clone(),
            window: plot.window.clone(),
            marks: plot.marks.iter().map(|mark| Mark { at: rounded(mark.at, DIGITS), ..mark.clone() }).collect(),
            filled,
        }
    }

    /// The plot with this title.
    pub(crate) fn plot(self, title: &str) -> Plot {
        // Borrowed: a page may say of any number of curves that they have the abscissae of a long one.
        let mut abscissae: Vec<&[Option<f64>]> = Vec::new();
        let mut curves = Vec::new();
        for CurveData { name, look, x, y } in &self.curves {
            let x = match x {
                Abscissae::Own(own) => own.as_slice(),
                Abscissae::Of(earlier) => abscissae.get(*earlier).copied().unwrap_or_default(),
            };
            abscissae.push(x);
            let value = |value: &Option<f64>| value.unwrap_or(f64::NAN);
            let points = x.iter().zip(y).map(|(x, y)| [value(x), value(y)]).collect();
            curves.push(Curve { name: name.clone(), points, look: *look });
        }
        Plot { title: title.to_owned(), x: self.x, y: self.y, curves, window: self.window, marks: self.marks }
    }
}

/// A line.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Line {
    /// What it is.
    pub words: String,
    /// Shown on hover, such as the whole key.
    pub title: String,
    /// The value; none where it is not distinguishable from zero, or open.
    pub value: Option<f64>,
    /// Its interval; an end that is open is that of the axis.
    pub interval: Option<[f64; 2]>,
    /// A value that it is compared with, and what that is.
    pub mark: Option<(f64, String)>,
    /// The value in words.
    pub text: String,
}

/// How values are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum RangeLook {
    /// From zero.
    Bars,
    /// Alone.
    Dots,
}

/// Share of the axis beyond the outermost values.
const MARGIN: f64 = 0.04;

/// The ends of an axis that has all values, intervals and marks, and of bars zero.
fn axis(look: RangeLook, lines: &[Line]) -> [f64; 2] {
    let of = |line: &Line| {
        [line.value, line.mark.as_ref().map(|mark| mark.0)]
            .into_iter()
            .flatten()
            .chain(line.interval.into_iter().flatten())
            .collect::<Vec<_>>()
    };
    let zero = (look == RangeLook::Bars).then_some(0.0);
    let all = lines.iter().flat_map(of).chain(zero).filter(|value| value.is_finite());
    let Some([low, high]) = ends(all) else { return [0.0, 1.0] };
    let margin = if high > low { MARGIN * (high - low) } else { 0.5 * high.abs().max(1.0) };
    let end = |value: f64, margin: f64| if look == RangeLook::Bars && value == 0.0 { 0.0 } else { value + margin };
    [end(low, -margin), end(high, margin)]
}

/// The lines below a heading (text), on an axis of their own; empty without lines.
pub(crate) fn ranges(heading: &str, look: RangeLook, lines: &[Line]) -> String {
    if lines.is_empty() {
        return String::new();
    }
    let [low, high] = axis(look, lines);
    let place = |value: f64| format!("{:.2}%", 100.0 * ((value - low) / (high - low)).clamp(0.0, 1.0));
    let width = |from: f64, to: f64| format!("left:{};right:calc(100% - {})", place(from.min(to)), place(from.max(to)));
    let drawn = |line: &Line| {
        let bar = line.value.filter(|_| look == RangeLook::Bars).map(|value| {
            let class = if value < 0.0 { "bar minus" } else { "bar" };
            format!("<i class=\"{class}\" style=\"{}\"></i>", width(0.0, value))
        });
        let whisker =
            line.interval.map(|[from, to]| format!("<i class=\"whisker\" style=\"{}\"></i>", width(from, to)));
        let dot = line
            .value
            .filter(|_| look == RangeLook::Dots)
            .map(|value| format!("<i class=\"dot\" style=\"left:{}\"></i>", place(value)));
        let mark = line.mark.as_ref().map(|(value, what)| {
            format!("<i class=\"mark\" style=\"left:{}\" title=\"{}\"></i>", place(*value), escape(what))
        });
        [bar, whisker, mark, dot].into_iter().flatten().collect::<String>()
    };
    let item = |line: &Line| {
        let (words, title, text) = (escape(&line.words), escape(&line.title), escape(&kept_together(&line.text)));
        format!(
            "<li><span class=\"words\" title=\"{title}\">{words}</span><span class=\"track\" aria-hidden=\"true\">{}</span>\
             <span class=\"said\">{text}</span></li>\n",
            drawn(line)
        )
    };
    let items: String = lines.iter().map(item).collect();
    let ends = match look {
        RangeLook::Bars => String::new(),
        RangeLook::Dots => {
            // As many digits as tell them apart.
            let size = low.abs().max(high.abs()) / (high - low);
            let figures = written::DIGITS.max(size.log10().ceil() as usize + 2);
            let ends =
                [low, 0.5 * (low + high), high].map(|value| significant(value, figures).replace('-', "\u{2212}"));
            let ends = ends.map(|end| format!("<span>{end}</span>"));
            format!("<p class=\"axis\" aria-hidden=\"true\"><span class=\"ends\">{}</span></p>\n", ends.concat())
        }
    };
    let heading = if heading.is_empty() { String::new() } else { format!("<h3>{}</h3>\n", escape(heading)) };
    format!("<div class=\"ranges\">\n{heading}<ul>\n{items}</ul>\n{ends}</div>\n")
}

#[cfg(test)]
mod tests {
    use serde_json::{Value, json};

    use super::*;

    fn plot(points: Vec<[f64; 2]>) -> Plot {
        Plot::new("A & B", ["time (ms)", "travel (mm)"], vec![Curve::line("</script><film>", points)])
    }

    /// The data block of a figure, as the page's script reads it.
    fn block(html: &str) -> Value {
        let (_, rest) = html.split_once("<script type=\"application/json\">").expect("a block");
        let (block, _) = rest.split_once("</script>").expect("its end");
        assert!(!block.contains('<'), "{block}");
        serde_json::from_str(block).expect("JSON")
    }

    #[test]
    fn a_figure_holds_its_points_and_its_escaped_names() {
        let html = figure(&plot(vec![[0.0, 1.0], [1.0, f64::NAN], [2.0, 1.0 / 3.0]]));
        let data = block(&html);
        assert_eq!(data["curves"][0]["name"], "</script><film>");
        assert_eq!(data["curves"][0]["x"], json!([0.0, 1.0, 2.0]));
        assert_eq!(data["curves"][0]["y"], json!([1.0, null, 0.333333]));
        assert!(html.contains("A &amp; B") && html.contains("&lt;film&gt;: 0.3333 to 1"), "{html}");
    }

    #[test]
    fn curves_share_their_abscissae() {
        let mut shared = plot(vec![[0.0, 1.0], [1.0, 2.0]]);
        shared.curves.push(Curve::line("other", [[0.0, f64::NAN], [1.0, 4.0]]).dashed());
        let data = block(&figure(&shared));
        assert_eq!((&data["curves"][1]["x"], &data["curves"][1]["look"]), (&json!(0), &json!("dashed")));
    }

    #[test]
    fn a_plot_without_points_is_empty() {
        assert_eq!(figure(&plot(vec![])), "");
        assert_eq!(figure(&plot(vec![[f64::NAN, 1.0]])), "");
        let mut logarithmic = plot(vec![[-1.0, 1.0]]);
        logarithmic.x.scale = Scale::Logarithmic;
        assert_eq!(figure(&logarithmic), "");
        assert_eq!(figures(&[plot(vec![])]), "");
    }

    #[test]
    fn rates_show_the_measured_range() {
        let histogram = RateHistogram {
            edges: vec![0.1, 1.0, 10.0, 100.0],
            shares: vec![0.2, 0.5, 0.3],
            measured: Some([0.04, 40.0]),
            outside: 0.3,
        };
        let data = block(&rates("Strain rates", &histogram));
        assert_eq!(data["window"]["range"], json!([0.04, 40.0]));
        assert_eq!(data["curves"][0]["x"], json!([0.1, 0.1, 1.0, 1.0, 10.0, 10.0, 100.0, 100.0]));
        assert_eq!((&data["x"]["log"], &data["filled"]), (&json!(true), &json!(true)));
        let nothing = RateHistogram { shares: vec![0.0; 3], ..histogram };
        assert_eq!(rates("Strain rates", &nothing), "");
    }

    #[test]
    fn marks_and_windows_are_drawn_and_described() {
        let marks = vec![Mark { label: "contact <1>".into(), at: 0.5 }];
        let window = Some(Window { label: "error window".into(), range: [0.0, 57.3] });
        let html = figure(&Plot { marks, window, ..plot(vec![[0.0, 0.0], [1.0, 1.0]]) });
        assert_eq!(block(&html)["marks"], json!([{ "words": "contact <1>", "at": 0.5 }]));
        assert_eq!(block(&html)["window"]["words"], "error window");
        assert!(html.contains("contact &lt;1&gt; at 0.5"), "{html}");
        assert!(html.contains("marked: error window, 0 to 57.3"), "{html}");
    }

    #[test]
    fn bars_begin_at_zero_and_texts_are_escaped() {
        let line = |value: f64| Line {
            words: "<k1>".into(),
            title: "a.b".into(),
            value: Some(value),
            interval: Some([value - 1.0, value + 1.0]),
            text: "3 %".into(),
            ..Line::default()
        };
        let html = ranges("effects", RangeLook::Bars, &[line(9.0), line(-9.0)]);
        let shown = ["&lt;k1&gt;", "class=\"bar minus\"", "axis"].map(|part| html.contains(part));
        assert_eq!(shown, [true, true, false], "{html}");
        assert!(html.contains("left:50.00%;right:calc(100% - 91.67%)"), "{html}");
        assert_eq!(ranges("", RangeLook::Bars, &[]), "");
    }

    #[test]
    fn dots_have_an_axis_and_what_they_are_compared_with() {
        let line = Line {
            value: Some(2.0),
            interval: Some([1.0, 3.0]),
            mark: Some((5.0, "truth 5".into())),
            ..Line::default()
        };
        let html = ranges("k1", RangeLook::Dots, &[line]);
        assert!(["title=\"truth 5\"", "class=\"dot\"", "class=\"axis\""].iter().all(|part| html.contains(part)));
        let narrow = Line { value: Some(12.01), interval: Some([11.96, 12.06]), ..Line::default() };
        let html = ranges("", RangeLook::Dots, &[narrow]);
        assert_eq!(html.matches("<span>12.01</span>").count(), 1, "{html}");
        assert_eq!(axis(RangeLook::Dots, &[Line { value: Some(2.0), ..Line::default() }]), [1.0, 3.0]);
        assert_eq!(axis(RangeLook::Dots, &[]), [0.0, 1.0]);
    }
}
