//! How the viewer opens: the scene left, diagrams right, log and summary below.

use re_sdk::blueprint::{
    Blueprint, BlueprintPanel, ContainerLike, Horizontal, SelectionPanel, Spatial3DView, Tabs, TextDocumentView,
    TextLogView, TimePanel, TimeSeriesView, Vertical,
};
use re_sdk_types::blueprint::components::{LoopMode, PanelState};

use crate::TIMELINE;
use crate::scene::{Plot, Scene};

/// Simulated seconds a second of watching.
const PLAYBACK_SPEED: f64 = 0.02;

/// The arrangement for `scene`.
pub fn blueprint(scene: &Scene) -> Blueprint {
    let picture = Spatial3DView::new("Scene").with_origin("scene");
    let texts = Tabs::new([
        TextLogView::new("Events").with_origin("events").into(),
        TextDocumentView::new("Summary").with_origin("summary").into(),
    ]);
    let left = Vertical::new([picture.into(), texts.into()]).with_row_shares(vec![4.0, 1.0]);
    let plots: Vec<ContainerLike> = scene.plots.iter().map(diagram).collect();
    let all = if plots.is_empty() {
        Horizontal::new([left.into()])
    } else {
        Horizontal::new([left.into(), Vertical::new(plots).into()]).with_column_shares(vec![3.0, 2.0])
    };
    Blueprint::new(all)
        .with_auto_views(false)
        .with_blueprint_panel(BlueprintPanel::from_state(PanelState::Collapsed))
        .with_selection_panel(SelectionPanel::from_state(PanelState::Collapsed))
        .with_time_panel(
            TimePanel::new()
                .with_state(PanelState::Collapsed)
                .with_timeline(TIMELINE)
                .with_playback_speed(PLAYBACK_SPEED)
                .with_loop_mode(LoopMode::All),
        )
}

fn diagram(plot: &Plot) -> ContainerLike {
    let contents = plot.signals.iter().map(|path| format!("+ /{path}"));
    TimeSeriesView::new(plot.title.as_str()).with_contents(contents).into()
}
