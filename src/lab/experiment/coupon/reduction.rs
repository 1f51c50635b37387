use std::collections::BTreeSet;

use serde::Serialize;

use super::average::{SampleStatistics, mean_curve};
use super::label::{Direction, is_same_speed};
use super::recording::not_positive;
use super::{BREAK_SHARE, Curve, Modulus, Rupture, Slack, WINDOW, YieldPoints, yield_points};
use crate::error::{Error, refusal};
use base::number::significant;

/// How curves are read.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rules {
    /// Strains between which the modulus is fitted.
    pub window: [f64; 2],
    /// Share of the largest force below which a coupon is broken.
    pub break_share: f64,
    /// Whether strain is counted from where the line of the steepest part meets zero stress (ISO 527-1, ASTM D882), not from
    /// the recording's zero; everything is then read from the shifted curve.
    pub toe_compensation: bool,
}

impl Default for Rules {
    fn default() -> Rules {
        Rules { window: WINDOW, break_share: BREAK_SHARE, toe_compensation: false }
    }
}

/// One tested coupon.
#[derive(Clone, Debug, PartialEq)]
pub struct Sample {
    /// Along which it was cut.
    pub direction: Direction,
    /// Speed of the jaws apart, m/s.
    pub velocity: f64,
    /// Line of the elastic part.
    pub modulus: Modulus,
    /// End of the curve.
    pub rupture: Rupture,
    /// Up to the break.
    pub curve: Curve,
    /// Slack at its start, where it counts and is not compensated.
    pub slack: Option<Slack>,
    /// The largest stress, Pa, where it may be the end of the load cell's range.
    pub saturated: Option<f64>,
    /// Stress that stays after the break, Pa.
    pub after_break: Option<f64>,
    /// Whether its file marks the recording as virtual.
    pub is_virtual: bool,
}

impl Sample {
    /// Reads modulus and break of `curve` by the `rules`, and stores the curve up to the break. It counts as measured.
    pub fn new(direction: Direction, velocity: f64, curve: &Curve, rules: &Rules) -> Result<Sample, Error> {
        if !(velocity.is_finite() && velocity > 0.0) {
            return Err(not_positive(velocity));
        }
        let curve = &match rules.toe_compensation {
            true => {
                let line = curve.steepest(rules.window)?;
                curve.toe_compensated(line.slope, line.intercept)
            }
            false => curve.clone(),
        };
        let (modulus, rupture) = (curve.modulus(rules.window)?, curve.rupture(rules.break_share)?);
        let slack = if rules.toe_compensation { None } else { curve.slack(rules.window, &modulus) };
        let (saturated, after_break) = (curve.saturated(), curve.after_break(&rupture));
        let whole = curve.within([f64::NEG_INFINITY, rupture.strain]);
        let curve = whole
            .ok_or_else(|| refusal!("the coupon broke at the strain {}, before its second sample", rupture.strain))?;
        Ok(Sample { direction, velocity, modulus, rupture, curve, slack, saturated, after_break, is_virtual: false })
    }
}

/// The coupons of one direction tested at one speed.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SpeedMeans {
    /// Speed of the jaws apart, m/s.
    pub velocity: f64,
    /// Young's modulus of each coupon, Pa, in the order given.
    pub moduli: Vec<f64>,
    /// Young's modulus, Pa.
    pub modulus: SampleStatistics,
    /// Tensile strength, Pa.
    pub strength: SampleStatistics,
    /// Break elongation.
    pub elongation: SampleStatistics,
    /// Mean of the coupons' curves up to the first break.
    #[serde(skip)]
    pub curve: Curve,
}

/// The coupons of one direction: means of the means of their speeds.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DirectionMeans {
    /// Along which it was cut.
    #[serde(skip)]
    pub direction: Direction,
    /// From the slowest to the fastest.
    #[serde(skip)]
    pub speeds: Vec<SpeedMeans>,
    /// Young's modulus, Pa.
    pub modulus: SampleStatistics,
    /// Tensile strength, Pa.
    pub strength: SampleStatistics,
    /// Break elongation.
    pub elongation: SampleStatistics,
    /// Stress at the break, Pa.
    pub break_stress: SampleStatistics,
    /// Mean of the speeds' curves up to the first break.
    #[serde(skip)]
    pub curve: Curve,
    /// Yield points of that mean curve.
    #[serde(skip)]
    pub yields: Result<YieldPoints, Error>,
    /// How many of the coupons are virtual: computed, not measured.
    pub virtual_recordings: usize,
}

/// All coupons of a film, reduced direction by direction.
#[derive(Clone, Debug, PartialEq)]
pub struct Reduction {
    /// In the order MD, TD, D3, D4 and then by angle, as far as they were measured.
    pub directions: Vec<DirectionMeans>,
    /// Mean of the moduli of MD and TD, Pa (Table 6); none where one of them was not measured.
    pub modulus: Option<f64>,
}

impl Reduction {
    /// Averages `samples` per direction and speed, then over the speeds of each direction, as the paper does.
    pub fn from_samples(samples: &[Sample], rules: &Rules) -> Result<Reduction, Error> {
        if samples.is_empty() {
            return Err(refusal!("there is no coupon to reduce"));
        }
        let measured: BTreeSet<Direction> = samples.iter().map(|sample| sample.direction).collect();
        let directions =
            measured.into_iter().map(|direction| along(direction, samples, rules)).collect::<Result<Vec<_>, _>>()?;
        let modulus =
            |direction| directions.iter().find(|d| d.direction == direction).map(|d: &DirectionMeans| d.modulus.mean);
        let modulus = modulus(Direction::Md).zip(modulus(Direction::Td)).map(|(md, td)| 0.5 * (md + td));
        Ok(Reduction { directions, modulus })
    }

    /// Means along `direction`.
    pub fn along(&self, direction: Direction) -> Option<&DirectionMeans> {
        self.directions.iter().find(|along| along.direction == direction)
    }

    /// How many coupons there are.
    pub fn recordings(&self) -> usize {
        self.directions.iter().map(DirectionMeans::recordings).sum()
    }

    /// How many of them are virtual: computed, not measured.
    pub fn virtual_recordings(&self) -> usize {
        self.directions.iter().map(|along| along.virtual_recordings).sum()
    }

    /// The slowest and the fastest speed of the jaws, m/s.
    pub fn velocities(&self) -> [f64; 2] {
        let speeds = self.directions.iter().flat_map(|along| &along.speeds).map(|speed| speed.velocity);
        speeds.fold([f64::INFINITY, 0.0], |[slowest, fastest], speed| [slowest.min(speed), fastest.max(speed)])
    }
}

impl DirectionMeans {
    /// How many coupons there are.
    pub fn recordings(&self) -> usize {
        self.elongation.count
    }
}

fn along(direction: Direction, samples: &[Sample], rules: &Rules) -> Result<DirectionMeans, Error> {
    let samples: Vec<&Sample> = samples.iter().filter(|sample| sample.direction == direction).collect();
    let mut velocities: Vec<f64> = samples.iter().map(|sample| sample.velocity).collect();
    velocities.sort_by(f64::total_cmp);
    velocities.dedup_by(|faster, slower| is_same_speed(*faster, *slower));
    let groups: Vec<Vec<&Sample>> = velocities
        .iter()
        .map(|velocity| samples.iter().copied().filter(|sample| is_same_speed(sample.velocity, *velocity)).collect())
        .collect();
    let speeds = groups.iter().zip(&velocities).map(|(group, velocity)| {
        at_speed(*velocity, group)
            .map_err(|error| error.about(format!("{direction} at {} m/s", significant(*velocity, 6))))
    });
    let speeds = speeds.collect::<Result<Vec<_>, _>>()?;
    over_speeds(direction, &groups, speeds, rules).map_err(|error| error.about(direction))
}

fn at_speed(velocity: f64, samples: &[&Sample]) -> Result<SpeedMeans, Error> {
    let moduli = figures(samples, |sample| sample.modulus.slope);
    let curves: Vec<Curve> = samples.iter().map(|sample| sample.curve.clone()).collect();
    Ok(SpeedMeans {
        velocity,
        modulus: SampleStatistics::from_figures(&moduli)?,
        moduli,
        strength: SampleStatistics::from_figures(&figures(samples, |sample| sample.rupture.strength))?,
        elongation: SampleStatistics::from_figures(&figures(samples, |sample| sample.rupture.strain))?,
        curve: mean_curve(&curves)?,
    })
}

fn over_speeds(
    direction: Direction,
    groups: &[Vec<&Sample>],
    speeds: Vec<SpeedMeans>,
    rules: &Rules,
) -> Result<DirectionMeans, Error> {
    let spread = |figure: fn(&Sample) -> f64| {
        let groups: Vec<Vec<f64>> = groups.iter().map(|group| figures(group, figure)).collect();
        SampleStatistics::from_groups(&groups)
    };
    let curves: Vec<Curve> = speeds.iter().map(|speed| speed.curve.clone()).collect();
    let curve = mean_curve(&curves)?;
    Ok(DirectionMeans {
        direction,
        modulus: spread(|sample| sample.modulus.slope)?,
        strength: spread(|sample| sample.rupture.strength)?,
        elongation: spread(|sample| sample.rupture.strain)?,
        break_stress: spread(|sample| sample.rupture.stress)?,
        yields: yield_points(&curve, rules.window),
        virtual_recordings: groups.iter().flatten().filter(|sample| sample.is_virtual).count(),
        curve,
        speeds,
    })
}

fn figures(samples: &[&Sample], figure: impl Fn(&Sample) -> f64) -> Vec<f64> {
    samples.iter().map(|sample| figure(sample)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A bilinear curve that breaks, then two samples of nothing.
    fn sample(direction: Direction, velocity: f64, modulus: f64, elongation: f64) -> Sample {
        let mut strain: Vec<f64> = (0..=200).map(|i| elongation * f64::from(i) / 200.0).collect();
        let mut stress: Vec<f64> = strain.iter().map(|e| modulus * e.min(0.1) + 5e6 * (e - 0.1).max(0.0)).collect();
        strain.extend([elongation + 0.01, elongation + 0.02]);
        stress.extend([0.0, 0.0]);
        let curve = Curve::new(strain, stress).unwrap();
        Sample::new(direction, velocity, &curve, &Rules::default()).unwrap()
    }

    #[test]
    fn directions_are_means_of_the_means_of_their_speeds() {
        let md = |velocity, modulus, elongation| sample(Direction::Md, velocity, modulus, elongation);
        let samples = [md(0.2, 30e6, 1.0), md(0.02, 50e6, 0.8), md(0.02, 60e6, 1.2), md(0.02, 70e6, 1.3)];
        let reduction = Reduction::from_samples(&samples, &Rules::default()).unwrap();
        let along = reduction.along(Direction::Md).unwrap();
        let velocities: Vec<f64> = along.speeds.iter().map(|speed| speed.velocity).collect();
        assert_eq!(velocities, [0.02, 0.2]);
        assert!((along.speeds[0].modulus.mean / 60e6 - 1.0).abs() < 1e-9);
        assert!((along.modulus.mean / 45e6 - 1.0).abs() < 1e-9);
        assert!((along.elongation.mean - 1.05).abs() < 1e-9);
        assert_eq!((along.elongation.count, reduction.modulus), (4, None));
        assert!((along.curve.range()[1] - 0.8).abs() < 1e-12);
        assert_eq!(reduction.velocities(), [0.02, 0.2]);
    }

    #[test]
    fn virtual_coupons_are_counted() {
        let pulled = sample(Direction::Md, 0.02, 40e6, 1.0);
        let made_up = |direction| Sample { is_virtual: true, ..sample(direction, 0.2, 60e6, 1.0) };
        let samples = [pulled, made_up(Direction::Md), made_up(Direction::Td)];
        let reduction = Reduction::from_samples(&samples, &Rules::default()).unwrap();
        assert_eq!((reduction.recordings(), reduction.virtual_recordings()), (3, 2));
        assert_eq!(reduction.along(Direction::Md).unwrap().virtual_recordings, 1);
    }

    #[test]
    fn toe_compensation_removes_slack_from_strain_and_break() {
        let strain: Vec<f64> = (0..=110).map(|i| 0.01 * f64::from(i)).collect();
        let stress = strain.iter().map(|e| 20e6 * (e - 0.1).max(0.0)).collect();
        let curve = Curve::new(strain, stress).unwrap();
        let rules = Rules { window: [0.2, 0.4], toe_compensation: true, ..Rules::default() };
        let sample = Sample::new(Direction::Md, 0.02, &curve, &rules).unwrap();
        assert!((sample.rupture.strain - 1.0).abs() < 1e-9);
        assert!((sample.modulus.slope / 20e6 - 1.0).abs() < 1e-9);
    }

    #[test]
    fn directions_have_an_order() {
        let angles = ["30deg", "D4", "15deg", "md"].map(|word| sample(word.parse().unwrap(), 0.02, 40e6, 1.0));
        let reduction = Reduction::from_samples(&angles, &Rules::default()).unwrap();
        let names: Vec<String> = reduction.directions.iter().map(|along| along.direction.to_string()).collect();
        assert_eq!(names, ["MD", "D4", "15deg", "30deg"]);
        assert!(Reduction::from_samples(&[], &Rules::default()).is_err());
    }
}
