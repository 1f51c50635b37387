//! Tests for which there is a template.

use std::path::Path;

use clap::Subcommand;

use super::{Script, Target, Template};
use base::diagnostic::shown_path;

/// The tests.
#[derive(Debug, Subcommand)]
pub(super) enum Test {
    /// A sphere on a wound film, as in the LLDPE study
    Drop(Target),
    /// A falling dart on a clamped disc, ASTM D1709 method A; its failure mass by a script
    #[command(name = "d1709-a", alias = "dart")]
    D1709A(Target),
    /// The same with a larger dart from a greater height, method B
    #[command(name = "d1709-b")]
    D1709B(Target),
    /// High-speed puncture of a film, ASTM D7192
    #[command(name = "d7192")]
    D7192(Target),
    /// Protrusion puncture of stretch wrap film by a slow probe, ASTM D5748
    #[command(name = "d5748")]
    D5748(Target),
    /// Instrumented puncture, ISO 7765-2
    #[command(name = "iso7765-2")]
    Iso7765(Target),
    /// Puncture of packaging film by a fine, slow probe, EN 14477
    #[command(name = "en14477")]
    En14477(Target),
    /// A tensile coupon between two jaws
    Coupon(Target),
    /// A slow probe into a clamped disc
    Indent(Target),
    /// A clamped disc inflated by pressure
    Pressure(Target),
    /// A clamped disc of rubber inflated by gas, beyond its largest pressure
    Volume(Target),
}

/// The post script of the puncture tests.
const PUNCTURE: Script = ("puncture.rhai", include_str!("../../../scripts/post/puncture.rhai"));

impl Test {
    /// Where its template is written.
    pub(super) fn target(&self) -> &Target {
        match self {
            Test::Drop(target)
            | Test::D1709A(target)
            | Test::D1709B(target)
            | Test::D7192(target)
            | Test::D5748(target)
            | Test::Iso7765(target)
            | Test::En14477(target)
            | Test::Coupon(target)
            | Test::Indent(target)
            | Test::Pressure(target)
            | Test::Volume(target) => target,
        }
    }

    /// Its scenario and scripts.
    pub(super) fn template(&self) -> Template {
        let (text, scripts): (_, &[Script]) = match self {
            Test::Drop(_) => (include_str!("templates/drop.toml"), &[]),
            Test::D1709A(_) => (include_str!("templates/d1709-a.toml"), &[PUNCTURE]),
            Test::D1709B(_) => (include_str!("templates/d1709-b.toml"), &[PUNCTURE]),
            Test::D7192(_) => (include_str!("templates/d7192.toml"), &[PUNCTURE]),
            Test::D5748(_) => (include_str!("templates/d5748.toml"), &[PUNCTURE]),
            Test::Iso7765(_) => (include_str!("templates/iso7765-2.toml"), &[PUNCTURE]),
            Test::En14477(_) => (include_str!("templates/en14477.toml"), &[PUNCTURE]),
            Test::Coupon(_) => (include_str!("templates/coupon.toml"), &[]),
            Test::Indent(_) => (include_str!("templates/indent.toml"), &[]),
            Test::Pressure(_) => (include_str!("templates/pressure.toml"), &[]),
            Test::Volume(_) => (include_str!("templates/volume.toml"), &[]),
        };
        Template { text: text.into(), scripts }
    }

    /// The command that gives the figure of the test whose scenario is at `path`.
    pub(super) fn next(&self, path: &Path) -> String {
        let scenario = shown_path(path);
        match self {
            Test::D1709A(_) | Test::D1709B(_) => {
                format!("droptower script failure-mass --scenario {scenario}   (the failure mass)")
            }
            Test::D7192(_) | Test::D5748(_) | Test::Iso7765(_) | Test::En14477(_) => {
                format!(
                    "droptower run {scenario}   (force, travel and energy of the puncture); droptower sweep {scenario}   (the same for \
                     both ends of what coupons do not tell)"
                )
            }
            Test::Drop(_) | Test::Coupon(_) | Test::Indent(_) | Test::Pressure(_) | Test::Volume(_) => {
                format!("droptower check {scenario}")
            }
        }
    }
}
