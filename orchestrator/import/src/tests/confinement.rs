//! Files to which imported files refer.

use std::os::unix::fs::symlink;

use scenario::Loader;

use super::super::{Sizes, import};
use super::{Folder, MAP, SCEN};

const YAML: &str = "image: IMAGE\nresolution: 1\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.65\n\
                    free_thresh: 0.2\n";

#[test]
fn a_file_reads_no_file_outside_its_folder_without_permission() {
    let outside = Folder::new(&[("secret.map", MAP), ("secret.pgm", &image(12))]);
    let secret = |name: &str| outside.path(name).display().to_string();
    let relative = |name: &str| format!("{}{}", "../".repeat(20), &secret(name)[1..]);
    for (file, text, other) in [
        (
            "a.scen",
            SCEN.replace("maps/room.map", "OTHER"),
            "secret.map",
        ),
        ("a.yaml", YAML.replace("IMAGE", "OTHER"), "secret.pgm"),
    ] {
        let folder = Folder::new(&[]);
        symlink(secret(other), folder.path("link")).unwrap();
        for path in [secret(other), relative(other), "link".to_owned()] {
            std::fs::write(folder.path(file), text.replace("OTHER", &path)).unwrap();
            let error = folder.import(file, Sizes::default()).unwrap_err();
            let expected = format!("{file} refers to {path}: path leads out of");
            assert!(
                error.contains(&expected),
                "{expected:?} is not in {error:?}"
            );
            let loader = Loader::new(kinds::KINDS);
            let found = import(&folder.path(file), Sizes::default(), true, &loader);
            assert!(found.is_ok(), "{found:?}");
        }
    }
}

/// A free image with this side (pixels).
fn image(side: usize) -> String {
    format!("P2 {side} {side} 255\n") + &"254 ".repeat(side * side)
}
