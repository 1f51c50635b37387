//! What the tests of film on film ask of a face that meets itself.

use super::*;

impl SelfContact {
    /// Distance by which two points of the first face may come nearer to each other before it has to be searched, m; zero
    /// where it is searched whatever its shape.
    pub(in crate::engine::film_contact) fn spared(&mut self, surface: &Surface, position: &Vectors) -> f64 {
        self.hierarchies[0].measure(surface, position);
        if self.has_open_edges[0] { 0.0 } else { self.hierarchies[0].spared(self.bound[0]) }
    }

    /// Pairs of triangles of the first face that a search looks at.
    pub(in crate::engine::film_contact) fn pairs_of_triangles(
        &mut self,
        surface: &Surface,
        position: &Vectors,
    ) -> usize {
        let hierarchy = &mut self.hierarchies[0];
        hierarchy.measure(surface, position);
        hierarchy.refit(surface, position);
        let mut count = 0;
        hierarchy.for_each_pair(surface, self.reach[0], &mut |_, _| count += 1);
        count
    }

    /// Parts of the first face that may meet and are nearer than `distance` (m), or than its reach, of all pairs of
    /// triangles.
    pub(in crate::engine::film_contact) fn parts_within(
        &self,
        surface: &Surface,
        position: &Vectors,
        distance: Option<f64>,
    ) -> usize {
        let distance = distance.unwrap_or(self.reach[0]);
        let mut count = 0;
        let intact = || surface.faces[0].clone().filter(|triangle| surface.is_intact[*triangle as usize]);
        for one in intact() {
            for other in intact().filter(|other| *other > one) {
                self.topology.candidates(surface, [one, other], &mut |parts| {
                    count += usize::from(distance_within(surface, position, parts, distance).is_some());
                });
            }
        }
        count
    }
}
