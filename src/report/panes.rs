//! Panes of signals: one table, from which the plots of a run's page and the charts of its recording follow.

use lab::signal::column::{self, COLUMNS, Column};
use lab::signal::{Recording, Series};
use study::post::ReferenceComparison;

/// Signals in one plot. A run has the panes for which it has channels.
pub struct Pane {
    /// With [`IMPACTORS`] in the place of the word for them: then only runs with impactors have it.
    title: &'static str,
    /// Where it is shown.
    pub shown: Shown,
    /// The column along x; none for time.
    pub over: Option<Column>,
    /// The columns along y, each with the label of its curve; of one alone there is none.
    pub columns: Vec<(Column, Option<&'static str>)>,
    /// What was measured of it.
    pub measured: &'static [Measured],
}

/// Where a pane is shown.
#[derive(Clone, Copy, PartialEq)]
pub enum Shown {
    /// On the page alone.
    Page,
    /// In the recording alone, beside the film.
    Beside,
    /// In the recording alone, in a tab.
    Tab,
    /// On the page, and in a tab of the recording.
    PageAndTab,
}

/// A measured signal.
pub struct Measured {
    /// The column that it is compared with.
    pub column: Column,
    /// The beginning of its label.
    pub label: &'static str,
    /// Its series in a reference.
    pub series: fn(&ReferenceComparison) -> Option<&Series>,
}

/// A channel of a run in a pane.
pub struct PaneCurve<'a> {
    /// Its column.
    pub column: Column,
    /// The beginning of the names of the channels of its impactor; empty of a single one, and of film and frame.
    pub prefix: &'a str,
    /// Its label.
    pub label: String,
    /// Its values, SI.
    pub values: &'a [f64],
}

/// The word for the impactors in a title: "impactor", or "impactors" of several.
const IMPACTORS: &str = "{impactors}";

/// The label of a curve that is the only one of its pane.
const SIMULATED: &str = "simulated";

const MEASURED_DISPLACEMENT: Measured =
    Measured { column: column::DISPLACEMENT, label: "", series: |c| c.displacement.as_ref() };
const MEASURED_ACCELERATION: Measured =
    Measured { column: column::ACCELERATION_FILTERED, label: "", series: |c| c.acceleration.as_ref() };
const MEASURED_LOSS: Measured =
    Measured { column: column::ABSORBED_ENERGY, label: "", series: |c| c.absorbed_energy.as_ref() };
const MEASURED_TOTAL: Measured =
    Measured { column: column::TOTAL_ENERGY, label: "total, ", series: |c| c.total_energy.as_ref() };

const MEASURED_ENERGIES: [Measured; 2] =
    [Measured { label: "absorbed by the film, ", ..MEASURED_LOSS }, MEASURED_TOTAL];

/// Load over travel in slow tests, as one column over another with the title of its plot.
pub(crate) const CHARACTERISTICS: [(&str, [Column; 2]); 4] = [
    ("Stress and strain", [column::STRAIN, column::STRESS]),
    ("Force and travel", [Column { axis: "travel of the jaws (mm)", ..column::DISPLACEMENT }, column::FORCE]),
    ("Force and depth", [column::DEPTH, column::FORCE]),
    ("Pressure and deflection", [column::DEFLECTION, column::PRESSURE]),
];

/// All panes, in the order in which they are shown: of impactors and loadings the rows of this table, of film and frame
/// those of the table of columns.
pub fn panes() -> impl Iterator<Item = Pane> {
    use Shown::{Beside, Page, PageAndTab, Tab};
    let of_loadings = [
        Pane::from_columns("Acceleration", Beside, &[column::ACCELERATION_FILTERED, column::ACCELERATION])
            .labelled(&["simulated, filtered", "simulated, raw"])
            .with(&[MEASURED_ACCELERATION]),
        Pane::from_columns("Displacement", Beside, &[column::DISPLACEMENT, column::DEPTH, column::DEFLECTION])
            .with(&[MEASURED_DISPLACEMENT]),
        Pane::from_columns(
            "Energy of the {impactors}",
            Beside,
            &[column::KINETIC_ENERGY, column::POTENTIAL_ENERGY, column::ABSORBED_ENERGY, column::TOTAL_ENERGY],
        )
        .labelled(&["kinetic", "potential", "absorbed by the film", "total"])
        .with(&MEASURED_ENERGIES),
        Pane::from_columns("Force", Beside, &[column::FORCE]),
        Pane::from_columns("Stress", Beside, &[column::STRESS]),
        Pane::from_columns("Strain", Beside, &[column::STRAIN]),
        Pane::from_columns("Pressure", Beside, &[column::PRESSURE]),
        // Figures 23 to 27 of the paper.
        Pane::from_columns("Displacement of the {impactors}", Page, &[column::DISPLACEMENT])
            .with(&[MEASURED_DISPLACEMENT]),
        Pane::from_columns("Acceleration of the {impactors}", Page, &[column::ACCELERATION_FILTERED])
            .with(&[MEASURED_ACCELERATION]),
        Pane::from_columns("Energy loss of the {impactors}", Page, &[column::ABSORBED_ENERGY]).with(&[MEASURED_LOSS]),
        Pane::from_columns(
            "Total energy of the {impactors}",
            Page,
            &[column::KINETIC_ENERGY, column::POTENTIAL_ENERGY, column::TOTAL_ENERGY],
        )
        .labelled(&["kinetic", "potential", "total"])
        .with(&[MEASURED_TOTAL]),
        Pane::against("Force and travel", [column::DISPLACEMENT, column::CONTACT_FORCE]),
        Pane::from_columns("Contact force", PageAndTab, &[column::CONTACT_FORCE]),
        Pane::from_columns("Largest strain of the film", PageAndTab, &[column::MAX_STRAIN_MD, column::MAX_STRAIN_TD])
            .labelled(&["along MD", "along TD"]),
        Pane::from_columns("Acceleration before the filter", Page, &[column::ACCELERATION]),
        Pane::from_columns("Force of the impactors on each other", PageAndTab, &[column::COLLISION_FORCE]),
        Pane::from_columns("Velocity", Tab, &[column::VELOCITY]),
        Pane::from_columns(
            "Displacement of the {impactors} along x and y",
            PageAndTab,
            &[column::DISPLACEMENT_X, column::DISPLACEMENT_Y],
        )
        .labelled(&["along x", "along y"]),
        Pane::from_columns("Size of the acceleration before the filter", PageAndTab, &[column::ACCELERATION_RESULTANT]),
    ];
    let characteristics = CHARACTERISTICS.into_iter().map(|(title, columns)| Pane::against(title, columns));
    let deflection = Pane::from_columns("Deflection of the highest point", Page, &[column::DEFLECTION]);
    of_loadings.into_iter().chain(characteristics).chain([deflection]).chain(of_columns())
}

/// The panes of film and frame: consecutive columns with the same title share one.
fn of_columns() -> Vec<Pane> {
    let mut panes: Vec<Pane> = vec![];
    for column in COLUMNS {
        let Some(curve) = column.curve else { continue };
        match panes.last_mut().filter(|pane| pane.title == curve.title) {
            Some(pane) => pane.columns.push((*column, curve.label)),
            None => panes.push(Pane {
                columns: vec![(*column, curve.label)],
                ..Pane::from_columns(curve.title, Shown::PageAndTab, &[])
            }),
        }
    }
    panes
}

impl Pane {
    fn from_columns(title: &'static str, shown: Shown, columns: &[Column]) -> Pane {
        let columns = columns.iter().map(|column| (*column, None)).collect();
        Pane { title, shown, over: None, columns, measured: &[] }
    }

    fn against(title: &'static str, [x, y]: [Column; 2]) -> Pane {
        Pane { over: Some(x), ..Pane::from_columns(title, Shown::Page, &[y]) }
    }

    fn labelled(mut self, labels: &[&'static str]) -> Pane {
        self.columns.iter_mut().zip(labels).for_each(|((_, own), label)| *own = Some(label));
        self
    }

    fn with(self, measured: &'static [Measured]) -> Pane {
        Pane { measured, ..self }
    }

    /// Its title in a run with `signals`; none where it names impactors and there are none.
    pub fn title(&self, signals: &Recording) -> Option<String> {
        if !self.title.contains(IMPACTORS) {
            return Some(self.title.to_owned());
        }
        // The displacement may be that of jaws.
        let of_impactor = |column: &Column| column.is_of_each_impactor && *column != column::DISPLACEMENT;
        let prefix = |name| column::find(name).filter(|(_, column)| of_impactor(column)).map(|(prefix, _)| prefix);
        let prefix = signals.channels.iter().find_map(|channel| prefix(&channel.name))?;
        Some(self.title.replace(IMPACTORS, if prefix.is_empty() { "impactor" } else { "impactors" }))
    }

    /// Its curves in a run with `signals`.
    pub fn curves<'a>(&self, signals: &'a Recording) -> Vec<PaneCurve<'a>> {
        let named = signals.channels.iter().filter_map(|channel| Some((column::find(&channel.name)?, &channel.values)));
        let named: Vec<_> = named.collect();
        let of_column = |&(column, label): &(Column, Option<&'static str>)| {
            let own = named.iter().filter(move |((_, found), _)| **found == column);
            own.map(move |&((prefix, _), values)| PaneCurve { column, prefix, label: label_of(prefix, label), values })
        };
        self.columns.iter().flat_map(of_column).collect()
    }
}

/// The label of a curve with this one in the table, of the impactor whose channels begin with `prefix`.
fn label_of(prefix: &str, label: Option<&str>) -> String {
    match (prefix.strip_suffix('_'), label) {
        (None, label) => label.unwrap_or(SIMULATED).to_owned(),
        (Some(name), None) => name.to_owned(),
        (Some(name), Some(label)) => format!("{name}, {label}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use lab::signal::Channel;

    fn recording(names: &[&str]) -> Recording {
        let channel = |name: &&str| Channel { name: (*name).to_owned(), values: vec![0.0] };
        Recording { time: vec![0.0], channels: names.iter().map(channel).collect() }
    }

    fn drawn(names: &[&str], shown: Shown) -> Vec<String> {
        let signals = recording(names);
        let words = |pane: Pane| {
            let labels: Vec<String> = pane.curves(&signals).into_iter().map(|curve| curve.label).collect();
            let title = pane.title(&signals).filter(|_| !labels.is_empty())?;
            Some(format!("{title}: {}", labels.join("; ")))
        };
        panes().filter(|pane| pane.shown == shown && pane.over.is_none()).filter_map(words).collect()
    }

    #[test]
    fn columns_of_one_title_share_a_pane() {
        let names = ["frame_force_x_N", "frame_force_y_N", "frame_force_N", "clamp_slip_m"];
        let expected = [
            "Force of the film on the frame: along x; along y; downwards",
            "Slip in the clamp of the frame: simulated",
        ];
        assert_eq!(drawn(&names, Shown::PageAndTab), expected);
    }

    #[test]
    fn curves_of_several_impactors_have_their_names() {
        let names = ["head_displacement_m", "head_kinetic_energy_J", "hand_displacement_m", "hand_kinetic_energy_J"];
        let expected = [
            "Displacement of the impactors: head; hand",
            "Total energy of the impactors: head, kinetic; hand, kinetic",
        ];
        assert_eq!(drawn(&names, Shown::Page), expected);
        assert_eq!(drawn(&["displacement_m", "force_N"], Shown::Page), [] as [&str; 0], "that of jaws");
    }
}
