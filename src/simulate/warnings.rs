//! What a run should tell its user although it went on.

use serde::{Deserialize, Serialize};

use super::Film;
use super::probe::KINETIC;
use crate::engine::{ContactState, ElementStrain, View};
use crate::model::MOST_IN_FRAMES;

/// Edge of an element in touch over the impactor's size above which a sphere is no longer round to the film.
const COARSE: f64 = 0.25;
/// Penetration over the impactor's size that is told.
const DEEP: f64 = 0.01;
/// Strain of one element over the mean of its neighbours that counts as localised, and the strain from which.
const LOCALISED: (f64, f64) = (2.0, 0.5);
/// Balance error that is told.
const BALANCE: f64 = 0.01;
/// Share of straining outside the measured rates that is told.
const OUTSIDE: f64 = 0.05;
/// Part of the bound on the kinetic share from which it is told.
const ALMOST: f64 = 0.2;

/// Scaled Jacobian of an element that is told.
const MISSHAPEN: f64 = 0.3;

/// What only the whole run can tell.
pub(super) struct Figures<'a> {
    /// Balance error of the energies.
    pub(super) balance: f64,
    /// Share of the straining outside the measured rates.
    pub(super) outside: f64,
    /// Kinetic share of a slow test.
    pub(super) kinetic: Option<f64>,
    /// What to do about it.
    pub(super) remedy: &'a str,
    /// Snapshots asked for and taken.
    pub(super) snapshots: [usize; 2],
    /// Whether the impactor still felt the film at the end.
    pub(super) unfinished: bool,
}

/// Each kind of warning, told once, with the time at which it first held.
#[derive(Default, Serialize, Deserialize)]
pub(super) struct Warnings {
    coarse: Option<(f64, f64)>,
    deep: Option<(f64, f64)>,
    frame_hit: Option<f64>,
    localised: Option<(f64, f64, usize)>,
}

/// Intact elements, by their number among such, that share a node with the one of number `element`.
fn neighbours(film: &crate::engine::Film, element: usize) -> Vec<usize> {
    let (mut corners, mut place) = (vec![], 0);
    film.for_each_intact(|c| {
        if place == element {
            corners.extend_from_slice(c);
        }
        place += 1;
    });
    let (mut beside, mut place) = (vec![], 0);
    film.for_each_intact(|c| {
        if place != element && c.iter().any(|n| corners.contains(n)) {
            beside.push(place);
        }
        place += 1;
    });
    beside
}

impl Warnings {
    /// Takes in what contact looks like at `time` (s) on an impactor of `size` (m).
    pub(super) fn touch(&mut self, time: f64, size: f64, seen: &ContactState) {
        let (edge, depth) = (seen.longest_edge / size, seen.penetration / size);
        if edge > COARSE && self.coarse.is_none_or(|(_, worst)| edge > worst) {
            self.coarse = Some((self.coarse.map_or(time, |c| c.0), edge));
        }
        if depth > DEEP && self.deep.is_none_or(|(_, worst)| depth > worst) {
            self.deep = Some((self.deep.map_or(time, |c| c.0), depth));
        }
        if seen.frame_hit && self.frame_hit.is_none() {
            self.frame_hit = Some(time);
        }
    }

    /// Looks for an element that strains far more than those around it.
    pub(super) fn strain(&mut self, view: &View<'_>, strains: &[Vec<ElementStrain>]) {
        if self.localised.is_some() {
            return;
        }
        for (face, (film, strains)) in view.films.iter().zip(strains).enumerate() {
            let largest = |s: &ElementStrain| s.strain[0].max(s.strain[1]);
            let intact: Vec<f64> = strains.iter().filter(|s| s.volume > 0.0).map(largest).collect();
            let Some(worst) = (0..intact.len()).max_by(|a, b| intact[*a].total_cmp(&intact[*b])) else { continue };
            if intact[worst] < LOCALISED.1 {
                continue;
            }
            let around: Vec<f64> = neighbours(film, worst).into_iter().map(|k| intact[k]).collect();
            let mean = around.iter().sum::<f64>() / around.len().max(1) as f64;
            if !around.is_empty() && intact[worst] > LOCALISED.0 * mean {
                self.localised = Some((view.time, intact[worst], face + 1));
            }
        }
    }

    /// All warnings.
    pub(super) fn finish(self, figures: &Figures<'_>, films: &[Film]) -> Vec<String> {
        let Figures { balance, outside, kinetic, remedy, snapshots: [wanted, kept], unfinished } = *figures;
        let ms = |t: f64| 1e3 * t;
        let mut out = vec![];
        for (face, film) in films.iter().enumerate().filter(|(_, film)| film.quality.jacobian < MISSHAPEN) {
            out.push(format!("misshapen elements in face {}: {}", face + 1, film.quality));
        }
        if let Some((time, edge)) = self.coarse {
            out.push(format!(
                "coarse contact: from {:.1} ms edges in touch are up to {edge:.2} of the impactor's radius (bound {COARSE}); use a smaller specimen.mesh.size",
                ms(time)
            ));
        }
        if let Some((time, depth)) = self.deep {
            out.push(format!(
                "penetration: from {:.1} ms faces reach up to {:.1} % of the radius into the impactor (bound {:.0} %); use a smaller specimen.mesh.size",
                ms(time), 100.0 * depth, 100.0 * DEEP
            ));
        }
        if let Some(time) = self.frame_hit {
            out.push(format!(
                "the impactor reached the clamped edge at {:.1} ms: the frame itself is not modelled",
                ms(time)
            ));
        }
        if let Some((time, strain, face)) = self.localised {
            out.push(format!(
                "strain localisation: at {:.1} ms one element of face {face} is strained to {strain:.2}, over {} times its neighbours; the result depends on the mesh from there on",
                ms(time), LOCALISED.0
            ));
        }
        if unfinished {
            out.push(
                "the run ends while the impactor is still in touch: rebound and energy absorption are not final; \
                 use a longer loading.impact.duration"
                    .into(),
            );
        }
        if kept < wanted {
            out.push(format!(
                "the recording shows {kept} states of the film in place of {wanted} (output.frames): more of so many elements \
                 would take more than {:.1} GB",
                1e-9 * MOST_IN_FRAMES
            ));
        }
        if balance > BALANCE {
            out.push(format!("energy balance error {:.1} % of the energy exchanged", 100.0 * balance));
        }
        if outside > OUTSIDE {
            out.push(format!(
                "strain rate: {:.0} % of the straining lies outside the rates at which the curves were measured",
                100.0 * outside
            ));
        }
        if let Some(share) = kinetic.filter(|k| *k > KINETIC) {
            out.push(format!(
                "not quasi-static: kinetic energy is up to {:.1} % of the film's; {remedy}",
                100.0 * share
            ));
        } else if let Some(share) = kinetic.filter(|k| *k > ALMOST * KINETIC) {
            out.push(format!(
                "hardly quasi-static: kinetic energy is up to {:.1} % of the film's (bound {:.0} %); {remedy}",
                100.0 * share,
                100.0 * KINETIC
            ));
        }
        out
    }
}
