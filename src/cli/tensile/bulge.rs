//! `droptower tensile bulge`: from pressure and height of a bulge to stress over strain in both directions.

use std::path::Path;

use super::args::BulgeArgs;
use super::coupling::{self, Figures, Test, check_out, fabric, warnings};
use super::reduce::{all, paths};
use crate::faults;
use crate::{Failure, Shared, print_figures};
use base::diagnostic::{Diagnostic, shown_path};
use base::units::{Dimension, Length, Pressure};
use lab::experiment::Warning;
use lab::experiment::biaxial::{Bulge, Coupling};
use lab::signal::file::{self, ChannelSelection};
use lab::signal::{ChannelError, Measurement, QuantityError, Series};
use membrane::material::Fabric;

/// Names of the height of the top, in the order in which they are looked for.
const HEIGHTS: [&str; 3] = ["height", "apex", "deflection"];

pub(super) fn run(args: &BulgeArgs, shared: &Shared) -> Result<(), Failure> {
    let bulge = Bulge::new(args.radius, args.thickness).map_err(|error| Diagnostic::new(error.to_string()))?;
    let paths = paths(&args.recordings)?;
    check_out(&args.coupling, paths.len())?;
    let fabric = fabric(&args.coupling)?;
    let tests = all(paths.iter().map(|path| test(args, &bulge, path, fabric.as_ref())))?;
    let written = coupling::write(&args.coupling, "equibiaxial", &tests)?;
    let warnings: Vec<Warning> = std::iter::once(Warning::CapAssumed).chain(tests.iter().flat_map(warnings)).collect();
    let figures = Figures::new(&tests, &warnings, written);
    print_figures(shared, &figures, || figures.text())
}

fn test(args: &BulgeArgs, bulge: &Bulge, path: &Path, fabric: Option<&Fabric>) -> Result<Test, Diagnostic> {
    let fault = |error: &dyn std::fmt::Display| Diagnostic::new(format!("{}: {error}", shown_path(path)));
    let options = args.file.options(ChannelSelection::All)?;
    let table = file::columns(path, &options).map_err(|error| faults::recording(&error))?.over_samples();
    let pressure = channel(&table, path, &args.pressure, Pressure::DIMENSION)?;
    let named = args.height.as_deref().or_else(|| HEIGHTS.into_iter().find(|name| table.channel(name).is_ok()));
    let height = channel(&table, path, named.unwrap_or(HEIGHTS[0]), Length::DIMENSION)?;
    let curve = bulge.curve(pressure.values(), height.values());
    let curve = curve.map_err(|error| Diagnostic { hint: error.hint().map(str::to_owned), ..fault(&error) })?;
    let coupling = fabric.map(|fabric| coupling::of(fabric, |film| Coupling::of_equal_strains(&curve, film)));
    let coupling = coupling.transpose();
    let coupling =
        coupling.map_err(|error| fault(&error).hint("check the units of height and --radius, and --film"))?;
    let is_virtual = table.annotations.is_virtual();
    Ok(Test { name: shown_path(path), is_virtual, curve, coupon: None, coupling, high: None })
}

/// The channel of a name, in SI.
fn channel<'t>(
    table: &'t Measurement,
    path: &Path,
    name: &str,
    dimension: Dimension,
) -> Result<&'t Series, Diagnostic> {
    let missing = |error: &ChannelError| {
        Diagnostic::new(format!("{}: {error}", shown_path(path)))
            .hint("a bulge has the channels `pressure` and `height`; --pressure and --height name others")
    };
    let found = table.channel(name).map_err(|error| missing(&error))?;
    found.quantity(dimension).map_err(|error| match &error {
        // Of several channels, each has its own.
        QuantityError::NoUnit { name, expected } => {
            faults::quantity(path, &error).hint(format!("give it: --unit {name}={}", expected.unit))
        }
        QuantityError::OtherDimension { .. } => faults::quantity(path, &error),
    })
}
