//! Values with their intervals on a common axis, a line each: bars from zero, or dots.

use super::html::escape;
use base::written;

/// A line.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Line {
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
pub(super) enum Look {
    /// From zero.
    Bars,
    /// Alone.
    Dots,
}

/// Share of the axis beyond the outermost values.
const MARGIN: f64 = 0.04;

/// The ends of an axis that has all values, intervals and marks, and of bars zero.
fn axis(look: Look, lines: &[Line]) -> [f64; 2] {
    let of = |line: &Line| {
        [line.value, line.mark.as_ref().map(|mark| mark.0)]
            .into_iter()
            .flatten()
            .chain(line.interval.into_iter().flatten())
            .collect::<Vec<_>>()
    };
    let zero = (look == Look::Bars).then_some(0.0);
    let all = lines.iter().flat_map(of).chain(zero).filter(|value| value.is_finite());
    let [low, high] =
        all.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| [low.min(value), high.max(value)]);
    if low > high {
        return [0.0, 1.0];
    }
    let margin = if high > low { MARGIN * (high - low) } else { 0.5 * high.abs().max(1.0) };
    let end = |value: f64, margin: f64| if look == Look::Bars && value == 0.0 { 0.0 } else { value + margin };
    [end(low, -margin), end(high, margin)]
}

/// The lines below a heading (text), on an axis of their own; empty without lines.
pub(super) fn ranges(heading: &str, look: Look, lines: &[Line]) -> String {
    if lines.is_empty() {
        return String::new();
    }
    let [low, high] = axis(look, lines);
    let place = |value: f64| format!("{:.2}%", 100.0 * ((value - low) / (high - low)).clamp(0.0, 1.0));
    let width = |from: f64, to: f64| format!("left:{};right:calc(100% - {})", place(from.min(to)), place(from.max(to)));
    let drawn = |line: &Line| {
        let bar = line.value.filter(|_| look == Look::Bars).map(|value| {
            let class = if value < 0.0 { "bar minus" } else { "bar" };
            format!("<i class=\"{class}\" style=\"{}\"></i>", width(0.0, value))
        });
        let whisker =
            line.interval.map(|[from, to]| format!("<i class=\"whisker\" style=\"{}\"></i>", width(from, to)));
        let dot = line
            .value
            .filter(|_| look == Look::Dots)
            .map(|value| format!("<i class=\"dot\" style=\"left:{}\"></i>", place(value)));
        let mark = line.mark.as_ref().map(|(value, what)| {
            format!("<i class=\"mark\" style=\"left:{}\" title=\"{}\"></i>", place(*value), escape(what))
        });
        [bar, whisker, mark, dot].into_iter().flatten().collect::<String>()
    };
    let item = |line: &Line| {
        let (words, title, text) = (escape(&line.words), escape(&line.title), escape(&line.text));
        format!(
            "<li><span class=\"words\" title=\"{title}\">{words}</span><span class=\"track\" aria-hidden=\"true\">{}</span>\
             <span class=\"said\">{text}</span></li>\n",
            drawn(line)
        )
    };
    let items: String = lines.iter().map(item).collect();
    let ends = match look {
        Look::Bars => String::new(),
        Look::Dots => {
            let ends = [low, 0.5 * (low + high), high].map(|value| format!("<span>{}</span>", written::digits(value)));
            format!("<p class=\"axis\" aria-hidden=\"true\"><span class=\"ends\">{}</span></p>\n", ends.concat())
        }
    };
    let heading = if heading.is_empty() { String::new() } else { format!("<h3>{}</h3>\n", escape(heading)) };
    format!("<div class=\"ranges\">\n{heading}<ul>\n{items}</ul>\n{ends}</div>\n")
}

#[cfg(test)]
mod tests {
    use super::*;

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
        let html = ranges("effects", Look::Bars, &[line(9.0), line(-9.0)]);
        assert!(
            html.contains("&lt;k1&gt;") && html.contains("class=\"bar minus\"") && !html.contains("axis"),
            "{html}"
        );
        assert!(html.contains("left:50.00%;right:calc(100% - 91.67%)"), "{html}");
        assert_eq!(ranges("", Look::Bars, &[]), "");
    }

    #[test]
    fn dots_have_an_axis_and_what_they_are_compared_with() {
        let line = Line {
            value: Some(2.0),
            interval: Some([1.0, 3.0]),
            mark: Some((5.0, "truth 5".into())),
            ..Line::default()
        };
        let html = ranges("k1", Look::Dots, &[line]);
        assert!(
            html.contains("title=\"truth 5\"") && html.contains("class=\"dot\"") && html.contains("class=\"axis\"")
        );
        assert_eq!(axis(Look::Dots, &[Line { value: Some(2.0), ..Line::default() }]), [1.0, 3.0]);
        assert_eq!(axis(Look::Dots, &[]), [0.0, 1.0]);
    }
}
