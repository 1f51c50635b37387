//! `droptower export` and `import`: films in the formats of other solvers.

use std::path::{Path, PathBuf};

use clap::{Args, Subcommand};
use serde_json::json;

use crate::args::{number, quantity};
use crate::{Failure, Shared, check, deck, output, print_figures, terminal};
use ::card::read::{self, Mistake, Reading};
use ::card::{Film, Request, System, Target};
use base::diagnostic::{Diagnostic, Source, Span, shown_path};
use base::file;
use base::finding::Finding;
use base::units::{Length, Rate};
use membrane::material::Material;
use scene::model::{self, Face};
use scene::scenario::Document;
use study::store::run_files;

#[derive(Debug, Subcommand)]
pub(crate) enum ExportCommand {
    /// Write the film of a material, a scenario or a run as a card of another solver
    Card(CardArgs),
    /// Write a drop test as a deck of LS-DYNA or OpenRadioss
    Deck(deck::DeckArgs),
}

pub(crate) fn run_export(command: &ExportCommand, shared: &Shared) -> Result<(), Failure> {
    match command {
        ExportCommand::Card(args) => export_card(args, shared),
        ExportCommand::Deck(args) => deck::run(args, shared),
    }
}

/// A film, and what it was made from.
pub(crate) struct FilmSource {
    pub(crate) name: String,
    pub(crate) material: Material,
    /// Layers that it stands for: those of its face, one of a material.
    pub(crate) layers: u32,
    /// Lines for the head of a card.
    pub(crate) origin: Vec<String>,
}

/// The film of a material, of a scenario or of a run's folder; of several faces that of `face`, counted from 1.
pub(crate) fn read(path: &Path, face: Option<usize>) -> Result<FilmSource, Failure> {
    let file = if path.is_dir() { in_folder(path)? } else { path.to_path_buf() };
    let document = Document::read(&file)?;
    if document.is_material() {
        let document = Document::read_material(&file)?;
        let material = model::check_material(&document)?;
        if let Some(face) = face {
            let mistake = Diagnostic::new(format!("{} is a material, which has no face {face}", shown_path(&file)));
            return Err(mistake.hint("leave --face out").into());
        }
        let named = document.material().0.and_then(|written| written.name);
        let name = named.unwrap_or_else(|| document.name());
        return Ok(FilmSource { name, material, layers: 1, origin: origin(&document)? });
    }
    let model = model::check(&document)?;
    let Face { film, material, layers, .. } = chosen(&model.faces, face, &file)?;
    let name = film.clone().unwrap_or_else(|| document.name());
    Ok(FilmSource { name, material: material.clone(), layers: *layers, origin: origin(&document)? })
}

/// The file of a film among the results of a study.
const FILM: &str = "film.toml";

/// The scenario of a run, or the film of a study.
pub(crate) fn in_folder(folder: &Path) -> Result<PathBuf, Diagnostic> {
    let files = [run_files::SCENARIO, FILM].map(|name| folder.join(name));
    files.into_iter().find(|file| file.is_file()).ok_or_else(|| {
        let mistake = Diagnostic::new(format!("{} has neither {} nor {FILM}", shown_path(folder), run_files::SCENARIO));
        mistake.hint("name the folder of a run, that of a study which wrote its film, or a material or scenario")
    })
}

fn chosen<'a>(faces: &'a [Face], face: Option<usize>, file: &Path) -> Result<&'a Face, Diagnostic> {
    let count = faces.len();
    let found = match (faces, face) {
        ([only], None) => Some(only),
        (_, Some(face)) => face.checked_sub(1).and_then(|place| faces.get(place)),
        (faces, None) => faces.first().filter(|first| faces.iter().all(|face| face.material == first.material)),
    };
    found.ok_or_else(|| {
        let mistake = Diagnostic::new(format!("{} has {count} faces of film", shown_path(file)));
        mistake.hint(format!("name one of them: --face 1 to --face {count}"))
    })
}

/// The file and its checksum, which also covers the files that it reads, one behind the other in their order.
pub(crate) fn origin(document: &Document) -> Result<Vec<String>, Diagnostic> {
    let file = document.path();
    let others: Vec<&PathBuf> = document.files().iter().filter(|other| *other != file).collect();
    let digest = file::sha256(std::iter::once(file).chain(others.iter().map(|path| path.as_path())))?;
    let names: Vec<String> = others.iter().map(|path| shown_path(path)).collect();
    let others = if names.is_empty() { String::new() } else { format!(" and {}", names.join(", ")) };
    Ok(vec![format!("from {}{others}, SHA-256 {digest}", shown_path(file))])
}

/// The options of films that are written, for cards and decks.
#[derive(Debug, Args)]
pub(crate) struct RequestArgs {
    /// The solver: ls-dyna, openradioss, abaqus, calculix, febio, kratos, or curves for a table; `droptower explain SOLVER`
    /// has what it is written
    #[arg(long = "for", value_name = "SOLVER", value_parser = target)]
    pub target: Target,
    /// The units: kg-m-s, t-mm-s, g-mm-ms, kg-mm-ms or lbf-in-s
    #[arg(long, value_name = "SYSTEM", default_value = "t-mm-s", value_parser = system)]
    pub units: System,
    /// Strain rate of the curves where the target takes those of one [default: all rates]
    #[arg(long, value_name = "RATE", value_parser = |text: &str| quantity(Rate::DIMENSION, text))]
    pub rate: Option<f64>,
    /// Most points of a curve
    #[arg(long, value_name = "N", default_value_t = 100, value_parser = clap::value_parser!(u16).range(2..=10_000))]
    pub points: u16,
    /// Poisson's ratio of incompressible film in elements that need one [default: 0.4995 or more, by the stress of the film]
    #[arg(long, value_name = "NUMBER", value_parser = poisson)]
    pub poisson: Option<f64>,
    /// Strain from which unloading curves are exact [default: the end of each curve]
    #[arg(long, value_name = "STRAIN", value_parser = strain)]
    pub unloading_from: Option<f64>,
}

impl RequestArgs {
    /// A request of one layer.
    pub(crate) fn request(&self) -> Request {
        Request {
            rate: self.rate,
            points: self.points.into(),
            poisson: self.poisson,
            unloading_from: self.unloading_from,
            ..Request::new(self.target, self.units)
        }
    }
}

/// The refusal of what is written from this file.
pub(crate) fn refused(file: &Path, refusal: Diagnostic) -> Diagnostic {
    Diagnostic { message: format!("{}: {}", shown_path(file), refusal.message), ..refusal }
}

fn target(text: &str) -> Result<Target, String> {
    let names = || Target::ALL.map(Target::key).join(", ");
    Target::ALL.into_iter().find(|target| target.key() == text).ok_or_else(|| format!("expected one of {}", names()))
}

/// The system of units of this name.
pub(crate) fn system(text: &str) -> Result<System, String> {
    System::from_name(text).ok_or_else(|| format!("expected one of {}", System::ALL.map(System::name).join(", ")))
}

fn poisson(text: &str) -> Result<f64, String> {
    let found = number(text)?;
    let is_possible = (0.4..0.5).contains(&found);
    is_possible.then_some(found).ok_or_else(|| format!("expected 0.4 to less than 0.5, found {text}"))
}

fn strain(text: &str) -> Result<f64, String> {
    let found = number(text)?;
    let is_possible = found > 0.0 && found <= 100.0;
    is_possible.then_some(found).ok_or_else(|| format!("expected a strain above 0 and up to 100, found {text}"))
}

/// The options of `export card`.
#[derive(Debug, Args)]
pub(crate) struct CardArgs {
    /// A material, a scenario, or the folder of a run
    pub film: PathBuf,
    /// The card to write
    #[arg(long, short, value_name = "FILE")]
    pub out: PathBuf,
    #[command(flatten)]
    pub request: RequestArgs,
    /// Layers that one element stands for [default: those of the scenario's face, else 1]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pub layers: Option<u32>,
    /// The face of a scenario with several, counted from 1
    #[arg(long, value_name = "N")]
    pub face: Option<usize>,
    /// Number of the material; those of its curves follow from it
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=99_999))]
    pub id: u32,
    /// Replace a file that exists
    #[arg(long)]
    pub force: bool,
}

fn export_card(args: &CardArgs, shared: &Shared) -> Result<(), Failure> {
    let target = args.request.target;
    output::check(&args.out, target.ending(), Some(&args.film), Some(args.force))?;
    let FilmSource { name, material, layers, origin } = read(&args.film, args.face)?;
    let request = Request { layers: args.layers.unwrap_or(layers), id: args.id, ..args.request.request() };
    let film = Film { name: &name, material: &material, origin: &origin };
    let written = ::card::write(&film, &request).map_err(|refusal| refused(&args.film, refusal))?;
    output::write(&args.out, |file| file.write_all(written.text.as_bytes()))?;
    let findings: Vec<Finding> = written.losses.iter().map(Finding::new).collect();
    let (out, target, units) = (shown_path(&args.out), target.name(), args.request.units.name());
    let figures = json!({
        "out": out,
        "target": target,
        "units": units,
        "film": name,
        "layers": request.layers,
        "findings": findings,
    });
    print_figures(shared, &figures, || {
        format!("{name} for {target}, {units}\n{}  {out}", terminal::findings("  ", &findings))
    })
}

/// Longest card, bytes.
const MOST_BYTES: u64 = 64 << 20;

#[derive(Debug, Subcommand)]
pub(crate) enum ImportCommand {
    /// Read the film of a card as a material
    Card(ImportCardArgs),
}

pub(crate) fn run_import(command: &ImportCommand, shared: &Shared) -> Result<(), Failure> {
    let ImportCommand::Card(args) = command;
    import_card(args, shared)
}

/// The options of `import card`.
#[derive(Debug, Args)]
pub(crate) struct ImportCardArgs {
    /// A card of LS-DYNA or OpenRadioss
    pub card: PathBuf,
    /// The material to write
    #[arg(long, short, value_name = "FILE")]
    pub out: PathBuf,
    /// The units of the card: kg-m-s, t-mm-s, g-mm-ms, kg-mm-ms or lbf-in-s [default: those that a card of droptower names]
    #[arg(long, value_name = "SYSTEM", value_parser = system)]
    pub units: Option<System>,
    /// Thickness of one layer, which is not in a card [default: that which a card of droptower names]
    #[arg(long, value_name = "LENGTH", value_parser = |text: &str| quantity(Length::DIMENSION, text))]
    pub thickness: Option<f64>,
    /// Number or title of the material, where the card has several [default: the first]
    #[arg(long, value_name = "NAME")]
    pub material: Option<String>,
    /// Replace a file that exists
    #[arg(long)]
    pub force: bool,
}

fn import_card(args: &ImportCardArgs, shared: &Shared) -> Result<(), Failure> {
    output::check(&args.out, "toml", Some(&args.card), Some(args.force))?;
    let shown = shown_path(&args.card);
    let text = file::read_text(&args.card, MOST_BYTES)
        .map_err(|error| Diagnostic::new(format!("cannot read {shown}: {error}")))?;
    let system = args.units.or_else(|| ::card::units_of(&text)).ok_or_else(|| {
        let mistake = Diagnostic::new(format!("the units of {shown} are not known: cards have none of their own"));
        mistake.hint("name them, such as --units t-mm-s")
    })?;
    let thickness = args.thickness.or_else(|| ::card::thickness_of(&text, system)).ok_or_else(|| {
        let mistake = Diagnostic::new(format!("the thickness of the film is not in {shown}"));
        mistake.hint("name that of one layer, such as --thickness \"12 um\"")
    })?;
    let Reading { film, warnings } =
        read::read(&text, system, args.material.as_deref()).map_err(|mistake| misread(&args.card, &text, &mistake))?;
    let findings: Vec<Finding> = warnings.iter().map(Finding::new).collect();
    let comments = [format!("Read from {shown} ({}) by droptower {}.", system.name(), env!("CARGO_PKG_VERSION"))];
    let comments: Vec<String> =
        comments.into_iter().chain(findings.iter().map(|finding| finding.message.clone())).collect();
    let material = read::material(&film, thickness, &comments);
    check::material_texts(&[("material.toml", material.as_str())])?;
    output::write(&args.out, |file| file.write_all(material.as_bytes()))?;
    let (out, units, film) = (shown_path(&args.out), system.name(), film.name);
    let figures = json!({
        "out": out,
        "card": shown,
        "film": film,
        "units": units,
        "thickness_m": thickness,
        "findings": findings,
    });
    print_figures(shared, &figures, || {
        format!("{film} of {shown}, {units}\n{}  {out}", terminal::findings("  ", &findings))
    })
}

/// A mistake in the `text` of a card, with its line.
fn misread(path: &Path, text: &str, mistake: &Mistake) -> Diagnostic {
    let line = text.lines().nth(mistake.place.line - 1).unwrap_or_default().to_owned();
    let source = Source::excerpt(path, mistake.place.line, line);
    Diagnostic::new(mistake.message.as_str()).at(&Span::position(&source, 1, mistake.place.column))
}
