//! Descriptions of the raw data of an object.

use std::rc::Rc;

use super::Fault;
use super::bytes::Bytes;
use super::kind::Kind;

/// What an object has in each chunk of a segment.
#[derive(Clone, Debug, PartialEq)]
pub struct Index {
    /// Type of its values.
    pub kind: Kind,
    /// Values in a chunk.
    pub count: u64,
    /// Bytes in a chunk; of DAQmx none, since its buffers are shared.
    pub bytes: u64,
    /// Of DAQmx: where its values are in the buffers.
    pub daqmx: Option<Daqmx>,
}

/// An object in a segment; without data there where it has no description.
pub type Member = (usize, Option<Rc<Index>>);

/// Raw data of DAQmx: one buffer a card, each with rows of so many bytes.
#[derive(Clone, Debug, PartialEq)]
pub struct Daqmx {
    pub scalers: Vec<Scaler>,
    /// Bytes of a row of each buffer.
    pub widths: Vec<u32>,
}

/// Where the values of one scaler are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scaler {
    pub kind: Kind,
    pub buffer: usize,
    /// Bytes of the row before the value.
    pub offset: u32,
    /// The one bit that is the value, of a digital line.
    pub bit: Option<u8>,
    /// Number that scales know it by.
    pub id: u32,
}

/// What the beginning of a description says.
pub enum Described {
    /// The object has no data in the segment.
    Nothing,
    /// Those of before.
    AsBefore,
    /// Its own.
    As(Index),
}

/// Beginnings of descriptions that are no lengths.
const NOTHING: u32 = u32::MAX;
const AS_BEFORE: u32 = 0;
const FORMAT_CHANGING_SCALERS: u32 = 0x1269;
const DIGITAL_LINE_SCALERS: u32 = 0x126a;

/// Most scalers or buffers of a channel.
const MOST_SCALERS: u32 = 256;

impl Described {
    /// Reads the description of the data of `object`.
    pub fn read(bytes: &mut Bytes, object: &str) -> Result<Described, Fault> {
        const WHAT: &str = "the description of data";
        Ok(match bytes.u32(WHAT)? {
            NOTHING => Described::Nothing,
            AS_BEFORE => Described::AsBefore,
            header => {
                let at = bytes.at();
                let wrong = |why| Fault::Index { at, object: object.to_owned(), why };
                let code = bytes.u32(WHAT)?;
                let kind = Kind::from_code(code).ok_or(Fault::UnknownType { at, what: "the data", code })?;
                if bytes.u32(WHAT)? != 1 {
                    return Err(wrong("expected one dimension"));
                }
                let count = bytes.u64(WHAT)?;
                let lines = header == DIGITAL_LINE_SCALERS;
                if lines || header == FORMAT_CHANGING_SCALERS {
                    let daqmx = Daqmx::read(bytes, lines).map_err(|fault| fault.locate(wrong))?;
                    return Ok(Described::As(Index { kind, count, bytes: 0, daqmx: Some(daqmx) }));
                }
                let size = match kind.width() {
                    Some(width) => {
                        count.checked_mul(width as u64).ok_or_else(|| wrong("more bytes than a file has"))?
                    }
                    None if kind == Kind::Text => bytes.u64(WHAT)?,
                    None => return Err(wrong("raw data of DAQmx without its scalers")),
                };
                Described::As(Index { kind, count, bytes: size, daqmx: None })
            }
        })
    }
}

/// A fault of scalers, before its object is known.
enum ScalerFault {
    Read(Fault),
    Wrong(&'static str),
}

impl From<Fault> for ScalerFault {
    fn from(fault: Fault) -> ScalerFault {
        ScalerFault::Read(fault)
    }
}

impl ScalerFault {
    fn locate(self, wrong: impl Fn(&'static str) -> Fault) -> Fault {
        match self {
            ScalerFault::Read(fault) => fault,
            ScalerFault::Wrong(why) => wrong(why),
        }
    }
}

impl Daqmx {
    fn read(bytes: &mut Bytes, lines: bool) -> Result<Daqmx, ScalerFault> {
        const WHAT: &str = "the scalers of DAQmx";
        let count = bytes.u32(WHAT)?;
        if count > MOST_SCALERS {
            return Err(ScalerFault::Wrong("more than 256 scalers"));
        }
        let mut scalers = Vec::new();
        for _ in 0..count {
            let code = bytes.u32(WHAT)?;
            let kind = Kind::from_scaler_code(code).ok_or(ScalerFault::Wrong("a scaler of an unknown type"))?;
            let (buffer, offset) = (bytes.u32(WHAT)? as usize, bytes.u32(WHAT)?);
            bytes.take(if lines { 1 } else { 4 }, WHAT)?;
            let id = bytes.u32(WHAT)?;
            let (offset, bit) = if lines { (offset / 8, Some((offset % 8) as u8)) } else { (offset, None) };
            scalers.push(Scaler { kind, buffer, offset, bit, id });
        }
        let buffers = bytes.u32(WHAT)?;
        if buffers > MOST_SCALERS {
            return Err(ScalerFault::Wrong("more than 256 buffers"));
        }
        let widths = (0..buffers).map(|_| bytes.u32(WHAT)).collect::<Result<Vec<_>, _>>()?;
        let fits = |scaler: &Scaler| {
            let end = u64::from(scaler.offset) + scaler.kind.width().unwrap_or(0) as u64;
            widths.get(scaler.buffer).is_some_and(|width| end <= u64::from(*width))
        };
        if scalers.iter().all(fits) {
            Ok(Daqmx { scalers, widths })
        } else {
            Err(ScalerFault::Wrong("a scaler lies beyond the rows of its buffer"))
        }
    }
}
