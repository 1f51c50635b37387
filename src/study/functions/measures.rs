//! Measures and ratings of signals, and resampling.

use rhai::{Array, Dynamic, Engine, INT, Map, NativeCallContext};

use crate::script::{Compared, Entry, HostResult, Session, number, refuse};
use lab::signal::clip::{self, Counting};
use lab::signal::{Series, hic, rating, resample};

/// Most samples of a resampled signal.
const MOST_SAMPLES: f64 = 1e6;

pub(super) fn register(engine: &mut Engine) {
    engine
        .register_fn("hic", |s: &mut Series, window: Dynamic| {
            let found = hic::head_injury_criterion(s, seconds(&window, "the window")?);
            found.map(|hic| hic.value).map_err(refuse)
        })
        .register_fn("hic_d", hic_d)
        .register_fn("clip", |s: &mut Series, duration: Dynamic| clip(s, &duration, Counting::Cumulative))
        .register_fn("clip_contiguous", |s: &mut Series, duration: Dynamic| clip(s, &duration, Counting::Contiguous))
        .register_fn("rate", rate)
        .register_fn("resampled", resampled)
        .register_fn("shifted", shifted)
        .register_fn("time", |s: &mut Series| Series::new(s.time().to_vec(), s.time().to_vec()))
        .register_fn("times", |context: NativeCallContext, s: &mut Series| list(&context, s.time()))
        .register_fn("values", |context: NativeCallContext, s: &mut Series| list(&context, s.values()));
}

fn hic_d(s: &mut Series) -> HostResult<f64> {
    hic::head_injury_criterion(s, hic::LONG_WINDOW).map(|hic| hic::dummy_equivalent(hic.value)).map_err(refuse)
}

fn seconds(milliseconds: &Dynamic, what: &str) -> HostResult<f64> {
    Ok(1e-3 * number(milliseconds, what)?)
}

fn clip(s: &Series, duration: &Dynamic, counting: Counting) -> HostResult<f64> {
    let found = clip::clip(s, seconds(duration, "the duration")?, counting);
    found.map(|clip| clip.level).map_err(refuse)
}

fn rate(context: NativeCallContext, reference: Series, comparison: Series) -> HostResult<Map> {
    let rating = rating::rate(&reference, &comparison).map_err(refuse)?;
    let all = [f64::NEG_INFINITY, f64::INFINITY];
    Session::from_context(&context).add_comparison(|| Compared::signals(&comparison, &reference, all));
    let notes: Array = rating.warnings.iter().map(|warning| Dynamic::from(warning.to_string())).collect();
    let entries: [(&str, Dynamic); 9] = [
        ("corridor", rating.corridor.into()),
        ("phase", rating.phase.into()),
        ("magnitude", rating.magnitude.into()),
        ("slope", rating.slope.into()),
        ("overall", rating.overall.into()),
        ("grade", rating.grade.to_string().into()),
        ("shift", rating.shift.into()),
        ("samples", (rating.samples as INT).into()),
        ("notes", notes.into()),
    ];
    Ok(entries.into_iter().map(|(name, value)| (name.into(), value)).collect())
}

fn resampled(s: &mut Series, step: Dynamic) -> HostResult<Series> {
    let step = number(&step, "the time step")?;
    if let [first, .., last] = s.time()
        && step > 0.0
        && (last - first) / step >= MOST_SAMPLES
    {
        return Err(refuse(format!("a time step of {step} s gives more than a million samples")));
    }
    resample::uniform(s, step).map_err(refuse)
}

fn shifted(s: &mut Series, by: Dynamic) -> HostResult<Series> {
    let by = number(&by, "the time shift")?;
    let times: Vec<f64> = s.time().iter().map(|time| time + by).collect();
    let apart = times.windows(2).all(|pair| pair[0] < pair[1]) && times.iter().all(|time| time.is_finite());
    if apart { Ok(Series::new(times, s.values())) } else { Err(refuse(format!("times cannot be shifted by {by} s"))) }
}

/// The numbers as a list within the limit of lists.
fn list(context: &NativeCallContext, numbers: &[f64]) -> HostResult<Array> {
    let (count, most) = (numbers.len(), context.engine().max_array_size());
    if count > most {
        return Err(refuse(format!(
            "the signal has {count} samples, a list holds {most}: take a slice or resample it"
        )));
    }
    Ok(numbers.iter().map(|number| (*number).into()).collect())
}

/// The reference of the functions of this file.
pub const ENTRIES: &[Entry] = &[
    Entry {
        call: "signal.hic(ms)",
        gives: "the head injury criterion of an acceleration (m/s²) over windows of at most that many ms, usually 15 or 36",
        example: "let s = signal([0, 0.05], [490.3325, 490.3325]).resampled(0.001); (s.hic(15) - 265.165).abs() < 0.001",
    },
    Entry {
        call: "signal.hic_d()",
        gives: "HIC(d), the head injury criterion of a free-motion head form as that of a dummy: 0.75446 HIC36 + 166.4 (49 CFR \
                571.201)",
        example: "let s = signal([0, 0.05], [490.3325, 490.3325]).resampled(0.001); (s.hic_d() - (0.75446 * s.hic(36) + 166.4)).abs() < 1e-9",
    },
    Entry {
        call: "signal.clip(ms)",
        gives: "the highest level that is exceeded for that many ms in total, usually 3",
        example: "let s = signal([0, 0.005, 0.01], [0, 100, 0]); (s.clip(3) - 70).abs() < 0.001",
    },
    Entry {
        call: "signal.clip_contiguous(ms)",
        gives: "the highest level that is exceeded for that many ms without interruption",
        example: "let s = signal([0, 0.002, 0.004, 0.006, 0.008], [0, 8, 0, 8, 0]); s.clip_contiguous(2) < s.clip(2)",
    },
    Entry {
        call: "rate(reference, comparison)",
        gives: "the rating of ISO/TS 18571: a map of corridor, phase, magnitude, slope, overall (0 to 1), grade, shift (delay of \
                the comparison, s), samples and notes",
        example: "let s = signal([0, 0.05, 0.1], [0, 1, 0]); let r = rate(s, s); r.overall > 0.999 && r.grade == \"excellent\"",
    },
    Entry {
        call: "signal.resampled(step)",
        gives: "the signal on equal steps (s), linear between samples",
        example: "let s = signal([0, 1, 3], [0, 2, 2]).resampled(0.5); s.len() == 7 && s.at(0.5) == 1.0",
    },
    Entry {
        call: "signal.shifted(dt)",
        gives: "the signal dt seconds later",
        example: "let s = signal([0, 1], [5, 6]).shifted(-0.5); s.start() == -0.5 && s.max() == 6.0",
    },
    Entry {
        call: "signal.times(), signal.values()",
        gives: "the samples as lists, of 10 000 at most; a value that was not measured is NaN",
        example: "let s = signal([0, 1], [5, 6]); s.times() == [0.0, 1.0] && s.values()[1] == 6.0",
    },
    Entry {
        call: "signal.time()",
        gives: "the times of a signal of any length, as a signal",
        example: "let s = signal([0, 2], [5, 6]); s.time().at(1) == 1.0 && s.time().len() == 2",
    },
];
