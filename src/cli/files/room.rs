//! Whether a disk has room for what a run will write: told before the work.
use std::ffi::CString;
use std::os::unix::ffi::OsStrExt;
use std::path::Path;

/// Bytes that a vertex takes in files at the least: half of what it takes in a .meshb and its .solb, since a forecast may be wrong by a factor of 2.
const BYTES_A_VERTEX: f64 = 100.0;

/// Why a mesh of so many vertices cannot be written to this path.
pub fn lacking(path: &Path, vertices: f64) -> Option<String> {
    let (free, needed) = (free(path.parent()?)?, BYTES_A_VERTEX * vertices);
    (free < needed).then(|| {
        let [free, needed] = [free, needed].map(|bytes| bytes / 1e6);
        format!(
            "{}: its disk has {free:.1} MB free, and a mesh of about {vertices:.0} vertices takes at least {needed:.1} MB: make room, write \
             elsewhere, or ask for less",
            path.display()
        )
    })
}

/// Why so many bytes cannot be written to a folder.
pub fn lacking_bytes(folder: &Path, needed: f64) -> Option<String> {
    let free = free(folder)?;
    (free < needed).then(|| {
        let [free, needed] = [free, needed].map(|bytes| bytes / 1e6);
        format!("{}: its disk has {free:.1} MB free, and {needed:.1} MB are wanted", folder.display())
    })
}

/// Bytes that we may write to the disk of a folder, as far as the system tells: some network disks say that they have no blocks at all.
fn free(folder: &Path) -> Option<f64> {
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let path = CString::new(folder.as_os_str().as_bytes()).ok()?;
    let mut found = std::mem::MaybeUninit::<libc::statvfs>::zeroed();
    // SAFETY: the path ends with a zero, and zeros are a value of the structure, which the call fills.
    let (code, found) = unsafe { (libc::statvfs(path.as_ptr(), found.as_mut_ptr()), found.assume_init()) };
    (code == 0 && found.f_blocks > 0).then_some(found.f_bavail as f64 * found.f_frsize as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_disk_has_room_for_little_and_not_for_everything() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.meshb");
        assert_eq!(lacking(&path, 1.0), None);
        let told = lacking(&path, 1e15).unwrap();
        assert!(told.contains("a.meshb") && told.contains("MB free"), "{told}");
        // A folder that nobody knows tells nothing here: that is found elsewhere.
        assert_eq!(lacking(&folder.path().join("none/a.meshb"), 1e15), None);
        assert!(lacking(Path::new("a.meshb"), 1e15).is_some());
    }
}
