//! A recording with its landmarks, drawn in characters.

use plot::{braille, thinned};
use report::{DropTest, drop_page};

/// Characters across and down.
const SIZE: [usize; 2] = [72, 12];

/// Most points of the curve: several a dot.
const MOST_POINTS: usize = 4000;

/// The acceleration as it was read, with the landmarks that were found below it and their times; every line ends with a
/// line break. Empty of a recording that could not be read.
pub(super) fn picture(test: &DropTest) -> String {
    let plots = thinned(drop_page::reading(test).into_iter().collect(), MOST_POINTS);
    let drawn: String = plots.iter().map(|plot| braille(plot, SIZE)).collect();
    if drawn.is_empty() {
        return drawn;
    }
    let times: Vec<String> =
        test.landmarks.named().into_iter().map(|(name, time)| format!("{name} {time:.4} s")).collect();
    let times = if times.is_empty() { "no landmark was found".into() } else { times.join(", ") };
    format!("{drawn}  {times}\n")
}
