//! Numbers as HDF5 stores them.

use hdf5_pure::{Datatype, DatatypeByteOrder};

/// Why values of this type are no real numbers; none where they are.
pub fn not_real(datatype: &Datatype) -> Option<String> {
    let what = match datatype {
        Datatype::FixedPoint { size: 1 | 2 | 4 | 8, byte_order, .. } if is_plain(*byte_order) => return None,
        Datatype::FloatingPoint { size: 4 | 8, byte_order, .. } if is_plain(*byte_order) => return None,
        Datatype::Enumeration { base_type, .. } => return not_real(base_type),
        Datatype::String { .. } | Datatype::VariableLength { is_string: true, .. } => "texts",
        Datatype::Compound { members, .. } if is_complex(members.iter().map(|member| member.name.as_str())) => {
            "complex numbers"
        }
        Datatype::Compound { .. } => "records within records",
        Datatype::Reference { .. } => "references, such as a cell array",
        _ => "values that are no numbers of 1 to 8 bytes",
    };
    Some(format!("it holds {what}"))
}

/// Whether the names are those of the parts of complex numbers.
pub fn is_complex<'a>(names: impl Iterator<Item = &'a str>) -> bool {
    let names: Vec<&str> = names.collect();
    [["real", "imag"], ["r", "i"]].iter().any(|parts| names == parts)
}

fn is_plain(order: DatatypeByteOrder) -> bool {
    matches!(order, DatatypeByteOrder::LittleEndian | DatatypeByteOrder::BigEndian)
}

/// The number in `bytes`, which are at least as many as those of its type.
pub fn number(datatype: &Datatype, bytes: &[u8]) -> Option<f64> {
    let (size, order) = match datatype {
        Datatype::FixedPoint { size, byte_order, .. } | Datatype::FloatingPoint { size, byte_order, .. } => {
            (*size as usize, *byte_order)
        }
        Datatype::Enumeration { base_type, .. } => return number(base_type, bytes),
        _ => return None,
    };
    let mut own = [0; 8];
    own.get_mut(..size)?.copy_from_slice(bytes.get(..size)?);
    if order == DatatypeByteOrder::BigEndian {
        own[..size].reverse();
    }
    let bits = u64::from_le_bytes(own);
    Some(match datatype {
        Datatype::FloatingPoint { size: 4, .. } => f32::from_bits(bits as u32).into(),
        Datatype::FloatingPoint { .. } => f64::from_bits(bits),
        Datatype::FixedPoint { layout, .. } if layout.signed => {
            let unused = 64 - 8 * size as u32;
            ((bits << unused) as i64 >> unused) as f64
        }
        _ => bits as f64,
    })
}
