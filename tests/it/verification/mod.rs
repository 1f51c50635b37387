//! Verification of the simulation with closed forms, other methods and the published outcomes. `docs/verification.md`
//! has the table, whose figures `docs/tables` writes from what these tests print.

mod axisymmetric;
mod claims;
mod random;
mod scene;
mod sheet;
mod solve;
pub mod tower;

mod absorption;
mod air;
mod balanced;
mod bending;
mod bodies;
mod contact;
mod convergence;
mod drop;
mod equilibrium;
mod film_contact;
mod frame_bars;
mod frame_force;
mod graded;
mod gradient;
mod guide_friction;
mod heating;
mod indentation;
mod inflation;
mod instability;
mod oscillation;
mod patch;
mod plastic;
mod poisson_sheet;
mod properties;
mod rates;
mod rubber;
mod rupture;
mod same_bits;
mod several;
mod shapes;
mod single_element;
mod springs;
mod stability;
mod stresses;
mod tears;
mod viscous;
mod warnings;
mod waves;
