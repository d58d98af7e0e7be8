use super::*;
use std::ffi::OsString;

fn names(folder: &Path) -> Vec<OsString> {
    fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name()).collect()
}

#[test]
fn a_failure_leaves_the_old_file_and_no_other() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("report.json");
    write_beside(&path, |w| w.write_all(b"old")).unwrap();
    let error = write_beside(&path, |w| {
        w.write_all(&[b'x'; 1 << 20])?;
        Err(io::Error::other("disk full"))
    });
    assert_eq!(error.unwrap_err().to_string(), format!("{}: disk full", path.display()));
    assert_eq!(fs::read(&path).unwrap(), b"old");
    assert_eq!(names(folder.path()), ["report.json"]);
    write_beside(&path, |w| w.write_all(b"new")).unwrap();
    assert_eq!(fs::read(&path).unwrap(), b"new");
    assert_eq!(names(folder.path()), ["report.json"]);
}

#[test]
fn a_missing_folder_a_folder_and_a_read_only_file_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let message = |path: &Path| write_beside(path, |w| w.write_all(b"new")).unwrap_err().to_string();
    assert!(message(&folder.path().join("no/where.mesh")).ends_with("no; make it first"));
    assert!(message(folder.path()).ends_with("this is a folder; name a file"));
    let fixed = folder.path().join("fixed");
    fs::write(&fixed, "old").unwrap();
    let mut permissions = fs::metadata(&fixed).unwrap().permissions();
    permissions.set_readonly(true);
    fs::set_permissions(&fixed, permissions).unwrap();
    assert!(message(&fixed).contains("read-only"));
    assert_eq!(fs::read(&fixed).unwrap(), b"old");
}

#[cfg(unix)]
#[test]
fn a_link_stays_and_its_target_is_replaced() {
    let folder = tempfile::tempdir().unwrap();
    let (file, link) = (folder.path().join("file"), folder.path().join("link"));
    fs::write(&file, "old").unwrap();
    std::os::unix::fs::symlink(&file, &link).unwrap();
    write_beside(&link, |w| w.write_all(b"new")).unwrap();
    assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
    assert_eq!(fs::read(&file).unwrap(), b"new");
}

#[test]
fn files_that_belong_together_come_together_or_not_at_all() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let (mesh, solution) = (path("a.meshb"), path("a.solb"));
    write_beside(&mesh, |w| w.write_all(b"old mesh")).unwrap();
    let mut batch = Batch::new();
    batch.add_main(&mesh, |w| w.write_all(b"mesh")).unwrap();
    assert!(batch.add(&solution, |_| Err(io::Error::other("disk full"))).is_err());
    drop(batch);
    assert_eq!(names(folder.path()), ["a.meshb"]);
    assert_eq!(fs::read(&mesh).unwrap(), b"old mesh");
    let mut batch = Batch::new();
    batch.add_main(&mesh, |w| w.write_all(b"mesh")).unwrap();
    batch.add(&solution, |w| w.write_all(b"solution")).unwrap();
    assert!(!solution.exists() && fs::read(&mesh).unwrap() == b"old mesh");
    batch.commit().unwrap();
    assert!(fs::read(&solution).unwrap() == b"solution" && fs::read(&mesh).unwrap() == b"mesh");
    assert_eq!(names(folder.path()).len(), 2);
}

#[test]
fn an_open_file_is_written_until_all_come() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.meshb");
    fs::write(&path, b"old").unwrap();
    let mut batch = Batch::new();
    let mut file = batch.open(&path, true).unwrap();
    assert_eq!(file.metadata().unwrap().len(), 0);
    file.write_all(b"new").unwrap();
    assert_eq!(fs::read(&path).unwrap(), b"old");
    assert_eq!(fs::read(batch.beside(&path).unwrap()).unwrap(), b"new");
    assert_eq!(batch.beside(&folder.path().join("b.meshb")), None);
    batch.commit().unwrap();
    assert_eq!(fs::read(&path).unwrap(), b"new");
    drop(Batch::new().open(&path, false).unwrap());
    assert_eq!((names(folder.path()).len(), fs::read(&path).unwrap()), (1, b"new".to_vec()));
    let mut batch = Batch::new();
    let inside = folder.path().join("new/b.meshb");
    batch.folder(&folder.path().join("new")).unwrap();
    batch.open(&inside, false).unwrap().write_all(b"inside").unwrap();
    batch.commit().unwrap();
    assert_eq!(fs::read(inside).unwrap(), b"inside");
    #[cfg(unix)]
    assert!(Batch::new().open(Path::new("/dev/null"), false).unwrap_err().to_string().contains("is a device"));
}

#[test]
fn the_main_file_is_renamed_last() {
    let folder = tempfile::tempdir().unwrap();
    let (mesh, solution) = (folder.path().join("a.meshb"), folder.path().join("a.solb"));
    let mut batch = Batch::new();
    batch.add_main(&mesh, |w| w.write_all(b"mesh")).unwrap();
    batch.add(&solution, |w| w.write_all(b"solution")).unwrap();
    fs::create_dir(&solution).unwrap(); // the rename fails
    assert!(batch.commit().unwrap_err().to_string().contains("a.solb"));
    assert!(!mesh.exists());
    assert_eq!(names(folder.path()), ["a.solb"]);
}

#[test]
fn a_new_folder_comes_with_its_files_or_not_at_all() {
    let folder = tempfile::tempdir().unwrap();
    let case = folder.path().join("case");
    let fill = |batch: &mut Batch| {
        batch.folder(&case.join("constant/polyMesh")).unwrap();
        batch.add(&case.join("constant/polyMesh/points"), |w| w.write_all(b"points")).unwrap();
        batch.folder(&case.join("0")).unwrap();
        batch.add(&case.join("0/p"), |w| w.write_all(b"p")).unwrap();
    };
    let mut batch = Batch::new();
    fill(&mut batch);
    assert!(!case.exists());
    drop(batch);
    assert_eq!(names(folder.path()), [""; 0]);
    let mut batch = Batch::new();
    fill(&mut batch);
    batch.commit().unwrap();
    assert_eq!(fs::read(case.join("constant/polyMesh/points")).unwrap(), b"points");
    assert_eq!(fs::read(case.join("0/p")).unwrap(), b"p");
    assert_eq!(names(folder.path()), ["case"]);
    let told = Batch::new().folder(&case.join("0/p/deeper")).unwrap_err().to_string();
    assert!(told.contains("there is a file of this name") || told.contains("ot a directory"), "{told}");
    assert!(Batch::new().folder(&case.join("new/../more")).unwrap_err().to_string().contains("without it"));
}

#[test]
fn a_name_as_long_as_the_file_system_takes_can_be_written() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a".repeat(255));
    write_beside(&path, |w| w.write_all(b"new")).unwrap();
    assert_eq!(fs::read(&path).unwrap(), b"new");
}

#[cfg(unix)]
#[test]
fn a_link_to_nothing_is_followed_and_a_circle_is_refused() {
    use std::os::unix::fs::symlink;
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    fs::create_dir(path("data")).unwrap();
    symlink("data/run", path("latest")).unwrap();
    write_beside(&path("latest"), |w| w.write_all(b"new")).unwrap();
    assert!(fs::symlink_metadata(path("latest")).unwrap().is_symlink());
    assert_eq!(fs::read(path("data/run")).unwrap(), b"new");
    symlink("one", path("two")).unwrap();
    symlink("two", path("one")).unwrap();
    assert!(write_beside(&path("one"), |w| w.write_all(b"new")).is_err());
    assert!(fs::symlink_metadata(path("one")).unwrap().is_symlink());
    symlink("none/run", path("lost")).unwrap();
    assert!(write_beside(&path("lost"), |w| w.write_all(b"new")).unwrap_err().to_string().contains("no folder"));
}

#[cfg(unix)]
#[test]
fn who_holds_the_folder_is_not_waited_for_for_ever() {
    let folder = tempfile::tempdir().unwrap();
    let held = File::open(folder.path()).unwrap();
    held.lock().unwrap();
    let mut batch = Batch::new();
    for name in ["a", "b"] {
        batch.add(&folder.path().join(name), |w| w.write_all(b"new")).unwrap();
    }
    batch.commit().unwrap();
    assert_eq!(names(folder.path()).len(), 2);
}

#[test]
fn what_a_killed_run_was_writing_goes_with_the_next() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let long_ago = std::time::SystemTime::now() - Duration::from_secs(60);
    let make = |name: &str| {
        let file = File::create(path(name)).unwrap();
        file.set_modified(long_ago).unwrap();
        file
    };
    let left = [".out.meshb.4711-0.tmp", ".out.meshb.1-12.tmp"];
    left.iter().for_each(|name| drop(make(name)));
    let kept = [".out.meshb.4711.tmp", ".out.meshb.a-0.tmp", ".other.meshb.4711-0.tmp", ".out.meshb.4711-1.tmp"];
    let files = kept.map(make);
    // The last one is in use, another is new.
    files[3].lock().unwrap();
    fs::write(path(".out.meshb.4711-2.tmp"), b"half").unwrap();
    write_beside(&path("out.meshb"), |w| w.write_all(b"new")).unwrap();
    assert!(left.iter().all(|name| !path(name).exists()));
    assert!(kept.iter().all(|name| path(name).exists()) && path(".out.meshb.4711-2.tmp").exists());
    // Where a folder was being written.
    fs::create_dir_all(path(".case.1-0.tmp/constant")).unwrap();
    File::open(path(".case.1-0.tmp")).unwrap().set_modified(long_ago).unwrap();
    write_beside(&path("case"), |w| w.write_all(b"new")).unwrap();
    assert!(!path(".case.1-0.tmp").exists());
}
