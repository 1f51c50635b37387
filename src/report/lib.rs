//! Self-contained pages of runs, studies and comparisons, their recordings, and the series for ParaView.
#![warn(missing_docs)]

mod body;
mod convergence;
pub mod compare_page;
mod field;
mod figure;
mod film;
mod fit_page;
mod script_output;
mod html;
mod key_figures;
mod drawn;
pub mod drop_page;
mod error_maps;
mod panes;
#[cfg(feature = "rerun")]
pub mod recording;
mod run_page;
mod run_plots;
mod run_scene;
mod stored;
mod table;
mod ranges;
mod progress_page;
mod study_page;
mod sweep_page;
mod test_page;
pub mod vtu;

pub use compare_page::compare_page;
pub use field::{FIELDS, Field};

pub use drawn::figures;
pub use drop_page::{DropPage, DropScatter, DropTest, FigureScatter, drop_page};
pub use figure::{Figure, G, markdown};
pub use film::{FilmError, run_scene};
pub use fit_page::{FitPage, FitTable, fit_page};
pub use html::page;
pub use progress_page::{PageTime, StudyCall, StudyProgress, StudyState, ended_page};
pub use run_page::{RunPage, run_page};
pub use run_scene::{Moment, RunScene, SceneBody, SceneFace};
pub use script_output::{cell, columns};
pub use stored::{StoredPage, StoredPageError};
pub use study_page::{StudyPage, study_page};
pub use sweep_page::{SweepPage, sweep_page};
pub use test_page::test_page;
