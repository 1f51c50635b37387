use std::fs;
use std::path::PathBuf;

use super::*;

fn read_text(name: &str, text: &[u8], unit: Option<f64>) -> Result<FieldFile, crate::Error> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    fs::write(&path, text).unwrap();
    read(&path, &FieldOptions { unit })
}

/// Files made after descriptions and printed headers of exports; none is an export itself.
#[test]
fn exports_of_each_program_are_read() {
    for (program, name, unit) in [
        ("VIC-3D", "vic", None),
        ("VIC-3D", "vic-plain", Some(1e-3)),
        ("MatchID", "matchid", None),
        ("MatchID", "matchid-older", None),
        ("ARAMIS", "aramis", Some(1e-3)),
        ("ARAMIS", "aramis-deformed", None),
        ("ARAMIS", "nodemap", None),
        ("DICe", "dice", Some(1e-3)),
    ] {
        let path = format!(concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/it/formats/fields/{}.csv"), name);
        let found = read(path.as_ref(), &FieldOptions { unit }).unwrap_or_else(|error| panic!("{name}: {error}"));
        assert_eq!((found.program, found.missing), (program, 1), "{name}");
        let near = |found: &[[f64; 3]], expected: [[f64; 3]; 2]| {
            let pairs = found.iter().flatten().zip(expected.as_flattened());
            assert!(found.len() == 2 && pairs.into_iter().all(|(a, b)| (a - b).abs() < 1e-12), "{program}: {found:?}");
        };
        near(&found.places, [[0.01, -0.02, 0.0015], [0.012, -0.02, 0.0015]]);
        near(&found.displacements, [[0.0005, 0.0, -0.002], [0.00025, 0.0, -0.002]]);
    }
}

#[test]
fn what_is_no_field_is_refused_by_name() {
    for (text, expected) in [
        ("x,y,F\n1,2,3\n", "no columns of places and displacements that are known among `x`, `y`, `F`"),
        ("x,y,u,v\n1,2,3,4\n", "displacements in the plane alone (`u`, `v`)"),
        ("X,Y,Z,U,V\n1,2,3,4,5\n", "displacements in the plane alone (`U`, `V`): fields of two-dimensional"),
        ("X,Y,Z,U,V,W\n1,2,3,4,5,6\n", "field.csv: `X` states no unit of length"),
        ("X [Pixel],Y,Z,U,V,W\n1,2,3,4,5,6\n", "`X [Pixel]` is in `Pixel`, not in a unit of length"),
        ("X [s],Y,Z,U,V,W\n1,2,3,4,5,6\n", "`X [s]` is in `s`, not in a unit of length"),
        ("X [m],Y [m],Z [m],U [m],V [m],W [m]\n1,2,3,4,5,\n", "no point has a displacement"),
        ("X [m],Y [m],Z [m],U [m],V [m],W [m]\n1,2,3,4,5,x\n", "field.csv:2:11: expected a number for `W`, found `x`"),
    ] {
        let error = read_text("field.csv", text.as_bytes(), None).unwrap_err().to_string();
        assert!(error.contains(expected), "{text:?} gave: {error}");
    }
}

#[test]
fn files_are_in_the_order_of_their_numbers() {
    let paths = |names: &[&str]| names.iter().map(PathBuf::from).collect::<Vec<_>>();
    let found = in_order(paths(&["b/f_10.csv", "a/f_9.csv", "f_009b.csv", "f_100.csv", "e_200.csv", "f.csv"]));
    assert_eq!(found, paths(&["e_200.csv", "f.csv", "a/f_9.csv", "f_009b.csv", "b/f_10.csv", "f_100.csv"]));
}

#[test]
fn states_share_their_places() {
    let folder = tempfile::tempdir().unwrap();
    let head = "X [mm],Y [mm],Z [mm],U [mm],V [mm],W [mm],sigma\n";
    let file = |name: &str, rows: &str| {
        let path = folder.path().join(name);
        fs::write(&path, format!("{head}{rows}")).unwrap();
        path
    };
    let first = file("1.csv", "0,0,0,0,0,0,0\n1,0,0,0,0,0,0\n2,0,0,0,0,0,-1\n");
    let second = file("2.csv", "1,0,0,0,0,3,0\n2,0,0,0,0,4,0\n");
    let field = Field::read(&[(first, 0.0), (second, 0.5)], &FieldOptions::default()).unwrap().unwrap();
    assert_eq!((field.places.len(), field.points()), (3, 4));
    assert_eq!(field.states[1].points, [(1, [0.0, 0.0, 0.003]), (2, [0.0, 0.0, 0.004])]);
    assert_eq!((field.states[0].missing, field.states[1].time), (1, 0.5));
}

#[test]
fn times_come_from_a_table() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("times.csv");
    let times = |text: &str| {
        fs::write(&path, text).unwrap();
        read_times(&path).map_err(|error| error.to_string())
    };
    assert_eq!(times("image,time [ms]\n0,0\n1,2.5\n").unwrap(), [0.0, 0.0025]);
    assert_eq!(times("0.0\n0.5\n").unwrap(), [0.0, 0.5]);
    assert!(times("image,load\n0,0\n").unwrap_err().contains("no column of time among `image`, `load`"));
    assert!(times("time_s\n0\n0\n").unwrap_err().contains("time 2 does not come after"));
}

#[test]
fn pairs_of_points_give_back_their_motion() {
    let rotation = nalgebra::UnitQuaternion::from_scaled_axis(nalgebra::Vector3::new(0.3, -1.2, 2.0));
    let motion = RigidMotion { rotation, translation: nalgebra::Vector3::new(0.1, -0.4, 2.0) };
    let flat = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 2.0, 0.0]];
    let pairs: Vec<_> = flat.iter().map(|place| [*place, motion.apply(*place)]).collect();
    let found = RigidMotion::of_pairs(&pairs).unwrap();
    assert!(found.rotation.angle_to(&motion.rotation) < 1e-12, "{found:?}");
    assert!((found.translation - motion.translation).norm() < 1e-12, "{found:?}");
    let there = motion.inverse().apply(motion.apply([0.3, 0.4, 0.5]));
    assert!((nalgebra::Vector3::from(there) - nalgebra::Vector3::new(0.3, 0.4, 0.5)).norm() < 1e-12);
    assert!(RigidMotion::of_pairs(&pairs[..2]).is_none(), "two points leave a rotation open");
}
