//! The blueprint: what the viewer shows and how, sent ahead of the data.
//!
//! The blueprint interface of the SDK cannot set properties of its views (camera, background, legends of plots), though
//! the format has them: they are logged by hand to the paths of the views, and sent together with the rest.

use re_sdk::blueprint::{Blueprint, BlueprintActivation, ContainerLike};
use re_sdk::external::re_log_types::BlueprintActivationCommand;
use re_sdk::log::LogMsg;
use re_sdk::{RecordingStream, RecordingStreamBuilder, RecordingStreamResult};
use re_sdk_types::{AsComponents, SerializedComponentBatch};

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

/// Sends the arrangement for `scene`.
pub(crate) fn send(stream: &RecordingStream, scene: &Scene) -> RecordingStreamResult<()> {
    let mut properties = Properties::default();
    let blueprint = layout::blueprint(scene, &mut properties);
    let mut messages = messages(stream, &blueprint)?;
    let Some(id) = messages.first().map(|message| message.store_id().clone()) else { return Ok(()) };
    let (own, storage) = RecordingStreamBuilder::from_store_id(&id).memory()?;
    own.set_time_sequence("blueprint", 0);
    for (path, batches) in properties.0 {
        own.log_serialized_batches(path, false, batches)?;
    }
    messages.extend(storage.take().into_iter().filter(|message| matches!(message, LogMsg::ArrowMsg(..))));
    stream.send_blueprint(messages, BlueprintActivationCommand::make_active(id));
    Ok(())
}

/// The blueprint as the SDK writes it, by way of a stream into memory.
fn messages(stream: &RecordingStream, blueprint: &Blueprint) -> RecordingStreamResult<Vec<LogMsg>> {
    let application = stream.store_info().map(|info| info.application_id().clone());
    let application = application.unwrap_or_else(|| "droptower".into());
    let (memory, storage) = RecordingStreamBuilder::new(application).enabled(true).memory()?;
    blueprint.send(&memory, BlueprintActivation::default())?;
    let all = storage.take();
    let is_wanted = |message: &LogMsg| match message {
        LogMsg::BlueprintActivationCommand(_) => false,
        message => message.store_id().is_blueprint(),
    };
    Ok(all.into_iter().filter(is_wanted).collect())
}
