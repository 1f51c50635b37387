//! The blueprint: what the viewer shows and how, sent ahead of the data.
//!
//! The blueprint interface of the SDK cannot set properties of its views (camera, background, legends of plots), though
//! the format has them: they are logged by hand to the paths of the views, and sent together with the rest.

use std::sync::{Mutex, PoisonError};

use re_sdk::blueprint::{Blueprint, BlueprintActivation, ContainerLike};
use re_sdk::external::re_log_types::BlueprintActivationCommand;
use re_sdk::log::LogMsg;
use re_sdk::sink::BufferedSink;
use re_sdk::{RecordingStream, RecordingStreamBuilder, RecordingStreamResult};
use re_sdk_types::blueprint::archetypes::{ActiveVisualizers, VisualizerInstruction};
use re_sdk_types::{AsComponents, SerializedComponentBatch, Visualizer};

use crate::layout;
use crate::scene::Scene;

/// Properties of the views of a blueprint.
#[derive(Default)]
pub(crate) struct Properties(Vec<(String, Vec<SerializedComponentBatch>)>);

impl Properties {
    /// Gives `view` a property; `name` is that of its archetype.
    pub(crate) fn set(&mut self, view: &ContainerLike, name: &str, property: &dyn AsComponents) {
        if let ContainerLike::View(view) = view {
            self.0.push((format!("{}/{name}", view.blueprint_path()), property.as_serialized_batches()));
        }
    }
}

impl Properties {
    /// Shows the entity at a path in `view` by a visualizer of its own.
    pub(crate) fn visualize(&mut self, view: &ContainerLike, entity: &str, visualizer: &Visualizer) {
        let ContainerLike::View(view) = view else { return };
        // As `ViewContents::blueprint_base_visualizer_path_for_entity` of the SDK, whose identifier of the view is hidden.
        let place = format!("{}/ViewContents/overrides/{entity}/visualizers", view.blueprint_path());
        let instruction = VisualizerInstruction::new(visualizer.visualizer_type.clone());
        let instruction = instruction.with_component_map(visualizer.mappings.clone());
        self.0.push((format!("{place}/{}", visualizer.id.0), instruction.as_serialized_batches()));
        self.0.push((place, ActiveVisualizers::new([visualizer.id]).as_serialized_batches()));
    }
}

/// Sends the arrangement for `scene`.
pub(crate) fn send(stream: &RecordingStream, scene: &Scene) -> RecordingStreamResult<()> {
    let mut properties = Properties::default();
    let blueprint = layout::blueprint(scene, &mut properties);
    let Arrangement { ids, mut messages, .. } = arrangement(stream, &blueprint)?;
    let Some(id) = messages.first().map(|message| message.store_id().clone()) else { return Ok(()) };
    let own = logged(RecordingStreamBuilder::from_store_id(&id), |own| {
        own.set_time_sequence("blueprint", 0);
        properties.0.into_iter().try_for_each(|(path, batches)| {
            let path = ids.iter().fold(path, |path, [here, there]| path.replace(here, there));
            own.log_serialized_batches(path, false, batches)
        })
    })?;
    messages.extend(own.into_iter().filter(|message| matches!(message, LogMsg::ArrowMsg(..))));
    stream.send_blueprint(messages, BlueprintActivationCommand::make_active(id));
    Ok(())
}

/// A blueprint as the SDK writes it.
#[derive(Clone)]
struct Arrangement {
    /// The blueprint as a text without its random identifiers.
    layout: String,
    /// Identifiers of a blueprint, each with that in the messages.
    ids: Vec<[String; 2]>,
    messages: Vec<LogMsg>,
}

/// Most arrangements that are kept.
const MOST_KEPT: usize = 64;

/// The messages of `blueprint`, or those of an earlier one that differs in its identifiers only.
///
/// The SDK makes them in a stream that holds itself (0.36), so that its two threads never end: hundreds of runs with the same
/// layout would leave as many.
fn arrangement(stream: &RecordingStream, blueprint: &Blueprint) -> RecordingStreamResult<Arrangement> {
    static KEPT: Mutex<Vec<Arrangement>> = Mutex::new(Vec::new());
    let (layout, ids) = without_ids(&format!("{blueprint:?}"));
    let mut kept = KEPT.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(known) = kept.iter().find(|known| known.layout == layout) {
        let pairs = ids.into_iter().zip(&known.ids).map(|(here, [_, there])| [here, there.clone()]);
        return Ok(Arrangement { ids: pairs.collect(), ..known.clone() });
    }
    let application = stream.store_info().map(|info| info.application_id().clone());
    let application = application.unwrap_or_else(|| "droptower".into());
    let all = logged(RecordingStreamBuilder::new(application).enabled(true), |memory| {
        blueprint.send(memory, BlueprintActivation::default())
    })?;
    let is_wanted = |message: &LogMsg| match message {
        LogMsg::BlueprintActivationCommand(_) => false,
        message => message.store_id().is_blueprint(),
    };
    let ids = ids.into_iter().map(|id| [id.clone(), id]).collect();
    let new = Arrangement { layout, ids, messages: all.into_iter().filter(is_wanted).collect() };
    if kept.len() < MOST_KEPT {
        kept.push(new.clone());
    }
    Ok(new)
}

/// The messages of what `log` logs, by way of a stream into memory.
fn logged(
    builder: RecordingStreamBuilder,
    log: impl FnOnce(&RecordingStream) -> RecordingStreamResult<()>,
) -> RecordingStreamResult<Vec<LogMsg>> {
    let (memory, storage) = builder.memory()?;
    let done = log(&memory);
    let messages = storage.take();
    // A sink in memory holds its stream, and the stream its sink: without another in its place both would stay.
    memory.set_sink(Box::new(BufferedSink::new()));
    done.map(|()| messages)
}

/// The text without the identifiers (UUID) in it, and these in their order, each once.
fn without_ids(text: &str) -> (String, Vec<String>) {
    let is_of_id = |letter: char| letter.is_ascii_hexdigit() || letter == '-';
    let is_id = |word: &&str| word.len() == 36 && [8, 13, 18, 23].iter().all(|dash| word.as_bytes()[*dash] == b'-');
    let mut ids: Vec<String> = Vec::new();
    for id in text.split(|letter| !is_of_id(letter)).filter(is_id) {
        if !ids.iter().any(|known| known == id) {
            ids.push(id.to_owned());
        }
    }
    let numbered = |text: String, (place, id): (usize, &String)| text.replace(id, &format!("id {place}"));
    (ids.iter().enumerate().fold(text.to_owned(), numbered), ids)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn layouts_are_the_same_whatever_their_identifiers() {
        let text = |first: char, second: char| {
            let id = |digit: char| [8, 4, 4, 4, 12].map(|count| digit.to_string().repeat(count)).join("-");
            format!(
                "View {{ id: {}, contents: [\"view/{}\", \"{}\"], shares: [-1.5e-3] }}",
                id(first),
                id(second),
                id(first)
            )
        };
        let [(one, ids), (other, others)] = [without_ids(&text('a', '1')), without_ids(&text('0', 'f'))];
        assert_eq!(one, "View { id: id 0, contents: [\"view/id 1\", \"id 0\"], shares: [-1.5e-3] }");
        assert_eq!(one, other);
        assert_eq!((ids.len(), others[1].chars().next()), (2, Some('f')));
    }
}
