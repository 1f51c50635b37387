//! The page of the last good run in a browser: it reloads itself, and shows mistakes above what it showed before.

use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread;

use serde::Serialize;
use tiny_http::{Header, Request, Response, Server};

use super::super::Failure;
use base::diagnostic::{self, Diagnostic};
use study::store::run_files;

/// The frame around the page of the run.
const FRAME: &str = include_str!("frame.html");

/// A page that this machine's browsers can open.
pub(super) struct Page {
    address: String,
    shown: Arc<Mutex<Shown>>,
}

/// The content of the page.
#[derive(Clone, Debug, Default, Serialize)]
struct Shown {
    /// Number of the result; 0 before the first.
    result: u64,
    /// Mistakes since, as text.
    mistakes: String,
    #[serde(skip)]
    folder: Option<PathBuf>,
}

impl Page {
    /// Serves the page to this machine only.
    ///
    /// # Errors
    /// The port is taken.
    pub(super) fn open(port: u16) -> Result<Page, Failure> {
        let server = Server::http(("127.0.0.1", port)).map_err(|error| {
            let mistake = Diagnostic::new(format!("cannot serve the page at port {port}: {error}"));
            Failure::output(mistake.hint("give another --port, or --no-page"))
        })?;
        let place = server.server_addr().to_string();
        let shown = Arc::new(Mutex::new(Shown::default()));
        let (known, served) = (place.clone(), Arc::clone(&shown));
        thread::spawn(move || {
            for request in server.incoming_requests() {
                let shown = lock(&served).clone();
                // A browser that has gone needs no answer.
                let _ = answer(request, &known, &shown);
            }
        });
        Ok(Page { address: format!("http://{place}"), shown })
    }

    /// Where a browser finds it.
    pub(super) fn address(&self) -> &str {
        &self.address
    }

    /// Shows the results in `folder`.
    pub(super) fn show(&self, folder: &Path) {
        let mut shown = lock(&self.shown);
        let result = shown.result + 1;
        *shown = Shown { result, mistakes: String::new(), folder: Some(folder.to_owned()) };
    }

    /// Shows mistakes above the last good results.
    pub(super) fn tell(&self, mistakes: &[Diagnostic]) {
        lock(&self.shown).mistakes = diagnostic::render(mistakes, false);
    }
}

fn lock(shown: &Mutex<Shown>) -> MutexGuard<'_, Shown> {
    shown.lock().unwrap_or_else(PoisonError::into_inner)
}

fn answer(request: Request, place: &str, shown: &Shown) -> std::io::Result<()> {
    // Another site whose name leads to this machine must not read results.
    let names_us = |header: &Header| header.field.equiv("Host") && header.value.as_str() == place;
    if !request.headers().iter().any(names_us) {
        return request.respond(Response::empty(403));
    }
    match request.url().split('?').next().unwrap_or_default() {
        "/" => request.respond(Response::from_string(FRAME).with_header(kind("text/html; charset=utf-8"))),
        "/shown" => {
            let text = serde_json::to_string(shown).unwrap_or_default();
            request.respond(Response::from_string(text).with_header(kind("application/json")))
        }
        url => match file(url, shown) {
            Some((file, content)) => request.respond(Response::from_file(file).with_header(kind(content))),
            None => request.respond(Response::empty(404)),
        },
    }
}

/// A file of the run folder itself and its kind.
fn file(url: &str, shown: &Shown) -> Option<(File, &'static str)> {
    let name = url.strip_prefix("/run/")?;
    let entry = fs::read_dir(shown.folder.as_ref()?).ok()?.flatten().find(|entry| entry.file_name() == *name)?;
    let content = match name {
        run_files::REPORT => "text/html; charset=utf-8",
        _ => "application/octet-stream",
    };
    entry.file_type().ok()?.is_file().then_some(())?;
    Some((File::open(entry.path()).ok()?, content))
}

fn kind(content: &str) -> Header {
    // The names of kinds are ASCII.
    Header::from_bytes("Content-Type", content).unwrap_or_else(|()| unreachable!("{content} is ASCII"))
}
