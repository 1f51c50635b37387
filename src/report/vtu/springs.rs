//! The springs between film and frame in one snapshot.

use super::{Grid, VtuError, numbers, scalars, vectors};
use scene::simulate::{FilmSpring, FilmState, Image, Outcome, Snapshot, SpringDetail};

/// A spring in a snapshot, or a mirror image of it.
struct Line<'a> {
    /// Number of the face, from 1.
    face: u32,
    /// Its own number within the face.
    number: u32,
    image: Image,
    spring: &'a FilmSpring,
    detail: &'a SpringDetail,
    /// Its end on the film now and in the first snapshot, m.
    ends: [[f32; 3]; 2],
    /// Velocity of that end, m/s.
    velocity: [f32; 3],
}

/// The springs of `outcome` in a snapshot.
pub(super) fn grid(outcome: &Outcome, snapshot: &Snapshot) -> Result<Grid, VtuError> {
    let lines = lines(outcome, snapshot)?;
    // From the frame, which stands still, to the film.
    let points = |of_frame: &dyn Fn(&Line<'_>) -> [f32; 3], of_film: &dyn Fn(&Line<'_>) -> [f32; 3]| {
        let ends = lines.iter().flat_map(|line| [of_frame(line), of_film(line)].map(|end| line.image.reflect(end)));
        ends.collect::<Vec<_>>()
    };
    let displacement = |line: &Line<'_>| {
        let [now, then] = line.ends;
        [0, 1, 2].map(|axis| now[axis] - then[axis])
    };
    let still = |_: &Line<'_>| [0.0; 3];
    Ok(Grid {
        points: points(&|line| line.spring.anchor, &|line| line.ends[0]),
        cells: (0..lines.len() as u64).map(|line| vec![2 * line, 2 * line + 1]).collect(),
        on_points: vec![
            vectors("displacement_m", points(&still, &displacement).into_iter()),
            vectors("velocity_m_s", points(&still, &|line| line.velocity).into_iter()),
        ],
        on_cells: vec![
            scalars("elongation_m", lines.iter().map(|line| line.detail.elongation)),
            scalars("force_N", lines.iter().map(|line| line.detail.force)),
            numbers("face", lines.iter().map(|line| line.face)),
            numbers("spring", lines.iter().map(|line| line.number)),
            numbers("image", lines.iter().map(|line| line.image.number)),
        ],
    })
}

fn lines<'a>(outcome: &'a Outcome, snapshot: &'a Snapshot) -> Result<Vec<Line<'a>>, VtuError> {
    let mut lines = vec![];
    let first = outcome.snapshots.first().unwrap_or(snapshot);
    let states = snapshot.films.iter().zip(&first.films);
    for (face, (film, (state, rest))) in (1..).zip(outcome.films.iter().zip(states)) {
        let FilmState { positions, detail: Some(detail), .. } = state else { return Err(VtuError::NoDetail) };
        for image in film.images() {
            for (number, (spring, own)) in (0..).zip(film.springs.iter().zip(&detail.springs)) {
                let ends = [positions, &rest.positions].map(|positions| spring.end(positions));
                // The weights of its end are those of the velocities, too.
                let velocity = spring.end(&detail.velocities);
                lines.push(Line { face, number, image, spring, detail: own, ends, velocity });
            }
        }
    }
    Ok(lines)
}
