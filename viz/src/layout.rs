//! The layout of the viewer: 3-D views and charts above, texts and events below.

use re_sdk::blueprint::{
    Blueprint, BlueprintPanel, ContainerLike, Horizontal, SelectionPanel, Spatial2DView, Spatial3DView, Tabs,
    TextDocumentView, TextLogView, TimePanel, TimeSeriesView, Vertical,
};
use re_sdk_types::VisualizableArchetype;
use re_sdk_types::archetypes::Mesh3D;
use re_sdk_types::blueprint::archetypes::{
    Background, EyeControls3D, LineGrid3D, PlotLegend, TextLogColumns, VisualBounds2D,
};
use re_sdk_types::blueprint::components::{
    BackgroundKind, Corner2D, LoopMode, PanelState, PlayState, TextLogColumn, VisualBounds2D as Bounds,
    VisualizerComponentMapping,
};
use re_sdk_types::blueprint::datatypes::{
    TextLogColumn as Column, TextLogColumnKind, VisualizerComponentMapping as Mapping,
};
use re_sdk_types::datatypes::Range2D;

use crate::blueprint::Properties;
use crate::diagram::{self, Diagram};
use crate::eye::Eye;
use crate::film::{self, COLOURS};
use crate::quantity::Quantity;
use crate::scene::{Document, Scene};
use crate::series::{Chart, TIME};

/// Playback time of a run, s.
const PLAYBACK: f64 = 6.0;

/// Most charts in a column; further ones are in tabs.
const MOST_CHARTS: usize = 4;

/// The arrangement for `scene`, and the properties of its views.
pub(crate) fn blueprint(scene: &Scene, properties: &mut Properties) -> Blueprint {
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
    let quantities: &[Quantity] = if scene.films.is_empty() { &[] } else { &scene.quantities };
    let mut tabs: Vec<ContainerLike> =
        quantities.iter().map(|quantity| coloured(scene, quantity, &eye, properties)).collect();
    tabs.extend(scene.diagrams.iter().map(|diagram| plane(diagram, properties)));
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
    for film in &scene.films {
        let visualizer = Mesh3D::update_fields().visualizer().with_mappings([mapping(quantity)]);
        properties.visualize(&view, &film::entity(film), &visualizer);
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
    Horizontal::new([view, legend]).with_column_shares(vec![7.0, 1.0]).with_name(quantity.title.as_str()).into()
}

/// Dark background in every theme, which contrasts with bright strains and steel.
fn ground() -> Background {
    Background::new(BackgroundKind::SolidColor).with_color([27, 30, 36])
}

/// Vertex colours from those of the quantity.
fn mapping(quantity: &Quantity) -> VisualizerComponentMapping {
    let target = Mesh3D::descriptor_vertex_colors().component.to_string();
    VisualizerComponentMapping(Mapping::new_source_component(target, format!("{COLOURS}:{}", quantity.key)))
}

fn charts(scene: &Scene, properties: &mut Properties) -> Vec<ContainerLike> {
    let (first, others) = scene.charts.split_at(scene.charts.len().min(MOST_CHARTS));
    let mut charts: Vec<ContainerLike> = first.iter().map(|shown| chart(shown, properties)).collect();
    let others: Vec<ContainerLike> =
        others.iter().chain(&scene.more_charts).map(|shown| chart(shown, properties)).collect();
    if !others.is_empty() {
        charts.push(Tabs::new(others).into());
    }
    charts
}

fn chart(chart: &Chart, properties: &mut Properties) -> ContainerLike {
    let contents = chart.signals.iter().map(|path| format!("+ /{path}"));
    let view = TimeSeriesView::new(chart.title.as_str()).with_contents(contents).into();
    properties.set(&view, "PlotLegend", &PlotLegend::new().with_corner(Corner2D::RightTop));
    view
}

fn plane(diagram: &Diagram, properties: &mut Properties) -> ContainerLike {
    let view = Spatial2DView::new(diagram.title.as_str()).with_origin(diagram.path.as_str()).into();
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
