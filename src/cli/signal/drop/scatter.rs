//! Medians and scatter of the drops of each mass and height.

use base::number::rounded;
use lab::experiment::drop::Figures;
use report::drop_page::{DROP_QUANTITIES, DropQuantity};
use report::{DropScatter, DropTest, FigureScatter};
use uncertainty::statistics::quantiles;

/// Significant digits by which masses and heights are the same.
const DIGITS: usize = 6;

/// The scatter of the drops of each mass and height, in the order in which these occur.
pub(super) fn scatter(tests: &[DropTest]) -> Vec<DropScatter> {
    let mut groups: Vec<([Option<f64>; 2], Vec<&Figures>)> = Vec::new();
    for test in tests {
        let (Some(figures), Some(tower)) = (&test.figures, test.tower) else { continue };
        let key = [Some(tower.body.mass), test.height()].map(|value| value.map(|value| rounded(value, DIGITS)));
        match groups.iter_mut().find(|(other, _)| *other == key) {
            Some((_, of_group)) => of_group.push(figures),
            None => groups.push((key, vec![figures])),
        }
    }
    let group = |([mass, height], figures): ([Option<f64>; 2], Vec<&Figures>)| DropScatter {
        mass_kg: mass.unwrap_or(f64::NAN),
        height_m: height,
        drops: figures.len(),
        figures: DROP_QUANTITIES.iter().filter_map(|quantity| of_quantity(quantity, &figures)).collect(),
    };
    groups.into_iter().map(group).collect()
}

fn of_quantity(quantity: &DropQuantity, figures: &[&Figures]) -> Option<FigureScatter> {
    let values: Vec<f64> =
        figures.iter().filter_map(|figures| (quantity.of)(figures)).filter(|value| value.is_finite()).collect();
    let found = quantiles(&values, &[0.0, 0.25, 0.5, 0.75, 1.0])?;
    let [least, low, median, high, largest] = found[..] else { return None };
    let count = values.len();
    Some(FigureScatter { figure: quantity.name, count, median, quartiles: [low, high], range: [least, largest] })
}
