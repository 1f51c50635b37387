//! Materials from coupon tests in scripts.

use rhai::{Dynamic, Engine, Map};

use crate::functions::Reduced;
use crate::script::{Entry, HostResult, Options, refuse};
use base::units::Density;
use lab::experiment::coupon::{Coupon, ShearMethod};
use lab::experiment::material_file::coupon::CouponMaterial;

/// Default name of the file of the shear curve.
const SHEAR_FILE: &str = "material-shear.csv";

/// Offers `coupon_material` to scripts.
pub(super) fn register(engine: &mut Engine) {
    engine
        .register_fn("coupon_material", |reduced: Reduced, coupon: Coupon| texts(&reduced, coupon, &Map::new()))
        .register_fn("coupon_material", |reduced: Reduced, coupon: Coupon, more: Map| texts(&reduced, coupon, &more));
}

fn texts(reduced: &Reduced, coupon: Coupon, more: &Map) -> HostResult<Map> {
    let more = Options { of: "coupon_material", map: more };
    more.check(&["density", "shear_file", "shear_by", "elastic_corner"])?;
    let density = more.map.get("density").map(|_| more.quantity("density", Density::DIMENSION)).transpose()?;
    let shear_file = more.map.get("shear_file").map_or(SHEAR_FILE.into(), Dynamic::to_string);
    let shear_by: Option<ShearMethod> =
        more.map.get("shear_by").map(|method| method.to_string().parse()).transpose().map_err(refuse)?;
    let shear_by = shear_by.unwrap_or_default();
    let elastic_corner = more.map.get("elastic_corner").map(|_| more.needed_number("elastic_corner")).transpose()?;
    let reduction = &reduced.0;
    let material =
        CouponMaterial { reduction, coupon, density, shear_file: &shear_file, elastic_corner, shear_by, shear: None };
    let texts = material.texts().map_err(refuse)?;
    let pairs = [("material", texts.material), ("shear", texts.shear)];
    Ok(pairs.into_iter().map(|(name, text)| (name.into(), Dynamic::from(text))).collect())
}

/// The reference of materials of coupon tests.
pub const ENTRIES: &[Entry] = &[Entry {
    call: "coupon_material(reduction, coupon), coupon_material(reduction, coupon, #{ density, shear_file, shear_by, elastic_corner })",
    gives: "a map of two texts: the material file of coupons of MD, TD and D3, and the shear curve's file that it names \
            (material-shear.csv); both state how many coupons were virtual; `shear_by` is as in `coupon.shear`; \
            up to the strain `elastic_corner` the curves of MD and TD have their mean Young's modulus",
    example: r#"let c = coupon(#{ gauge: "5 mm", width: "10 mm", thickness: "12 um" }); let t = read_coupons("data/virtual/coupons/*-0.2-*.csv", c);
                let m = coupon_material(reduce_coupons(t), c, #{ density: "0.915 g/cm3" });
                m.material.contains("thickness = \"12 um\"") && m.shear.contains("VIRTUAL") && m.shear.contains("strain,stress_MPa")"#,
}];
