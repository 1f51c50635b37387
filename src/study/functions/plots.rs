//! Plots of scripts: signals over time, curves over strain, pairs of lists.

use rhai::{Array, Dynamic, Engine, ImmutableString, Map};

use super::files::Column;
use crate::script::{Entry, File, HostResult, Options, OutputCollector, refuse, window};
use lab::experiment::coupon;
use lab::signal::Series;
use plot::{self, Axis, Curve, Look, Plot, Scale, TIME, Window};

/// Least and most points of one curve; a longer one is thinned, with its extremes preserved.
const CURVE_POINTS: [usize; 2] = [200, 2_000];

/// Points of all curves of one plot, unless the least of each is more.
const PLOT_POINTS: usize = 12_000;

const LOOKS: [(&str, Look); 3] = [("line", Look::Line), ("dashed", Look::Dashed), ("points", Look::Points)];

/// Offers `plot` to scripts.
pub(super) fn register(collector: &OutputCollector, engine: &mut Engine) {
    let own = collector.clone();
    engine.register_fn("plot", move |title: &str, curves: Dynamic| {
        own.plot(written(title, &Map::new(), &curves)?).map_err(refuse)
    });
    let own = collector.clone();
    engine.register_fn("plot", move |title: &str, options: Map, curves: Dynamic| {
        let plot = written(title, &options, &curves)?;
        if let Some(name) = picture(&options)? {
            own.file(File { name, content: plot::svg(&plot) }).map_err(refuse)?;
        }
        own.plot(plot).map_err(refuse)
    });
}

/// One curve from a script.
struct Given {
    name: String,
    look: Look,
    shape: Shape,
}

enum Shape {
    /// Over time.
    Signal(Series),
    /// Stress over strain.
    Law(coupon::Curve),
    /// In the units of the axes.
    Pair([Column; 2]),
}

/// Axes, and the factors from values of curves to units of the axes.
struct Axes {
    x: Axis,
    y: Axis,
    factors: [f64; 2],
}

fn written(title: &str, options: &Map, curves: &Dynamic) -> HostResult<Plot> {
    let options = Options { of: "plot", map: options };
    options.check(&["x", "y", "log_x", "log_y", "window", "window_name", "picture"])?;
    let given = given(title, curves)?;
    let Axes { x, y, factors } = axes(title, &options, &given)?;
    let [least, most] = CURVE_POINTS;
    let points = (PLOT_POINTS / given.len().max(1)).clamp(least, most);
    let curves = given.iter().map(|given| given.drawn(factors).thinned(points)).collect();
    let window = marked(&options, factors[0])?;
    Ok(Plot { x, y, window, ..Plot::new(title, ["", ""], curves) })
}

/// The curves with their names; a single curve takes the title.
fn given(title: &str, curves: &Dynamic) -> HostResult<Vec<Given>> {
    if let Some(map) = curves.read_lock::<Map>() {
        return map.iter().map(|(name, curve)| Given::from_curve(name, curve)).collect();
    }
    let all_named = |list: &Array| !list.is_empty() && list.iter().all(Dynamic::is_map);
    match curves.read_lock::<Array>() {
        Some(list) if all_named(&list) => list.iter().map(Given::named).collect(),
        _ => Ok(vec![Given { name: title.into(), look: Look::Line, shape: Shape::from_value(curves)? }]),
    }
}

impl Given {
    /// A curve of a list: `#{ name, curve, look }`.
    fn named(map: &Dynamic) -> HostResult<Given> {
        let name = map.read_lock::<Map>().and_then(|map| map.get("name").cloned());
        let name = name.ok_or_else(|| refuse("a curve of a list needs its `name`"))?;
        Given::from_curve(&name.to_string(), map)
    }

    /// A curve, or a map of a curve and its look.
    fn from_curve(name: &str, curve: &Dynamic) -> HostResult<Given> {
        let Some(map) = curve.read_lock::<Map>() else {
            return Ok(Given { name: name.into(), look: Look::Line, shape: Shape::from_value(curve)? });
        };
        let options = Options { of: "a curve of a plot", map: &map };
        options.check(&["name", "curve", "look"])?;
        let look = map.get("look").map_or(Ok(Look::Line), look)?;
        Ok(Given { name: name.into(), look, shape: Shape::from_value(options.value("curve")?)? })
    }

    fn drawn(&self, [x, y]: [f64; 2]) -> Curve {
        let points: Vec<[f64; 2]> = match &self.shape {
            Shape::Signal(series) => series.samples().map(|[time, value]| [time * x, value]).collect(),
            Shape::Law(law) => law.strain().iter().zip(law.stress()).map(|(e, s)| [e * x, s * y]).collect(),
            Shape::Pair([xs, ys]) => xs.values().iter().zip(ys.values()).map(|(x, y)| [*x, *y]).collect(),
        };
        Curve { name: self.name.clone(), points, look: self.look }
    }
}

fn look(value: &Dynamic) -> HostResult<Look> {
    let text = value.to_string();
    let found = LOOKS.iter().find(|(name, _)| *name == text).map(|(_, look)| *look);
    found.ok_or_else(|| refuse(format!("unknown look `{text}` (there are line, dashed, points)")))
}

impl Shape {
    fn from_value(value: &Dynamic) -> HostResult<Shape> {
        if let Some(series) = value.read_lock::<Series>() {
            return Ok(Shape::Signal(series.clone()));
        }
        if let Some(law) = value.read_lock::<coupon::Curve>() {
            return Ok(Shape::Law(law.clone()));
        }
        let wrong = || refuse(format!("a plot shows signals, curves or pairs [xs, ys], not {}", value.type_name()));
        let pair = value.read_lock::<Array>().ok_or_else(wrong)?;
        let [x, y] = pair.as_slice() else {
            return Err(refuse(format!("a pair of a plot is [xs, ys], not a list of {}", pair.len())));
        };
        let columns = [Column::from_value(x)?, Column::from_value(y)?];
        let [x, y] = columns.each_ref().map(|column| column.values().len());
        if x == y { Ok(Shape::Pair(columns)) } else { Err(refuse(format!("{x} values along x for {y} along y"))) }
    }
}

/// Labels and units: those of the script, or else those of the curves.
fn axes(title: &str, options: &Options<'_>, given: &[Given]) -> HostResult<Axes> {
    let has = |kind: fn(&Shape) -> bool| given.iter().any(|given| kind(&given.shape));
    let over_time = has(|shape| matches!(shape, Shape::Signal(_)));
    let over_strain = has(|shape| matches!(shape, Shape::Law(_)));
    let (x, y) = (label(options, "x")?, label(options, "y")?);
    let (x, y, factors) = match (over_time, over_strain) {
        (true, true) => return Err(refuse("a plot shows signals over time or curves over strain, not both")),
        (true, false) => {
            let x = x.unwrap_or_else(|| TIME.into());
            let factor = in_unit(&x, &[("(ms)", 1e3), ("(s)", 1.0)])?;
            (x, y.unwrap_or_else(|| title.into()), [factor, 1.0])
        }
        (false, true) => {
            let (x, y) = (x.unwrap_or_else(|| "strain".into()), y.unwrap_or_else(|| "stress (MPa)".into()));
            let factors = [in_unit(&x, &[("(%)", 1e2), ("", 1.0)])?, in_unit(&y, &[("(MPa)", 1e-6), ("(Pa)", 1.0)])?];
            (x, y, factors)
        }
        (false, false) => {
            let x =
                x.ok_or_else(|| refuse("plot needs `x`, the label of the x axis: #{ x: \"displacement (mm)\" }"))?;
            (x, y.unwrap_or_else(|| title.into()), [1.0, 1.0])
        }
    };
    let scale = |log| if log { Scale::Logarithmic } else { Scale::Linear };
    let x = Axis { label: x, scale: scale(options.boolean("log_x", false)?) };
    let y = Axis { label: y, scale: scale(options.boolean("log_y", false)?) };
    Ok(Axes { x, y, factors })
}

/// The file of the picture, if there is to be one.
fn picture(options: &Map) -> HostResult<Option<String>> {
    let name = label(&Options { of: "plot", map: options }, "picture")?;
    match name {
        Some(name) if !name.ends_with(".svg") => {
            Err(refuse(format!("a picture is a file that ends in .svg, not `{name}`")))
        }
        name => Ok(name),
    }
}

fn label(options: &Options<'_>, name: &str) -> HostResult<Option<String>> {
    let Some(value) = options.map.get(name) else { return Ok(None) };
    match value.read_lock::<ImmutableString>() {
        Some(text) => Ok(Some(text.to_string())),
        None => Err(refuse(format!("`{name}` must be a string, not {}", value.type_name()))),
    }
}

/// The factor of the unit that `label` ends with.
fn in_unit(label: &str, units: &[(&str, f64)]) -> HostResult<f64> {
    let found = units.iter().find(|(unit, _)| label.ends_with(unit));
    found.map(|(_, factor)| *factor).ok_or_else(|| {
        let known: Vec<&str> = units.iter().map(|(unit, _)| *unit).collect();
        refuse(format!("`{label}` has no unit at its end: add {}", known.join(" or ")))
    })
}

/// The window to mark: in s where signals are shown, else in the unit of the axis.
fn marked(options: &Options<'_>, factor: f64) -> HostResult<Option<Window>> {
    let Some(bounds) = options.map.get("window") else { return Ok(None) };
    let [from, to] = window(bounds)?;
    if !(from.is_finite() && to.is_finite() && from < to) {
        return Err(refuse(format!("the end of a window exceeds its start, which {from} to {to} does not")));
    }
    let label = label(options, "window_name")?.unwrap_or_else(|| "window".into());
    Ok(Some(Window { label, range: [from * factor, to * factor] }))
}

/// The reference of plots.
pub const ENTRIES: &[Entry] = &[
    Entry {
        call: "plot(title, #{ name: signal, … })",
        gives: "a plot in the report and, of a run, in its recording: signals over time in ms; the title labels the y axis",
        example: r#"plot("acceleration (m/s²)", #{ measured: signal([0, 0.1], [0, 150]), raw: signal([0, 0.1], [3, 149]) })"#,
    },
    Entry {
        call: "plot(title, #{ x, y, log_x, log_y, window: [from, to], window_name }, curves)",
        gives: "the same with labels of the axes, logarithmic axes, and a marked window of x (s where signals are shown)",
        example: r#"let read = signal([0, 0.1], [0, 150]);
                    plot("Braking", #{ y: "acceleration (m/s²)", window: [0, 0.05], window_name: "loading" }, read)"#,
    },
    Entry {
        call: "plot(title, #{ …, picture: \"name.svg\" }, curves)",
        gives: "the same, and its picture as a file among the results",
        example: r#"plot("MD", #{ picture: "pictures/md.svg" }, curve([0, 0.26], [0, 8.4e6]))"#,
    },
    Entry {
        call: "#{ name: signal | curve | [xs, ys] }",
        gives: "the curves of a plot: signals over time, stress–strain curves in MPa, or two lists or signals of the same length in the \
                units of the axes in `x` and `y`",
        example: r#"plot("MD", #{ film: curve([0, 0.26], [0, 8.4e6]) });
                    let travel = signal([0, 0.1], [0, -0.17]); let force = signal([0, 0.1], [0, 1500]);
                    plot("Loop", #{ x: "travel (mm)", y: "force (N)" }, [travel * -1000, force])"#,
    },
    Entry {
        call: "[#{ name, curve, look: \"line\" | \"dashed\" | \"points\" }, …]",
        gives: "curves in this order; dashed is meant for references",
        example: r#"let law = curve([0, 0.26, 0.84], [0, 8.4e6, 20e6]);
                    plot("Yield points of MD", [#{ name: "mean", curve: law },
                        #{ name: "yield points", curve: [[0.26, 0.84], [8.4, 20]], look: "points" }])"#,
    },
];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::functions::{engine as plain, register_output};
    use crate::script::Limits;

    fn plots(script: &str) -> Vec<Plot> {
        let collector = OutputCollector::new(vec![]);
        let mut engine = plain(Limits::POST);
        register_output(&mut engine, &collector);
        engine.run(script).unwrap();
        collector.output().plots
    }

    #[test]
    fn signals_are_plotted_over_milliseconds_and_curves_in_megapascals() {
        let found = plots(
            "let s = signal([0, 0.05, 0.1], [0, 150, 20]);
             plot(\"a\", #{ y: \"acceleration (m/s²)\", window: [0, 0.05] }, [#{ name: \"s\", curve: s }, #{ name: \"e\", curve: s, look: \"dashed\" }]);
             plot(\"b\", #{ x: \"time (s)\", log_y: true }, #{ s: s });
             plot(\"c\", #{ x: \"strain (%)\" }, curve([0, 0.5], [0, 5e6]));
             plot(\"d\", #{ x: \"travel (mm)\", y: \"force (N)\" }, [s * 10, [1, 2, ()]]);",
        );
        let [a, b, c, d] = &found[..] else { panic!("{found:?}") };
        assert_eq!(a.curves[0].points, [[0.0, 0.0], [50.0, 150.0], [100.0, 20.0]]);
        assert_eq!(
            (a.x.label.as_str(), a.y.label.as_str(), a.curves[1].look),
            ("time (ms)", "acceleration (m/s²)", Look::Dashed)
        );
        assert_eq!(a.window, Some(Window { label: "window".into(), range: [0.0, 50.0] }));
        assert_eq!((b.curves[0].points[1][0], b.y.scale, b.y.label.as_str()), (0.05, Scale::Logarithmic, "b"));
        assert_eq!(
            (c.curves[0].points[1], c.y.label.as_str(), c.curves[0].name.as_str()),
            ([50.0, 5.0], "stress (MPa)", "c")
        );
        assert_eq!(d.curves[0].points[1], [1500.0, 2.0]);
        assert!(d.curves[0].points[2][1].is_nan());
    }

    #[test]
    fn the_size_of_plots_is_limited() {
        let long = "let s = signal([0, 1e-4], [0, 1]).resampled(1e-9);";
        let thin = plots(&format!("{long} plot(\"a\", s); plot(\"a\", s);"));
        assert!(thin.len() == 1 && (1300..=2000).contains(&thin[0].curves[0].points.len()));
    }
}
