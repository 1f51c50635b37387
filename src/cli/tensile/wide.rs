//! `droptower tensile wide`: coupons that are wide for their length, whose width is held.

use super::args::{Reduced, WideArgs};
use super::coupling::{self, Figures, Test, check_out, fabric};
use super::reduce::{all, paths, reduced};
use crate::{Failure, Shared, print_figures};
use base::diagnostic::{Diagnostic, shown_path};
use lab::experiment::Warning;
use lab::experiment::biaxial::{Coupling, edge_share};
use lab::experiment::coupon::{CouponTest, Direction};
use membrane::material::Fabric;

/// Speed of the jaws, m/s: nothing here depends on it.
const ANY_SPEED: f64 = 1.0;

/// Width over length of a coupon from which it counts as held.
const LEAST_WIDTH: f64 = 3.0;

pub(super) fn run(args: &WideArgs, shared: &Shared) -> Result<(), Failure> {
    check_out(&args.coupling, paths(&args.coupons.recordings)?.len())?;
    let fabric = fabric(&args.coupling)?;
    let Reduced { tests, .. } = reduced(&args.coupons, Some(ANY_SPEED))?;
    let tests = all(tests.iter().map(|own| test(own, fabric.as_ref())))?;
    let written = coupling::write(&args.coupling, "plane", &tests)?;
    let warnings: Vec<Warning> = tests.iter().flat_map(warnings).collect();
    let figures = Figures::new(&tests, &warnings, written);
    print_figures(shared, &figures, || figures.text())
}

fn test(own: &CouponTest, fabric: Option<&Fabric>) -> Result<Test, Diagnostic> {
    let name = shown_path(&own.place());
    let ratio = own.coupon.width() / own.coupon.gauge();
    if ratio < LEAST_WIDTH {
        let message = format!("{name}: its width, {ratio:.2} times its length, is not held by the jaws");
        return Err(Diagnostic::new(message)
            .hint("a wide coupon is at least three times as wide as long, better ten; `tensile reduce` takes others"));
    }
    let direction = own.sample.direction;
    let along = match direction {
        Direction::Md => Some(0),
        Direction::Td => Some(1),
        _ => None,
    };
    let curve = own.sample.curve.clone();
    let coupling = match (fabric, along) {
        (Some(fabric), Some(along)) => {
            let found = coupling::of(fabric, |film| Coupling::of_held_width(&curve, film, along));
            Some(found.map_err(|error| Diagnostic::new(format!("{name}: {error}")))?)
        }
        (Some(_), None) => {
            let message = format!("{name}: the coupling of MD and TD shows in coupons along MD or TD, not {direction}");
            return Err(Diagnostic::new(message));
        }
        (None, _) => None,
    };
    let high = coupling.as_ref().map(|own| own.value / (1.0 - edge_share(1.0, ratio)));
    let coupon = Some((direction.to_string(), ratio));
    Ok(Test { name, is_virtual: own.sample.is_virtual, curve, coupon, coupling, high })
}

/// Warnings about a test.
fn warnings(test: &Test) -> Vec<Warning> {
    let (Some(own), Some((_, ratio)), Some(high)) = (&test.coupling, &test.coupon, test.high) else {
        return Vec::new();
    };
    let name = || test.name.clone();
    let mut all = coupling::warnings(test);
    if !all.iter().any(|warning| matches!(warning, Warning::CouplingDoubtful { .. })) {
        all.push(Warning::CouponEdges { test: name(), ratio: *ratio, ends: [own.value, high] });
        all.push(Warning::WidthHeld { test: name() });
    }
    all
}
