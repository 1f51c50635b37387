//! Cards: an identified film in the material formats of other solvers.
//!
//! A [`Film`] and a [`Request`] give a [`Card`]: the text, and what it does not say of the film. Each solver has a module that
//! knows its format and nothing of the others; what they share is the film in their terms and curves with few points
//! (`film`), fields and numbers in columns (`layout`) and systems of units (`target`).
#![warn(missing_docs)]

mod abaqus;
mod curves;
pub mod deck;
mod febio;
mod film;
mod kratos;
mod layout;
mod loss;
mod ls_dyna;
mod openradioss;
pub mod read;
mod target;

pub use film::{Film, Request};
pub use loss::{CODES, Loss};
pub use target::{About, System, Target};

use base::diagnostic::Diagnostic;
use base::number::significant;
use film::Draft;

/// A card.
#[derive(Clone, Debug, PartialEq)]
pub struct Card {
    /// Its text.
    pub text: String,
    /// What it does not say of the film, or has otherwise.
    pub losses: Vec<Loss>,
}

/// Writes a film.
///
/// # Errors
/// The target cannot hold its law.
pub fn write(film: &Film<'_>, request: &Request) -> Result<Card, Diagnostic> {
    let Pieces { head, body, losses } = pieces(film, request)?;
    let text = match request.target {
        Target::LsDyna => format!("{head}*KEYWORD\n{body}*END\n"),
        // The first line tells the reader what follows.
        Target::OpenRadioss => format!("#RADIOSS STARTER\n{head}{body}/END\n"),
        // Two hyphens would end a comment.
        Target::Febio => format!("<!--\n{}-->\n{body}", head.replace("--", "- -")),
        Target::Abaqus | Target::CalculiX | Target::Curves => head + &body,
        Target::Kratos => body,
    };
    Ok(Card { text, losses })
}

/// A card without the lines that begin and end a file.
struct Pieces {
    /// Lines of comments.
    head: String,
    body: String,
    losses: Vec<Loss>,
}

fn pieces(film: &Film<'_>, request: &Request) -> Result<Pieces, Diagnostic> {
    // A name of a stranger's is one line and no keyword.
    let film = &Film { name: &title(film.name), ..film.clone() };
    let mut draft = Draft { film, request, losses: vec![] };
    let (mark, body) = match request.target {
        Target::LsDyna => ("$ ", ls_dyna::write(&mut draft)?),
        Target::OpenRadioss => ("# ", openradioss::write(&mut draft)?),
        Target::Abaqus | Target::CalculiX => ("** ", abaqus::write(&mut draft)?),
        Target::Febio => ("  ", febio::write(&mut draft)?),
        Target::Kratos => ("", kratos::write(&mut draft)?),
        Target::Curves => ("# ", curves::write(&mut draft)?),
    };
    Ok(Pieces { head: commented(mark, &head_of_card(&draft)), body, losses: draft.losses })
}

/// Lines of comments.
fn commented(mark: &str, lines: &[String]) -> String {
    lines.iter().map(|line| format!("{}\n", format!("{mark}{line}").trim_end())).collect()
}

/// What a card says of itself: its thickness and measures, and what it lacks.
fn head_of_card(draft: &Draft<'_>) -> Vec<String> {
    let Draft { film, request, losses } = draft;
    let [_, length, ..] = request.system.words();
    let thickness = film.material.thickness / request.system.length();
    let thickness = format!(
        "thickness of one layer {} {length}; {} layer{}: {} {length}",
        significant(thickness, 6),
        request.layers,
        if request.layers == 1 { "" } else { "s" },
        significant(thickness * f64::from(request.layers), 6)
    );
    let mut about = vec![thickness, measures(film, request.target).to_owned()];
    about.extend(losses.iter().map(Loss::to_string));
    head(film.name, film.origin, request, about)
}

/// What a card or a deck says of itself: what it was made from, its units, and more `about` it. ASCII, since not every reader takes
/// more.
fn head(name: &str, origin: &[String], request: &Request, about: Vec<String>) -> Vec<String> {
    let Request { target, system, .. } = request;
    let [mass, length, time, force, stress] = system.words();
    let title = format!("{name} for {}, by droptower {}", target.name(), env!("CARGO_PKG_VERSION"));
    let units = format!("units: {} ({mass}, {length}, {time}; {force}, {stress})", system.name());
    let origin = origin.iter().cloned();
    let lines = std::iter::once(title).chain(origin).chain([units]).chain(about);
    lines.map(|line| ascii(&line)).collect()
}

/// The units that the head of a card of droptower's names.
pub fn units_of(card: &str) -> Option<System> {
    let rest = in_head(card, "units: ")?;
    System::from_name(rest.split_whitespace().next()?)
}

/// The thickness of one layer (m) that the head of a card of droptower's names.
pub fn thickness_of(card: &str, system: System) -> Option<f64> {
    let rest = in_head(card, "thickness of one layer ")?;
    let value: f64 = rest.split_whitespace().next()?.parse().ok()?;
    (value > 0.0 && value.is_finite()).then(|| value * system.length())
}

/// What follows `words` in a line of the head.
fn in_head<'a>(card: &'a str, words: &str) -> Option<&'a str> {
    /// Lines of a head.
    const LINES: usize = 40;
    card.lines().take(LINES).find_map(|line| Some(line.split_once(words)?.1))
}

/// Stress and strain of the law that was written.
fn measures(film: &Film<'_>, target: Target) -> &'static str {
    use membrane::material::Law;
    match &film.material.law {
        Law::Fabric(_) | Law::RateFabric(_) if target == Target::Curves => {
            "force per width of all layers over engineering strain, in shear over the angle (rad); the text of VPS' card is not \
             known here"
        }
        Law::Fabric(_) | Law::RateFabric(_) => {
            "nominal stress over engineering strain along the fibres, shear stress over shear angle"
        }
        Law::Elastic(_) | Law::TensionField(_) => "linear elastic",
        Law::Hyperelastic(_) => "an energy of the principal stretches",
        Law::Plastic(_) => "true stress over equivalent plastic strain",
    }
}

/// A name that no reader takes for a keyword or a comment.
fn title(name: &str) -> String {
    let name = ascii(name);
    if name.starts_with(|c: char| c.is_ascii_alphanumeric()) { name } else { format!("film {name}") }
}

/// One line without characters that a reader might not take.
fn ascii(text: &str) -> String {
    let replaced = text.replace('ν', "nu").replace('µ', "u").replace('–', "-").replace('°', " deg");
    replaced.chars().map(|c| if c.is_ascii() && !c.is_ascii_control() { c } else { '?' }).collect()
}
