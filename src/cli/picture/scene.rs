//! The scene of a run as a picture: which state, which field, from where the states are taken.

use serde_json::{Map, json};

use crate::args::quantity;
use crate::failure::hinted;
use crate::picture::args::{self, PictureArgs};
use crate::picture::{Format, Made, find, name_of, refused, unknown};
use crate::progress::Bar;
use crate::scenarios::{self, Checked};
use crate::{Failure, Shared};
use base::diagnostic::{Diagnostic, shown_path};
use base::number::{duration, significant};
use base::units::Time;
use lab::signal::column;
use picture::{ScenePicture, gltf};
use report::geometry::{FIELDS, Field, RunScene};
use report::{StoredPage, run_scene};
use scene::simulate::{self, RunError, RunOptions, Snapshot};
use study::store::{StoredRun, run_files};

/// Words for times that every run has.
const TIMES: [&str; 3] = ["first", "last", "first-contact"];

/// Digits of a figure in the line that is printed.
const DIGITS: usize = 3;

/// The scene in the state that the arguments choose: flat, or as binary glTF, which holds the figures too.
pub(super) fn draw(
    page: Result<StoredPage, Diagnostic>,
    args: &PictureArgs,
    format: Format,
    shared: &Shared,
) -> Result<Made, Failure> {
    let flat = if format == Format::Glb { None } else { Some(args::from_args(args, format)?) };
    let (title, scene) = if args.again {
        again(args, shared)?
    } else {
        let page = page?;
        let scene = page.scene()?;
        (page.title, scene)
    };
    let Chosen { state, words } = chosen(&scene, args)?;
    let field = field(&scene, args)?;
    let states = scene.states.iter().flat_map(|state| &state.films);
    let range = args.range.unwrap_or_else(|| field.range(states));
    let title = args.title.clone().unwrap_or(title);
    let caption = [duration(state.time)].into_iter().chain(words).collect::<Vec<_>>().join(", ");
    let picture = ScenePicture {
        scene: &scene,
        state,
        field,
        range,
        view: args.view.unwrap_or_default(),
        in_perspective: args.perspective,
        part: args.part,
        title: &title,
        caption: &caption,
    };
    let figures = Map::from_iter([
        ("time_s".to_owned(), json!(state.time)),
        ("field".to_owned(), json!(field.key)),
        ("range".to_owned(), json!(range)),
        ("unit".to_owned(), json!(field.unit)),
        ("coarsened".to_owned(), json!(scene.is_coarsened)),
    ]);
    let words = told(&title, &caption, field, range, args, &scene);
    let Some((style, dpi)) = flat else {
        return Ok(Made {
            content: gltf::binary(&picture.surfaces(), &picture.lines(), figures.clone()),
            words,
            figures,
        });
    };
    let made = picture.draw(&style, dpi).and_then(|drawing| Made::drawn(&drawing, format, words, figures));
    Ok(made.map_err(|error| refused(&error))?)
}

/// A description of the picture for the terminal.
fn told(title: &str, caption: &str, field: &Field, range: [f32; 2], args: &PictureArgs, scene: &RunScene) -> String {
    let [low, high] = range.map(|end| significant(f64::from(end), DIGITS));
    let kept = match &args.at {
        Some(asked) if asked.starts_with(|letter: char| letter.is_ascii_digit()) => {
            format!(" (the kept state nearest to {})", asked.trim())
        }
        _ => String::new(),
    };
    let mut text =
        format!("{title}\n  {caption}{kept}\n  {} from {low} to {high} {}", field.title.to_lowercase(), field.unit);
    if scene.is_coarsened {
        text += "\n  the page has the mesh coarsened; --again draws every element";
    }
    text
}

/// A state, and what happens there.
struct Chosen<'a> {
    state: &'a Snapshot,
    words: Option<String>,
}

fn chosen<'a>(scene: &'a RunScene, args: &PictureArgs) -> Result<Chosen<'a>, Failure> {
    let (first, last) = (&scene.states[0], &scene.states[scene.states.len() - 1]);
    let Some(asked) = args.at.as_deref().map(str::trim) else { return Ok(busiest(scene)) };
    let plain = |state| Ok(Chosen { state, words: None });
    if asked.starts_with(|letter: char| letter.is_ascii_digit() || "+-.".contains(letter)) {
        let time = quantity(Time::DIMENSION, asked).map_err(|message| Diagnostic::new(format!("--at: {message}")))?;
        // A time may be rounded, to that of a state.
        let slack = 1e-3 * (last.time - first.time);
        if time < first.time - slack || time > last.time + slack {
            let mistake = Diagnostic::new(format!("--at: {} is outside of the run", duration(time)));
            let hint = format!("its states go from {} to {}", duration(first.time), duration(last.time));
            return Err(mistake.hint(hint).into());
        }
        return plain(scene.nearest(time));
    }
    match asked {
        "first" => plain(first),
        "last" => plain(last),
        "first-contact" => {
            let state = scene.at_or_after(first_contact(args)?);
            Ok(Chosen { state, words: Some("first contact".into()) })
        }
        _ => match find(asked, scene.moments.iter().map(|moment| moment.words.as_str())) {
            Some(at) => Ok(at_moment(scene, at)),
            None => {
                let moments: Vec<String> = scene.moments.iter().map(|moment| name_of(&moment.words)).collect();
                let known = TIMES.into_iter().chain(moments.iter().map(String::as_str));
                let mistake = unknown("moment", asked, known);
                let hint = mistake.hint.as_ref().map(|hint| format!("{hint}, and times such as \"57 ms\""));
                Err(Diagnostic { hint, ..mistake }.into())
            }
        },
    }
}

fn at_moment(scene: &RunScene, at: usize) -> Chosen<'_> {
    let moment = &scene.moments[at];
    // A rupture is seen behind it.
    let is_rupture = moment.words.starts_with("rupture");
    let state = if is_rupture { scene.at_or_after(moment.time) } else { scene.nearest(moment.time) };
    let [own, time] = [state.time, moment.time].map(duration);
    let words = match own == time {
        true => moment.words.clone(),
        false if is_rupture => format!("after {} ({time})", moment.words),
        false => format!("nearest to {} ({time})", moment.words),
    };
    Chosen { state, words: Some(words) }
}

/// The lowest point or the largest force, but not after rupture, as the page shows first.
fn busiest(scene: &RunScene) -> Chosen<'_> {
    let moment = |start: &str| scene.moments.iter().position(|moment| moment.words.starts_with(start));
    let rupture = moment("rupture").map_or(f64::INFINITY, |at| scene.moments[at].time);
    let peak = moment("lowest point").or_else(|| moment("largest force"));
    match peak.filter(|at| scene.moments[*at].time <= rupture) {
        Some(at) => at_moment(scene, at),
        None => {
            let before = scene.states.iter().rfind(|state| state.time < rupture);
            Chosen { state: before.unwrap_or(&scene.states[0]), words: None }
        }
    }
}

/// Time of the first contact of any impactor, s.
fn first_contact(args: &PictureArgs) -> Result<f64, Diagnostic> {
    let run = StoredRun::read(&args.run).map_err(|error| Diagnostic::new(error.to_string()))?;
    let name = column::CONTACT_FORCE.name;
    let forces = run.signals.channels.iter().filter(|channel| channel.name.ends_with(name));
    let begins = forces.filter_map(|force| force.values.iter().position(|value| *value > 0.0));
    let first = begins.min().and_then(|at| run.signals.time.get(at));
    first.copied().ok_or_else(|| Diagnostic::new("no impactor meets the film").hint("choose another time for --at"))
}

fn field(scene: &RunScene, args: &PictureArgs) -> Result<&'static Field, Diagnostic> {
    let own: Vec<&Field> = Field::all_in(&scene.states[0].films).collect();
    if let Some(field) = own.iter().find(|field| field.key == args.field) {
        return Ok(field);
    }
    let is_known = FIELDS.iter().any(|field| field.key == args.field);
    match (is_known, args.again) {
        (false, _) => Err(unknown("field", &args.field, FIELDS.iter().map(|field| field.key))),
        (true, true) => {
            let names = own.iter().map(|field| field.key).collect::<Vec<_>>().join(", ");
            let mistake = Diagnostic::new(format!("the film of this run has no field `{}`", args.field));
            Err(mistake.hint(format!("it has {names}")))
        }
        (true, false) => {
            let mistake = Diagnostic::new(format!("the page does not hold the field `{}`", args.field));
            Err(mistake.hint("--again simulates the scenario again, which gives every field that its film has"))
        }
    }
}

/// Title and scene of the stored scenario, simulated again.
fn again(args: &PictureArgs, shared: &Shared) -> Result<(String, RunScene), Failure> {
    let path = args.run.join(run_files::SCENARIO);
    if !path.is_file() {
        let mistake = Diagnostic::new(format!("{} holds no {}", shown_path(&args.run), run_files::SCENARIO));
        return Err(mistake.hint("--again needs the folder of a run").into());
    }
    let Checked { model, plan, .. } = scenarios::check(&path, &[])?;
    let bar = Bar::new(1, shared.quiet);
    let outcome = simulate::run_with(&model, RunOptions::default(), &mut |progress| bar.show(0, progress));
    bar.finish();
    let outcome = match outcome {
        Ok(outcome) => outcome,
        // A run that failed has states until then.
        Err(RunError::Failure(failure)) => failure.so_far,
        Err(error) => return Err(hinted(&format!("{}: {error}", model.name), error.hint()).into()),
    };
    let results = plan.measure(&model, &outcome).ok();
    let signals = results.as_ref().map_or(&outcome.signals, |results| &results.signals);
    let scene = run_scene(&model, &outcome, signals);
    let scene = scene.ok_or_else(|| Diagnostic::new("the run has no snapshot"))?;
    Ok((model.title, scene))
}
