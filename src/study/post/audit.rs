//! Figures of every run: its size, its cost and its errors.

use schemars::JsonSchema;
use serde::Serialize;

use super::Verdict;
use super::field::FieldFigures;
use crate::field_comparison::FieldComparison;
use base::number::clean_time;
use membrane::engine::{AddedMass, Relaxation};
use membrane::lane::Width;
use scene::mesh::Quality;
use scene::simulate::{Outcome, RateHistogram};

/// Figures of machine and mesh, which differ between runs of a scenario or follow from its keys.
pub const COST: [&str; 7] =
    ["elements", "steps", "time_step_s", "wall_s", "ns_per_element_step", "threads", "instructions"];

/// Those of them that differ between runs of one scenario: they follow from the machine, and from what else it does.
pub const OF_THE_MACHINE: [&str; 4] = ["wall_s", "ns_per_element_step", "threads", "instructions"];

/// Size, cost and errors of a run; fields of `summary.json`.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Audit {
    /// Largest error of the energy balance over the largest energy.
    pub energy_balance_error: f64,
    /// Whether the film ruptured: whether a fibre, or an element of film with a rupture criterion of its own, is past its limit and
    /// deleted; of film that tears by and by, how far is `torn_length_m`.
    pub ruptured: bool,
    /// `ruptured`, `held`, `too coarse to tell` where elements are too large for the impactor, `still descending` where the run ends
    /// before the lowest point, or `cannot break` of film without a break criterion.
    #[schemars(with = "String")]
    pub verdict: Verdict,
    /// Time of the first such element.
    pub rupture_time_s: Option<f64>,
    /// Length of all tears in stress-free film; only of film with a rupture criterion of its own.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub torn_length_m: Option<f64>,
    /// Their length × thickness.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub torn_area_m2: Option<f64>,
    /// Energy that they took.
    #[serde(rename = "fracture_energy_J", skip_serializing_if = "Option::is_none")]
    pub fracture_energy_j: Option<f64>,
    /// Largest growth of the temperature of an element that does not tear, before film first breaks; only of film with
    /// `thermal`. An upper bound: that film cools as it is stretched elastically is left out.
    #[serde(rename = "warming_K", skip_serializing_if = "Option::is_none")]
    pub warming_k: Option<f64>,
    /// Root mean square of the errors against the displacement field of the reference; only with one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub field_rms_m: Option<f64>,
    /// Norm of these errors over that of the measured displacements.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub field_error: Option<f64>,
    /// The comparison with the displacement field: its points, the motion of its axes, the errors over time.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub field: Option<FieldFigures>,
    /// Elements of all faces.
    pub elements: usize,
    /// Time steps.
    pub steps: u64,
    /// Largest time step.
    pub time_step_s: f64,
    /// Wall time.
    pub wall_s: f64,
    /// Wall time over elements and steps, with those of the relaxation before the test.
    pub ns_per_element_step: f64,
    /// Threads of the engine.
    pub threads: usize,
    /// Vector instructions of the kernels.
    #[schemars(with = "String")]
    pub instructions: Width,
    /// Factor on the film's mass; only quasi-static loadings.
    pub mass_scaling: Option<f64>,
    /// Mass added to small elements of the computed part of the film; only with `solver.smallest_step`.
    pub added_mass_kg: Option<f64>,
    /// The same over the mass of the film.
    pub added_mass_share: Option<f64>,
    /// Largest ratio of kinetic energy to the energy that the film took up; only quasi-static loadings.
    pub kinetic_share: Option<f64>,
    /// Energy lost to damping over the energy that the film took up; only quasi-static loadings.
    pub damping_share: Option<f64>,
    /// How the film came to equilibrium before the test; none where nothing holds it.
    pub relaxation: Option<RelaxationFigures>,
    /// Largest penetration over the impactor's radius, or over half its smallest extent where it is not round.
    pub penetration: Option<f64>,
    /// The mesh of each face.
    pub meshes: Vec<MeshFigures>,
    /// Strain increments by strain rate.
    pub strain_rates: RateHistogram,
}

/// How the film came to equilibrium before the test (theory.md, section 18).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
pub struct RelaxationFigures {
    /// Forces out of balance over the reactions, of the film as mounted.
    pub mounted_residual: f64,
    /// The same at the start of the test.
    pub residual: f64,
    /// Steps of the relaxation; zero where the film was mounted in equilibrium.
    pub steps: u64,
    /// Largest displacement of a node in it.
    pub displacement_m: f64,
}

impl RelaxationFigures {
    fn from_relaxation(relaxation: Relaxation) -> RelaxationFigures {
        let Relaxation { mounted, residual, steps, displacement, .. } = relaxation;
        RelaxationFigures { mounted_residual: mounted, residual, steps, displacement_m: displacement }
    }
}

/// Shape of the elements of one face, the worst of them.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct MeshFigures {
    /// Number of elements.
    pub elements: usize,
    /// Shortest edge, m.
    pub shortest_edge_m: f64,
    /// Longest edge, m.
    pub longest_edge_m: f64,
    /// Largest ratio of the edges of an element.
    pub aspect_ratio: f64,
    /// Smallest scaled Jacobian.
    pub scaled_jacobian: f64,
    /// Largest skew.
    pub skew: f64,
}

impl MeshFigures {
    fn from_quality(quality: &Quality) -> MeshFigures {
        MeshFigures {
            elements: quality.elements,
            shortest_edge_m: quality.edges[0],
            longest_edge_m: quality.edges[1],
            aspect_ratio: quality.aspect,
            scaled_jacobian: quality.jacobian,
            skew: quality.skew,
        }
    }
}

impl Audit {
    /// The figures of a finished or failed run, and of its comparison with a displacement field.
    pub(super) fn from_outcome(outcome: &Outcome, verdict: Verdict, field: Option<&FieldComparison>) -> Audit {
        let wall_s = outcome.wall.as_secs_f64();
        let relaxed = outcome.relaxation.map_or(0, |relaxation| relaxation.steps);
        let element_steps = outcome.elements as f64 * (outcome.steps + relaxed) as f64;
        let sums = |[mass, own]: [f64; 2], added: &AddedMass| [mass + added.mass, own + added.own];
        let added = (!outcome.added_mass.is_empty()).then(|| outcome.added_mass.iter().fold([0.0; 2], sums));
        let figures = field.map(FieldFigures::from_comparison);
        Audit {
            energy_balance_error: outcome.energy_balance_error,
            ruptured: outcome.rupture_time.is_some(),
            verdict,
            rupture_time_s: outcome.rupture_time.map(clean_time),
            torn_length_m: outcome.torn.map(|torn| torn.length),
            torn_area_m2: outcome.torn.map(|torn| torn.area),
            fracture_energy_j: outcome.torn.map(|torn| torn.energy),
            warming_k: outcome.warming,
            field_rms_m: figures.as_ref().and_then(|figures| figures.rms_m),
            field_error: field.and_then(|field| field.norms().relative()),
            field: figures,
            elements: outcome.elements,
            steps: outcome.steps,
            time_step_s: outcome.time_step,
            wall_s,
            ns_per_element_step: wall_s * 1e9 / element_steps,
            threads: outcome.threads,
            instructions: outcome.instructions,
            mass_scaling: outcome.mass_scaling,
            added_mass_kg: added.map(|[mass, _]| mass),
            added_mass_share: added.map(|[mass, own]| mass / own),
            kinetic_share: outcome.kinetic_share,
            damping_share: outcome.damping_share,
            relaxation: outcome.relaxation.map(RelaxationFigures::from_relaxation),
            penetration: outcome.penetration,
            meshes: outcome.films.iter().map(|film| MeshFigures::from_quality(&film.quality)).collect(),
            strain_rates: outcome.rates.clone(),
        }
    }
}
