//! The tests of a calibration: a scenario each, and the recordings that its signals are compared with.

use rhai::{Array, Dynamic, Map};

use super::distance::Distance;
use nalgebra::{DVector, Matrix2};

use super::error_model::{Correlation, ErrorModel, Noise, Recorded, Shape, Spectrum};
use super::outcome::{self, Outcomes};
use super::pulled;
use crate::post::Run;
use crate::scenario_functions::{ScenarioHandle, Scenarios, changes_of};
use crate::script::{
    Compared, HostResult, Options, Session, cause, number, one_or_several, refuse, refuse_within, texts,
};
use base::units::{Dimension, Length, Time};
use lab::signal::Series;
use lab::signal::column::{self, COLUMNS, Column};
use lab::signal::file::{self, ReadOptions};
use scene::model::Loading;
use scene::simulate::Across;

/// A test: a scenario and its recordings.
#[derive(Clone)]
pub(super) struct Test {
    /// Its name in results: that of the scenario, unless given.
    pub(super) name: String,
    /// The scenario, which runs as long as its recordings are compared.
    pub(super) study: ScenarioHandle,
    /// Names of parameters that have a value of their own here.
    pub(super) own: Vec<String>,
    /// What its squared residuals are multiplied by.
    pub(super) weight: f64,
    /// The word of those tests that have the model's error in common, and what that leaves of the weight of its signals.
    pub(super) shared_error: Option<String>,
    pub(super) of_signals: f64,
    /// Its signals, each with all of its recordings.
    pub(super) signals: Vec<Signal>,
    /// Whether its film held, and what else is known of its rupture.
    pub(super) outcomes: Option<Outcomes>,
    /// What holds the film across, where it is pulled and not run.
    pub(super) pull: Option<Across>,
}

/// A signal of a test that is compared with its recordings, which share what the model is off by.
#[derive(Clone)]
pub(super) struct Signal {
    /// Its name in scripts.
    pub(super) name: &'static str,
    /// Its column.
    pub(super) column: &'static Column,
    /// What it is compared over; none for time.
    over: Option<&'static Column>,
    /// The recordings in their windows.
    pub(super) recordings: Vec<Series>,
    /// What the two may differ by.
    pub(super) errors: ErrorModel,
    /// How they are compared.
    pub(super) distance: Distance,
}

/// What signals of all tests may differ by.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tolerances {
    pub(super) noise: Noise,
    /// Length over which the model's error is correlated, of time signals where it is a time; none where it is not known.
    pub(super) correlation: Option<Correlation>,
}

/// The impactor's peak is not a column; these names stand for columns.
const ALIASES: [(&str, &str); 1] = [("apex", "deflection")];

impl Test {
    /// Reads `#{ scenario, compare, window, … }`.
    pub(super) fn read(
        given: &Dynamic,
        scenarios: &Scenarios,
        tolerances: Tolerances,
        session: &Session,
    ) -> HostResult<Test> {
        let map = given.read_lock::<Map>().map(|map| map.clone());
        let map =
            map.ok_or_else(|| refuse!("a test of calibrate is a map with `scenario` and `compare`, not {given}"))?;
        let options = Options::new("a test of calibrate", &map, &super::file::options_at(super::file::TEST))?;
        let study = scenarios.changed(&options, "`set` of a test", session)?;
        let name = map.get("name").map_or_else(|| study.name().to_owned(), Dynamic::to_string);
        let place = format!("test `{name}`");
        let test = Test::of_scenario(name, study, &options, tolerances, session);
        test.map_err(|error| refuse_within(&place, error))
    }

    /// The test of a scenario with these options.
    fn of_scenario(
        name: String,
        study: ScenarioHandle,
        options: &Options<'_>,
        tolerances: Tolerances,
        session: &Session,
    ) -> HostResult<Test> {
        let Options { map, .. } = options;
        let weight = options.number("weight", 1.0)?;
        if !(weight > 0.0 && weight.is_finite()) {
            return Err(refuse!("`weight` is {weight}, which must be above zero"));
        }
        let outcomes = outcome::read(map, &study, session).map_err(|error| refuse(cause(&error)))?;
        check_together(map, outcomes.as_ref())?;
        let own = options.texts("own")?;
        let pull = map.get("pull").map(|given| pulled::across(given, &study)).transpose()?;
        let shared_error = map.get("shared_error").map(Dynamic::to_string);
        let test =
            Test { name, study, own, weight, shared_error, of_signals: 1.0, signals: Vec::new(), outcomes, pull };
        if test.outcomes.is_some() && !map.contains_key("compare") {
            Ok(test)
        } else {
            test.compared(options, tolerances, session)
        }
    }

    /// The test with the signals that are compared.
    fn compared(self, options: &Options<'_>, tolerances: Tolerances, session: &Session) -> HostResult<Test> {
        let Options { map, .. } = options;
        let columns = signals_of(map, &self.study)?;
        let over = abscissa_of(map, &self.study)?;
        let noise = map.get("noise").map_or(Ok(tolerances.noise), noise)?;
        let tolerances = Tolerances { noise, ..tolerances };
        let reading = Reading { over, window: map.get("window"), tolerances, distance: Distance::read(options)? };
        let recordings = map.get("recordings").map_or_else(|| vec![Dynamic::UNIT], one_or_several);
        if recordings.is_empty() {
            return Err(refuse("`recordings` is an empty array, as of a pattern that no file matches"));
        }
        if self.pull.is_some() {
            let reading = Reading { over: Some(&column::STRAIN), ..reading };
            let recorded = recordings.iter().map(|recording| reading.pulled(recording));
            let signal = reading.signal(&column::STRESS, recorded.collect::<HostResult<Vec<_>>>()?)?;
            return Ok(Test { signals: vec![signal], ..self });
        }
        let mut recorded: Vec<Vec<Recorded>> = vec![Vec::new(); columns.len()];
        let mut longest: Option<(f64, ScenarioHandle)> = None;
        for recording in &recordings {
            let (own, end, found) = reading.recording(&self.study, recording, &columns, session)?;
            recorded.iter_mut().zip(found).for_each(|(all, one)| all.push(one));
            if longest.as_ref().is_none_or(|(latest, _)| end > *latest) {
                longest = Some((end, own));
            }
        }
        let signals = columns.iter().zip(recorded).map(|(column, recorded)| reading.signal(column, recorded));
        let signals = signals.collect::<HostResult<Vec<_>>>()?;
        Ok(match longest {
            Some((_, study)) => Test { signals, study, ..self },
            None => Test { signals, ..self },
        })
    }

    /// Its signals as the scenario gives them, by a run unless it is pulled.
    pub(super) fn simulated(&self, study: &ScenarioHandle, session: &Session) -> HostResult<Vec<Series>> {
        let Some(across) = self.pull else {
            let run = study.simulate(session)?;
            return self.signals.iter().map(|signal| signal.simulated(&run)).collect();
        };
        let end = self.signals.iter().map(Signal::end).fold(0.0, f64::max);
        Ok(vec![pulled::simulated(study, across, end)?])
    }

    /// The scenario whose runs its signals are of: that of film which does not break where it has outcomes.
    pub(super) fn compared_study(&self) -> &ScenarioHandle {
        self.outcomes.as_ref().map_or(&self.study, |outcomes| &outcomes.study)
    }

    /// All recordings of all signals.
    pub(super) fn recordings(&self) -> impl Iterator<Item = &Series> {
        self.signals.iter().flat_map(|signal| &signal.recordings)
    }

    /// The shapes that the model's error of its signals may have: of time signals those of a length that is given.
    pub(super) fn shapes(&self, length: Option<Correlation>) -> Vec<Shape> {
        match length {
            // A time says nothing of a travel; a finding says so.
            Some(Correlation::Length(_)) if self.signals.iter().any(Signal::is_over_travel) => Shape::all(None),
            length => Shape::all(length),
        }
    }
}

/// Says of tests that have the model's error in common what that leaves of the weight of their signals: together they tell as much
/// as their mean (methods.md, section 28). A test without weight is none of them.
pub(super) fn share_errors(tests: &mut [Test]) {
    let counts = |test: &&Test| test.weight > 0.0 && test.shared_error.is_some();
    let words: Vec<Option<String>> = tests.iter().filter(counts).map(|test| test.shared_error.clone()).collect();
    for test in tests.iter_mut().filter(|test| counts(&&**test)) {
        test.of_signals = 1.0 / words.iter().filter(|word| **word == test.shared_error).count() as f64;
    }
}

/// How the recordings of a test are read.
struct Reading<'a> {
    over: Option<&'static Column>,
    window: Option<&'a Dynamic>,
    tolerances: Tolerances,
    distance: Distance,
}

impl Reading<'_> {
    /// The signals of one recording, the end of their windows, and the scenario that is compared with it.
    fn recording(
        &self,
        study: &ScenarioHandle,
        recording: &Dynamic,
        columns: &[&'static Column],
        session: &Session,
    ) -> HostResult<(ScenarioHandle, f64, Vec<Recorded>)> {
        let is_impact = matches!(study.model().loading, Loading::Impact(_)) && self.over.is_none();
        let of_scenario = |signals: Vec<Recorded>| (study.clone(), end_of(&signals), signals);
        if let Some(map) = recording.read_lock::<Map>() {
            return self.given(&map, is_impact, columns).map(of_scenario);
        }
        if !is_impact {
            return self.file(recording, columns, session).map(of_scenario);
        }
        let mut changes = Map::new();
        if !recording.is_unit() {
            changes.insert("reference.signals".into(), recording.clone());
        }
        if let Some(window) = self.window {
            changes.insert("reference.window".into(), window.clone());
        }
        let with = || if changes.is_empty() { Ok(study.clone()) } else { study.with(changes_of(&changes)?, session) };
        let study = with()?;
        let comparison = study.comparison()?.clone();
        let class = study.model().output.filter;
        let signals = columns.iter().map(|column| {
            let series = match column.short {
                "acceleration" => comparison.acceleration.clone().map(|series| (series, class)),
                "displacement" => comparison.displacement.clone().map(|series| (series, None)),
                _ => None,
            };
            let Some((series, class)) = series else {
                let known = "an impact is compared by `acceleration` and `displacement`";
                return Err(refuse!("its recording has no `{}`: {known}", column.short));
            };
            let recorded = self.recorded(column, &series, comparison.window, class)?;
            let contact = Matrix2::from_fn(|row, column| comparison.contact[row][column]);
            Ok(recorded.with_contact(contact, columns.len()))
        });
        let signals = signals.collect::<HostResult<Vec<_>>>()?;
        Ok((study, comparison.window[1], signals))
    }

    /// Signals that the script gives, over time or over what is asked for.
    fn given(&self, map: &Map, is_impact: bool, columns: &[&'static Column]) -> HostResult<Vec<Recorded>> {
        const ERRORS: [&str; 2] = ["contact_error", "speed_error"];
        let known: Vec<&str> = columns.iter().map(|column| column.short).chain(ERRORS).collect();
        Options { of: "a recording of signals", map }.check(&known)?;
        let error = |key: &str| {
            let Some(given) = map.get(key) else { return Ok(0.0) };
            let value = number(given, key)?;
            match is_impact && value > 0.0 && value.is_finite() {
                true => Ok(value),
                false if !is_impact => Err(refuse!("`{key}` is of an impact over time")),
                false => Err(refuse!("`{key}` is a standard deviation above zero, not {value}")),
            }
        };
        let [of_time, of_speed] = [error(ERRORS[0])?, error(ERRORS[1])?];
        let contact = Matrix2::from_diagonal(&[of_time * of_time, of_speed * of_speed].into());
        let signals = columns.iter().map(|column| {
            let series =
                map.get(column.short).and_then(|value| value.read_lock::<Series>().map(|series| series.clone()));
            let series = series.ok_or_else(|| refuse!("a recording of signals has no `{}`", column.short))?;
            let window = self.window(&series)?;
            Ok(self.recorded(column, &series, window, None)?.with_contact(contact, columns.len()))
        });
        signals.collect()
    }

    /// Signals of a file with the columns of `signals.csv`, over time or over another of its columns.
    fn file(&self, recording: &Dynamic, columns: &[&'static Column], session: &Session) -> HostResult<Vec<Recorded>> {
        let path = recording.clone().into_string();
        let path = path.map_err(|_| refuse("name its `recordings`: one file or an array of files"))?;
        let path = std::path::Path::new(&path);
        let measurement = file::read(path, &ReadOptions::default()).map_err(refuse)?;
        session.add_recording(path, measurement.annotations.is_virtual());
        let channel = |column: &Column| {
            let found = [column.name, column.short].iter().find_map(|name| measurement.channel(name).ok());
            let known =
                || measurement.channels.iter().map(|channel| channel.name.as_str()).collect::<Vec<_>>().join(", ");
            let missing = || refuse!("{} has no `{}`; it has {}", path.display(), column.name, known());
            found.map(|channel| channel.series.clone()).ok_or_else(missing)
        };
        let signals = columns.iter().map(|column| {
            let series = match self.over {
                None => channel(column)?,
                Some(over) => over_abscissa(&channel(over)?, &channel(column)?),
            };
            let window = self.window(&series)?;
            self.recorded(column, &series, window, None)
        });
        signals.collect()
    }

    /// Stress over strain of a coupon.
    fn pulled(&self, recording: &Dynamic) -> HostResult<Recorded> {
        self.recorded(&column::STRESS, &pulled::recorded(recording)?, pulled::window(self.window)?, None)
    }

    /// The window that the options give, or all of the signal.
    fn window(&self, series: &Series) -> HostResult<[f64; 2]> {
        let all = [f64::NEG_INFINITY, f64::INFINITY];
        let Some(given) = self.window else { return Ok(all) };
        if given.clone().into_string().is_ok_and(|text| text == "all") {
            return Ok(all);
        }
        let wrong = || refuse("`window` is [from, to] or \"all\" where there is no loading phase of an impact");
        let list =
            given.read_lock::<Array>().filter(|list| list.len() == 2).map(|list| list.clone()).ok_or_else(wrong)?;
        let dimension: Dimension = if self.over.is_none() { Time::DIMENSION } else { Length::DIMENSION };
        let end = |value: &Dynamic| match value.clone().into_string() {
            Ok(text) => dimension.parse(&text).map_err(refuse),
            Err(_) => number(value, "an end of the window"),
        };
        let window = [end(&list[0])?, end(&list[1])?];
        if window[0] < window[1] && !series.is_empty() { Ok(window) } else { Err(wrong()) }
    }

    fn recorded(&self, column: &Column, series: &Series, window: [f64; 2], class: Option<f64>) -> HostResult<Recorded> {
        Recorded::new(series, window, class).map_err(|error| refuse!("{}: {error}", column.short))
    }

    /// A signal with all of its recordings.
    fn signal(&self, column: &'static Column, recorded: Vec<Recorded>) -> HostResult<Signal> {
        let length =
            self.tolerances.correlation.filter(|own| self.over.is_none() || matches!(own, Correlation::Share(_)));
        let errors = ErrorModel::new(&recorded, self.tolerances.noise, Shape::all(length)[0]);
        let errors = errors.map_err(|error| refuse!("{}: {error}", column.short))?;
        let recordings = recorded.into_iter().map(|own| own.series).collect();
        Ok(Signal { name: column.short, column, over: self.over, recordings, errors, distance: self.distance })
    }
}

/// Where the last of some signals ends.
fn end_of(signals: &[Recorded]) -> f64 {
    signals.iter().filter_map(|own| own.series.time().last().copied()).fold(0.0, f64::max)
}

impl Signal {
    /// The simulated signal over the abscissa of the recording.
    pub(super) fn simulated(&self, run: &Run) -> HostResult<Series> {
        let values = run.channel(self.name)?;
        Ok(match self.over {
            None => values,
            Some(over) => over_abscissa(&run.channel(over.short)?, &values),
        })
    }

    /// What a simulated signal differs by from the recordings, bin by bin over the noise; one number of other distances.
    pub(super) fn scaled(&self, simulated: &Series) -> Result<DVector<f64>, String> {
        let found = self.distance.scaled(&self.errors, &self.recordings, simulated);
        found.map_err(|error| format!("{}: {error}", self.name))
    }

    /// Independent residuals of unit variance, with a model's error of `share`; plain ones take that as independent from bin to bin.
    pub(super) fn residuals(&self, simulated: &Series, share: f64, is_plain: bool) -> Result<Vec<f64>, String> {
        let scaled = self.scaled(simulated)?;
        Ok(match (self.distance.is_residuals(), is_plain) {
            (false, _) => scaled.as_slice().to_vec(),
            (true, true) => self.errors.plain(&scaled, share),
            (true, false) => self.errors.whitened(&scaled, share),
        })
    }

    /// Number of differences.
    pub(super) fn count(&self) -> usize {
        if self.distance.is_residuals() { self.errors.bins() } else { 1 }
    }

    /// The coordinates of the differences in which noise and a model's error of a shape, or of its own, are independent.
    pub(super) fn spectrum(&self, shape: Option<Shape>) -> Spectrum {
        match (self.distance.is_residuals(), shape) {
            (false, _) => Spectrum::trivial(1),
            (true, Some(shape)) => self.errors.spectrum_of(shape),
            (true, None) => self.errors.spectrum().clone(),
        }
    }

    /// Takes the errors of its recordings' contacts as errors of its differences, by the simulated signal and by that of an
    /// impactor which is faster by so much.
    pub(super) fn add_contact(&mut self, simulated: &Series, faster: Option<(&Series, f64)>) -> Result<(), String> {
        if self.errors.contact_errors() == [false; 2] {
            return Ok(());
        }
        let of_speed = faster.map(|(faster, by)| -> Result<DVector<f64>, String> {
            let [own, faster] = [simulated, faster].map(|series| self.errors.means(series).map(DVector::from_vec));
            let mut change = (faster? - own?) / by;
            if self.column.short == column::DISPLACEMENT.short {
                // The travel of the recording falls with its speed, too.
                change.iter_mut().zip(self.errors.middles()).for_each(|(own, [time, _])| *own += time);
            }
            Ok(change)
        });
        let mut errors = self.errors.clone();
        let is_travel = self.column.short == column::DISPLACEMENT.short;
        errors.add_contact(|by| later(simulated, by, is_travel), of_speed.transpose()?)?;
        self.errors = errors;
        Ok(())
    }

    /// Where the last of its recordings ends.
    pub(super) fn end(&self) -> f64 {
        self.recordings.iter().filter_map(|own| own.time().last().copied()).fold(0.0, f64::max)
    }

    /// The comparison with the first recording, for plots of the search.
    pub(super) fn compared(&self, simulated: &Series) -> Compared {
        let all = [f64::NEG_INFINITY, f64::INFINITY];
        let measured = &self.recordings[0];
        if self.over == Some(&column::STRAIN)
            && let (Some(own), Some(measured)) = (pulled::curve(simulated), pulled::curve(measured))
        {
            return Compared::curves(&own, &measured);
        }
        match self.over {
            Some(_) => Compared::over_travel(simulated, measured),
            None => Compared::signals(simulated, measured, all),
        }
    }

    /// Whether it is compared over a travel, a depth or a strain and not over time.
    pub(super) fn is_over_travel(&self) -> bool {
        self.over.is_some()
    }

    /// Words of the axis and of the abscissa in plots.
    pub(super) fn abscissa(&self) -> (&'static str, f64) {
        self.over.map_or(("time (ms)", 1e3), |over| (over.axis, over.factor))
    }
}

/// A simulated signal as it is seen by one who takes the contact to be so much later than it was, with the same speed then
/// (docs/methods.md, equation 331c).
fn later(simulated: &Series, by: f64, is_travel: bool) -> Series {
    let time = simulated.time();
    let (Some(first), Some(last)) = (simulated.samples().next(), simulated.samples().last()) else {
        return simulated.clone();
    };
    let slope_at = |place: usize| match (simulated.samples().nth(place), simulated.samples().nth(place + 1)) {
        (Some(a), Some(b)) => (b[1] - a[1]) / (b[0] - a[0]),
        _ => 0.0,
    };
    // A travel counts from contact, and its speed there is what was measured; an acceleration counts as it is.
    let start = if is_travel { slope_at(0) } else { 0.0 };
    let end = slope_at(time.len().saturating_sub(2));
    let at = |t: f64| match simulated.value_at(t) {
        Some(value) => value,
        None if t < first[0] => first[1] + start * (t - first[0]),
        None => last[1] + end * (t - last[0]),
    };
    let [zero, turn] = match time.partition_point(|t| *t <= first[0] + by) {
        _ if !is_travel => [0.0, 0.0],
        0 => [at(first[0] + by) - first[1], 0.0],
        place => [at(first[0] + by) - first[1], start - slope_at(place - 1)],
    };
    let value = |t: &f64| at(t + by) - zero + turn * (t - first[0]);
    Series::new(time.to_vec(), time.iter().map(value).collect::<Vec<_>>())
}

/// Refuses options of a test that do not go together.
fn check_together(map: &Map, outcomes: Option<&Outcomes>) -> HostResult<()> {
    let is_compared = map.contains_key("compare");
    if outcomes.is_some_and(Outcomes::all_broke) && is_compared {
        return Err(refuse(
            "its film broke, and signals beside outcomes are those of film that holds: compare them in a test of their own, with \
            `on_rupture: \"keep\"` or a `window` that ends before",
        ));
    }
    if map.contains_key("noise") && map.get("distance").is_some_and(|given| given.to_string() != "residuals") {
        let why = "it is of the distance \"residuals\", others have an `error`";
        return Err(refuse!("`noise` has no effect here: {why}"));
    }
    let inert: &[&str] = match (outcomes, map.contains_key("pull")) {
        (Some(_), _) if !is_compared => &["recordings", "window", "over", "noise", "distance", "error", "pull"],
        (_, true) => &["compare", "over"],
        _ => &[],
    };
    let Some(key) = inert.iter().find(|key| map.contains_key(**key)) else { return Ok(()) };
    let why = match is_compared || outcomes.is_none() {
        true => "with `pull` stress is compared over strain",
        false => "beside an outcome, signals count where `compare` names them",
    };
    Err(refuse!("`{key}` has no effect here: {why}"))
}

/// `values` over another signal, where that exceeds all before.
fn over_abscissa(abscissa: &Series, values: &Series) -> Series {
    let mut largest = f64::NEG_INFINITY;
    let (mut places, mut found) = (Vec::new(), Vec::new());
    for ([time, place], value) in abscissa.samples().zip(values.values()) {
        let own = if values.time().len() == abscissa.len() { Some(*value) } else { values.value_at(time) };
        if let Some(own) = own.filter(|own| own.is_finite() && place > largest) {
            largest = place;
            places.push(place);
            found.push(own);
        }
    }
    Series::new(places, found)
}

/// The signals that a test is compared by.
fn signals_of(map: &Map, study: &ScenarioHandle) -> HostResult<Vec<&'static Column>> {
    let Some(given) = map.get("compare") else { return Ok(vec![usual_signal(study)]) };
    texts(given, "compare")?.iter().map(|name| found_column(name).map_err(refuse)).collect()
}

/// What a test is compared over; none for time.
fn abscissa_of(map: &Map, study: &ScenarioHandle) -> HostResult<Option<&'static Column>> {
    match map.get("over").map(Dynamic::to_string).as_deref() {
        None => Ok(usual_abscissa(study)),
        Some("time") => Ok(None),
        Some(name) => found_column(name).map(Some).map_err(refuse),
    }
}

/// The signals of a run as a test with these options would compare them, by their names.
pub(super) fn as_recorded(map: &Map, study: &ScenarioHandle, run: &Run) -> HostResult<Map> {
    /// Share of the travel that counts: with other parameters, film may break a little earlier.
    const BEFORE_BREAK: f64 = 0.9;
    let over = abscissa_of(map, study)?;
    let recorded = |column: &'static Column| {
        let values = run.channel(column.short)?;
        let series = match over {
            None => values,
            Some(over) => {
                let all = over_abscissa(&run.channel(over.short)?, &values);
                let end = all.time().last().copied().unwrap_or(0.0);
                all.window([0.0, BEFORE_BREAK * end])
            }
        };
        Ok((column.short.into(), Dynamic::from(series)))
    };
    signals_of(map, study)?.into_iter().map(recorded).collect()
}

/// The signal that a test of this loading is usually compared by.
fn usual_signal(study: &ScenarioHandle) -> &'static Column {
    match &study.model().loading {
        Loading::Impact(_) => &column::ACCELERATION_FILTERED,
        Loading::Stretch(_) | Loading::Indent(_) => &column::FORCE,
        _ => &column::PRESSURE,
    }
}

/// The abscissa of a test of this loading; none for time.
fn usual_abscissa(study: &ScenarioHandle) -> Option<&'static Column> {
    match &study.model().loading {
        Loading::Stretch(_) => Some(&column::DISPLACEMENT),
        Loading::Indent(_) => Some(&column::DEPTH),
        _ => None,
    }
}

/// The column that a script calls `name`.
pub(super) fn found_column(name: &str) -> Result<&'static Column, String> {
    let name = ALIASES.iter().find(|(alias, _)| *alias == name).map_or(name, |(_, own)| *own);
    let found = COLUMNS.iter().find(|column| column.short == name);
    let shorts = || COLUMNS.iter().map(|column| column.short);
    found.ok_or_else(|| match base::diagnostic::did_you_mean(name, shorts()) {
        Some(hint) => format!("there is no signal `{name}` ({hint})"),
        None => format!("there is no signal `{name}`"),
    })
}

/// The noise that an option gives.
pub(super) fn noise(given: &Dynamic) -> HostResult<Noise> {
    let shown = given.clone().into_string().map_or_else(|_| given.to_string(), |text| format!("\"{text}\""));
    let wrong = || refuse!("`noise` is \"from the recordings\" or a share of the signal such as 0.01, not {shown}");
    if let Ok(text) = given.clone().into_string() {
        return if text == "from the recordings" { Ok(Noise::FromRecording) } else { Err(wrong()) };
    }
    let share = number(given, "noise").map_err(|_| wrong())?;
    if share > 0.0 && share < 1.0 { Ok(Noise::Share(share)) } else { Err(wrong()) }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A travel under a constant deceleration is the same again from a later contact with the same speed; from an earlier one on the
    /// impactor first goes on as it came; an acceleration that rises evenly is shifted.
    #[test]
    fn a_later_contact_has_the_closed_form() {
        let time: Vec<f64> = (0..=500).map(|sample| 1e-4 * f64::from(sample)).collect();
        let series =
            |of: &dyn Fn(f64) -> f64| Series::new(time.clone(), time.iter().map(|t| of(*t)).collect::<Vec<_>>());
        let off = |found: &Series, of: &dyn Fn(f64) -> f64| {
            found.samples().map(|[t, value]| (value - of(t)).abs()).fold(0.0, f64::max)
        };
        let travel = |t: f64| -4.0 * t + 50.0 * t * t;
        // Slopes are those of samples: the speed is off by its change within one, over all of the time.
        let bound = 100.0 * 1e-4 * 0.05;
        for by in [2e-3, 5e-4] {
            let found = off(&later(&series(&travel), by, true), &travel);
            assert!(found < bound, "{by}: {found}");
        }
        let expected = |t: f64| -4.0 * t + if t < 1e-3 { 0.0 } else { 50.0 * (t - 1e-3).powi(2) };
        let found = off(&later(&series(&travel), -1e-3, true), &expected);
        assert!(found < bound, "{found}");
        let ramp = |t: f64| 2000.0 * t;
        assert!(off(&later(&series(&ramp), 1e-3, false), &|t| ramp(t + 1e-3)) < 1e-6);
    }
}
