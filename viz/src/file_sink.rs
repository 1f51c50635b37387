//! The file that a recording is written to.
//!
//! The sink of the SDK writes by a thread of its own, and waits for ever once that thread has ended at a full disk (0.36).

use std::fs::File;
use std::io::{self, BufWriter};
use std::path::Path;
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

use re_sdk::external::re_log_encoding::Encoder;
use re_sdk::external::re_log_encoding::rrd::EncodingOptions;
use re_sdk::log::LogMsg;
use re_sdk::sink::{LogSink, SinkFlushError};

/// Writes messages to a file as they come.
pub(crate) struct FileSink(Mutex<State>);

struct State {
    encoder: Encoder<BufWriter<File>>,
    /// Why nothing is written any more.
    failure: Option<String>,
}

impl FileSink {
    /// A sink into the file at `path`, replacing what is there.
    ///
    /// # Errors
    /// The file cannot be written.
    pub(crate) fn new(path: &Path) -> io::Result<FileSink> {
        let file = BufWriter::new(File::create(path)?);
        let version = re_sdk::build_info().version;
        let encoder = Encoder::new_eager(version, EncodingOptions::PROTOBUF_COMPRESSED, file);
        let mut encoder = encoder.map_err(io::Error::other)?;
        // An index of the messages, which the viewer makes itself and which would hold all of them in memory.
        encoder.do_not_emit_footer();
        Ok(FileSink(Mutex::new(State { encoder, failure: None })))
    }

    /// Does `work` unless an earlier one failed.
    fn with<E: ToString>(
        &self,
        work: impl FnOnce(&mut Encoder<BufWriter<File>>) -> Result<(), E>,
    ) -> Result<(), String> {
        let mut state = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(failure) = &state.failure {
            return Err(failure.clone());
        }
        work(&mut state.encoder).map_err(|error| {
            let failure = error.to_string();
            state.failure = Some(failure.clone());
            failure
        })
    }
}

impl LogSink for FileSink {
    fn send(&self, message: LogMsg) {
        // What fails is told by the flush that ends every recording.
        let _ = self.with(|encoder| encoder.append(&message).map(drop));
    }

    fn flush_blocking(&self, _timeout: Duration) -> Result<(), SinkFlushError> {
        self.with(Encoder::flush_blocking).map_err(SinkFlushError::failed)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[cfg(target_os = "linux")]
    #[test]
    fn a_full_disk_is_an_error_of_every_flush() {
        let sink = FileSink::new(Path::new("/dev/full")).unwrap();
        for _ in 0..2 {
            let error = sink.flush_blocking(Duration::MAX).unwrap_err().to_string();
            assert!(error.contains("No space left"), "{error}");
        }
    }
}
