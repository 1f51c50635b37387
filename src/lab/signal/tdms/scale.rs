//! Scales: what the properties of a channel say its stored numbers mean, each scale applied to those before it.
//!
//! What National Instruments does not document (names of the properties, the sign of `Subtract`, the configurations of
//! bridges) is as `npTDMS` found it in files.

use super::property::{Properties, number, text};
use super::sensor::{Resistance, Strain, Thermistor};

/// What a scale is applied to.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Input {
    /// The stored number.
    Stored,
    /// The result of another scale.
    Scale(usize),
}

/// One scale.
#[derive(Clone, Debug, PartialEq)]
enum Scale {
    /// The scaler of DAQmx with this number.
    Scaler(u32),
    /// The input as it is.
    Same(Input),
    Polynomial(Vec<f64>, Input),
    /// Pairs of input and output, by increasing input.
    Table(Vec<[f64; 2]>, Input),
    Strain(Strain, Input),
    Resistance(Resistance, Input),
    Thermistor(Thermistor, Input),
    Add(Input, Input),
    /// The second less the first.
    Subtract(Input, Input),
}

/// The scales of a channel, in an order in which each follows those that it needs.
#[derive(Clone, Debug, PartialEq)]
pub struct Scales {
    scales: Vec<Scale>,
    order: Vec<usize>,
}

/// Most scales of a channel, and values of a table or coefficients.
const MOST_SCALES: f64 = 256.0;
const MOST_COEFFICIENTS: f64 = 100_000.0;
/// The input source that is the stored number.
const STORED: f64 = u32::MAX as f64;
/// The kind of excitation that is a current.
const CURRENT: f64 = 10_134.0;

impl Scales {
    /// Of these properties; none where they have none, or where they are applied already.
    ///
    /// # Errors
    /// Why they cannot be applied.
    pub fn read(properties: &Properties) -> Result<Option<Scales>, String> {
        let stated = number(properties, "NI_Number_Of_Scales");
        let numbered = properties.keys().filter_map(|key| {
            key.strip_prefix("NI_Scale[")?.strip_suffix("]_Scale_Type")?.parse::<u32>().ok()?.checked_add(1)
        });
        let count = stated.or_else(|| numbered.max().map(f64::from)).unwrap_or(0.0);
        if count.is_nan() || count < 1.0 || text(properties, "NI_Scaling_Status") == Some("scaled") {
            return Ok(None);
        }
        if count > MOST_SCALES {
            return Err(format!("it has {count} scales"));
        }
        let reader = |scale| Reader { properties, scale };
        let scales = (0..count as usize).map(|scale| reader(scale).read()).collect::<Result<Vec<_>, _>>()?;
        let order = order(&scales)?;
        Ok(Some(Scales { scales, order }))
    }

    /// The numbers of the scalers of DAQmx that the scales need.
    pub fn scalers(&self) -> impl Iterator<Item = u32> {
        self.order.iter().filter_map(|scale| match self.scales[*scale] {
            Scale::Scaler(id) => Some(id),
            _ => None,
        })
    }

    /// Whether the scales need the stored number itself.
    pub fn need_stored(&self) -> bool {
        self.order.iter().any(|scale| self.scales[*scale].inputs().contains(&Some(Input::Stored)))
    }

    /// The value of which `stored` is stored, and `scaler` what each scaler gives; `results` is room for those of the
    /// scales.
    pub fn apply(&self, stored: f64, scaler: impl Fn(u32) -> f64, results: &mut Vec<f64>) -> f64 {
        results.resize(self.scales.len(), f64::NAN);
        for scale in &self.order {
            let of = |input: &Input| match input {
                Input::Stored => stored,
                Input::Scale(other) => results[*other],
            };
            results[*scale] = match &self.scales[*scale] {
                Scale::Scaler(id) => scaler(*id),
                Scale::Same(input) => of(input),
                Scale::Polynomial(coefficients, input) => {
                    let x = of(input);
                    coefficients.iter().rev().fold(0.0, |sum, coefficient| sum * x + coefficient)
                }
                Scale::Table(pairs, input) => interpolated(pairs, of(input)),
                Scale::Strain(bridge, input) => bridge.strain(of(input)),
                Scale::Resistance(thermometer, input) => thermometer.temperature(of(input)),
                Scale::Thermistor(thermistor, input) => thermistor.temperature(of(input)),
                Scale::Add(left, right) => of(left) + of(right),
                Scale::Subtract(left, right) => of(right) - of(left),
            };
        }
        results.last().copied().unwrap_or(stored)
    }
}

impl Scale {
    fn inputs(&self) -> [Option<Input>; 2] {
        match self {
            Scale::Scaler(_) => [None; 2],
            Scale::Same(input)
            | Scale::Polynomial(_, input)
            | Scale::Table(_, input)
            | Scale::Strain(_, input)
            | Scale::Resistance(_, input)
            | Scale::Thermistor(_, input) => [Some(*input), None],
            Scale::Add(left, right) | Scale::Subtract(left, right) => [Some(*left), Some(*right)],
        }
    }
}

/// The scales that the last one needs, each after those that it needs itself.
fn order(scales: &[Scale]) -> Result<Vec<usize>, String> {
    let mut order = Vec::new();
    // 0: not seen, 1: its inputs are being ordered, 2: ordered.
    let mut state = vec![0_u8; scales.len()];
    let mut open = vec![scales.len() - 1];
    while let Some(scale) = open.last().copied() {
        if state[scale] == 2 {
            open.pop();
            continue;
        }
        let inputs = scales[scale].inputs().into_iter().flatten();
        let needed: Vec<usize> = inputs
            .filter_map(|input| match input {
                Input::Scale(other) => Some(other),
                Input::Stored => None,
            })
            .collect();
        if let Some(missing) = needed.iter().find(|other| **other >= scales.len()) {
            return Err(format!("scale {scale} is applied to scale {missing}, which it does not have"));
        }
        let next = needed.into_iter().find(|other| state[*other] != 2);
        match next {
            Some(other) if state[other] == 1 => return Err(format!("scale {other} is applied to itself")),
            Some(other) => open.push(other),
            None => {
                order.push(scale);
                open.pop();
            }
        }
        state[scale] = if next.is_some() { 1 } else { 2 };
    }
    Ok(order)
}

/// Linear between the pairs, constant beyond them.
fn interpolated(pairs: &[[f64; 2]], x: f64) -> f64 {
    let after = pairs.partition_point(|pair| pair[0] < x);
    match (after.checked_sub(1).map(|before| pairs[before]), pairs.get(after)) {
        (Some(before), Some(after)) => before[1] + (x - before[0]) * ((after[1] - before[1]) / (after[0] - before[0])),
        (Some(end), None) | (None, Some(&end)) => end[1],
        (None, None) => f64::NAN,
    }
}

/// Reads one scale.
struct Reader<'a> {
    properties: &'a Properties,
    scale: usize,
}

impl Reader<'_> {
    fn read(&self) -> Result<Scale, String> {
        let Some(kind) = text(self.properties, &self.name("Scale_Type")) else {
            return Ok(Scale::Scaler(self.scale as u32));
        };
        Ok(match kind {
            "Linear" => {
                let coefficients = [self.number("Linear_Y_Intercept")?, self.number("Linear_Slope")?];
                Scale::Polynomial(coefficients.into(), self.input("Linear"))
            }
            "Polynomial" => {
                let count = self.count("Polynomial_Coefficients_Size", Some(4.0))?;
                let one = |place| self.number(&format!("Polynomial_Coefficients[{place}]"));
                let coefficients = (0..count).map(one).collect::<Result<Vec<_>, _>>()?;
                Scale::Polynomial(coefficients, self.input("Polynomial"))
            }
            "Table" => Scale::Table(self.table()?, self.input("Table")),
            "Strain" => Scale::Strain(self.strain()?, self.input("Strain")),
            "RTD" => Scale::Resistance(self.resistance()?, self.input("RTD")),
            "Thermistor" => Scale::Thermistor(self.thermistor()?, self.input("Thermistor")),
            "Add" => Scale::Add(self.input("Add_Left_Operand"), self.input("Add_Right_Operand")),
            "Subtract" => Scale::Subtract(self.input("Subtract_Left_Operand"), self.input("Subtract_Right_Operand")),
            "AdvancedAPI" => Scale::Same(self.input("AdvancedAPI")),
            other => return Err(format!("scale {} is of the kind {other}, which is not known here", self.scale)),
        })
    }

    fn name(&self, what: &str) -> String {
        format!("NI_Scale[{}]_{what}", self.scale)
    }

    fn number(&self, what: &str) -> Result<f64, String> {
        let name = self.name(what);
        number(self.properties, &name).ok_or_else(|| format!("the property `{name}` is missing"))
    }

    fn count(&self, what: &str, default: Option<f64>) -> Result<usize, String> {
        let stated = number(self.properties, &self.name(what)).or(default).map_or_else(|| self.number(what), Ok)?;
        let fits = (0.0..=MOST_COEFFICIENTS).contains(&stated);
        if fits { Ok(stated as usize) } else { Err(format!("`{}` is {stated}", self.name(what))) }
    }

    fn input(&self, what: &str) -> Input {
        match number(self.properties, &self.name(&format!("{what}_Input_Source"))) {
            Some(scale) if scale < STORED => Input::Scale(scale.max(0.0) as usize),
            _ => Input::Stored,
        }
    }

    fn table(&self) -> Result<Vec<[f64; 2]>, String> {
        let count = self.count("Table_Pre_Scaled_Values_Size", None)?;
        if self.count("Table_Scaled_Values_Size", None)? != count {
            return Err(format!("the table of scale {} has inputs and outputs of different number", self.scale));
        }
        let pair = |place| {
            let value = |what| self.number(&format!("Table_{what}_Values[{place}]"));
            Ok([value("Pre_Scaled")?, value("Scaled")?])
        };
        let mut pairs = (0..count).map(pair).collect::<Result<Vec<_>, String>>()?;
        let rises = |pairs: &[[f64; 2]]| pairs.windows(2).all(|pair| pair[0][0] < pair[1][0]);
        if !rises(&pairs) {
            pairs.reverse();
        }
        if rises(&pairs) {
            Ok(pairs)
        } else {
            Err(format!("the inputs of the table of scale {} do not rise", self.scale))
        }
    }

    fn strain(&self) -> Result<Strain, String> {
        let of = |what: &str| self.number(&format!("Strain_{what}"));
        let configuration = of("Configuration")?;
        if !Strain::CONFIGURATIONS.contains(&configuration) {
            return Err(format!("scale {} is of the bridge {configuration}, which is not known here", self.scale));
        }
        Ok(Strain {
            configuration: configuration as u32,
            poisson: of("Poisson_Ratio")?,
            lead: 1.0 / (1.0 + of("Lead_Wire_Resistance")? / of("Gage_Resistance")?),
            initial: of("Initial_Bridge_Voltage")?,
            gauge_factor: of("Gage_Factor")?,
            gain: of("Bridge_Shunt_Calibration_Gain_Adjustment")?,
            excitation: of("Voltage_Excitation")?,
        })
    }

    fn resistance(&self) -> Result<Resistance, String> {
        let of = |what: &str| self.number(&format!("RTD_{what}"));
        Ok(Resistance {
            current: of("Current_Excitation")?,
            nominal: of("R0_Nominal_Resistance")?,
            coefficients: [of("A")?, of("B")?, of("C")?],
            leads: leads(true, of("Resistance_Configuration")?) * of("Lead_Wire_Resistance")?,
        })
    }

    fn thermistor(&self) -> Result<Thermistor, String> {
        let of = |what: &str| self.number(&format!("Thermistor_{what}"));
        let is_current = of("Excitation_Type")? == CURRENT;
        Ok(Thermistor {
            is_current,
            excitation: of("Excitation_Value")?,
            reference: of("R1_Reference_Resistance")?,
            leads: leads(is_current, of("Resistance_Configuration")?) * of("Lead_Wire_Resistance")?,
            coefficients: [of("A")?, of("B")?, of("C")?],
            offset: of("Temperature_Offset")?,
        })
    }
}

/// How many leads are measured with a resistance: of three wires one, of two wires two under a current.
fn leads(is_current: bool, wires: f64) -> f64 {
    match wires {
        3.0 => 1.0,
        2.0 if is_current => 2.0,
        _ => 0.0,
    }
}
