//! An impactor: its body, its contact with the film, and its release.

use nalgebra::{Isometry3, Vector3};
use serde::{Deserialize, Serialize};

use super::contact::{Contact, ContactHistory};
use super::film::Film;
use super::rigid_body::{Motion, RigidBody};

/// An impactor and its contact with the film.
pub struct Impact {
    /// The body. One that is held is at rest.
    pub body: RigidBody,
    /// Its contact.
    pub contact: Contact,
    /// Whether it starts in contact with the film, and so is lifted with film that settles above where it was mounted.
    pub in_contact: bool,
    /// Coefficient of restitution against other bodies, of which a pair has the smaller.
    pub restitution: f64,
    /// Thickness of the film on it, through which it meets other bodies, m.
    pub(super) cover: f64,
    /// Whether it is the frame's bars.
    pub(super) is_frame: bool,
    /// Impulse of other bodies on it along z so far, N s.
    pub(super) collision_impulse: f64,
    /// Whether it met the frame's bars in the last step.
    pub(super) meets_frame: bool,
    release: Release,
}

/// Whether a body moves.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Release {
    /// It is held where it is, and is no obstacle.
    Held(Launch),
    /// It is released at this full step.
    Now,
    /// It moves.
    Done,
}

/// When and how a body is released.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Launch {
    /// s.
    at: f64,
    /// m/s.
    velocity: Vector3<f64>,
    /// rad/s.
    spin: Vector3<f64>,
}

/// Motion of an impactor and its contact, as they are saved.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct ImpactState {
    motion: Motion,
    pub(super) contact: ContactHistory,
    collision_impulse: f64,
    is_held: bool,
}

impl Impact {
    /// An impactor that moves from the start, beside the film, without restitution.
    pub fn new(body: RigidBody, contact: Contact) -> Impact {
        Impact {
            body,
            contact,
            in_contact: false,
            restitution: 0.0,
            cover: 0.0,
            is_frame: false,
            collision_impulse: 0.0,
            meets_frame: false,
            release: Release::Done,
        }
    }

    /// The bars of the frame, which stand still at the height `z` (m) of the middle of their surface. Other bodies meet
    /// them with their own restitution, through film of the thickness `cover` (m).
    pub fn frame(contact: Contact, z: f64, cover: f64) -> Impact {
        let body = RigidBody::prescribed(Isometry3::translation(0.0, 0.0, z), 0.0);
        Impact { restitution: 1.0, cover, is_frame: true, ..Impact::new(body, contact) }
    }

    /// This impact, starting in contact with the film or not.
    pub fn starting_in_contact(self, in_contact: bool) -> Impact {
        Impact { in_contact, ..self }
    }

    /// This impact with the coefficient of `restitution` against other bodies.
    pub fn with_restitution(self, restitution: f64) -> Impact {
        Impact { restitution, ..self }
    }

    /// This impact held where it is until the time `at` (s), where it is released with its motion; from the start where
    /// that is zero.
    pub fn released_at(self, at: f64) -> Impact {
        if at <= 0.0 {
            return self;
        }
        let Impact { mut body, .. } = self;
        let launch = Launch { at, velocity: body.velocity, spin: body.spin };
        (body.velocity, body.spin) = (Vector3::zeros(), Vector3::zeros());
        Impact { body, release: Release::Held(launch), ..self }
    }

    /// This impact as one of several.
    pub(super) fn beside_others(self) -> Impact {
        Impact { contact: self.contact.beside_others(), ..self }
    }

    /// Whether it is held until its release.
    pub fn is_held(&self) -> bool {
        matches!(self.release, Release::Held(_))
    }

    /// Whether it is to be released by `time` (s).
    pub(super) fn is_due(&self, time: f64) -> bool {
        matches!(self.release, Release::Held(launch) if launch.at <= time)
    }

    /// Releases it.
    pub(super) fn release(&mut self) {
        self.body = self.launched();
        self.release = Release::Now;
    }

    /// The body with the motion that it has, or is released with.
    pub fn launched(&self) -> RigidBody {
        let mut body = self.body.clone();
        if let Release::Held(Launch { velocity, spin, .. }) = self.release {
            (body.velocity, body.spin) = (velocity, spin);
        }
        body
    }

    /// Changes the velocity by gravity `g` (m/s², downward) over `over` (s), or half the next step `dt` (s) after its
    /// release.
    pub(super) fn kick(&mut self, [over, dt]: [f64; 2], g: f64) {
        match self.release {
            Release::Held(_) => {}
            Release::Now => {
                self.body.kick(0.5 * dt, g);
                self.release = Release::Done;
            }
            Release::Done => self.body.kick(over, g),
        }
    }

    /// Its state, to be saved.
    pub(super) fn save(&self) -> ImpactState {
        ImpactState {
            motion: self.body.motion(),
            contact: self.contact.save(),
            collision_impulse: self.collision_impulse,
            is_held: self.is_held(),
        }
    }

    /// Restores its state in a scene of the same `films`.
    pub(super) fn restore(&mut self, state: ImpactState, films: &[Film]) {
        self.body.restore(&state.motion);
        self.contact.restore(state.contact, films);
        self.collision_impulse = state.collision_impulse;
        if !state.is_held {
            self.release = Release::Done;
        }
    }
}

/// Pairs of released bodies with their indices, the smaller one first, in the order of the second.
pub(super) fn released_pairs(impacts: &[Impact]) -> impl Iterator<Item = ([usize; 2], [&Impact; 2])> {
    let released = move |end: usize| impacts[..end].iter().enumerate().filter(|(_, impact)| !impact.is_held());
    released(impacts.len())
        .flat_map(move |(second, b)| released(second).map(move |(first, a)| ([first, second], [a, b])))
}
