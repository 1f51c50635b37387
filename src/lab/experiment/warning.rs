//! Warnings of the reduction of drops and coupons, by code.

use std::path::PathBuf;

use super::absorption::AbsorptionError;
use super::coupon::{Direction, Slack};
use crate::Error;
use crate::signal::FILTERED_BEFORE;
use base::diagnostic::shown_path;
use base::findings;
use base::number::significant;

findings! {
    /// A doubt about a reduction that continues.
    #[derive(Clone, Debug, PartialEq)]
    pub enum Warning {
        /// No laser; the drop height is known.
        NoLaser = "no-laser" as NO_LASER, Note;
            meaning "contact and impact speed come from the fall and the onset of the force, since there is no laser";
            remedy "nothing, if the height of fall, or the impact speed, is well known";
            message "no laser: contact and speed from the fall over the known height and the onset of the force";
        /// Neither laser nor drop height; the impact speed is known.
        NoLaserNoHeight = code &NO_LASER;
            message "no laser and no height: contact from the fall to the known speed and the onset of the force";
        LaserOutOfRange {
            samples: usize, "number of constant samples" => "samples";
            run: usize, "fewest equal samples in a row that count";
        } = "laser-out-of-range", Note;
            meaning "the laser repeats one value over a moving impactor; these samples count as not measured";
            remedy "nothing, if the laser holds its last value out of range; or else check its wiring";
            message "laser: {samples} constant samples, {run} or more in a row, count as out of its range";
        LaserMismatch { residual: f64, "root mean square distance, m" => "residual_m" } = "laser-mismatch", Warning;
            meaning "the motion integrated from the acceleration does not follow the laser";
            remedy "check the unit of the laser, its zero, and what it writes out of range";
            message "laser and integrated acceleration are {:.2} mm apart", 1e3 * residual;
        NoEnergyAbsorption { reason: AbsorptionError, "why" } = "no-energy-absorption", Note;
            meaning "the energy absorption cannot be computed from this recording";
            remedy "record until the impactor has left the film";
            message "no energy absorption: {reason}";
        ImpossibleAbsorption {
            absorption: f64, "as a share" => "energy_absorption";
        } = "impossible-energy-absorption", Warning;
            meaning "the energy absorption lies outside 0 to 100 %, so speed or acceleration is wrong";
            remedy "check the laser, the time constant and the zero of the accelerometer";
            message "an energy absorption of {:.1} % is impossible: laser, time constant and zero of the sensor do not \
                agree",
                100.0 * absorption;
        FasterThanFreeFall {
            excess: f64, "share of the free fall's speed" => "excess";
            height: f64, "drop height, m" => "height_m";
        } = "faster-than-free-fall", Warning;
            meaning "the impact speed exceeds that of a free fall over the drop height, which friction cannot explain";
            remedy "check the drop height and the sensitivity of the sensors";
            message "the impact speed is {:.2} % above that of a free fall over {} m",
                100.0 * excess, significant(*height, 6);
        SlowImpact { share: f64, "share of the free fall's speed" => "share" } = "slow-impact", Warning;
            meaning "the impact speed is less than half of that of a free fall over the drop height";
            remedy "check the guide, the drop height and the laser";
            message "the impact speed is {:.0} % of that of a free fall", 100.0 * share;
        DropHeightDiffers {
            what: &'static str, "height, impact speed or time of contact" => "what";
            unit: &'static str, "of both, SI" => "unit";
            found: f64, "as laser and accelerometer show it" => "found";
            stated: f64, "as stated" => "stated";
        } = "drop-height-differs", Warning;
            meaning "laser and accelerometer show another height, impact speed or time of contact than the stated one, which is not used";
            remedy "check what was stated; with a time constant that was given, check that";
            message "laser and accelerometer show a {what} of {} {unit}, not {} {unit}, which is not used",
                significant(*found, 4), significant(*stated, 6);
        LaserSpeedDiffers {
            reached: f64, "by the fall, m/s" => "reached_m_s";
            laser: f64, "with the laser, m/s" => "laser_m_s";
        } = "laser-speed-differs", Warning;
            meaning "the fall explains the stated height and the onset of the force, but not the laser, which is not used";
            remedy "check the scale of the laser, its unit and its place";
            message "the impactor reaches {reached:.3} m/s at contact by the fall, {laser:.3} m/s with the laser, which is not used";
        LaserContactDiffers {
            laser: f64, "time of contact with the laser, s" => "laser_s";
            force: f64, "as release, height and onset of the force show it without the laser, s" => "force_s";
            held: bool, "whether intervals hold both";
        } = "laser-contact-differs", Warning;
            meaning "release, height and the onset of the force show another time of contact than the laser, by more than their errors; \
                intervals hold both where the message says so";
            remedy "check the zero of the laser, which counts from the film's upper face, and the height; `--without-laser` leaves it \
                out";
            message "the force sets in {:.1} ms {} the contact that the laser shows, at {laser:.4} s{}",
                1e3 * (laser - force).abs(), if force < laser { "before" } else { "after" },
                if *held { ": intervals hold both" } else { "" };
        GuideFrictionChanges {
            friction: [f64; 2], "at the release and at contact, N"
                => "friction_at_release_N" = friction[0], "friction_at_contact_N" = friction[1];
        } = "guide-friction-changes", Note;
            meaning "the guide's friction grows with the speed of the fall";
            remedy "none is needed: intervals allow for it; its line of a scenario has `per_speed`";
            message "the guide's friction changes from {:.1} N at the release to {:.1} N at contact", friction[0], friction[1];
        DcCoupled { at_least: f64, "least time constant, s" => "time_constant_at_least_s" } = "dc-coupled", Note;
            meaning "the recording does not tell the sensor from one that holds a constant: it is DC-coupled, or its time constant is \
                longer than the recording shows; intervals hold both";
            remedy "give the time constant of the sensor's data sheet where it has one";
            message "the sensor holds a constant (DC-coupled), or has a time constant above {} s", significant(*at_least, 2);
        ClassOfRate {
            class: Option<f64>, "channel frequency class" => "class";
            rate: f64, "samples a second" => "rate_1_s";
        } = "class-of-rate", Note;
            meaning "the channel frequency class is the highest that the rate of the samples allows, below 1000: peaks of one class are \
                not those of another";
            remedy "record with at least 10 000 samples a second, or filter all recordings with the class of the slowest";
            message "{} is the highest class that {rate:.0} samples a second allow",
                class.map_or_else(|| "no filter".to_owned(), |class| format!("CFC {class}"));
        ZeroDrift {
            rate: f64, "slope of the reading at rest, m/s³" => "rate_m_s3";
            over_record: f64, "drift from the first to the last sample at that slope, m/s²" => "over_record_m_s2";
        } = "zero-drift", Warning;
            meaning "the reading of the accelerometer drifts while the impactor is at rest";
            remedy "let the sensor warm up; integrated speed and displacement drift with it";
            message "the reading at rest drifts by {rate:.2} m/s² per second, {over_record:.2} m/s² over the record";
        LatePeak {
            peak: f64, "time of the largest acceleration, s from contact" => "peak_s";
            lowest_point: f64, "time of the lowest point, s from contact" => "lowest_point_s";
        } = "late-peak", Warning;
            meaning "the largest acceleration comes well after the lowest point, so it is not that of the impact";
            remedy "shorten the recording to the impact";
            message "the largest acceleration, at {:.1} ms, is not that of the impact, whose lowest point is at {:.1} \
                ms",
                1e3 * peak, 1e3 * lowest_point;
        Saturated {
            reading: f64, "the largest reading, m/s²" => "reading_m_s2";
            start: f64, "first time of this reading on the recording's clock, s" => "start_s";
            duration: f64, "time for which it stays, s" => "duration_s";
            peak: f64, "largest filtered acceleration of the clipped signal, m/s²: the true one is not smaller"
                => "peak_acceleration_at_least_m_s2";
            deepest: f64, "where the clipped signal first stops to descend, m: the true lowest point is not deeper; none where it does not"
                => "peak_displacement_at_least_m";
        } = "saturated-accelerometer", Warning;
            meaning "the accelerometer stays at its largest reading, which may be the end of its range; figures that \
                rest on these samples are withheld, the peak is a bound, and so is the displacement where the impactor turns";
            remedy "use a larger range; contact and impact speed hold, since they precede the samples";
            message "the accelerometer reads {reading:.1} m/s² for {:.1} ms from {start:.4} s on, which may be the end \
                of its range: figures that rest on it are withheld",
                1e3 * duration;
        GapBridged {
            count: usize, "number of gaps" => "gaps";
            after: f64, "time of the last sample before the longest, s" => "after_s";
            duration: f64, "duration of the longest, s" => "duration_s";
        } = "gap-bridged", Warning;
            meaning "gaps of the acceleration are bridged by straight lines, as was asked for";
            remedy "record again where a gap lies in the impact, since the peak and all integrals after it depend on \
                it";
            message "acceleration: {}, {} ms after {} s",
                bridged(*count), significant(1e3 * duration, 6), significant(*after, 6);
        FilteredAlready { class: f64, "channel frequency class that the file states" => "class" }
            = "not-filtered-again", Note;
            meaning "the acceleration passed a channel filter before it was recorded, as its file states, and the \
                reduction does not filter it again; where it does, that is `filtered-before`";
            remedy "none is needed; its cut-off frequency is that of the stated class";
            message "the acceleration went through CFC {class} before, as its file states, and is not filtered again";
        /// The acceleration was filtered before and is filtered again.
        FilteredAgain {
            class: f64, "channel frequency class that the file states" => "class";
            again: f64, "that of the reduction";
        } = code &FILTERED_BEFORE;
            message "the acceleration went through CFC {class} before, as its file states, and is filtered again with \
                CFC {again}";
        RecordEndsUnderLoad {
            paths: Vec<PathBuf>, "the recordings" => "files" = shown(paths);
        } = "record-ends-under-load", Warning;
            meaning "a coupon was still under load at the end of its recording, which counts as its break";
            remedy "record until the coupon breaks; strength and elongation may be too small";
            message "the record ends under load, and its end counts as the break: {}", shown(paths).join("; ");
        SlackAtStart {
            paths: Vec<PathBuf>, "the recordings" => "files" = shown(paths);
            slack: Vec<Slack>, "what is slack, and the modulus without it"
                => "slack_strain" = slack.iter().map(|slack| slack.strain).collect::<Vec<_>>(),
                "young_modulus_without_Pa" = slack.iter().map(|slack| slack.modulus).collect::<Vec<_>>();
            moduli: Vec<f64>, "with it, Pa" => "young_modulus_Pa";
        } = "slack-at-start", Warning;
            meaning "a coupon hangs slack, or seats itself in the jaws, before it is strained: its curve begins much less steep than it \
                goes on, so that modulus, yield points and break elongation are wrong";
            remedy "give `--toe`, which counts strain from where the line of the steepest part meets zero stress (ISO 527-1, ASTM \
                D882)";
            message "{} {} slack at the start: the modulus is {} MPa, with --toe {} MPa", shown(paths).join("; "),
                if paths.len() == 1 { "has" } else { "have" }, megapascals(moduli.iter().copied()),
                megapascals(slack.iter().map(|slack| slack.modulus));
        SaturatedLoadCell {
            paths: Vec<PathBuf>, "the recordings" => "files" = shown(paths);
            forces: Vec<f64>, "the largest ones, N" => "force_N";
        } = "saturated-load-cell", Warning;
            meaning "the force of a coupon rises, and then stays exactly at its largest value: it may be the end of the load cell's \
                range, so that strength, stress at the break and yield points are too low";
            remedy "pull again with a larger load cell, or leave the recording out";
            message "the force stays at its largest value, {} N, which may be the end of the load cell's range: {}",
                each(forces, 4), shown(paths).join("; ");
        ForceAfterBreak {
            paths: Vec<PathBuf>, "the recordings" => "files" = shown(paths);
            forces: Vec<f64>, "what is left, N" => "force_N";
        } = "force-after-break", Warning;
            meaning "a force stays after a coupon broke: the zero of the load cell is off, and all stresses with it, or the coupon did \
                not break whole";
            remedy "subtract the force from the recording where it is the zero; else measure again";
            message "{} N stay after the break, so that the zero of the load cell may be off: {}",
                each(forces, 3), shown(paths).join("; ");
        ImplausibleCoupon {
            paths: Vec<PathBuf>, "the recordings" => "files" = shown(paths);
            what: &'static str, "the figure" => "what";
            unit: &'static str, "of the figures" => "unit";
            found: Vec<f64>, "the figures" => "found";
            likely: [f64; 2], "what films have" => "likely";
        } = "implausible-coupon", Warning;
            meaning "thickness, Young's modulus or strength of a coupon are none that films have: a dimension or a unit is wrong";
            remedy "check `--thickness`, `--width`, `--gauge` and the units of the channels";
            message "the {what} of {} is {} {unit}, films have {} to {} {unit}", shown(paths).join("; "), each(found, 2),
                significant(likely[0], 4), significant(likely[1], 4);
        SpeedStatedOtherwise {
            paths: Vec<PathBuf>, "the recordings" => "files" = shown(paths);
            stated: Vec<f64>, "by names or headers, m/s" => "stated_m_s";
            measured: Vec<f64>, "by time and travel, m/s" => "measured_m_s";
        } = "speed-stated-otherwise", Warning;
            meaning "the name or the header of a coupon's recording states another speed of the jaws than its time and travel show";
            remedy "correct the name or the header, or give --velocity; the speed of time and travel counts";
            message "time and travel show {} m/s, name or header state {} m/s, which is not used: {}",
                speeds(measured), speeds(stated), shown(paths).join("; ");
        HeadReplaced {
            path: PathBuf, "the recording" => "file" = shown_path(path);
            what: String, "what replaces what";
        } = "head-replaced", Note;
            meaning "an option was given in place of what the head of a machine's export states";
            remedy "leave the option out to use what the file states";
            message "{}: {what}", shown_path(path);
        SpecimensDiffer {
            dimension: &'static str, "the dimension" => "dimension";
            least: f64, "of the specimens, m" => "least_m";
            most: f64, "of the specimens, m" => "most_m";
        } = "specimens-differ", Note;
            meaning "coupons have different dimensions, each reduced by its own; the material file states their mean";
            remedy "nothing, if they differ as much as they were measured to";
            message "the {dimension} of the specimens is {} to {} mm; the material states the mean",
                significant(1e3 * least, 4), significant(1e3 * most, 4);
        MergedSamples {
            path: PathBuf, "the recording" => "file" = shown_path(path);
            samples: usize, "number of samples" => "samples";
        } = "merged-samples", Note;
            meaning "samples between which the displacement of the jaws did not increase were merged";
            remedy "nothing, if they are few";
            message "{}: {samples} samples are merged with others, since the displacement did not increase",
                shown_path(path);
        NoYieldPoints {
            direction: Direction, "of the film" => "direction" = direction.to_string();
            reason: Error, "why";
        } = "no-yield-points", Note;
            meaning "the mean curve of a direction has no double yield point, so the material takes the curve itself";
            remedy "nothing, or choose another window for the modulus";
            message "{direction}: {reason}";
        ShearCurveEnds {
            angle: f64, "last one of the curve, rad" => "angle_rad";
            strain: f64, "of the coupons there" => "strain";
            reached: f64, "strain of the coupons' mean curve at its end" => "strain_reached";
            off: [f64; 2], "strain at which the law is furthest off the coupons' mean curve, and by which share of the stress"
                => "strain_of_largest_error" = off[0], "largest_error" = off[1];
        } = "shear-curve-ends", Warning;
            meaning "the shear curve from the coupons of D3 ends at a small part of the strain that they reached, since the fabric of \
                their fibres cannot follow them further; beyond its end the curve goes on with its last slope, and film of the \
                material does not follow its own coupons at 45°";
            remedy "fit a law to the coupons by `calibrate` (an isotropic or plastic one for film alike in all directions), give a \
                shear curve by `--shear`, or use the material up to this strain alone";
            message "the shear curve ends at {} rad, a strain of {} of the coupons of D3, which reached {}; beyond, film of this \
                material is up to {:+.0} % off their stress (at a strain of {})",
                significant(*angle, 3), significant(*strain, 2), significant(*reached, 3), 100.0 * off[1],
                significant(off[0], 2);
        DirectionsNotUsed {
            directions: Vec<Direction>, "of the film" => "directions" = directions.iter().map(Direction::to_string).collect::<Vec<_>>();
        } = "directions-not-used", Warning;
            meaning "the material that is written takes the curves of MD and TD and its shear from D3; coupons at other angles are \
                reduced, and count in nothing of it";
            remedy "`calibrate` fits one law to coupons at any angles (scripts/coupons-at-angles.rhai), and says how far it is off \
                at each";
            message "coupons of {} are in no curve of the material that is written",
                directions.iter().map(Direction::to_string).collect::<Vec<_>>().join(", ");
        SpeedNotMeasured {
            direction: Direction, "of the film" => "direction" = direction.to_string();
            velocity: f64, "speed of the jaws, m/s" => "velocity_m_s";
        } = "speed-not-measured", Note;
            meaning "a direction was not measured at a speed at which others were, so their means are over other \
                speeds";
            remedy "measure it, or leave out the speed for all directions";
            message "{direction} was not measured at {} m/s", significant(*velocity, 6);
        NoAbsorption = "no-absorption", Note;
            meaning "the material file states no energy absorption, since coupons pulled to their break do not show \
                it; film of this material returns all energy on unloading";
            remedy "set `absorption` in the file from a drop test (`droptower reduce drop` prints it)";
            message "the material file has no `absorption`: coupons pulled to their break do not show the energy \
                absorbed on unloading, so a run returns all of it";
        DensityAssumed = "density-assumed", Warning;
            meaning "no density was given, so the material file states that of LLDPE";
            remedy "give --density";
            message "the density in the material file is assumed (LLDPE)";
        PoissonAssumed { poisson: f64, "as assumed" => "poisson" } = "poisson-assumed", Warning;
            meaning "no Poisson's ratio was given, so the material file states one that is assumed";
            remedy "give --poisson";
            message "Poisson's ratio in the material file is assumed: {}", significant(*poisson, 3);
        CapAssumed = "cap-assumed", Note;
            meaning "a bulge is reduced as a spherical cap that is strained evenly, while film at its top is strained more than \
                near the clamp and curved otherwise, by how much depends on how easily it shears";
            remedy "none is needed for a first value; `calibrate` with the inflation as a test follows film as it is \
                (scripts/find-coupling.rhai)";
            message "a bulge is taken as a spherical cap: below yield the coupling of a fabric is off by up to 0.12, that of \
                isotropic film by 0.17 (stress by 11 %)";
        WidthHeld { test: String, "the recording" => "test" } = "width-held", Note;
            meaning "a coupon whose width is held has the coupling of a fabric at half of its strain; film of another law shows \
                less there than under equal strains: isotropic elastic film with Poisson's ratio 0.44 shows 0.48 in place of 0.79";
            remedy "compare it with a bulge; where both differ, film does not couple as a fabric does, and the value of the test that \
                strains film as the impact will is the one to take";
            message "{test}: the width is held: film that is no fabric has more coupling under equal strains (isotropic film: 0.79 \
                where 0.48 is seen here)";
        CouponEdges {
            test: String, "the recording" => "test";
            ratio: f64, "width over length" => "width_over_length";
            ends: [f64; 2], "coupling with free edges as short and as long as they can be"
                => "coupling_low" = ends[0], "coupling_high" = ends[1];
        } = "coupon-edges", Note;
            meaning "free edges of a wide coupon contract and carry less, so that its coupling is too low by at most half of its \
                length over its width";
            remedy "pull coupons that are ten times as wide as long, or let `calibrate` run the coupon with its edges \
                (scripts/find-coupling.rhai)";
            message "{test}: {} times as wide as long: the coupling is {} to {} with its free edges",
                significant(*ratio, 3), significant(ends[0], 3), significant(ends[1], 3);
        CouplingDoubtful {
            test: String, "the recording" => "test";
            coupling: f64, "as it would be" => "coupling";
            left: f64, "root mean square of what is left of the stress, over it" => "relative_rms";
        } = "coupling-doubtful", Warning;
            meaning "no film couples like that: below zero, above 1.2, or with a tenth of the stress left over; curves, thickness, a \
                unit or the film is another one than that of the test";
            remedy "check `--film`, the thickness and the units, and that the curves were measured at the rate of the test";
            message "{test}: no coupling of MD and TD explains the test: {}, and {:.0} % of its stress would be left",
                match *coupling {
                    value if value < 0.0 => format!("it would be {}, below zero", significant(value, 3)),
                    value => format!("it would be {}, where films have up to 1.2", significant(value, 3)),
                },
                100.0 * left;
        CouplingVaries {
            test: String, "the recording" => "test";
            at: [[f64; 2]; 2], "strain and coupling where it is least and largest"
                => "strain_of_least" = at[0][0], "least" = at[0][1], "strain_of_largest" = at[1][0], "largest" = at[1][1];
        } = "coupling-varies", Warning;
            meaning "the coupling that a test shows changes with its strain, so that one number, as a fabric has it, does not \
                follow the test";
            remedy "take the coupling at the strains of the test that is to be simulated, or another law: an isotropic or \
                plastic one, fitted to the curves";
            message "{test}: the coupling is {} at a strain of {} and {} at {}: one number does not follow the test",
                significant(at[0][1], 2), significant(at[0][0], 2), significant(at[1][1], 2), significant(at[1][0], 2);
        CurvesEnd {
            test: String, "the recording" => "test";
            end: f64, "last strain" => "strain";
        } = "curves-end", Note;
            meaning "the curves of MD and TD end before the test does; its samples beyond are left out of the coupling";
            remedy "none is needed where the strains of interest are below; otherwise measure the curves farther";
            message "{test}: the curves of the film end at a strain of {}; samples beyond are left out", significant(*end, 3);
        CouponHeldInWidth { ratio: f64, "largest width over length" => "width_over_length" } = "coupon-held-in-width", Note;
            meaning "jaws hold the width of a coupon that is not long for it, so that its curve carries a part of the coupling of \
                MD and TD, and a coupling that is added to such curves counts twice";
            remedy "measure the coupling (`reduce wide`, `reduce bulge`) against curves of coupons that are at least twice as long \
                as wide, or find curves and coupling in one calibration";
            message "coupons of MD or TD are {} times as wide as long: the jaws hold their width in part, and their curves carry a part \
                of the coupling of MD and TD", significant(*ratio, 3);
        MaterialIncomplete { keys: String, "the keys in words" => "keys" } = "material-incomplete", Warning;
            meaning "the material file lacks keys that a material needs, since they were not given: a scenario cannot \
                use it before they are written";
            remedy "give --density and --thickness, or write them into the file or into the scenario that names it";
            message "the material file lacks {keys}: not given";
    }
}

fn shown(paths: &[PathBuf]) -> Vec<String> {
    paths.iter().map(|path| shown_path(path)).collect()
}

/// Values with so many digits, as many as there are.
fn each(values: &[f64], digits: usize) -> String {
    values.iter().map(|value| significant(*value, digits)).collect::<Vec<_>>().join(", ")
}

/// Speeds, each once.
fn speeds(speeds: &[f64]) -> String {
    let mut words: Vec<String> = speeds.iter().map(|speed| significant(*speed, 3)).collect();
    words.dedup();
    words.join(", ")
}

/// Stresses (Pa) in MPa.
fn megapascals(stresses: impl Iterator<Item = f64>) -> String {
    stresses.map(|stress| format!("{:.1}", 1e-6 * stress)).collect::<Vec<_>>().join(", ")
}

fn bridged(count: usize) -> String {
    match count {
        1 => "a gap is bridged by a straight line".into(),
        several => format!("{several} gaps are bridged by straight lines, the longest"),
    }
}
