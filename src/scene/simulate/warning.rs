//! Findings of a run, with what `explain` says of each, and their bounds; `monitor.rs` reports them.

use std::fmt;

use serde::{Deserialize, Serialize};

use super::springs::SpringStep;
use crate::mesh::Quality;
use crate::model::{ImpactorShape, Model};
use base::{findings, number, words};
use membrane::engine::Relaxation;

/// The body that a warning is about.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum ImpactorName {
    /// The only impactor of a scene.
    Only,
    /// One of several.
    OfSeveral(String),
    /// The bars of the frame.
    Bars,
}

impl ImpactorName {
    /// The name of the impactor at this place among those of `model`.
    pub(super) fn of_impactor(model: &Model, place: usize) -> ImpactorName {
        let name = model.names().get(place).copied().flatten();
        name.map_or(ImpactorName::Only, |name| ImpactorName::OfSeveral(name.to_owned()))
    }

    /// Its name among the figures.
    fn figure(&self) -> Option<(&'static str, &str)> {
        match self {
            ImpactorName::Only => None,
            ImpactorName::OfSeveral(name) => Some(("impactor", name)),
            ImpactorName::Bars => Some(("body", "frame.bars")),
        }
    }

    /// As the owner of something.
    fn possessive(&self) -> String {
        match self {
            ImpactorName::Only => "the impactor's".to_owned(),
            ImpactorName::OfSeveral(name) => format!("the \"{name}\" impactor's"),
            ImpactorName::Bars => "the frame's bars'".to_owned(),
        }
    }

    /// In the possessive form of a pronoun.
    fn its(&self) -> &'static str {
        if *self == ImpactorName::Bars { "their" } else { "its" }
    }
}

impl fmt::Display for ImpactorName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            ImpactorName::Only => f.write_str("the impactor"),
            ImpactorName::OfSeveral(name) => write!(f, "the impactor \"{name}\""),
            ImpactorName::Bars => f.write_str("the frame's bars"),
        }
    }
}

words! {
    /// The length of a body with which elements and penetrations are compared.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
    pub enum BodySize {
        /// Of a body that is round, or of bars.
        Radius = "radius",
        /// Half the smallest extent of any other.
        HalfExtent = "half smallest extent",
    }
}

impl BodySize {
    /// The size of a body of this shape.
    pub(super) fn from_shape(shape: &ImpactorShape) -> BodySize {
        match shape {
            ImpactorShape::Sphere { .. } | ImpactorShape::Hemisphere { .. } | ImpactorShape::Capsule { .. } => {
                BodySize::Radius
            }
            ImpactorShape::Cylinder { .. }
            | ImpactorShape::Cone { .. }
            | ImpactorShape::Box { .. }
            | ImpactorShape::Mesh { .. }
            | ImpactorShape::Compound(_) => BodySize::HalfExtent,
        }
    }

    /// The figure `value` over this size: of its names, over a radius and over half an extent, the one that says so.
    fn figure(self, [over_radius, over_half_extent]: [&'static str; 2], value: f64) -> [(&'static str, f64); 1] {
        match self {
            BodySize::Radius => [(over_radius, value)],
            BodySize::HalfExtent => [(over_half_extent, value)],
        }
    }
}

findings! {
    /// Findings that put figures of a run in doubt. Faces are counted from one.
    #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
    pub enum Warning {
        MisshapenElements {
            face: usize, "the face" => "face";
            quality: Quality, "shape of its elements, the worst of them" => "scaled_jacobian" = quality.jacobian;
        } = "misshapen-elements", Warning;
            meaning "an element of the mesh has a small scaled Jacobian: it is far from a square or an equilateral \
                triangle, and its strains and its stable time step are poor";
            remedy "mesh the outline again with better shaped elements; `droptower check` names the worst of them";
            message "misshapen elements in face {face}: {quality}";
        AddedMass {
            face: usize, "the face" => "face";
            share: f64, "added mass over its own" => "added_mass_share";
        } = "added-mass", Warning;
            meaning "`solver.smallest_step` added more than 5 % to the mass of a face: waves in it and its inertia are \
                not those of the film";
            remedy "set a shorter `solver.smallest_step`, or leave it out";
            message "added mass: small elements of face {face} got {} % of its mass (bound {} %)",
                percent(share), percent(&bounds::ADDED_MASS);
        StepOfSprings(
            springs: SpringStep => "time_step_s" = springs.step, "time_step_without_springs_s" = springs.free
        ) = "step-of-springs", Note;
            meaning "springs of the frame make the stable time step a quarter of the film's or less, so that the run takes many times as \
                long; a larger element does not help";
            remedy "use a lower `frame.springs.stiffness`: that of all springs of a held node over its mass bounds the step";
            message "step of springs: `{}` makes the time step {} us, which without springs is {} us", SpringStep::KEY,
                number::figure(1e6 * springs.step, 2), number::figure(1e6 * springs.free, 2);
        Settled(
            relaxation: Relaxation
                => "mounted_residual" = relaxation.mounted, "residual" = relaxation.residual,
                "steps" = relaxation.steps, "displacement_m" = relaxation.displacement
        ) = "settled", Note;
            meaning "the film was not mounted in equilibrium with its pre-strain and its weight, and was brought to it \
                before the test, without impactor; strains and energies count from there";
            remedy "nothing; `settle = false` in `[layers]` or a `[[layer]]` starts from film as mounted";
            message "settled before the test: forces out of balance fell from {} to {} of the reactions in {} steps, in \
                which the film moved by up to {} mm",
                number::figure(relaxation.mounted, 2), number::figure(relaxation.residual, 2),
                number::grouped(relaxation.steps), number::figure(1e3 * relaxation.displacement, 3);
        NotInEquilibrium(
            relaxation: Relaxation
                => "mounted_residual" = relaxation.mounted, "residual" = relaxation.residual,
                "steps" = relaxation.steps, "displacement_m" = relaxation.displacement
        ) = "not-in-equilibrium", Warning;
            meaning "the film is out of balance with its pre-strain or its weight when the test starts, so that it \
                moves by itself; or it was not brought to the balance that is asked for (10⁻⁶ of the reactions) in 200 000 steps";
            remedy "leave out `settle = false`, where it is given; where the film has no equilibrium, such as slack film under its \
                weight, give it a pre-strain";
            message "not in equilibrium: at the start forces out of balance are {} of the reactions{}",
                number::figure(relaxation.residual, 2),
                match relaxation.steps {
                    0 => String::new(),
                    steps => format!(", after {} steps in which the film moved by up to {} mm", number::grouped(steps),
                        number::figure(1e3 * relaxation.displacement, 3)),
                };
        NoContact(impactor: ImpactorName => ..impactor.figure()) = "no-contact", Warning;
            meaning "the impactor passed the film, or did not reach it, without touching it: its signals are those of \
                a free fall";
            remedy "correct `impactor.position` or the outline of the film, or use a longer duration";
            message "no contact: {impactor} did not touch the film during the whole test";
        TornBeforeContact {
            impactor: ImpactorName, "which one" => ..impactor.figure();
            time: f64, "when film first broke, s" => "time_s";
        } = "torn-before-contact", Warning;
            meaning "the film broke before the impactor touched it, and the impactor passed without touching what is left: its \
                signals are those of a free fall";
            remedy "use a lower `layers.prestrain` or a shorter cut in `specimen.cuts`, or a higher limit in \
                `specimen.material.rupture`: the film breaks by what it is mounted with";
            message "torn before contact: the film broke at {}, and {impactor} did not touch it during the whole test",
                number::duration(*time);
        NoFilmContact(impactor: ImpactorName => ..impactor.figure()) = "no-film-contact", Note;
            meaning "the impactor met other impactors or the frame's bars, but never the film: its displacement counts \
                from its start, and it has no lowest point, no rebound and no energy absorption";
            remedy "nothing, where that is meant; otherwise correct `impactor.position` or use a longer duration";
            message "no contact with the film: {impactor} touched other bodies only";
        CoarseContact {
            impactor: ImpactorName, "which one" => ..impactor.figure();
            time: f64, "when the bound was exceeded first, s" => "time_s";
            edge: f64, "longest edge in contact over the size of the impactor"
                => ..size.figure(["edge_over_radius", "edge_over_half_extent"], *edge);
            size: BodySize, "what that size is";
        } = "coarse-contact" as COARSE_CONTACT, Warning;
            meaning "elements in contact are large compared with the impactor, so that the film takes its shape only \
                approximately";
            remedy "use a smaller `specimen.mesh.size`";
            message "coarse contact: from {} edges in contact are up to {} of {} {size} (bound {})",
                number::duration(*time), number::figure(*edge, 2), impactor.possessive(), bounds::EDGE;
        TooFast {
            impactor: ImpactorName, "which one" => ..impactor.figure();
            time: f64, "when it was fastest, s" => "time_s";
            travel: f64, "longest travel in one step over the size of the impactor"
                => ..size.figure(["travel_over_radius", "travel_over_half_extent"], *travel);
            size: BodySize, "what that size is";
        } = "too-fast", Warning;
            meaning "the impactor travels farther in one step than it is thick, so that it passes film without being \
                seen in contact with it, or for one step only";
            remedy "use a lower speed, or a smaller `solver.step_factor`; a film so soft or so heavy that waves in it are \
                much slower than the impactor has too long a step";
            message "too fast: at {} {impactor} travels {} of {} {size} in one step (bound {})",
                number::duration(*time), number::figure(*travel, 2), impactor.its(), bounds::TRAVEL;
        Penetration {
            impactor: ImpactorName, "which one" => ..impactor.figure();
            time: f64, "when the bound was exceeded first, s" => "time_s";
            depth: f64, "largest penetration over the size of the impactor"
                => ..size.figure(["penetration_over_radius", "penetration_over_half_extent"], *depth);
            size: BodySize, "what that size is";
        } = "penetration", Warning;
            meaning "elements penetrate the impactor between nodes in contact";
            remedy "use a smaller `specimen.mesh.size`";
            message "penetration: from {} elements penetrate {impactor} by up to {} % of {} {size} (bound {} %)",
                number::duration(*time), percent(depth), impactor.its(), percent(&bounds::PENETRATION);
        FrameHit {
            impactor: ImpactorName, "which one" => ..impactor.figure();
            time: f64, "when it did first, s" => "time_s";
            has_bars: bool, "whether the frame has bars, which it met" => "bars";
        } = "frame-hit" as FRAME_HIT, Warning;
            meaning "the impactor hit the frame: with `frame.bars` it meets them with its own restitution, rigidly, so \
                that peaks from then on are those of a rigid frame; without them the frame is not modelled, so that \
                the motion from then on is not that of a test";
            remedy "shorten the test, use a stiffer film or a lower impact energy, or model the frame with \
                `frame.bars`";
            message "{impactor} {} at {}{}",
                if *has_bars { "hit the bars of the frame" } else { "reached the clamped edge" },
                number::duration(*time),
                if *has_bars { "" } else { ": the frame itself is not modelled" };
        ClampSlip {
            time: f64, "when it was seen first, s" => "time_s";
            slip: f64, "largest slip, m" => "slip_m";
        } = "clamp-slip", Warning;
            meaning "film slipped in the frame's clamp: its pull exceeded the force of friction there; its edge stays \
                at its height, or on its bar, wherever it slips to, so that the run holds for a slip that is small \
                against the opening and the arc on the bar";
            remedy "use a larger `frame.clamp.force`, or `frame.clamp.width`, after which film is free";
            message "clamp slip: from {} film slips in its clamp, by up to {} mm",
                number::duration(*time), number::figure(1e3 * slip, 3);
        ClampLeft {
            time: f64, "when it was seen first, s" => "time_s";
            share: f64, "share of the held length" => "share";
        } = "clamp-left", Warning;
            meaning "film slipped out of the frame's clamp by more than `frame.clamp.width`: there nothing holds it \
                any more";
            remedy "use a larger `frame.clamp.force`, or a stiffer film or a lower impact energy";
            message "film left its clamp: from {} on, in the end along {} % of the held length",
                number::duration(*time), percent(share);
        SpringsSlack {
            time: f64, "when it was seen first, s" => "time_s";
            share: f64, "largest share of the springs that were" => "share";
        } = "springs-slack", Note;
            meaning "springs on which the film hangs went slack: shorter than without force they do not push, and a real one may \
                unhook";
            remedy "nothing, where that is meant; otherwise use a larger `frame.springs.preload`";
            message "slack springs: from {} springs of the frame are slack, up to {} % of them",
                number::duration(*time), percent(share);
        StrainLocalisation {
            time: f64, "when it was found first, s" => "time_s";
            strain: f64, "largest engineering strain of the element" => "strain";
            face: usize, "its face" => "face";
        } = "strain-localisation", Warning;
            meaning "one element is strained much more than its neighbours; with a softening law or a coarse mesh the \
                result from then on depends on the mesh";
            remedy "compare with a finer `specimen.mesh.size` and do not use figures from after that time";
            message "strain localisation: at {} one element of face {face} is strained to {}, over {} times its \
                neighbours; the result depends on the mesh from there on",
                number::duration(*time), number::figure(*strain, 2), number::figure(bounds::LOCALISATION, 2);
        UncoupledBiaxial {
            time: f64, "when the share was largest, s" => "time_s";
            share: f64, "share of the face under biaxial load" => "share";
            face: usize, "its face" => "face";
            coupling: f64, "its `biaxial`" => "biaxial";
        } = "uncoupled-biaxial", Warning;
            meaning "the directions of the fabric know nothing or little of each other's strain (`biaxial` below 0.5, the \
                coupling of isotropic film with Poisson's ratio 1/3; 0.79 with 0.44, 1 with 0.5), but are strained at once over a \
                part of the film, and nothing says where the coupling comes from: real film is stiffer there, as much as \
                isotropic film or less, which uniaxial coupons do not tell; in a drop on near-isotropic film without coupling the \
                peak is a quarter low and the travel a quarter long";
            remedy "run once more with `--set specimen.material.fabric.biaxial=0.79`, the coupling of isotropic film with \
                Poisson's ratio 0.44, and compare both with `droptower compare`; the film lies between. A bulge test or a \
                wide coupon tells the coupling: give it with its test as `specimen.material.fabric.biaxial_source`, after which \
                this is not reported, also of a fabric that has none";
            message "uncoupled biaxial load: at {} {} % of face {face} is stretched in both directions, which `biaxial = {}` {}",
                number::duration(*time), percent(share), number::significant(*coupling, 3),
                if *coupling > 0.0 { "couples less than isotropic film (0.5 to 1)" } else { "does not couple" };
        ThinningBeforeBreak {
            face: usize, "its face" => "face";
            strain: f64, "largest equivalent plastic strain" => "plastic_strain";
            from: f64, "strain from which it thins by itself" => "thins_from";
        } = "thinning-before-break", Warning;
            meaning "plastic film that can tear was strained beyond the strain from which its flow stress rises too slowly to \
                spread strain: it thins in a row of elements before it reaches its limit. A fracture energy does not \
                regularise what precedes it, so that strain, travel and energy up to the break fall with the element \
                size: of one film under a dart the energy by 9 to 22 % for a millimetre less (docs/limits.md)";
            remedy "compare two sizes of `specimen.mesh.size`, and give no figure at the break without its size; a limit that \
                is found on elements of a size by a coupon holds for that size alone";
            message "thinning before the break: face {face} was strained plastically to {}, but thins by itself from {} on; \
                figures at its break depend on the element size",
                number::figure(*strain, 2), number::figure(*from, 2);
        ElementsTooWide {
            width: f64, "its width across the tear, m" => "width_m";
            ratio: f64, "what it stored over what its tear takes" => "stored_over_fracture_energy";
        } = "elements-too-wide", Warning;
            meaning "an element that reached its limit, or came to the tip of a tear, stored more energy than its tear takes: \
                the rest was lost with it, so that where and when film tears depends on the mesh";
            remedy "use a smaller `specimen.mesh.size`, or a lower limit: an element stores at its limit less than \
                `specimen.material.rupture.energy` over its width";
            message "elements too wide for the fracture energy: one of {} mm stored {} times what its tear takes; the \
                widest that fits is {} mm",
                number::significant(1e3 * width, 3), number::significant(*ratio, 3),
                number::significant(1e3 * width / ratio, 2);
        TearByLimit {
            share: f64, "share of the work that film at the first such tip would return" => "returned";
        } = "tear-by-limit", Warning;
            meaning "film around the tip of a tear or cut would return so little of the work done on it that this is less than \
                the tear takes, where all of the work would be more: not the fracture energy, but the limit decides when \
                the tear goes on, and with it the element size";
            remedy "give no force or travel at which film that absorbs or yields tears without its `specimen.mesh.size`; \
                `specimen.material.rupture.limit` found on a sheet with a cut holds for elements of that size alone";
            message "tear by its limit: at a tip film would return {} % of the work done on it, less than its tear takes, so \
                that the limit decides there, which depends on the element size",
                percent(share);
        FilmCrossing {
            time: f64, "when it did first, s" => "time_s";
            depth: f64, "largest depth, m" => "depth_m";
        } = "film-crossing", Warning;
            meaning "a face of film passed through another, or through itself, which film does not";
            remedy "use a smaller `specimen.mesh.size` or `solver.step_factor`, and do not use what follows";
            message "film crossing: from {} film passes through film by up to {} mm",
                number::duration(*time), number::figure(1e3 * depth, 2);
        FilmBehindMirror {
            time: f64, "when it first was, s" => "time_s";
            depth: f64, "largest depth, m" => "depth_m";
        } = "film-behind-mirror", Warning;
            meaning "film with `contact.film` or `contact.itself` lies behind a mirror plane, farther than it is thick: it passed \
                through its own image, which it does not meet";
            remedy "compute it as a whole: `specimen.symmetry = \"none\"`";
            message "film behind a mirror plane: from {} film lies up to {} mm behind one, through its own image",
                number::duration(*time), number::figure(1e3 * depth, 2);
        FilmContactLost {
            time: f64, "when it was first, s" => "time_s";
            times: u64, "how often" => "times";
        } = "film-contact-lost", Note;
            meaning "contact of film with film was given up at a node or at two edges and found again later: where film \
                folds sharply or leaves the outline of another face, its side is no longer known";
            remedy "look at these places in the recording; a smaller `specimen.mesh.size` resolves folds";
            message "film contact lost: from {} contact of film with film was given up {times} times at a node or at \
                two edges",
                number::duration(*time);
        FilmContactUnresolved {
            steps: u64, "in how many" => "steps";
            of: u64, "all steps" => "of";
        } = "film-contact-unresolved", Note;
            meaning "the impulses of film on film did not converge in many steps, so that it comes closer there than \
                its thickness";
            remedy "look at `film_distance_m`; a larger `specimen.mesh.size` or fewer faces on each other converge \
                sooner";
            message "film contact unresolved: the impulses of film on film did not converge in {steps} of {of} steps";
        Unfinished(impactor: ImpactorName => ..impactor.figure()) = "unfinished", Warning;
            meaning "the run ends while the impactor is still in contact, so that its rebound is not final and its energy \
                absorption not known";
            remedy "use a longer `loading.impact.duration`";
            message "the run ends while {impactor} is still in contact: its rebound is not final, its energy absorption not known";
        FewerSnapshots {
            wanted: usize, "requested" => "wanted";
            taken: usize, "taken" => "taken";
            memory: f64, "memory that all snapshots may take, bytes";
        } = "fewer-snapshots", Warning;
            meaning "the recording has fewer snapshots than `output.frames`, because more of so fine a mesh would take \
                too much memory; signals and figures are not affected";
            remedy "use a lower `output.frames` or a larger `specimen.mesh.size`";
            message "the recording has {taken} snapshots instead of {wanted}: more of so fine a mesh would take more \
                than {} GB",
                number::figure(1e-9 * memory, 2);
        EnergyBalance {
            error: f64, "largest error over the energy exchanged" => "energy_balance_error";
        } = "energy-balance", Warning;
            meaning "the sum of all energies changed by more than 1 % of the energy exchanged; above 10 % the run \
                stops";
            remedy "use a smaller `solver.step_factor` or a finer mesh";
            message "energy balance error {} % of the energy exchanged", percent(error);
        StrainRateOutside { share: f64, "share of the strain increments" => "share" } = "strain-rate-outside", Warning;
            meaning "more than 5 % of the film's strain increments lie outside the strain rates at which its curves \
                were measured";
            remedy "use curves that were measured at the rates of the test (`strain_rates` in the summary)";
            message "strain rate: {} % of the strain increments lie outside the rates at which the curves were \
                measured",
                percent(share);
        BreakStrainOfCoupons {
            broke: bool, "whether film broke" => "broke";
            share: f64, "largest strain of the film over the least break strain of its direction" => "share";
        } = "break-strain-of-coupons" as BREAK_STRAIN_OF_COUPONS, Note;
            meaning "in a drop, film broke or came near the last strain of its curves, which coupons have at the rate of a tensile \
                machine and under tension in one direction; of two LDPE films, whose darts' failure masses were measured, that strain \
                would have to be a fifth to three fifths of the coupons', as the dart's friction is (docs/scenarios.md)";
            remedy "take from it whether film holds only where darts or drops were compared; `calibrate` finds the break strain \
                (`specimen.material.fabric.md.break_factor`) from drops that held or broke and from failure masses";
            message "the film {} its coupons' break strain; two films that were measured under darts broke at 20 to 60 % of theirs",
                if *broke { "broke at".into() } else { format!("came to {} % of", percent(share)) };
        ShearExceeded {
            face: usize, "number of the face, from one" => "face";
            angle: f64, "largest shear angle, rad" => "shear_angle_rad";
            end: f64, "shear angle at the end of the curve, rad" => "curve_end_rad";
        } = "shear-exceeded", Warning;
            meaning "film that is not broken sheared beyond the last point of its shear curve, from which on the curve goes on with its \
                last slope: there stress is a guess";
            remedy "measure the shear curve up to the angle of the test (`specimen.material.fabric.shear`); where coupons at 45° \
                cannot give it, use another law";
            message "face {face} sheared by up to {} rad, its shear curve ends at {}",
                number::significant(*angle, 3), number::significant(*end, 3);
        HardeningExceeded {
            face: usize, "number of the face, from one" => "face";
            strain: f64, "largest equivalent plastic strain" => "plastic_strain";
            end: f64, "equivalent plastic strain at the end of the curve" => "curve_end";
        } = "hardening-exceeded", Warning;
            meaning "plastic film flowed beyond the last point of its flow curve, from which on the flow stress is \
                taken as constant";
            remedy "measure the hardening up to the plastic strain of the test \
                (`specimen.material.plastic.hardening.curve`), or give Voce's law";
            message "face {face} reached the equivalent plastic strain {}, its flow curve ends at {}",
                number::significant(*strain, 3), number::significant(*end, 3);
        ThicknessLost {
            face: usize, "number of the face, from one" => "face";
        } = "thickness-lost", Warning;
            meaning "film was strained so far that its law gives no thickness: of linear elastic film 1 + 2E₃₃ is below zero. Its \
                thickness is left out there, and the largest loss of thickness is that of other elements";
            remedy "give a hyperelastic law (`specimen.material.hyperelastic`), which holds at large strains";
            message "face {face} is strained beyond where its law gives a thickness";
        HeatTwice {
            face: usize, "its face" => "face";
            rate: f64, "highest rate of its curves, 1/s" => "rate_per_s";
        } = "heat-twice", Warning;
            meaning "film warms up by what it absorbs (`thermal`), but the fastest coupons of its curves broke before their heat left \
                them: such curves hold a part of it already (under tension in one direction a half of that under a dart, or less), and \
                softening counts twice";
            remedy "give `specimen.material.thermal` to the curves of slow coupons alone, and name their rates in `measured_rates`";
            message "heat counts twice: curves of face {face} were measured up to {} 1/s, too fast for heat to leave", number::significant(*rate, 3);
        HeatLeaves {
            face: usize, "its face" => "face";
            time: f64, "of the test, s" => "time_s";
            cooling: f64, "in which two thirds of its heat leave film in still air, s" => "cooling_s";
        } = "heat-leaves", Warning;
            meaning "film warms up by what it absorbs (`thermal`), as if no heat left it, but the test takes so long that air takes a \
                part of it: what leaves through both sides of the face at 10 W/(m² K), assumed for still air and radiation; metal \
                takes more";
            remedy "leave `specimen.material.thermal` out of slow tests, whose film keeps the temperature of the room";
            message "heat leaves: the test takes {}, face {face} gives two thirds of its heat to still air in {}",
                number::duration(*time), number::duration(*cooling);
        NotQuasiStatic {
            share: f64, "largest share of kinetic energy in the energy that the film took up" => "kinetic_share";
        } = "not-quasi-static", Warning;
            meaning "the kinetic energy of the film exceeds 1 % of the energy that it took up: inertia affects the \
                force";
            remedy "load more slowly or set a lower `mass_scaling`";
            message "not quasi-static: kinetic energy is up to {} % of the energy that the film took up",
                percent(share);
        BarelyQuasiStatic {
            share: f64, "largest share of kinetic energy in the energy that the film took up" => "kinetic_share";
        } = "barely-quasi-static", Warning;
            meaning "the kinetic energy of the film exceeds 0.2 % of the energy that it took up; the bound is 1 %";
            remedy "load more slowly or set a lower `mass_scaling` where accuracy matters";
            message "barely quasi-static: kinetic energy is up to {} % of the energy that the film took up (bound {} \
                %)",
                percent(share), percent(&bounds::KINETIC);
    }
}

fn percent(share: &f64) -> String {
    number::significant(100.0 * share, 2)
}

/// Bounds above which a run has a warning.
pub(super) mod bounds {
    /// Scaled Jacobian of an element, a lower bound.
    pub(in crate::simulate) const JACOBIAN: f64 = 0.3;
    /// Added mass over that of a face.
    pub(in crate::simulate) const ADDED_MASS: f64 = 0.05;
    /// Edge of an element in contact over the size of the impactor.
    pub(in crate::simulate) const EDGE: f64 = 0.25;
    /// Penetration over the size of the impactor.
    pub(in crate::simulate) const PENETRATION: f64 = 0.01;
    /// Travel of an impactor in one step over its size.
    pub(in crate::simulate) const TRAVEL: f64 = 1.0;
    /// Strain of one element over the mean of its neighbours.
    pub(in crate::simulate) const LOCALISATION: f64 = 2.0;

    /// Share of the steps in which the impulses between faces may not converge.
    pub(in crate::simulate) const UNRESOLVED: f64 = 0.01;
    /// Strain below which localisation is not looked for.
    pub(in crate::simulate) const LOCALISED_STRAIN: f64 = 0.5;
    /// Strain of film in a drop over the break strain of its coupons: the least at which measured films broke under darts.
    pub(in crate::simulate) const OF_BREAK: f64 = 0.2;
    /// Share of a face under biaxial load.
    pub(in crate::simulate) const BIAXIAL: f64 = 0.05;
    /// Biaxial coupling of a fabric, a lower bound: ν/(1 − ν) of isotropic film with ν = 1/3, which few polymers are below;
    /// film of polyethylene and polypropylene has 0.67 to 0.85 (ν of 0.40 to 0.46).
    pub(in crate::simulate) const COUPLING: f64 = 0.5;
    /// Duration of a test over the time in which film that warms up gives its heat to the air.
    pub(in crate::simulate) const COOLING: f64 = 0.3;
    /// Error of the energy balance.
    pub(in crate::simulate) const BALANCE: f64 = 0.01;
    /// Share of the strain increments outside the measured rates.
    pub(in crate::simulate) const RATES: f64 = 0.05;
    /// Kinetic share of a quasi-static test.
    pub(in crate::simulate) const KINETIC: f64 = 0.01;
    /// Kinetic share of a test that is barely quasi-static.
    pub(in crate::simulate) const BARELY: f64 = 0.2 * KINETIC;
}

#[cfg(test)]
mod tests {
    use super::*;
    use base::finding::Finding;

    #[test]
    fn figures_of_contact_are_named_for_the_size_that_the_message_names() {
        for (size, in_words, in_name) in
            [(BodySize::Radius, "radius", "radius"), (BodySize::HalfExtent, "half smallest extent", "half_extent")]
        {
            let impactor = || ImpactorName::Only;
            let coarse = Finding::new(&Warning::CoarseContact { impactor: impactor(), time: 0.01, edge: 0.4, size });
            assert!(coarse.message.contains(&format!("0.40 of the impactor's {in_words}")), "{}", coarse.message);
            assert_eq!(coarse.figures[&format!("edge_over_{in_name}")], 0.4);
            let deep = Finding::new(&Warning::Penetration { impactor: impactor(), time: 0.01, depth: 0.02, size });
            assert!(deep.message.contains(&format!("by up to 2 % of its {in_words}")), "{}", deep.message);
            assert_eq!(deep.figures[&format!("penetration_over_{in_name}")], 0.02);
            assert_eq!([coarse.figures.len(), deep.figures.len()], [2; 2]);
        }
    }
}
