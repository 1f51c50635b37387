//! What reading, filtering and rating recordings report, by code.

use std::fmt;

use serde_json::{Map, Value};
use thiserror::Error;

use super::curve::Curve;
use base::codes;
use base::diagnostic::listed;
use base::finding::{Code, Report};
use base::number::significant;

codes! {
    VIRTUAL_RECORDING = "virtual-recording", Warning,
        "a recording is virtual, as its file states: it was computed, nothing was measured; of a script, one that it \
         read or that its scenarios are compared with",
        "use its figures to try a procedure, not as measured values; agreement with it is not a validation";
    NO_HEADER = "no-header", Note,
        "a table has no line of column names, so its columns are numbered and the first holds the time",
        "write a header, or name the columns with --columns";
    NO_TIME_COLUMN = "no-time-column", Note,
        "a table has no column of time, so its columns are read as values alone",
        "name the column of time with --time where there is one";
    TIME_UNIT_ASSUMED = "time-unit-assumed", Warning,
        "the file states no unit of time; its times are read as seconds",
        "write the unit into the header, e.g. `time [ms]`";
    UNKNOWN_UNIT = "unknown-unit", Warning,
        "the unit of a channel is not stated or not known; its values are not converted to SI",
        "write a known unit into the file, or give it with --unit";
    SKIPPED_LINES = "skipped-lines", Warning,
        "lines that hold neither a header entry nor values were not read",
        "check the lines that the message names";
    UNKNOWN_FILTER_CLASS = "unknown-filter-class", Warning,
        "the header states a channel frequency class that is not a number",
        "correct the header, e.g. `CFC 1000`";
    UNREADABLE_CHANNEL = "unreadable-channel", Warning,
        "another channel of the same ISO-MME test cannot be read",
        "correct its file; the channel that was asked for is not affected";
    NO_TEST_FILE = "no-test-file", Note,
        "an ISO-MME container has no test file (.mme), so nothing is known of the test",
        "add the file where it exists";
    NO_CHANNEL_LIST = "no-channel-list", Note,
        "an ISO-MME container has no list of its channels (.chn), so a missing channel is not noticed",
        "add the file where it exists";
    CHANNEL_LIST_DIFFERS = "channel-list-differs", Warning,
        "the list of channels (.chn) does not agree with the channel files",
        "check whether channel files are missing";
    SAMPLE_COUNT_MISSING = "sample-count-missing", Note,
        "the header of a channel does not state its number of samples, so a truncated file is not noticed",
        "add `Number of samples` to the header";
    TIME_AXIS_ASSUMED = "time-axis-assumed", Warning,
        "the header of a channel does not state how its times are given; equal steps from its first sample are assumed",
        "add `Reference channel` and `Time of first sample` to the header";
    EXTREME_DIFFERS = "extreme-differs", Warning,
        "the extremes that the header of a channel states are not those of its samples",
        "check whether the file was changed after its header was written";
    UNUSUAL_FILTER_CLASS = "unusual-filter-class", Note,
        "this channel frequency class is not one of ISO 6487 and SAE J211-1",
        "use 60, 180, 600 or 1000 where figures are to be compared with others";
    FILTERED_BEFORE = "filtered-before", Warning,
        "a channel is filtered that passed a channel filter before it was recorded, as its file states",
        "do not filter it again; two filters have a lower cut-off frequency than one";
    ALIASING = "aliasing", Warning,
        "a series was resampled to fewer samples without an anti-aliasing filter",
        "filter the series first, or resample to a higher rate";
    NO_POSITIVE_LEVEL = "no-positive-level", Warning,
        "no positive level is exceeded for the time of the clip",
        "turn the sign so that a deceleration is positive, or give the resultant";
    CURVE_RESAMPLED = "curve-resampled", Note,
        "a curve was interpolated linearly at 10 kHz before it was rated, without an anti-aliasing filter",
        "record or filter both curves at 10 kHz";
    CURVE_CUT = "curve-cut", Note,
        "a curve was rated over the time that both curves cover, not over all of its samples",
        "nothing, if the interval in common is the one to be rated";
    CONSTANT_CURVE = "constant-curve", Warning,
        "the rated curve is constant, so it correlates with the reference at no shift better than at another",
        "check the channel";
}

/// The largest or the smallest value of a channel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Extreme {
    /// The largest.
    Maximum,
    /// The smallest.
    Minimum,
}

impl fmt::Display for Extreme {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Extreme::Maximum => "maximum",
            Extreme::Minimum => "minimum",
        })
    }
}

/// What reading, filtering or rating a recording reports although it continues.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum Warning {
    /// The file marks its recording as virtual.
    #[error("{comment}")]
    VirtualRecording {
        /// The comment that says so.
        comment: String,
    },
    /// A table without a line of names.
    #[error("the file has no header; its columns are called {}", columns.join(", "))]
    NoHeader {
        /// The names given to the columns.
        columns: Vec<String>,
    },
    /// A table without a column of time.
    #[error("there is no column of time")]
    NoTimeColumn,
    /// Times without unit.
    #[error("time (`{channel}`) has no unit; seconds are assumed")]
    TimeUnitAssumed {
        /// The channel of time.
        channel: String,
    },
    /// A unit that is not known.
    #[error("the unit `{unit}` of `{channel}` is not known; its values are as written")]
    UnknownUnit {
        /// The channel.
        channel: String,
        /// As the file writes it.
        unit: String,
    },
    /// A channel of which the header gives no unit.
    #[error("{channel}: no unit is stated; its values are as written")]
    NoUnit {
        /// The channel.
        channel: String,
    },
    /// A recording without a length, and channels that could be one.
    #[error("the unit of {} is not known, so none of them counts as a laser", listed(channels))]
    LaserUnitMissing {
        /// The channels without a known unit.
        channels: Vec<String>,
    },
    /// Comments among the rows of a table.
    #[error("lines below the first row that start with `#` are left out: {count}, the first is line {first}")]
    SkippedComments {
        /// Number of lines.
        count: usize,
        /// The first of them, counted from one.
        first: usize,
    },
    /// Blank lines among the rows of a table.
    #[error("lines below the first row that are blank are left out: {count}, the first is line {first}")]
    SkippedBlanks {
        /// Number of lines.
        count: usize,
        /// The first of them, counted from one.
        first: usize,
    },
    /// Lines of an ISO-MME header that are none.
    #[error("{file}: lines without a colon are left out: {count}, the first is line {first}")]
    SkippedHeaderLines {
        /// Name of the file.
        file: String,
        /// Number of lines.
        count: usize,
        /// The first of them, counted from one.
        first: usize,
    },
    /// A channel frequency class that is not a number.
    #[error("{channel}: the channel frequency class `{stated}` is not known")]
    UnknownFilterClass {
        /// The channel.
        channel: String,
        /// As the header writes it.
        stated: String,
    },
    /// A channel of the same test that cannot be read.
    #[error("a channel beside it cannot be read: {error}")]
    UnreadableChannel {
        /// Why.
        error: String,
    },
    /// An ISO-MME container without a test file.
    #[error("there is no test (.mme)")]
    NoTestFile,
    /// An ISO-MME container without a list of channels.
    #[error("there is no list of the channels (.chn)")]
    NoChannelList,
    /// A list of channels that disagrees with its own count.
    #[error("the list of channels states {stated} and has {listed}")]
    ChannelCountDiffers {
        /// Entries that it states.
        stated: f64,
        /// Entries of the list.
        listed: usize,
    },
    /// Channels that are listed but have no file.
    #[error("{count} of {listed} listed channels are missing; the first is {first}")]
    ListedChannelsMissing {
        /// Channels without a file.
        count: usize,
        /// Entries of the list.
        listed: usize,
        /// Code of the first that is missing.
        first: String,
    },
    /// A channel file that is not in the list.
    #[error("{channel} is not in the list of channels")]
    UnlistedChannel {
        /// The channel.
        channel: String,
    },
    /// A channel whose number of samples is not stated.
    #[error("{channel}: the number of samples is not stated; a truncated file is not noticed")]
    SampleCountMissing {
        /// The channel.
        channel: String,
    },
    /// A channel that does not state how its times are given.
    #[error("{channel}: how its time is given is not stated; implicit is assumed")]
    TimeAxisAssumed {
        /// The channel.
        channel: String,
    },
    /// A channel with an implicit time axis that does not state where it starts.
    #[error("{channel}: the time of the first sample is not stated; 0 is assumed")]
    FirstTimeAssumed {
        /// The channel.
        channel: String,
    },
    /// A stated extreme that the samples do not have.
    #[error(
        "{channel}: the header states the {extreme} {}, the samples have {}",
        significant(*stated, 9), significant(*found, 9)
    )]
    ExtremeDiffers {
        /// The channel.
        channel: String,
        /// Which of the two.
        extreme: Extreme,
        /// As the header states it, in the unit of the file.
        stated: f64,
        /// Of the samples, in the unit of the file.
        found: f64,
    },
    /// An extreme at another time than stated.
    #[error(
        "{channel}: the header states the {extreme} at {} s, the samples at {} s",
        significant(*stated, 9), significant(*found, 9)
    )]
    ExtremeTimeDiffers {
        /// The channel.
        channel: String,
        /// Which of the two.
        extreme: Extreme,
        /// As the header states it, s.
        stated: f64,
        /// Of the samples, s.
        found: f64,
    },
    /// A channel frequency class that no standard defines.
    #[error("CFC {class} is none of the standards' classes (1000, 600, 180, 60)")]
    UnusualFilterClass {
        /// Channel frequency class.
        class: f64,
    },
    /// A channel that was filtered before is filtered again.
    #[error("`{channel}` went through CFC {class} before, as its file states")]
    FilteredBefore {
        /// The channel.
        channel: String,
        /// Channel frequency class that its file states.
        class: f64,
    },
    /// Resampling to fewer samples.
    #[error(
        "{after} samples from {before}, interpolated without an anti-aliasing filter: faster vibrations fold into slower ones"
    )]
    Aliasing {
        /// Samples before.
        before: usize,
        /// Samples after.
        after: usize,
    },
    /// A clip of a series that stays at or below zero.
    #[error("no positive level is held that long")]
    NoPositiveLevel,
    /// A curve that was interpolated before it was rated.
    #[error(
        "{curve}: {samples} samples, read linearly between them at 10 kHz from {} s to {} s, without a filter",
        significant(*from, 9), significant(*to, 9)
    )]
    CurveResampled {
        /// Which of the two.
        curve: Curve,
        /// Samples before.
        samples: usize,
        /// Start of the interval, s.
        from: f64,
        /// End of the interval, s.
        to: f64,
    },
    /// A curve that was rated over a part of its time.
    #[error("{curve}: cut to the common {} s to {} s", significant(*from, 9), significant(*to, 9))]
    CurveCut {
        /// Which of the two.
        curve: Curve,
        /// Start of the interval, s.
        from: f64,
        /// End of the interval, s.
        to: f64,
    },
    /// A comparison that is constant.
    #[error("comparison: constant, so no shift correlates better than none")]
    ConstantCurve,
}

impl Report for Warning {
    fn code(&self) -> &'static Code {
        match self {
            Warning::VirtualRecording { .. } => &VIRTUAL_RECORDING,
            Warning::NoHeader { .. } => &NO_HEADER,
            Warning::NoTimeColumn => &NO_TIME_COLUMN,
            Warning::TimeUnitAssumed { .. } => &TIME_UNIT_ASSUMED,
            Warning::UnknownUnit { .. } | Warning::NoUnit { .. } | Warning::LaserUnitMissing { .. } => &UNKNOWN_UNIT,
            Warning::SkippedComments { .. } | Warning::SkippedBlanks { .. } | Warning::SkippedHeaderLines { .. } => {
                &SKIPPED_LINES
            }
            Warning::UnknownFilterClass { .. } => &UNKNOWN_FILTER_CLASS,
            Warning::UnreadableChannel { .. } => &UNREADABLE_CHANNEL,
            Warning::NoTestFile => &NO_TEST_FILE,
            Warning::NoChannelList => &NO_CHANNEL_LIST,
            Warning::ChannelCountDiffers { .. }
            | Warning::ListedChannelsMissing { .. }
            | Warning::UnlistedChannel { .. } => &CHANNEL_LIST_DIFFERS,
            Warning::SampleCountMissing { .. } => &SAMPLE_COUNT_MISSING,
            Warning::TimeAxisAssumed { .. } | Warning::FirstTimeAssumed { .. } => &TIME_AXIS_ASSUMED,
            Warning::ExtremeDiffers { .. } | Warning::ExtremeTimeDiffers { .. } => &EXTREME_DIFFERS,
            Warning::UnusualFilterClass { .. } => &UNUSUAL_FILTER_CLASS,
            Warning::FilteredBefore { .. } => &FILTERED_BEFORE,
            Warning::Aliasing { .. } => &ALIASING,
            Warning::NoPositiveLevel => &NO_POSITIVE_LEVEL,
            Warning::CurveResampled { .. } => &CURVE_RESAMPLED,
            Warning::CurveCut { .. } => &CURVE_CUT,
            Warning::ConstantCurve => &CONSTANT_CURVE,
        }
    }

    fn figures(&self) -> Map<String, Value> {
        let named =
            |figures: &[(&str, Value)]| figures.iter().map(|(name, v)| ((*name).to_owned(), v.clone())).collect();
        match self {
            Warning::NoHeader { columns } => named(&[("columns", columns.clone().into())]),
            Warning::LaserUnitMissing { channels } => named(&[("channels", channels.clone().into())]),
            Warning::TimeUnitAssumed { channel }
            | Warning::NoUnit { channel }
            | Warning::UnlistedChannel { channel }
            | Warning::SampleCountMissing { channel }
            | Warning::TimeAxisAssumed { channel }
            | Warning::FirstTimeAssumed { channel } => named(&[("channel", channel.as_str().into())]),
            Warning::UnknownUnit { channel, unit } => {
                named(&[("channel", channel.as_str().into()), ("unit", unit.as_str().into())])
            }
            Warning::SkippedComments { count, first }
            | Warning::SkippedBlanks { count, first }
            | Warning::SkippedHeaderLines { count, first, .. } => {
                named(&[("lines", (*count).into()), ("first_line", (*first).into())])
            }
            Warning::UnknownFilterClass { channel, stated } => {
                named(&[("channel", channel.as_str().into()), ("stated", stated.as_str().into())])
            }
            Warning::ChannelCountDiffers { stated, listed } => {
                named(&[("stated", (*stated).into()), ("listed", (*listed).into())])
            }
            Warning::ListedChannelsMissing { count, listed, first } => named(&[
                ("missing", (*count).into()),
                ("listed", (*listed).into()),
                ("first_missing", first.as_str().into()),
            ]),
            Warning::ExtremeDiffers { channel, stated, found, .. } => {
                named(&[("channel", channel.as_str().into()), ("stated", (*stated).into()), ("found", (*found).into())])
            }
            Warning::ExtremeTimeDiffers { channel, stated, found, .. } => named(&[
                ("channel", channel.as_str().into()),
                ("stated_s", (*stated).into()),
                ("found_s", (*found).into()),
            ]),
            Warning::UnusualFilterClass { class } => named(&[("class", (*class).into())]),
            Warning::FilteredBefore { channel, class } => {
                named(&[("channel", channel.as_str().into()), ("class", (*class).into())])
            }
            Warning::Aliasing { before, after } => {
                named(&[("samples_before", (*before).into()), ("samples_after", (*after).into())])
            }
            Warning::CurveResampled { curve, samples, from, to } => named(&[
                ("curve", curve.to_string().into()),
                ("samples", (*samples).into()),
                ("from_s", (*from).into()),
                ("to_s", (*to).into()),
            ]),
            Warning::CurveCut { curve, from, to } => {
                named(&[("curve", curve.to_string().into()), ("from_s", (*from).into()), ("to_s", (*to).into())])
            }
            Warning::VirtualRecording { .. }
            | Warning::NoTimeColumn
            | Warning::UnreadableChannel { .. }
            | Warning::NoTestFile
            | Warning::NoChannelList
            | Warning::NoPositiveLevel
            | Warning::ConstantCurve => Map::new(),
        }
    }
}
