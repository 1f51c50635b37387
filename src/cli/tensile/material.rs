//! The material file of reduced coupons, checked as `droptower check` does before it is written.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use super::args::{ReduceArgs, Reduced};
use super::output;
use crate::Failure;
use base::diagnostic::{Diagnostic, shown_path};
use base::file::{self, FileError};
use lab::experiment::coupon::Direction;
use lab::experiment::material_file::coupon::{CouponMaterial, CouponMaterialError, GivenShear};
use scene::model;
use scene::scenario::Document;

/// Largest shear curve that is read, bytes.
const MOST_BYTES: u64 = 1 << 20;

/// The files to write and their texts; none where no file is asked for.
pub(super) fn texts(args: &ReduceArgs, reduced: &Reduced) -> Result<Vec<(PathBuf, String)>, Failure> {
    let Some(path) = &args.out else {
        return Ok(Vec::new());
    };
    check_folder(path)?;
    let places = output::places(path)?;
    let given = args.shear.as_deref().map(|file| given(file, &places)).transpose()?;
    let [material, shear] = places;
    let source = args.shear.as_deref().map(shown_path).unwrap_or_default();
    let shear_file = shear.file_name().unwrap_or_default().to_string_lossy();
    let written = CouponMaterial {
        reduction: &reduced.reduction,
        coupon: reduced.coupon,
        density: args.density,
        shear_file: &shear_file,
        elastic_corner: args.elastic_corner.then(|| args.coupons.window[1]),
        shear_by: args.shear_by,
        shear: given.as_deref().map(|text| GivenShear { source: &source, text }),
    };
    let texts = written.texts().map_err(|error| fault(&error))?;
    check(&written, args.shear.as_deref())?;
    Ok(vec![(shear, texts.shear), (material, texts.material)])
}

fn fault(error: &CouponMaterialError) -> Diagnostic {
    let mistake = Diagnostic::new(format!("no material: {error}"));
    match error {
        CouponMaterialError::Missing { direction: Direction::D3 } => {
            mistake.hint("give a shear curve from elsewhere: --shear FILE")
        }
        _ => mistake,
    }
}

fn check_folder(material: &Path) -> Result<(), Diagnostic> {
    match material.parent().filter(|folder| !folder.as_os_str().is_empty()) {
        Some(folder) if !folder.is_dir() => {
            let message =
                format!("{} cannot be written: there is no folder {}", shown_path(material), shown_path(folder));
            Err(Diagnostic::new(message).hint("create it first"))
        }
        _ => Ok(()),
    }
}

/// The text of a shear curve, which must not be one of the files to be written.
fn given(shear: &Path, places: &[PathBuf]) -> Result<String, Diagnostic> {
    let canonical = |path: &Path| fs::canonicalize(path).ok();
    let is_written = places.iter().any(|place| canonical(place).is_some_and(|place| canonical(shear) == Some(place)));
    if is_written {
        let message = format!("{} is the shear curve and would be replaced", shown_path(shear));
        return Err(Diagnostic::new(message).hint("give the material another name"));
    }
    file::read_text(shear, MOST_BYTES).map_err(|error| {
        let why = match error {
            FileError::TooLarge { .. } => {
                format!("it is larger than {} MB, the most of a shear curve", MOST_BYTES >> 20)
            }
            other => other.to_string(),
        };
        Diagnostic::new(format!("cannot read {}: {why}", shown_path(shear)))
    })
}

/// Refuses a material that `droptower check` would refuse, with the place of a mistake in the `given` shear curve.
fn check(written: &CouponMaterial<'_>, given: Option<&Path>) -> Result<(), Vec<Diagnostic>> {
    let scratch = scratch(written, given).map_err(|error| vec![Diagnostic::new(format!("no material: {error}"))])?;
    let document = Document::read_material(&scratch.path().join(DRAFT))?;
    model::check_material(&document).map(|_| ())
}

const DRAFT: &str = "material.toml";

/// A folder of its own with the material, which reads the `given` shear curve where that lies.
fn scratch(written: &CouponMaterial<'_>, given: Option<&Path>) -> io::Result<tempfile::TempDir> {
    let scratch = tempfile::tempdir()?;
    let shear = match given {
        Some(file) => fs::canonicalize(file)?,
        None => scratch.path().join("shear.csv"),
    };
    let shear_file = shear.to_string_lossy();
    let draft = CouponMaterial { shear_file: &shear_file, ..written.clone() }.texts().map_err(io::Error::other)?;
    if given.is_none() {
        fs::write(&shear, draft.shear)?;
    }
    fs::write(scratch.path().join(DRAFT), draft.material)?;
    Ok(scratch)
}
