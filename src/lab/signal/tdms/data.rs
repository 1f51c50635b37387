//! The values in a run.

use std::fs::File;
use std::io::{BufReader, Read, Seek, SeekFrom};

use super::Fault;
use super::chunks::Run;

/// Bytes that are read at once.
const BLOCK: u64 = 1 << 18;

/// Gives every value of `run`, of `width` bytes, to `push`.
pub fn read(file: &mut BufReader<File>, run: Run, width: usize, mut push: impl FnMut(&[u8])) -> Result<(), Fault> {
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
        let here = file.stream_position()?;
        file.seek_relative(at.wrapping_sub(here) as i64).or_else(|_| file.seek(SeekFrom::Start(at)).map(drop))?;
        bytes.clear();
        file.by_ref().take(length).read_to_end(&mut bytes)?;
        for row in 0..now {
            let start = (row * stride) as usize;
            let Some(value) = bytes.get(start..start + width) else {
                return Err(Fault::Ends { at, what: "the values of a channel" });
            };
            push(value);
        }
        done += now;
    }
    Ok(())
}
