//! Scales: what the properties of a channel say its stored numbers mean, each scale applied to the one before it.
//!
//! What National Instruments does not document, the names of the properties, is as `npTDMS` found it in files.

use super::value::{Properties, number, text};

/// The scales that lead from the stored number to the value.
#[derive(Clone, Debug, PartialEq)]
pub struct Scales {
    /// The scaler of DAQmx that they begin with; none where they begin with the stored number.
    pub scaler: Option<u32>,
    /// The first that is applied comes last.
    steps: Vec<Step>,
}

/// One scale.
#[derive(Clone, Debug, PartialEq)]
enum Step {
    Polynomial(Vec<f64>),
    /// Pairs of input and output, by increasing input.
    Table(Vec<[f64; 2]>),
}

/// Most scales of a channel, and values of a table or coefficients.
const MOST_SCALES: f64 = 256.0;
const MOST_COEFFICIENTS: f64 = 100_000.0;
/// The input source that is the stored number.
const STORED: f64 = u32::MAX as f64;

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
        let count = count as usize;
        let mut steps = Vec::new();
        let mut next = Some(count - 1);
        for _ in 0..count {
            let Some(scale) = next else { break };
            if scale >= count {
                return Err(format!("a scale is applied to scale {scale}, which it does not have"));
            }
            let reader = Reader { properties, scale };
            let Some(kind) = text(properties, &reader.name("Scale_Type")) else {
                return Ok(Some(Scales { scaler: Some(scale as u32), steps }));
            };
            steps.extend(reader.step(kind)?);
            next = reader.input(kind);
        }
        match next {
            Some(scale) => Err(format!("scale {scale} is applied to itself")),
            None => Ok(Some(Scales { scaler: None, steps })),
        }
    }

    /// The value that stands for what is stored, or for what the scaler gives.
    pub fn apply(&self, stored: f64) -> f64 {
        self.steps.iter().rfold(stored, |x, step| match step {
            Step::Polynomial(coefficients) => {
                coefficients.iter().rev().fold(0.0, |sum, coefficient| sum * x + coefficient)
            }
            Step::Table(pairs) => interpolated(pairs, x),
        })
    }
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
    /// What it does; nothing where it is the input as it is.
    fn step(&self, kind: &str) -> Result<Option<Step>, String> {
        Ok(match kind {
            "Linear" => {
                let coefficients = [self.number("Linear_Y_Intercept")?, self.number("Linear_Slope")?];
                Some(Step::Polynomial(coefficients.into()))
            }
            "Polynomial" => {
                let count = self.count("Polynomial_Coefficients_Size", Some(4.0))?;
                let one = |place| self.number(&format!("Polynomial_Coefficients[{place}]"));
                Some(Step::Polynomial((0..count).map(one).collect::<Result<Vec<_>, _>>()?))
            }
            "Table" => Some(Step::Table(self.table()?)),
            "AdvancedAPI" => None,
            other => {
                return Err(format!(
                    "scale {} is of the kind {other}, which is not applied; save it scaled, e.g. as a table",
                    self.scale
                ));
            }
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

    /// The scale to whose result it is applied; none where that is the stored number.
    fn input(&self, kind: &str) -> Option<usize> {
        let source = number(self.properties, &self.name(&format!("{kind}_Input_Source")));
        source.filter(|scale| *scale < STORED).map(|scale| scale.max(0.0) as usize)
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
}

#[cfg(test)]
mod tests {
    use super::super::value::Value;
    use super::*;

    fn read(own: &[(&str, Value)]) -> Result<Option<Scales>, String> {
        Scales::read(&own.iter().map(|(name, value)| (format!("NI_Scale{name}"), value.clone())).collect())
    }

    #[test]
    fn scales_of_sensors_are_refused_by_name() {
        for kind in ["RTD", "Thermistor", "Strain", "Thermocouple", "Add", "Subtract"] {
            let error = read(&[("[0]_Scale_Type", Value::Text(kind.into()))]).unwrap_err();
            assert!(error.starts_with(&format!("scale 0 is of the kind {kind}, which is not applied")), "{error}");
        }
    }

    #[test]
    fn a_circle_of_scales_is_refused() {
        let same = || Value::Text("AdvancedAPI".into());
        let input = |scale: f64| Value::Number(scale);
        for source in [0.0, 1.0, 7.0] {
            let own = [
                ("[0]_Scale_Type", same()),
                ("[0]_AdvancedAPI_Input_Source", input(source)),
                ("[1]_Scale_Type", same()),
                ("[1]_AdvancedAPI_Input_Source", input(0.0)),
            ];
            assert!(read(&own).is_err(), "{source}");
        }
    }
}
