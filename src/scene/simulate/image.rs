//! Mirror images that complete a film of which only a part was computed.

use super::film::Film;

/// A film itself or one of its mirror images.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Image {
    /// 0 is the film itself.
    pub number: u32,
    /// Planes that it is mirrored in: x = 0, y = 0.
    mirrored: [bool; 2],
}

impl Film {
    /// The film and its mirror images.
    pub fn images(&self) -> impl Iterator<Item = Image> + use<> {
        Image::all(self.mirrored)
    }
}

impl Image {
    /// The film itself and its images where x = 0 and y = 0 are mirror planes or not.
    pub fn all([x, y]: [bool; 2]) -> impl Iterator<Item = Image> {
        (0..4)
            .map(|number| Image { number, mirrored: [number & 1 == 1, number & 2 == 2] })
            .filter(move |Image { mirrored, .. }| (x || !mirrored[0]) && (y || !mirrored[1]))
    }

    /// Factors on x, y and z.
    pub fn signs(self) -> [f32; 3] {
        let sign = |mirrored: bool| if mirrored { -1.0 } else { 1.0 };
        [sign(self.mirrored[0]), sign(self.mirrored[1]), 1.0]
    }

    /// Whether it reverses orientation: the order of an element's corners and the sign of shear.
    pub fn is_reversed(self) -> bool {
        self.mirrored[0] != self.mirrored[1]
    }

    /// The image of a point or a vector.
    pub fn reflect(self, place: [f32; 3]) -> [f32; 3] {
        let signs = self.signs();
        [0, 1, 2].map(|axis| signs[axis] * place[axis])
    }

    /// The image of the direction of fibres that lie along `axis` (0 x, 1 y) in stress-free film. The sign of a fibre's
    /// direction is arbitrary; it is the one of the film itself.
    pub fn of_fibre(self, direction: [f32; 3], axis: usize) -> [f32; 3] {
        let sign = self.signs()[axis];
        self.reflect(direction).map(|c| sign * c)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{Mesh, Quality};

    #[test]
    fn a_quarter_has_four_images_a_half_two_and_a_whole_one() {
        for (mirrored, numbers) in [
            ([true, true], &[0, 1, 2, 3][..]),
            ([true, false], &[0, 1]),
            ([false, true], &[0, 2]),
            ([false, false], &[0]),
        ] {
            let quality = Quality::from_mesh(&Mesh::default());
            let film = Film { nodes: 0, quads: vec![], tris: vec![], held: vec![], springs: vec![], mirrored, quality };
            let found: Vec<u32> = film.images().map(|image| image.number).collect();
            assert_eq!(found, numbers);
            for image in film.images() {
                assert_eq!(image.reflect([1.0, 2.0, 3.0])[2], 3.0);
                assert_eq!(image.is_reversed(), image.signs().iter().product::<f32>() < 0.0);
                assert_eq!(image.of_fibre([1.0, 0.0, 0.0], 0), [1.0, 0.0, 0.0], "with the sign of the film itself");
            }
        }
    }
}
