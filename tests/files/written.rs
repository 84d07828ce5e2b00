//! Files that are written: whole or not at all, under the name that was given, with the permissions that were there.
#![cfg(target_os = "linux")]

use std::fs::{self, Permissions};
use std::os::unix::fs::{PermissionsExt, symlink};
use std::path::Path;
use std::process::Output;

use super::{RECORDING, folder, names, on_stage, program, run, stage, status, text};

/// Every command that writes files: its arguments, and the files that it writes. `@` is the folder of the stage.
const WRITERS: [(&[&str], &[&str]); 6] = [
    (
        &["simulate", "@/calibration.yaml", "@/path.yaml", "--output", "@/out", "--force"],
        &["out/data.csv", "out/recording.yaml"],
    ),
    (
        &[
            "simulate",
            "@/calibration.yaml",
            "@/path.yaml",
            "--output",
            "@/other",
            "--plot",
            "@/out.svg",
            "--force",
        ],
        &["out.svg"],
    ),
    (&["compensate", "@/calibration.yaml", "--map", "@/map.svg", "--force"], &["map.svg"]),
    (&["diagnose", "@/recording.yaml", "--write-calibration", "@/new.yaml"], &["new.yaml"]),
    (
        &["update", "@/calibration.yaml", "@/recording.yaml", "--output", "@/new.yaml", "--force"],
        &["new.yaml"],
    ),
    (&["man", "--output", "@/pages"], &["pages/abbe.1", "pages/abbe-derive.1"]),
];

fn mode(file: &Path) -> u32 {
    fs::metadata(file).unwrap().permissions().mode() & 0o7777
}

fn succeeds(output: &Output) {
    assert_eq!(status(output), 0, "{}", text(&output.stderr));
}

#[test]
fn a_new_file_has_the_permissions_of_the_mask() {
    for (arguments, files) in WRITERS {
        let folder = folder("mask");
        stage(&folder);
        let mut shell = std::process::Command::new("sh");
        let arguments = super::placed(arguments, &folder);
        let positions = fs::File::open(folder.join("positions.csv")).unwrap();
        shell.args(["-c", "umask 027; exec \"$0\" \"$@\"", env!("CARGO_BIN_EXE_abbe")]).args(arguments);
        succeeds(&shell.stdin(positions).output().unwrap());
        for file in files {
            assert_eq!(mode(&folder.join(file)), 0o640, "{file}");
        }
    }
}

#[test]
fn a_file_that_is_replaced_keeps_its_permissions() {
    for (arguments, files) in WRITERS {
        let folder = folder("kept");
        stage(&folder);
        for file in files {
            let file = folder.join(file);
            fs::create_dir_all(file.parent().unwrap()).unwrap();
            fs::write(&file, "before").unwrap();
            fs::set_permissions(&file, Permissions::from_mode(0o606)).unwrap();
        }
        succeeds(&on_stage(arguments, &folder));
        for file in files {
            let file = folder.join(file);
            assert_eq!(mode(&file), 0o606, "{}", file.display());
            assert_ne!(fs::read_to_string(&file).unwrap(), "before", "{}", file.display());
        }
    }
}

/// What the link names is replaced; the link stays one, also where it leads to a link or to nothing yet.
#[test]
fn a_link_is_followed() {
    for (arguments, files) in WRITERS {
        for there in [true, false] {
            let folder = folder("link");
            stage(&folder);
            fs::create_dir(folder.join("elsewhere")).unwrap();
            for file in files {
                let (link, name) = (folder.join(file), Path::new(file).file_name().unwrap());
                fs::create_dir_all(link.parent().unwrap()).unwrap();
                let real = folder.join("elsewhere").join(name);
                if there {
                    fs::write(&real, "before").unwrap();
                }
                let middle = folder.join("elsewhere").join(format!("to-{}", name.display()));
                symlink(name, &middle).unwrap();
                symlink(&middle, &link).unwrap();
            }
            succeeds(&on_stage(arguments, &folder));
            for file in files {
                let link = folder.join(file);
                assert!(fs::symlink_metadata(&link).unwrap().is_symlink(), "{file}");
                let real = folder.join("elsewhere").join(link.file_name().unwrap());
                let metadata = fs::symlink_metadata(&real).unwrap();
                assert!(metadata.is_file() && metadata.len() > 10, "{file}");
            }
        }
    }
}

/// A loop of links ends in an error.
#[test]
fn a_link_to_itself_is_refused() {
    let folder = folder("loop");
    stage(&folder);
    symlink("new.yaml", folder.join("new.yaml")).unwrap();
    let output = on_stage(WRITERS[3].0, &folder);
    assert_eq!(status(&output), 2);
    assert!(text(&output.stderr).contains("new.yaml"), "{}", text(&output.stderr));
}

/// Whoever takes the right to write away means it, whatever the folder allows and whoever asks.
#[test]
fn a_read_only_file_is_not_replaced() {
    for (arguments, files) in WRITERS {
        for file in files {
            let folder = folder("read-only");
            stage(&folder);
            let kept = folder.join(file);
            fs::create_dir_all(kept.parent().unwrap()).unwrap();
            fs::write(&kept, "before").unwrap();
            fs::set_permissions(&kept, Permissions::from_mode(0o444)).unwrap();
            let output = on_stage(arguments, &folder);
            let err = text(&output.stderr);
            assert_eq!(status(&output), 2, "{file}: {err}");
            assert!(err.contains("read-only") && err.contains(kept.to_str().unwrap()), "{err}");
            assert_eq!(fs::read_to_string(&kept).unwrap(), "before");
            nothing_is_left(&folder);
        }
    }
}

/// The file systems of the kernel take no file from anybody, also not from a superuser.
#[test]
fn a_folder_that_takes_no_file() {
    let folder = folder("no-file");
    stage(&folder);
    for (arguments, _) in WRITERS {
        let arguments: Vec<&str> = arguments
            .iter()
            .map(|argument| match *argument {
                "@/out" | "@/out.svg" | "@/map.svg" | "@/new.yaml" | "@/pages" => {
                    "/proc/abbe-writes-here.yaml"
                }
                other => other,
            })
            .collect();
        let output = on_stage(&arguments, &folder);
        let err = text(&output.stderr);
        assert_eq!(status(&output), 2, "{arguments:?}: {err}");
        assert!(err.contains("/proc"), "{err}");
    }
}

/// A disk that fills up while a file grows: here the limit of a file's size, which gives the same kind of error.
#[test]
fn a_disk_that_fills_up_leaves_what_was_there() {
    for (arguments, files) in WRITERS {
        let folder = folder("full");
        stage(&folder);
        let data: String = (0..2000).map(|row| format!("{row},1,{0},{0}\n", row % 40)).collect();
        fs::write(folder.join("data.csv"), format!("t,run,x,m\n{data}")).unwrap();
        let long = format!("title: {}\n", "a long title ".repeat(400));
        fs::write(folder.join("recording.yaml"), format!("{RECORDING}{long}")).unwrap();
        for file in files {
            let file = folder.join(file);
            fs::create_dir_all(file.parent().unwrap()).unwrap();
            fs::write(&file, "before").unwrap();
        }
        let arguments = super::placed(arguments, &folder);
        let mut shell = std::process::Command::new("sh");
        let positions = fs::File::open(folder.join("positions.csv")).unwrap();
        // Without the trap the system would end the program before it can tell.
        shell.args(["-c", "trap '' XFSZ; ulimit -f 0; exec \"$0\" \"$@\"", env!("CARGO_BIN_EXE_abbe")]);
        let output = shell.args(arguments).stdin(positions).output().unwrap();
        let err = text(&output.stderr);
        assert_eq!(status(&output), 2, "{files:?}: {err}");
        assert!(err.contains("error: cannot write"), "{err}");
        for file in files {
            assert_eq!(fs::read_to_string(folder.join(file)).unwrap(), "before", "{file}");
        }
        nothing_is_left(&folder);
    }
}

/// What is no file is written to as it is: a device is not replaced by a file of its name.
#[test]
fn a_device_is_written_to() {
    let folder = folder("device");
    stage(&folder);
    let full = folder.join("new.yaml");
    symlink("/dev/full", &full).unwrap();
    let output = on_stage(WRITERS[3].0, &folder);
    let err = text(&output.stderr);
    assert_eq!(status(&output), 2, "{err}");
    assert!(err.contains("error: cannot write"), "{err}");
    assert!(!fs::metadata("/dev/full").unwrap().is_file());
}

/// A pipe with a name is one too: whoever reads it gets the file.
#[test]
fn a_named_pipe_is_written_to() {
    let folder = folder("pipe");
    stage(&folder);
    let pipe = folder.join("new.yaml");
    assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    let reader = std::thread::spawn({
        let pipe = pipe.clone();
        move || fs::read_to_string(pipe).unwrap()
    });
    succeeds(&on_stage(WRITERS[3].0, &folder));
    assert!(reader.join().unwrap().contains("calibration: 1"));
    assert!(!fs::metadata(&pipe).unwrap().is_file());
}

/// A name as long as the file system takes is a good name.
#[test]
fn a_long_name() {
    let folder = folder("long");
    stage(&folder);
    let name = format!("{}.yaml", "n".repeat(250));
    let target = folder.join(&name);
    let recording = folder.join("recording.yaml");
    succeeds(&run(&[
        "diagnose".as_ref(),
        recording.as_os_str(),
        "--write-calibration".as_ref(),
        target.as_os_str(),
    ]));
    assert!(target.is_file());
    nothing_is_left(&folder);
}

/// Two runs at once into one name: each file is one of the two, whole.
#[test]
fn two_writers_at_once() {
    let folder = folder("at-once");
    stage(&folder);
    let start = |seed: &str| {
        let mut command = program();
        command.args(super::placed(WRITERS[0].0, &folder)).args(["--seed", seed]);
        command.stderr(std::process::Stdio::null()).spawn().unwrap()
    };
    let children: Vec<_> = ["1", "2", "3", "4"].map(start).into_iter().collect();
    for mut child in children {
        assert!(child.wait().unwrap().success());
    }
    let alone = super::folder("alone");
    stage(&alone);
    succeeds(&on_stage(WRITERS[0].0, &alone));
    // Without noise all seeds give the same table.
    let read = |folder: &Path| fs::read_to_string(folder.join("out/data.csv")).unwrap();
    assert_eq!(read(&folder), read(&alone));
    nothing_is_left(&folder);
}

/// No file of an unfinished attempt, in any folder below.
fn nothing_is_left(folder: &Path) {
    for name in names(folder) {
        assert!(!name.contains(".part"), "{name} is left in {}", folder.display());
        let below = folder.join(&name);
        if below.is_dir() {
            nothing_is_left(&below);
        }
    }
}
