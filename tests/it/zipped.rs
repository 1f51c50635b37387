//! ISO-MME in zip archives: read as its folder is, and refused where it is no test.

use std::fs;
use std::io::{Cursor, Write};
use std::path::Path;

use droptower::signal::{Measurement, ReadOptions, file};
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipWriter};

use crate::workbench::{container, data, droptower, figure, figures, lay_down, printed, refused};

/// An archive of files by their names.
fn archive(files: &[(String, Vec<u8>)], method: CompressionMethod) -> Vec<u8> {
    let options = SimpleFileOptions::default().compression_method(method);
    let mut zip = ZipWriter::new(Cursor::new(Vec::new()));
    for (name, content) in files {
        zip.start_file(name, options).expect("a file");
        zip.write_all(content).expect("its content");
    }
    zip.finish().expect("an archive").into_inner()
}

/// The files of the test in `data/`, their names changed.
fn fixture(rename: impl Fn(&str) -> String) -> Vec<(String, Vec<u8>)> {
    let names = ["test.mme", "Channel/test.chn", "Channel/test.001", "Channel/test.002", "Channel/test.003"];
    let read = |name: &str| fs::read(data("isomme_fixture").join(name)).expect("a file of the test");
    names.iter().map(|name| (rename(name), read(name))).collect()
}

fn read(path: &Path) -> Measurement {
    file::read(path, &ReadOptions::default()).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

#[test]
fn an_archive_is_read_as_its_folder() {
    let bench = tempfile::tempdir().expect("a folder");
    let expected = read(&data("isomme_fixture"));
    let attributes = ("__MACOSX/._test.mme".to_owned(), b"\0\x05\x16\x07".to_vec());
    let folder = ("T/".to_owned(), vec![]);
    for (what, files, method) in [
        ("at the top", fixture(str::to_owned), CompressionMethod::Deflated),
        ("not compressed", fixture(str::to_owned), CompressionMethod::Stored),
        ("in a folder", [vec![folder], fixture(|name| format!("T/{name}"))].concat(), CompressionMethod::Deflated),
        ("two folders deep", fixture(|name| format!("2026/T/{name}")), CompressionMethod::Deflated),
        ("by Windows", fixture(|name| format!("T\\{}", name.replace('/', "\\"))), CompressionMethod::Deflated),
        ("by macOS", [vec![attributes], fixture(|name| format!("T/{name}"))].concat(), CompressionMethod::Deflated),
        ("in capitals", fixture(|name| name.to_uppercase()), CompressionMethod::Deflated),
    ] {
        let path = bench.path().join("T.zip");
        fs::write(&path, archive(&files, method)).expect("written");
        let found = read(&path);
        // A gap is NaN, which equals nothing: compared by what is printed.
        assert_eq!(format!("{found:?}"), format!("{expected:?}"), "{what}");
    }
    let printed = printed(&droptower(bench.path(), &["signal", "info", "T.zip"]));
    assert!(printed.contains("11HEADCG0000ACXP"), "{printed}");
}

/// Sets bytes of every header of files, at `local` behind those in front of the files, at `central` behind those of the
/// directory.
fn patched(mut bytes: Vec<u8>, [local, central]: [usize; 2], value: &[u8]) -> Vec<u8> {
    for (signature, offset) in [(b"PK\x03\x04", local), (b"PK\x01\x02", central)] {
        let places: Vec<usize> =
            bytes.windows(4).enumerate().filter(|(_, at)| at == signature).map(|(i, _)| i).collect();
        assert!(!places.is_empty());
        places.iter().for_each(|place| bytes[place + offset..][..value.len()].copy_from_slice(value));
    }
    bytes
}

#[test]
fn an_archive_with_mistakes_is_refused_by_name() {
    let bench = tempfile::tempdir().expect("a folder");
    let deflated = |files: &[(String, Vec<u8>)]| archive(files, CompressionMethod::Deflated);
    let top = || fixture(str::to_owned);
    let with = |name: &str, content: &[u8]| [top(), vec![(name.to_owned(), content.to_vec())]].concat();
    let without = |name: &str| top().into_iter().filter(|(found, _)| found != name).collect::<Vec<_>>();
    let good = deflated(&top());
    let many: Vec<_> = (0..=20_000).map(|number| (format!("{number}.txt"), vec![])).collect();
    // Places in the headers of the format: flags, method, unpacked size.
    let (flags, method, size) = ([6, 8], [8, 10], [22, 24]);
    let mut flipped = archive(&top(), CompressionMethod::Stored);
    let place = flipped.windows(4).position(|at| at == b"Unit").expect("a header of a channel");
    flipped[place] ^= 1;
    for (bytes, expected) in [
        (b"time_s,a\n0,1\n".to_vec(), "T.zip: not a readable zip archive"),
        (good[..good.len() - 40].to_vec(), "T.zip: not a readable zip archive"),
        (deflated(&with(&("a/".repeat(30_000) + "x.mme"), b"")), "the archive holds a file in 30000 folders"),
        (deflated(&with("../T.002", b"")), "the archive holds a file outside of itself: `../T.002`"),
        (deflated(&with("/etc/T.002", b"")), "the archive holds a file outside of itself: `/etc/T.002`"),
        (deflated(&with("C:\\T.002", b"")), "the archive holds a file outside of itself: `C:\\T.002`"),
        (patched(good.clone(), flags, &[1, 0]), "`test.mme` is encrypted"),
        (patched(good.clone(), method, &[14, 0]), "not supported"),
        (patched(good.clone(), size, &[0, 0, 0, 0x41]), "`test.mme` would unpack to 1090519040 bytes"),
        (patched(good.clone(), size, &[0, 0, 0, 0x39]), "`T.zip` would unpack to 4781506560 bytes"),
        (patched(good.clone(), size, &[1, 0, 0, 0]), "cannot be read"),
        (flipped, "cannot be read"),
        (deflated(&with("b.mme", b"")), "several tests in the folder: `b.mme`, `test.mme`"),
        (deflated(&with("Channel\\test.001", b"")), "the archive holds several files `Channel\\test.001`"),
        (deflated(&[("a.txt".to_owned(), vec![])]), "neither a test (.mme) nor a list of channels (.chn)"),
        (deflated(&top()[..1]), "T.zip/test.mme: no folder `Channel` beside the test"),
        (deflated(&without("Channel/test.001")), "which is missing"),
        (deflated(&with("Channel/test.004", b"Channel code:X\nUnit:g\nx\n")), "T.zip/Channel/test.004"),
        (deflated(&many), "the archive holds 20001 files"),
    ] {
        let path = bench.path().join("T.zip");
        fs::write(&path, &bytes).expect("written");
        refused(&droptower(bench.path(), &["signal", "info", "T.zip"]), expected);
    }
    let left: Vec<_> = fs::read_dir(bench.path()).expect("the folder").collect();
    assert_eq!(left.len(), 1, "nothing was unpacked: {left:?}");
}

/// A drop test is reduced from the archive to the figures of the folder, and a scenario names it as its reference.
#[test]
fn a_drop_is_reduced_from_an_archive() {
    let bench = tempfile::tempdir().expect("a folder");
    let files = container(&data("virtual/1008.csv"));
    fs::write(bench.path().join("drop.zip"), archive(&files, CompressionMethod::Deflated)).expect("written");
    let test = lay_down(&bench.path().join("folder"), &files);
    let reduced = |path: &str| {
        let arguments = ["reduce", "drop", path, "--mass", "10.72 kg", "--height", "1 m", "--json"];
        figure(&figures(&droptower(bench.path(), &arguments)), "peak_acceleration_m_s2")
    };
    assert_eq!(reduced("drop.zip"), reduced(test.to_str().expect("UTF-8")));
    let base = data("../scenarios/drop/1008.toml");
    let scenario = format!("extends = '{}'\nreference.signals = \"drop.zip\"\n", base.display());
    fs::write(bench.path().join("zipped.toml"), scenario).expect("written");
    printed(&droptower(bench.path(), &["check", "zipped.toml"]));
    fs::write(bench.path().join("drop.zip"), "no archive").expect("written");
    refused(&droptower(bench.path(), &["check", "zipped.toml"]), "not a readable zip archive");
}
