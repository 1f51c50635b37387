//! Mirror images that complete a film of which only a part was computed.

use crate::simulate::Film;

/// The film itself or one of its mirror images.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Image {
    /// 0 is the film itself.
    pub number: u32,
    /// Planes that it is mirrored in: x = 0, y = 0.
    mirrored: [bool; 2],
}

impl Image {
    /// The film and its images.
    pub fn all(film: &Film) -> impl Iterator<Item = Image> + use<> {
        let [x, y] = film.mirrored;
        (0..4)
            .map(|number| Image { number, mirrored: [number & 1 == 1, number & 2 == 2] })
            .filter(move |Image { mirrored, .. }| (x || !mirrored[0]) && (y || !mirrored[1]))
    }

    /// Whether it turns right into left, and with it the sense of corners and of shear.
    pub fn is_reversed(self) -> bool {
        self.mirrored[0] != self.mirrored[1]
    }

    /// Where a point or a vector goes.
    pub fn of(self, [x, y, z]: [f32; 3]) -> [f32; 3] {
        let [across_x, across_y] = self.mirrored;
        [if across_x { -x } else { x }, if across_y { -y } else { y }, z]
    }

    /// Direction of fibres that lie along `axis` (0 x, 1 y) in stress-free film: a fibre has no sense, but those of the images
    /// are drawn with that of the film itself.
    pub fn of_fibre(self, direction: [f32; 3], axis: usize) -> [f32; 3] {
        let image = self.of(direction);
        if self.mirrored[axis] { image.map(|c| -c) } else { image }
    }
}
