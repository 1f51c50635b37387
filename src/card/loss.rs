//! What a card does not say of the film: findings that stand in its head and on the terminal.

use super::film::Sampled;
use base::findings;
use base::number::significant;
use membrane::material::Elastic;

findings! {
    /// Something that the film has and the card does not, or has otherwise.
    #[derive(Clone, Debug, PartialEq)]
    pub enum Loss {
        BiaxialCoupling = "card-biaxial-coupling", Warning;
            meaning "the biaxial coupling of MD and TD has no place in the card";
            remedy "identify the film without `biaxial` for that solver, or compare both under biaxial load";
            message "lost: biaxial coupling of MD and TD";
        FromMemory {
            what: &'static str, "of the card" => "what";
        } = "card-from-memory", Warning;
            meaning "a part of the card follows what is remembered of the solver's manual, not the manual";
            remedy "compare it with the manual before the card is used";
            message "from memory: {what}";
        Wrinkling = "card-wrinkling", Note;
            meaning "film carries no compression here; in the other solver that is a matter of its element or an option";
            remedy "use a membrane without compression there, and compare a case with wrinkles";
            message "lost: the film carries no compression in any direction (tension field)";
        Rates {
            kept: f64, "rate of the curves that were written, 1/s" => "rate_per_s";
        } = "card-rates", Warning;
            meaning "the card holds the curves of one strain rate, the film those of several";
            remedy "name the rate of the load with `--rate`, and write a card for each";
            message "lost: strain rates but {} 1/s", significant(*kept, 6);
        LayerBreaks = "card-layer-breaks", Warning;
            meaning "the layers of the film break one after another, those of the card at once or never";
            remedy "model the layers one by one there";
            message "lost: layers break one after another";
        Absorption {
            share: f64, "share of the stored energy that is lost" => "absorption";
        } = "card-absorption", Warning;
            meaning "the film absorbs energy on unloading, the material of the card does not, or only on one path";
            remedy "compare the rebound, or use a target with unloading curves";
            message "lost: {} % of the stored energy are absorbed on unloading", significant(100.0 * share, 4);
        UnloadingFrom {
            md: f64, "strain from which unloading along MD is exact" => "strain_md";
            td: f64, "the same along TD" => "strain_td";
        } = "card-unloading-from", Note;
            meaning "the unloading curves of the card are those from one strain; from another one the film follows others";
            remedy "write the card for the strain that the film reaches, with `--unloading-from`";
            message "unloading curves are those from the strains {} (MD) and {} (TD)", significant(*md, 4), significant(*td, 4);
        Hysteresis {
            share: f64, "share of the stored energy that is lost" => "absorption";
        } = "card-hysteresis", Note;
            meaning "the parameter of hysteresis is the share of the stored energy that is lost; that its path is that of \
                droptower is from memory";
            remedy "compare one cycle of loading and unloading";
            message "H is the share {} of the stored energy that is lost; the path between is the solver's own", significant(*share, 4);
        Hill = "card-hill", Warning;
            meaning "the yield function of the film is Hill's, that of the card von Mises'";
            remedy "use a target with Hill's function, or accept the MD direction in all";
            message "lost: yield and flow differ along MD and TD (Hill); those along MD are written for all directions";
        BreakStrain {
            md: f64, "strain at which MD fibres break" => "strain_md";
            td: f64, "the same along TD" => "strain_td";
        } = "card-break-strain", Warning;
            meaning "fibres break at the ends of their curves, the material of the card goes on with the last slope";
            remedy "add a failure criterion of the solver at these strains";
            message "lost: fibres break at the strains {} (MD) and {} (TD)", significant(*md, 6), significant(*td, 6);
        Rupture = "card-rupture", Warning;
            meaning "the rupture criterion of the film has no place in the card";
            remedy "add a failure criterion of the solver";
            message "lost: rupture by a criterion of its own";
        Heating = "card-heating", Warning;
            meaning "the film warms up by what it absorbs and softens, the material of the card keeps its temperature";
            remedy "couple it with temperature there, or write curves measured at the rates of the load, which have the heat in them";
            message "lost: softening by the heat of what the film absorbs";
        Viscosity = "card-viscosity", Warning;
            meaning "the film relaxes by a Prony series, the material of the card does not";
            remedy "use a target with Prony terms for this law, or write a law identified at the rate of the load";
            message "lost: relaxation by a Prony series; the stress is that of the law as written";
        LinearViscosity = "card-linear-viscosity", Note;
            meaning "moduli of a Prony series are those of small strain: the solver's overstress is linear in the strain, that of \
                droptower a share of the law's stress";
            remedy "compare one relaxation at the strain of the load";
            message "Prony moduli are of small strain, G_i = g_i G";
        ShellRelaxation = "card-shell-relaxation", Warning;
            meaning "shells of LAW42 take G_i times the deviator of each increment of strain as overstress: without the factor of two, \
                and without the pressure that keeps the volume (sigeps42c.F of August 2026). One element in it had 34, 14, 2 and 50 % \
                at a strain of 2 %";
            remedy "write a law identified at the rate of the load for that solver, without a Prony series";
            message "film whose modulus halves by relaxation has 33 % of its overstress there in uniaxial tension, 12 % with the width \
                held, none with both directions stretched, 50 % in shear";
        Compressible {
            poisson: f64, "Poisson's ratio that was written" => "poisson";
        } = "card-compressible", Note;
            meaning "the film is incompressible; elements of the other solver need a bulk modulus, which plane stress does not";
            remedy "another one: `--poisson`";
            message "the film is incompressible; a bulk modulus for ν = {} is written", significant(*poisson, 6);
        StrainMeasure {
            law: &'static str, "of the card" => "law";
            small: f64, "difference of the uniaxial nominal stress at a strain of 1 %" => "at_1_percent";
            large: f64, "the same at 10 %" => "at_10_percent";
        } = "card-strain-measure", Note;
            meaning "the law of the card is linear in logarithmic strain, St. Venant-Kirchhoff's in Green's strain";
            remedy "compare at the largest strain";
            message "the law of the film is linear in Green's strain, that of the card ({law}) in logarithmic strain: {} % of the \
                stress at 1 % strain, {} % at 10 %", significant(100.0 * small, 2), significant(100.0 * large, 2);
        ScaledUnloading = "card-scaled-unloading", Warning;
            meaning "the solver scales the whole unloading curve to the strain from which film unloads, and reloads along the scaled \
                loading curve; droptower moves that curve. Film that reaches less than the strain of the card gives back more: after \
                the lowest point of test 1008 the impactor flies off with 1.72 m/s instead of 1.42";
            remedy "`--unloading-from` with the strain that film reaches, and a look at the signals: the solver ends a run normally \
                whose motion is no number";
            message "unloading is scaled from the strain of the card to that of the film, and reloading too: compare until the \
                lowest point only";
        ShearOfPresentArea = "card-shear-area", Note;
            meaning "shear stress of the card is over the present area, that of the film over the stress-free one";
            remedy "nothing up to a shear of 0.2; compare film that shears more";
            message "shear stress is over the present area: +2 % at a shear of 0.2, +12 % at 0.8";
        StressOfVolume {
            uniaxial: f64, "difference of the stress at the end of the flow curve, one direction stretched" => "uniaxial";
        } = "card-stress-of-volume", Note;
            meaning "flow stress of the card is Cauchy stress, that of the film is over the stress-free volume, which elastic strain \
                changes: by 1 - 2 nu times the sum of stresses over the modulus";
            remedy "nothing; both agree where the yield stress is small beside the modulus";
            message "flow stress is over the present volume: +{} % of the stress at the end of its curve, twice as much with both \
                directions stretched", significant(100.0 * uniaxial, 2);
        Sampled {
            points: usize, "of the longest curve" => "points";
            error: f64, "largest difference over the largest stress" => "error";
        } = "card-sampled", Note;
            meaning "a curve has more points than the card may have, or none, and is written by straight pieces";
            remedy "more points: `--points`";
            message "curves of at most {points} points: off by at most {} % of the largest stress", significant(100.0 * error, 2);
    }
}

impl Loss {
    /// The finding of flow stress (Pa) over the present volume.
    pub(crate) fn stress_of_volume(elastic: &Elastic, flow: &[(Option<f64>, Sampled)]) -> Loss {
        let last =
            flow.iter().filter_map(|(_, curve)| curve.points.last()).map(|[_, stress]| *stress).fold(0.0, f64::max);
        Loss::StressOfVolume { uniaxial: (1.0 - 2.0 * elastic.poisson) * last / elastic.young }
    }

    /// The finding of a law that is linear in logarithmic strain: of uniaxial nominal stress E ln λ λ⁻ᵛⁿ, of n sides that grow
    /// narrow, for St. Venant-Kirchhoff's E λ (λ² − 1)/2.
    pub(crate) fn strain_measure(law: &'static str, elastic: &Elastic, sides: f64) -> Loss {
        let difference = |stretch: f64| {
            let card = stretch.ln() * stretch.powf(-sides * elastic.poisson);
            card / (0.5 * stretch * (stretch * stretch - 1.0)) - 1.0
        };
        Loss::StrainMeasure { law, small: difference(1.01), large: difference(1.1) }
    }
}
