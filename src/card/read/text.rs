//! A film that was read as a material file.

use super::{Found, FoundLaw};
use crate::film::{Points, Rated};
use crate::layout;

/// A number with the digits that survive a change of units.
fn whole(value: f64) -> String {
    const DIGITS: usize = 12;
    let rounded: f64 = format!("{value:.*e}", DIGITS - 1).parse().unwrap_or(value);
    layout::whole(rounded)
}

/// The text of a material whose layers are `thickness` (m) thick, below `comments`, one a line.
pub fn material(found: &Found, thickness: f64, comments: &[String]) -> String {
    let mut text: String = comments.iter().map(|comment| format!("# {}\n", one_line(comment))).collect();
    text += &format!("name      = {}\n", quoted(&found.name));
    text +=
        &format!("density   = \"{} kg/m3\"\nthickness = \"{} um\"\n\n", whole(found.density), whole(1e6 * thickness));
    text += &law(&found.law);
    for [share, time] in &found.prony {
        text += &format!("\n[[prony]]\nshare = {}\ntime  = \"{} s\"\n", whole(*share), whole(*time));
    }
    text
}

fn law(law: &FoundLaw) -> String {
    match law {
        FoundLaw::Fabric { fibres: [md, td], shear, absorption } => {
            let mut text = format!("[fabric]\n{}{}", fibre("md", md), fibre("td", td));
            text += &format!("shear = {{ curve = {} }}\n", points(shear));
            text + &format!("absorption = {}\n", whole(*absorption))
        }
        FoundLaw::Elastic { young, poisson } => {
            format!("[elastic]\nyoung   = {}\npoisson = {}\n", stress(*young), whole(*poisson))
        }
        FoundLaw::Polynomial([c10, c01, c20, c30]) => {
            let (name, constants) = match (*c01 == 0.0, *c20 == 0.0 && *c30 == 0.0) {
                (true, true) => ("neo-hookean", vec![("mu", 2.0 * c10)]),
                (false, true) => ("mooney-rivlin", vec![("c10", *c10), ("c01", *c01)]),
                (_, false) => ("yeoh", vec![("c10", *c10), ("c20", *c20), ("c30", *c30)]),
            };
            let constants: String =
                constants.iter().map(|(name, value)| format!("{name} = {}\n", stress(*value))).collect();
            format!("[hyperelastic]\nlaw = \"{name}\"\n{constants}")
        }
        FoundLaw::Ogden(terms) => {
            let list = |values: Vec<String>| values.join(", ");
            let mu = list(terms.iter().map(|[mu, _]| stress(*mu)).collect());
            let alpha = list(terms.iter().map(|[_, alpha]| whole(*alpha)).collect());
            format!("[hyperelastic]\nlaw   = \"ogden\"\nmu    = [{mu}]\nalpha = [{alpha}]\n")
        }
        FoundLaw::Plastic { young, poisson, curves, hill } => {
            let mut text = format!("[plastic]\nyoung   = {}\npoisson = {}\n", stress(*young), whole(*poisson));
            match curves.as_slice() {
                [(None, only)] => text += &format!("hardening = {{ curve = {} }}\n", points(only)),
                curves => text += &format!("hardening = {{ rates = [\n{}] }}\n", rows(curves)),
            }
            if let Some(r) = hill {
                let [r0, r45, r90] = r.map(whole);
                text += &format!("hill = {{ r0 = {r0}, r45 = {r45}, r90 = {r90} }}\n");
            }
            text
        }
    }
}

fn fibre(name: &str, curves: &[Rated<Points>]) -> String {
    if let [(None, only)] = curves {
        return format!("{name} = {{ curve = {} }}\n", points(only));
    }
    format!("{name}.rates = [\n{}]\n", rows(curves))
}

/// The curves of several rates, a line each.
fn rows(curves: &[Rated<Points>]) -> String {
    let row = |(rate, curve): &Rated<Points>| {
        format!("    {{ rate = \"{} 1/s\", curve = {} }},\n", whole(rate.unwrap_or_default()), points(curve))
    };
    curves.iter().map(row).collect()
}

fn points(points: &[[f64; 2]]) -> String {
    let point = |[x, y]: &[f64; 2]| format!("[{}, {}]", whole(*x), stress(*y));
    format!("[{}]", points.iter().map(point).collect::<Vec<_>>().join(", "))
}

fn stress(value: f64) -> String {
    format!("\"{} Pa\"", whole(value))
}

fn one_line(text: &str) -> String {
    text.chars().map(|c| if c.is_control() { ' ' } else { c }).collect()
}

/// A string of JSON is one of TOML.
fn quoted(text: &str) -> String {
    serde_json::Value::from(one_line(text)).to_string()
}
