//! `[loading.…]`: exactly one of them.

use base::units::{Acceleration, Angle, Length, Pressure, Time, Velocity, Volume};

keys! {
    /// The loading of the specimen.
    pub enum Loading {
        /// An impactor falls, flies or swings onto the film, or film falls onto it.
        Impact(Impact),
        /// Two jaws, the edges x- and x+, part along x.
        Stretch(Stretch),
        /// The impactor moves slowly down into the film at a prescribed speed.
        Indent(Indent),
        /// Pressure on the lower side of the film, held all around, inflates it; of several faces it acts on the lowest, which
        /// presses on those above it.
        Pressure(Inflation),
        /// Gas let in under one face of film, held all around, inflates it, also beyond the largest pressure that it carries.
        Volume(Filling),
    }

    /// An impact.
    #[schemars(extend("not" = { "required": ["velocity", "drop_height"] }))]
    pub struct Impact {
        /// Speed at the start, at first contact where the impactor starts there, downward positive; on a guide along a line,
        /// down the line. `impactor.velocity` is one in any direction.
        velocity: Option<Velocity>, above 0, likely [1e-3, 500.0], title "Impact speed";
        /// Drop height of an ideal free fall to first contact, in place of `velocity`.
        drop_height: Option<Length>, above 0, likely [1e-3, 30.0], title "Drop height";
        /// Acceleration of free fall.
        gravity: Acceleration, default "standard_gravity", from 0, likely [1e-3, 300.0];
        /// Simulated time from the start: from first contact, unless the impactor starts above the film.
        duration: Time, above 0, likely [1e-6, 5.0];
    }

    /// A tensile test of a coupon or of a single element.
    pub struct Stretch {
        /// Direction of loading in the film: along MD, along TD, or an angle from MD.
        direction: Direction;
        /// Speed at which the jaws part, both together.
        velocity: Velocity, above 0;
        /// Engineering strain at which the test ends.
        until: f64, above 0, to 100;
        /// Factor on the film's mass that lengthens the time step; chosen from the number of steps where it
        /// is left out.
        mass_scaling: Option<f64>, from 1;
    }

    /// Direction of loading. The validator has reported mistakes before serde tries the two forms.
    #[derive(Copy, PartialEq)]
    pub enum Direction of forms {
        /// Along MD or TD.
        Axis(Axis),
        /// An angle from MD.
        Angle(Angle),
    }

    /// A direction of the film.
    pub enum Axis of words {
        /// The machine direction.
        #[serde(rename = "MD")]
        Machine,
        /// The transverse direction.
        #[serde(rename = "TD")]
        Transverse,
    }

    /// A slow indentation: the film is in equilibrium throughout.
    pub struct Indent {
        /// Travel of the impactor from first contact, downward, at which the test ends.
        depth: Length, above 0, likely [1e-5, 2.0];
        /// Speed of the impactor.
        velocity: Velocity, above 0;
        /// Factor on the film's mass that lengthens the time step; where it is left out, chosen so that the
        /// loading lasts 50 periods of the film.
        mass_scaling: Option<f64>, from 1;
    }

    /// A slow inflation: the film is in equilibrium throughout.
    pub struct Inflation {
        /// Final difference of the pressures below and above the film.
        pressure: Pressure, above 0, likely [1.0, 1e8];
        /// Time in which the pressure rises, smoothly at both ends; it is then constant for half as long.
        ramp: Time, above 0;
        /// Factor on the film's mass that lengthens the time step; where it is left out, chosen so that the
        /// loading lasts 50 periods of the film.
        mass_scaling: Option<f64>, from 1;
    }

    /// A slow inflation by a volume of gas: the film is in equilibrium throughout.
    pub struct Filling {
        /// Volume of the gas under the film at the end, at the pressure that it has there; of the whole film, also where its
        /// symmetry is used.
        volume: Volume, above 0, likely [1e-9, 100.0];
        /// Time in which the gas is let in, smoothly at both ends; its volume is then constant for half as long.
        ramp: Time, above 0;
        /// Factor on the film's mass that lengthens the time step; where it is left out, chosen so that the
        /// loading lasts 100 periods of the film.
        mass_scaling: Option<f64>, from 1;
    }
}

fn standard_gravity() -> Acceleration {
    Acceleration(9.81)
}
