//! Outputs that would overwrite an input or another output, or that cannot be written, are refused
//! before anything is computed, and nothing in the folder changes.

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use brdf_tests::{brdf_command, export_command, fit_command, in_workspace, trade_command};
use tempfile::TempDir;

const BAD: i32 = 2;

const SCAN: &str = "psi_deg,theta_deg,brdf_per_sr\n\
                    10,-10,0.5\n10,0,0.3\n30,-30,0.6\n30,-20,0.4\n30,0,0.2\n60,-60,0.9\n";

/// A folder with the scan `scan.csv`, its fit `fit.json`, and a folder `below`, in which commands run.
struct Folder(TempDir);

impl Folder {
    fn new() -> Self {
        let folder = Self(tempfile::tempdir().unwrap());
        fs::write(folder.path("scan.csv"), SCAN).unwrap();
        fs::create_dir(folder.path("below")).unwrap();
        let output = folder.fit(&["scan.csv", "--n", "1.5", "--json", "fit.json"]);
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        folder
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn run(&self, command: &mut Command, arguments: &[&str]) -> Output {
        let command = command.current_dir(self.0.path()).args(arguments);
        command.stdin(Stdio::null()).output().unwrap()
    }

    fn fit(&self, arguments: &[&str]) -> Output {
        self.run(&mut fit_command(), arguments)
    }

    /// Checks that a command refuses its outputs at once, with this message, and changes nothing.
    fn refuses(&self, command: &mut Command, arguments: &[&str], message: &str) {
        let before = content(self.0.path());
        let output = self.run(command, arguments);
        let text = stderr(&output);
        assert_eq!(output.status.code(), Some(BAD), "{arguments:?}: {text}");
        assert!(
            text.contains(message),
            "{arguments:?}: no \"{message}\" in: {text}"
        );
        assert!(output.stdout.is_empty(), "{arguments:?} computed something");
        assert!(content(self.0.path()) == before, "{arguments:?}");
    }

    /// [`refuses`](Self::refuses) of `fit scan.csv`.
    fn fit_refuses(&self, arguments: &[&str], message: &str) {
        let arguments = [&["scan.csv", "--n", "1.5"], arguments].concat();
        self.refuses(&mut fit_command(), &arguments, message);
    }
}

/// Everything below a folder: links by their target, files by their content.
fn content(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut all = BTreeMap::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if let Ok(target) = fs::read_link(&path) {
            all.insert(path, target.into_os_string().into_encoded_bytes());
        } else if path.is_dir() {
            all.extend(content(&path));
            all.insert(path, Vec::new());
        } else {
            let bytes = fs::read(&path).unwrap();
            all.insert(path, bytes);
        }
    }
    all
}

fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

const OWN: &str = "expected a file of its own";

#[test]
fn no_spelling_of_a_path_overwrites_an_input() {
    let folder = Folder::new();
    let absolute = folder.path("scan.csv");
    for scan in [
        "scan.csv",
        "./scan.csv",
        "below/../scan.csv",
        absolute.to_str().unwrap(),
    ] {
        folder.fit_refuses(&["--json", scan], OWN);
        folder.fit_refuses(&["--curves", scan], OWN);
        folder.refuses(
            &mut trade_command(),
            &["fit", "scan.csv", "--n", "1.5", "--csv", scan],
            OWN,
        );
    }
    folder.refuses(
        &mut fit_command(),
        &[
            "scan.csv",
            "--again",
            "fit.json",
            "--curves",
            "below/../fit.json",
        ],
        OWN,
    );
    let export = ["fit.json", "--to", "c", "-o", "below/../fit.json"];
    folder.refuses(&mut export_command(), &export, OWN);
}

#[cfg(unix)]
#[test]
fn no_link_overwrites_an_input() {
    use std::os::unix::fs::symlink;
    let folder = Folder::new();
    let link = |target: &str, name: &str| symlink(target, folder.path(name)).unwrap();
    link("scan.csv", "link");
    link("below/../link", "chain");
    link(".", "here");
    fs::hard_link(folder.path("scan.csv"), folder.path("hard")).unwrap();
    fs::hard_link(folder.path("fit.json"), folder.path("model.xml")).unwrap();
    for scan in ["link", "chain", "here/scan.csv", "hard", "here/hard"] {
        folder.fit_refuses(&["--json", scan], OWN);
        folder.refuses(
            &mut fit_command(),
            &[scan, "--n", "1.5", "--curves", "scan.csv"],
            OWN,
        );
    }
    // The scene that stands beside a plugin of Mitsuba.
    let export = ["fit.json", "--to", "mitsuba", "-o", "model.py"];
    folder.refuses(
        &mut export_command(),
        &export,
        "model.xml: is the same file as fit.json",
    );
}

#[test]
fn two_outputs_are_two_files() {
    let folder = Folder::new();
    fs::write(folder.path("old"), "").unwrap();
    fs::hard_link(folder.path("old"), folder.path("hard")).unwrap();
    let mut pairs = vec![("new", "below/../new"), ("old", "hard")];
    #[cfg(unix)]
    {
        use std::os::unix::fs::symlink;
        symlink("missing", folder.path("one")).unwrap();
        symlink("below/../one", folder.path("two")).unwrap();
        pairs.extend([
            ("missing", "one"),
            ("one", "two"),
            ("two", "below/../missing"),
        ]);
    }
    for (json, curves) in pairs {
        folder.fit_refuses(&["--json", json, "--curves", curves], OWN);
    }
    let trade = [
        "fit",
        "scan.csv",
        "--n",
        "1.5",
        "--csv",
        "new",
        "--plot",
        "below/../new",
    ];
    folder.refuses(&mut trade_command(), &trade, OWN);
}

#[test]
fn the_folder_of_the_figures_is_a_folder_of_its_own() {
    let folder = Folder::new();
    for (data, plot) in [
        ("out", "out"),
        ("out", "out/figures"),
        ("below/../out", "out/figures/more"),
    ] {
        folder.fit_refuses(
            &["--json", data, "--plot", plot],
            "is a folder of another output",
        );
    }
    // What is written into the folder of the figures, under a name of its own, is none of them.
    let together = [
        "scan.csv",
        "--n",
        "1.5",
        "--plot",
        "out/new",
        "--json",
        "out/new/fit.json",
    ];
    let output = folder.fit(&together);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    for file in ["fit.json", "report.html", "scan-theory-log.svg"] {
        assert!(folder.path("out/new").join(file).is_file(), "{file}");
    }
}

#[test]
fn a_figure_is_no_other_output_and_no_input() {
    let folder = Folder::new();
    for name in ["report.html", "scan-theory-log.svg", "scan-residuals.png"] {
        let data = format!("below/{name}");
        folder.fit_refuses(&["--json", &data, "--plot", "below"], OWN);
        folder.fit_refuses(&["--json", &data, "--plot", "below/../below"], OWN);
        // A scan of this name would be overwritten by its own figure.
        fs::copy(folder.path("scan.csv"), folder.path(&data)).unwrap();
        let again = [data.as_str(), "scan.csv", "--n", "1.5", "--plot", "below"];
        folder.refuses(&mut fit_command(), &again, OWN);
        fs::remove_file(folder.path(&data)).unwrap();
        fs::hard_link(folder.path("scan.csv"), folder.path(&data)).unwrap();
        folder.fit_refuses(&["--plot", "below"], OWN);
        fs::remove_file(folder.path(&data)).unwrap();
        #[cfg(unix)]
        {
            std::os::unix::fs::symlink("../scan.csv", folder.path(&data)).unwrap();
            folder.fit_refuses(&["--plot", "below"], OWN);
            fs::remove_file(folder.path(&data)).unwrap();
        }
    }
}

#[test]
fn a_figure_of_one_wavelength_is_no_other_output() {
    let folder = Folder::new();
    let scan = in_workspace("data/measured/z307_on_aluminium.csv");
    fs::copy(&scan, folder.path("t_0.85223um.svg")).unwrap();
    let trade = ["fit", "t_0.85223um.svg", "--n", "1.5", "--plot", "t.svg"];
    folder.refuses(&mut trade_command(), &trade, OWN);
    let trade = [
        "fit",
        scan.to_str().unwrap(),
        "--n",
        "1.5",
        "--plot",
        "t.svg",
        "--csv",
        "t_0.63079um.svg",
    ];
    folder.refuses(&mut trade_command(), &trade, OWN);
}

fn protect(path: &Path) {
    let mut permissions = fs::metadata(path).unwrap().permissions();
    permissions.set_readonly(true);
    fs::set_permissions(path, permissions).unwrap();
}

#[test]
fn what_cannot_be_written_is_refused_at_once() {
    let folder = Folder::new();
    fs::write(folder.path("protected"), "kept").unwrap();
    protect(&folder.path("protected"));
    let long = "x".repeat(300);
    for (output, message) in [
        (
            "protected",
            "protected: cannot be written: the file is read-only",
        ),
        ("below", "below: cannot be written: it is a folder"),
        ("below/", "below/: cannot be written: it is a folder"),
        (
            "new/",
            "new/: cannot be written: the name is that of a folder",
        ),
        ("..", "..: cannot be written: it is a folder"),
        (
            "no/such/out",
            "no/such/out: cannot be written: the folder no/such does not exist",
        ),
        (
            "scan.csv/out",
            "scan.csv/out: cannot be written: scan.csv is not a folder",
        ),
        (&long, "cannot be written: File name too long"),
    ] {
        folder.fit_refuses(&["--json", output], message);
        folder.fit_refuses(&["--curves", output], message);
        let trade = ["fit", "scan.csv", "--n", "1.5", "--plot", output];
        folder.refuses(&mut trade_command(), &trade, message);
        let export = ["fit.json", "--to", "c", "-o", output];
        folder.refuses(&mut export_command(), &export, message);
    }
}

#[test]
fn a_folder_of_figures_that_cannot_be_written_is_refused_at_once() {
    let folder = Folder::new();
    for plot in ["scan.csv", "scan.csv/figures", "scan.csv/figures/more"] {
        let message = format!("{plot}: cannot be written: scan.csv is not a folder");
        folder.fit_refuses(&["--plot", plot], &message);
        folder.refuses(&mut brdf_command(), &["figures", plot], &message);
    }
    let page = folder.path("below/report.html");
    fs::create_dir(&page).unwrap();
    folder.fit_refuses(
        &["--plot", "below"],
        "report.html: cannot be written: it is a folder",
    );
    fs::remove_dir(&page).unwrap();
    let figure = folder.path("below/scan-reflectance.png");
    fs::write(&figure, "kept").unwrap();
    protect(&figure);
    folder.fit_refuses(
        &["--plot", "below"],
        "scan-reflectance.png: cannot be written: the file is read-only",
    );
}

/// Whether the tests may write everywhere, so that no folder is read-only for them.
#[cfg(unix)]
fn is_root(folder: &Path) -> bool {
    use std::os::unix::fs::MetadataExt as _;
    let is_root = fs::metadata(folder).unwrap().uid() == 0;
    if is_root {
        println!("skipped: root may write into a read-only folder");
    }
    is_root
}

#[cfg(unix)]
#[test]
fn a_read_only_folder_is_refused_at_once() {
    let folder = Folder::new();
    if is_root(folder.0.path()) {
        return;
    }
    protect(&folder.path("below"));
    let message = "cannot be written: Permission denied";
    folder.fit_refuses(&["--json", "below/out"], message);
    folder.fit_refuses(&["--plot", "below"], message);
    folder.fit_refuses(&["--plot", "below/new"], message);
}

#[cfg(unix)]
#[test]
fn the_system_folder_proc_is_refused_at_once() {
    let folder = Folder::new();
    if Path::new("/proc/self").exists() {
        folder.fit_refuses(&["--json", "/proc/out"], "/proc/out: cannot be written: ");
        folder.fit_refuses(&["--plot", "/proc/out"], "/proc/out: cannot be written: ");
    }
}

#[cfg(unix)]
#[test]
fn a_file_behind_a_standard_stream_is_in_use_as_well() {
    let folder = Folder::new();
    let before = content(folder.0.path());
    let run = |input: Stdio, output: Stdio, arguments: &[&str]| {
        let mut command = fit_command();
        command.current_dir(folder.0.path()).args(arguments);
        let child = command.stdin(input).stdout(output).stderr(Stdio::piped());
        let output = child.spawn().unwrap().wait_with_output().unwrap();
        assert_eq!(output.status.code(), Some(BAD), "{}", stderr(&output));
        stderr(&output)
    };
    let scan = || Stdio::from(File::open(folder.path("scan.csv")).unwrap());
    let message = run(
        scan(),
        Stdio::null(),
        &["-", "--n", "1.5", "--json", "scan.csv"],
    );
    assert!(
        message.contains("scan.csv: is the same file as standard input"),
        "{message}"
    );

    let out = folder.path("out");
    let to_file = || Stdio::from(File::create(&out).unwrap());
    let options = ["scan.csv", "--n", "1.5", "--json", "out"];
    let message = run(Stdio::null(), to_file(), &options);
    assert!(
        message.contains("out: is the same file as standard output"),
        "{message}"
    );
    let at_its_end = fs::OpenOptions::new()
        .append(true)
        .open(folder.path("scan.csv"));
    let message = run(
        Stdio::null(),
        at_its_end.unwrap().into(),
        &["scan.csv", "--n", "1.5"],
    );
    assert!(
        message.contains("standard output: is the same file as scan.csv"),
        "{message}"
    );
    fs::remove_file(&out).unwrap();
    assert!(content(folder.0.path()) == before);
}

#[cfg(unix)]
#[test]
fn devices_and_pipes_take_several_outputs() {
    let folder = Folder::new();
    let both = [
        "scan.csv",
        "--n",
        "1.5",
        "--json",
        "/dev/null",
        "--curves",
        "/dev/null",
    ];
    let output = folder.fit(&both);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert!(!output.stdout.is_empty());
}
