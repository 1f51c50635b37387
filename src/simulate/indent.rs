//! The signals of a slow indentation, and where it starts.

use nalgebra::Isometry3;

use super::tracks::Tracks;
use crate::engine::{Contact, Nodes};
use crate::signal::Recording;

/// Gap over the impactor's size at which it is in touch.
const TOUCH: f64 = 1e-9;

/// Depth below first touch of an impactor that goes down at `velocity` (m/s), and the force on it: the momentum that it got
/// from the film between two samples, over that time.
pub(super) fn signals(tracks: &Tracks, velocity: f64) -> Recording {
    let row = |k: usize| [velocity * k as f64 * tracks.sample, tracks.contact_force(k)];
    let rows: Vec<_> = (0..tracks.whole()).map(row).collect();
    tracks.table(&["depth_m", "force_N"], &rows)
}

/// How far the impactor at `pose` has to go down until a node touches, m; none where it passes all of them. No gap
/// closes faster than the impactor goes down, so it can always go down by the smallest.
pub(super) fn way_to_touch(contact: &Contact, pose: &Isometry3<f64>, nodes: &Nodes) -> Option<f64> {
    let surface = contact.surface();
    let mut way = 0.0;
    let lowest = nodes.position.iter().fold(f64::INFINITY, |low, x| low.min(x[2]));
    while pose.translation.vector.z - way + surface.reach() > lowest {
        let mut at = *pose;
        at.translation.vector.z -= way;
        let gap = contact.smallest_gap(nodes, &at);
        if gap < TOUCH * surface.size() {
            return Some(way);
        }
        way += gap;
    }
    None
}
