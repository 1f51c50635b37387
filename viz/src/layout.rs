//! How the viewer opens: pictures and charts above, texts and events below, on the timeline that the scene has.

use re_sdk::blueprint::{
    Blueprint, BlueprintPanel, ContainerLike, Horizontal, SelectionPanel, Spatial2DView, Spatial3DView, Tabs,
    TextDocumentView, TextLogView, TimePanel, TimeSeriesView, Vertical,
};
use re_sdk_types::blueprint::components::{LoopMode, PanelState};

use crate::diagram::Diagram;
use crate::scene::{Document, Scene};
use crate::series::{Chart, ITERATION, TIME};

/// Simulated seconds a second of watching.
const PLAYBACK_SPEED: f64 = 0.02;

/// Iterations a second of watching.
const ITERATIONS_PER_SECOND: f64 = 4.0;

/// The arrangement for `scene`.
pub fn blueprint(scene: &Scene) -> Blueprint {
    let pictures = if scene.films.is_empty() {
        Tabs::new(scene.diagrams.iter().map(diagram)).into()
    } else {
        Spatial3DView::new("Scene").with_origin("scene").into()
    };
    let left = Vertical::new([pictures, texts(scene)]).with_row_shares(vec![4.0, 1.0]);
    let mut charts: Vec<ContainerLike> = scene.charts.iter().map(chart).collect();
    if !scene.films.is_empty() && !scene.diagrams.is_empty() {
        charts.push(Tabs::new(scene.diagrams.iter().map(diagram)).into());
    }
    let all = if charts.is_empty() {
        Horizontal::new([left.into()])
    } else {
        Horizontal::new([left.into(), Vertical::new(charts).into()]).with_column_shares(vec![3.0, 2.0])
    };
    Blueprint::new(all)
        .with_auto_views(false)
        .with_blueprint_panel(BlueprintPanel::from_state(PanelState::Collapsed))
        .with_selection_panel(SelectionPanel::from_state(PanelState::Collapsed))
        .with_time_panel(time_panel(scene))
}

fn time_panel(scene: &Scene) -> TimePanel {
    let panel = TimePanel::new().with_state(PanelState::Collapsed).with_loop_mode(LoopMode::All);
    if scene.films.is_empty() {
        panel.with_timeline(ITERATION).with_fps(ITERATIONS_PER_SECOND)
    } else {
        panel.with_timeline(TIME).with_playback_speed(PLAYBACK_SPEED)
    }
}

fn texts(scene: &Scene) -> ContainerLike {
    let events = TextLogView::new("Events").with_origin("events").into();
    let documents = scene.documents.iter().map(document);
    Tabs::new(std::iter::once(events).chain(documents)).into()
}

fn document(document: &Document) -> ContainerLike {
    TextDocumentView::new(document.title.as_str()).with_origin(document.path.as_str()).into()
}

fn chart(chart: &Chart) -> ContainerLike {
    let contents = chart.signals.iter().map(|path| format!("+ /{path}"));
    TimeSeriesView::new(chart.title.as_str()).with_contents(contents).into()
}

fn diagram(diagram: &Diagram) -> ContainerLike {
    Spatial2DView::new(diagram.title.as_str()).with_origin(diagram.path.as_str()).into()
}
