//! Recordings of National Instruments as TDMS: groups of channels, in segments that follow each other as they were
//! recorded.
//!
//! Source: National Instruments, *TDMS File Format Internal Structure*; what that leaves open (raw data of DAQmx, scales)
//! is read as `npTDMS` does. Little- and big-endian files, interleaved and DAQmx data, chained scales and truncated ends
//! are read; the file of an index (`.tdms_index`) is not needed.

mod objects;
mod segment;
mod value;

use std::fs::File;
use std::io::{self, BufReader, Read, Seek, SeekFrom};
use std::path::Path;

use super::catalogue::{Axis, Catalogue, Entry, Reader};
use super::text::unreadable;
use super::{Annotations, Warning};
use crate::error::Error;
use base::file;
use base::units::{Time, Unit};
use objects::{Index, Object, Objects, Scaler};
use segment::{Run, Segment, Segments};
use value::{Kind, Scales, Timestamp, Value, ends, number, text};

/// The first bytes of a file.
const TAG: &[u8] = b"TDSm";

/// The first bytes of the file of an index.
const INDEX_TAG: &[u8] = b"TDSh";

/// Whether the first bytes are those of a file, or of its index.
pub fn is_own(first: &[u8]) -> bool {
    first.starts_with(TAG) || first.starts_with(INDEX_TAG)
}

/// A TDMS file.
struct Tdms {
    source: BufReader<File>,
    objects: Objects,
    segments: Vec<Segment>,
    /// Object and scales of each channel.
    channels: Vec<(usize, Option<Scales>)>,
}

/// Properties of a channel that have their own use.
const UNITS: [&str; 2] = ["unit_string", "NI_UnitDescription"];
const START: &str = "wf_start_offset";
const INCREMENT: &str = "wf_increment";
const START_TIME: &str = "wf_start_time";
/// Unit of the steps of a waveform; seconds where there is none.
const STEP_UNIT: &str = "wf_xunit_string";

/// Reads everything but the values.
pub fn open(path: &Path) -> Result<Catalogue, Error> {
    let file = file::open(path)?;
    let length = file.metadata().map_err(|error| unreadable(&error))?.len();
    let mut source = BufReader::with_capacity(1 << 16, file);
    let Segments { objects, segments, missing } = Segments::read(&mut source, length)?;
    let mut annotations = Annotations::new(comments(&objects));
    annotations.warnings.extend(missing.map(|missing| Warning::TruncatedFile { missing }));
    let mut tdms = Tdms { source, objects, segments, channels: Vec::new() };
    let entries = tdms.list(&mut annotations.warnings)?;
    Ok(Catalogue::new(entries, annotations, tdms))
}

impl Tdms {
    /// Lists the channels.
    fn list(&mut self, warnings: &mut Vec<Warning>) -> Result<Vec<Entry>, Error> {
        let mut found: Vec<Found> = vec![Found::default(); self.objects.all.len()];
        for segment in &self.segments {
            for (place, (object, index)) in segment.list.members.iter().enumerate() {
                let Some(index) = index else { continue };
                let runs = segment.list.chunks.runs(&segment.span, &segment.list.members, place, None)?;
                let found = &mut found[*object];
                found.samples = found.samples.saturating_add(runs.count());
                let not_real = index.kind.not_real().or_else(|| not_one(index));
                found.not_real = found.not_real.or(not_real);
                found.is_time |= index.kind == Kind::Timestamp;
            }
        }
        let mut first_start: Option<(String, Timestamp)> = None;
        let mut entries = Vec::new();
        for (place, object) in self.objects.all.iter().enumerate() {
            let [group, name] = &object.names[..] else { continue };
            let unit = UNITS.iter().find_map(|name| text(&object.properties, name).filter(|unit| !unit.is_empty()));
            let mut entry = Entry::new(group, name, unit)?;
            entry.samples = Some(found[place].samples);
            if found[place].is_time && entry.column.unit.is_none() {
                entry.column.unit = Unit::parse("s").ok();
            }
            let mut not_over_time = None;
            if let Some(step) = number(&object.properties, INCREMENT) {
                let start = number(&object.properties, START).unwrap_or(0.0);
                match seconds(text(&object.properties, STEP_UNIT)) {
                    Ok(factor) => entry.axis = Axis::Steps { start: start * factor, step: step * factor },
                    Err(why) => not_over_time = Some(why),
                }
            }
            if let (Some(Value::Time(start)), Axis::Steps { .. }) = (object.properties.get(START_TIME), &entry.axis) {
                let (first, earliest) = first_start.get_or_insert_with(|| (entry.label().to_owned(), *start));
                let apart = start.since(*earliest);
                let is_told = warnings.iter().any(|w| matches!(w, Warning::StartTimesDiffer { .. }));
                if apart != 0.0 && !is_told {
                    let (first, other) = (first.clone(), entry.label().to_owned());
                    warnings.push(Warning::StartTimesDiffer { first, other, apart });
                }
            }
            let scales = self.scales(object);
            entry.unread = match (found[place].not_real, &scales) {
                _ if not_over_time.is_some() => not_over_time,
                (Some(what), _) => Some(format!("it holds {what}")),
                (None, Err(why)) => Some(why.clone()),
                (None, Ok(scales)) => self.unscaled(place, scales.as_ref()),
            };
            entries.push(entry);
            self.channels.push((place, scales.ok().flatten()));
        }
        Ok(entries)
    }

    /// The scales of a channel: its own, those of its group or those of the file.
    fn scales(&self, object: &Object) -> Result<Option<Scales>, String> {
        for depth in (0..=object.names.len()).rev() {
            let names: Vec<&str> = object.names[..depth].iter().map(String::as_str).collect();
            let Some(owner) = self.objects.find(&names) else { continue };
            if let Some(scales) = Scales::read(&owner.properties)? {
                return Ok(Some(scales));
            }
        }
        Ok(None)
    }

    /// Why the data of a channel are not those that its scales need.
    fn unscaled(&self, object: usize, scales: Option<&Scales>) -> Option<String> {
        let mut indices = self.segments.iter().filter_map(|segment| {
            segment.list.places.get(&object).and_then(|place| segment.list.members[*place].1.as_deref())
        });
        let index = indices.next()?;
        let ids: Vec<u32> = index.daqmx.iter().flat_map(|daqmx| &daqmx.scalers).map(|scaler| scaler.id).collect();
        let scaler = scales.and_then(|scales| scales.scaler);
        let missing = scaler.filter(|id| !ids.contains(id));
        if let Some(scale) = missing {
            return Some(format!("scale {scale} has no kind, and its data no scaler of this number"));
        }
        (scaler.is_none() && ids.len() > 1)
            .then(|| format!("its data have {} scalers and no scale for them", ids.len()))
    }

    /// What one scaler of a channel gives, or what is stored where it has none.
    fn stored(&mut self, object: usize, id: Option<u32>) -> Result<Vec<f64>, Error> {
        let mut values = Vec::new();
        let mut start = None;
        for segment in &self.segments {
            let list = &segment.list;
            let Some(place) = list.places.get(&object) else { continue };
            let Some(index) = list.members[*place].1.as_deref() else { continue };
            let scaler = scaler(index, id);
            let kind = scaler.map_or(index.kind, |scaler| scaler.kind);
            let (Some(width), is_big) = (kind.width(), segment.span.is_big) else { continue };
            let runs = list.chunks.runs(&segment.span, &list.members, *place, scaler)?;
            values.reserve(usize::try_from(runs.count()).unwrap_or(0));
            let bit = scaler.and_then(|scaler| scaler.bit);
            for run in runs.iter() {
                read_values(&mut self.source, run, width, |bytes| {
                    let value = kind.number(bytes, is_big).or_else(|| {
                        let time = Timestamp::from_bytes(bytes, is_big)?;
                        Some(time.since(*start.get_or_insert(time)))
                    });
                    let value = value.unwrap_or(f64::NAN);
                    values.push(bit.map_or(value, |bit| f64::from((value as i64 >> bit) as u8 & 1)));
                })?;
            }
        }
        Ok(values)
    }
}

impl Reader for Tdms {
    fn values(&mut self, place: usize) -> Result<Vec<f64>, Error> {
        let (object, scales) = self.channels[place].clone();
        let mut values = self.stored(object, scales.as_ref().and_then(|scales| scales.scaler))?;
        if let Some(scales) = scales {
            values.iter_mut().for_each(|value| *value = scales.apply(*value));
        }
        Ok(values)
    }
}

/// What the segments say about an object.
#[derive(Clone, Debug, Default)]
struct Found {
    samples: u64,
    not_real: Option<&'static str>,
    is_time: bool,
}

/// What a description of DAQmx without scalers holds.
fn not_one(index: &Index) -> Option<&'static str> {
    index.daqmx.as_ref().filter(|daqmx| daqmx.scalers.is_empty()).map(|_| "data of DAQmx without a scaler")
}

/// Seconds in the unit of the steps of a waveform.
fn seconds(unit: Option<&str>) -> Result<f64, String> {
    let Some(symbol) = unit.map(str::trim).filter(|unit| !unit.is_empty()) else { return Ok(1.0) };
    let known = Unit::parse(symbol).ok().filter(|unit| unit.measures(Time::DIMENSION));
    known.map(|unit| unit.to_si(1.0)).ok_or_else(|| format!("its steps are in `{symbol}`, which is no time"))
}

/// The scaler with this number, or the first.
fn scaler(index: &Index, id: Option<u32>) -> Option<&Scaler> {
    let scalers = &index.daqmx.as_ref()?.scalers;
    id.and_then(|id| scalers.iter().find(|scaler| scaler.id == id)).or(scalers.first())
}

/// The texts and times among the properties of the file itself.
fn comments(objects: &Objects) -> Vec<String> {
    let properties = objects.find(&[]).into_iter().flat_map(|file| &file.properties);
    let comment = |(name, value): (&String, &Value)| {
        let value = match value {
            Value::Text(text) if !text.trim().is_empty() => text.trim().to_owned(),
            Value::Time(time) => time.date(),
            _ => return None,
        };
        let is_own = name.starts_with("NI_");
        (!is_own).then(|| Annotations::value_comment(name, value))
    };
    properties.filter_map(comment).collect()
}

/// Bytes that are read at once.
const BLOCK: u64 = 1 << 18;

/// Gives every value of `run`, of `width` bytes, to `push`.
fn read_values(file: &mut BufReader<File>, run: Run, width: usize, mut push: impl FnMut(&[u8])) -> Result<(), Error> {
    let stride = run.stride.max(1);
    // Of rows much longer than their value, the value alone is read.
    let rows = if stride > BLOCK / 4 { 1 } else { BLOCK / stride };
    let mut bytes = Vec::new();
    let mut done = 0;
    while done < run.count {
        let at = run.at.saturating_add(done.saturating_mul(stride));
        let now = rows.min(run.count - done);
        // Behind the last value of a block, its row is not needed.
        let length = (now - 1) * stride + width as u64;
        bytes.clear();
        read_at(file, at, length, &mut bytes).map_err(|error| unreadable(&error))?;
        for row in 0..now {
            let start = (row * stride) as usize;
            let Some(value) = bytes.get(start..start + width) else {
                return Err(ends(at, "the values of a channel"));
            };
            push(value);
        }
        done += now;
    }
    Ok(())
}

/// Reads up to `length` bytes from the place `at` on.
fn read_at(file: &mut BufReader<File>, at: u64, length: u64, bytes: &mut Vec<u8>) -> io::Result<usize> {
    let here = file.stream_position()?;
    file.seek_relative(at.wrapping_sub(here) as i64).or_else(|_| file.seek(SeekFrom::Start(at)).map(drop))?;
    file.by_ref().take(length).read_to_end(bytes)
}
