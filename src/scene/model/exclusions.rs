//! What excludes what: tables of keys and of what they are refused beside, which one loop checks and `explain` prints.

use super::loading::{Impactors, Inertia};
use super::{Checker, Hold, Loading, Symmetry};
use crate::mesh::Side;
use crate::scenario::{self, BodyShape, Guide, ImpactorShape, MountingCurve, Scenario};

/// A key that is refused beside something else.
pub(super) struct Exclusion<F> {
    /// Paths of such keys below the table that is checked; `*` stands for each place of a list.
    keys: &'static [&'static str],
    /// What they are refused beside, in words.
    beside: &'static str,
    /// Whether that is so in a scenario.
    when: fn(&F) -> bool,
    /// The fact; left out where the key "is not allowed here".
    message: Option<&'static str>,
    /// The remedy, or why it is not allowed. `{}` stands for the path of the table.
    hint: &'static str,
    /// Path of another key, and what is there.
    label: Option<[&'static str; 2]>,
}

impl<F> Exclusion<F> {
    /// Reports the `key` of the table at `path`.
    fn report(&self, key: &str, path: &str, checker: &mut Checker<'_>) {
        let hint = self.hint.replace("{}", path);
        match self.message {
            Some(message) => checker.report_with(key, message, hint),
            None => checker.out_of_place(key, hint),
        }
        if let Some([other, text]) = self.label {
            checker.label(&other.replace("{}", path), text);
        }
    }
}

/// Keys that are refused beside something: the path without places of lists, and beside what.
pub fn exclusions() -> Vec<(String, &'static str)> {
    fn rows<F>(path: &str, table: &[Exclusion<F>]) -> Vec<(String, &'static str)> {
        let keys = |row: &Exclusion<F>| row.keys.iter().map(|key| format!("{path}{key}").replace(".*", ""));
        table.iter().flat_map(|row| keys(row).map(|key| (key, row.beside))).collect()
    }
    [rows("", &scene()), rows("impactor.", &impactor()), rows("specimen.material.", &material())].concat()
}

/// The parts of a scenario on which it depends what the others may be.
#[derive(Clone, Copy)]
pub(super) struct Scene<'a> {
    pub scenario: &'a Scenario,
    pub loading: &'a Loading,
    pub hold: &'a Hold,
    /// Whether its outline has holes.
    pub has_holes: bool,
    /// Whether it gives the vent of its air.
    pub has_vent: bool,
}

impl Scene<'_> {
    fn is_stretch(&self) -> bool {
        matches!(self.loading, Loading::Stretch(_))
    }

    fn is_impact(&self) -> bool {
        self.loading.impact().is_some()
    }

    pub(super) fn is_by_gas(&self) -> bool {
        self.loading.is_by_gas()
    }

    fn has_cushion(&self) -> bool {
        self.scenario.air.as_ref().is_some_and(|air| air.cushion.is_some())
    }

    /// Whether there is gas under the film or between its faces.
    fn encloses_gas(&self) -> bool {
        self.is_by_gas() || (self.is_impact() && self.has_cushion())
    }

    /// Whether gas presses faces on each other.
    pub(super) fn gas_joins_faces(&self) -> bool {
        self.scenario.faces() > 1 && self.is_by_gas() && self.loading.refuses_faces().is_none()
    }

    /// Whether impactors or gas press faces on each other.
    pub(super) fn faces_meet(&self) -> bool {
        (self.scenario.faces() > 1 && !self.scenario.impactor.is_empty()) || self.gas_joins_faces()
    }

    /// Whether an impactor or gas folds film.
    pub(super) fn film_folds(&self) -> bool {
        !self.scenario.impactor.is_empty() || self.is_by_gas()
    }

    fn has_no_signals(&self) -> bool {
        self.scenario
            .reference
            .as_ref()
            .is_some_and(|reference| reference.signals.is_none() && reference.field.is_some())
    }

    /// Whether two opposite sides are held.
    fn is_spanned(&self) -> bool {
        let both = |a, b| self.hold.holds(a) && self.hold.holds(b);
        both(Side::XMinus, Side::XPlus) || both(Side::YMinus, Side::YPlus)
    }

    fn is_held_by_jaws(&self) -> bool {
        matches!(self.hold, Hold::Sides(sides) if sides.len() == 2)
            && [Side::XMinus, Side::XPlus].iter().all(|side| self.hold.holds(*side))
    }
}

/// The parts of a scenario that the exclusions of an impactor ask for.
pub(super) struct Body<'a> {
    pub body: &'a scenario::Impactor,
    pub loading: &'a Loading,
    pub symmetry: Symmetry,
    /// Whether there is nothing rigid besides, no other impactor and no bars.
    pub is_alone: bool,
}

impl Body<'_> {
    fn is_pressed(&self) -> bool {
        self.loading.impactors() == Impactors::Prescribed
    }

    fn is_mirrored(&self) -> bool {
        self.symmetry != Symmetry::None
    }

    fn rotates(&self) -> bool {
        matches!(self.body.guide, Guide::Free | Guide::Hinge(_))
    }

    fn is_off_centre(&self) -> bool {
        self.symmetry.mirrors().iter().zip(&self.body.position).any(|(mirror, offset)| *mirror && offset.0 != 0.0)
    }
}

/// Writes rows of exclusions: keys, what they are refused beside, when; then the message where the key is not merely "not
/// allowed here", the hint, and a label at another key.
macro_rules! exclusions {
    ($($(#[$doc:meta])* fn $table:ident $(<$life:lifetime>)? of $facts:ty: $(
        $($key:literal),+ beside $beside:literal when $when:expr => $($message:literal;)? hint $hint:literal
        $(; at $other:literal $label:literal)?.
    )+)+) => {
        $($(#[$doc])* pub(super) fn $table $(<$life>)?() -> Vec<Exclusion<$facts>> {
            vec![$(Exclusion {
            keys: &[$($key),+],
            beside: $beside,
            when: $when,
            message: exclusions!(@option $($message)?),
            hint: $hint,
            label: exclusions!(@option $([$other, $label])?),
        }),+]
        })+
    };
    (@option) => { None };
    (@option $value:expr) => { Some($value) };
}

exclusions! {
    /// Exclusions among the tables of a scenario.
    fn scene<'a> of Scene<'a>:
        "frame.hold" beside "gas, unless \"all\"" when |s| s.is_by_gas() && *s.hold != Hold::All
            => "pressure escapes past an edge that is not held"; hint "leave the key out, or hold \"all\"".
        "frame.hold" beside "`loading.stretch`" when |s| s.is_stretch() && !s.is_held_by_jaws()
            => "the jaws of a stretch test hold the sides x- and x+"; hint "leave the key out".
        "frame.hold" beside "`loading.indent`, unless opposite sides"
            when |s| matches!(s.loading, Loading::Indent(_)) && !s.is_spanned()
            => "the film is not held on both sides of the impactor"; hint "hold \"all\", or at least two opposite sides".
        "frame.bars" beside "gas" when Scene::is_by_gas
            => "bars under film with pressure are not supported"; hint "leave them out: pressure lifts film off the bars below it".
        "frame.bars" beside "`loading.stretch`" when Scene::is_stretch
            => hint "jaws hold the film of a stretch test, which stays plane".
        "frame.bars" beside "`frame.hold = \"none\"`" when |s| *s.hold == Hold::None
            => hint "bars lie where film is held, and no edge is".
        "frame.clamp" beside "gas" when Scene::is_by_gas
            => "film that slips in its clamp under pressure is not supported";
            hint "leave it out; the edge of film under pressure is held without slip".
        "frame.clamp" beside "`loading.stretch`" when Scene::is_stretch
            => "film that slips in jaws is not supported"; hint "leave it out; the jaws of a stretch test hold without slip".
        "frame.clamp" beside "`frame.hold = \"none\"`" when |s| *s.hold == Hold::None => hint "no edge is held".
        "frame.clamp" beside "`air.cushion`" when Scene::has_cushion
            => "air between faces that slip in their clamp is not supported"; hint "leave the clamp or `air.cushion` out";
            at "air.cushion" "the air between the faces".
        "frame.springs" beside "gas" when Scene::is_by_gas
            => "film on springs under pressure is not supported"; hint "leave them out; the edge of film under pressure is fixed".
        "frame.springs" beside "`loading.stretch`" when Scene::is_stretch
            => "springs between film and jaws are not supported";
            hint "leave them out; the jaws of a stretch test hold the film itself".
        "frame.springs" beside "`frame.hold = \"none\"`" when |s| *s.hold == Hold::None => hint "no edge is held".
        "frame.springs" beside "`frame.bars`" when |s| s.scenario.frame.bars.is_some()
            => "bars under film on springs are not supported"; hint "leave the springs or `frame.bars` out";
            at "frame.bars" "here".
        "frame.springs" beside "`frame.clamp`" when |s| s.scenario.frame.clamp.is_some()
            => "springs at film that slips in its clamp are not supported"; hint "leave the springs or `frame.clamp` out";
            at "frame.clamp" "here".
        "frame.springs" beside "`air.cushion`" when Scene::has_cushion
            => "air between faces on springs is not supported"; hint "leave the springs or `air.cushion` out";
            at "air.cushion" "here".
        "specimen.md_angle", "layer.*.md_angle" beside "`loading.stretch`" when Scene::is_stretch
            => hint "`loading.stretch.direction` gives the orientation of the film between the jaws".
        "layers.prestrain", "layer.*.prestrain" beside "`loading.stretch`" when Scene::is_stretch
            => hint "a stretch test pulls an unstrained film between two jaws".
        "impactor" beside "`loading.stretch`" when Scene::is_stretch => hint "`loading.stretch` has no impactor".
        "impactor" beside "`loading.pressure`" when |s| s.loading.name() == "pressure"
            => hint "`loading.pressure` has no impactor".
        "impactor" beside "`loading.volume`" when |s| s.loading.name() == "volume" => hint "`loading.volume` has no impactor".
        "specimen.damping" beside "`loading.indent`, gas" when |s| s.loading.inertia() == Inertia::Negligible
            => hint "the damping of a quasi-static test follows from its duration".
        "specimen.cuts" beside "gas, `air.cushion`"
            when |s| !s.scenario.specimen.cuts.is_empty() && s.encloses_gas()
            => "film with cuts does not hold gas"; hint "leave `cuts` out, or the gas".
        "specimen.shape.polygon.holes" beside "gas, `air.cushion`"
            when |s| s.has_holes && s.encloses_gas()
            => "film with holes does not hold gas"; hint "leave `holes` out, or the gas".
        "specimen.shape.polygon.file" beside "gas, `air.cushion`, if it has holes"
            when |s| s.has_holes && s.encloses_gas()
            => "film with holes does not hold gas"; hint "draw the outline alone, or leave the gas out".
        "air" beside "all loadings but `loading.impact`" when |s| !s.is_impact()
            => hint "air matters to fast tests, under `loading.impact`".
        "air.vent", "air.discharge", "air.density", "air.pressure" beside "no `air.cushion`"
            when |s| s.is_impact() && !s.has_cushion()
            => hint "no air is enclosed without `cushion`".
        "air.discharge" beside "no `air.vent`" when |s| s.is_impact() && s.has_cushion() && !s.has_vent
            => hint "closed air does not flow: give `vent`".
        "air.cushion" beside "`frame.hold`, unless \"all\"" when |s| s.is_impact() && *s.hold != Hold::All
            => "air escapes past an edge that is not held"; hint "hold \"all\"".
        "contact.itself" beside "no impactor or gas" when |s| s.scenario.contact.itself && !s.film_folds()
            => hint "neither an impactor nor a pressure folds the film".
        "contact.film" beside "no second face and impactor" when |s| s.scenario.contact.film && !s.faces_meet()
            => hint "no two faces can meet".
        "contact.film_friction" beside "no second face and impactor" when |s| !s.faces_meet() && !s.scenario.contact.itself
            => hint "no two faces are pressed on each other".
        "reference.signals" beside "all loadings but `loading.impact`" when |s| !s.is_impact()
            => hint "only an impact is compared with recorded signals".
        "output.filter" beside "all loadings but `loading.impact`" when |s| !s.is_impact()
            => hint "only an impact has a filtered channel".
        "reference.impactor", "reference.acceleration", "reference.invert", "reference.displacement",
        "reference.drop_height", "reference.height_error", "reference.speed", "reference.speed_error", "reference.contact_time",
        "reference.contact_error", "reference.time_constant", "reference.guide_friction"
            beside "no `reference.signals`" when Scene::has_no_signals => hint "there are no `signals`".

    /// Exclusions among the keys of an impactor.
    fn impactor<'a> of Body<'a>:
        "position" beside "`specimen.symmetry`, off its planes" when Body::is_off_centre
            => "the axis of the impactor is not in the mirror plane"; hint "set `specimen.symmetry` to \"none\"";
            at "specimen.symmetry" "the mirror planes".
        "guide" beside "`specimen.symmetry`, if \"free\"" when |b| b.is_mirrored() && b.body.guide == Guide::Free
            => "a free impactor can tip out of the mirror plane"; hint "set `specimen.symmetry` to \"none\"";
            at "specimen.symmetry" "the mirror planes".
        "guide" beside "`specimen.symmetry`, if a line or a hinge"
            when |b| b.is_mirrored() && matches!(b.body.guide, Guide::Line(_) | Guide::Hinge(_))
            => "an impactor on a line or a hinge is not known to stay in the mirror plane";
            hint "set `specimen.symmetry` to \"none\""; at "specimen.symmetry" "the mirror planes".
        "orientation" beside "`specimen.symmetry`" when Body::is_mirrored
            => "an inclined impactor is not symmetric"; hint "set `specimen.symmetry` to \"none\"";
            at "specimen.symmetry" "the mirror planes".
        "shape.mesh" beside "`specimen.symmetry`"
            when |b| b.is_mirrored() && matches!(b.body.shape, ImpactorShape::One(BodyShape::Mesh(_)))
            => "the symmetry of a meshed impactor is not known"; hint "set `specimen.symmetry` to \"none\"";
            at "specimen.symmetry" "the mirror planes".
        "shape.compound" beside "`specimen.symmetry`" when Body::is_mirrored
            => "the symmetry of a compound impactor is not known"; hint "set `specimen.symmetry` to \"none\"";
            at "specimen.symmetry" "the mirror planes".
        "guide" beside "`loading.indent`, unless \"z\"" when |b| b.is_pressed() && b.body.guide != Guide::Z
            => "an indentation prescribes the motion of the impactor along z"; hint "leave the key out".
        "mass", "velocity", "spin", "inertia", "at", "restitution" beside "`loading.indent`" when Body::is_pressed
            => hint "an indentation prescribes the motion of the impactor".
        "position" beside "`loading.indent`, with a height" when |b| b.is_pressed() && b.body.position.len() > 2
            => "an indentation begins in contact with the film"; hint "give x and y".
        "guide_friction" beside "`guide = \"free\"`" when |b| b.body.guide == Guide::Free
            => "a free impactor has no guide"; hint "leave the key out, or set `{}guide` to \"z\"".
        "guide_friction" beside "any `guide` but \"z\"" when |b| !matches!(b.body.guide, Guide::Free | Guide::Z)
            => "friction of a guide along z only is supported"; hint "leave the key out"; at "{}guide" "the guide".
        "guide_friction" beside "`loading.indent`" when Body::is_pressed
            => "an indentation prescribes the motion of the impactor"; hint "leave the key out".
        "at" beside "`guide = \"fixed\"`" when |b| b.body.at.0 > 0.0 && b.body.guide == Guide::Fixed
            => hint "a fixed impactor is not released".
        "velocity" beside "`guide = \"fixed\"`" when |b| b.body.guide == Guide::Fixed => hint "a fixed impactor has none".
        "velocity" beside "`guide.hinge`" when |b| matches!(b.body.guide, Guide::Hinge(_))
            => hint "an impactor on a hinge has a `spin`".
        "inertia", "spin" beside "any `guide` but \"free\" and a hinge" when |b| !b.rotates()
            => hint "the guide admits no rotation; \"free\" and a hinge do".
        "restitution" beside "no other impactor or bars" when |b| b.is_alone
            => hint "there is no other impactor to meet, and the frame has no bars".

    /// Exclusions among the keys of a material.
    fn material of scenario::Material:
        "prony_of", "temperature", "shift" beside "no `prony`" when |m| m.prony.is_empty()
            => hint "the material has no `prony`".
        "prony" beside "`fabric` with `rates`" when scenario::Material::is_fabric_by_rate
            => "a fabric with `rates` cannot also have `prony`: the rate would count twice";
            hint "leave `prony` out, or give each fibre set one curve".
        "prony" beside "`fabric.mounting = \"quasi-static\"`"
            when |m| m.fabric.as_ref().is_some_and(|fabric| fabric.mounting == MountingCurve::QuasiStatic)
            => "a fabric mounted at its quasi-static curve cannot also have `prony`: relaxation would count twice";
            hint "leave `mounting` out: film with `prony` relaxes on the frame"; at "{}fabric.mounting" "the mounting".
        "prony" beside "`plastic`" when |m| m.plastic.is_some()
            => "a plastic film cannot also have `prony`";
            hint "its yield stress grows with the strain rate by `plastic.hardening.rates`; elastic, hyperelastic and fabric film relax".
        "rupture" beside "`fabric.break_scatter`"
            when |m| m.fabric.as_ref().is_some_and(|fabric| fabric.break_scatter > 0.0)
            => "film with a rupture criterion of its own cannot also break layer by layer";
            hint "leave `fabric.break_scatter` out, or `rupture`".
        "thermal" beside "film that absorbs nothing" when |m| !m.absorbs()
            => "film that absorbs no energy does not warm up";
            hint "give `fabric.absorption`, `prony` or a `plastic` law, or leave `thermal` out".
        "thermal" beside "curves by `rates`"
            when |m| m.is_fabric_by_rate() || m.plastic.as_ref().is_some_and(|plastic| plastic.hardening.rates.is_some())
            => "film with curves by strain rate cannot also warm up: those of high rates have their heat in them";
            hint "leave `thermal` out, or give the slowest curve alone".
        "fabric.rate_memory" beside "no `rates`" when |m| !m.is_fabric_by_rate() => hint "neither fibre set has `rates`".
}

/// Most entries of a list of tables whose keys are looked for.
const MOST_PLACES: usize = 64;

impl Checker<'_> {
    /// Reports the keys of the table at `path`, which ends with a point, that the `exclusions` refuse there, each at its
    /// first row, and returns them.
    pub(super) fn exclude<F>(&mut self, path: &str, exclusions: &[Exclusion<F>], facts: &F) -> Vec<&'static str> {
        let mut refused = vec![];
        for row in exclusions.iter().filter(|row| (row.when)(facts)) {
            let keys: Vec<&str> = row.keys.iter().copied().filter(|key| !refused.contains(key)).collect();
            for key in keys {
                let places = if key.contains('*') { MOST_PLACES } else { 1 };
                for place in 0..places {
                    let written = format!("{path}{}", key.replace('*', &place.to_string()));
                    if self.is_written(&written) {
                        row.report(&written, path, self);
                        refused.push(key);
                    }
                }
            }
        }
        refused
    }
}
