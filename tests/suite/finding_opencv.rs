//! `scripts/pkg-config`: what it tells a build about OpenCV, on simulated systems in test folders.

use super::support::{Captured, finish_process, root};
use std::fs;
use std::os::unix::fs::{PermissionsExt, symlink};
use std::path::Path;
use std::process::Command;
use tempfile::TempDir;

/// A system without pkg-config, with its files below a folder.
struct System {
    folder: TempDir,
}

impl System {
    fn new() -> System {
        let folder = tempfile::tempdir().unwrap();
        let programs = folder.path().join("programs");
        fs::create_dir(&programs).unwrap();
        for name in ["dirname", "id", "sed", "sh", "sleep", "uname"] {
            let found = ["/bin", "/usr/bin"].map(|bin| Path::new(bin).join(name));
            let found = found.iter().find(|path| path.exists()).expect(name);
            symlink(found, programs.join(name)).unwrap();
        }
        System { folder }
    }

    fn write(&self, path: &str, text: &str) {
        let path = self.folder.path().join(path);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, text).unwrap();
    }

    /// Adds a shell script as a program.
    fn program(&self, name: &str, text: &str) {
        let path = format!("programs/{name}");
        self.write(&path, &format!("#!/bin/sh\n{text}\n"));
        let path = self.folder.path().join(path);
        fs::set_permissions(path, fs::Permissions::from_mode(0o755)).unwrap();
    }

    /// Installs OpenCV as the system would; returns the folders of its headers and libraries.
    fn bring_opencv(&self, libraries: &str) -> [String; 2] {
        let (prefix, ending) = match cfg!(target_os = "macos") {
            true => ("opt/homebrew/opt/opencv", "dylib"),
            false => ("usr", "so"),
        };
        for module in ["core", "imgproc"] {
            self.write(
                &format!("{prefix}/include/opencv4/opencv2/{module}.hpp"),
                "",
            );
            self.write(
                &format!("{prefix}/{libraries}/libopencv_{module}.{ending}"),
                "",
            );
        }
        self.write(
            &format!("{prefix}/include/opencv4/opencv2/core/version.hpp"),
            "#define CV_VERSION_MAJOR    4\n#define CV_VERSION_MINOR    9\n#define CV_VERSION_REVISION 3\n\
             #define CV_VERSION_STATUS   \"\"\n",
        );
        let root = self.folder.path().display();
        [
            format!("{root}/{prefix}/include/opencv4"),
            format!("{root}/{prefix}/{libraries}"),
        ]
    }

    fn command(&self, words: &str) -> Command {
        let mut command = Command::new(root().join("scripts/pkg-config"));
        command
            .args(words.split(' '))
            .env_clear()
            .env("PATH", self.folder.path().join("programs"))
            .env("PKG_CONFIG_SYSROOT_DIR", self.folder.path());
        command
    }

    fn ask(&self, words: &str) -> Captured {
        finish_process(&mut self.command(words))
    }
}

#[test]
fn opencv_is_found_without_pkg_config() {
    let system = System::new();
    let [headers, libraries] = system.bring_opencv("lib");
    let said = system.ask("--libs --cflags opencv4");
    assert_eq!(said.code, 0, "{}", said.stderr);
    let expected = format!("-L{libraries} -lopencv_imgproc -lopencv_core -I{headers}\n");
    assert_eq!(said.stdout, expected);
    assert_eq!(system.ask("--modversion opencv4").stdout, "4.9.3\n");
    assert_eq!(system.ask("--exists opencv4").code, 0);
    for other in ["opencv5", "opencv"] {
        let said = system.ask(&format!("--libs --cflags {other}"));
        assert_eq!((said.code, said.stderr.as_str()), (1, ""), "{other}");
    }
}

#[test]
#[cfg(target_os = "linux")]
fn the_folders_of_an_architecture_are_found() {
    let system = System::new();
    let [headers, libraries] = system.bring_opencv("lib/x86_64-linux-gnu");
    let own = "usr/include/x86_64-linux-gnu/opencv4";
    system.write(&format!("{own}/opencv2/cvconfig.h"), "");
    let own = system.folder.path().join(own).display().to_string();
    let said = system.ask("--libs --cflags opencv4");
    let expected = format!("-L{libraries} -lopencv_imgproc -lopencv_core -I{headers} -I{own}\n");
    assert_eq!(said.stdout, expected, "{}", said.stderr);
}

#[test]
fn the_real_pkg_config_answers_what_it_can() {
    let system = System::new();
    system.bring_opencv("lib");
    system.program("pkg-config", "echo \"real: $*\"");
    for words in ["--libs --cflags opencv4", "--modversion openssl"] {
        assert_eq!(system.ask(words).stdout, format!("real: {words}\n"));
    }
}

#[test]
fn a_pkg_config_that_does_not_know_opencv_is_helped() {
    let system = System::new();
    let [headers, _] = system.bring_opencv("lib");
    system.program("pkgconf", "echo \"real: $*\"; exit 1");
    let said = system.ask("--cflags opencv4");
    assert_eq!((said.code, said.stdout), (0, format!("-I{headers}\n")));
    let said = system.ask("--cflags opencv5");
    assert_eq!(
        (said.code, said.stdout.as_str()),
        (1, "real: --cflags opencv5\n")
    );
}

#[test]
fn what_is_missing_is_named_in_one_line_with_a_command() {
    let system = System::new();
    let said = system.ask("--libs --cflags opencv4");
    assert_eq!((said.code, said.stdout.as_str()), (1, ""));
    let [line] = said.stderr.lines().collect::<Vec<_>>()[..] else {
        panic!("{}", said.stderr);
    };
    let start = "fabc: missing: OpenCV's core and imgproc development files: ";
    let command = line.strip_prefix(start).expect(line);
    assert!(command.contains("install"), "{line}");
    // A check for existence prints nothing.
    let said = system.ask("--exists opencv4");
    assert_eq!((said.code, said.stderr.as_str()), (1, ""));
    // One module is not enough.
    system.write("usr/include/opencv4/opencv2/core.hpp", "");
    assert_eq!(system.ask("--exists opencv4").code, 1);
}

#[test]
fn this_systems_libraries_are_not_offered_to_another_platform() {
    let system = System::new();
    system.bring_opencv("lib");
    let mut command = system.command("--cflags opencv4");
    command.envs([("HOST", "one"), ("TARGET", "another")]);
    assert_eq!(finish_process(&mut command).code, 0);
    command.env_remove("PKG_CONFIG_SYSROOT_DIR");
    let said = finish_process(&mut command);
    assert_eq!(said.code, 1);
    assert!(said.stderr.contains("not for another"), "{}", said.stderr);
}
