//! Time histories of OpenRadioss (`filmT01`, and `film_0001.thy` where `/TH/VERS` asks for a format with units): the motion of nodes, energies, impulses of rigid bodies.
//!
//! Source: OpenRadioss, `engine/source/output/th/hist1.F` and `hist2.F`, which write them.
//!
//! A time history: a sequence of records, each between two copies of its length in bytes; numbers are big-endian, whole ones and reals
//! of four bytes. The head lists parts, materials, properties, subsets and groups of output; after it every instant is a record of its
//! time and records of values.

use std::ops::Range;
use std::path::Path;

use super::catalogue::{Axis, Catalogue, Entry, Reader};
use super::{Annotations, Warning};
use crate::error::{Error, refusal};
use base::file;

/// The channel of the times of a test.
const OWN_TIME: &str = "test time";

/// What stands between the title of a group of nodes and the time (s) at which the test of a deck of droptower begins.
const MARK: &str = "; test from ";

/// Most bytes of a file.
const MOST_BYTES: u64 = 1 << 30;

const NO_INSTANT: &str = "the file ends before its first instant";

/// A unit as powers of the file's mass, length and time, and its symbol in SI.
type Measure = ([i32; 3], &'static str);

const LENGTH: Measure = ([0, 1, 0], "m");
const VELOCITY: Measure = ([0, 1, -1], "m/s");
const ACCELERATION: Measure = ([0, 1, -2], "m/s2");
const ENERGY: Measure = ([1, 2, -2], "J");
const MASS: Measure = ([1, 0, 0], "kg");
const TIME: Measure = ([0, 0, 1], "s");
const IMPULSE: Measure = ([1, 1, -1], "N s");
const ANGULAR_VELOCITY: Measure = ([0, 0, -1], "rad/s");
const ANGULAR_ACCELERATION: Measure = ([0, 0, -2], "rad/s2");

/// Values that follow each other in the order of their numbers: their measure, and their names between commas.
type Values = [(Measure, &'static str)];

/// Values of the whole model.
const GLOBAL: &Values = &[
    (ENERGY, "internal energy, kinetic energy"),
    (IMPULSE, "momentum x, momentum y, momentum z"),
    (MASS, "mass"),
    (TIME, "time step"),
    (ENERGY, "rotational energy, external work, spring energy, contact energy, hourglass energy"),
    (ENERGY, "elastic contact energy, friction contact energy, damping contact energy, plastic work"),
    (MASS, "added mass"),
    (([0, 0, 0], "-"), "added mass share"),
    (MASS, "inlet mass, outlet mass"),
    (ENERGY, "inlet energy, outlet energy"),
];

/// Kinds of groups that are read, and their values by number: of nodes, and of rigid bodies, whose forces are summed over time.
const NODES: i32 = 0;
const RIGID: i32 = 103;
const OF_NODES: &Values = &[
    (LENGTH, "DX, DY, DZ"),
    (VELOCITY, "VX, VY, VZ"),
    (ACCELERATION, "AX, AY, AZ"),
    (ANGULAR_VELOCITY, "VRX, VRY, VRZ"),
    (ANGULAR_ACCELERATION, "ARX, ARY, ARZ"),
    (LENGTH, "X, Y, Z"),
];
/// Reactions at nodes that are fixed or moved, summed over time, and the number of the first.
const OF_REACTION: &Values = &[(IMPULSE, "REACX, REACY, REACZ")];
const FIRST_REACTION: i32 = 620;
const OF_RIGID: &Values = &[(IMPULSE, "impulse FX, impulse FY, impulse FZ")];

/// Name and measure of the value at a place, from zero.
fn value(values: &Values, place: usize) -> Option<(&'static str, Measure)> {
    values.iter().flat_map(|(measure, names)| names.split(", ").map(|name| (name, *measure))).nth(place)
}

/// Values along z of a node whose motion is that of a test, as droptower calls them.
const OF_TEST: [(i32, &str); 3] = [(3, "displacement_m"), (6, "velocity_m_s"), (9, "acceleration_m_s2")];

/// A time history.
struct T01 {
    bytes: Vec<u8>,
    channels: Vec<Channel>,
    /// First byte of the instants, bytes of one, and how many there are.
    instants: (usize, usize, usize),
}

/// Where the values of a channel are.
struct Channel {
    /// Byte of an instant.
    place: usize,
    /// Of the unit.
    factor: f64,
    /// First instant that it has.
    from: usize,
    /// What is taken from its values.
    less: f64,
}

/// Reads the head, and counts the instants.
pub fn open(path: &Path) -> Result<Catalogue, Error> {
    let bytes = file::read(path, MOST_BYTES)?;
    let mut records = Records { bytes: &bytes, at: 0 };
    let head = Head::read(&mut records)?;
    let first = records.at;
    let lengths: Vec<usize> = std::iter::once(4).chain(head.lengths.iter().copied()).collect();
    let step: usize = lengths.iter().map(|length| length + 8).sum();
    let count = (bytes.len() - first) / step;
    for _ in 0..count {
        for length in &lengths {
            records.of_length("a record of values", *length)?;
        }
    }
    let mut annotations = Annotations::new(vec![format!("{COMPUTED}, nothing fell"), format!("title: {}", head.title)]);
    let rest = (bytes.len() - first) % step;
    let missing = (rest > 0).then(|| Warning::TruncatedFile { missing: (step - rest) as u64 });
    annotations.warnings.extend(missing);
    if count == 0 {
        return Err(Error::new(NO_INSTANT));
    }
    let mut entries: Vec<Entry> = Vec::new();
    let mut file = T01 { channels: vec![], instants: (first, step, count), bytes };
    let time = file.push(&mut entries, "", "time", Ok(TIME), 4, head.units)?;
    // Names of the signals of a test say that they are SI.
    let are_si = head.units.is_some();
    for value in head.values.into_iter().filter(|value| are_si || value.test.is_none()) {
        let unit =
            value.measure.map_err(|number| format!("a value of the number {number}, whose meaning is not known here"));
        let Some(begin) = value.test else {
            let entry = file.push(&mut entries, &value.group, &value.name, unit, value.place, head.units)?;
            entries[entry].axis = Axis::Channel(time);
            continue;
        };
        // Signals of the test are over its own time, a displacement from where it begins.
        let known = entries.iter().position(|entry| entry.group == value.group && entry.column.name == OWN_TIME);
        let of_time = match known {
            Some(of_time) => of_time,
            None => file.push(&mut entries, &value.group, OWN_TIME, Ok(TIME), 4, head.units)?,
        };
        let from = file.values(time)?.iter().position(|time| *time >= begin - 1e-9).unwrap_or(count);
        file.channels[of_time].less = begin;
        let entry = file.push(&mut entries, &value.group, &value.name, unit, value.place, head.units)?;
        if value.name == OF_TEST[0].1 {
            file.channels[entry].less = file.values(entry)?.get(from).copied().unwrap_or_default();
        }
        for place in [of_time, entry] {
            file.channels[place].from = from;
            entries[place].samples = Some((count - from) as u64);
        }
        entries[entry].axis = Axis::Channel(of_time);
    }
    Ok(Catalogue::new(entries, annotations, file))
}

impl T01 {
    /// Adds a channel; its place in the list.
    fn push(
        &mut self,
        entries: &mut Vec<Entry>,
        group: &str,
        name: &str,
        measure: Result<Measure, String>,
        place: usize,
        units: Option<[f64; 3]>,
    ) -> Result<usize, Error> {
        let (powers, symbol) = measure.clone().unwrap_or_default();
        let mut entry = Entry::new(group, name, units.map(|_| symbol))?;
        entry.samples = Some(self.instants.2 as u64);
        entry.unread = measure.err();
        let factor = units.unwrap_or([1.0; 3]).iter().zip(powers).map(|(unit, power)| unit.powi(power)).product();
        entries.push(entry);
        self.channels.push(Channel { place, factor, from: 0, less: 0.0 });
        Ok(entries.len() - 1)
    }
}

impl Reader for T01 {
    fn values(&mut self, place: usize) -> Result<Vec<f64>, Error> {
        let (first, step, count) = self.instants;
        let channel = &self.channels[place];
        let value = |instant: usize| {
            let at = first + instant * step + channel.place;
            let bytes = self.bytes.get(at..at + 4).and_then(|bytes| bytes.try_into().ok()).unwrap_or_default();
            f64::from(f32::from_be_bytes(bytes)) * channel.factor - channel.less
        };
        Ok((channel.from..count).map(value).collect())
    }
}

/// A value of every instant.
struct Value {
    group: String,
    name: String,
    /// Its unit, or its number where that says nothing here.
    measure: Result<Measure, i32>,
    /// Byte of an instant.
    place: usize,
    /// When the test begins whose motion it is, s.
    test: Option<f64>,
}

/// What the head says.
struct Head {
    title: String,
    /// Mass, length and time of the file, in SI; none before version 3050, unless `/TH/VERS` asks for a later one.
    units: Option<[f64; 3]>,
    /// Bytes of the records of an instant, but that of its time.
    lengths: Vec<usize>,
    values: Vec<Value>,
}

impl Head {
    /// In one piece since the head has no table of contents: where a value lies in an instant follows from the lengths of all
    /// that stands before it.
    fn read(records: &mut Records<'_>) -> Result<Head, Error> {
        let mut first = records.of_length("the title", 84)?;
        let version = first.whole();
        let title = first.text(80);
        records.of_length("the date", 80)?;
        let (mut title_length, mut units) = (if version >= 3041 { 80 } else { 40 }, None);
        if version >= 3050 {
            let count = records.of_length("the number of records", 4)?.count("records")?;
            title_length = records.of_length("the length of titles", 4)?.count("characters")?;
            let mut factors = records.of_length("the units", 12)?;
            // A millimetre has seven digits in the file and is meant as 0.001.
            let found = [0; 3].map(|_| f32::from_bits(factors.whole() as u32).to_string().parse().unwrap_or(f64::NAN));
            units = Some(found);
            if !found.iter().all(|unit| unit.is_finite() && *unit > 0.0) {
                let at = records.at;
                return Err(refusal!("byte {at}: the units of the file are no positive multiples of SI units"));
            }
            for _ in 2..count {
                records.next("a record of the head")?;
            }
        }
        let mut counts = records.of_length("the numbers of parts and groups", 24)?;
        let [parts, materials, properties, subsets, groups, global] = [
            counts.count("parts")?,
            counts.count("materials")?,
            counts.count("properties")?,
            counts.count("subsets")?,
            counts.count("groups")?,
            counts.count("values of the model")?,
        ];
        let mut head = Head { title, units, lengths: vec![], values: vec![] };
        let mut place = 12;
        if global > 0 {
            records.of_length("the values of the model", 4 * global)?;
            for number in 0..global {
                let known = value(GLOBAL, number);
                let name = known.map_or_else(|| format!("value {}", number + 1), |(name, _)| name.to_owned());
                let measure = known.map(|(_, measure)| measure).ok_or(number as i32 + 1);
                head.values.push(Value {
                    group: String::new(),
                    name,
                    measure,
                    place: place + 4 + 4 * number,
                    test: None,
                });
            }
            place += head.add(global);
        }
        // Energies and momenta of parts and subsets are those of the model, divided.
        let mut of_parts = 0;
        for _ in 0..parts {
            let mut part = records.of_length("a part", 20 + title_length)?;
            part.skip(4 + title_length + 12);
            let count = part.count("values of a part")?;
            records.list("the values of a part", count)?;
            of_parts += count;
        }
        place += head.add(of_parts);
        for _ in 0..materials.saturating_add(properties) {
            records.of_length("a material or a property", 4 + title_length)?;
        }
        let mut of_subsets = 0;
        for _ in 0..subsets {
            let mut subset = records.of_length("a subset", 20 + title_length)?;
            subset.skip(8);
            for what in ["subsets of a subset", "parts of a subset", "values of a subset"] {
                let count = subset.count(what)?;
                records.list(what, count)?;
                of_subsets += if what == "values of a subset" { count } else { 0 };
            }
        }
        place += head.add(of_subsets);
        for _ in 0..groups {
            let mut group = records.of_length("a group", 20 + title_length)?;
            group.skip(4);
            let kind = group.whole();
            group.skip(4);
            let (members, count) = (group.count("members")?, group.count("values of a member")?);
            let title = group.text(title_length);
            let mut names = vec![];
            for _ in 0..members {
                let mut member = records.of_length("a member of a group", 4 + title_length)?;
                let number = member.whole();
                names.push(number);
            }
            let numbers = records.list("the values of a group", count)?;
            // Its values are listed only where the file has bytes for one instant of them.
            if members.saturating_mul(count).saturating_mul(4).saturating_add(place) > records.left() {
                return Err(Error::new(NO_INSTANT));
            }
            head.group(kind, &title, &names, &numbers, place + 4);
            place += head.add(members.saturating_mul(count));
        }
        // The signals of one impactor have plain names, as in tables.
        let mut tests: Vec<&mut Value> = head.values.iter_mut().filter(|value| value.test.is_some()).collect();
        if tests.windows(2).all(|two| two[0].group == two[1].group) {
            tests.iter_mut().for_each(|value| value.group.clear());
        }
        Ok(head)
    }

    /// Adds a record of so many values to an instant, if there are any; its bytes.
    fn add(&mut self, values: usize) -> usize {
        if values == 0 {
            return 0;
        }
        self.lengths.push(4 * values);
        4 * values + 8
    }

    /// Adds the values of a group, whose first is at a byte of an instant.
    fn group(&mut self, kind: i32, title: &str, members: &[i32], numbers: &[i32], first: usize) {
        let (title, test) = match title.split_once(MARK).map(|(name, rest)| (name, rest.trim_end_matches(" s").parse()))
        {
            Some((name, Ok(begin))) if kind == NODES && members.len() == 1 => (name, Some(begin)),
            _ => (title, None),
        };
        let known = match kind {
            NODES => OF_NODES,
            RIGID => OF_RIGID,
            _ => &[],
        };
        for (row, member) in members.iter().enumerate() {
            let group = if members.len() == 1 { title.to_owned() } else { format!("{title}/{member}") };
            for (column, number) in numbers.iter().enumerate() {
                let place = first + 4 * (row * numbers.len() + column);
                let (known, from) = match kind {
                    NODES if *number >= FIRST_REACTION => (OF_REACTION, FIRST_REACTION),
                    _ => (known, 1),
                };
                let found = usize::try_from(*number - from).ok().and_then(|place| value(known, place));
                let name = found.map_or_else(|| format!("value {number}"), |(name, _)| name.to_owned());
                let measure = found.map(|(_, measure)| measure).ok_or(*number);
                let of_test = OF_TEST.iter().find(|(of, _)| of == number).filter(|_| test.is_some());
                if let Some((_, name)) = of_test {
                    self.values.push(Value { group: group.clone(), name: (*name).to_owned(), measure, place, test });
                }
                self.values.push(Value { group: group.clone(), name, measure, place, test: None });
            }
        }
    }
}

/// The records of a file.
struct Records<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Records<'a> {
    /// Bytes behind the last record.
    fn left(&self) -> usize {
        self.bytes.len() - self.at
    }

    /// The next record.
    fn next(&mut self, what: &'static str) -> Result<Record<'a>, Error> {
        let ends = || refusal!("byte {}: the file ends within {what}", self.at);
        let length = |at: usize| {
            let bytes: [u8; 4] = self.bytes.get(at..at.checked_add(4)?)?.try_into().ok()?;
            Some(u32::from_be_bytes(bytes) as usize)
        };
        let expected = length(self.at).ok_or_else(ends)?;
        let content = self.at + 4..(self.at + 4).saturating_add(expected);
        let found = length(content.end).ok_or_else(ends)?;
        if found != expected {
            return Err(other_length(self.at, what, found, expected));
        }
        self.at = content.end + 4;
        Ok(Record { bytes: self.bytes, rest: content })
    }

    /// The next record, of so many bytes.
    fn of_length(&mut self, what: &'static str, expected: usize) -> Result<Record<'a>, Error> {
        let at = self.at;
        let record = self.next(what)?;
        match record.rest.len() {
            found if found == expected => Ok(record),
            found => Err(other_length(at, what, found, expected)),
        }
    }

    /// So many whole numbers, in a record of their own where there are any.
    fn list(&mut self, what: &'static str, count: usize) -> Result<Vec<i32>, Error> {
        if count == 0 {
            return Ok(vec![]);
        }
        let mut record = self.of_length(what, count.saturating_mul(4))?;
        Ok((0..count).map(|_| record.whole()).collect())
    }
}

/// The fault of a record at a byte that is not as long as it must be, or does not end with its length.
fn other_length(at: usize, what: &str, found: usize, expected: usize) -> Error {
    refusal!("byte {at}: {what} has {found} bytes, expected {expected}")
}

/// A record, of whose length there is no doubt.
struct Record<'a> {
    bytes: &'a [u8],
    rest: Range<usize>,
}

impl Record<'_> {
    fn skip(&mut self, bytes: usize) {
        self.rest.start = (self.rest.start + bytes).min(self.rest.end);
    }

    fn whole(&mut self) -> i32 {
        let bytes = self.bytes.get(self.rest.start..self.rest.start + 4).and_then(|bytes| bytes.try_into().ok());
        self.skip(4);
        i32::from_be_bytes(bytes.unwrap_or_default())
    }

    /// A number that counts something.
    fn count(&mut self, what: &'static str) -> Result<usize, Error> {
        let at = self.rest.start;
        let found = self.whole();
        usize::try_from(found).map_err(|_| refusal!("byte {at}: {found} is no number of {what}"))
    }

    fn text(&mut self, length: usize) -> String {
        let end = (self.rest.start + length).min(self.rest.end);
        let text = String::from_utf8_lossy(&self.bytes[self.rest.start..end]).trim().replace(char::is_control, " ");
        self.skip(length);
        text
    }
}

/// Whether the first bytes are those of a file: a record of a number and 80 characters, and one of 80 characters.
pub fn is_own(first: &[u8]) -> bool {
    let at = |place: usize| first.get(place..place + 4).and_then(|bytes| bytes.try_into().ok()).map(u32::from_be_bytes);
    at(0) == Some(84) && at(88) == Some(84) && at(92) == Some(80)
}

/// The comment by which a motion is known as computed, here and in tables.
pub const COMPUTED: &str = "VIRTUAL: computed by OpenRadioss";

#[cfg(test)]
mod tests {
    use super::*;

    /// A group of a thousand members with a thousand values each, and no instant.
    #[test]
    fn values_without_an_instant_are_not_listed() {
        let mut bytes = Vec::new();
        let mut record = |numbers: &[i32], length: usize| {
            let length_bytes = (length as u32).to_be_bytes();
            let mut content: Vec<u8> = numbers.iter().flat_map(|number| number.to_be_bytes()).collect();
            content.resize(length, 0);
            bytes.extend([&length_bytes[..], &content, &length_bytes].concat());
        };
        record(&[3000], 84);
        record(&[], 80);
        record(&[0, 0, 0, 0, 1, 0], 24);
        record(&[1, NODES, 0, 1000, 1000], 60);
        (0..1000).for_each(|member| record(&[member], 44));
        record(&[1; 1000], 4000);
        let found = Head::read(&mut Records { bytes: &bytes, at: 0 });
        assert_eq!(found.err().map(|error| error.to_string()), Some(NO_INSTANT.to_owned()));
    }
}
