//! Coupons of film that yields: true stress over plastic strain.

use std::fmt;
use std::path::Path;
use std::str::FromStr;

use thiserror::Error;

use crate::experiment::coupon::{Curve, CurveError, ModulusError};
use crate::signal::file::{self, ChannelSelection, ReadError, ReadOptions};
use crate::signal::{ChannelError, QuantityError};
use base::units::{Pressure, Strain};

/// Direction of a coupon in film that yields.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum PlasticDirection {
    /// The machine direction.
    Md,
    /// The transverse direction.
    Td,
    /// At 45° between them.
    Diagonal,
    /// Across the film, along its normal.
    Normal,
}

/// A word that is not a direction of a coupon.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("`{0}` is not a direction of a coupon: expected MD, TD, D3, D4 or ND")]
pub struct PlasticDirectionError(pub String);

impl PlasticDirection {
    /// All directions.
    pub const ALL: [PlasticDirection; 4] =
        [PlasticDirection::Md, PlasticDirection::Td, PlasticDirection::Diagonal, PlasticDirection::Normal];

    /// As it is written.
    pub fn name(self) -> &'static str {
        match self {
            PlasticDirection::Md => "MD",
            PlasticDirection::Td => "TD",
            PlasticDirection::Diagonal => "D3",
            PlasticDirection::Normal => "ND",
        }
    }
}

impl fmt::Display for PlasticDirection {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for PlasticDirection {
    type Err = PlasticDirectionError;

    fn from_str(text: &str) -> Result<PlasticDirection, PlasticDirectionError> {
        match text.trim().to_ascii_uppercase().as_str() {
            "MD" => Ok(PlasticDirection::Md),
            "TD" => Ok(PlasticDirection::Td),
            "D3" | "D4" => Ok(PlasticDirection::Diagonal),
            "ND" => Ok(PlasticDirection::Normal),
            _ => Err(PlasticDirectionError(text.into())),
        }
    }
}

/// The measured curve of one coupon.
#[derive(Clone, Debug, PartialEq)]
pub struct PlasticCoupon {
    /// Name in figures: that of its file.
    pub name: String,
    /// Its direction.
    pub direction: PlasticDirection,
    /// Nominal stress over engineering strain.
    pub curve: Curve,
}

/// Why a file is no coupon that yields.
#[derive(Debug, Error)]
pub enum CouponError {
    /// The file cannot be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// A column is missing.
    #[error("{name}: {fault}")]
    Column {
        /// Name of the coupon.
        name: String,
        /// Which one.
        fault: ChannelError,
    },
    /// A column has no unit, or another dimension.
    #[error("{name}: {fault}")]
    Quantity {
        /// Name of the coupon.
        name: String,
        /// Which one.
        fault: Box<QuantityError>,
    },
    /// The columns are no curve.
    #[error("{name}: {fault}")]
    Curve {
        /// Name of the coupon.
        name: String,
        /// Why.
        fault: CurveError,
    },
    /// There is no modulus in the window.
    #[error("{name}: {fault}")]
    Modulus {
        /// Name of the coupon.
        name: String,
        /// Why.
        fault: ModulusError,
    },
    /// The coupon does not flow.
    #[error("{name}: its largest stress comes before {} % of plastic strain", 100.0 * offset)]
    NoFlow {
        /// Name of the coupon.
        name: String,
        /// Plastic strain from which on hardening is fitted.
        offset: f64,
    },
}

impl PlasticCoupon {
    /// Reads the columns `strain` and `stress` of a table at `path`; both are engineering measures.
    ///
    /// # Errors
    /// [`CouponError`].
    pub fn read(path: &Path, direction: PlasticDirection, table: &ReadOptions) -> Result<PlasticCoupon, CouponError> {
        let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let columns = ["strain", "stress"].map(String::from).to_vec();
        let options = ReadOptions { channels: ChannelSelection::Named(columns), ..table.clone() };
        let table = file::columns(path, &options)?.over_samples();
        let channel =
            |wanted: &str| table.channel(wanted).map_err(|fault| CouponError::Column { name: name.clone(), fault });
        let (strain, stress) = (channel("strain")?, channel("stress")?);
        let quantity = |fault| CouponError::Quantity { name: name.clone(), fault: Box::new(fault) };
        let strains = match &strain.unit {
            None => &strain.series,
            Some(_) => strain.quantity(Strain::DIMENSION).map_err(quantity)?,
        };
        let stresses = stress.quantity(Pressure::DIMENSION).map_err(quantity)?;
        let curve = Curve::new(strains.values().to_vec(), stresses.values().to_vec());
        let curve = curve.map_err(|fault| CouponError::Curve { name: name.clone(), fault })?;
        Ok(PlasticCoupon { name, direction, curve })
    }

    /// Young's modulus (Pa) between the strains of `window`, and the curve from where its elastic line meets zero stress.
    ///
    /// # Errors
    /// [`CouponError::Modulus`].
    pub fn modulus(&self, window: [f64; 2]) -> Result<(f64, Curve), CouponError> {
        let modulus = self.curve.modulus(window);
        let modulus = modulus.map_err(|fault| CouponError::Modulus { name: self.name.clone(), fault })?;
        Ok((modulus.slope, self.curve.toe_compensated(modulus.slope, modulus.intercept)))
    }
}

/// True stress over plastic strain: T = s (1 + e) and E_p = ln(1 + e) − T/Y, up to the largest nominal stress, from
/// which on the coupon necks.
#[derive(Clone, Debug, PartialEq)]
pub struct TrueCurve {
    /// Plastic strain and true stress, Pa; plastic strain ascends.
    pub points: Vec<[f64; 2]>,
    /// Engineering strain and stress (Pa) at the same points.
    pub engineering: Vec<[f64; 2]>,
}

impl TrueCurve {
    /// `count` points of `curve` at equal intervals of engineering strain, from the plastic strain `offset` on, with
    /// Young's modulus `young` (Pa); none where fewer than two flow.
    pub(super) fn from_engineering(curve: &Curve, young: f64, offset: f64, count: usize) -> Option<TrueCurve> {
        let plastic = |[strain, stress]: [f64; 2]| strain.ln_1p() - stress * (1.0 + strain) / young;
        let samples: Vec<[f64; 2]> = curve.samples().collect();
        let top = samples.iter().enumerate().max_by(|a, b| a.1[1].total_cmp(&b.1[1])).map(|(place, _)| place)?;
        let first = samples[..top].iter().rposition(|sample| plastic(*sample) < offset).map_or(0, |place| place + 1);
        let (from, to) = (samples[first][0], samples[top][0]);
        if first >= top {
            return None;
        }
        let mut out = TrueCurve { points: vec![], engineering: vec![] };
        for k in 0..count {
            let strain = from + (to - from) * k as f64 / (count - 1) as f64;
            let sample = [strain, curve.stress_at(strain)?];
            let p = plastic(sample);
            if p >= offset && out.points.last().is_none_or(|last| p > last[0]) {
                out.points.push([p, sample[1] * (1.0 + strain)]);
                out.engineering.push(sample);
            }
        }
        (out.points.len() >= 2).then_some(out)
    }

    /// True stress (Pa) at the plastic strain `p`; none outside.
    pub fn stress_at(&self, p: f64) -> Option<f64> {
        let after = self.points.iter().position(|point| point[0] >= p)?;
        let [to, high] = self.points[after];
        if to == p {
            return Some(high);
        }
        let [from, low] = self.points[after.checked_sub(1)?];
        Some(low + (high - low) * (p - from) / (to - from))
    }
}
