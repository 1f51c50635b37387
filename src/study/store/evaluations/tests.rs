//! Records survive whatever happens to the processes that write them.

use std::fs;
use std::io::Write;

use super::*;

fn key(number: u8) -> Key {
    Key([number; 16])
}

fn open(folder: &Path) -> EvaluationStore {
    EvaluationStore::open(folder, "1").unwrap()
}

fn only_segment(folder: &Path) -> PathBuf {
    let found = segments(folder).unwrap();
    assert_eq!(found.len(), 1, "{found:?}");
    found[0].clone()
}

#[test]
fn records_are_read_back_by_the_same_build_only() {
    let folder = tempfile::tempdir().unwrap();
    let store = open(folder.path());
    assert!(
        store.is_empty() && segments(folder.path()).unwrap().is_empty(),
        "a store that is only read leaves nothing"
    );
    store.put(key(1), b"one").unwrap();
    store.put(key(2), b"").unwrap();
    assert_eq!(store.get(key(1)).unwrap().as_deref(), Some(&b"one"[..]));
    drop(store);
    let again = open(folder.path());
    assert_eq!(again.len(), 2);
    assert_eq!(again.get(key(2)).unwrap().as_deref(), Some(&b""[..]));
    assert_eq!(again.get(key(3)).unwrap(), None);
    assert!(EvaluationStore::open(folder.path(), "2").unwrap().is_empty());
}

#[test]
fn processes_see_each_others_records() {
    let folder = tempfile::tempdir().unwrap();
    let stores = [open(folder.path()), open(folder.path())];
    for (number, store) in (0..).zip(&stores) {
        store.put(key(number), &[number]).unwrap();
    }
    for store in &stores {
        store.refresh().unwrap();
        assert!((0..2).all(|number| store.get(key(number)).unwrap() == Some(vec![number])));
    }
    stores[1].put(key(7), b"later").unwrap();
    assert!(!stores[0].contains(key(7)));
    stores[0].refresh().unwrap();
    assert_eq!(stores[0].get(key(7)).unwrap().as_deref(), Some(&b"later"[..]));
}

#[test]
fn a_segment_cut_anywhere_keeps_its_complete_records() {
    let folder = tempfile::tempdir().unwrap();
    let store = open(folder.path());
    let records: Vec<Vec<u8>> = (0..4).map(|number| vec![number; 10 * usize::from(number)]).collect();
    let mut ends = vec![];
    for (number, record) in (0..).zip(&records) {
        store.put(key(number), record).unwrap();
        ends.push(fs::metadata(only_segment(folder.path())).unwrap().len());
    }
    let path = only_segment(folder.path());
    let whole = fs::read(&path).unwrap();
    for length in 0..=whole.len() {
        fs::write(&path, &whole[..length]).unwrap();
        let complete = ends.iter().filter(|end| **end <= length as u64).count();
        let found = open(folder.path());
        assert_eq!(found.len(), complete, "{length} bytes");
        let read = |number: u8| found.get(key(number)).unwrap();
        assert!((0..complete).all(|number| read(number as u8).as_ref() == Some(&records[number])));
    }
}

#[test]
fn a_damaged_record_is_none() {
    let folder = tempfile::tempdir().unwrap();
    let store = open(folder.path());
    store.put(key(1), b"whole").unwrap();
    store.put(key(2), b"damaged").unwrap();
    let path = only_segment(folder.path());
    let mut bytes = fs::read(&path).unwrap();
    let last = bytes.len() - 1;
    bytes[last] ^= 1;
    fs::write(&path, bytes).unwrap();
    let found = open(folder.path());
    assert!(found.contains(key(1)) && !found.contains(key(2)));
}

/// Whether the store claims the evaluation; the claim is held, as by a process that is at work.
fn claims(store: &EvaluationStore, key: Key) -> bool {
    store.claim(key).unwrap().map(std::mem::forget).is_some()
}

/// However a thread ends, nobody waits for what it does not compute any more.
#[test]
fn a_dropped_claim_is_given_up() {
    let folder = tempfile::tempdir().unwrap();
    let [one, other] = [open(folder.path()), open(folder.path())];
    let claim = one.claim(key(1)).unwrap();
    other.refresh().unwrap();
    assert!(claim.is_some() && !claims(&one, key(1)) && !claims(&other, key(1)));
    drop(claim);
    other.refresh().unwrap();
    assert!(claims(&other, key(1)));
    // What was added is not given up.
    let claim = one.claim(key(2)).unwrap();
    one.put(key(2), b"done").unwrap();
    let length = || fs::metadata(&one.state().own.as_ref().unwrap().path).unwrap().len();
    let before = length();
    drop(claim);
    assert_eq!(length(), before);
}

#[test]
fn a_refusal_is_told_and_may_pass() {
    let folder = tempfile::tempdir().unwrap();
    let [one, other] = [open(folder.path()), open(folder.path())];
    for cause in ["too slow", "too slow again"] {
        one.claim(key(1)).unwrap().unwrap().refuse(cause).unwrap();
        other.refresh().unwrap();
        for store in [&one, &other, &open(folder.path())] {
            assert_eq!(store.refusal(key(1)).unwrap().as_deref(), Some(cause));
            assert!(!store.contains(key(1)));
        }
    }
    other.claim(key(1)).unwrap().map(std::mem::forget).unwrap();
    other.put(key(1), b"done").unwrap();
    one.refresh().unwrap();
    for store in [&one, &other, &open(folder.path())] {
        assert_eq!(store.refusal(key(1)).unwrap(), None);
    }
}

#[test]
fn claims_hold_until_given_up_or_fulfilled() {
    let folder = tempfile::tempdir().unwrap();
    let [one, other] = [open(folder.path()), open(folder.path())];
    assert!(claims(&one, key(1)) && claims(&one, key(2)));
    other.refresh().unwrap();
    assert!(!claims(&other, key(1)));
    assert!(claims(&other, key(3)));
    one.put(key(1), b"done").unwrap();
    one.close().unwrap();
    other.refresh().unwrap();
    assert!(other.contains(key(1)) && claims(&other, key(2)));
    // Whoever goes on working after all claims again.
    assert!(claims(&one, key(4)));
    other.refresh().unwrap();
    assert!(!claims(&other, key(4)));
}

/// Two processes that look, find nothing, and claim the same at once: when both have looked again, one computes it.
#[test]
fn of_two_claims_at_once_one_yields() {
    let folder = tempfile::tempdir().unwrap();
    let [one, other, third] = [open(folder.path()), open(folder.path()), open(folder.path())];
    let path = |store: &EvaluationStore| store.state().own.as_ref().unwrap().path.clone();
    [&one, &other].iter().for_each(|store| store.put(key(9), b"").unwrap());
    let [first, second] = if path(&one) < path(&other) { [one, other] } else { [other, one] };
    assert!(claims(&first, key(1)) && !claims(&second, key(1)));
    // The one that yields gives up its own claim, not that of the other.
    third.refresh().unwrap();
    assert!(!claims(&third, key(1)));
    // One that has begun keeps its claim, in whichever segment it is.
    assert!(claims(&second, key(2)) && !claims(&first, key(2)));
    second.put(key(2), b"once").unwrap();
    first.refresh().unwrap();
    assert!(first.contains(key(2)));
}

#[test]
fn of_claims_at_the_same_moment_one_stands() {
    const PROCESSES: usize = 3;
    const EVALUATIONS: u16 = 2000;
    let evaluation = |number: u16| Key(std::array::from_fn(|place| number.to_le_bytes()[place % 2]));
    let folder = tempfile::tempdir().unwrap();
    let start = std::sync::Barrier::new(PROCESSES);
    let process = || {
        let store = open(folder.path());
        let claimed = |number: &u16| {
            start.wait();
            claims(&store, evaluation(*number))
        };
        let claimed: Vec<u16> = (0..EVALUATIONS).filter(claimed).collect();
        // Claims end with their process.
        (claimed, store)
    };
    let ended = std::thread::scope(|scope| {
        let processes = [(); PROCESSES].map(|()| scope.spawn(process));
        processes.map(|process| process.join().unwrap())
    });
    let mut standing: Vec<u16> = ended.iter().flat_map(|(claimed, _)| claimed).copied().collect();
    standing.sort_unstable();
    assert_eq!(standing, (0..EVALUATIONS).collect::<Vec<u16>>());
}

#[test]
fn claims_of_an_old_segment_do_not_hold() {
    let folder = tempfile::tempdir().unwrap();
    let killed = open(folder.path());
    assert!(claims(&killed, key(1)));
    let file = fs::OpenOptions::new().append(true).open(only_segment(folder.path())).unwrap();
    file.set_modified(std::time::SystemTime::now() - 2 * STALE).unwrap();
    assert!(claims(&open(folder.path()), key(1)));
}

/// The lock of a killed process is gone, whatever the age of its segment.
#[cfg(target_os = "linux")]
#[test]
fn claims_of_a_killed_process_of_this_machine_do_not_hold() {
    let folder = tempfile::tempdir().unwrap();
    let killed = open(folder.path());
    assert!(claims(&killed, key(1)));
    let other = open(folder.path());
    assert!(!claims(&other, key(1)));
    drop(killed);
    assert!(claims(&other, key(1)));
}

/// An entry that a killed process or a full disk left incomplete is no sign of life: its claims end.
#[test]
fn a_segment_that_ends_in_an_incomplete_entry_does_not_grow() {
    let folder = tempfile::tempdir().unwrap();
    let killed = open(folder.path());
    killed.put(key(2), b"whole").unwrap();
    assert!(claims(&killed, key(1)));
    let mut file = fs::OpenOptions::new().append(true).open(only_segment(folder.path())).unwrap();
    file.write_all(&[7; 40]).unwrap();
    file.set_modified(std::time::SystemTime::now() - 2 * STALE).unwrap();
    let found = open(folder.path());
    found.refresh().unwrap();
    assert!(found.contains(key(2)) && claims(&found, key(1)));
}

/// A segment shows its header as soon as it shows itself: a process that looked too early would never look again.
#[test]
fn nothing_but_whole_segments_is_seen() {
    let folder = tempfile::tempdir().unwrap();
    let [one, other] = [open(folder.path()), open(folder.path())];
    assert!(claims(&one, key(1)));
    let names: Vec<_> = fs::read_dir(folder.path()).unwrap().map(|entry| entry.unwrap().path()).collect();
    assert_eq!(names, [only_segment(folder.path())]);
    other.refresh().unwrap();
    assert!(!claims(&other, key(1)));
}

#[test]
fn whole_runs_are_kept_beside_and_removed_with_their_segment() {
    let folder = tempfile::tempdir().unwrap();
    let store = open(folder.path());
    assert_eq!(store.run(key(1)).unwrap(), None);
    // Figures are kept under another key than the run that a script made them of.
    store.put(key(5), b"figures").unwrap();
    store.put_run(key(1), b"signals").unwrap();
    assert_eq!(store.run(key(1)).unwrap().as_deref(), Some(&b"signals"[..]));
    fs::write(store.run_path(key(1)), b"damaged!").unwrap();
    assert_eq!(store.run(key(1)).unwrap(), None);
    let [figures] = &EvaluationStore::list(folder.path()).unwrap()[..] else { panic!("one segment") };
    assert_eq!((figures.build.as_deref(), figures.evaluations), (Some("1"), 1));
    assert_eq!((figures.runs, figures.run_bytes), (1, 8));
    EvaluationStore::remove(folder.path(), &figures.path).unwrap();
    assert!(!store.run_path(key(1)).exists() && open(folder.path()).is_empty());
}
