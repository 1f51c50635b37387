//! Decks of OpenRadioss: a starter and an engine file.
//!
//! Blocks in the format of 2023, as its configuration files have them (OpenRadioss, `hm_cfg_files/config/CFG`). A fabric (LAW58)
//! takes the property of type 16, LAW19 and LAW43 that of type 9, the others that of type 1; all with one point through the
//! thickness.

use membrane::material::Law;

use super::finding::DeckLoss;
use super::{Body, DeckWriter, Face, GRAVITY, Move, STEEL, Scene, listed};
use crate::film::WriteCurve;
use crate::layout::Field::{Real, Whole, Word};
use crate::layout::{Field, Layout, in_twenty, whole};
use crate::openradioss::{block, function};
use crate::target::System;
use base::diagnostic::Diagnostic;

/// Share of the mass of a body that its shells have; the rest is that of its main node.
const OF_SHELLS: f64 = 1e-3;

/// Largest stiffness of a contact at a node, N/m. The solver's own is that of the steepest curve, unloading among them, which
/// throws stiff film back and takes four times as many steps. Nodes of test 1008, with 3 N each, sink by 0.2 mm.
const CONTACT_STIFFNESS: f64 = 2e4;

/// Blocks of a deck. What shells do where a card has no field of the law's are defaults of the solver: elements of type 24 (QEPH),
/// the share 5/6 of the shear stiffness, no damping but that of membranes.
const PART: Layout = &["prop_ID# mat_ID# subset_ID#=0"];
/// Of a fabric, with forces per width of film without stress: its thickness stays.
const SHELL_16: Layout = &[
    "Ishell#=24 Ismstr# Ish3n#=2 - - - P_Thick_Fail=1.0",
    "Hm=0.0 Hf=0.0 Hr=0.0 Dm=0.0 Dn=0.015",
    "N#=1 Istrain#=1 Thick:length Ashear=0.8333333333333334 - Ithick#=2",
    "Vx Vy Vz=0.0 Skew_ID#=0 Ipos#=0 - Ip#=0",
    "Phi_i=0.0 Alpha_i=90.0 T_i:length Z_i=0.0 mat_IDi#",
];
const SHELL_9: Layout = &[
    "Ishell#=24 Ismstr# Ish3n#=2 Idrill#=0 - - P_Thick_Fail=1.0",
    "Hm=0.0 Hf=0.0 Hr=0.0 Dm=0.0 Dn=0.015",
    "N#=1 Istrain#=1 Thick:length Ashear=0.8333333333333334 Iskew#=0 Ithick#=1 Iplas#=1",
    "Vx Vy Vz=0.0 Phi=0.0 - Ip#=0",
];
/// Film that flows thins as it does without volume: without Iplas it thins as elastic film.
const SHELL_1: Layout = &[
    "Ishell#=24 Ismstr# Ish3n#=2 Idrill#=0 - - P_Thick_Fail=1.0",
    "Hm=0.0 Hf=0.0 Hr=0.0 Dm=0.0 Dn=0.015",
    "N#=1 Istrain#=1 Thick:length Ashear=0.8333333333333334 - Ithick# Iplas#=1",
];
const STEEL_OF_BODY: Layout = &["RHO_I:density", "E:stress nu"];
/// The centre of a body is that of its main node.
const RIGID: Layout = &[
    "node_ID# sens_ID#=0 Skew_ID#=0 Ispher#=0 Mass:mass grnd_ID# Ikrem#=0 ICoG#=3 surf_ID#=0",
    "Jxx:inertia Jyy:inertia Jzz:inertia",
    "Jxy=0.0 Jyz=0.0 Jxz=0.0",
    "Ioptoff#=0 Iexpams#=0",
];
const VELOCITY: Layout = &["Vx:velocity Vy:velocity Vz:velocity Gnod_id# Skew_id#=0"];
const FIXED: Layout = &["Tra_rot# skew_ID#=0 grnod_ID#"];
const MOTION: Layout = &[
    "funct_IDT# Dir# skew_ID#=0 sensor_ID#=0 grnod_ID# frame_ID#=0 Icoor#=0",
    "Ascale_x=1.0 Fscale_Y Tstart=0.0 Tstop:time",
];
const GRAVITY_LOAD: Layout = &["funct_IDT# DIR#=Z skew_ID#=0 sensor_ID#=0 grnod_ID# - Ascale_x=1.0 Fscale_Y=-1.0"];
/// The least of both stiffnesses, a constant gap, and friction by increments: the default is viscous, and less.
const CONTACT: Layout = &[
    "grnod_id# surf_id# Istf#=4 Ithe#=0 Igap#=1000 - Ibag#=0 Idel#=0 Icurv#=0 Iadm#=0",
    "Fscalegap=1.0 Gap_max=0.0 Fpenmax=0.0 - - Itied#=0",
    "Stmin=0.0 Stmax:stiffness Percent_mesh_size=0.0 dtmin=0.0 Irem_gap#=1 Irem_i2#=0",
    "Stfac=1.0 Fric GAPmin:length Tstart=0.0 Tstop=0.0",
    "IBC#=000 - - Inacti#=0 VIS_S=0.05 VIS_F=1.0 Bumult=0.0",
    "Ifric#=0 Ifiltr#=0 Xfreq=0.0 Iform#=2 sens_ID#=0 fct_IDF#=0 AscaleF=1.0 fric_ID#=0",
];

pub(super) struct OpenRadioss<'s> {
    scene: &'s Scene<'s, 's>,
    units: [&'static str; 3],
    /// Groups of nodes so far.
    groups: i64,
}

impl DeckWriter for OpenRadioss<'_> {
    const CURVE: WriteCurve = function;

    fn begin(&mut self) -> String {
        let units: String = self.units.iter().map(|unit| format!("{unit:>20}")).collect();
        let title = crate::title(self.scene.deck.title);
        format!("/BEGIN\nfilm\n{:>10}{:>10}\n{units}\n{units}\n/TITLE\n{title}\n", 2023, 0)
    }

    fn face(&mut self, face: &Face<'_>, place: usize, first: [usize; 2]) -> String {
        let number = place + 1;
        let material = i64::from(self.scene.materials.of_face[place]);
        let title = crate::title(&format!("face {number} {}", face.film.name));
        let mut text = self.part(number, &title, material) + &self.film_property(face, number, material, &title);
        text += &self.nodes(face.stress_free.iter().copied(), first[0]);
        let corner = |node: u32| first[0] + node as usize;
        text += &elements("SHELL", number, first[1], face.quads.iter().map(|quad| quad.map(corner)));
        text += &elements("SH3N", number, first[1] + face.quads.len(), face.tris.iter().map(|tri| tri.map(corner)));
        text + &self.group(&format!("face {number}"), first[0]..first[0] + face.mounted.len())
    }

    /// Shells on a main node at the centre, which has mass, velocity and output.
    fn body(&mut self, body: &Body, place: usize, next: &mut [usize; 2]) -> String {
        let scene = self.scene;
        let number = scene.deck.faces.len() + place + 1;
        let material = (scene.materials.cards.len() + place + 1) as i64;
        let (start, inset) = (scene.start(body), body.shape.inset());
        let surface = body.shape.triangles(inset, scene.rings(body));
        let main = next[0];
        let title = crate::title(&body.name);
        let mut text = self.part(number, &title, material);
        // Thin shells of any mass but none: what they have is not added to the main node.
        let shells = [Whole(2), Real(inset), Whole(2)];
        text += &self.block(&format!("/PROP/TYPE1/{number}"), &title, SHELL_1, &shells);
        let density = OF_SHELLS * body.mass / (surface.area() * inset);
        // The shells of a body are rigid.
        let [_, young, poisson] = STEEL;
        let steel = [density, young, poisson].map(Real);
        text += &self.block(&format!("/MAT/LAW1/{material}"), &title, STEEL_OF_BODY, &steel);
        let places = surface.points.iter().map(|point| [0, 1, 2].map(|axis| start[axis] + point[axis]));
        text += &self.nodes(std::iter::once(start).chain(places), main);
        let corners = surface.corners.iter().map(|corners| corners.map(|corner| main + 1 + corner));
        text += &elements("SH3N", number, next[1], corners);
        *next = [main + 1 + surface.points.len(), next[1] + surface.corners.len()];
        text += &self.group(&format!("{title}, surface"), main + 1..next[0]);
        let head = [Whole(main as i64), Real((1.0 - OF_SHELLS) * body.mass), Whole(self.groups)];
        let rigid = [&head[..], &body.inertia.map(Real)].concat();
        text += &self.block(&format!("/RBODY/{}", place + 1), &title, RIGID, &rigid);
        text += &format!("/SURF/PART/{number}\n{title}\n{number:>10}\n");
        text += &self.group(&format!("{title}, main node"), [main]);
        if body.is_guided {
            text += &self.constraint(place + 1, "110 111", &format!("{title}, guide"));
        }
        text += &self.group(&format!("{title}, all"), main..next[0]);
        let velocity = [&body.velocity.map(Real)[..], &[Whole(self.groups)]].concat();
        text += &self.block(&format!("/INIVEL/TRA/{}", place + 1), &title, VELOCITY, &velocity);
        // By its end a time history is known as that of a test: lab's reader of them has its signals over the time of the test.
        let test = format!("{}; test from {} s", title.chars().take(60).collect::<String>(), scene.mounting.begin);
        text += &format!("/TH/NODE/{}\n{test}\nDZ        VZ        AZ\n{main:>10}{:>10}\n", 2 * place + 1, 0);
        text + &format!("/TH/RBODY/{}\n{title}\nDEF       FX        FY        FZ\n{:>10}\n", 2 * place + 2, place + 1)
    }

    fn fixed(&mut self, axis: usize, nodes: &[usize]) -> String {
        let title = format!("fixed along {}", ["x", "y", "z"][axis]);
        let number = self.scene.deck.bodies.len() + axis + 1;
        let group = self.group(&title, nodes.iter().map(|node| node + 1));
        group + &self.constraint(number, ["100 000", "010 000", "001 000"][axis], &title)
    }

    fn moved(&mut self, place: usize, one: &Move) -> String {
        let scene = self.scene;
        let direction = ["X", "Y", "Z"][one.axis];
        let group = self.group(&format!("moved along {direction}"), one.nodes.iter().map(|node| node + 1));
        let (curve, scale) = scene.curve_of(one);
        let stop = if one.is_held { 2.0 * scene.end() } else { scene.mounting.time };
        let values = [Whole(curve), Word(direction), Whole(self.groups), Real(scale), Real(stop)];
        group + &self.block(&format!("/IMPDISP/{}", place + 1), "mounting", MOTION, &values)
    }

    fn gravity(&mut self, nodes: usize) -> String {
        let group = self.group("all", 1..=nodes);
        group + &self.block("/GRAV/1", "gravity", GRAVITY_LOAD, &[Whole(GRAVITY), Whole(self.groups)])
    }

    /// At a constant gap. The group of a face has its number.
    fn contact(&mut self, body: &Body, place: usize, face: usize) -> String {
        let faces = self.scene.deck.faces.len();
        let title = crate::title(&format!("{} on face {}", body.name, face + 1));
        let gap = body.shape.inset() + self.scene.offset(face);
        let [group, surface] = [face + 1, faces + place + 1].map(|number| Whole(number as i64));
        let values = [group, surface, Real(CONTACT_STIFFNESS), Real(body.friction[face]), Real(gap)];
        self.block(&format!("/INTER/TYPE7/{}", place * faces + face + 1), &title, CONTACT, &values)
    }
}

impl<'s> OpenRadioss<'s> {
    pub(super) fn new(scene: &'s Scene<'s, 's>, losses: &mut Vec<DeckLoss>) -> Result<OpenRadioss<'s>, Diagnostic> {
        losses.push(DeckLoss::ContactStiffness { stiffness: CONTACT_STIFFNESS });
        let units = match scene.system {
            System::KgMS => ["kg", "m", "s"],
            System::TMmS => ["Mg", "mm", "s"],
            System::GMmMs => ["g", "mm", "ms"],
            System::KgMmMs => ["kg", "mm", "ms"],
            System::LbfInS => {
                let message = format!("OpenRadioss has no name for the units of {}", scene.system.name());
                return Err(Diagnostic::new(message).hint("name other ones, such as --units t-mm-s"));
            }
        };
        Ok(OpenRadioss { scene, units, groups: 0 })
    }

    fn block(&self, keyword: &str, title: &str, layout: Layout, values: &[Field]) -> String {
        block(keyword, title, layout, self.scene.system, values)
    }

    fn part(&self, number: usize, title: &str, material: i64) -> String {
        self.block(&format!("/PART/{number}"), title, PART, &[Whole(number as i64), Whole(material)])
    }

    /// The property of a face: large strain, one point and with it no bending, and thickness that changes where the law is one of
    /// true stress. Strain is computed, as all that is read of it needs.
    fn film_property(&self, face: &Face<'_>, number: usize, material: i64, title: &str) -> String {
        let kind = property(face);
        let thickness = Real(face.thickness());
        let [vx, vy] = [face.md_angle.cos(), face.md_angle.sin()].map(Real);
        // Rubber has the strain of the whole motion: increments of it add up to another one where film is sheared.
        let strain = Whole(if matches!(face.film.material.law, Law::Hyperelastic(_)) { 10 } else { 4 });
        let (layout, values) = match kind {
            16 => (SHELL_16, vec![strain, thickness, vx, vy, thickness, Whole(material)]),
            9 => (SHELL_9, vec![strain, thickness, vx, vy]),
            _ => (SHELL_1, vec![strain, thickness, Whole(1)]),
        };
        self.block(&format!("/PROP/TYPE{kind}/{number}"), title, layout, &values)
    }

    /// Nodes at places in m, numbered from `first`.
    fn nodes(&self, places: impl Iterator<Item = [f64; 3]>, first: usize) -> String {
        let mut text = String::from("/NODE\n#  NODE_ID                  XC                  YC                  ZC\n");
        for (node, place) in places.enumerate() {
            let [x, y, z] = place.map(|value| in_twenty(self.scene.length(value)));
            text += &format!("{:>10}{x:>20}{y:>20}{z:>20}\n", first + node);
        }
        text
    }

    /// The next group of nodes, which are counted from 1.
    fn group(&mut self, title: &str, nodes: impl IntoIterator<Item = usize>) -> String {
        self.groups += 1;
        format!("/GRNOD/NODE/{}\n{title}\n{}", self.groups, listed(nodes, 10))
    }

    /// Degrees of freedom of the last group that are fixed.
    fn constraint(&self, number: usize, fixed: &'static str, title: &str) -> String {
        self.block(&format!("/BCS/{number}"), title, FIXED, &[Word(fixed), Whole(self.groups)])
    }
}

/// Type of the property that a law takes.
fn property(face: &Face<'_>) -> u32 {
    match &face.film.material.law {
        Law::Fabric(_) | Law::RateFabric(_) => 16,
        Law::Elastic(_) | Law::TensionField(_) => 9,
        Law::Plastic(law) if crate::film::lost_hill(law).is_some() => 9,
        Law::Plastic(_) | Law::Hyperelastic(_) => 1,
    }
}

/// Elements numbered from `first`; nothing where there are none.
fn elements<const N: usize>(
    kind: &str,
    part: usize,
    first: usize,
    elements: impl ExactSizeIterator<Item = [usize; N]>,
) -> String {
    if elements.len() == 0 {
        return String::new();
    }
    let line = |(element, corners): (usize, [usize; N])| listed(std::iter::once(first + element).chain(corners), 10);
    format!("/{kind}/{part}\n{}", elements.enumerate().map(line).collect::<String>())
}

/// The engine file: how long, and what is written how often. Time histories of the format of 2021 name their units.
pub(super) fn engine(scene: &Scene<'_, '_>) -> String {
    let [end, interval] = [scene.end(), scene.deck.interval].map(|time| whole(scene.time(time)));
    let states = whole(scene.time(scene.deck.duration / 100.0));
    // Stiff film of linear law rings at its stable step.
    let is_stiff = |face: &Face<'_>| property(face) != 16 && !matches!(face.film.material.law, Law::Hyperelastic(_));
    let step = if scene.deck.faces.iter().any(is_stiff) { 0.6 } else { 0.9 };
    format!(
        "#RADIOSS ENGINE\n/VERS/2023\n/RUN/film/1\n{end}\n/TFILE\n{interval}\n/TH/VERS/2021\n/ANIM/DT\n0.0 {states}\n/PRINT/-1000\n/DT\n{step} 0.0\n"
    )
}
