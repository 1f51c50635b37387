//! What scripts leave: figures, tables, plots, files, the log.

use rhai::{Array, Dynamic, Engine, ImmutableString, Map};

use crate::script::{
    File, HostResult, MOST_BYTES, Options, OutputCollector, Row, number, refuse, to_json, too_many_bytes, window,
};
use base::finding::Finding;
use lab::experiment::coupon;
use lab::signal::Series;
use plot::{self, Axis, Curve, Look, Plot, Scale, TIME, Window};

/// Offers the functions whose output `collector` takes: `answer`, `measure`, `table`, `log`, `print`, `warn`, `plot`, `write_csv` and `write_text` to scripts; files are written with
/// the other results, or not at all.
pub fn register(engine: &mut Engine, collector: &OutputCollector) {
    let own = collector.clone();
    engine.register_fn("answer", move |sentence: &str| own.answer(sentence));
    let own = collector.clone();
    engine
        .register_fn("measure", move |name: &str, value: Dynamic| own.measure(name, to_json(&value)?).map_err(refuse));
    let own = collector.clone();
    engine
        .register_fn("table", move |name: &str, rows: Dynamic| own.table(name, rows_of(&rows, None)?).map_err(refuse));
    let own = collector.clone();
    engine.register_fn("table", move |name: &str, columns: Array, rows: Dynamic| {
        own.table(name, rows_of(&rows, Some(&columns))?).map_err(refuse)
    });
    let own = collector.clone();
    engine.register_fn("log", move |line: Dynamic| own.log(&line.to_string()).map_err(refuse));
    let own = collector.clone();
    engine.register_fn("warn", move |code: &str, text: &str| own.warn(code, text).map_err(refuse));
    let own = collector.clone();
    engine.register_fn("warn", move |finding: Map| own.report(finding_of(finding)?).map_err(refuse));
    let own = collector.clone();
    // The interpreter's own `print` cannot return an error: it drops lines past the limit.
    engine.on_print(move |line| drop(own.log(line)));
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
    let collect = |collector: &OutputCollector, name: &str, content: String| {
        collector.file(File { name: name.into(), content }).map_err(refuse)
    };
    let own = collector.clone();
    engine.register_fn("write_text", move |name: &str, text: &str| collect(&own, name, text.into()));
    let own = collector.clone();
    engine.register_fn("write_csv", move |name: &str, names: Array, columns: Array| {
        collect(&own, name, csv(&names, &columns, &Array::new())?)
    });
    let own = collector.clone();
    engine.register_fn("write_csv", move |name: &str, names: Array, columns: Array, comments: Array| {
        collect(&own, name, csv(&names, &columns, &comments)?)
    });
}

fn finding_of(map: Map) -> HostResult<Finding> {
    let finding = serde_json::from_value(to_json(&map.into())?);
    finding.map_err(|error| refuse!("a finding is a map with `code`, `severity` and `message`: {error}"))
}

fn rows_of(rows: &Dynamic, columns: Option<&Array>) -> HostResult<Vec<Row>> {
    if let Some(map) = rows.read_lock::<Map>() {
        return Ok(vec![row_of(&map, columns)?]);
    }
    let Some(rows) = rows.read_lock::<Array>() else {
        return Err(refuse!("a table is a map or a list of maps, not {}", rows.type_name()));
    };
    let row = |row: &Dynamic| match row.read_lock::<Map>() {
        Some(map) => row_of(&map, columns),
        None => Err(refuse!("a row of a table is a map, not {}", row.type_name())),
    };
    rows.iter().map(row).collect()
}

fn row_of(map: &Map, columns: Option<&Array>) -> HostResult<Row> {
    let Some(columns) = columns else {
        return map.iter().map(|(key, value)| Ok((key.to_string(), to_json(value)?))).collect();
    };
    let column = |column: &Dynamic| {
        let name = column.to_string();
        let value = map.get(name.as_str()).ok_or_else(|| refuse!("a row has no `{name}`"))?;
        Ok((name, to_json(value)?))
    };
    columns.iter().map(column).collect()
}

/// Least and most points of one curve; a longer one is thinned, with its extremes preserved.
const CURVE_POINTS: [usize; 2] = [200, 2_000];

/// Points of all curves of one plot, unless the least of each is more.
const PLOT_POINTS: usize = 12_000;

const LOOKS: [(&str, Look); 3] = [("line", Look::Line), ("dashed", Look::Dashed), ("points", Look::Points)];

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
    let options = Options::new("plot", options, &["x", "y", "log_x", "log_y", "window", "window_name", "picture"])?;
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
        let options = Options::new("a curve of a plot", &map, &["name", "curve", "look"])?;
        let look = options.word("look", &LOOKS)?.unwrap_or(Look::Line);
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

impl Shape {
    fn from_value(value: &Dynamic) -> HostResult<Shape> {
        if let Some(series) = value.read_lock::<Series>() {
            return Ok(Shape::Signal(series.clone()));
        }
        if let Some(law) = value.read_lock::<coupon::Curve>() {
            return Ok(Shape::Law(law.clone()));
        }
        let wrong = || refuse!("a plot shows signals, curves or pairs [xs, ys], not {}", value.type_name());
        let pair = value.read_lock::<Array>().ok_or_else(wrong)?;
        let [x, y] = pair.as_slice() else {
            return Err(refuse!("a pair of a plot is [xs, ys], not a list of {}", pair.len()));
        };
        let columns = [Column::from_value(x)?, Column::from_value(y)?];
        let [x, y] = columns.each_ref().map(|column| column.values().len());
        if x == y { Ok(Shape::Pair(columns)) } else { Err(refuse!("{x} values along x for {y} along y")) }
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
        Some(name) if !name.ends_with(".svg") => Err(refuse!("a picture is a file that ends in .svg, not `{name}`")),
        name => Ok(name),
    }
}

fn label(options: &Options<'_>, name: &str) -> HostResult<Option<String>> {
    let Some(value) = options.map.get(name) else { return Ok(None) };
    match value.read_lock::<ImmutableString>() {
        Some(text) => Ok(Some(text.to_string())),
        None => Err(refuse!("`{name}` must be a string, not {}", value.type_name())),
    }
}

/// The factor of the unit that `label` ends with.
fn in_unit(label: &str, units: &[(&str, f64)]) -> HostResult<f64> {
    let found = units.iter().find(|(unit, _)| label.ends_with(unit));
    found.map(|(_, factor)| *factor).ok_or_else(|| {
        let known: Vec<&str> = units.iter().map(|(unit, _)| *unit).collect();
        refuse!("`{label}` has no unit at its end: add {}", known.join(" or "))
    })
}

/// The window to mark: in s where signals are shown, else in the unit of the axis.
fn marked(options: &Options<'_>, factor: f64) -> HostResult<Option<Window>> {
    let Some(bounds) = options.map.get("window") else { return Ok(None) };
    let [from, to] = window(bounds)?;
    if !(from.is_finite() && to.is_finite() && from < to) {
        return Err(refuse!("the end of a window exceeds its start, which {from} to {to} does not"));
    }
    let label = label(options, "window_name")?.unwrap_or_else(|| "window".into());
    Ok(Some(Window { label, range: [from * factor, to * factor] }))
}

/// The text of a table: comments, a header, one row per value; a number that is not finite leaves its cell empty.
fn csv(names: &Array, columns: &Array, comments: &Array) -> HostResult<String> {
    if names.len() != columns.len() {
        return Err(refuse!("{} names for {} columns", names.len(), columns.len()));
    }
    let columns = columns.iter().map(Column::from_value).collect::<HostResult<Vec<_>>>()?;
    let columns: Vec<&[f64]> = columns.iter().map(Column::values).collect();
    let rows = columns.first().map_or(0, |column| column.len());
    if let Some(place) = columns.iter().position(|column| column.len() != rows) {
        let message = format!("column `{}` has {} rows, the first has {rows}", names[place], columns[place].len());
        return Err(refuse(message));
    }
    // Every cell takes at least the byte of its separator.
    if rows.saturating_mul(columns.len()) > MOST_BYTES {
        return Err(refuse(too_many_bytes()));
    }
    let comments: String = comments
        .iter()
        .map(|comment| comment.to_string().lines().map(|line| format!("# {line}\n")).collect::<String>())
        .collect();
    table(comments, names, &columns, MOST_BYTES)
}

/// The `comments` followed by the table.
///
/// # Errors
/// The text exceeds `most` bytes; the rest is not formatted then.
fn table(comments: String, names: &Array, columns: &[&[f64]], most: usize) -> HostResult<String> {
    let mut out = csv::Writer::from_writer(comments.into_bytes());
    out.write_record(names.iter().map(Dynamic::to_string)).map_err(refuse)?;
    for row in 0..columns.first().map_or(0, |column| column.len()) {
        out.write_record(columns.iter().map(|column| cell(column[row]))).map_err(refuse)?;
        if out.get_ref().len() > most {
            return Err(refuse(too_many_bytes()));
        }
    }
    let bytes = out.into_inner().map_err(|error| refuse(error.error()))?;
    String::from_utf8(bytes).map_err(refuse)
}

/// The shortest digits that read back to the same number.
fn cell(value: f64) -> String {
    if value.is_finite() { value.to_string() } else { String::new() }
}

/// A column from a script; a signal is not copied.
pub(super) enum Column {
    Signal(Series),
    List(Vec<f64>),
}

impl Column {
    /// The values of a signal or the numbers of a list, where `()` is NaN.
    pub(super) fn from_value(column: &Dynamic) -> HostResult<Column> {
        if let Some(series) = column.read_lock::<Series>() {
            return Ok(Column::Signal(series.clone()));
        }
        let Some(items) = column.read_lock::<Array>() else {
            return Err(refuse!("a column is a signal or a list of numbers, not {}", column.type_name()));
        };
        let value = |item: &Dynamic| if item.is_unit() { Ok(f64::NAN) } else { number(item, "a cell") };
        items.iter().map(value).collect::<HostResult<_>>().map(Column::List)
    }

    pub(super) fn values(&self) -> &[f64] {
        match self {
            Column::Signal(series) => series.values(),
            Column::List(values) => values,
        }
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use rhai::Scope;

    use super::*;
    use crate::functions::{engine, engine as plain, register_output};
    use crate::script::{Fault, Limits, OutputCollector, Script, ScriptOutput};
    use base::finding::Finding;

    fn run(text: &str) -> Result<ScriptOutput, Fault> {
        let (mut engine, scope) = (engine(Limits { operations: 30_000, ..Limits::STUDY }), Scope::new());
        let collector = OutputCollector::new(vec!["steps".into()]);
        register_output(&mut engine, &collector);
        let script = Script::compile(&engine, &scope, Path::new("s.rhai"), text);
        script.map_err(|mut faults| faults.remove(0))?.run(&engine, scope)?;
        Ok(collector.output())
    }

    #[test]
    fn an_endless_log_is_stopped() {
        assert!(run("loop { print(\"x\"); log(\"y\"); }").is_err());
        assert!(run("loop { warn(\"x\", \"y\"); }").is_err());
    }

    #[test]
    fn a_warning_is_a_finding_with_the_code_of_the_script() {
        let found = run("log(\"warning: of the log\"); warn(\"hard-impact\", \"the peak exceeds 500 m/s²\")").unwrap();
        assert_eq!(found.findings, [Finding::of_script("hard-impact", "the peak exceeds 500 m/s²")]);
        assert_eq!(found.log, ["warning: of the log"], "a line of the log is no warning, whatever it says");
        let fault = run("let a = 1;\n  warn(\"Hard impact\", \"x\")").unwrap_err();
        assert!(fault.message.starts_with("`Hard impact` is not the code of a warning: use lower-case"), "{fault}");
        assert_eq!((fault.line, fault.column), (2, 3));
    }

    #[test]
    fn a_finding_keeps_severity_and_figures() {
        let map = "#{ code: \"late\", severity: \"note\", message: \"the peak is late\", time_s: 0.5, index: 2 }";
        let found = run(&format!("warn({map}); warn({map} + #{{ message: `a: ${{{map}.message}}` }})")).unwrap();
        let json = serde_json::json!([
            { "code": "late", "severity": "note", "message": "the peak is late", "time_s": 0.5, "index": 2 },
            { "code": "late", "severity": "note", "message": "a: the peak is late", "time_s": 0.5, "index": 2 },
        ]);
        assert_eq!(serde_json::to_value(&found.findings).unwrap(), json);
        for (text, expected) in [
            ("warn(#{ severity: \"note\", message: \"x\" })", "missing field `code`"),
            ("warn(#{ code: \"x\", severity: \"grave\", message: \"x\" })", "unknown variant `grave`"),
            ("warn(#{ code: \"X Y\", severity: \"note\", message: \"x\" })", "`X Y` is not the code"),
        ] {
            assert!(run(text).unwrap_err().message.contains(expected), "{text}");
        }
    }

    #[test]
    fn names_are_checked() {
        assert!(run("measure(\"a b\", 1)").unwrap_err().message.contains("use letters, digits and _"));
        assert!(run("measure(\"../x\", 1)").is_err());
        assert!(run("table(\"ä\", [])").is_err());
        assert!(run("measure(\"steps\", 1)").unwrap_err().message.contains("cannot be replaced"));
    }

    #[test]
    fn figures_keep_their_order_and_kind() {
        let found = run("measure(\"b\", 1); measure(\"a\", 0.5); measure(\"n\", 0.0/0.0); measure(\"t\", \"x\");
         table(\"rows\", [\"test\", \"k1\"], [#{ k1: 2, test: \"1008\" }]); print(1.5);")
        .unwrap();
        let measures = serde_json::to_string(&found.measures).unwrap();
        assert_eq!(measures, r#"{"b":1,"a":0.5,"n":null,"t":"x"}"#);
        assert_eq!(serde_json::to_string(&found.tables[0].1).unwrap(), r#"[{"test":"1008","k1":2}]"#);
        assert_eq!(found.log, ["1.5"]);
    }

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
        assert_eq!([a.x.label.as_str(), a.y.label.as_str()], ["time (ms)", "acceleration (m/s²)"]);
        assert_eq!(a.curves[1].look, Look::Dashed);
        assert_eq!(a.window, Some(Window { label: "window".into(), range: [0.0, 50.0] }));
        assert_eq!((b.curves[0].points[1][0], b.y.scale, b.y.label.as_str()), (0.05, Scale::Logarithmic, "b"));
        assert_eq!([c.y.label.as_str(), c.curves[0].name.as_str()], ["stress (MPa)", "c"]);
        assert_eq!(c.curves[0].points[1], [50.0, 5.0]);
        assert_eq!(d.curves[0].points[1], [1500.0, 2.0]);
        assert!(d.curves[0].points[2][1].is_nan());
    }

    #[test]
    fn the_size_of_plots_is_limited() {
        let long = "let s = signal([0, 1e-4], [0, 1]).resampled(1e-9);";
        let thin = plots(&format!("{long} plot(\"a\", s); plot(\"a\", s);"));
        assert!(thin.len() == 1 && (1300..=2000).contains(&thin[0].curves[0].points.len()));
    }

    /// Its text, or copies of its columns, would take gigabytes.
    #[test]
    fn a_table_that_is_too_large_is_refused_before_it_is_written() {
        let long = Dynamic::from(Series::new(vec![0.0; 1_000_000], vec![0.0; 1_000_000]));
        let error = csv(&vec!["a".into(); 9_000], &vec![long; 9_000], &Array::new()).unwrap_err().to_string();
        assert!(error.contains("256 MB"), "{error}");
        let digits = vec![-1e-300; 1_000];
        assert!(table(String::new(), &vec!["a".into()], &[&digits], 100_000).is_err(), "digits count too");
        assert!(table(String::new(), &vec!["a".into()], &[&digits], 400_000).is_ok());
    }

    #[test]
    fn a_table_has_its_comments_its_header_and_gaps() {
        let list = |items: [f64; 2]| Dynamic::from(items.map(Dynamic::from).to_vec());
        let names: Array = vec!["a, b".into(), "c".into()];
        let columns: Array = vec![list([0.1, 2.0]), list([f64::NAN, -1e-7])];
        let text = csv(&names, &columns, &vec!["virtual\nmade up".into()]).unwrap();
        assert_eq!(text, "# virtual\n# made up\n\"a, b\",c\n0.1,\n2,-0.0000001\n");
        let ragged: Array = vec![list([0.0, 1.0]), Dynamic::from(vec![Dynamic::from(1.0)])];
        assert!(csv(&names, &ragged, &Array::new()).unwrap_err().to_string().contains("`c` has 1 rows"));
        assert!(csv(&names, &ragged[..1].to_vec(), &Array::new()).is_err());
    }
}
