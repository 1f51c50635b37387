//! Values and their types: in bytes that are read in order, as raw data, and as properties of objects. Scales: what the properties of
//! a channel say its stored numbers mean, each scale applied to the one before it.
//!
//! What National Instruments does not document, the names of the properties of scales, is as `npTDMS` found it in files.

use std::collections::BTreeMap;

use crate::error::{Error, refusal};
use crate::signal::catalogue::Binary;

/// Bytes of a file that are read in order.
pub struct Bytes<'a> {
    bytes: &'a [u8],
    read: usize,
    /// Place of the first of them in the file.
    base: u64,
    is_big: bool,
}

impl<'a> Bytes<'a> {
    pub fn new(bytes: &'a [u8], base: u64, is_big: bool) -> Bytes<'a> {
        Bytes { bytes, read: 0, base, is_big }
    }

    /// Place in the file.
    pub fn at(&self) -> u64 {
        self.base + self.read as u64
    }

    /// Whether more significant bytes come first.
    pub fn is_big(&self) -> bool {
        self.is_big
    }

    /// The next `count` bytes, which are those of `what`.
    pub fn take(&mut self, count: usize, what: &'static str) -> Result<&'a [u8], Error> {
        let end = self.read.checked_add(count).filter(|end| *end <= self.bytes.len());
        let end = end.ok_or_else(|| ends(self.at(), what))?;
        let taken = &self.bytes[self.read..end];
        self.read = end;
        Ok(taken)
    }

    pub fn u32(&mut self, what: &'static str) -> Result<u32, Error> {
        self.array(what).map(|bytes| if self.is_big { u32::from_be_bytes(bytes) } else { u32::from_le_bytes(bytes) })
    }

    pub fn u64(&mut self, what: &'static str) -> Result<u64, Error> {
        self.array(what).map(|bytes| if self.is_big { u64::from_be_bytes(bytes) } else { u64::from_le_bytes(bytes) })
    }

    /// A text with its length before it.
    pub fn text(&mut self, what: &'static str) -> Result<String, Error> {
        let length = self.u32(what)? as usize;
        Ok(String::from_utf8_lossy(self.take(length, what)?).into_owned())
    }

    fn array<const N: usize>(&mut self, what: &'static str) -> Result<[u8; N], Error> {
        let mut array = [0; N];
        array.copy_from_slice(self.take(N, what)?);
        Ok(array)
    }
}

/// The fault of an end within `what`, at a byte of the file.
pub fn ends(at: u64, what: &str) -> Error {
    refusal!("byte {at}: the list of objects ends within {what}")
}

/// The fault of a type that the format does not have.
pub fn unknown_type(at: u64, what: &str, code: u32) -> Error {
    refusal!("byte {at}: {what} has the unknown type {code:#x}")
}

/// The fault of a file with more than is read.
pub fn too_many(at: u64, most: usize, what: &str) -> Error {
    refusal!("byte {at}: more than {most} {what}").with_hint("defragment the file: TDMS Defragment in LabVIEW")
}

/// Type of the values of a channel, or of a property.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Numbers of so many bytes.
    Number(Binary, u8),
    Bool,
    Timestamp,
    /// Texts, whose values have different lengths.
    Text,
    /// Nothing, of no length.
    Void,
    /// Raw data of DAQmx, whose types are those of its scalers.
    Daqmx,
    /// Numbers of two parts, or of more than eight bytes.
    Other {
        width: u8,
        what: &'static str,
    },
}

impl Kind {
    /// Of the number that the format has for it.
    pub fn from_code(code: u32) -> Option<Kind> {
        Some(match code {
            0 => Kind::Void,
            1..=4 => Kind::Number(Binary::Signed, 1 << (code - 1)),
            5..=8 => Kind::Number(Binary::Unsigned, 1 << (code - 5)),
            9 | 0x19 => Kind::Number(Binary::Float, 4),
            10 | 0x1a => Kind::Number(Binary::Float, 8),
            11 | 0x1b => Kind::Other { width: 16, what: "extended floating-point numbers" },
            0x20 => Kind::Text,
            0x21 => Kind::Bool,
            0x44 => Kind::Timestamp,
            0x0008_000c => Kind::Other { width: 8, what: "complex numbers" },
            0x0010_000d => Kind::Other { width: 16, what: "complex numbers" },
            u32::MAX => Kind::Daqmx,
            _ => return None,
        })
    }

    /// Of the number that scalers of DAQmx have for it, which is another.
    pub fn from_scaler_code(code: u32) -> Option<Kind> {
        Some(match code {
            // Unsigned and signed by turns, from one byte to eight.
            0..=7 if code.is_multiple_of(2) => Kind::Number(Binary::Unsigned, 1 << (code / 2)),
            0..=7 => Kind::Number(Binary::Signed, 1 << (code / 2)),
            8 => Kind::Number(Binary::Float, 4),
            9 => Kind::Number(Binary::Float, 8),
            u32::MAX => Kind::Timestamp,
            _ => return None,
        })
    }

    /// Bytes of a value; none where they differ.
    pub fn width(self) -> Option<usize> {
        Some(match self {
            Kind::Void => 0,
            Kind::Bool => 1,
            Kind::Timestamp => 16,
            Kind::Number(_, width) | Kind::Other { width, .. } => width.into(),
            Kind::Text | Kind::Daqmx => return None,
        })
    }

    /// What its values are, where they are no real numbers.
    pub fn not_real(self) -> Option<&'static str> {
        match self {
            Kind::Text => Some("texts"),
            Kind::Void => Some("nothing"),
            Kind::Other { what, .. } => Some(what),
            _ => None,
        }
    }

    /// The number in `bytes`, as many as its width; a time has none.
    pub fn number(self, bytes: &[u8], is_big: bool) -> Option<f64> {
        let bytes = self.width().and_then(|width| bytes.get(..width))?;
        match self {
            Kind::Number(meaning, _) => meaning.number(bytes, is_big),
            Kind::Bool => Some(f64::from(u8::from(bytes[0] != 0))),
            Kind::Timestamp | Kind::Text | Kind::Void | Kind::Daqmx | Kind::Other { .. } => None,
        }
    }
}

/// A time of the day: seconds since 1904-01-01 00:00 UTC, and a part of a second in units of 2⁻⁶⁴.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Timestamp {
    pub seconds: i64,
    pub fraction: u64,
}

impl Timestamp {
    /// Of its 16 bytes.
    pub fn from_bytes(bytes: &[u8], is_big: bool) -> Option<Timestamp> {
        let [first, last] = [bytes.get(..8)?.try_into().ok()?, bytes.get(8..16)?.try_into().ok()?];
        Some(match is_big {
            true => Timestamp { seconds: i64::from_be_bytes(first), fraction: u64::from_be_bytes(last) },
            false => Timestamp { seconds: i64::from_le_bytes(last), fraction: u64::from_le_bytes(first) },
        })
    }

    /// Seconds from `start` to it.
    pub fn since(self, start: Timestamp) -> f64 {
        let whole = i128::from(self.seconds) - i128::from(start.seconds);
        let part = |time: Timestamp| time.fraction as f64 / 2_f64.powi(64);
        whole as f64 + (part(self) - part(start))
    }

    /// As a date and a time of the day in UTC, to a millisecond.
    pub fn date(self) -> String {
        const DAY: i64 = 86_400;
        let (days, second) = (self.seconds.div_euclid(DAY), self.seconds.rem_euclid(DAY));
        let (year, month, day) = calendar(days);
        let milliseconds = ((self.fraction >> 32) * 1000) >> 32;
        format!(
            "{year:04}-{month:02}-{day:02}T{:02}:{:02}:{:02}.{milliseconds:03}Z",
            second / 3600,
            second / 60 % 60,
            second % 60
        )
    }
}

/// Year, month and day of so many days after 1904-01-01, by the Gregorian calendar (Richards, in *Explanatory Supplement to
/// the Astronomical Almanac*, 2013, section 15.11.3).
fn calendar(days: i64) -> (i64, i64, i64) {
    // The Julian day number of 1904-01-01 is 2 416 481; days beyond those of the formula are none of a recording.
    let julian = days.clamp(-2_000_000, 500_000_000) + 2_416_481;
    let f = julian + 1401 + (4 * julian + 274_277) / 146_097 * 3 / 4 - 38;
    let e = 4 * f + 3;
    let h = 5 * (e % 1461 / 4) + 2;
    let month = (h / 153 + 2) % 12 + 1;
    (e / 1461 - 4716 + (14 - month) / 12, month, h % 153 / 5 + 1)
}

/// Properties by name.
pub type Properties = BTreeMap<String, Value>;

/// Value of a property.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    Number(f64),
    Text(String),
    Time(Timestamp),
    /// Of a type that no property is used with here.
    Other,
}

impl Value {
    fn read(bytes: &mut Bytes) -> Result<Value, Error> {
        const WHAT: &str = "a property";
        let (at, code) = (bytes.at(), bytes.u32(WHAT)?);
        let kind = Kind::from_code(code).ok_or_else(|| unknown_type(at, WHAT, code))?;
        let is_big = bytes.is_big();
        Ok(match (kind, kind.width()) {
            (Kind::Text, _) => Value::Text(bytes.text(WHAT)?),
            (_, None) => return Err(unknown_type(at, WHAT, code)),
            (Kind::Timestamp, Some(width)) => {
                Timestamp::from_bytes(bytes.take(width, WHAT)?, is_big).map_or(Value::Other, Value::Time)
            }
            (_, Some(width)) => kind.number(bytes.take(width, WHAT)?, is_big).map_or(Value::Other, Value::Number),
        })
    }
}

/// Reads the properties of an object over those that it had.
pub fn read_properties(bytes: &mut Bytes, properties: &mut Properties) -> Result<(), Error> {
    for _ in 0..bytes.u32("the number of properties")? {
        let name = bytes.text("the name of a property")?;
        properties.insert(name, Value::read(bytes)?);
    }
    Ok(())
}

/// The number of this name.
pub fn number(properties: &Properties, name: &str) -> Option<f64> {
    match properties.get(name) {
        Some(Value::Number(number)) => Some(*number),
        _ => None,
    }
}

/// The text of this name.
pub fn text<'a>(properties: &'a Properties, name: &str) -> Option<&'a str> {
    match properties.get(name) {
        Some(Value::Text(text)) => Some(text),
        _ => None,
    }
}

/// The scales that lead from the stored number to the value.
#[derive(Clone, Debug, PartialEq)]
pub struct Scales {
    /// The scaler of DAQmx that they begin with; none where they begin with the stored number.
    pub scaler: Option<u32>,
    /// The first that is applied comes last.
    steps: Vec<Step>,
}

/// One scale.
#[derive(Clone, Debug, PartialEq)]
enum Step {
    Polynomial(Vec<f64>),
    /// Pairs of input and output, by increasing input.
    Table(Vec<[f64; 2]>),
}

/// Most scales of a channel, and values of a table or coefficients.
const MOST_SCALES: f64 = 256.0;
const MOST_COEFFICIENTS: f64 = 100_000.0;
/// The input source that is the stored number.
const STORED: f64 = u32::MAX as f64;

impl Scales {
    /// Of these properties; none where they have none, or where they are applied already.
    ///
    /// # Errors
    /// Why they cannot be applied.
    pub fn read(properties: &Properties) -> Result<Option<Scales>, String> {
        let stated = number(properties, "NI_Number_Of_Scales");
        let numbered = properties.keys().filter_map(|key| {
            key.strip_prefix("NI_Scale[")?.strip_suffix("]_Scale_Type")?.parse::<u32>().ok()?.checked_add(1)
        });
        let count = stated.or_else(|| numbered.max().map(f64::from)).unwrap_or(0.0);
        if count.is_nan() || count < 1.0 || text(properties, "NI_Scaling_Status") == Some("scaled") {
            return Ok(None);
        }
        if count > MOST_SCALES {
            return Err(format!("it has {count} scales"));
        }
        let count = count as usize;
        let mut steps = Vec::new();
        let mut next = Some(count - 1);
        for _ in 0..count {
            let Some(scale) = next else { break };
            if scale >= count {
                return Err(format!("a scale is applied to scale {scale}, which it does not have"));
            }
            let reader = Reader { properties, scale };
            let Some(kind) = text(properties, &reader.name("Scale_Type")) else {
                return Ok(Some(Scales { scaler: Some(scale as u32), steps }));
            };
            steps.extend(reader.step(kind)?);
            next = reader.input(kind);
        }
        match next {
            Some(scale) => Err(format!("scale {scale} is applied to itself")),
            None => Ok(Some(Scales { scaler: None, steps })),
        }
    }

    /// The value that stands for what is stored, or for what the scaler gives.
    pub fn apply(&self, stored: f64) -> f64 {
        self.steps.iter().rfold(stored, |x, step| match step {
            Step::Polynomial(coefficients) => {
                coefficients.iter().rev().fold(0.0, |sum, coefficient| sum * x + coefficient)
            }
            Step::Table(pairs) => interpolated(pairs, x),
        })
    }
}

/// Linear between the pairs, constant beyond them.
fn interpolated(pairs: &[[f64; 2]], x: f64) -> f64 {
    let after = pairs.partition_point(|pair| pair[0] < x);
    match (after.checked_sub(1).map(|before| pairs[before]), pairs.get(after)) {
        (Some(before), Some(after)) => before[1] + (x - before[0]) * ((after[1] - before[1]) / (after[0] - before[0])),
        (Some(end), None) | (None, Some(&end)) => end[1],
        (None, None) => f64::NAN,
    }
}

/// Reads one scale.
struct Reader<'a> {
    properties: &'a Properties,
    scale: usize,
}

impl Reader<'_> {
    /// What it does; nothing where it is the input as it is.
    fn step(&self, kind: &str) -> Result<Option<Step>, String> {
        Ok(match kind {
            "Linear" => {
                let coefficients = [self.number("Linear_Y_Intercept")?, self.number("Linear_Slope")?];
                Some(Step::Polynomial(coefficients.into()))
            }
            "Polynomial" => {
                let count = self.count("Polynomial_Coefficients_Size", Some(4.0))?;
                let one = |place| self.number(&format!("Polynomial_Coefficients[{place}]"));
                Some(Step::Polynomial((0..count).map(one).collect::<Result<Vec<_>, _>>()?))
            }
            "Table" => Some(Step::Table(self.table()?)),
            "AdvancedAPI" => None,
            other => {
                return Err(format!(
                    "scale {} is of the kind {other}, which is not applied; save it scaled, e.g. as a table",
                    self.scale
                ));
            }
        })
    }

    fn name(&self, what: &str) -> String {
        format!("NI_Scale[{}]_{what}", self.scale)
    }

    fn number(&self, what: &str) -> Result<f64, String> {
        let name = self.name(what);
        number(self.properties, &name).ok_or_else(|| format!("the property `{name}` is missing"))
    }

    fn count(&self, what: &str, default: Option<f64>) -> Result<usize, String> {
        let stated = number(self.properties, &self.name(what)).or(default).map_or_else(|| self.number(what), Ok)?;
        let fits = (0.0..=MOST_COEFFICIENTS).contains(&stated);
        if fits { Ok(stated as usize) } else { Err(format!("`{}` is {stated}", self.name(what))) }
    }

    /// The scale to whose result it is applied; none where that is the stored number.
    fn input(&self, kind: &str) -> Option<usize> {
        let source = number(self.properties, &self.name(&format!("{kind}_Input_Source")));
        source.filter(|scale| *scale < STORED).map(|scale| scale.max(0.0) as usize)
    }

    fn table(&self) -> Result<Vec<[f64; 2]>, String> {
        let count = self.count("Table_Pre_Scaled_Values_Size", None)?;
        if self.count("Table_Scaled_Values_Size", None)? != count {
            return Err(format!("the table of scale {} has inputs and outputs of different number", self.scale));
        }
        let pair = |place| {
            let value = |what| self.number(&format!("Table_{what}_Values[{place}]"));
            Ok([value("Pre_Scaled")?, value("Scaled")?])
        };
        let mut pairs = (0..count).map(pair).collect::<Result<Vec<_>, String>>()?;
        let rises = |pairs: &[[f64; 2]]| pairs.windows(2).all(|pair| pair[0][0] < pair[1][0]);
        if !rises(&pairs) {
            pairs.reverse();
        }
        if rises(&pairs) {
            Ok(pairs)
        } else {
            Err(format!("the inputs of the table of scale {} do not rise", self.scale))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_of_the_day() {
        let at = |seconds, fraction| Timestamp { seconds, fraction };
        for (time, expected) in [
            (at(0, 0), "1904-01-01T00:00:00.000Z"),
            (at(2_082_844_800, 0), "1970-01-01T00:00:00.000Z"),
            (at(2_082_844_800 + 951_782_400 + 3661, 1 << 63), "2000-02-29T01:01:01.500Z"),
            (at(-1, 0), "1903-12-31T23:59:59.000Z"),
        ] {
            assert_eq!(time.date(), expected);
        }
        assert_eq!(at(5, 1 << 62).since(at(3, 1 << 63)), 1.75);
        assert!(at(i64::MAX, 0).since(at(i64::MIN, 0)) > 0.0 && !at(i64::MIN, u64::MAX).date().is_empty());
    }

    fn read(own: &[(&str, Value)]) -> Result<Option<Scales>, String> {
        Scales::read(&own.iter().map(|(name, value)| (format!("NI_Scale{name}"), value.clone())).collect())
    }

    #[test]
    fn scales_of_sensors_are_refused_by_name() {
        for kind in ["RTD", "Thermistor", "Strain", "Thermocouple", "Add", "Subtract"] {
            let error = read(&[("[0]_Scale_Type", Value::Text(kind.into()))]).unwrap_err();
            assert!(error.starts_with(&format!("scale 0 is of the kind {kind}, which is not applied")), "{error}");
        }
    }

    #[test]
    fn a_circle_of_scales_is_refused() {
        let same = || Value::Text("AdvancedAPI".into());
        let input = |scale: f64| Value::Number(scale);
        for source in [0.0, 1.0, 7.0] {
            let own = [
                ("[0]_Scale_Type", same()),
                ("[0]_AdvancedAPI_Input_Source", input(source)),
                ("[1]_Scale_Type", same()),
                ("[1]_AdvancedAPI_Input_Source", input(0.0)),
            ];
            assert!(read(&own).is_err(), "{source}");
        }
    }
}
