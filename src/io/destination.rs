//! The thing behind a path, through every link: a file, which is replaced as a whole, or a pipe or device, which takes bytes.

use std::fs::{self, Metadata, OpenOptions};
use std::io::{self, Write};
use std::path::{Component, Path, PathBuf};

/// Links that are followed, as most systems do.
const MOST_LINKS: usize = 40;

/// The thing behind a path.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Destination {
    /// A plain file, or nothing yet: its own path, free of links.
    File(PathBuf),
    /// Standard output, wherever it leads.
    Stdout,
    /// Standard error, wherever it leads.
    Stderr,
    /// A pipe or a device.
    Stream(PathBuf),
    /// A folder.
    Folder(PathBuf),
}

impl Destination {
    /// Looks behind a path.
    pub fn of(path: &Path) -> Destination {
        let Ok(about) = fs::metadata(path) else {
            return Destination::File(resolved(path));
        };
        if about.is_dir() {
            return Destination::Folder(path.into());
        }
        match standard(&about) {
            Some(place) => place,
            None if about.is_file() => Destination::File(resolved(path)),
            None => Destination::Stream(path.into()),
        }
    }

    /// Writes bytes into a pipe, a device or a standard stream; `false` where it is none.
    pub fn pour(&self, bytes: &[u8]) -> io::Result<bool> {
        match self {
            Destination::Stdout => io::stdout()
                .write_all(bytes)
                .and_then(|()| io::stdout().flush())?,
            Destination::Stderr => io::stderr().write_all(bytes)?,
            Destination::Stream(path) => OpenOptions::new()
                .write(true)
                .open(path)?
                .write_all(bytes)?,
            Destination::File(_) | Destination::Folder(_) => return Ok(false),
        }
        Ok(true)
    }
}

/// The standard stream that a file is, if any: `/dev/stdout`, or the file that standard output goes into.
#[cfg(unix)]
fn standard(about: &Metadata) -> Option<Destination> {
    use std::os::fd::AsFd;
    let is = |stream: std::os::fd::BorrowedFd| {
        let file = stream.try_clone_to_owned().map(fs::File::from);
        let stream = file.and_then(|file| file.metadata()).ok();
        stream.is_some_and(|stream| inode(&stream) == inode(about))
    };
    match (is(io::stdout().as_fd()), is(io::stderr().as_fd())) {
        (true, _) => Some(Destination::Stdout),
        (_, true) => Some(Destination::Stderr),
        _ => None,
    }
}

#[cfg(not(unix))]
fn standard(_: &Metadata) -> Option<Destination> {
    None
}

/// Device and number of a file: the same for all its names.
#[cfg(unix)]
pub fn inode(about: &Metadata) -> Option<(u64, u64)> {
    use std::os::unix::fs::MetadataExt;
    Some((about.dev(), about.ino()))
}

/// Device and number of a file, where the system tells them.
#[cfg(not(unix))]
pub fn inode(_: &Metadata) -> Option<(u64, u64)> {
    None
}

/// The path free of links and of `..`, whether something is there or not.
pub fn resolved(path: &Path) -> PathBuf {
    let mut path = path.to_path_buf();
    for _ in 0..MOST_LINKS {
        if let Ok(whole) = fs::canonicalize(&path) {
            return whole;
        }
        // A link to nothing is a file to be.
        match fs::read_link(&path) {
            Ok(target) => path = folder(&path).join(target),
            Err(_) => break,
        }
    }
    match path.components().next_back() {
        Some(Component::Normal(name)) => resolved(folder(&path)).join(name),
        Some(Component::ParentDir) => {
            let mut inner = resolved(folder(&path));
            inner.pop();
            inner
        }
        Some(Component::CurDir) => resolved(folder(&path)),
        _ => path,
    }
}

/// The folder of a file, `.` where its path names none.
pub fn folder(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if folder != Path::new("") => folder,
        _ => Path::new("."),
    }
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;
    use std::os::unix::fs::symlink;

    #[test]
    fn links_lead_to_what_is_or_will_be_there() {
        let folder = tempfile::tempdir().expect("a folder");
        let at = |name: &str| folder.path().join(name);
        let real = fs::canonicalize(folder.path()).expect("a folder");
        fs::write(at("file"), "x").expect("a file");
        fs::create_dir(at("inner")).expect("a folder");
        symlink("file", at("near")).expect("a link");
        symlink("inner", at("door")).expect("a link");
        symlink("inner/new", at("empty")).expect("a link");
        symlink("loop", at("loop")).expect("a link");
        for (name, expected) in [
            ("near", "file"),
            ("door/../file", "file"),
            ("inner/../near", "file"),
            ("door/x.png", "inner/x.png"),
            ("empty", "inner/new"),
            ("nowhere/../file", "file"),
            ("nowhere/deep/x", "nowhere/deep/x"),
            ("loop", "loop"),
        ] {
            assert_eq!(resolved(&at(name)), real.join(expected), "{name}");
        }
        assert_eq!(
            Destination::of(&at("door")),
            Destination::Folder(at("door"))
        );
        assert_eq!(
            Destination::of(&at("near")),
            Destination::File(real.join("file"))
        );
    }

    #[test]
    fn devices_take_bytes_and_files_do_not() {
        let null = Destination::of(Path::new("/dev/null"));
        assert!(null.pour(b"x").expect("a device"));
        let full = Destination::Stream("/dev/full".into());
        if Path::new("/dev/full").exists() {
            let told = full.pour(b"x").expect_err("a full device");
            assert_eq!(told.kind(), io::ErrorKind::StorageFull);
        }
        assert!(!Destination::File("x".into()).pour(b"x").expect("no stream"));
    }
}
