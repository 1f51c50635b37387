//! The columns of `signals.csv`, each with its unit, its name in scripts and how it is plotted.

use base::units::{DIMENSIONS, Dimension};

/// A column of `signals.csv`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Column {
    /// In the header of the file; it ends with the unit.
    pub name: &'static str,
    /// As a property of a run or of a reduced drop in scripts.
    pub short: &'static str,
    /// Of its values; empty of a ratio.
    pub unit: &'static str,
    /// Words of its axis in plots, with the unit there.
    pub axis: &'static str,
    /// Unit of the axis.
    pub axis_unit: &'static str,
    /// From the unit of the values to that of the axis.
    pub factor: f64,
    /// Its explanation, as one or more lines.
    pub sentence: &'static [&'static str],
    /// Of which runs it is.
    pub when: &'static str,
    /// Whether each of several impactors has its own, whose name begins with that of the impactor.
    pub is_of_each_impactor: bool,
    /// Its curve over time, where page and recording draw it in a plot of film or frame.
    pub curve: Option<CurveOverTime>,
}

/// The curve of a column in a plot over time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CurveOverTime {
    /// Title of the plot, which consecutive columns may share.
    pub title: &'static str,
    /// Label of the curve; none where it is the only one of its plot.
    pub label: Option<&'static str>,
}

// A row: `CONSTANT = name, name in scripts, unit, quantity (unit of the axis), factor; when;`, and where it has a curve,
// `in "title of its plot";` or `in "title of its plot" as "label";`.
macro_rules! columns {
    ($(is_of_each_impactor = $each:literal {
        $($(#[doc = $doc:literal])+ $constant:ident = $name:literal, $short:literal,
            $unit:literal, $quantity:literal ($axis_unit:literal), $factor:literal; $when:literal;
            $(in $title:literal $(as $label:literal)?;)?)+
    })+) => {
        $($($(#[doc = $doc])+ pub const $constant: Column = Column {
            name: $name,
            short: $short,
            unit: $unit,
            axis: concat!($quantity, " (", $axis_unit, ")"),
            axis_unit: $axis_unit,
            factor: $factor,
            sentence: &[$($doc),+],
            when: $when,
            is_of_each_impactor: $each,
            curve: columns!(@curve $($title $(as $label)?)?),
        };)+)+
        /// All columns, in the order in which scripts list them.
        pub const COLUMNS: &[Column] = &[$($($constant),+),+];
    };
    (@curve) => { None };
    (@curve $title:literal) => { Some(CurveOverTime { title: $title, label: None }) };
    (@curve $title:literal as $label:literal) => { Some(CurveOverTime { title: $title, label: Some($label) }) };
}

columns! {
    is_of_each_impactor = true {
        /// Vertical position of the impactor from first contact, or travel of the jaws.
        DISPLACEMENT = "displacement_m", "displacement", "m", "displacement" ("mm"), 1e3;
            "of an impact and of a stretch";
        /// Vertical velocity of the impactor, positive upwards.
        VELOCITY = "velocity_m_s", "velocity", "m/s", "velocity" ("m/s"), 1.0;
            "of an impact";
        /// Acceleration of the impactor through the channel filter of the run.
        ACCELERATION_FILTERED = "acceleration_filtered_m_s2", "acceleration", "m/s2", "acceleration" ("m/s²"), 1.0;
            "of an impact";
        /// Acceleration of the impactor before the filter.
        ACCELERATION = "acceleration_m_s2", "acceleration_raw", "m/s2", "acceleration" ("m/s²"), 1.0;
            "of an impact";
        /// Position of an impactor that does not only move along z, along x from the start.
        DISPLACEMENT_X = "displacement_x_m", "displacement_x", "m", "displacement" ("mm"), 1e3;
            "of an impactor that does not move along z alone";
        /// Position of an impactor that does not only move along z, along y from the start.
        DISPLACEMENT_Y = "displacement_y_m", "displacement_y", "m", "displacement" ("mm"), 1e3;
            "of an impactor that does not move along z alone";
        /// Velocity of an impactor that does not only move along z, along x.
        VELOCITY_X = "velocity_x_m_s", "velocity_x", "m/s", "velocity" ("m/s"), 1.0;
            "of an impactor that does not move along z alone";
        /// Velocity of an impactor that does not only move along z, along y.
        VELOCITY_Y = "velocity_y_m_s", "velocity_y", "m/s", "velocity" ("m/s"), 1.0;
            "of an impactor that does not move along z alone";
        /// Acceleration of an impactor that does not only move along z, along x, before any filter.
        ACCELERATION_X = "acceleration_x_m_s2", "acceleration_x", "m/s2", "acceleration" ("m/s²"), 1.0;
            "of an impactor that does not move along z alone";
        /// Acceleration of an impactor that does not only move along z, along y, before any filter.
        ACCELERATION_Y = "acceleration_y_m_s2", "acceleration_y", "m/s2", "acceleration" ("m/s²"), 1.0;
            "of an impactor that does not move along z alone";
        /// Size of the acceleration of the centre of mass of an impactor that does not only move along z, before any
        /// filter.
        ACCELERATION_RESULTANT = "acceleration_resultant_m_s2", "acceleration_resultant", "m/s2", "acceleration" ("m/s²"), 1.0;
            "of an impactor that does not move along z alone";
        /// Vertical force of the film on the impactor.
        CONTACT_FORCE = "contact_force_N", "contact_force", "N", "force" ("N"), 1.0;
            "of an impact";
        /// Vertical force of other impactors and of the frame's bars on an impactor.
        COLLISION_FORCE = "collision_force_N", "collision_force", "N", "force" ("N"), 1.0;
            "of an impact, where there are several impactors or `frame.bars`";
        /// Kinetic energy of the impactor, of its rotation too.
        KINETIC_ENERGY = "kinetic_energy_J", "kinetic_energy", "J", "energy" ("J"), 1.0;
            "of an impact";
        /// Potential energy of the impactor.
        POTENTIAL_ENERGY = "potential_energy_J", "potential_energy", "J", "energy" ("J"), 1.0;
            "of an impact";
        /// Energy that the film has taken from the impactor.
        ABSORBED_ENERGY = "absorbed_energy_J", "absorbed_energy", "J", "energy" ("J"), 1.0;
            "of an impact";
        /// Sum of kinetic, potential and absorbed energy.
        TOTAL_ENERGY = "total_energy_J", "total_energy", "J", "energy" ("J"), 1.0;
            "of an impact";
    }
    is_of_each_impactor = false {
        /// Largest engineering strain of the MD fibres.
        MAX_STRAIN_MD = "max_strain_md", "max_strain_md", "", "engineering strain" ("%"), 100.0;
            "of an impact";
        /// Largest engineering strain of the TD fibres.
        MAX_STRAIN_TD = "max_strain_td", "max_strain_td", "", "engineering strain" ("%"), 100.0;
            "of an impact";
        /// Mean force on the held sides across x.
        FRAME_FORCE_X = "frame_force_x_N", "frame_force_x", "N", "force" ("N"), 1.0;
            "where a frame holds sides across x of a rectangle; not of a stretch";
            in "Force of the film on the frame" as "along x";
        /// Mean force on the held sides across y.
        FRAME_FORCE_Y = "frame_force_y_N", "frame_force_y", "N", "force" ("N"), 1.0;
            "where a frame holds sides across y of a rectangle; not of a stretch";
            in "Force of the film on the frame" as "along y";
        /// Vertical force on the frame, positive downwards: of film, of the edge on their crest and of impactors on its bars,
        /// or of the springs on which film hangs.
        FRAME_FORCE = "frame_force_N", "frame_force", "N", "force" ("N"), 1.0;
            "where there are `frame.bars` or `frame.springs`";
            in "Force of the film on the frame" as "downwards";
        /// Largest slip of film in the frame's clamp.
        CLAMP_SLIP = "clamp_slip_m", "clamp_slip", "m", "slip" ("mm"), 1e3;
            "where there is a `frame.clamp`";
            in "Slip in the clamp of the frame";
        /// Largest elongation of a spring on which film hangs.
        SPRING_ELONGATION = "spring_elongation_m", "spring_elongation", "m", "elongation" ("mm"), 1e3;
            "where there are `frame.springs`";
            in "Largest elongation of a spring of the frame";
        /// Largest force of one spring on which film hangs.
        SPRING_FORCE = "spring_force_N", "spring_force", "N", "force" ("N"), 1.0;
            "where there are `frame.springs`";
            in "Largest force of a spring of the frame";
        /// Pressure of the air between two faces over that of the surroundings.
        AIR_PRESSURE = "air_pressure_Pa", "air_pressure", "Pa", "air pressure" ("Pa"), 1.0;
            "with `air.cushion`";
        /// Least distance of the middle surfaces of two faces, or of one face that meets itself; where none is within that in which they are followed, it is
        /// at least this, which the column has then.
        FILM_DISTANCE = "film_distance_m", "film_distance", "m", "distance" ("mm"), 1e3;
            "of film with `contact.film` or `contact.itself`";
        /// Nodes that press on another face of film, or elsewhere on their own.
        FILM_CONTACT_NODES = "film_contact_nodes", "film_contact_nodes", "", "nodes" ("number"), 1.0;
            "of film with `contact.film` or `contact.itself`";
        /// Force on the jaws, or on the impactor of an indentation.
        FORCE = "force_N", "force", "N", "force" ("N"), 1.0;
            "of a stretch and of an indentation";
        /// Engineering strain between the jaws.
        STRAIN = "strain", "strain", "", "engineering strain" ("%"), 100.0;
            "of a stretch";
        /// Nominal stress between the jaws.
        STRESS = "stress_Pa", "stress", "Pa", "stress" ("MPa"), 1e-6;
            "of a stretch";
        /// Depth of an indentation.
        DEPTH = "depth_m", "depth", "m", "depth" ("mm"), 1e3;
            "of an indentation";
        /// Pressure on the film.
        PRESSURE = "pressure_Pa", "pressure", "Pa", "pressure" ("kPa"), 1e-3;
            "of film under pressure, or under gas of a volume";
        /// Volume under an inflated film.
        VOLUME = "volume_m3", "volume", "m3", "volume" ("l"), 1e3;
            "of film under pressure, or under gas of a volume";
        /// Length of all tears in stress-free film.
        TORN_LENGTH = "torn_length_m", "torn_length", "m", "torn length" ("mm"), 1e3;
            "of film with `rupture`";
            in "Length of the tears";
        /// Length × thickness of all tears.
        TORN_AREA = "torn_area_m2", "torn_area", "m2", "torn area" ("mm2"), 1e6;
            "of film with `rupture`";
        /// Energy that tears took.
        FRACTURE_ENERGY = "fracture_energy_J", "fracture_energy", "J", "energy" ("J"), 1.0;
            "of film with `rupture`";
            in "Energy that the tears took";
        /// Deflection of the highest point of an inflated film.
        DEFLECTION = "deflection_m", "deflection", "m", "deflection" ("mm"), 1e3;
            "of film under pressure, or under gas of a volume";
    }
}

/// The column `name`, which may begin with the name of one of several impactors and an underscore, and that beginning.
pub fn find(name: &str) -> Option<(&str, &'static Column)> {
    let beginning = |column: &'static Column| {
        let prefix = name.strip_suffix(column.name)?;
        (prefix.is_empty() || prefix.ends_with('_')).then_some((prefix, column))
    };
    // Some names end like two columns, e.g. `contact_force_N`: the longer one is meant.
    COLUMNS.iter().filter_map(beginning).min_by_key(|(prefix, _)| prefix.len())
}

/// Dimension of a column or a figure, by the end of its name; none of a number without unit.
pub fn dimension(name: &str) -> Option<Dimension> {
    let of_column = find(name).map(|(_, column)| column.unit);
    let fits = |dimension: &&Dimension| match of_column {
        Some(unit) => dimension.unit == unit,
        None => !dimension.suffix().is_empty() && name.ends_with(&format!("_{}", dimension.suffix())),
    };
    DIMENSIONS.iter().filter(fits).max_by_key(|dimension| dimension.suffix().len()).copied()
}

#[cfg(test)]
mod tests {
    use super::*;
    use base::units::Unit;

    #[test]
    fn names_end_with_their_unit_and_differ() {
        for (place, column) in COLUMNS.iter().enumerate() {
            let suffix = column.unit.replace('/', "_");
            assert!(suffix.is_empty() || column.name.ends_with(&format!("_{suffix}")), "{}", column.name);
            let others = &COLUMNS[..place];
            assert!(others.iter().all(|other| other.name != column.name && other.short != column.short));
        }
    }

    #[test]
    fn names_may_begin_with_that_of_an_impactor() {
        let found = |name| find(name).map(|(prefix, column)| (prefix, column.name));
        assert_eq!(found("contact_force_N"), Some(("", "contact_force_N")));
        assert_eq!(found("left_hand_contact_force_N"), Some(("left_hand_", "contact_force_N")));
        assert_eq!(found("head_displacement_x_m"), Some(("head_", "displacement_x_m")));
        assert_eq!((found("overstrain"), found("head_")), (None, None));
    }

    #[test]
    fn the_factor_is_that_of_the_units() {
        let scale = |symbol: &str| match symbol.replace('²', "2").as_str() {
            "" | "number" => 1.0,
            "%" => 0.01,
            symbol => Unit::parse(symbol).unwrap().to_si(1.0),
        };
        for Column { name, unit, axis, axis_unit, factor, .. } in COLUMNS {
            let expected = scale(unit) / scale(axis_unit);
            assert!((factor / expected - 1.0).abs() < 1e-12, "{name}: {expected}");
            assert!(axis.ends_with(&format!(" ({axis_unit})")), "{axis}");
        }
    }
}
