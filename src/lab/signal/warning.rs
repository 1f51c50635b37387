//! Warnings of reading, filtering and rating recordings, by code.

use base::diagnostic::listed;
use base::number::significant;
use base::{findings, words};

words! {
    /// The largest or the smallest value of a channel.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum Extreme {
        /// The largest.
        Maximum = "maximum",
        /// The smallest.
        Minimum = "minimum",
    }
}

findings! {
    /// A doubt about a recording that is read, filtered or rated nevertheless.
    #[derive(Clone, Debug, PartialEq)]
    pub enum Warning {
        VirtualRecording {
            comment: String, "the comment that says so";
        } = "virtual-recording" as VIRTUAL_RECORDING, Warning;
            meaning "a recording is virtual, as its file states: it was computed, nothing was measured; of a script, \
                one that it read or that its scenarios are compared with";
            remedy "use its figures to try a procedure, not as measured values; agreement with it is not a validation";
            message "{comment}";
        NoHeader { columns: Vec<String>, "the names given to the columns" => "columns" } = "no-header", Note;
            meaning "a table has no line of column names, so its columns are numbered and the first holds the time";
            remedy "write a header, or name the columns with --columns";
            message "the file has no header; its columns are called {}", columns.join(", ");
        NoTimeColumn = "no-time-column", Note;
            meaning "a table has no column of time, so its columns are read as values alone";
            remedy "name the column of time with --time where there is one";
            message "there is no column of time";
        TimeUnitAssumed { channel: String, "the channel of time" => "channel" } = "time-unit-assumed", Warning;
            meaning "the file states no unit of time; its times are read as seconds";
            remedy "write the unit into the header, e.g. `time [ms]`";
            message "time (`{channel}`) has no unit; seconds are assumed";
        /// A unit that is not known.
        UnknownUnit {
            channel: String, "the channel" => "channel";
            unit: String, "as the file writes it" => "unit";
        } = "unknown-unit" as UNKNOWN_UNIT, Warning;
            meaning "the unit of a channel is not stated or not known; its values are not converted to SI";
            remedy "write a known unit into the file, or give it with --unit";
            message "the unit `{unit}` of `{channel}` is not known; its values are as written";
        /// A channel of which the header gives no unit.
        NoUnit { channel: String, "the channel" => "channel" } = code &UNKNOWN_UNIT;
            message "{channel}: no unit is stated; its values are as written";
        /// A recording without a length, and channels that could be one.
        LaserUnitMissing {
            channels: Vec<String>, "the channels without a known unit" => "channels";
        } = code &UNKNOWN_UNIT;
            message "the unit of {} is not known, so none of them counts as a laser", listed(channels);
        /// Comments among the rows of a table.
        SkippedComments {
            count: usize, "number of lines" => "lines";
            first: usize, "the first of them, counted from one" => "first_line";
        } = "skipped-lines" as SKIPPED_LINES, Warning;
            meaning "lines that hold neither a header entry nor values were not read";
            remedy "check the lines that the message names";
            message "lines below the first row that start with `#` are left out: {count}, the first is line {first}";
        /// Blank lines among the rows of a table.
        SkippedBlanks {
            count: usize, "number of lines" => "lines";
            first: usize, "the first of them, counted from one" => "first_line";
        } = code &SKIPPED_LINES;
            message "lines below the first row that are blank are left out: {count}, the first is line {first}";
        /// Lines of an ISO-MME header that are none.
        SkippedHeaderLines {
            file: String, "name of the file";
            count: usize, "number of lines" => "lines";
            first: usize, "the first of them, counted from one" => "first_line";
        } = code &SKIPPED_LINES;
            message "{file}: lines without a colon are left out: {count}, the first is line {first}";
        UnknownFilterClass {
            channel: String, "the channel" => "channel";
            stated: String, "as the header writes it" => "stated";
        } = "unknown-filter-class", Warning;
            meaning "the header states a channel frequency class that is not a number";
            remedy "correct the header, e.g. `CFC 1000`";
            message "{channel}: the channel frequency class `{stated}` is not known";
        UnreadableChannel { error: String, "why" } = "unreadable-channel", Warning;
            meaning "another channel of the same ISO-MME test cannot be read";
            remedy "correct its file; the channel that was asked for is not affected";
            message "a channel beside it cannot be read: {error}";
        ChannelNotRead {
            channel: String, "the channel" => "channel";
            why: String, "why";
        } = "channel-not-read", Note;
            meaning "a channel of a file is left out: it holds no numbers, no samples or no time, or scales that are not known";
            remedy "name the channels that are needed with --column, or see why this one is left out";
            message "{channel} is left out: {why}";
        TruncatedFile { missing: u64, "bytes that its last part lacks; 0 where it does not state them" => "missing_bytes" }
            = "truncated-file", Warning;
            meaning "a file ends within its last part, as when the recorder was stopped; the samples before the end are read";
            remedy "check whether the file was copied as a whole";
            message "the file ends within its last segment{}", match missing {
                0 => String::new(),
                missing => format!("; {missing} bytes are missing"),
            };
        StartTimesDiffer {
            first: String, "a channel" => "first";
            other: String, "a channel that starts at another time" => "other";
            apart: f64, "from one start to the other, s" => "apart_s";
        } = "start-times-differ", Warning;
            meaning "channels of one file started at different times of the day; each is counted from its own start";
            remedy "compare only channels that started together";
            message "{first} and {other} start {} s apart; each is counted from its own start", significant(*apart, 6);
        NoTestFile = "no-test-file", Note;
            meaning "an ISO-MME container has no test file (.mme), so nothing is known of the test";
            remedy "add the file where it exists";
            message "there is no test (.mme)";
        NoChannelList = "no-channel-list", Note;
            meaning "an ISO-MME container has no list of its channels (.chn), so a missing channel is not noticed";
            remedy "add the file where it exists";
            message "there is no list of the channels (.chn)";
        /// A list of channels that disagrees with its own count.
        ChannelCountDiffers {
            stated: f64, "entries that it states" => "stated";
            listed: usize, "entries of the list" => "listed";
        } = "channel-list-differs" as CHANNEL_LIST_DIFFERS, Warning;
            meaning "the list of channels (.chn) does not agree with the channel files";
            remedy "check whether channel files are missing";
            message "the list of channels states {stated} and has {listed}";
        /// Channels that are listed but have no file.
        ListedChannelsMissing {
            count: usize, "channels without a file" => "missing";
            listed: usize, "entries of the list" => "listed";
            first: String, "code of the first that is missing" => "first_missing";
        } = code &CHANNEL_LIST_DIFFERS;
            message "{count} of {listed} listed channels are missing; the first is {first}";
        /// A channel file that is not in the list.
        UnlistedChannel { channel: String, "the channel" => "channel" } = code &CHANNEL_LIST_DIFFERS;
            message "{channel} is not in the list of channels";
        SampleCountMissing { channel: String, "the channel" => "channel" } = "sample-count-missing", Note;
            meaning "the header of a channel does not state its number of samples, so a truncated file is not noticed";
            remedy "add `Number of samples` to the header";
            message "{channel}: the number of samples is not stated; a truncated file is not noticed";
        /// A channel that does not state how its times are given.
        TimeAxisAssumed {
            channel: String, "the channel" => "channel";
        } = "time-axis-assumed" as TIME_AXIS_ASSUMED, Warning;
            meaning "the header of a channel does not state how its times are given; equal steps from its first sample \
                are assumed";
            remedy "add `Reference channel` and `Time of first sample` to the header";
            message "{channel}: how its time is given is not stated; implicit is assumed";
        /// A channel with an implicit time axis that does not state where it starts.
        FirstTimeAssumed { channel: String, "the channel" => "channel" } = code &TIME_AXIS_ASSUMED;
            message "{channel}: the time of the first sample is not stated; 0 is assumed";
        /// A stated extreme that the samples do not have.
        ExtremeDiffers {
            channel: String, "the channel" => "channel";
            extreme: Extreme, "which of the two";
            stated: f64, "as the header states it, in the unit of the file" => "stated";
            found: f64, "of the samples, in the unit of the file" => "found";
        } = "extreme-differs" as EXTREME_DIFFERS, Warning;
            meaning "the extremes that the header of a channel states are not those of its samples";
            remedy "check whether the file was changed after its header was written";
            message "{channel}: the header states the {extreme} {}, the samples have {}",
                significant(*stated, 9), significant(*found, 9);
        /// An extreme at another time than stated.
        ExtremeTimeDiffers {
            channel: String, "the channel" => "channel";
            extreme: Extreme, "which of the two";
            stated: f64, "as the header states it, s" => "stated_s";
            found: f64, "of the samples, s" => "found_s";
        } = code &EXTREME_DIFFERS;
            message "{channel}: the header states the {extreme} at {} s, the samples at {} s",
                significant(*stated, 9), significant(*found, 9);
        UnusualFilterClass { class: f64, "channel frequency class" => "class" } = "unusual-filter-class", Note;
            meaning "this channel frequency class is not one of ISO 6487 and SAE J211-1";
            remedy "use 60, 180, 600 or 1000 where figures are to be compared with others";
            message "CFC {class} is none of the standards' classes (1000, 600, 180, 60)";
        FilteredBefore {
            channel: String, "the channel" => "channel";
            class: f64, "channel frequency class that its file states" => "class";
        } = "filtered-before" as FILTERED_BEFORE, Warning;
            meaning "a channel is filtered that passed a channel filter before it was recorded, as its file states";
            remedy "do not filter it again; two filters have a lower cut-off frequency than one";
            message "`{channel}` went through CFC {class} before, as its file states";
        Aliasing {
            before: usize, "samples before" => "samples_before";
            after: usize, "samples after" => "samples_after";
        } = "aliasing", Warning;
            meaning "a series was resampled to fewer samples without an anti-aliasing filter";
            remedy "filter the series first, or resample to a higher rate";
            message "{after} samples from {before}, interpolated without an anti-aliasing filter: faster vibrations \
                fold into slower ones";
        NoPositiveLevel = "no-positive-level", Warning;
            meaning "no positive level is exceeded for the time of the clip";
            remedy "turn the sign so that a deceleration is positive, or give the resultant";
            message "no positive level is held that long";
        CurveResampled {
            curve: Curve, "which of the two" => "curve" = curve.to_string();
            samples: usize, "samples before" => "samples";
            from: f64, "start of the interval, s" => "from_s";
            to: f64, "end of the interval, s" => "to_s";
        } = "curve-resampled", Note;
            meaning "a curve was interpolated linearly at 10 kHz before it was rated, without an anti-aliasing filter";
            remedy "record or filter both curves at 10 kHz";
            message "{curve}: {samples} samples, read linearly between them at 10 kHz from {} s to {} s, without a \
                filter",
                significant(*from, 9), significant(*to, 9);
        CurveCut {
            curve: Curve, "which of the two" => "curve" = curve.to_string();
            from: f64, "start of the interval, s" => "from_s";
            to: f64, "end of the interval, s" => "to_s";
        } = "curve-cut", Note;
            meaning "a curve was rated over the time that both curves cover, not over all of its samples";
            remedy "nothing, if the interval in common is the one to be rated";
            message "{curve}: cut to the common {} s to {} s", significant(*from, 9), significant(*to, 9);
        ConstantCurve = "constant-curve", Warning;
            meaning "the rated curve is constant, so it correlates with the reference at no shift better than at \
                another";
            remedy "check the channel";
            message "comparison: constant, so no shift correlates better than none";
    }
}

words! {
    /// One of the two curves of a rating.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum Curve {
        /// The measured curve, or the one that counts as exact.
        Reference = "reference",
        /// The curve that is rated.
        Comparison = "comparison",
    }
}
