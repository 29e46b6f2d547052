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
    let removed = |root| FoundDirectory::Removed {
        root,
        killed: Vec::new(),
    };
    let expected = [
        FoundDirectory::Alive(unknown),
        removed(free),
        removed(missing),
    ];
    assert_eq!(clean_below(&base).unwrap(), expected);
    assert_eq!(names(&base), ["other", "r1"]);
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
