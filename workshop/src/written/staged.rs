//! One file on its way to the disk. In: a name and what fills the file. Out: the file under that name, whole; or nothing
//! changed, and nothing left beside it.
//!
//! The content goes into a file of another name in the same folder and takes its name when it is complete. So the name is a
//! whole file at every instant, and other hard links of a replaced file keep what it held. The new file takes the permissions
//! of the file that it replaces, or those that the user's mask gives. If the name is a symbolic link, its target is replaced. A file that
//! may not be written is not replaced. A pipe or a device is written to directly.

use std::fs::{self, File, OpenOptions};
use std::io;
use std::path::{Path, PathBuf};

/// The longest chain of symbolic links that is followed, as on Linux.
const MOST_LINKS: usize = 40;

/// The largest number of files of other attempts that may be in the way.
const MOST_ATTEMPTS: u32 = 1000;

/// A complete file that does not have its final name yet. If it is dropped before [`Self::keep`], it is deleted.
#[derive(Debug)]
pub struct Staged {
    /// Where it is, and its name; nothing where the content is at its place already.
    names: Option<(PathBuf, PathBuf)>,
}

impl Staged {
    /// Writes the content to a temporary file in the folder of `target`, and waits until it is on the disk.
    pub fn write(target: &Path, fill: impl FnOnce(&mut File) -> io::Result<()>) -> io::Result<Self> {
        let target = behind_links(target)?;
        let there = match fs::metadata(&target) {
            Ok(there) => Some(there),
            Err(error) if error.kind() == io::ErrorKind::NotFound => None,
            Err(error) => return Err(error),
        };
        if there.as_ref().is_some_and(|there| !there.is_file() && !there.is_dir()) {
            fill(&mut OpenOptions::new().write(true).open(&target)?)?;
            return Ok(Self { names: None });
        }
        let permissions = there.map(|there| there.permissions());
        if permissions.as_ref().is_some_and(fs::Permissions::readonly) {
            return Err(io::Error::new(io::ErrorKind::PermissionDenied, "the file is read-only"));
        }
        let (mut file, part) = create_beside(&target)?;
        let staged = Self { names: Some((part, target)) };
        // Before anything is in it that others may not read.
        if let Some(permissions) = permissions {
            file.set_permissions(permissions)?;
        }
        fill(&mut file)?;
        file.sync_all()?;
        Ok(staged)
    }

    /// Gives the file its name.
    pub fn keep(mut self) -> io::Result<()> {
        if let Some((part, target)) = &self.names {
            fs::rename(part, target)?;
            self.names = None;
        }
        Ok(())
    }
}

impl Drop for Staged {
    fn drop(&mut self) {
        if let Some((part, _)) = &self.names {
            // What is left of the attempt is of no use; that it cannot be removed is not the failure to tell of.
            let _ = fs::remove_file(part);
        }
    }
}

/// The place that a name stands for, whether or not there is a file yet.
fn behind_links(name: &Path) -> io::Result<PathBuf> {
    let mut place = name.to_owned();
    for _ in 0..=MOST_LINKS {
        match fs::read_link(&place) {
            // A link is counted from its own folder; an absolute one replaces it.
            Ok(next) => place = place.parent().unwrap_or_else(|| Path::new("")).join(next),
            // No link, or nothing at all.
            Err(_) => return Ok(place),
        }
    }
    Err(io::Error::other("too many links lead to other links"))
}

/// A new file in the folder of another one, with a name that is short whatever the other is called.
fn create_beside(target: &Path) -> io::Result<(File, PathBuf)> {
    let process = std::process::id();
    for attempt in 0..MOST_ATTEMPTS {
        let part = target.with_file_name(format!(".abbe.{process}.{attempt}.part"));
        match OpenOptions::new().write(true).create_new(true).open(&part) {
            Ok(file) => return Ok((file, part)),
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {}
            Err(error) => return Err(error),
        }
    }
    Err(io::Error::new(io::ErrorKind::AlreadyExists, "files from unfinished attempts are in the way"))
}
