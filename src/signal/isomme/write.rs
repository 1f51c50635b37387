//! Writing a whole container.

use std::collections::BTreeSet;
use std::fs;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use thiserror::Error;

use super::ChannelCode;
use crate::diagnostic::folder_of;
use crate::signal::csv::clean_time;
use crate::signal::{Measured, Measurement, Series, resample};
use crate::units::Time;

/// Why a container was not written.
#[derive(Debug, Error)]
pub enum WriteError {
    #[error("{} has no name to call the files by", path.display())]
    NoName { path: PathBuf },
    #[error("{} is there already", path.display())]
    Exists { path: PathBuf },
    #[error("cannot write {}: {source}", path.display())]
    Write { path: PathBuf, source: io::Error },
    #[error("`{name}` has no samples")]
    Empty { name: String },
    #[error("{count} channels, more than the {MOST_CHANNELS} that can be counted")]
    TooMany { count: usize },
}

/// Most channels: their numbers and those of their time axes have four digits.
const MOST_CHANNELS: usize = 4_999;

/// Width of the keys.
const KEY: usize = 28;

/// Writes `measurement` as the test at `path` (`<test>.mme`) with its folder `Channel`, in SI units.
///
/// The files are laid down under other names and renamed when they are whole, the test last: without it there is no
/// container. Numbers are in the shortest form that reads back to the same bits. The time is implicit where its steps are
/// equal, or else a channel of its own. Channels keep their names where those are codes; others get a code that counts.
///
/// # Errors
/// Nothing that exists is replaced.
pub fn write(path: &Path, measurement: &Measurement) -> Result<(), WriteError> {
    let stem = path.file_stem().filter(|stem| !stem.is_empty());
    let stem = stem.ok_or_else(|| WriteError::NoName { path: path.into() })?.to_string_lossy();
    if let Some(channel) = measurement.channels.iter().find(|channel| channel.series.is_empty()) {
        return Err(WriteError::Empty { name: channel.name.clone() });
    }
    let count = measurement.channels.len();
    if count > MOST_CHANNELS {
        return Err(WriteError::TooMany { count });
    }
    let folder = folder_of(path);
    let channels = folder.join("Channel");
    for place in [path, &channels] {
        if place.exists() {
            return Err(WriteError::Exists { path: place.into() });
        }
    }
    lay_down(path, folder, &channels, &stem, &sheets(measurement), &measurement.notes)
        .map_err(|source| WriteError::Write { path: path.into(), source })
}

fn lay_down(
    path: &Path,
    folder: &Path,
    channels: &Path,
    stem: &str,
    sheets: &[Sheet],
    notes: &[String],
) -> io::Result<()> {
    fs::create_dir_all(folder)?;
    let draft = tempfile::Builder::new().prefix(".isomme-").tempdir_in(folder)?;
    let inner = draft.path().join("Channel");
    fs::create_dir(&inner)?;
    let file = |path: PathBuf| fs::File::create_new(path).map(BufWriter::new);
    for (number, sheet) in (1..).zip(sheets) {
        sheet.write(file(inner.join(format!("{stem}.{number:03}")))?)?;
    }
    write_list(file(inner.join(format!("{stem}.chn")))?, sheets)?;
    let test = draft.path().join("test.mme");
    write_test(file(test.clone())?, stem, notes)?;
    fs::rename(&inner, channels)?;
    fs::rename(&test, path).inspect_err(|_| {
        // What is left without its test is no container; that it cannot be removed either adds nothing.
        let _ = fs::remove_dir_all(channels);
    })
}

/// One channel file.
struct Sheet<'a> {
    code: ChannelCode,
    label: String,
    unit: Option<String>,
    class: Option<f64>,
    axis: Axis,
    time: &'a [f64],
    values: &'a [f64],
}

/// Where the times of a channel are.
enum Axis {
    /// First sample and interval, s.
    Implicit([f64; 2]),
    Explicit(ChannelCode),
    /// The channel is a time axis.
    Itself,
}

/// The channels, and the time axes of those whose steps differ, each once and before its first channel.
fn sheets(measurement: &Measurement) -> Vec<Sheet<'_>> {
    let codes = codes(&measurement.channels);
    let (mut sheets, mut axes): (Vec<Sheet>, Vec<(&[f64], ChannelCode)>) = (Vec::new(), Vec::new());
    for (channel, code) in measurement.channels.iter().zip(codes) {
        let time = channel.series.time();
        let axis = match even(time) {
            Some(even) => Axis::Implicit(even),
            None => {
                let known = axes.iter().find(|(axis, _)| *axis == time).map(|(_, code)| code.clone());
                Axis::Explicit(known.unwrap_or_else(|| {
                    let sheet = time_sheet(time, axes.len() + 1);
                    let code = sheet.code.clone();
                    sheets.push(sheet);
                    axes.push((time, code.clone()));
                    code
                }))
            }
        };
        let (label, unit, class) = (channel.label.clone(), channel.value_unit(), channel.filtered);
        sheets.push(Sheet { code, label, unit, class, axis, time, values: channel.series.values() });
    }
    sheets
}

fn time_sheet(time: &[f64], number: usize) -> Sheet<'_> {
    let unit = Some(Time::DIMENSION.unit.to_owned());
    let code = ChannelCode::time_axis(number);
    Sheet { code, label: "time".into(), unit, class: None, axis: Axis::Itself, time, values: time }
}

/// The names of the channels where they are codes, each once; codes that count for the others.
fn codes(channels: &[Measured]) -> Vec<ChannelCode> {
    let own = |channel: &Measured| ChannelCode::parse(&channel.name).filter(|code| !code.is_time());
    let mut taken: BTreeSet<String> = channels.iter().filter_map(own).map(|code| code.to_string()).collect();
    let mut kept = BTreeSet::new();
    let mut code = |(number, channel): (usize, &Measured)| {
        if let Some(code) = own(channel).filter(|code| kept.insert(code.to_string())) {
            return code;
        }
        let mut number = number;
        loop {
            let code = ChannelCode::counted(number, channel.unit.as_ref(), channel.filtered);
            if taken.insert(code.to_string()) {
                return code;
            }
            number += 1;
        }
    };
    (1..).zip(channels).map(&mut code).collect()
}

/// First sample and interval, if the times are `first + i·interval` to a millionth of the interval.
fn even(time: &[f64]) -> Option<[f64; 2]> {
    let first = *time.first()?;
    let interval = clean_time(resample::common_step(time)?);
    let close = |(sample, at): (usize, &f64)| (first + sample as f64 * interval - at).abs() <= 1e-6 * interval;
    time.iter().enumerate().all(close).then_some([first, interval])
}

impl Sheet<'_> {
    fn write(&self, mut out: impl Write) -> io::Result<()> {
        let code = self.code.to_string();
        pair(&mut out, "Channel code", &code)?;
        pair(&mut out, "Name of the channel", &self.label)?;
        match &self.axis {
            Axis::Implicit([first, interval]) => {
                pair(&mut out, "Reference channel", "implicit")?;
                pair(&mut out, "Reference channel name", NOTHING)?;
                pair(&mut out, "Time of first sample", &number(*first))?;
                pair(&mut out, "Sampling interval", &number(*interval))?;
            }
            Axis::Explicit(axis) => {
                pair(&mut out, "Reference channel", "explicit")?;
                pair(&mut out, "Reference channel name", &axis.to_string())?;
            }
            Axis::Itself => {}
        }
        pair(&mut out, "Dimension", self.code.dimension())?;
        pair(&mut out, "Direction", self.code.direction())?;
        let class = self.class.map(|class| class.to_string());
        pair(&mut out, "Channel frequency class", class.as_deref().unwrap_or(NOTHING))?;
        pair(&mut out, "Unit", self.unit.as_deref().unwrap_or(NOTHING))?;
        pair(&mut out, "Number of samples", &self.values.len().to_string())?;
        self.write_extremes(&mut out)?;
        pair(&mut out, "Data status", "ok")?;
        for value in self.values {
            write!(out, "{}\r\n", number(*value))?;
        }
        out.flush()
    }

    /// A reader's free check.
    fn write_extremes(&self, out: &mut impl Write) -> io::Result<()> {
        let series = Series::new(self.time, self.values);
        for (word, extreme) in [("maximum", series.largest()), ("minimum", series.smallest())] {
            let [time, value] = extreme.map_or([f64::NAN; 2], |extreme| extreme);
            pair(out, &format!("First global {word} value"), &number(value))?;
            pair(out, &format!("Time of {word} value"), &number(time))?;
        }
        Ok(())
    }
}

const NOTHING: &str = "NOVALUE";

fn write_test(mut out: impl Write, stem: &str, notes: &[String]) -> io::Result<()> {
    pair(&mut out, "Data format edition number", "1.6")?;
    for key in ["Laboratory name", "Customer name", "Test date", "Type of the test"] {
        pair(&mut out, key, NOTHING)?;
    }
    pair(&mut out, "Test number", stem)?;
    notes.iter().try_for_each(|note| pair(&mut out, "Comments", note))?;
    out.flush()
}

fn write_list(mut out: impl Write, sheets: &[Sheet]) -> io::Result<()> {
    pair(&mut out, "Instrumentation standard", NOTHING)?;
    pair(&mut out, "Number of channels", &sheets.len().to_string())?;
    for (number, sheet) in (1..).zip(sheets) {
        let (key, name) = (format!("Name of channel {number:03}"), format!("{} / {}", sheet.code, sheet.label));
        pair(&mut out, &key, &name)?;
    }
    out.flush()
}

/// A line of a header; what would end the line is a blank.
fn pair(out: &mut impl Write, key: &str, value: &str) -> io::Result<()> {
    write!(out, "{key:KEY$}:{}\r\n", value.replace(char::is_control, " "))
}

fn number(value: f64) -> String {
    if value.is_finite() { format!("{value:E}") } else { NOTHING.into() }
}
