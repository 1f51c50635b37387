//! `droptower export deck`: a whole test for another solver.

use std::path::{Path, PathBuf};
use std::{fs, io};

use clap::Args;
use serde_json::json;

use crate::export::{self, RequestArgs};
use crate::{Failure, Shared, output, print_figures, terminal};
use ::card::Film;
use ::card::deck::{self, Body, Deck, DeckLoss, FILES, Face, File, Shape, stress_free};
use base::diagnostic::{Diagnostic, folder_of, shown_path};
use base::finding::Finding;
use base::scratch::ScratchFolder;
use membrane::engine::{GuideFriction, Mesh};
use scene::model::{self, Guide, Hold, Impactor, ImpactorShape, Model};
use scene::scenario::Document;
use scene::{mesh, simulate};

/// The options of `export deck`.
#[derive(Debug, Args)]
pub(crate) struct DeckArgs {
    /// A scenario, or the folder of a run
    pub scenario: PathBuf,
    /// The folder to write
    #[arg(long, short, value_name = "FOLDER")]
    pub out: PathBuf,
    #[command(flatten)]
    pub request: RequestArgs,
    /// Replace the deck in the folder
    #[arg(long)]
    pub force: bool,
}

pub(crate) fn run(args: &DeckArgs, shared: &Shared) -> Result<(), Failure> {
    check_folder(&args.out, args.force)?;
    let file = if args.scenario.is_dir() { export::in_folder(&args.scenario)? } else { args.scenario.clone() };
    let test = Test::read(&file)?;
    let origin = export::origin(&Document::read(&file)?)?;
    let deck = test.deck(&origin)?;
    let written = deck::write(&deck, &args.request.request()).map_err(|refusal| export::refused(&file, refusal))?;
    write_folder(&args.out, &written.files)?;
    let of_deck = written.losses.iter().map(Finding::new);
    let findings: Vec<Finding> = of_deck.chain(written.card_losses.iter().map(Finding::new)).collect();
    let files: Vec<&str> = written.files.iter().map(|file| file.name).collect();
    let (out, title) = (shown_path(&args.out), deck.title);
    let (target, units) = (args.request.target.name(), args.request.units.name());
    let nodes: usize = deck.faces.iter().map(|face| face.mounted.len()).sum();
    let elements: usize = deck.faces.iter().map(|face| face.quads.len() + face.tris.len()).sum();
    let figures = json!({
        "out": out,
        "files": files,
        "target": target,
        "units": units,
        "title": title,
        "nodes": nodes,
        "elements": elements,
        "findings": findings,
    });
    print_figures(shared, &figures, || {
        format!(
            "{title} for {target}, {units}: {nodes} nodes and {elements} elements of film\n{}  {out}: {}",
            terminal::findings("  ", &findings),
            files.join("  ")
        )
    })
}

/// Refuses a folder that holds anything, unless `force` is given and it is a deck; a deck is given to a solver, so it has none of
/// the files by which `study::store` knows its own folders.
fn check_folder(out: &Path, force: bool) -> Result<(), Failure> {
    let shown = shown_path(out);
    let refused = |message: String, hint: &str| Err(Failure::from(Diagnostic::new(message).hint(hint)));
    if out.file_name().is_none() {
        return refused(format!("{shown} does not name a folder of its own"), "give a new folder, such as deck");
    }
    let entries = match fs::read_dir(out) {
        Ok(entries) => entries,
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(()),
        Err(error) if error.kind() == io::ErrorKind::NotADirectory => {
            return refused(format!("{shown} is not a folder"), "give another name");
        }
        Err(error) => return Err(output::failed(out, &error)),
    };
    let mut is_empty = true;
    for entry in entries {
        let name = entry.map_err(|error| output::failed(out, &error))?.file_name();
        let name = name.to_string_lossy();
        if !FILES.contains(&&*name) {
            return refused(format!("{shown} holds `{name}`, which is no file of a deck"), "give another folder");
        }
        is_empty = false;
    }
    if is_empty || force {
        return Ok(());
    }
    refused(format!("{shown} holds a deck and is not replaced"), "give another folder, or --force")
}

/// Writes a folder beside `out` that replaces it when it is complete.
fn write_folder(out: &Path, files: &[File]) -> Result<(), Failure> {
    let written = || -> io::Result<()> {
        let parent = folder_of(out);
        fs::create_dir_all(parent)?;
        let mut draft = ScratchFolder::new(parent)?;
        let deck = draft.path().to_path_buf();
        for File { name, text } in files {
            fs::write(deck.join(name), text)?;
        }
        let former = ScratchFolder::new(parent)?;
        let replaced = if out.exists() { Some(former.former(out)?) } else { None };
        if let Some(place) = &replaced {
            fs::rename(out, place)?;
        }
        if let Err(error) = fs::rename(&deck, out) {
            // Dropping the temporary folder would delete the former deck.
            if replaced.is_some_and(|place| fs::rename(place, out).is_err()) {
                former.keep();
            }
            return Err(error);
        }
        draft.renamed();
        Ok(())
    };
    written().map_err(|error| output::failed(out, &error))
}

/// A test that can be a deck.
struct Test {
    model: Model,
    meshes: Vec<Mesh>,
    /// Of the film of each face.
    names: Vec<String>,
    gravity: f64,
    file: String,
}

/// A height that is round-off, m.
const ROUND_OFF: f64 = 1e-9;

impl Test {
    /// Reads, checks and meshes a scenario.
    ///
    /// # Errors
    /// It has mistakes, or is no impact.
    fn read(file: &Path) -> Result<Test, Failure> {
        let document = Document::read(file)?;
        let shown = shown_path(file);
        let model = model::check(&document)?;
        simulate::check(&document, &model)?;
        let Some(impact) = model.loading.impact() else {
            let mistake = Diagnostic::new(format!("{shown} is no impact: its loading is `{}`", model.loading.name()));
            return Err(mistake.hint("decks are written of tests in which impactors fall onto film").into());
        };
        let gravity = impact.gravity;
        let mirrors = model.specimen.symmetry.mirrors();
        let build = |face: &model::Face| {
            mesh::build(&model.specimen.shape, mirrors, &face.meshing)
                .map_err(|error| Diagnostic::new(format!("{shown}: {error}")))
        };
        let meshes = model.faces.iter().map(build).collect::<Result<Vec<Mesh>, Diagnostic>>()?;
        let name = |face: &model::Face| face.film.clone().unwrap_or_else(|| document.name());
        let names = model.faces.iter().map(name).collect();
        Ok(Test { model, meshes, names, gravity, file: shown })
    }

    /// The test in the terms of other solvers; `origin` says what it was made from.
    ///
    /// # Errors
    /// An impactor or the mounting has no counterpart.
    fn deck<'a>(&'a self, origin: &'a [String]) -> Result<Deck<'a>, Diagnostic> {
        let model = &self.model;
        let faces: Vec<Face<'a>> = (0..model.faces.len()).map(|place| self.face(place)).collect::<Result<_, _>>()?;
        let bodies = model.impactors.iter().map(|impactor| self.body(impactor, &faces)).collect::<Result<_, _>>()?;
        Ok(Deck {
            title: &model.title,
            origin,
            faces,
            bodies,
            mirrored: model.specimen.symmetry.mirrors(),
            gravity: self.gravity,
            duration: model.run_time(),
            interval: 1.0 / model.output.sample_rate,
            losses: losses(model),
        })
    }

    fn refused(&self, what: impl std::fmt::Display, hint: &str) -> Diagnostic {
        Diagnostic::new(format!("{}: {what}", self.file)).hint(hint.to_owned())
    }

    fn face(&self, place: usize) -> Result<Face<'_>, Diagnostic> {
        let (face, mesh) = (&self.model.faces[place], &self.meshes[place]);
        let mounted: Vec<[f64; 3]> = mesh.nodes.iter().map(|node| [node.x, node.y, node.z + face.height]).collect();
        let is_flat = mounted.iter().all(|node| (node[2] - mounted[0][2]).abs() <= ROUND_OFF);
        if !is_flat && face.prestrain != [0.0; 2] {
            let what = format!("face {} is not flat, and has pre-strain", place + 1);
            return Err(self.refused(what, "leave `prestrain` out: film that is not flat has no one stress-free shape"));
        }
        Ok(Face {
            film: Film { name: &self.names[place], material: &face.material, origin: &[] },
            layers: face.layers,
            stress_free: stress_free(&mounted, face.md_angle, face.prestrain),
            mounted,
            quads: mesh.quads.clone(),
            tris: mesh.tris.clone(),
            held: held(mesh, &self.model.frame.hold),
            md_angle: face.md_angle,
        })
    }

    fn body(&self, impactor: &Impactor, faces: &[Face<'_>]) -> Result<Body, Diagnostic> {
        let name = impactor.words();
        let (shape, tip) = match impactor.shape {
            ImpactorShape::Sphere { radius } => (Shape::Sphere { radius }, radius),
            ImpactorShape::Hemisphere { radius, length } | ImpactorShape::Capsule { radius, length } => {
                (Shape::Capsule { radius, length }, radius + 0.5 * length)
            }
            _ => {
                let what = format!("the shape of {name} has no counterpart in a deck");
                return Err(self.refused(what, "spheres, hemispheres and capsules have one"));
            }
        };
        let is_upright = matches!(shape, Shape::Sphere { .. }) || impactor.orientation == [0.0; 3];
        if !is_upright {
            return Err(self.refused(format!("{name} is inclined"), "leave `orientation` out"));
        }
        let is_guided = match impactor.guide {
            Guide::Z => true,
            Guide::Free => false,
            Guide::Fixed | Guide::Line(_) | Guide::Hinge { .. } => {
                let what = format!("the guide of {name} has no counterpart in a deck");
                return Err(self.refused(what, "guides \"z\" and \"free\" have one"));
            }
        };
        if impactor.release > 0.0 {
            return Err(self.refused(format!("{name} is released later"), "leave `release` out"));
        }
        let moments = match impactor.inertia {
            Some(moments) => moments,
            None => {
                let surface =
                    simulate::surface(&impactor.shape).map_err(|error| self.refused(error, "draw another body"))?;
                let per_mass = surface.inertia_per_mass();
                [0, 1, 2].map(|axis| per_mass[(axis, axis)] * impactor.mass)
            }
        };
        let copies = self.model.specimen.symmetry.copies();
        // Where it is in contact with the highest point of the first face.
        let heights = faces[0].mounted.iter().map(|node| node[2]);
        let top = heights.fold(f64::NEG_INFINITY, f64::max) + 0.5 * faces[0].thickness();
        let [x, y] = impactor.position;
        let between = self.model.contact.film_friction.unwrap_or(impactor.friction);
        Ok(Body {
            name: name.to_owned(),
            shape,
            mass: impactor.mass / copies,
            inertia: moments.map(|moment| moment / copies),
            position: [x, y, impactor.height.unwrap_or(top + tip)],
            velocity: impactor.velocity,
            is_guided,
            friction: (0..faces.len()).map(|face| if face == 0 { impactor.friction } else { between }).collect(),
        })
    }
}

/// Axes along which the frame and mirror planes hold each node.
fn held(mesh: &Mesh, hold: &Hold) -> Vec<[bool; 3]> {
    let mut held = vec![[false; 3]; mesh.nodes.len()];
    for (axis, plane) in mesh.mirrors.iter().enumerate() {
        plane.iter().for_each(|node| held[*node as usize][axis] = true);
    }
    hold.nodes(mesh).into_iter().flatten().for_each(|node| held[*node as usize] = [true; 3]);
    held
}

/// What a scenario has and a deck does not.
fn losses(model: &Model) -> Vec<DeckLoss> {
    let impactors = &model.impactors;
    let all = [
        (model.frame.bars.is_some(), DeckLoss::Bars),
        (model.frame.clamp.is_some(), DeckLoss::Clamp),
        (model.frame.springs.is_some(), DeckLoss::Springs),
        (model.air.is_some(), DeckLoss::Air),
        (model.contact.film || model.contact.itself, DeckLoss::FilmContact),
        (impactors.len() > 1, DeckLoss::BodyContact),
        (impactors.iter().any(|one| one.guide_friction != GuideFriction::default()), DeckLoss::GuideFriction),
        (impactors.iter().any(|one| one.spin != [0.0; 3]), DeckLoss::Spin),
        (model.faces.iter().any(|face| face.settle), DeckLoss::Settling),
        (!model.specimen.cuts.is_empty(), DeckLoss::Cuts),
        (model.solver.smallest_step.is_some(), DeckLoss::AddedMass),
        (model.specimen.damping > 0.0, DeckLoss::Damping),
    ];
    all.into_iter().filter(|(is_lost, _)| *is_lost).map(|(_, loss)| loss).collect()
}
