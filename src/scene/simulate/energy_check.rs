//! The energy balance of a run.

use serde::{Deserialize, Serialize};

use super::fault::Fault;
use lab::signal::{Channel, Recording};
use membrane::engine::{Energies, EnergyTerm};

/// The sum of the terms as a channel.
const SUM: EnergyTerm = EnergyTerm {
    name: "sum_J",
    sentence: &["Sum of all terms, which is constant but for the error of the energy balance."],
};

/// The columns of a run's energies.
pub fn energy_columns() -> impl Iterator<Item = EnergyTerm> {
    Energies::TERMS.iter().copied().chain([SUM])
}

/// Balance error, over the energy exchanged, that stops a run.
const STOP: f64 = 0.1;

/// Share of the energy taken up that tears have taken from which on film moves with them.
const TORN: f64 = 0.01;

/// Least divisor of the balance error over the run's own scale of energy.
const FLOOR: f64 = 0.02;

/// Share of the largest term below which a gap is round-off: pre-strain alone may store far more than a run moves.
const ROUND_OFF: f64 = 1e-12;

/// The energy audit through a run.
#[derive(Serialize, Deserialize)]
pub(super) struct EnergyCheck {
    scale: f64,
    /// Time from which a lost balance stops the run, s.
    from: f64,
    start: Option<Energies>,
    time: Vec<f64>,
    rows: Vec<Energies>,
    /// Largest losses in contact, in friction and in the guide so far, J.
    lost: [f64; 3],
    largest_gap: f64,
    most_exchanged: f64,
    largest_term: f64,
}

impl EnergyCheck {
    /// `scale` is an energy (J) that the run exchanges at least, such as the impactor's. The run is not
    /// stopped before the time `from` (s): a slow loading has no such scale, and little energy to divide by until then.
    pub(super) fn new(scale: f64, from: f64) -> EnergyCheck {
        EnergyCheck {
            scale,
            from,
            start: None,
            time: vec![],
            rows: vec![],
            lost: [0.0; 3],
            largest_gap: 0.0,
            most_exchanged: 0.0,
            largest_term: 0.0,
        }
    }

    /// Adds the energies at `time` (s).
    ///
    /// # Errors
    /// The energy balance is lost.
    pub(super) fn sample(&mut self, time: f64, energies: Energies) -> Result<(), Fault> {
        let start = *self.start.get_or_insert(energies);
        self.time.push(time);
        self.rows.push(energies);
        let gap = energies.total() - start.total() + self.recovered(&energies);
        self.largest_gap = self.largest_gap.max(gap.abs());
        self.most_exchanged = self.most_exchanged.max(energies.exchanged(&start));
        self.largest_term = energies.terms().iter().fold(self.largest_term, |most, term| most.max(term.abs()));
        if time < self.from { Ok(()) } else { self.fault().map_or(Ok(()), Err) }
    }

    /// The fault of a run whose energy balance is lost.
    pub(super) fn fault(&self) -> Option<Fault> {
        let (time, error) = (*self.time.last()?, self.balance_error());
        (error > STOP).then_some(Fault::EnergyBalance { time, error })
    }

    /// Decrease of the losses in contact, friction and guide from their largest values, J: an error that the sum of all
    /// terms does not show.
    fn recovered(&mut self, energies: &Energies) -> f64 {
        let now = [energies.contact, energies.friction, energies.guide];
        (0..3)
            .map(|k| {
                self.lost[k] = self.lost[k].max(now[k]);
                self.lost[k] - now[k]
            })
            .sum()
    }

    /// Largest |ΣE − E₀|, plus the decrease of losses, over the largest energy exchanged.
    pub(super) fn balance_error(&self) -> f64 {
        let exchanged = self.most_exchanged.max(FLOOR * self.scale).max(ROUND_OFF * self.largest_term);
        if exchanged > 0.0 { self.largest_gap / exchanged } else { 0.0 }
    }

    /// Energy that the film has taken up since the start with the springs on which it hangs, J.
    fn taken_up(&self, energies: &Energies) -> f64 {
        let inner = |e: &Energies| e.stored + e.absorbed + e.rupture + e.springs;
        inner(energies) - self.start.as_ref().map_or(0.0, inner)
    }

    fn most_taken_up(&self) -> f64 {
        self.rows.iter().map(|e| self.taken_up(e)).fold(0.0, f64::max)
    }

    /// Time (s) and size of the largest ratio of kinetic energy to the energy that the film has taken up, where that is
    /// more than a tenth of its maximum; of film that `can_tear` until a tear has taken a share of it, since one that runs
    /// moves the film.
    pub(super) fn kinetic_share(&self, can_tear: bool) -> (f64, f64) {
        let least = 0.1 * self.most_taken_up();
        let rows =
            self.time.iter().zip(&self.rows).take_while(|(_, e)| !can_tear || e.rupture <= TORN * self.taken_up(e));
        let rows = rows.filter(|(_, e)| self.taken_up(e) > least);
        let shares = rows.map(|(time, e)| (*time, e.kinetic_film / self.taken_up(e)));
        shares.fold((0.0, 0.0), |most, now| if now.1 > most.1 { now } else { most })
    }

    /// Energy lost to damping over the largest energy that the film took up.
    pub(super) fn damping_share(&self) -> f64 {
        let most = self.most_taken_up();
        self.rows.last().map_or(0.0, |e| if most > 0.0 { e.damping / most } else { 0.0 })
    }

    /// One channel a term, and their sum.
    pub(super) fn recording(&self) -> Recording {
        let channel = |(place, term): (usize, &EnergyTerm)| Channel {
            name: term.name.to_owned(),
            values: self.rows.iter().map(|e| e.terms()[place]).collect(),
        };
        let mut channels: Vec<Channel> = Energies::TERMS.iter().enumerate().map(channel).collect();
        channels.push(Channel { name: SUM.name.to_owned(), values: self.rows.iter().map(Energies::total).collect() });
        Recording { time: self.time.clone(), channels }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn round_off_of_a_large_prestrain_energy_is_no_error() {
        let mut check = EnergyCheck::new(0.0, 0.0);
        let stored = |stored: f64| Energies { stored, ..Energies::default() };
        assert_eq!(check.sample(0.0, stored(1.0)), Ok(()));
        assert_eq!(check.sample(1.0, stored(1.0 + f64::EPSILON)), Ok(()));
        assert!(check.sample(2.0, stored(1.0 + 1e-9)).is_err());
    }

    #[test]
    fn the_balance_of_a_slow_start_is_not_checked() {
        let mut check = EnergyCheck::new(0.0, 1.0);
        let moved = |given: f64| Energies { stored: given - 1e-3, external: -given, ..Energies::default() };
        assert_eq!(check.sample(0.0, Energies::default()), Ok(()));
        assert_eq!(check.sample(0.5, moved(2e-3)), Ok(()));
        assert!(check.fault().is_some(), "the balance of a run that ends here is lost");
        assert_eq!(check.sample(1.0, moved(1.0)), Ok(()));
        assert!(check.sample(2.0, Energies { stored: 2.0, ..Energies::default() }).is_err());
    }
}
