//! A plastic law, fitted to coupons.

use std::fmt::Write;
use std::path::PathBuf;

use serde::Serialize;

use super::args::{FitArgs, PlasticArgs};
use crate::scenarios::expanded;
use crate::{Failure, Shared, faults, findings, output, print_figures};
use base::diagnostic::{Diagnostic, shown_path};
use base::finding::Finding;
use base::number::significant;
use lab::experiment::coupon::ModulusError;
use lab::experiment::law_fit::plastic::{
    CouponError, HardeningForm, PlasticCoupon, PlasticFit, PlasticFitError, PlasticRules,
};
use lab::signal::file::ChannelSelection;
use membrane::material::Hardening;

/// Digits of figures in a material file.
const DIGITS: usize = 6;

/// The figures of a fit; SI.
#[derive(Serialize)]
struct Figures {
    law: String,
    #[serde(rename = "young_modulus_Pa")]
    young: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    voce: Option<[f64; 3]>,
    r22: f64,
    r45: f64,
    r33: f64,
    plastic_strain_end: f64,
    coupons: Vec<CouponFigures>,
    scatter: Vec<(String, f64)>,
    findings: Vec<Finding>,
    written: Vec<String>,
}

#[derive(Serialize)]
struct CouponFigures {
    name: String,
    direction: &'static str,
    #[serde(rename = "strength_Pa")]
    strength: f64,
    #[serde(rename = "rms_Pa")]
    rms: f64,
    #[serde(rename = "largest_difference_Pa")]
    largest: f64,
}

pub(super) fn run(form: HardeningForm, args: &FitArgs, shared: &Shared) -> Result<(), Failure> {
    let PlasticArgs { directions, window, offset } = &args.plastic;
    let paths: Vec<PathBuf> =
        args.data.iter().map(|pattern| expanded(pattern)).collect::<Result<Vec<_>, _>>()?.concat();
    if directions.len() != paths.len() {
        let message = format!("{} directions for {} files of coupons", directions.len(), paths.len());
        return Err(Diagnostic::new(message).hint("give one for each: --directions MD,MD,TD").into());
    }
    for (is_given, option) in [
        (!args.weight.is_empty(), "--weight"),
        (!args.test.is_empty(), "--test"),
        (!args.predict.is_empty(), "--predict"),
        (args.stable_to.is_some(), "--stable-to"),
        (args.page.is_some(), "--page"),
    ] {
        super::refuse(is_given, option, "laws of rubber-like film")?;
    }
    let options = args.file.options(ChannelSelection::All)?;
    let coupons = paths
        .iter()
        .zip(directions)
        .map(|(path, direction)| PlasticCoupon::read(path, *direction, &options).map_err(|error| coupon_fault(&error)));
    let coupons = coupons.collect::<Result<Vec<_>, _>>()?;
    let rules = PlasticRules { form, window: [window[0], window[1]], offset: *offset };
    let fit = PlasticFit::from_coupons(&coupons, &rules).map_err(|error| match &error {
        PlasticFitError::Coupon(error) => coupon_fault(error),
        PlasticFitError::NoMachineDirection => Diagnostic::new(error.to_string()).hint("mark one: --directions MD,…"),
        other => Diagnostic::new(format!("no law: {other}")),
    })?;
    let mut written = vec![];
    if let Some(path) = &args.out {
        output::check(path, "toml", None, None)?;
        let text = material(&fit, form, args, args.poisson, &coupons)?;
        output::write_sealed(&[(path.clone(), text)])?;
        written.push(shown_path(path).to_string());
    }
    let figures = figures(&fit, form, written);
    print_figures(shared, &figures, || text(&figures))
}

fn coupon_fault(error: &CouponError) -> Diagnostic {
    let diagnostic = Diagnostic::new(error.to_string());
    match error {
        CouponError::Read(error) => faults::recording(error),
        CouponError::Column { .. } => diagnostic
            .hint("a coupon has the columns `strain` and `stress`, engineering measures; --columns names them"),
        CouponError::Quantity { .. } => diagnostic.hint("give the unit: --unit stress=MPa"),
        CouponError::Modulus { fault: ModulusError::Window { .. } | ModulusError::TooFew { .. }, .. } => {
            diagnostic.hint("choose the window of the elastic part: --window 0.001 0.003")
        }
        _ => diagnostic,
    }
}

fn figures(fit: &PlasticFit, form: HardeningForm, written: Vec<String>) -> Figures {
    let voce = match &fit.hardening {
        Hardening::Voce(voce) => Some([voce.initial, voce.saturation, voce.rate]),
        Hardening::Table(_) => None,
    };
    let coupons = fit.coupons.iter().map(|coupon| CouponFigures {
        name: coupon.name.clone(),
        direction: coupon.direction.name(),
        strength: coupon.strength,
        rms: coupon.rms,
        largest: coupon.largest,
    });
    let [r22, r45, r33] = fit.ratios.map(|ratio| ratio.value);
    Figures {
        law: form.to_string(),
        young: fit.young,
        voce,
        r22,
        r45,
        r33,
        plastic_strain_end: fit.end,
        coupons: coupons.collect(),
        scatter: fit.scatter.iter().map(|(direction, scatter)| (direction.to_string(), *scatter)).collect(),
        findings: fit.warnings.iter().map(Finding::new).collect(),
        written,
    }
}

fn text(figures: &Figures) -> String {
    let mut out = format!("{}  E {} MPa\n", figures.law, significant(figures.young * 1e-6, 4));
    if let Some([initial, saturation, rate]) = figures.voce {
        let [initial, saturation] = [initial, saturation].map(|stress| significant(stress * 1e-6, 4));
        let _ = writeln!(out, "  yield {initial} MPa, saturation {saturation} MPa, rate {}", significant(rate, 4));
    }
    let [r22, r45, r33] = [figures.r22, figures.r45, figures.r33].map(|ratio| significant(ratio, 4));
    let _ = writeln!(out, "  yield stress over that along MD: TD {r22}, 45° {r45}, ND {r33}");
    let _ = writeln!(out, "  up to the plastic strain {}", significant(figures.plastic_strain_end, 3));
    for CouponFigures { name, direction, strength, rms, largest } in &figures.coupons {
        let [rms, largest] = [rms, largest].map(|difference| significant(100.0 * difference / strength, 2));
        let _ = writeln!(out, "  {direction}  {name}: {rms} % rms, at most {largest} % of its strength");
    }
    for (direction, scatter) in &figures.scatter {
        let _ = writeln!(out, "  {direction}  coupons differ by up to {} %", significant(100.0 * scatter, 2));
    }
    out += &findings::lines("", &figures.findings);
    out.extend(figures.written.iter().map(|file| format!("wrote {file}\n")));
    out
}

/// The material file.
fn material(
    fit: &PlasticFit,
    form: HardeningForm,
    args: &FitArgs,
    poisson: Option<f64>,
    coupons: &[PlasticCoupon],
) -> Result<String, Diagnostic> {
    let (Some(density), Some(thickness)) = (args.density, args.thickness) else {
        let message = "a material file needs the density and the thickness of the film";
        return Err(Diagnostic::new(message).hint("give them: --density \"920 kg/m3\" --thickness \"50 um\""));
    };
    if poisson.is_some_and(|poisson| !(poisson > -1.0 && poisson < 0.5)) {
        return Err(Diagnostic::new("expected a Poisson's ratio between -1 and 0.5"));
    }
    let names: Vec<String> = coupons.iter().map(|coupon| format!("{} ({})", coupon.name, coupon.direction)).collect();
    let mpa = |stress: f64| significant(stress * 1e-6, DIGITS);
    let hardening = match &fit.hardening {
        Hardening::Voce(voce) => format!(
            "{{ voce = {{ yield = \"{} MPa\", saturation = \"{} MPa\", rate = {} }} }}",
            mpa(voce.initial),
            mpa(voce.saturation),
            significant(voce.rate, DIGITS)
        ),
        Hardening::Table(curve) => {
            let points = curve
                .points()
                .map(|[p, stress]| format!("    [{}, \"{} MPa\"],\n", significant(p, DIGITS), mpa(stress)));
            format!("{{ curve = [\n{}] }}", points.collect::<String>())
        }
    };
    let [td, diagonal, normal] = fit.ratios;
    let assumed: Vec<&str> = [(diagonal, "r12"), (td, "r22"), (normal, "r33")]
        .into_iter()
        .filter_map(|(ratio, key)| (!ratio.measured).then_some(key))
        .collect();
    let remark = if assumed.is_empty() { String::new() } else { format!(" # assumed: {}", assumed.join(", ")) };
    let [r22, r33, r12] = [td.value, normal.value, fit.shear_ratio()].map(|ratio| significant(ratio, DIGITS));
    Ok(format!(
        "# {form}, fitted by droptower tensile fit to the coupons\n# {}\n\
         # up to the equivalent plastic strain {}. No coupon was unloaded: the plastic strain is what exceeds stress over\n\
         # modulus, assumed.\n\
         density   = \"{} kg/m3\"\nthickness = \"{} um\"\n\n[plastic]\n\
         young     = \"{} MPa\"\npoisson   = {}{}\nhardening = {hardening}\n\
         hill      = {{ r11 = 1, r22 = {r22}, r33 = {r33}, r12 = {r12} }}{remark}\n",
        names.join(", "),
        significant(fit.end, 3),
        significant(density, DIGITS),
        significant(thickness * 1e6, DIGITS),
        mpa(fit.young),
        significant(poisson.unwrap_or(ASSUMED_POISSON), DIGITS),
        if poisson.is_some() { "" } else { " # assumed" },
    ))
}

/// Poisson's ratio of polymer film where none is given.
const ASSUMED_POISSON: f64 = 0.4;
