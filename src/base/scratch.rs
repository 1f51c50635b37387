//! Temporary files and folders beside what they become, and what killed processes left of them.
//!
//! Each is locked as long as its process lives. The next process that makes one in the same folder removes those that
//! nobody holds any more.

use std::collections::BTreeSet;
use std::fs::{self, File, OpenOptions};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, OnceLock};
use std::time::Duration;

use tempfile::{Builder, NamedTempFile, TempDir};

use crate::diagnostic::file_name;

/// Begins the name of each.
const PREFIX: &str = ".droptower-";

/// Begins the name of one that is kept.
const KEPT: &str = "droptower-kept-";

/// Folder within a temporary one with what is to be replaced, under its name.
const FORMER: &str = "former";

/// Age from which what this machine left since it was started is removed: what is made now may not be locked yet.
const NEW: Duration = Duration::from_secs(1);

/// Age from which the rest is removed: other machines may not show their locks.
const OLD: Duration = Duration::from_secs(24 * 3600);

/// A temporary folder, which is removed with its content when it is dropped.
#[derive(Debug)]
pub struct ScratchFolder {
    folder: TempDir,
    /// Shows other processes that this one lives.
    _lock: Option<File>,
}

impl ScratchFolder {
    /// An empty folder in `parent`, with the permissions of the user's mask.
    ///
    /// # Errors
    /// It cannot be created.
    pub fn new(parent: &Path) -> io::Result<ScratchFolder> {
        sweep_once(parent);
        let folder = named(0o777, |builder| builder.tempdir_in(parent))?;
        // Not every system opens or locks a folder; what is left there stays.
        let lock = File::open(folder.path()).ok().filter(|file| file.try_lock().is_ok());
        Ok(ScratchFolder { folder, _lock: lock })
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        self.folder.path()
    }

    /// The path within it for `target`, which is moved there to be replaced: should this process be killed before, it is
    /// moved back.
    ///
    /// # Errors
    /// It cannot be created.
    pub fn former(&self, target: &Path) -> io::Result<PathBuf> {
        let folder = self.path().join(FORMER);
        fs::create_dir(&folder)?;
        Ok(folder.join(target.file_name().unwrap_or_default()))
    }

    /// Leaves it where it is: it was renamed.
    pub fn renamed(&mut self) {
        self.folder.disable_cleanup(true);
    }

    /// Its path from now on: it is not removed, and has a name that no later process takes for something left.
    pub fn keep(self) -> PathBuf {
        let path = self.folder.keep();
        let name = file_name(&path).replacen(PREFIX, KEPT, 1);
        let kept = path.with_file_name(name);
        match fs::rename(&path, &kept) {
            Ok(()) => kept,
            Err(_) => path,
        }
    }
}

/// A temporary file in `folder` with the permissions of the user's mask instead of the owner's alone.
///
/// # Errors
/// It cannot be created.
pub fn file(folder: &Path) -> io::Result<NamedTempFile> {
    sweep_once(folder);
    let file = named(0o666, |builder| builder.tempfile_in(folder))?;
    // Where files cannot be locked, what is left stays.
    let _ = file.as_file().try_lock();
    Ok(file)
}

/// What `make` makes under a name of this process, with these permissions but those of the user's mask.
fn named<T>(mode: u32, make: impl Fn(&Builder<'_, '_>) -> io::Result<T>) -> io::Result<T> {
    let prefix = format!("{PREFIX}{}-", boot());
    let mut builder = Builder::new();
    builder.prefix(&prefix);
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(fs::Permissions::from_mode(mode));
    }
    #[cfg(not(unix))]
    let _ = mode;
    make(&builder)
}

/// Distinguishes machines, and the times between their starts; the same for all where the system does not tell.
pub fn boot() -> &'static str {
    static BOOT: OnceLock<String> = OnceLock::new();
    BOOT.get_or_init(|| {
        let id = fs::read_to_string("/proc/sys/kernel/random/boot_id").unwrap_or_default();
        let id: String = id.chars().filter(char::is_ascii_alphanumeric).take(12).collect();
        if id.is_empty() { "0".into() } else { id }
    })
}

/// Removes what killed processes left in `folder`, the first time that this process makes something there.
fn sweep_once(folder: &Path) {
    static SWEPT: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());
    let place = folder.canonicalize().unwrap_or_else(|_| folder.to_owned());
    if crate::lock(&SWEPT).insert(place) {
        sweep(folder);
    }
}

fn sweep(folder: &Path) {
    let own = format!("{PREFIX}{}-", boot());
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let name = entry.file_name();
        let Some(name) = name.to_str().filter(|name| name.starts_with(PREFIX)) else { continue };
        let least = if name.starts_with(&own) && boot() != "0" { NEW } else { OLD };
        // What cannot be removed is looked at the next time.
        let _ = remove_left(&entry.path(), folder, least);
    }
}

/// Removes what is at `path` in `folder`, of at least this age, unless a process holds it.
fn remove_left(path: &Path, folder: &Path, least: Duration) -> io::Result<()> {
    let about = fs::symlink_metadata(path)?;
    let is_old = about.modified()?.elapsed().is_ok_and(|age| age >= least);
    if !is_old || !(about.is_dir() || about.is_file()) {
        return Ok(());
    }
    let mut options = OpenOptions::new();
    options.read(true);
    #[cfg(unix)]
    std::os::unix::fs::OpenOptionsExt::custom_flags(&mut options, libc::O_NOFOLLOW | libc::O_NONBLOCK);
    let held = options.open(path)?;
    if held.try_lock().is_err() {
        return Ok(());
    }
    if about.is_file() {
        return fs::remove_file(path);
    }
    for former in fs::read_dir(path.join(FORMER)).into_iter().flatten().flatten() {
        let target = folder.join(former.file_name());
        // The process was killed between two renames: what it was about to replace is all that there is.
        if fs::symlink_metadata(&target).is_err() {
            fs::rename(former.path(), target)?;
        }
    }
    fs::remove_dir_all(path)
}

#[cfg(all(test, unix))]
mod tests {
    use std::time::SystemTime;

    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let mut names: Vec<String> =
            fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    fn age(path: &Path, age: Duration) {
        File::open(path).unwrap().set_modified(SystemTime::now() - age).unwrap();
    }

    #[test]
    fn what_a_killed_process_left_is_removed_and_the_rest_stays() {
        let folder = tempfile::tempdir().unwrap();
        let place = |name: &str| folder.path().join(name);
        let held = ScratchFolder::new(folder.path()).unwrap();
        let own = format!("{PREFIX}{}", boot());
        for name in
            [&format!("{own}-left"), &format!("{own}-new"), ".droptower-elsewhere-late", ".droptower-elsewhere-old"]
        {
            fs::create_dir(place(name)).unwrap();
            fs::write(place(name).join("a"), "1").unwrap();
        }
        let two = Duration::from_secs(2);
        fs::write(place(&format!("{own}-file")), "").unwrap();
        age(&place(&format!("{own}-file")), two);
        age(&place(&format!("{own}-left")), two);
        age(held.path(), two);
        age(&place(".droptower-elsewhere-late"), two);
        age(&place(".droptower-elsewhere-old"), 2 * OLD);
        sweep(folder.path());
        let held_name = held.path().file_name().unwrap().to_str().unwrap().to_owned();
        let mut expected = vec![".droptower-elsewhere-late".to_owned(), format!("{own}-new"), held_name];
        expected.sort();
        assert_eq!(names(folder.path()), expected);
    }

    #[test]
    fn what_is_kept_stays() {
        let folder = tempfile::tempdir().unwrap();
        let scratch = ScratchFolder::new(folder.path()).unwrap();
        let former = scratch.former(&folder.path().join("run")).unwrap();
        fs::create_dir(&former).unwrap();
        fs::create_dir(folder.path().join("run")).unwrap();
        let kept = scratch.keep();
        age(&kept, 2 * OLD);
        sweep(folder.path());
        assert!(kept.join(FORMER).join("run").is_dir());
    }

    #[test]
    fn what_was_to_be_replaced_comes_back() {
        let folder = tempfile::tempdir().unwrap();
        for (target, is_published) in [("lost", false), ("replaced", true)] {
            let mut scratch = ScratchFolder::new(folder.path()).unwrap();
            let former = scratch.former(&folder.path().join(target)).unwrap();
            fs::create_dir(&former).unwrap();
            fs::write(former.join("former"), "").unwrap();
            if is_published {
                fs::create_dir(folder.path().join(target)).unwrap();
            }
            // As a killed process leaves it.
            let left = scratch.path().to_owned();
            scratch.renamed();
            drop(scratch);
            age(&left, Duration::from_secs(2));
        }
        sweep(folder.path());
        assert_eq!(names(folder.path()), ["lost", "replaced"]);
        assert_eq!(names(&folder.path().join("lost")), ["former"]);
        assert!(names(&folder.path().join("replaced")).is_empty());
    }
}
