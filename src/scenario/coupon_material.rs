//! The material file that coupon tests give: what was measured, what is assumed, and what is left to the user.

use std::fmt::Write;

use thiserror::Error;

use crate::experiment::coupon::average::Spread;
use crate::experiment::coupon::{Along, Coupon, CouponError, Direction, Reduction, YieldError};

/// Density of LLDPE film, kg/m³, where the user gives none.
const LLDPE_DENSITY: f64 = 915.0;

/// Points of the shear curve that is written.
const SHEAR_POINTS: usize = 16;

/// The first words of every file that is made of coupon tests.
pub const MARK: &str = "# Written by droptower from coupon tests";

/// What a material file is made of.
#[derive(Clone, Debug)]
pub struct CouponMaterial<'a> {
    pub reduction: &'a Reduction,
    pub coupon: Coupon,
    /// Side L of the square of equations 4 to 8, m.
    pub side: f64,
    /// kg/m³; that of LLDPE where it is not known.
    pub density: Option<f64>,
    /// Name of the shear curve's file, which lies beside the material's.
    pub shear_file: &'a str,
    /// How many of the recordings say that they are virtual.
    pub virtual_recordings: usize,
}

/// A material file and the shear curve's file beside it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Texts {
    pub material: String,
    pub shear: String,
}

/// Why coupons give no material.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum CouponMaterialError {
    #[error("a material needs coupons of MD, TD and D3 (for shear), and there is none of {direction}")]
    Missing { direction: Direction },
    #[error("{direction}: {source}")]
    Yield { direction: Direction, source: YieldError },
    #[error("{direction}: stress falls between the points {}, which a material's curve does not", shown(points))]
    Falls { direction: Direction, points: [[f64; 2]; 2] },
    #[error("shear: {0}")]
    Shear(#[from] CouponError),
    #[error("shear: stress falls at the angle {angle} rad, which a material's curve does not")]
    ShearFalls { angle: f64 },
}

fn shown(points: &[[f64; 2]; 2]) -> String {
    let point = |[strain, stress]: [f64; 2]| format!("({}, {} MPa)", digits(strain), digits(stress * 1e-6));
    format!("{} and {}", point(points[0]), point(points[1]))
}

impl CouponMaterial<'_> {
    /// The files' texts.
    ///
    /// The curves of MD and TD are the yield points of the mean curve, and the mean break elongation with the mean
    /// stress at the break. The shear curve comes from the mean curve of D3.
    pub fn texts(&self) -> Result<Texts, CouponMaterialError> {
        let (md, td) = (self.along(Direction::Md)?, self.along(Direction::Td)?);
        let skewed = self.along(Direction::D3)?;
        let (md_fibre, td_fibre) = (fibre(md)?, fibre(td)?);
        let (shear, remark) = self.shear(skewed)?;
        let mut material = self.head();
        let rates = self.reduction.velocities().map(|velocity| digits(velocity / self.coupon.gauge()));
        let _ = write!(
            material,
            "\n{density}\nthickness = \"{thickness} um\"   # as given; one layer\n\n[fabric]\n\
             # Yield points of the mean curves, mean break elongation and mean stress at the break. Between them: straight lines.\n\
             md = {md_fibre}\ntd = {td_fibre}\n{remark}shear = {{ curve = \"{file}\" }}\n\
             # Coupons that are pulled until they break do not show what is lost on unloading. Until a drop test has shown it\n\
             # (droptower signal drop), nothing is.\n# absorption = 0.9\n\
             # Slowest and fastest jaws over the gauge length.\nmeasured_rates = [\"{} 1/s\", \"{} 1/s\"]\n",
            rates[0],
            rates[1],
            density = self.density_line(),
            thickness = digits(self.coupon.thickness() * 1e6),
            file = self.shear_file,
        );
        Ok(Texts { material, shear })
    }

    fn along(&self, direction: Direction) -> Result<&Along, CouponMaterialError> {
        self.reduction.along(direction).ok_or(CouponMaterialError::Missing { direction })
    }

    fn head(&self) -> String {
        let count: usize = self.reduction.directions.iter().map(|along| along.elongation.count).sum();
        let mut head = format!("{MARK}: {count} recordings.\n");
        if self.virtual_recordings > 0 {
            let _ = writeln!(head, "# {} of them are VIRTUAL: nothing was pulled.", self.virtual_recordings);
        }
        head.extend(self.reduction.directions.iter().map(summary));
        head
    }

    fn density_line(&self) -> String {
        match self.density {
            Some(density) => format!("density   = \"{} kg/m3\"", digits(density)),
            None => format!("density   = \"{LLDPE_DENSITY} kg/m3\" # assumed: that of LLDPE, since none was given"),
        }
    }

    /// The shear curve's file, and the remark that belongs to it.
    fn shear(&self, skewed: &Along) -> Result<(String, String), CouponMaterialError> {
        let sheared = self.coupon.shear(&skewed.curve, self.side)?;
        let [_, end] = sheared.curve.range();
        let mut file = format!("{MARK}: shear angle (rad) and stress of the film, from D3.\nstrain,stress_MPa\n");
        let mut before = 0.0;
        for i in 1..=SHEAR_POINTS {
            let angle = if i == SHEAR_POINTS { end } else { end * i as f64 / SHEAR_POINTS as f64 };
            let Some(stress) = sheared.curve.at(angle).filter(|stress| *stress >= before) else {
                return Err(CouponMaterialError::ShearFalls { angle });
            };
            let _ = writeln!(file, "{},{}", digits(angle), digits(stress * 1e-6));
            before = stress;
        }
        let side = digits(self.side * 1e3);
        let cut = if sheared.cut > 0 { ", where the square is closed; D3 was measured beyond" } else { "" };
        let remark = format!(
            "# From D3 by equations 4 to 8 of Polymers 2021, 13, 1537, up to the angle {}{cut}. Assumed: a square of the side\n\
             # {side} mm that carries its share of the coupon's width.\n",
            digits(end)
        );
        Ok((file, remark))
    }
}

/// What was measured along one direction, as a comment.
fn summary(along: &Along) -> String {
    let Along { direction, elongation, .. } = along;
    let speeds: Vec<String> = along.speeds.iter().map(|speed| digits(speed.velocity)).collect();
    let (modulus, strength) = (shown_spread(&along.modulus, 1e-6), shown_spread(&along.strength, 1e-6));
    format!(
        "# {direction}: {} coupons at {} m/s; E {modulus} MPa, strength {strength} MPa, break elongation {} %.\n",
        elongation.count,
        speeds.join(", "),
        shown_spread(elongation, 100.0),
    )
}

fn shown_spread(spread: &Spread, factor: f64) -> String {
    format!("{:.1} +- {:.1}", spread.mean * factor, spread.deviation * factor)
}

/// Yield points and break as the language writes them.
fn fibre(along: &Along) -> Result<String, CouponMaterialError> {
    let direction = along.direction;
    let yields =
        along.yields.as_ref().map_err(|source| CouponMaterialError::Yield { direction, source: source.clone() })?;
    let points = [[0.0, 0.0], yields.first, yields.second, [along.elongation.mean, along.break_stress.mean]];
    for pair in points.windows(2) {
        if pair[1][0] <= pair[0][0] || pair[1][1] < pair[0][1] {
            return Err(CouponMaterialError::Falls { direction, points: [pair[0], pair[1]] });
        }
    }
    let [_, first, second, end] =
        points.map(|[strain, stress]| format!("[{}, \"{} MPa\"]", digits(strain), digits(stress * 1e-6)));
    Ok(format!("{{ yield = [{first}, {second}], break = {end} }}"))
}

/// Four significant digits.
fn digits(value: f64) -> String {
    let rounded = format!("{value:.3e}").parse::<f64>();
    rounded.unwrap_or(value).to_string()
}
