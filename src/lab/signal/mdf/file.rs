//! An MDF file: its channels, and the values of one.

use std::collections::HashSet;
use std::io::BufReader;
use std::path::Path;

use super::Fault;
use super::block::{Block, Blocks, u16_at, u32_at};
use super::conversion::Conversion;
use super::data;
use super::record::{self, Records, Slot};
use crate::signal::Annotations;
use crate::signal::stored::{self, Axis, Catalogue, Entry};
use base::file;
use base::units::Unit;

/// An MDF file whose channels are listed.
pub struct Mdf {
    blocks: Blocks,
    sets: Vec<Set>,
    entries: Vec<Entry>,
    /// Of each entry.
    channels: Vec<Channel>,
    /// The data of a set, since channels are read one after the other.
    held: Option<(usize, Vec<u8>)>,
    comments: Vec<String>,
    /// Groups that were listed, and the names of those that have one.
    groups: usize,
    names: HashSet<String>,
}

/// Groups that share their data.
struct Set {
    data: u64,
    id_bytes: usize,
    groups: Vec<Records>,
}

struct Channel {
    set: usize,
    group: Records,
    slot: Slot,
    conversion: Conversion,
}

/// Place of the header.
const HEADER: u64 = 64;
/// Kinds of channels.
const FIXED: u8 = 0;
const MASTER: u8 = 2;
const VIRTUAL_MASTER: u8 = 3;
/// Most samples for each byte of the file: packed data have no more.
const MOST_PACKED: u64 = 1100;

impl Mdf {
    /// Reads everything but the values.
    pub fn open(path: &Path) -> Result<Mdf, stored::Fault> {
        let file = file::open(path).map_err(Fault::Open)?;
        let length = file.metadata().map_err(Fault::Read)?.len();
        let blocks = Blocks::new(BufReader::new(file), length);
        let (sets, entries, channels, comments) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        let mut mdf = Mdf { blocks, sets, entries, channels, held: None, comments, groups: 0, names: HashSet::new() };
        let header = mdf.blocks.read(HEADER, "##HD")?;
        let comment = mdf.blocks.text(header.link(5))?;
        mdf.comments.extend(comment.map(|text| text.replace(char::is_control, " ").chars().take(200).collect()));
        let mut next = header.link(0);
        while next != 0 {
            let set = mdf.blocks.read(next, "##DG")?;
            mdf.list(&set)?;
            next = set.link(0);
        }
        // A single group needs no name before its channels.
        let first = mdf.entries.first().map(|entry| entry.group.clone());
        if mdf.entries.iter().all(|entry| Some(&entry.group) == first.as_ref()) {
            for entry in &mut mdf.entries {
                let own = entry.column.label[entry.group.len()..].trim_start_matches('/').to_owned();
                entry.column.label = own;
                entry.group.clear();
            }
        }
        Ok(mdf)
    }

    fn list(&mut self, set: &Block) -> Result<(), stored::Fault> {
        let id_bytes = usize::from(set.at_least(1)?[0]).min(8);
        let place = self.sets.len();
        self.sets.push(Set { data: set.link(2), id_bytes, groups: Vec::new() });
        let mut next = set.link(1);
        while next != 0 {
            let group = self.blocks.read(next, "##CG")?;
            let data = group.at_least(32)?;
            let ([id, count], flags) = (record::counts(data), u16_at(data, 16));
            let lengths = [u32_at(data, 24) as usize, u32_at(data, 28) as usize];
            let records = Records { id, lengths: (flags & 1 == 0).then_some(lengths) };
            self.sets[place].groups.push(records);
            if records.lengths.is_some() {
                self.list_group(&group, (place, records, lengths), count)?;
            }
            next = group.link(0);
        }
        Ok(())
    }

    /// Lists the channels of a group: the chain of channels is followed once for names, units and conversions, and for the master,
    /// whose times the others have.
    fn list_group(
        &mut self,
        group: &Block,
        (set, records, lengths): (usize, Records, [usize; 2]),
        count: u64,
    ) -> Result<(), stored::Fault> {
        let named = self.blocks.text(group.link(2))?;
        // Names need not differ; a number does.
        self.groups += 1;
        let named = named.filter(|name| self.names.insert(name.clone()));
        let name = named.unwrap_or_else(|| format!("group {}", self.groups));
        let first = self.entries.len();
        let (mut next, mut master) = (group.link(1), None);
        while next != 0 {
            let channel = self.blocks.read(next, "##CN")?;
            let data = channel.at_least(24)?;
            let (kind, sync) = (data[0], data[1]);
            let flags = u32_at(data, 12);
            let slot = Slot {
                kind: data[2],
                bit: data[3].into(),
                byte: u32_at(data, 4) as usize,
                bits: u32_at(data, 8),
                invalid: (flags & 2 != 0).then(|| u32_at(data, 16) as usize),
                is_number: kind == VIRTUAL_MASTER,
            };
            let (conversion, unit_of_conversion) = Conversion::read(&mut self.blocks, channel.link(4))?;
            let own = self.blocks.text(channel.link(2))?.unwrap_or_else(|| "channel".to_owned());
            let unit = match self.blocks.text(channel.link(6))? {
                Some(unit) => Some(unit),
                None => self.blocks.text(unit_of_conversion)?,
            };
            let mut entry = Entry::new(&name, &own, unit.as_deref())?;
            entry.samples = count;
            let is_number = matches!((slot.kind, slot.bits), (0..=3, 1..=64) | (4 | 5, 32 | 64));
            entry.unread = match kind {
                FIXED | MASTER | VIRTUAL_MASTER if flags & 1 != 0 => Some("all its values are invalid".to_owned()),
                FIXED | MASTER if !is_number => Some("it holds no numbers".to_owned()),
                FIXED | MASTER | VIRTUAL_MASTER if !slot.fits(lengths) => {
                    Some("its values lie beyond the records of its group".to_owned())
                }
                FIXED | MASTER | VIRTUAL_MASTER if count > self.blocks.length.saturating_mul(MOST_PACKED) => {
                    Some(format!("its group states {count} records, more than the file can hold"))
                }
                FIXED | MASTER | VIRTUAL_MASTER => conversion.unread(),
                _ => Some("it holds values of different lengths".to_owned()),
            };
            // By the standard the master of a group that is a time is in seconds.
            if matches!(kind, MASTER | VIRTUAL_MASTER) && sync == 1 {
                master = master.or(Some(self.entries.len()));
                let has_unit = entry.column.unit.is_some() || entry.column.unknown_unit.is_some();
                entry.column.unit = if has_unit { entry.column.unit } else { Unit::parse("s").ok() };
            }
            self.entries.push(entry);
            self.channels.push(Channel { set, group: records, slot, conversion });
            next = channel.link(0);
        }
        if let Some(master) = master {
            self.entries[first..].iter_mut().for_each(|entry| entry.axis = Axis::Channel(master));
        }
        Ok(())
    }
}

impl Catalogue for Mdf {
    fn entries(&self) -> &[Entry] {
        &self.entries
    }

    fn annotations(&self) -> Annotations {
        Annotations::new(self.comments.clone())
    }

    fn values(&mut self, place: usize) -> Result<Vec<f64>, stored::Fault> {
        let (channel, entry) = (&self.channels[place], &self.entries[place]);
        let set = &self.sets[channel.set];
        let data = match self.held.take().filter(|(held, _)| *held == channel.set) {
            Some((_, data)) => data,
            None => data::read(&mut self.blocks, set.data)?,
        };
        let (mut values, mut number) = (Vec::new(), 0);
        let length = channel.group.lengths.map_or(0, |[values, _]| values);
        record::each(&data, set.id_bytes, &set.groups, channel.group, |record| {
            if number < entry.samples {
                values.push(channel.conversion.apply(channel.slot.value(record, length, number)));
            }
            number += 1;
        });
        self.held = Some((channel.set, data));
        if (values.len() as u64) < entry.samples {
            let (group, found) = (entry.group.clone(), values.len() as u64);
            return Err(Fault::Records { group, found, stated: entry.samples }.into());
        }
        Ok(values)
    }
}
