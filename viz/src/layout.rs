//! The layout of the viewer, sent ahead of the data as a blueprint: 3-D views and charts above, texts and events below.
//!
//! The blueprint interface of the SDK cannot set properties of its views (camera, background, legends of plots), though
//! the format has them: they are logged by hand to the paths of the views, and sent together with the rest.

use std::sync::{Mutex, PoisonError};

use re_sdk::blueprint::{
    Blueprint, BlueprintActivation, BlueprintPanel, ContainerLike, Horizontal, SelectionPanel, Spatial2DView,
    Spatial3DView, Tabs, TextDocumentView, TextLogView, TimePanel, TimeSeriesView, Vertical,
};
use re_sdk::external::re_log_types::BlueprintActivationCommand;
use re_sdk::log::LogMsg;
use re_sdk::sink::BufferedSink;
use re_sdk::{RecordingStream, RecordingStreamBuilder, RecordingStreamResult};
use re_sdk_types::archetypes::Mesh3D;
use re_sdk_types::blueprint::archetypes::{
    ActiveVisualizers, Background, EyeControls3D, LineGrid3D, PlotLegend, TextLogColumns, VisualBounds2D,
    VisualizerInstruction,
};
use re_sdk_types::blueprint::components::{
    BackgroundKind, Corner2D, LoopMode, PanelState, PlayState, TextLogColumn, VisualBounds2D as Bounds,
    VisualizerComponentMapping,
};
use re_sdk_types::blueprint::datatypes::{
    TextLogColumn as Column, TextLogColumnKind, VisualizerComponentMapping as Mapping,
};
use re_sdk_types::datatypes::Range2D;
use re_sdk_types::{AsComponents, SerializedComponentBatch, VisualizableArchetype, Visualizer};

use crate::diagram;
use crate::eye::Eye;
use crate::film::{self, COLOURS};
use crate::quantity::{Quantity, TIME};
use crate::scene::{Chart, Charts, Document, Scene};
use plot::Plot;

/// Playback time of a run, s.
const PLAYBACK: f64 = 6.0;

/// Most charts in a column; further ones are in tabs.
const MOST_CHARTS: usize = 4;

/// The arrangement for `scene`, and the properties of its views.
fn blueprint(scene: &Scene, properties: &mut Properties) -> Blueprint {
    let texts = texts(scene, properties);
    let left = match pictures(scene, properties) {
        Some(pictures) => Vertical::new([pictures, texts]).with_row_shares(vec![7.0, 2.0]).into(),
        None => texts,
    };
    let charts = charts(scene, properties);
    let all = if charts.is_empty() {
        Horizontal::new([left])
    } else {
        Horizontal::new([left, Vertical::new(charts).into()]).with_column_shares(vec![3.0, 2.0])
    };
    Blueprint::new(all)
        .with_auto_views(false)
        .with_blueprint_panel(BlueprintPanel::from_state(PanelState::Collapsed))
        .with_selection_panel(SelectionPanel::from_state(PanelState::Hidden))
        .with_time_panel(time_panel(scene))
}

fn time_panel(scene: &Scene) -> TimePanel {
    let panel = TimePanel::new()
        .with_state(PanelState::Collapsed)
        .with_play_state(if scene.is_live { PlayState::Following } else { PlayState::Playing })
        .with_loop_mode(LoopMode::All)
        .with_timeline(TIME);
    if scene.duration > 0.0 { panel.with_playback_speed(scene.duration / PLAYBACK) } else { panel }
}

/// A tab with the films for each quantity, beside its colour bar, and a tab for each diagram.
fn pictures(scene: &Scene, properties: &mut Properties) -> Option<ContainerLike> {
    let eye = Eye::on(scene);
    let quantities: &[Quantity] = if scene.faces.is_empty() { &[] } else { &scene.quantities };
    let mut tabs: Vec<ContainerLike> =
        quantities.iter().map(|quantity| coloured(scene, quantity, &eye, properties)).collect();
    tabs.extend(scene.diagrams.iter().enumerate().map(|(index, plot)| plane(index, plot, properties)));
    (!tabs.is_empty()).then(|| Tabs::new(tabs).into())
}

fn coloured(scene: &Scene, quantity: &Quantity, eye: &Eye, properties: &mut Properties) -> ContainerLike {
    let view = Spatial3DView::new(match scene.bodies.len() {
        0 => "Film",
        1 => "Film and impactor",
        _ => "Film and impactors",
    })
    .with_origin("/")
    .with_contents(["+ /scene/**"]);
    let view: ContainerLike = view.into();
    for face in 0..scene.faces.len() {
        let visualizer = Mesh3D::update_fields().visualizer().with_mappings([mapping(quantity)]);
        properties.visualize(&view, &format!("scene/{}", film::name(face)), &visualizer);
    }
    properties.set(
        &view,
        "EyeControls3D",
        &EyeControls3D::new().with_position(eye.position).with_look_target(eye.target).with_eye_up([0.0, 0.0, 1.0]),
    );
    properties.set(&view, "LineGrid3D", &LineGrid3D::new().with_visible(false));
    properties.set(&view, "Background", &ground());
    let legend: ContainerLike = Spatial2DView::new("").with_origin(quantity.legend()).into();
    let bounds = Range2D { x_range: [-0.05, 0.35].into(), y_range: [-0.12, 1.05].into() };
    properties.set(&legend, "VisualBounds2D", &VisualBounds2D::new(Bounds(bounds)));
    properties.set(&legend, "Background", &ground());
    Horizontal::new([view, legend]).with_column_shares(vec![7.0, 1.0]).with_name(quantity.field.title).into()
}

/// Dark background in every theme, which contrasts with bright strains and steel.
fn ground() -> Background {
    Background::new(BackgroundKind::SolidColor).with_color([27, 30, 36])
}

/// Vertex colours from those of the quantity.
fn mapping(quantity: &Quantity) -> VisualizerComponentMapping {
    let target = Mesh3D::descriptor_vertex_colors().component.to_string();
    VisualizerComponentMapping(Mapping::new_source_component(target, format!("{COLOURS}:{}", quantity.field.key)))
}

fn charts(scene: &Scene, properties: &mut Properties) -> Vec<ContainerLike> {
    let Charts { beside, tabs } = &scene.charts;
    let (first, others) = beside.split_at(beside.len().min(MOST_CHARTS));
    let mut charts: Vec<ContainerLike> = first.iter().map(|shown| chart(shown, properties)).collect();
    let others: Vec<ContainerLike> = others.iter().chain(tabs).map(|shown| chart(shown, properties)).collect();
    if !others.is_empty() {
        charts.push(Tabs::new(others).into());
    }
    charts
}

fn chart(chart: &Chart, properties: &mut Properties) -> ContainerLike {
    let contents = chart.tracks.iter().map(|track| format!("+ /{}", track.path));
    let view = TimeSeriesView::new(chart.title.as_str()).with_contents(contents).into();
    properties.set(&view, "PlotLegend", &PlotLegend::new().with_corner(Corner2D::RightTop));
    view
}

fn plane(index: usize, plot: &Plot, properties: &mut Properties) -> ContainerLike {
    let view = Spatial2DView::new(plot.title.as_str()).with_origin(diagram::entity(index)).into();
    let [x_range, y_range] = diagram::BOUNDS;
    let bounds = Range2D { x_range: x_range.into(), y_range: y_range.into() };
    properties.set(&view, "VisualBounds2D", &VisualBounds2D::new(Bounds(bounds)));
    view
}

fn texts(scene: &Scene, properties: &mut Properties) -> ContainerLike {
    let events = (!scene.events.is_empty()).then(|| events(properties));
    let documents = scene.documents.iter().map(document);
    Tabs::new(events.into_iter().chain(documents)).into()
}

/// The log with level and text, which one entity holds.
fn events(properties: &mut Properties) -> ContainerLike {
    let view = TextLogView::new("Events").with_origin("events").into();
    let column = |kind, visible: bool| TextLogColumn(Column { kind, visible: visible.into() });
    let columns = [
        column(TextLogColumnKind::EntityPath, false),
        column(TextLogColumnKind::LogLevel, true),
        column(TextLogColumnKind::Body, true),
    ];
    properties.set(&view, "TextLogColumns", &TextLogColumns::new().with_text_log_columns(columns));
    view
}

fn document(document: &Document) -> ContainerLike {
    TextDocumentView::new(document.title.as_str()).with_origin(document.path.as_str()).into()
}

/// Properties of the views of a blueprint.
#[derive(Default)]
struct Properties(Vec<(String, Vec<SerializedComponentBatch>)>);

impl Properties {
    /// Gives `view` a property; `name` is that of its archetype.
    fn set(&mut self, view: &ContainerLike, name: &str, property: &dyn AsComponents) {
        if let ContainerLike::View(view) = view {
            self.0.push((format!("{}/{name}", view.blueprint_path()), property.as_serialized_batches()));
        }
    }

    /// Shows the entity at a path in `view` by a visualizer of its own.
    fn visualize(&mut self, view: &ContainerLike, entity: &str, visualizer: &Visualizer) {
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
    let blueprint = blueprint(scene, &mut properties);
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
