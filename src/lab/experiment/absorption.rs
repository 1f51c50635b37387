//! Share of the impactor's energy that the film absorbs (Polymers 2021, 13, 1537, equation 11).

use thiserror::Error;

use membrane::engine::GuideFriction;

/// Why a motion has no energy absorption.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum AbsorptionError {
    /// The impactor never moves upwards after its lowest point.
    #[error("the recording ends before the rebound")]
    NoUnloading,
    /// Its energy does not fall before the lowest point.
    #[error("the film absorbs no energy during loading")]
    NoLoading,
}

/// The rigid body that falls, and gravity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Body {
    /// kg.
    pub mass: f64,
    /// m/s², positive.
    pub gravity: f64,
}

impl Body {
    /// Kinetic and potential energy E_kp = ½Mv² + Mgd (J) at velocity `v` (m/s) and displacement `d` (m, up).
    pub fn energy(&self, v: f64, d: f64) -> f64 {
        0.5 * self.mass * v * v + self.mass * self.gravity * d
    }
}

/// Energy absorption D = 1 − ΔE_u/ΔE_l (methods.md, equation 26).
///
/// ΔE_l and ΔE_u are the differences between the largest and the smallest E_kp before and after the
/// largest travel. `velocity` (m/s) and `displacement` (m) count upward and share one time axis.
pub fn energy_absorption(body: Body, velocity: &[f64], displacement: &[f64]) -> Result<f64, AbsorptionError> {
    film_absorption(body, &GuideFriction::default(), velocity, displacement)
}

/// Energy absorption of the film alone: as [`energy_absorption`], but of the energy that the impactor would have
/// without what its guide with `friction` dissipates (methods.md, equation 53).
pub fn film_absorption(
    body: Body,
    friction: &GuideFriction,
    velocity: &[f64],
    displacement: &[f64],
) -> Result<f64, AbsorptionError> {
    let motion = || velocity.iter().zip(displacement);
    let dissipated = friction.dissipated(velocity, displacement);
    let energy: Vec<f64> = motion().zip(&dissipated).map(|((v, d), lost)| body.energy(*v, *d) + lost).collect();
    absorption_of(&energy, displacement)
}

/// Share of the depth by which the impactor rises, and falls again, between two impacts.
pub const RISES: f64 = 0.1;

/// Number of samples of the first impact: all, or those up to the highest point from which the impactor falls again, to a later
/// impact.
pub fn first_impact(displacement: &[f64]) -> usize {
    let (mut lowest, mut top) = (0.0_f64, 0);
    for (i, d) in displacement.iter().enumerate() {
        // Above the film it falls to its first impact.
        let least = -RISES * lowest;
        if least > 0.0 && displacement[top] - lowest > least && displacement[top] - d > least {
            return top + 1;
        }
        if *d < lowest {
            (lowest, top) = (*d, i);
        } else if *d > displacement[top] {
            top = i;
        }
    }
    displacement.len()
}

/// Energy absorption of a body of the mechanical energy `energy` (J) at the height `displacement` (m), in its first impact.
pub fn absorption_of(energy: &[f64], displacement: &[f64]) -> Result<f64, AbsorptionError> {
    let end = first_impact(displacement);
    let (energy, displacement) = (&energy[..end.min(energy.len())], &displacement[..end]);
    let lowest = displacement.iter().enumerate().min_by(|(_, a), (_, b)| a.total_cmp(b));
    let Some((turn, _)) = lowest.filter(|(turn, _)| turn + 1 < energy.len()) else {
        return Err(AbsorptionError::NoUnloading);
    };
    let loading = span(&energy[..=turn]);
    if loading <= 0.0 {
        return Err(AbsorptionError::NoLoading);
    }
    Ok(1.0 - span(&energy[turn..]) / loading)
}

fn span(energy: &[f64]) -> f64 {
    let largest = energy.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let smallest = energy.iter().copied().fold(f64::INFINITY, f64::min);
    largest - smallest
}

#[cfg(test)]
mod tests {
    use super::*;

    const BODY: Body = Body { mass: 10.72, gravity: 9.81 };

    /// Half a cosine down with speed `v_in`, half a cosine up with `v_out`; both 0.1 m deep, without gravity.
    fn bounce(v_in: f64, v_out: f64) -> (Vec<f64>, Vec<f64>) {
        let phase = |i: usize| std::f64::consts::FRAC_PI_2 * i as f64 / 500.0;
        let speed = |i: usize| {
            if i <= 500 { -v_in * phase(i).cos() } else { -v_out * phase(i).cos() }
        };
        let place = |i: usize| -0.1 * phase(i).sin();
        ((0..=1000).map(speed).collect(), (0..=1000).map(place).collect())
    }

    #[test]
    fn without_gravity_it_is_the_loss_of_kinetic_energy() {
        let (v, d) = bounce(4.0, 1.0);
        let body = Body { gravity: 0.0, ..BODY };
        let absorbed = energy_absorption(body, &v, &d).unwrap();
        assert!((absorbed - (1.0 - 1.0 / 16.0)).abs() < 1e-12, "{absorbed}");
    }

    #[test]
    fn with_gravity_the_fall_through_the_film_counts() {
        let (v, d) = bounce(4.0, 1.0);
        let absorbed = energy_absorption(BODY, &v, &d).unwrap();
        let (loading, unloading) = (8.0 + 9.81 * 0.1, 0.5 + 9.81 * 0.1);
        assert!((absorbed - (1.0 - unloading / loading)).abs() < 1e-6, "{absorbed}");
    }

    /// The guide takes F over 0.1 m each way.
    #[test]
    fn what_the_guide_takes_is_not_absorbed_by_the_film() {
        let (v, d) = bounce(4.0, 1.0);
        let friction = GuideFriction { constant: 50.0, ..GuideFriction::default() };
        let film = film_absorption(BODY, &friction, &v, &d).unwrap();
        let guide = 50.0 * 0.1 / BODY.mass;
        let (loading, unloading) = (8.0 + 9.81 * 0.1 - guide, 0.5 + 9.81 * 0.1 + guide);
        assert!((film - (1.0 - unloading / loading)).abs() < 1e-6, "{film}");
        assert!(film < energy_absorption(BODY, &v, &d).unwrap());
    }

    /// The film that an impact has stretched lets the next one deeper.
    #[test]
    fn a_second_impact_does_not_count() {
        let ((v, d), (again_v, again_d)) = (bounce(4.0, 1.0), bounce(1.0, 0.5));
        let fall = (1..100).map(|i| 0.1 - 0.001 * f64::from(i));
        let first = d.len() + 1;
        let deeper: Vec<f64> = again_d.iter().map(|d| 1.1 * d).collect();
        let displacement: Vec<f64> = d.iter().copied().chain(fall).chain(deeper).collect();
        let velocity: Vec<f64> = v.iter().copied().chain([-1.0; 99]).chain(again_v).collect();
        assert_eq!(first_impact(&displacement), first);
        assert_eq!(first_impact(&d), d.len());
        // One as deep, and one that is less so.
        for share in [1.0, 0.3] {
            let fall = (1..100).map(|i| 0.1 - 0.001 * f64::from(i));
            let again = again_d.iter().map(|d| share * d);
            let displacement: Vec<f64> = d.iter().copied().chain(fall).chain(again).collect();
            assert_eq!(first_impact(&displacement), first, "{share}");
        }
        let from_above: Vec<f64> = [2e-3, 1e-3].into_iter().chain(d.iter().copied()).collect();
        assert_eq!(first_impact(&from_above), from_above.len());
        let body = Body { gravity: 0.0, ..BODY };
        assert_eq!(energy_absorption(body, &velocity, &displacement), energy_absorption(body, &v, &d));
    }

    #[test]
    fn an_impactor_without_rebound_has_none() {
        let v = vec![-4.0; 100];
        let d: Vec<f64> = (0..100).map(|i| -0.01 * f64::from(i)).collect();
        assert_eq!(energy_absorption(BODY, &v, &d), Err(AbsorptionError::NoUnloading));
        assert_eq!(energy_absorption(BODY, &[], &[]), Err(AbsorptionError::NoUnloading));
    }

    #[test]
    fn one_that_gives_nothing_has_none() {
        assert_eq!(energy_absorption(BODY, &[0.0; 3], &[0.0; 3]), Err(AbsorptionError::NoLoading));
    }
}
