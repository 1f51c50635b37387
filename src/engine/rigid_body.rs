//! The impactor as a rigid body.

use nalgebra::{
    Isometry3, Matrix3, Matrix6, Point3, Quaternion, Translation3, UnitQuaternion, Vector3, Vector4, Vector6,
};
use serde::{Deserialize, Serialize};

/// A rigid body about its centre of mass, guided along z or free.
#[derive(Clone, Debug)]
pub struct RigidBody {
    /// Of the centre of mass, at the full step.
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
    /// Whether it is guided along z; a free body has six degrees of freedom.
    guided: bool,
}

/// How a body moves, as plain numbers.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct Motion {
    /// Of the centre of mass, m.
    place: [f64; 3],
    /// Unit quaternion i, j, k, w.
    rotation: [f64; 4],
    velocity: [f64; 3],
    spin: [f64; 3],
    /// Column by column.
    inverse_inertia: [[f64; 3]; 3],
}

/// Contacts gathered into the body's own equations of motion: how much film mass follows each of its motions, and
/// the momentum that film takes from it. Rows: translation, rotation; a guided body uses the third alone.
#[derive(Clone, Debug)]
pub struct Gathered {
    mass: Matrix6<f64>,
    momentum: Vector6<f64>,
}

impl Default for Gathered {
    fn default() -> Self {
        Gathered { mass: Matrix6::zeros(), momentum: Vector6::zeros() }
    }
}

impl Gathered {
    /// Adds film of `mass` (kg) and `momentum` (kg m/s) along z, all that a guided body feels.
    pub fn add_along_z(&mut self, mass: f64, momentum: f64) {
        self.mass[(2, 2)] += mass;
        self.momentum[2] += momentum;
    }

    /// These contacts and others.
    pub fn and(&self, others: &Gathered) -> Gathered {
        Gathered { mass: self.mass + others.mass, momentum: self.momentum + others.momentum }
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
            guided: true,
        }
    }

    /// A body at `pose` with six degrees of freedom and `velocity` (m/s), not spinning; `mass` in kg, `inertia` (kg m²) about
    /// its centre of mass in body axes.
    pub fn free(pose: Isometry3<f64>, velocity: Vector3<f64>, mass: f64, inertia: Matrix3<f64>) -> RigidBody {
        let spin = Vector3::zeros();
        let inverse_inertia = Matrix3::zeros();
        let mut body = RigidBody { pose, velocity, spin, mass, inertia, inverse_inertia, guided: false };
        body.update_inverse_inertia();
        body
    }

    /// A body at `pose` with the prescribed motion along z at `velocity` (m/s, upward).
    pub fn driven(pose: Isometry3<f64>, velocity: f64) -> RigidBody {
        RigidBody::guided(pose, velocity, f64::INFINITY)
    }

    /// How it moves.
    pub fn motion(&self) -> Motion {
        Motion {
            place: self.pose.translation.vector.into(),
            rotation: self.pose.rotation.coords.into(),
            velocity: self.velocity.into(),
            spin: self.spin.into(),
            inverse_inertia: self.inverse_inertia.into(),
        }
    }

    /// Moves as `motion` tells, to the bit: nothing is normalised or worked out again.
    pub fn resume(&mut self, motion: &Motion) {
        let turn = UnitQuaternion::new_unchecked(Quaternion::from_vector(Vector4::from(motion.rotation)));
        self.pose = Isometry3::from_parts(Translation3::from(motion.place), turn);
        self.velocity = motion.velocity.into();
        self.spin = motion.spin.into();
        self.inverse_inertia = motion.inverse_inertia.into();
    }

    /// Whether its motion is prescribed: then it has no energy of its own, and what it gives comes from outside.
    pub fn is_driven(&self) -> bool {
        self.mass.is_infinite()
    }

    /// Brings the inverse inertia to the present pose; a body that resists no rotation about some axis is kept from it.
    fn update_inverse_inertia(&mut self) {
        if !self.guided {
            self.inverse_inertia = self.space_inertia().try_inverse().unwrap_or_else(Matrix3::zeros);
        }
    }

    /// Velocity of its material point at `arm` (m) from the centre of mass.
    #[inline]
    pub fn velocity_at(&self, arm: &Vector3<f64>) -> Vector3<f64> {
        match self.guided {
            true => self.velocity,
            false => self.velocity + self.spin.cross(arm),
        }
    }

    /// Centre of mass.
    pub fn centre(&self) -> Point3<f64> {
        self.pose.translation.vector.into()
    }

    /// Where it will be after `dt` at its present velocity.
    pub fn predicted(&self, dt: f64) -> Isometry3<f64> {
        let turn = UnitQuaternion::from_scaled_axis(self.spin * dt);
        let to = self.pose.translation.vector + self.velocity * dt;
        Isometry3::from_parts(Translation3::from(to), turn * self.pose.rotation)
    }

    /// Moves on by `dt`.
    pub fn drift(&mut self, dt: f64) {
        self.pose = self.predicted(dt);
        self.pose.rotation.renormalize();
        self.update_inverse_inertia();
    }

    /// Gravity `g` (m/s², downward) and the gyroscopic moment over `dt`.
    pub fn kick(&mut self, dt: f64, g: f64) {
        self.velocity.z -= g * dt;
        if !self.guided {
            let moment = self.spin.cross(&(self.space_inertia() * self.spin));
            self.spin -= self.inverse_inertia * moment * dt;
        }
    }

    /// Takes up `impulse` (N s) at `arm` from the centre of mass, as far as the guide lets it.
    pub fn push(&mut self, impulse: &Vector3<f64>, arm: &Vector3<f64>) {
        self.push_about(impulse, &arm.cross(impulse));
    }

    /// Takes up impulses of the sum `impulse` (N s) and their `moment` about the centre of mass (N m s), as far as the guide
    /// lets it.
    pub fn push_about(&mut self, impulse: &Vector3<f64>, moment: &Vector3<f64>) {
        match self.guided {
            true => self.velocity.z += impulse.z / self.mass,
            false => {
                self.velocity += impulse / self.mass;
                self.spin += self.inverse_inertia * moment;
            }
        }
    }

    /// Work of impulses at its surface, their sum `impulse` (N s) and `moment` about the centre of mass (N m s), at the mean of
    /// its motion `before` and now, J.
    pub fn work_of(&self, impulse: &Vector3<f64>, moment: &Vector3<f64>, before: &RigidBody) -> f64 {
        let turned = match self.guided {
            true => 0.0,
            false => moment.dot(&(self.spin + before.spin)),
        };
        0.5 * (impulse.dot(&(self.velocity + before.velocity)) + turned)
    }

    /// Velocity per impulse along `direction` at `arm` from the centre of mass, 1/kg.
    pub fn mobility(&self, direction: &Vector3<f64>, arm: &Vector3<f64>) -> f64 {
        match self.guided {
            true => direction.z * direction.z / self.mass,
            false => {
                let lever = arm.cross(direction);
                1.0 / self.mass + lever.dot(&(self.inverse_inertia * lever))
            }
        }
    }

    /// Whether it only moves along z.
    #[inline(always)]
    pub fn is_guided(&self) -> bool {
        self.guided
    }

    /// Adds to `gathered` film of `mass` (kg) that a contact at `arm` drags along, in every direction or only along one,
    /// and the momentum `change` (kg m/s) that this film needs if the free body keeps its velocity.
    pub fn gather(
        &self,
        gathered: &mut Gathered,
        arm: &Vector3<f64>,
        mass: f64,
        along: Option<&Vector3<f64>>,
        change: &Vector3<f64>,
    ) {
        let mass = along.map_or(Matrix3::identity(), |n| n * n.transpose()) * mass;
        let lever = arm.cross_matrix();
        let turned = lever * mass;
        let blocks =
            [(0, 0, mass), (0, 3, mass * lever.transpose()), (3, 0, turned), (3, 3, turned * lever.transpose())];
        for (row, column, block) in blocks {
            let mut view = gathered.mass.fixed_view_mut::<3, 3>(row, column);
            view += block;
        }
        for (row, part) in [(0, *change), (3, arm.cross(change))] {
            let mut view = gathered.momentum.fixed_rows_mut::<3>(row);
            view += part;
        }
    }

    /// The body as it will be once the gathered contacts have acted: the implicit answer of a body and the film mass
    /// that follows it (theory.md, equation 20).
    pub fn after(&self, gathered: &Gathered) -> RigidBody {
        let mut body = self.clone();
        match self.guided {
            true => body.velocity.z -= gathered.momentum[2] / (self.mass + gathered.mass[(2, 2)]),
            false => {
                let mut own = Matrix6::from_diagonal_element(self.mass);
                own.fixed_view_mut::<3, 3>(3, 3).copy_from(&self.space_inertia());
                if let Some(inverse) = (own + gathered.mass).try_inverse() {
                    let change = inverse * gathered.momentum;
                    body.velocity -= change.fixed_rows::<3>(0);
                    body.spin -= change.fixed_rows::<3>(3);
                }
            }
        }
        body
    }

    /// Kinetic energy with velocities half a step before and after, J (theory.md, equation 23).
    pub fn kinetic_energy(&self, before: &RigidBody) -> f64 {
        if self.is_driven() {
            return 0.0;
        }
        let turning = self.spin.dot(&(self.space_inertia() * before.spin));
        0.5 * (self.mass * self.velocity.dot(&before.velocity) + turning)
    }

    /// Potential energy under gravity `g` (m/s², downward), J.
    pub fn potential_energy(&self, g: f64) -> f64 {
        if self.is_driven() { 0.0 } else { self.mass * g * self.centre().z }
    }

    fn space_inertia(&self) -> Matrix3<f64> {
        let turn = self.pose.rotation.to_rotation_matrix();
        turn * self.inertia * turn.transpose()
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

    /// One contact, solved implicitly, is the inelastic collision of two masses at a point.
    #[test]
    fn a_gathered_contact_is_an_inelastic_collision() {
        let at = Vector3::new(0.4, 0.1, -0.3);
        let film = 0.5;
        let body = free_body();
        let mut gathered = Gathered::default();
        let meeting = body.velocity_at(&at);
        body.gather(&mut gathered, &at, film, None, &(film * meeting));
        let after = body.after(&gathered);
        let mut pushed = body.clone();
        pushed.push(&(-film * after.velocity_at(&at)), &at);
        assert!((pushed.velocity - after.velocity).norm() < 1e-13);
        assert!((pushed.spin - after.spin).norm() < 1e-13);
    }

    /// Contact neither slows a driven body down nor turns up in its energy.
    #[test]
    fn a_driven_body_keeps_its_velocity() {
        let mut driven = RigidBody::driven(Isometry3::translation(0.0, 0.0, 1.0), -0.5);
        let at = Vector3::new(0.1, 0.0, -0.2);
        let mut gathered = Gathered::default();
        driven.gather(&mut gathered, &at, 3.0, None, &Vector3::new(1.0, 2.0, 3.0));
        assert_eq!(driven.after(&gathered).velocity.z, -0.5);
        driven.push(&Vector3::new(0.0, 0.0, 7.0), &at);
        driven.kick(1e-3, 0.0);
        assert_eq!((driven.velocity.z, driven.mobility(&Vector3::z(), &at)), (-0.5, 0.0));
        assert_eq!((driven.kinetic_energy(&driven.clone()), driven.potential_energy(9.81)), (0.0, 0.0));
    }

    /// Spinning freely about a general axis: energy and angular momentum stay.
    #[test]
    fn a_free_spin_keeps_its_angular_momentum() {
        let mut free = free_body();
        let start = free.space_inertia() * free.spin;
        let energy = free.kinetic_energy(&free.clone());
        let dt = 1e-5;
        for _ in 0..100_000 {
            free.kick(dt, 0.0);
            free.drift(dt);
        }
        assert!((free.space_inertia() * free.spin - start).norm() < 1e-4 * start.norm());
        assert!((free.kinetic_energy(&free.clone()) / energy - 1.0).abs() < 1e-4);
    }
}
