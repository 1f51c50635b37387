//! Signed distances from cylinders, cones and boxes in closed form.

/// A convex shape about its own centre, its axis along z.
#[derive(Clone, Copy, Debug)]
pub(super) enum Convex {
    /// Of a radius and half a length, m.
    Cylinder { radius: f64, half: f64 },
    /// Tip down, of the radius of its flat upper end and half a length, m.
    Cone { radius: f64, half: f64 },
    /// Of half lengths, m.
    Cuboid { half: [f64; 3] },
}

impl Convex {
    /// Signed distance of a point (m) and the outward unit normal there.
    #[inline(always)]
    pub(super) fn project(&self, point: [f64; 3]) -> (f64, [f64; 3]) {
        let [x, y, z] = point;
        match *self {
            Convex::Cylinder { radius, half } => {
                let rho = (x * x + y * y).sqrt();
                let (distance, [radial, axial]) = rectangle([rho - radius, z.abs() - half]);
                (distance, turned([x, y], rho, [radial, axial.copysign(z)]))
            }
            Convex::Cone { radius, half } => {
                let rho = (x * x + y * y).sqrt();
                let (distance, normal) = half_triangle([rho, z + half], radius, 2.0 * half);
                (distance, turned([x, y], rho, normal))
            }
            Convex::Cuboid { half } => {
                let beyond = [x.abs() - half[0], y.abs() - half[1], z.abs() - half[2]];
                let (distance, normal) = corner(beyond);
                (distance, [0, 1, 2].map(|k| if point[k] < 0.0 { -normal[k] } else { normal[k] }))
            }
        }
    }

    /// The farthest point along the unit vector `direction`, times it, m.
    pub(super) fn reach(&self, direction: [f64; 3]) -> f64 {
        let [x, y, z] = direction;
        let radial = (x * x + y * y).sqrt();
        match *self {
            Convex::Cylinder { radius, half } => radial * radius + z.abs() * half,
            Convex::Cone { radius, half } => (radial * radius + z * half).max(-z * half),
            Convex::Cuboid { half } => x.abs() * half[0] + y.abs() * half[1] + z.abs() * half[2],
        }
    }

    /// The farthest point along `direction`, of which there may be several, m.
    #[inline(always)]
    pub(super) fn support(&self, direction: [f64; 3]) -> [f64; 3] {
        let [x, y, z] = direction;
        let on_circle = |radius: f64| {
            let rho = (x * x + y * y).sqrt();
            if rho > 0.0 { [radius * (x / rho), radius * (y / rho)] } else { [0.0; 2] }
        };
        match *self {
            Convex::Cylinder { radius, half } => {
                let [u, v] = on_circle(radius);
                [u, v, half.copysign(z)]
            }
            Convex::Cone { radius, half } => {
                let [u, v] = on_circle(radius);
                if x * u + y * v + z * half > -z * half { [u, v, half] } else { [0.0, 0.0, -half] }
            }
            Convex::Cuboid { half } => [half[0].copysign(x), half[1].copysign(y), half[2].copysign(z)],
        }
    }

    /// How far all faces can move inwards, m.
    pub(super) fn inradius(&self) -> f64 {
        match *self {
            Convex::Cylinder { radius, half } => radius.min(half),
            Convex::Cone { radius, half } => {
                let length = 2.0 * half;
                radius * length / (radius + (radius * radius + length * length).sqrt())
            }
            Convex::Cuboid { half } => half[0].min(half[1]).min(half[2]),
        }
    }

    /// The shape whose faces lie `by` (m) inside these, less than [`Convex::inradius`], and how far its centre lies
    /// above.
    pub(super) fn shrunk(&self, by: f64) -> (Convex, f64) {
        match *self {
            Convex::Cylinder { radius, half } => (Convex::Cylinder { radius: radius - by, half: half - by }, 0.0),
            Convex::Cone { radius, half } => {
                // The tip moves up by the depth over the sine of half its angle, the flat end down by the depth.
                let share = 1.0 - by / self.inradius();
                (Convex::Cone { radius: radius * share, half: half * share }, half * (1.0 - share) - by)
            }
            Convex::Cuboid { half } => (Convex::Cuboid { half: half.map(|half| half - by) }, 0.0),
        }
    }
}

/// Turns a normal of a profile, radial and axial, about the axis to the point at `[x, y]`, `rho` from it.
#[inline(always)]
fn turned([x, y]: [f64; 2], rho: f64, [radial, axial]: [f64; 2]) -> [f64; 3] {
    if rho > 0.0 { [radial * (x / rho), radial * (y / rho), axial] } else { [radial, 0.0, axial] }
}

/// Distance and normal of a point `beyond` the two sides of a right angle.
#[inline(always)]
fn rectangle(beyond: [f64; 2]) -> (f64, [f64; 2]) {
    let [a, b] = beyond;
    if a > 0.0 && b > 0.0 {
        let length = (a * a + b * b).sqrt();
        return (length, [a / length, b / length]);
    }
    if a > b { (a, [1.0, 0.0]) } else { (b, [0.0, 1.0]) }
}

/// Distance and normal of a point `beyond` the three faces of a corner.
#[inline(always)]
fn corner(beyond: [f64; 3]) -> (f64, [f64; 3]) {
    let outside = beyond.map(|b| b.max(0.0));
    let squared = outside[0] * outside[0] + outside[1] * outside[1] + outside[2] * outside[2];
    if squared > 0.0 {
        let length = squared.sqrt();
        return (length, outside.map(|b| b / length));
    }
    let [a, b, c] = beyond;
    if a > b && a > c {
        (a, [1.0, 0.0, 0.0])
    } else if b > c {
        (b, [0.0, 1.0, 0.0])
    } else {
        (c, [0.0, 0.0, 1.0])
    }
}

/// Distance and normal of a point from the half profile of a cone: its tip at the origin, its flat end of `radius` at
/// `length` along the second axis.
#[inline(always)]
fn half_triangle([r, z]: [f64; 2], radius: f64, length: f64) -> (f64, [f64; 2]) {
    let slant = (radius * radius + length * length).sqrt();
    let (cos, sin) = (length / slant, radius / slant);
    let (across, along) = (r * cos - z * sin, r * sin + z * cos);
    let above = z - length;
    if across <= 0.0 && above <= 0.0 {
        return if across > above { (across, [cos, -sin]) } else { (above, [0.0, 1.0]) };
    }
    let from = |a: f64, b: f64| {
        let distance = (a * a + b * b).sqrt();
        (distance, [a / distance, b / distance])
    };
    if along < 0.0 {
        from(r, z)
    } else if r > radius && along > slant {
        from(r - radius, above)
    } else if above > 0.0 && r <= radius {
        (above, [0.0, 1.0])
    } else {
        (across, [cos, -sin])
    }
}
