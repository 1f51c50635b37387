//! Sensors whose voltage scales turn into what they measure.

/// A strain gauge bridge.
#[derive(Clone, Debug, PartialEq)]
pub struct Strain {
    pub configuration: u32,
    pub poisson: f64,
    /// 1 over 1 plus the resistance of the leads over that of the gauge.
    pub lead: f64,
    pub initial: f64,
    pub gauge_factor: f64,
    pub gain: f64,
    pub excitation: f64,
}

/// A resistance thermometer: the Callendar–Van Dusen equation, IEC 60751.
#[derive(Clone, Debug, PartialEq)]
pub struct Resistance {
    pub current: f64,
    pub nominal: f64,
    pub coefficients: [f64; 3],
    /// Resistance of the leads in the measured one.
    pub leads: f64,
}

/// A thermistor: the equation of Steinhart and Hart.
#[derive(Clone, Debug, PartialEq)]
pub struct Thermistor {
    pub is_current: bool,
    pub excitation: f64,
    pub reference: f64,
    pub leads: f64,
    pub coefficients: [f64; 3],
    pub offset: f64,
}

impl Strain {
    /// The strain at which a bridge gives the voltage.
    pub fn strain(&self, voltage: f64) -> f64 {
        let (g, v, nu) = (self.gauge_factor, self.excitation, self.poisson);
        let out = voltage - self.initial;
        match self.configuration {
            10_183 => -out * self.gain / (v * g),
            10_184 => -2.0 * out * self.gain / (v * g * (1.0 + nu)),
            10_185 => -2.0 * out * self.gain / (g * (v * (1.0 + nu) + out * (1.0 - nu))),
            10_188 => -4.0 * out * self.gain / (g * v * self.lead * (1.0 + nu + 2.0 * out / v * (1.0 - nu))),
            10_189 => -2.0 * out * self.gain / (g * v * self.lead),
            _ => 2.0 * self.gain / (g * self.lead) * (1.0 / (1.0 + 2.0 * out / v) - 1.0),
        }
    }

    /// Numbers of full bridges, half bridges and quarter bridges.
    pub const CONFIGURATIONS: [f64; 7] = [10_183.0, 10_184.0, 10_185.0, 10_188.0, 10_189.0, 10_271.0, 10_272.0];
}

impl Resistance {
    /// The temperature, °C, at which the thermometer has the voltage.
    pub fn temperature(&self, voltage: f64) -> f64 {
        let [a, b, c] = self.coefficients;
        let ratio = (voltage / self.current - self.leads) / self.nominal;
        let above = (-a + (a * a - 4.0 * b * (1.0 - ratio)).sqrt()) / (2.0 * b);
        if ratio >= 1.0 {
            return above;
        }
        // Below 0 °C the equation is of fourth order; Newton's method from the solution of the second converges in a few
        // steps.
        (0..20).fold(above, |t, _| {
            let value = 1.0 + t * (a + t * (b + (t - 100.0) * c * t)) - ratio;
            let slope = a + t * (2.0 * b + c * t * (4.0 * t - 300.0));
            t - value / slope
        })
    }
}

impl Thermistor {
    /// The temperature, K less the offset, at which the thermistor has the voltage.
    pub fn temperature(&self, voltage: f64) -> f64 {
        let measured = match self.is_current {
            true => voltage / self.excitation,
            false => self.reference / (self.excitation / voltage - 1.0),
        };
        let logarithm = (measured - self.leads).ln();
        let [a, b, c] = self.coefficients;
        1.0 / (a + logarithm * (b + logarithm * logarithm * c)) - self.offset
    }
}
