//! The signals of a slow indentation, and where it starts.

use nalgebra::Isometry3;

use super::tracks::Tracks;
use crate::engine::{Contact, Nodes};
use crate::signal::Recording;

/// Gap over the impactor's size at which it is in touch.
const TOUCH: f64 = 1e-9;

/// Least way down at once over the impactor's size: past nodes that it nearly touches, but never will, the gap alone would
/// take for ever.
const STRIDE: f64 = 1e-3;

/// Depth below first touch of an impactor that goes down at `velocity` (m/s), and the force on it: the momentum that it got
/// from the film between two samples, over that time.
pub(super) fn signals(tracks: &Tracks, velocity: f64) -> Recording {
    let row = |k: usize| [velocity * k as f64 * tracks.sample, tracks.contact_force(k)];
    let rows: Vec<_> = (0..tracks.whole().min(tracks.strains.rows.len())).map(row).collect();
    tracks.table(&["depth_m", "force_N"], &rows)
}

/// How far the impactor at `pose` has to go down until a node touches, m; none where it passes all of them. No gap
/// closes faster than the impactor goes down, so it can always go down by the smallest; where that is less than a stride it
/// goes down by one, and back by halving if a node is then inside.
pub(super) fn way_to_touch(contact: &Contact, pose: &Isometry3<f64>, nodes: &Nodes) -> Option<f64> {
    let surface = contact.surface();
    let mut way = 0.0;
    let lowest = nodes.position.iter().fold(f64::INFINITY, |low, x| low.min(x[2]));
    let gap_at = |way: f64| {
        let mut at = *pose;
        at.translation.vector.z -= way;
        contact.smallest_gap(nodes, &at)
    };
    let (touch, stride) = (TOUCH * surface.size(), STRIDE * surface.size());
    let mut gap = gap_at(way);
    while gap >= touch {
        let before = way;
        way += gap.max(stride);
        if pose.translation.vector.z - way + surface.bounding_radius() <= lowest {
            return None;
        }
        gap = gap_at(way);
        if gap < 0.0 {
            return Some(halved(before, way, touch, gap_at));
        }
    }
    Some(way)
}

/// Way (m) between one without touch and one with a node inside at which the gap is closed but for `touch`.
fn halved(mut clear: f64, mut inside: f64, touch: f64, gap_at: impl Fn(f64) -> f64) -> f64 {
    for _ in 0..60 {
        let middle = 0.5 * (clear + inside);
        let gap = gap_at(middle);
        if gap < 0.0 {
            inside = middle;
        } else {
            clear = middle;
        }
        if (0.0..touch).contains(&gap) {
            break;
        }
    }
    clear
}
