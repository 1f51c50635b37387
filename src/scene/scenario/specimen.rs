//! `[specimen]`, `[layers]`, `[[layer]]`, `[frame]`, `[contact]` and `[air]`: the film and what is around it.

use std::borrow::Cow;
use std::path::PathBuf;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Deserialize, Serialize};

use super::impactor::{MeshFile, MeshUnit};
use super::material::Material;
use super::schema;
use crate::mesh::{Element, Side};
use base::units::{Angle, Area, AreaDensity, Density, Force, Length, Pressure, Rate, Stiffness, Time};

keys! {
    /// The film: outline, material, mesh.
    pub struct Specimen {
        /// Outline of the film's free span; rectangles and circles are centred on the origin.
        shape: Shape;
        /// What one layer is made of: the path of a material file, or the table itself.
        material: Option<Material>, default, schemars(schema_with = "schema::path_or_table::<Material>");
        /// Angle from the x axis to the machine direction (MD).
        md_angle: Angle, default;
        /// Element type and size of a face.
        mesh: Meshing, default;
        /// Mirror planes through the origin; only the part at positive x and/or y is computed.
        symmetry: Symmetry, default;
        /// Mass-proportional damping of the film; none where it is left out.
        damping: Rate, default, from 0;
        /// Cuts through all faces, each a line through its points (x and y of each): the elements that it passes through are
        /// left out, at its ends those whose middle lies before them. With symmetry, of the computed part. A tear of film with
        /// `rupture` starts from their ends.
        cuts: Vec<Vec<[Length; 2]>>, or empty, most 1000, schemars(inner(length(min = 2, max = 10_000))), likely [-20.0, 20.0];
        /// Time between mounting and loading of film with `prony`, which is mounted at once with its pre-strain; its stress has
        /// relaxed entirely where it is left out.
        rest: Option<Time>, from 0;
    }

    /// Outline of the film in the plane z = 0.
    pub enum Shape {
        /// Full side lengths along x and y.
        Rectangle(#[schemars(transform = schema::positive_items, extend("x-likely" = [1e-4, 20.0]))] [Length; 2]),
        /// A disc: its free span.
        Circle(Round<1000>),
        /// A polygon with holes, whose edges are free. With symmetry it is the computed part.
        Polygon(Polygon),
        /// Nodes and elements from an STL, OBJ, VTU or Gmsh (.msh) file.
        Mesh(MeshFile),
    }

    /// A polygon with holes: corners, or a drawing.
    #[schemars(extend("oneOf" = [{ "required": ["file"] }, { "required": ["points"] }]))]
    pub struct Polygon {
        /// Drawing in a DXF file (LWPOLYLINE, POLYLINE, LINE, ARC and CIRCLE) or an SVG file (paths and basic shapes), in place of
        /// `points`; the largest loop is the outline, the others are holes.
        file: Option<PathBuf>, path;
        /// Unit of the drawing's coordinates; required where the drawing does not give it (DXF: $INSUNITS; SVG: width and height
        /// with a unit).
        unit: Option<MeshUnit>;
        /// Corners of the outline in order, x and y of each.
        points: Option<Vec<[Length; 2]>>, least 3, most 10_000, likely [-20.0, 20.0];
        /// Corners of each hole.
        holes: Vec<Vec<[Length; 2]>>, or empty, most 1000;
    }

    /// Element type and size of a face.
    #[derive(Default)]
    pub struct Meshing {
        /// Type of membrane element.
        element: Option<Element>, usually "quad4";
        /// Target edge length, of a graded mesh the largest; required unless the mesh is imported.
        size: Option<Length>, above 0, likely [1e-6, 0.5];
        /// Target edge length around one place, from which elements grow to `size`; left out, all have one size.
        fine: Option<Length>, above 0, likely [1e-6, 0.5];
        /// Where elements are `fine`: where each impactor meets the film, or around a point of the undeformed film.
        around: Option<Around>, usually "impactor";
        /// Radius of the circle in which elements are `fine`; the impactor's radius seen from above where it is left out, and
        /// of a point zero.
        within: Option<Length>, from 0, likely [1e-5, 5.0];
        /// Growth of the edge length per distance from that circle, up to `size`.
        growth: Option<f64>, from 0.02, to 1, usually 0.25;
    }

    /// Where elements are fine. The validator has reported mistakes before serde tries the two forms.
    #[derive(Copy, PartialEq)]
    pub enum Around of forms {
        /// Around the impactors.
        Word(AroundChoice),
        /// Around a point, x and y.
        Point([Length; 2]),
    }

    /// A place that other keys give.
    pub enum AroundChoice of words {
        /// Where each impactor meets the film.
        Impactor,
    }

    /// Mirror planes through the origin.
    #[derive(Default)]
    pub enum Symmetry of words {
        /// The whole film is computed.
        #[default]
        None,
        /// Only x >= 0 is computed.
        HalfX,
        /// Only y >= 0 is computed.
        HalfY,
        /// Only x >= 0 and y >= 0 is computed.
        Quarter,
    }

    /// Faces of film that differ in height only.
    pub struct Layers with defaults {
        /// Layers per face; n layers act as one membrane of n times the thickness.
        count: u32, else 1, from 1, to 10_000;
        /// Height of every face, the highest first.
        faces: Vec<Length>, else { vec![Length(0.0)] }, least 1, most 64, likely [-10.0, 10.0];
        /// Engineering strain with which the film is mounted on the frame.
        prestrain: Prestrain;
        /// Whether film is brought to equilibrium with its pre-strain and its weight before the test.
        settle: bool, else true;
    }

    /// One face of film with its own material, angle and mesh.
    pub struct Layer with defaults {
        /// Height of the undeformed face.
        height: Length, likely [-10.0, 10.0];
        /// Layers in this face.
        count: u32, else 1, from 1, to 10_000;
        /// Material of one layer; the specimen's where it is left out.
        material: Option<Material>, schemars(schema_with = "schema::path_or_table::<Material>");
        /// Angle from the x axis to MD; the specimen's where it is left out.
        md_angle: Option<Angle>;
        /// Engineering strain with which this face is mounted.
        prestrain: Prestrain;
        /// Whether this face is brought to equilibrium with its pre-strain and its weight before the test.
        settle: bool, else true;
        /// Element type and size; what is left out is the specimen's.
        mesh: Meshing;
    }

    /// Engineering strain before the test: the film's own length is the span / (1 + strain).
    #[derive(Copy)]
    pub struct Prestrain with defaults {
        /// Along the machine direction.
        md: f64, above -1, to 100, likely [-1.0, 5.0], title "Pre-strain along MD";
        /// Along the transverse direction.
        td: f64, above -1, to 100, likely [-1.0, 5.0], title "Pre-strain along TD";
    }

    /// The mounting frame.
    #[derive(Default)]
    pub struct Frame {
        /// Clamped edges: all of them, none, or the sides listed. Under `loading.stretch` the jaws clamp the sides
        /// x- and x+, and no other edge can be clamped.
        hold: Option<Hold>, usually "all";
        /// Bars along the held edges, over which film bends: the edge lies on their crest. Between two faces they are as high as
        /// these are apart. Impactors that reach them meet them. Left out, the frame has no thickness.
        bars: Option<Bars>;
        /// A clamp in which film slips; left out, it is held.
        clamp: Option<Clamp>;
        /// Springs on which film hangs, between its held edges and the frame; left out, these edges are fixed.
        springs: Option<Springs>;
    }

    /// Bars along the held edges of film.
    pub struct Bars {
        /// Of the bars, over which film bends.
        round: Round<50>, flat;
        /// Coulomb coefficient between bars and film; between bars and an impactor the smaller of theirs.
        friction: f64, from 0, to 10, likely [1e-3, 2.0];
    }

    /// A clamp in which film slips.
    #[derive(Copy, PartialEq)]
    pub struct Clamp {
        /// Force with which the clamp presses on each face of film, along all of its held edges together.
        force: Force, above 0, likely [1e-2, 1e6];
        /// Coulomb coefficient between the clamp and each side of the film.
        friction: f64, to 10, above 0, likely [1e-3, 2.0];
        /// Length of film within the clamp, after which it has slipped out of it; left out, it never does.
        width: Option<Length>, above 0, likely [1e-4, 1.0];
    }

    /// Linear springs between the held edges of film and the frame: each points outward, in the plane of the film and across its
    /// edge. One that is shorter than without force is slack.
    #[derive(Copy, PartialEq)]
    pub struct Springs {
        /// Stiffness of one spring.
        stiffness: Stiffness, above 0, likely [1.0, 1e9];
        /// Number of springs along the held edges of the whole film, of each face, evenly along each stretch of them and round
        /// its corners.
        count: u32, from 1, to 100_000;
        /// Distance from the edge of film, as it is mounted, to the frame.
        length: Length, above 0, likely [1e-4, 10.0];
        /// Force of one spring at that length; left out, what the pre-strain of the film pulls with across its edge.
        preload: Option<Force>, from 0, likely [1e-3, 1e6];
    }

    /// Clamped edges. The validator has reported mistakes before serde tries the two forms.
    #[derive(PartialEq)]
    pub enum Hold of forms {
        /// All edges or none.
        Word(EdgeChoice),
        /// The sides listed.
        Sides(#[schemars(length(min = 1, max = 4))] Vec<Side>),
    }

    /// All edges or none.
    pub enum EdgeChoice of words {
        /// Every edge is clamped.
        All,
        /// No edge is clamped.
        None,
    }

    /// Contact of film with film.
    #[derive(Copy, PartialEq)]
    pub struct Contact with defaults {
        /// Whether faces meet each other, also where the impactor is not; without it each face meets the impactor alone,
        /// through the film above it.
        film: bool;
        /// Whether each face meets itself, where it folds and where the lips of a cut or a tear meet; without it film passes
        /// through itself.
        itself: bool;
        /// Coulomb coefficient of film on film. Where it is left out, film is assumed to have the coefficient that it has on the
        /// impactor; impactors that differ in `friction` need it, and so does `loading.pressure`.
        film_friction: Option<f64>, from 0, to 10, likely [1e-3, 2.0];
    }

    /// The air around the film, which has no effect where the table is left out.
    #[derive(Copy, PartialEq)]
    pub struct Air with defaults {
        /// How the air between the two faces of film behaves that the impactor compresses; no such air where it is left
        /// out. Torn film lets it out.
        cushion: Option<Compression>;
        /// Area of all openings through which the air between the faces leaves; closed where it is left out.
        vent: Area, from 0, to 100;
        /// Discharge coefficient of the openings: the share of their area that a jet fills.
        discharge: f64, else 0.6, above 0, to 1;
        /// Mass of air per area of film that moves with it, on both sides together; it has inertia and no weight.
        added_mass: AreaDensity, from 0, to 10;
        /// Density of the air.
        density: Density, else Density(1.2), above 0, to 100;
        /// Pressure of the air.
        pressure: Pressure, else Pressure(101_325.0), above 0, to 1e7, likely [1e4, 2e5];
    }

    /// How enclosed air is compressed.
    pub enum Compression of words {
        /// Without exchange of heat: too fast for it.
        Adiabatic,
        /// At constant temperature.
        Isothermal,
    }
}

impl Meshing {
    /// The keys of one face, and of those that it leaves out the ones that all faces share.
    pub fn over(&self, shared: &Meshing) -> Meshing {
        Meshing {
            element: self.element.or(shared.element),
            size: self.size.or(shared.size),
            fine: self.fine.or(shared.fine),
            around: self.around.or(shared.around),
            within: self.within.or(shared.within),
            growth: self.growth.or(shared.growth),
        }
    }
}

impl Symmetry {
    /// Whether x = 0 and y = 0 are mirror planes.
    pub fn mirrors(self) -> [bool; 2] {
        [matches!(self, Symmetry::HalfX | Symmetry::Quarter), matches!(self, Symmetry::HalfY | Symmetry::Quarter)]
    }

    /// How many copies of the computed part the whole is made of.
    pub fn copies(self) -> f64 {
        self.mirrors().iter().map(|mirror| if *mirror { 2.0 } else { 1.0 }).product()
    }
}

impl Compression {
    /// Exponent of pressure over density.
    pub fn exponent(self) -> f64 {
        match self {
            Compression::Adiabatic => 1.4,
            Compression::Isothermal => 1.0,
        }
    }
}

/// Radius or diameter; the validator has refused both and neither. A radius above `LIKELY` cm is implausible.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Round<const LIKELY: u32> {
    /// The radius.
    pub radius: Option<Length>,
    /// The diameter, in place of the radius.
    pub diameter: Option<Length>,
}

/// Least radius that is plausible, m.
const LEAST: f64 = 1e-4;

/// Largest radius, m.
const LARGEST: f64 = 1e3;

impl<const LIKELY: u32> Round<LIKELY> {
    /// The radius, m.
    pub fn radius(self) -> f64 {
        match (self.radius, self.diameter) {
            (Some(radius), _) => radius.0,
            (None, Some(diameter)) => 0.5 * diameter.0,
            (None, None) => f64::NAN,
        }
    }
}

impl<const LIKELY: u32> JsonSchema for Round<LIKELY> {
    fn schema_name() -> Cow<'static, str> {
        format!("Round{LIKELY}").into()
    }

    fn inline_schema() -> bool {
        true
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let mut length = |sentence: &str, factor: f64| {
            let mut schema = Length::json_schema(generator);
            let likely = [LEAST, 1e-2 * f64::from(LIKELY)].map(|radius| factor * radius);
            schema.insert("description".into(), sentence.into());
            schema.insert("exclusiveMinimum".into(), 0.into());
            schema.insert("maximum".into(), (factor * LARGEST).into());
            schema.insert("x-likely".into(), likely.to_vec().into());
            schema
        };
        let (radius, diameter) = (length("Radius.", 1.0), length("Diameter, in place of the radius.", 2.0));
        json_schema!({
            "type": "object",
            "properties": { "radius": radius, "diameter": diameter },
            "oneOf": [{ "required": ["radius"] }, { "required": ["diameter"] }],
        })
    }
}
