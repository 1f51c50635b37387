//! What of a run is drawn, self-contained pages of runs, studies and comparisons, and the series for ParaView.
#![warn(missing_docs)]

mod coarse;
pub mod compare_page;
mod drawn;
pub mod drop_page;
mod error_maps;
mod figure;
mod film;
mod film_data;
mod fit_page;
pub mod geometry;
mod html;
pub mod panes;
mod progress_page;
mod run_page;
mod script_output;
mod stored;
mod study_page;
mod sweep_page;
mod test_page;
pub mod vtu;

pub use crate::compare_page::compare_page;
pub use crate::drawn::figures;
pub use crate::drop_page::{DropPage, DropScatter, DropTest, FigureScatter, drop_page};
pub use crate::figure::{Figure, G, escaped, markdown};
pub use crate::film::run_scene;
pub use crate::fit_page::{FitPage, FitTable, fit_page};
pub use crate::html::page;
pub use crate::progress_page::{Counts, Pace, PageTime, StudyCall, StudyProgress, StudyState, ended_page};
pub use crate::run_page::{RunPage, run_page};
pub use crate::script_output::{cell, columns};
pub use crate::stored::StoredPage;
pub use crate::study_page::{StudyPage, study_answer, study_page};
pub use crate::sweep_page::{SweepPage, sweep_answer, sweep_page};
pub use crate::test_page::test_page;
