//! Fields of the film by which faces are coloured, in recordings and pictures.

use scene::simulate::FilmState;

/// A field of the film: a number of each element, or patch of several.
pub struct Field {
    /// By which users name it.
    pub key: &'static str,
    /// The quantity in words.
    pub title: &'static str,
    /// Its symbol.
    pub symbol: &'static str,
    /// Unit in which it is shown.
    pub unit: &'static str,
    /// Factor from the value of `of` to the unit.
    factor: f32,
    /// Of an element, by its index.
    of: fn(&FilmState, usize) -> f32,
    /// Whether film in this state has it; all has it where there is no such condition.
    only: Option<fn(&FilmState) -> bool>,
}

/// The fields to choose from, the default first. A mirror image reverses a shear angle, so its magnitude is shown. The
/// last four only where a law gives the thickness or a plastic strain, where film can tear, and where it warms up.
pub const FIELDS: [Field; 8] = [
    Field {
        key: "largest",
        title: "Larger fibre strain",
        symbol: "max(MD, TD)",
        unit: "%",
        factor: 100.0,
        of: |state, element| state.strains[element][0].max(state.strains[element][1]),
        only: None,
    },
    Field {
        key: "md",
        title: "Strain MD",
        symbol: "MD",
        unit: "%",
        factor: 100.0,
        of: |state, element| state.strains[element][0],
        only: None,
    },
    Field {
        key: "td",
        title: "Strain TD",
        symbol: "TD",
        unit: "%",
        factor: 100.0,
        of: |state, element| state.strains[element][1],
        only: None,
    },
    Field {
        key: "shear",
        title: "Shear",
        symbol: "|γ|",
        unit: "°",
        factor: 180.0 / std::f32::consts::PI,
        of: |state, element| state.strains[element][2].abs(),
        only: None,
    },
    Field {
        key: "thickness",
        title: "Loss of thickness",
        symbol: "1 − h/h₀",
        unit: "%",
        factor: 100.0,
        of: |state, element| 1.0 - state.thickness_ratio.get(element).copied().unwrap_or(f32::NAN),
        only: Some(|state| !state.thickness_ratio.is_empty()),
    },
    Field {
        key: "plastic",
        title: "Plastic strain",
        symbol: "equivalent",
        unit: "%",
        factor: 100.0,
        of: |state, element| state.plastic_strain.get(element).copied().unwrap_or(f32::NAN),
        only: Some(|state| !state.plastic_strain.is_empty()),
    },
    Field {
        key: "damage",
        title: "Damage",
        symbol: "share of the force lost",
        unit: "%",
        factor: 100.0,
        of: |state, element| state.damage.get(element).copied().unwrap_or(f32::NAN),
        only: Some(|state| !state.damage.is_empty()),
    },
    Field {
        key: "warming",
        title: "Warming",
        symbol: "ΔT",
        unit: "K",
        factor: 1.0,
        of: |state, element| state.warming.get(element).copied().unwrap_or(f32::NAN),
        only: Some(|state| !state.warming.is_empty()),
    },
];

/// Least upper end of the range of a field: strains below it are rounding errors.
const LEAST: f32 = 1e-6;

impl Field {
    /// The fields of faces in the states `films` at one time.
    pub fn all_in(films: &[FilmState]) -> impl Iterator<Item = &'static Field> {
        let is_shown = |field: &&Field| field.only.is_none_or(|is_in| films.iter().any(is_in));
        FIELDS.iter().filter(is_shown)
    }

    /// From zero to the largest value of an intact element in any of `states`, in its unit.
    pub fn range<'a>(&self, states: impl Iterator<Item = &'a FilmState>) -> [f32; 2] {
        [0.0, self.factor * states.map(|state| self.largest(state)).fold(LEAST, f32::max)]
    }

    fn largest(&self, state: &FilmState) -> f32 {
        let intact = state.failed.iter().enumerate().filter(|(_, failed)| !**failed);
        intact.map(|(element, _)| (self.of)(state, element)).fold(0.0, f32::max)
    }

    /// Values at the nodes of a face, in its unit: the mean of the intact elements around each, zero where there is none.
    /// An element that is a triangle has its last corner twice.
    pub fn at_nodes(&self, nodes: usize, elements: impl Iterator<Item = [u32; 4]>, state: &FilmState) -> Vec<f32> {
        let mut sums = vec![(0.0_f32, 0.0_f32); nodes];
        for (element, (corners, _)) in elements.zip(&state.failed).enumerate().filter(|(_, (_, failed))| !**failed) {
            let corners = if corners[2] == corners[3] { &corners[..3] } else { &corners[..] };
            for node in corners {
                let (sum, elements) = &mut sums[*node as usize];
                *sum += self.factor * (self.of)(state, element);
                *elements += 1.0;
            }
        }
        let mean = |(sum, elements): (f32, f32)| sum / elements.max(1.0);
        sums.into_iter().map(mean).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_at_nodes_are_means_of_the_intact_elements() {
        let elements = [[0, 1, 2, 3], [1, 4, 2, 2], [4, 5, 2, 2]];
        let state = FilmState {
            positions: vec![[0.0; 3]; 6],
            strains: vec![[0.1, 0.4, 0.3], [0.2, 0.0, -0.5], [7.0, 0.0, 0.0]],
            failed: vec![false, false, true],
            ..FilmState::default()
        };
        let at_nodes = |field: &Field| field.at_nodes(6, elements.into_iter(), &state);
        let strains = at_nodes(&FIELDS[0]);
        let expected = [40.0, 30.0, 30.0, 40.0, 20.0, 0.0];
        for (strain, expected) in strains.iter().zip(expected) {
            assert!((strain - expected).abs() < 1e-5, "{strains:?}");
        }
        assert_eq!(FIELDS.each_ref().map(|field| field.largest(&state)), [0.4, 0.2, 0.4, 0.5, 0.0, 0.0, 0.0, 0.0]);
        let thin = FilmState { thickness_ratio: vec![0.9, 0.7, 0.1], ..state.clone() };
        assert!((FIELDS[4].largest(&thin) - 0.3).abs() < 1e-6, "of the intact elements");
        let shear = at_nodes(&FIELDS[3]);
        assert!((shear[4] - 0.5_f32.to_degrees()).abs() < 1e-4, "shear is in degrees: {shear:?}");
        assert_eq!(Field::all_in(std::slice::from_ref(&state)).count(), 4);
        assert_eq!(Field::all_in(&[thin]).map(|field| field.key).last(), Some("thickness"));
    }
}
