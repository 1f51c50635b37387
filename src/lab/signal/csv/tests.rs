use super::*;
use crate::signal::{Channel, Recording};

fn read_text(text: &str) -> Result<Recording, ReadError> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("r.csv");
    std::fs::write(&path, text).unwrap();
    read(&path)
}

#[test]
fn a_written_recording_reads_back_to_the_same_bits() {
    let recording = Recording {
        time: vec![0.0, 1e-4, 2e-4],
        channels: vec![
            Channel { name: "acceleration_m_s2".into(), values: vec![-9.81, 0.1 + 0.2, 1e-300] },
            Channel { name: "displacement_m".into(), values: vec![-0.0, 1.0 / 3.0, 6.02e23] },
        ],
    };
    let mut text = Vec::new();
    write(&recording, &mut text).unwrap();
    let text = String::from_utf8(text).unwrap();
    assert!(text.starts_with("time_s,acceleration_m_s2,displacement_m\n0.0,-9.81,-0.0\n"), "{text}");
    assert_eq!(read_text(&text).unwrap(), recording);
}
