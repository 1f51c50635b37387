//! The impactor as a rigid body.

use nalgebra::{
    Isometry3, Matrix3, Matrix6, Point3, Quaternion, Translation3, Unit, UnitQuaternion, Vector3, Vector4, Vector6,
};
use serde::{Deserialize, Serialize};

use super::guide_friction::GuideFriction;

/// Degrees of freedom of a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Freedom {
    /// Translation along z.
    Z,
    /// Translation along a line.
    Line(Unit<Vector3<f64>>),
    /// Rotation about an axis through the point `at` (m).
    Hinge {
        /// Its direction.
        axis: Unit<Vector3<f64>>,
        /// A point of it.
        at: Point3<f64>,
    },
    /// All six.
    All,
}

/// A rigid body about its centre of mass.
#[derive(Clone, Debug)]
pub struct RigidBody {
    /// Position of the centre of mass (m) and rotation, at the full step.
    pub pose: Isometry3<f64>,
    /// m/s, at the half step.
    pub velocity: Vector3<f64>,
    /// rad/s, at the half step, in space axes.
    pub spin: Vector3<f64>,
    /// kg; infinite where the motion is prescribed.
    pub mass: f64,
    /// kg m², in body axes.
    inertia: Matrix3<f64>,
    /// Inverse of the inertia in space axes at the present pose, 1/(kg m²).
    inverse_inertia: Matrix3<f64>,
    freedom: Freedom,
    /// Of the guide.
    guide_friction: GuideFriction,
}

/// Motion of a body, as it is saved.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) struct Motion {
    /// Of the centre of mass, m.
    position: [f64; 3],
    /// Unit quaternion i, j, k, w.
    rotation: [f64; 4],
    velocity: [f64; 3],
    spin: [f64; 3],
    /// Column by column.
    inverse_inertia: [[f64; 3]; 3],
}

/// The film in contact in the body's equations of motion (theory.md, equation 20): the mass that follows each motion of
/// the body, and the momentum that it takes. Rows: translation, rotation; a guided body uses the third alone.
#[derive(Clone, Debug)]
pub(super) struct CoupledFilm {
    mass: Matrix6<f64>,
    momentum: Vector6<f64>,
}

impl Default for CoupledFilm {
    fn default() -> Self {
        CoupledFilm { mass: Matrix6::zeros(), momentum: Vector6::zeros() }
    }
}

impl CoupledFilm {
    /// Adds film of `mass` (kg) and `momentum` (kg m/s) along z, for a guided body.
    pub(super) fn add_along_z(&mut self, mass: f64, momentum: f64) {
        self.mass[(2, 2)] += mass;
        self.momentum[2] += momentum;
    }

    /// Mass that follows a guided body, kg.
    pub(super) fn mass_along_z(&self) -> f64 {
        self.mass[(2, 2)]
    }

    /// The film of these contacts and others.
    pub(super) fn and(&self, others: &CoupledFilm) -> CoupledFilm {
        CoupledFilm { mass: self.mass + others.mass, momentum: self.momentum + others.momentum }
    }
}

/// Velocity of a point per impulse on it, 1/kg, by its columns.
#[derive(Clone, Copy, Debug)]
pub(super) struct InverseMass(pub(super) [Vector3<f64>; 3]);

impl InverseMass {
    /// What `impulse` (N s) changes of the velocity, m/s.
    #[inline(always)]
    pub(super) fn response(&self, impulse: &Vector3<f64>) -> Vector3<f64> {
        // Column by column: a product of nalgebra's matrices is a call.
        let [x, y, z] = &self.0;
        x * impulse.x + y * impulse.y + z * impulse.z
    }
}

impl RigidBody {
    /// A body at `pose` that moves along z alone, at `velocity` (m/s, upward); `mass` in kg.
    pub fn guided(pose: Isometry3<f64>, velocity: f64, mass: f64) -> RigidBody {
        RigidBody {
            pose,
            velocity: Vector3::new(0.0, 0.0, velocity),
            spin: Vector3::zeros(),
            mass,
            inertia: Matrix3::zeros(),
            inverse_inertia: Matrix3::zeros(),
            freedom: Freedom::Z,
            guide_friction: GuideFriction::default(),
        }
    }

    /// This body on a guide with `friction`, which only a body that moves along z by its own inertia has.
    pub fn with_guide_friction(self, friction: GuideFriction) -> RigidBody {
        let has_guide = self.freedom == Freedom::Z && self.mass.is_finite();
        let guide_friction = if has_guide { friction } else { GuideFriction::default() };
        RigidBody { guide_friction, ..self }
    }

    /// A body at `pose` with six degrees of freedom and `velocity` (m/s), not spinning; `mass` in kg, `inertia` (kg m²)
    /// about its centre of mass in body axes.
    pub fn free(pose: Isometry3<f64>, velocity: Vector3<f64>, mass: f64, inertia: Matrix3<f64>) -> RigidBody {
        let mut body = RigidBody { velocity, inertia, freedom: Freedom::All, ..RigidBody::guided(pose, 0.0, mass) };
        body.update_inverse_inertia();
        body
    }

    /// This body spinning at `spin` (rad/s, in space axes).
    pub fn spinning(self, spin: Vector3<f64>) -> RigidBody {
        RigidBody { spin, ..self }
    }

    /// This body with the degrees of freedom `freedom`, which admit a part of its motion.
    pub fn with_freedom(self, freedom: Freedom) -> RigidBody {
        let mut body = RigidBody { freedom, ..self };
        match freedom {
            Freedom::Z => {
                (body.velocity, body.spin) = (Vector3::new(0.0, 0.0, body.velocity.z), Vector3::zeros());
            }
            Freedom::Line(line) => {
                (body.velocity, body.spin) = (line.scale(line.dot(&body.velocity)), Vector3::zeros());
            }
            Freedom::Hinge { axis, .. } => body.spin = axis.scale(axis.dot(&body.spin)),
            Freedom::All => {}
        }
        body.follow_hinge();
        body
    }

    /// The motion that a line or a hinge admits, per its one coordinate: velocity of the centre of mass and spin.
    fn admitted(&self) -> Option<Vector6<f64>> {
        let (velocity, spin) = match self.freedom {
            Freedom::Z | Freedom::All => return None,
            Freedom::Line(line) => (*line, Vector3::zeros()),
            Freedom::Hinge { axis, at } => (axis.cross(&(self.centre() - at)), *axis),
        };
        Some(Vector6::new(velocity.x, velocity.y, velocity.z, spin.x, spin.y, spin.z))
    }

    /// Mass or moment of inertia of the coordinate of the `admitted` motion, kg or kg m².
    fn admitted_mass(&self, admitted: &Vector6<f64>) -> f64 {
        let (velocity, spin) = (admitted.fixed_rows::<3>(0), admitted.fixed_rows::<3>(3));
        self.mass * velocity.norm_squared() + spin.dot(&(self.space_inertia() * spin))
    }

    /// Changes the motion by `change` of velocity and spin.
    fn accelerate(&mut self, change: &Vector6<f64>) {
        self.velocity += change.fixed_rows::<3>(0);
        self.spin += change.fixed_rows::<3>(3);
    }

    /// Velocity of the centre of mass of a body on a hinge, from its spin.
    fn follow_hinge(&mut self) {
        if let Freedom::Hinge { at, .. } = self.freedom {
            self.velocity = self.spin.cross(&(self.centre() - at));
        }
    }

    /// A body at `pose` with the prescribed motion along z at `velocity` (m/s, upward).
    pub fn prescribed(pose: Isometry3<f64>, velocity: f64) -> RigidBody {
        RigidBody::guided(pose, velocity, f64::INFINITY)
    }

    /// Its motion, to be saved.
    pub(super) fn motion(&self) -> Motion {
        Motion {
            position: self.pose.translation.vector.into(),
            rotation: self.pose.rotation.coords.into(),
            velocity: self.velocity.into(),
            spin: self.spin.into(),
            inverse_inertia: self.inverse_inertia.into(),
        }
    }

    /// Restores a saved motion bit by bit: nothing is normalised or computed again.
    pub(super) fn restore(&mut self, motion: &Motion) {
        let rotation = UnitQuaternion::new_unchecked(Quaternion::from_vector(Vector4::from(motion.rotation)));
        self.pose = Isometry3::from_parts(Translation3::from(motion.position), rotation);
        self.velocity = motion.velocity.into();
        self.spin = motion.spin.into();
        self.inverse_inertia = motion.inverse_inertia.into();
    }

    /// Whether its motion is prescribed: then its energy is not balanced, and its work on the film is external.
    pub fn has_prescribed_motion(&self) -> bool {
        self.mass.is_infinite()
    }

    /// Updates the inverse inertia to the present pose; a singular inertia admits no rotation.
    fn update_inverse_inertia(&mut self) {
        if self.freedom != Freedom::Z {
            self.inverse_inertia = self.space_inertia().try_inverse().unwrap_or_else(Matrix3::zeros);
        }
    }

    /// Velocity of its material point at `arm` (m) from the centre of mass, m/s.
    #[inline]
    pub(super) fn velocity_at(&self, arm: &Vector3<f64>) -> Vector3<f64> {
        match self.freedom {
            // No cross product with zero: a guided body has the bits of a point on a line.
            Freedom::Z => self.velocity,
            _ => self.velocity + self.spin.cross(arm),
        }
    }

    /// Position of the centre of mass, m.
    pub fn centre(&self) -> Point3<f64> {
        self.pose.translation.vector.into()
    }

    /// The pose after `dt` (s) at its present velocity.
    pub(super) fn predicted(&self, dt: f64) -> Isometry3<f64> {
        let rotation = UnitQuaternion::from_scaled_axis(self.mean_spin(dt) * dt);
        let to = match self.freedom {
            Freedom::Hinge { at, .. } => at.coords + rotation * (self.centre() - at),
            _ => self.pose.translation.vector + self.velocity * dt,
        };
        Isometry3::from_parts(Translation3::from(to), rotation * self.pose.rotation)
    }

    /// Spin in the middle of the next `dt` (s), rad/s: of a free body that of its angular momentum in the pose there.
    fn mean_spin(&self, dt: f64) -> Vector3<f64> {
        if self.freedom != Freedom::All || self.spin == Vector3::zeros() {
            return self.spin;
        }
        // Midpoint: over a step the spin of a free body changes although its angular momentum does not.
        let half = UnitQuaternion::from_scaled_axis(self.spin * (0.5 * dt)).to_rotation_matrix();
        // Inverse inertia in the pose that is turned by half the angle.
        half * (self.inverse_inertia * (half.transpose() * (self.space_inertia() * self.spin)))
    }

    /// Moves by `dt` (s) at its present velocity.
    pub(super) fn drift(&mut self, dt: f64) {
        let turns = self.freedom == Freedom::All && self.spin != Vector3::zeros();
        let momentum = turns.then(|| self.space_inertia() * self.spin);
        self.pose = self.predicted(dt);
        // Products of unit quaternions drift from length one by a round-off a step.
        self.pose.rotation.renormalize();
        self.update_inverse_inertia();
        if let Some(momentum) = momentum {
            // Turning changes the inertia in space, not the angular momentum: the gyroscopic moment.
            self.spin = self.inverse_inertia * momentum;
        }
        self.follow_hinge();
    }

    /// Changes the velocities by gravity `g` (m/s², downward) over `dt` (s).
    pub(super) fn kick(&mut self, dt: f64, g: f64) {
        if self.has_prescribed_motion() {
            return;
        }
        match self.freedom {
            Freedom::Z => self.velocity.z -= g * dt,
            Freedom::All => self.velocity.z -= g * dt,
            Freedom::Line(_) | Freedom::Hinge { .. } => {
                self.apply_impulse(&Vector3::new(0.0, 0.0, -self.mass * g * dt), &Vector3::zeros());
            }
        }
    }

    /// Downward acceleration of its centre of mass under gravity `g` (m/s², downward) alone, m/s².
    pub fn free_acceleration(&self, g: f64) -> f64 {
        match self.freedom {
            _ if self.has_prescribed_motion() => 0.0,
            Freedom::Z | Freedom::All => g,
            Freedom::Line(_) | Freedom::Hinge { .. } => {
                let mut body = RigidBody { velocity: Vector3::zeros(), ..self.clone() };
                body.kick(1.0, g);
                -body.velocity.z
            }
        }
    }

    /// Applies `impulse` (N s) at `arm` (m) from the centre of mass, of which a guide admits a part.
    #[inline]
    pub(super) fn apply_impulse_at(&mut self, impulse: &Vector3<f64>, arm: &Vector3<f64>) {
        self.apply_impulse(impulse, &arm.cross(impulse));
    }

    /// Applies `impulse` (N s) and its `moment` about the centre of mass (N m s), of which a guide admits a part.
    #[inline]
    pub(super) fn apply_impulse(&mut self, impulse: &Vector3<f64>, moment: &Vector3<f64>) {
        let [velocity, spin] = self.response(impulse, moment);
        self.velocity += velocity;
        self.spin += spin;
    }

    /// What `impulse` (N s) and its `moment` about the centre of mass (N m s) change of velocity and spin.
    #[inline]
    fn response(&self, impulse: &Vector3<f64>, moment: &Vector3<f64>) -> [Vector3<f64>; 2] {
        match self.freedom {
            Freedom::Z => [Vector3::new(0.0, 0.0, impulse.z / self.mass), Vector3::zeros()],
            Freedom::All => [impulse / self.mass, self.inverse_inertia * moment],
            Freedom::Line(_) | Freedom::Hinge { .. } => self.admitted().map_or([Vector3::zeros(); 2], |admitted| {
                let load = admitted.fixed_rows::<3>(0).dot(impulse) + admitted.fixed_rows::<3>(3).dot(moment);
                let change = admitted * (load / self.admitted_mass(&admitted));
                [change.fixed_rows::<3>(0).into(), change.fixed_rows::<3>(3).into()]
            }),
        }
    }

    /// Velocity at `arm` (m) from the centre of mass per impulse there, 1/kg.
    pub(super) fn inverse_mass_at(&self, arm: &Vector3<f64>) -> InverseMass {
        let along = |impulse: Vector3<f64>| {
            let [velocity, spin] = self.response(&impulse, &arm.cross(&impulse));
            if self.is_guided() { velocity } else { velocity + spin.cross(arm) }
        };
        InverseMass([along(Vector3::x()), along(Vector3::y()), along(Vector3::z())])
    }

    /// Work of `impulse` (N s) and its `moment` about the centre of mass (N m s) in the half step in which it moves so, J
    /// (theory.md, equation 22).
    pub(super) fn half_work(&self, impulse: &Vector3<f64>, moment: &Vector3<f64>) -> f64 {
        let rotation = if self.freedom == Freedom::Z { 0.0 } else { moment.dot(&self.spin) };
        0.5 * (impulse.dot(&self.velocity) + rotation)
    }

    /// Whether it moves along z alone.
    #[inline(always)]
    pub(super) fn is_guided(&self) -> bool {
        self.freedom == Freedom::Z
    }

    /// Adds film of `mass` (kg) that follows the body at `arm` (m), in all directions or `along` one, and the momentum
    /// `change` (kg m/s) that it takes from a free body of unchanged velocity.
    pub(super) fn couple(
        &self,
        coupled: &mut CoupledFilm,
        arm: &Vector3<f64>,
        mass: f64,
        along: Option<&Vector3<f64>>,
        change: &Vector3<f64>,
    ) {
        let mass = along.map_or(Matrix3::identity(), |n| n * n.transpose()) * mass;
        let lever = arm.cross_matrix();
        let moment = lever * mass;
        let blocks =
            [(0, 0, mass), (0, 3, mass * lever.transpose()), (3, 0, moment), (3, 3, moment * lever.transpose())];
        for (row, column, block) in blocks {
            let mut view = coupled.mass.fixed_view_mut::<3, 3>(row, column);
            view += block;
        }
        for (row, part) in [(0, *change), (3, arm.cross(change))] {
            let mut view = coupled.momentum.fixed_rows_mut::<3>(row);
            view += part;
        }
    }

    /// The body with the velocity of the implicit solution for the body and the `coupled` film (theory.md,
    /// equation 20).
    pub(super) fn after_contact(&self, coupled: &CoupledFilm) -> RigidBody {
        let mut body = self.clone();
        match self.freedom {
            Freedom::Z => body.velocity.z -= coupled.momentum[2] / (self.mass + coupled.mass[(2, 2)]),
            Freedom::All => {
                let mut own = Matrix6::from_diagonal_element(self.mass);
                own.fixed_view_mut::<3, 3>(3, 3).copy_from(&self.space_inertia());
                if let Some(inverse) = (own + coupled.mass).try_inverse() {
                    body.accelerate(&-(inverse * coupled.momentum));
                }
            }
            Freedom::Line(_) | Freedom::Hinge { .. } => {
                if let Some(admitted) = self.admitted() {
                    let mass = self.admitted_mass(&admitted) + admitted.dot(&(coupled.mass * admitted));
                    body.accelerate(&(admitted * (-admitted.dot(&coupled.momentum) / mass)));
                }
            }
        }
        body
    }

    /// The impulse of the guide (N s) over `dt` (s) on the body, which moved as `before` and with all that follows it,
    /// of `mass` (kg) in total, would move at `velocity` (m/s) without.
    pub(super) fn guide_impulse(&self, before: &RigidBody, velocity: f64, mass: f64, dt: f64) -> f64 {
        self.guide_friction.impulse(velocity, before.velocity.z, mass, dt)
    }

    /// Whether its guide has friction.
    pub(super) fn has_guide_friction(&self) -> bool {
        !self.guide_friction.is_none()
    }

    /// Kinetic energy with velocities half a step before and after, J (theory.md, equation 23).
    pub fn kinetic_energy(&self, before: &RigidBody) -> f64 {
        if self.has_prescribed_motion() {
            return 0.0;
        }
        let rotation = self.spin.dot(&(self.space_inertia() * before.spin));
        0.5 * (self.mass * self.velocity.dot(&before.velocity) + rotation)
    }

    /// Kinetic energy of the motion besides that along z, at the half step, J.
    pub(super) fn lateral_energy(&self) -> f64 {
        if self.has_prescribed_motion() || self.freedom == Freedom::Z {
            return 0.0;
        }
        let rotation = self.spin.dot(&(self.space_inertia() * self.spin));
        0.5 * (self.mass * self.velocity.xy().norm_squared() + rotation)
    }

    /// Potential energy under gravity `g` (m/s², downward), J.
    pub(super) fn potential_energy(&self, g: f64) -> f64 {
        if self.has_prescribed_motion() { 0.0 } else { self.mass * g * self.centre().z }
    }

    /// Inertia in space axes, kg m².
    fn space_inertia(&self) -> Matrix3<f64> {
        let rotation = self.pose.rotation.to_rotation_matrix();
        rotation * self.inertia * rotation.transpose()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn free_body() -> RigidBody {
        let inertia = Matrix3::from_diagonal(&Vector3::new(0.1, 0.2, 0.3));
        let velocity = Vector3::new(0.3, -0.2, -4.0);
        let mut body = RigidBody::free(Isometry3::translation(0.0, 0.0, 1.0), velocity, 2.0, inertia);
        body.spin = Vector3::new(1.0, -2.0, 0.5);
        body
    }

    /// The implicit solution with one contact is the inelastic collision of two masses at a point.
    #[test]
    fn one_sticking_contact_is_an_inelastic_collision() {
        let at = Vector3::new(0.4, 0.1, -0.3);
        let film = 0.5;
        let body = free_body();
        let mut coupled = CoupledFilm::default();
        let relative = body.velocity_at(&at);
        body.couple(&mut coupled, &at, film, None, &(film * relative));
        let after = body.after_contact(&coupled);
        let mut hit = body.clone();
        hit.apply_impulse_at(&(-film * after.velocity_at(&at)), &at);
        assert!((hit.velocity - after.velocity).norm() < 1e-13);
        assert!((hit.spin - after.spin).norm() < 1e-13);
    }

    /// Contact does not change the velocity or the energy of a body with prescribed motion.
    #[test]
    fn contact_does_not_change_a_prescribed_motion() {
        let mut body = RigidBody::prescribed(Isometry3::translation(0.0, 0.0, 1.0), -0.5);
        let at = Vector3::new(0.1, 0.0, -0.2);
        let mut coupled = CoupledFilm::default();
        body.couple(&mut coupled, &at, 3.0, None, &Vector3::new(1.0, 2.0, 3.0));
        assert_eq!(body.after_contact(&coupled).velocity.z, -0.5);
        body.apply_impulse_at(&Vector3::new(0.0, 0.0, 7.0), &at);
        body.kick(1e-3, 0.0);
        assert_eq!((body.velocity.z, body.inverse_mass_at(&at).response(&Vector3::z())), (-0.5, Vector3::zeros()));
        assert_eq!((body.kinetic_energy(&body.clone()), body.potential_energy(9.81)), (0.0, 0.0));
    }

    /// Contact with film on a line and on a hinge is an inelastic collision of the one coordinate, and a pendulum has
    /// its period and its energy.
    #[test]
    fn guides_admit_one_coordinate() {
        let at = Vector3::new(0.4, 0.1, -0.3);
        let line = Unit::new_normalize(Vector3::new(1.0, 0.0, -2.0));
        let hinge = Freedom::Hinge { axis: Vector3::y_axis(), at: Point3::new(0.1, 0.0, 1.5) };
        for freedom in [Freedom::Line(line), hinge] {
            let body = free_body().with_freedom(freedom);
            let mut coupled = CoupledFilm::default();
            body.couple(&mut coupled, &at, 0.5, None, &(0.5 * body.velocity_at(&at)));
            let after = body.after_contact(&coupled);
            let mut hit = body.clone();
            hit.apply_impulse_at(&(-0.5 * after.velocity_at(&at)), &at);
            assert!((hit.velocity - after.velocity).norm() < 1e-13 && (hit.spin - after.spin).norm() < 1e-13);
            if let Freedom::Line(line) = freedom {
                assert!(after.velocity.cross(&line).norm() < 1e-14 && after.spin == Vector3::zeros());
            }
        }
        let (length, g) = (0.5, 9.81);
        let hinge = Freedom::Hinge { axis: Vector3::y_axis(), at: Point3::origin() };
        let pose = Isometry3::translation(1e-3 * length, 0.0, -length);
        let inertia = Matrix3::from_diagonal(&Vector3::new(0.1, 0.2, 0.3));
        let mut swing = RigidBody::free(pose, Vector3::zeros(), 2.0, inertia).with_freedom(hinge);
        let (dt, period) = (1e-5, std::f64::consts::TAU * ((2.0 * length * length + 0.2) / (2.0 * g * length)).sqrt());
        // A quarter: the place changes most where it passes below the hinge.
        let steps = (0.25 * period / dt).round() as usize;
        swing.kick(0.5 * dt, g);
        for _ in 0..steps {
            swing.drift(dt);
            swing.kick(dt, g);
        }
        assert!((swing.centre().x / (1e-3 * length)).abs() < 1e-3, "{}", swing.centre().x);
        assert!((swing.centre().coords.norm() - pose.translation.vector.norm()).abs() < 1e-12);
    }

    /// Free rotation about a general axis.
    #[test]
    fn free_rotation_conserves_energy_and_angular_momentum() {
        let mut free = free_body();
        let start = free.space_inertia() * free.spin;
        let energy = free.kinetic_energy(&free.clone());
        let dt = 1e-5;
        for _ in 0..100_000 {
            free.kick(dt, 0.0);
            free.drift(dt);
        }
        assert!((free.space_inertia() * free.spin - start).norm() < 1e-9 * start.norm());
        let change = free.kinetic_energy(&free.clone()) / energy - 1.0;
        assert!(change.abs() < 1e-9, "{change}");
    }
}
