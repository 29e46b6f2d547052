use super::*;

fn mode(path: &Path, mode: u32) {
    std::fs::set_permissions(path, Permissions::from_mode(mode)).unwrap();
}

fn names(base: &Path) -> Vec<String> {
    let mut names: Vec<String> = std::fs::read_dir(base)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    names
}

#[test]
fn a_run_is_alive_until_its_owner_ends_and_leaves_nothing() {
    let directory = tempfile::tempdir().unwrap();
    let base = directory.path().join("protean");
    assert_eq!(clean_below(&base).unwrap(), []);
    let owned = RunDirectory::create_in(&base).unwrap();
    let root = owned.space().root().to_owned();
    assert_eq!(
        clean_below(&base).unwrap(),
        [FoundDirectory::Alive(root.clone())]
    );
    assert!(root.join(LOCK).exists());
    drop(owned);
    assert_eq!(names(&base), [] as [&str; 0]);
    assert_eq!(clean_below(&base).unwrap(), []);
}

#[test]
fn only_a_lock_that_is_free_or_missing_means_that_a_run_is_abandoned() {
    let directory = tempfile::tempdir().unwrap();
    let base = directory.path().join("protean");
    make_private(&base).unwrap();
    let root = |name: &str| {
        let root = base.join(name);
        std::fs::create_dir(&root).unwrap();
        root
    };
    // An unreadable lock, as with too many open files.
    let unknown = root("r1");
    std::fs::create_dir(unknown.join(LOCK)).unwrap();
    let free = root("r2");
    File::create(free.join(LOCK)).unwrap();
    let missing = root("r3");
    let half_made = root("tmp-4");
    File::create(half_made.join(LOCK)).unwrap();
    root("tmp-5");
    root("other");
    // A directory under construction, also with an unreadable lock.
    let unknown_new = root("tmp-6");
    std::fs::create_dir(unknown_new.join(LOCK)).unwrap();
    let reason = "kept, since its lock cannot be used: Is a directory (os error 21)".to_owned();
    let expected = [
        FoundDirectory::Failed(unknown, reason.clone()),
        removed(free, Vec::new()),
        removed(missing, Vec::new()),
        FoundDirectory::Failed(unknown_new, reason),
    ];
    assert_eq!(clean_below(&base).unwrap(), expected);
    assert_eq!(names(&base), ["other", "r1", "tmp-6"]);
}

#[test]
fn memory_of_a_run_with_another_directory_is_removed_once_no_process_uses_it() {
    let directory = tempfile::tempdir().unwrap();
    let base = directory.path().join("protean");
    let id = std::process::id();
    let memory = |name: &str| {
        let path = PathBuf::from(format!("/dev/shm/protean_rM{id}{name}"));
        std::fs::write(&path, "").unwrap();
        path
    };
    let used = [memory("a_turn"), memory("a_lock")];
    let unused = [memory("b_turn"), memory("b_lock")];
    let without_lock = memory("c_turn");
    let lock = File::open(&used[1]).unwrap();
    lock.lock_shared().unwrap();
    let clean =
        |known: &[FoundDirectory]| clean_memory(&base, &format!("protean_rM{id}"), known).unwrap();
    let of = |name: &str| PathBuf::from(format!("/dev/shm/protean_rM{id}{name}_"));
    // Its directory was examined before.
    let known = FoundDirectory::Alive(base.join(format!("rM{id}b")));
    assert_eq!(clean(&[known]), []);
    assert_eq!(clean(&[]), [removed(of("b"), Vec::new())]);
    assert!(unused.iter().all(|path| !path.exists()));
    assert!(used.iter().all(|path| path.exists()));
    drop(lock);
    assert_eq!(clean(&[]), [removed(of("a"), Vec::new())]);
    assert!(without_lock.exists());
    std::fs::remove_file(without_lock).unwrap();
}

#[test]
fn runs_can_be_created_while_others_clean() {
    use std::sync::atomic::{AtomicBool, Ordering};
    let directory = tempfile::tempdir().unwrap();
    let base = directory.path().join("protean");
    make_private(&base).unwrap();
    let stop = AtomicBool::new(false);
    std::thread::scope(|scope| {
        scope.spawn(|| {
            while !stop.load(Ordering::SeqCst) {
                for found in clean_below(&base).unwrap() {
                    assert!(!matches!(found, FoundDirectory::Failed(..)), "{found:?}");
                }
            }
        });
        for _ in 0..200 {
            let owned = RunDirectory::create_in(&base).unwrap();
            assert!(owned.space().root().join(LOCK).exists());
        }
        stop.store(true, Ordering::SeqCst);
    });
    assert_eq!(names(&base), [] as [&str; 0]);
}

#[test]
fn a_directory_that_others_can_open_or_swap_is_refused_by_its_name() {
    let directory = tempfile::tempdir().unwrap();
    let refused = |base: &Path| RunDirectory::create_in(base).err().map(|e| e.to_string());
    let above = directory.path().join("above");
    std::fs::create_dir(&above).unwrap();
    let base = above.join("protean");
    for (of_above, of_base, named) in [
        (0o700, 0o755, Some(&base)),
        (0o700, 0o770, Some(&base)),
        (0o777, 0o700, Some(&above)),
        (0o1777, 0o700, None),
        (0o755, 0o700, None),
    ] {
        std::fs::create_dir(&base).unwrap();
        mode(&base, of_base);
        mode(&above, of_above);
        match (refused(&base), named) {
            (None, None) => {}
            (Some(error), Some(path)) => {
                let start = format!("{}: ", path.display());
                assert!(error.starts_with(&start), "{error}");
            }
            (found, _) => panic!("{of_above:o} {of_base:o}: {found:?}"),
        }
        std::fs::remove_dir(&base).unwrap();
    }
    if !rustix::process::getuid().is_root() {
        eprintln!("skipped: only root can give a directory away");
        return;
    }
    for given in [&base, &above] {
        std::fs::create_dir_all(&base).unwrap();
        mode(&base, 0o700);
        std::os::unix::fs::chown(given, Some(65534), None).unwrap();
        let error = refused(&base).unwrap();
        assert!(error.starts_with(&format!("{}: owned by user 65534", given.display())));
        std::os::unix::fs::chown(&base, Some(0), None).unwrap();
    }
}

#[test]
fn a_link_to_nowhere_is_refused_by_its_name() {
    let directory = tempfile::tempdir().unwrap();
    let base = directory.path().join("protean");
    std::os::unix::fs::symlink(directory.path().join("nowhere"), &base).unwrap();
    let error = RunDirectory::create_in(&base).err().unwrap().to_string();
    assert!(error.starts_with(base.to_str().unwrap()), "{error}");
}
