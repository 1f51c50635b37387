use super::*;
use crate::random::Stream;
use crate::statistics::{deviation, quantiles};

fn about(centre: &[f64], spread: f64) -> impl FnMut() -> Vec<f64> {
    let (centre, mut stream) = (centre.to_vec(), Stream::new(1));
    move || centre.iter().map(|x| x + spread * stream.normal()).collect()
}

/// Mean and covariance of a normal density in three dimensions whose directions differ by a thousand.
#[test]
fn a_normal_density_has_its_mean_deviations_and_correlation() {
    let (deviations, correlation) = ([1.0, 1e3, 1e-3], 0.95_f64);
    let density = |x: &[f64]| {
        let [a, b, c] = [x[0] / deviations[0], (x[1] - 5.0) / deviations[1], x[2] / deviations[2]];
        let tied = (b - correlation * a).powi(2) / (1.0 - correlation * correlation);
        -0.5 * (a * a + tied + c * c)
    };
    let found = sample(&density, about(&[0.0, 5.0, 0.0], 1e-3), &Options { effective: 4000.0, ..Options::default() });
    let found = found.unwrap();
    assert!(found.is_converged() && found.effective.iter().all(|size| *size > 4000.0), "{:?}", found.r_hat);
    for (index, expected) in deviations.iter().enumerate() {
        let own = found.coordinate(index);
        let [ratio, shift] =
            [deviation(&own).unwrap() / expected, (mean(&own).unwrap() - [0.0, 5.0, 0.0][index]) / expected];
        // Four standard errors of 4000 independent samples.
        assert!((ratio - 1.0).abs() < 4.0 / 8000_f64.sqrt() && shift.abs() < 4.0 / 4000_f64.sqrt(), "{ratio} {shift}");
    }
    let both = found.points.iter().map(|x| x[0] * (x[1] - 5.0) / 1e3).sum::<f64>() / found.points.len() as f64;
    assert!((both - correlation).abs() < 0.07, "{both}");
}

/// Rosenbrock's density exp(−(a − x)²/2 − b (y − x²)²/2): x is normal about a, y about x² (Pagani, Wiegand, Nadarajah
/// 2022), so that E[y] = a² + 1 and var(y) = 4 a² + 2 + 1/b.
#[test]
fn rosenbrock_s_banana_has_its_closed_moments() {
    let (a, b) = (1.0, 20.0);
    let density = |x: &[f64]| -0.5 * (a - x[0]).powi(2) - 0.5 * b * (x[1] - x[0] * x[0]).powi(2);
    let options = Options { effective: 3000.0, most_steps: 64_000, ..Options::default() };
    let found = sample(&density, about(&[1.0, 1.0], 0.3), &options).unwrap();
    assert!(found.is_converged(), "{:?} {:?}", found.r_hat, found.effective);
    let (x, y) = (found.coordinate(0), found.coordinate(1));
    assert!((mean(&x).unwrap() - a).abs() < 0.1 && (deviation(&x).unwrap() - 1.0).abs() < 0.07);
    let (expected, spread) = (a * a + 1.0, (4.0 * a * a + 2.0 + 1.0 / b).sqrt());
    assert!((mean(&y).unwrap() - expected).abs() < 5.0 * spread / 3000_f64.sqrt(), "{:?}", mean(&y));
    assert!((deviation(&y).unwrap() / spread - 1.0).abs() < 0.12, "{:?} for {spread}", deviation(&y));
}

/// Two normal densities three deviations from zero, of which the right one has three quarters.
#[test]
fn both_modes_of_a_density_have_their_shares() {
    let normal = |x: f64, centre: f64| (-0.5 * (x - centre).powi(2)).exp();
    let density = |x: &[f64]| (0.25 * normal(x[0], -3.0) + 0.75 * normal(x[0], 3.0)).ln() - 0.5 * x[1] * x[1];
    let options = Options { effective: 2000.0, most_steps: 32_000, ..Options::default() };
    let found = sample(&density, about(&[0.0, 0.0], 3.0), &options).unwrap();
    assert!(found.is_converged(), "{:?}", found.r_hat);
    let right = found.points.iter().filter(|x| x[0] > 0.0).count() as f64 / found.points.len() as f64;
    assert!((right - 0.75).abs() < 0.05, "{right}");
    let ends = quantiles(&found.coordinate(0), &[0.025, 0.975]).unwrap();
    assert!((ends[0] + 4.28).abs() < 0.3 && (ends[1] - 4.83).abs() < 0.3, "{ends:?}");
}

/// Walkers that start in one of two modes far apart stay there, and R̂ says so.
#[test]
fn modes_that_no_walker_crosses_are_not_converged() {
    let density = |x: &[f64]| (-0.5 * (x[0].abs() - 40.0).powi(2)) - 0.5 * x[1] * x[1];
    let mut number = 0;
    let start = || {
        number += 1;
        let mut stream = Stream::new(number);
        // The first ensemble, 32 walkers and the draw that counts the dimensions, on the left.
        let side = if number <= 33 { -40.0 } else { 40.0 };
        vec![side + stream.normal(), stream.normal()]
    };
    let found = sample(&density, start, &Options { most_steps: 1000, ..Options::default() }).unwrap();
    assert!(!found.is_converged() && found.r_hat[0] > 2.0, "{:?}", found.r_hat);
}

#[test]
fn a_seed_gives_the_same_samples_and_another_others() {
    let density = |x: &[f64]| -0.5 * x[0] * x[0];
    let of =
        |seed| sample(&density, about(&[0.0], 1.0), &Options { seed, steps: 50, most_steps: 50, ..Options::default() });
    assert_eq!(of(1).unwrap(), of(1).unwrap());
    assert_ne!(of(1).unwrap().points, of(2).unwrap().points);
}

#[test]
fn what_cannot_be_sampled_is_said() {
    let density = |x: &[f64]| if x[0] > 100.0 { 0.0 } else { f64::NEG_INFINITY };
    let nowhere = sample(&density, about(&[0.0], 1.0), &Options::default()).unwrap_err();
    assert_eq!(nowhere, EnsembleError::Starts { found: 0, needed: 128 });
    let flat = |_: &[f64]| 0.0;
    let few = Options { walkers: Some(3), ..Options::default() };
    let error = sample(&flat, about(&[0.0, 0.0], 1.0), &few).unwrap_err();
    assert_eq!(error, EnsembleError::Walkers { walkers: 3, dimensions: 2 });
    assert_eq!(sample(&flat, Vec::new, &Options::default()).unwrap_err(), EnsembleError::NoCoordinate);
}

/// 88 walkers of four ensembles that never leave a good draw of the density, and walkers that leave it every thousandth step.
#[test]
fn walkers_that_hardly_move_are_no_samples() {
    let (walkers, steps) = (88, 1000);
    let mut stream = Stream::new(4);
    for leaves in [0.0, 1e-3] {
        let mut chain = || {
            let mut at: Vec<f64> = (0..walkers).map(|_| stream.normal()).collect();
            let mut chain = Vec::new();
            for _ in 0..steps {
                for x in &mut at {
                    *x = if stream.uniform() < leaves { stream.normal() } else { *x };
                }
                chain.extend_from_slice(&at);
            }
            chain
        };
        let chains: Vec<Vec<f64>> = (0..4).map(|_| chain()).collect();
        let [r_hat, effective] = known(&chains, walkers);
        // A walker that leaves with the probability p has an integrated time of 2/p: two thirds of a sample each at most.
        assert!(r_hat > 1.3 && effective < 4.0 * 88.0 * 1.5, "{r_hat} {effective}");
        assert!(leaves > 0.0 || (r_hat.is_infinite() && effective == 0.0), "{r_hat} {effective}");
    }
}

/// A long, thin banana, x of which is normal about a: walks that are too short count as not converged, and their means scatter as
/// those of so many independent samples as are reported.
#[test]
fn a_banana_that_mixes_slowly_is_not_converged_before_it_is() {
    const WALKS: u64 = 16;
    let (a, b) = (1.0, 200.0);
    let density = |x: &[f64]| -0.5 * (a - x[0]).powi(2) - 0.5 * b * (x[1] - x[0] * x[0]).powi(2);
    let squares = (0..WALKS).map(|seed| {
        let options = Options { steps: 2000, most_steps: 2000, seed, ..Options::default() };
        let mut draws = Stream::new(100 + seed);
        let start = || {
            let x = a + draws.normal();
            vec![x, x * x + draws.normal() / b.sqrt()]
        };
        let found = sample(&density, start, &options).unwrap();
        assert!(!found.is_converged(), "{:?} {:?}", found.r_hat, found.effective);
        found.effective[0] * (mean(&found.coordinate(0)).unwrap() - a).powi(2)
    });
    let off = (squares.sum::<f64>() / WALKS as f64).sqrt();
    println!("means of {WALKS} short walks are off by {off} of what their effective sizes say");
    assert!((0.6..1.5).contains(&off), "{off}");
}

/// Specimens that are known to a width each, with a half-normal deviation over them.
struct Specimens {
    measured: Vec<f64>,
    width: f64,
    expected: f64,
    blocks: Vec<Vec<Scattered>>,
}

impl Specimens {
    fn new(measured: Vec<f64>, width: f64, expected: f64) -> Specimens {
        let block = |specimen: usize| vec![Scattered { place: 2 + specimen, mean: 0, deviation: 1 }];
        let blocks = (0..measured.len()).map(block).collect();
        Specimens { measured, width, expected, blocks }
    }

    /// Quantiles of the deviation by quadrature: with mean and specimens integrated out,
    /// p(τ) ∝ exp(−τ²/2τ₀²) (w² + τ²)^(−(n−1)/2) exp(−Σ(y − ȳ)²/2(w² + τ²)).
    fn quantiles(&self, of: &[f64]) -> Vec<f64> {
        let count = self.measured.len() as f64;
        let centre = mean(&self.measured).unwrap();
        let squares: f64 = self.measured.iter().map(|y| (y - centre).powi(2)).sum();
        let density = |tau: f64| {
            let whole = self.width * self.width + tau * tau;
            (-0.5 * (tau / self.expected).powi(2) - 0.5 * (count - 1.0) * whole.ln() - 0.5 * squares / whole).exp()
        };
        let step = 2e-5 * self.expected;
        let values: Vec<f64> = (0..250_000).map(|at| density((f64::from(at) + 0.5) * step)).collect();
        let all: f64 = values.iter().sum();
        let at = |share: &f64| {
            let mut sum = 0.0;
            let place = values.iter().position(|value| {
                sum += value / all;
                sum >= *share
            });
            place.unwrap() as f64 * step
        };
        of.iter().map(at).collect()
    }
}

impl Density for Specimens {
    fn log(&self, state: &[f64]) -> f64 {
        state[1] - 0.5 * (state[1].exp() / self.expected).powi(2)
    }

    fn blocks(&self) -> &[Vec<Scattered>] {
        &self.blocks
    }

    fn log_of_block(&self, block: usize, state: &[f64]) -> f64 {
        let x = state[2 + block];
        let from_mean = (x - state[0]) / state[1].exp();
        -0.5 * (from_mean * from_mean + ((x - self.measured[block]) / self.width).powi(2)) - state[1]
    }
}

/// A hierarchy against quadrature: without scatter, where its deviation is small against the width of every test (the neck), with
/// as much scatter as that width, and with ten times as much.
#[test]
fn the_deviation_of_a_hierarchy_has_the_quantiles_of_quadrature() {
    let mut stream = Stream::new(8);
    for (count, scatter) in [(10, 0.0), (40, 0.0), (10, 0.05), (10, 0.5)] {
        let target = Specimens::new((0..count).map(|_| scatter * stream.normal()).collect(), 0.05, 0.3);
        let mut draws = Stream::new(1);
        let start = || {
            let mut state = vec![0.02 * draws.normal(), -2.5 + 0.3 * draws.normal()];
            state.extend(target.measured.iter().map(|y| y + 0.05 * draws.normal()));
            state
        };
        let found = sample(&target, start, &Options { effective: 4000.0, seed: 5, ..Options::default() }).unwrap();
        assert!(found.is_converged(), "{:?}", found.r_hat);
        let deviations: Vec<f64> = found.coordinate(1).iter().map(|x| x.exp()).collect();
        let at = [0.025, 0.25, 0.5, 0.975];
        let (own, exact) = (quantiles(&deviations, &at).unwrap(), target.quantiles(&at));
        println!("{count} specimens, scatter {scatter}: {own:.4?} for {exact:.4?}, {} steps", found.steps);
        let width = exact[3] - exact[0];
        for (own, exact) in own.iter().zip(&exact) {
            assert!((own - exact).abs() < 0.04 * width, "{count} {scatter}: {own} for {exact}");
        }
        assert!(scatter > 0.1 || (own[0] / exact[0] - 1.0).abs() < 0.35, "{own:?} for {exact:?}");
    }
}
