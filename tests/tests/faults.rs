//! Runs that are killed, interrupted or without room: each output is the earlier one or the new one,
//! whole, and no temporary file stays.
#![cfg(unix)]

use std::collections::BTreeMap;
use std::fs;
use std::io::Write as _;
use std::os::unix::process::ExitStatusExt as _;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Output, Stdio};
use std::sync::OnceLock;
use std::thread;
use std::time::{Duration, Instant};

use brdf_tests::{fit_command, generator, in_workspace, uniform};
use serde_json::Value;
use tempfile::TempDir;

const BAD: i32 = 2;

/// How often a run is killed with each signal.
const KILLS: u32 = 100;

/// The content of each file of a folder.
type Files = BTreeMap<PathBuf, Vec<u8>>;

fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// The results of two samples, which every bench shares.
struct Known {
    earlier: Files,
    new: Files,
    /// The time of a whole run.
    whole: Duration,
}

/// Two scans of the same name, so that the figures of their fits have the same names, and a folder of
/// results.
struct Bench {
    folder: TempDir,
    known: &'static Known,
}

impl Bench {
    /// A folder with the results of the first scan.
    fn new() -> Self {
        static KNOWN: OnceLock<Known> = OnceLock::new();
        let folder = Self::folder();
        let known = KNOWN.get_or_init(|| {
            let earlier = completed(folder.path(), "first");
            let start = Instant::now();
            let new = completed(folder.path(), "second");
            let whole = start.elapsed();
            assert!(earlier.keys().eq(new.keys()));
            let figures = new.keys().filter(|name| ends(name, "png"));
            assert_eq!(figures.count(), 5);
            Known {
                earlier,
                new,
                whole,
            }
        });
        let bench = Self { folder, known };
        bench.reset();
        bench
    }

    /// A folder with the scans: every third reading of one wavelength of a measured sample.
    fn folder() -> TempDir {
        let folder = tempfile::tempdir().unwrap();
        let samples = ["z307_on_aluminium.csv", "z307_on_aluminium_cycled.csv"];
        for (name, sample) in ["first", "second"].into_iter().zip(samples) {
            let text = fs::read_to_string(in_workspace("data/measured").join(sample)).unwrap();
            let (head, readings): (Vec<&str>, Vec<&str>) =
                text.lines().partition(|line| !line.starts_with("0.63"));
            let head = head
                .into_iter()
                .take_while(|line| !line.starts_with(['0', '1']));
            let lines: Vec<&str> = head.chain(readings.into_iter().step_by(3)).collect();
            fs::create_dir(folder.path().join(name)).unwrap();
            fs::write(folder.path().join(name).join("scan.csv"), lines.join("\n")).unwrap();
        }
        folder
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn fit(&self, scan: &str) -> Command {
        fit(self.folder.path(), scan)
    }

    /// Puts the results of the first scan back; what else is in the folders stays.
    fn reset(&self) {
        fs::create_dir_all(self.path("results/figures")).unwrap();
        for (path, content) in &self.known.earlier {
            fs::write(self.folder.path().join(path), content).unwrap();
        }
    }

    /// Checks that each result is that of one of the scans, whole. Returns how many are new, and the
    /// temporary files.
    fn check(&self) -> (usize, Vec<PathBuf>) {
        let (files, litter) = results(self.folder.path());
        let Known { earlier, new, .. } = self.known;
        assert!(files.keys().eq(earlier.keys()));
        let mut replaced = 0;
        for (name, content) in &files {
            if content != &earlier[name] {
                assert_same(name, content, &new[name]);
                replaced += 1;
            }
        }
        (replaced, litter)
    }
}

/// `fit` of one of the scans of a folder, with all of its outputs in the folder of results.
fn fit(folder: &Path, scan: &str) -> Command {
    let mut command = fit_command();
    command.current_dir(folder).env("RAYON_NUM_THREADS", "1");
    command.args([
        &format!("{scan}/scan.csv"),
        "--n",
        "1.5",
        "--model",
        "lambert",
    ]);
    command.args([
        "--json",
        "results/fit.json",
        "--curves",
        "results/curves.csv",
    ]);
    command.args(["--plot", "results/figures"]);
    command.stdin(Stdio::null()).stdout(Stdio::null());
    command.stderr(Stdio::piped());
    command
}

/// The results of a run that nothing disturbs. No file but the results is in their folder.
fn completed(folder: &Path, scan: &str) -> Files {
    fs::create_dir_all(folder.join("results")).unwrap();
    let output = fit(folder, scan).output().unwrap();
    assert!(output.status.success(), "{}", stderr(&output));
    let (files, litter) = results(folder);
    assert_eq!(litter, Vec::<PathBuf>::new());
    files
}

/// The results in a folder, and the temporary files beside them.
fn results(root: &Path) -> (Files, Vec<PathBuf>) {
    let (mut files, mut litter) = (Files::new(), Vec::new());
    for folder in ["results", "results/figures"] {
        for entry in fs::read_dir(root.join(folder)).unwrap() {
            let path = entry.unwrap().path();
            let name = path.strip_prefix(root).unwrap().to_owned();
            if ends(&name, "tmp") {
                litter.push(name);
            } else if path.is_file() {
                files.insert(name, fs::read(path).unwrap());
            }
        }
    }
    (files, litter)
}

fn ends(path: &Path, extension: &str) -> bool {
    path.extension().is_some_and(|found| found == extension)
}

/// Checks that a file is that of another run, but for its times.
fn assert_same(name: &Path, content: &[u8], expected: &[u8]) {
    if ends(name, "json") {
        let json = |bytes: &[u8]| without_times(serde_json::from_slice(bytes).unwrap());
        assert_eq!(json(content), json(expected), "{}", name.display());
    } else if ends(name, "html") {
        // The page tells the times of the stages.
        let end = b"</html>\n";
        assert!(content.ends_with(end) && expected.ends_with(end));
        assert!(content.len().abs_diff(expected.len()) < 1000);
    } else {
        assert!(content == expected, "{} is cut", name.display());
    }
}

fn without_times(mut value: Value) -> Value {
    match &mut value {
        Value::Object(fields) => {
            fields.remove("seconds");
            let fields = fields.values_mut();
            fields.for_each(|field| *field = without_times(field.take()));
        }
        Value::Array(values) => values
            .iter_mut()
            .for_each(|value| *value = without_times(value.take())),
        _ => {}
    }
    value
}

fn interrupt(child: &Child) {
    let kill = Command::new("sh")
        .args(["-c", "kill -INT \"$0\"", &child.id().to_string()])
        .status();
    assert!(kill.unwrap().success());
}

/// Starts runs over the earlier results, ends each at a random moment, and checks what is left.
/// Returns how many runs were ended between their first and their last output.
fn disturb(
    bench: &Bench,
    seed: u64,
    end: impl Fn(&mut Child),
    check: impl Fn(ExitStatus, &[PathBuf]),
) -> usize {
    let mut generator = generator(seed);
    let mut between = 0;
    for i in 0..KILLS {
        bench.reset();
        // The last outputs of a run are written within a few milliseconds, which half of the runs reach.
        let latest = if i % 2 == 0 { 1.0 } else { 0.6 };
        let moment = bench
            .known
            .whole
            .mul_f64(uniform(&mut generator, 0.0, latest));
        let mut child = bench.fit("second").spawn().unwrap();
        thread::sleep(moment);
        end(&mut child);
        let output = child.wait_with_output().unwrap();
        assert_eq!(stderr(&output), "", "after {moment:?}");
        let (new, litter) = bench.check();
        between += usize::from(new > 0 && new < bench.known.new.len());
        check(output.status, &litter);
    }
    between
}

#[test]
fn a_killed_run_leaves_whole_results_and_the_next_one_cleans_up() {
    let bench = Bench::new();
    let between = disturb(&bench, 1, |child| child.kill().unwrap(), |_, _| {});
    println!("{between} of {KILLS} runs were killed between their first and their last output");
    bench.reset();
    let left = bench.path("results/.brdf-output-0123456789abcdef.tmp");
    fs::write(left, "half").unwrap();
    for (name, content) in completed(bench.folder.path(), "second") {
        assert_same(&name, &content, &bench.known.new[&name]);
    }
}

#[test]
fn an_interrupted_run_leaves_whole_results_and_no_temporary_file() {
    let bench = Bench::new();
    let interrupted = |status: ExitStatus, litter: &[PathBuf]| {
        // 2 is SIGINT. A shell may start the tests with SIGINT ignored.
        assert!(status.signal() == Some(2) || status.success(), "{status}");
        assert_eq!(litter, Vec::<PathBuf>::new());
    };
    let between = disturb(&bench, 2, |child| interrupt(child), interrupted);
    println!(
        "{between} of {KILLS} runs were interrupted between their first and their last output"
    );
}

#[test]
fn a_limit_on_the_size_of_files_is_an_error() {
    let bench = Bench::new();
    let program = bench.fit("second");
    // In blocks of 512 bytes: enough for the small figures, too little for the document.
    let mut limited = Command::new("sh");
    limited
        .args(["-c", "ulimit -f 32 && exec \"$0\" \"$@\""])
        .arg(program.get_program())
        .args(program.get_args())
        .current_dir(bench.folder.path());
    let output = limited.output().unwrap();
    let message = stderr(&output);
    assert_eq!(output.status.code(), Some(BAD), "{message}");
    assert!(
        message.contains("fit.json: cannot be written: File too large"),
        "{message}"
    );
    assert!(!output.stdout.is_empty(), "the tables are delivered");
    let (_, litter) = bench.check();
    assert_eq!(litter, Vec::<PathBuf>::new());
}

/// A small file system, while the value is alive.
struct SmallDisk(PathBuf);

impl SmallDisk {
    fn mount(folder: &Path, bytes: usize) -> Option<Self> {
        let mounted = Command::new("mount")
            .args(["-t", "tmpfs", "-o", &format!("size={bytes}"), "tmpfs"])
            .arg(folder)
            .stderr(Stdio::null())
            .status();
        if mounted.is_ok_and(|status| status.success()) {
            return Some(Self(folder.to_owned()));
        }
        println!("skipped: no permission to mount a small file system");
        None
    }
}

impl Drop for SmallDisk {
    fn drop(&mut self) {
        let _ = Command::new("umount").arg(&self.0).status();
    }
}

#[test]
fn a_full_disk_leaves_whole_results_and_no_temporary_file() {
    const PAGE: usize = 4096;
    let bench = Bench::new();
    let pages: usize = bench
        .known
        .earlier
        .values()
        .map(|file| file.len().div_ceil(PAGE))
        .sum();
    // The earlier results, their folder, and room for a small file beside them.
    let Some(_disk) = SmallDisk::mount(&bench.path("results"), (pages + 12) * PAGE) else {
        return;
    };
    bench.reset();
    let output = bench.fit("second").output().unwrap();
    let message = stderr(&output);
    assert_eq!(output.status.code(), Some(BAD), "{message}");
    assert!(message.contains("No space left on device"), "{message}");
    let (new, litter) = bench.check();
    assert_eq!(litter, Vec::<PathBuf>::new());
    println!("{new} of {} files were replaced", bench.known.new.len());
}

/// A run that ends by itself within its exit statuses: no panic, no signal.
fn assert_orderly(output: &Output, statuses: &[i32]) {
    let message = stderr(output);
    let status = output.status.code();
    assert!(
        status.is_some_and(|status| statuses.contains(&status)),
        "{}: {message}",
        output.status
    );
    assert!(!message.contains("panicked"), "{message}");
}

#[test]
fn a_pipe_whose_writer_dies_is_an_incomplete_file() {
    let scan = in_workspace("data/measured/z307_on_aluminium.csv");
    let text = fs::read(scan).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let json = folder.path().join("fit.json");
    fs::write(&json, "earlier").unwrap();
    // Nothing, a part of a comment, and tables whose last line ends before its reading.
    for length in [0, 50, 400, text.len() / 2] {
        let mut child = fit_command()
            .args(["-", "--n", "1.5", "--json"])
            .arg(&json)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let end = text[..length].iter().rposition(|&byte| byte == b',');
        let sent = &text[..end.unwrap_or(length)];
        let mut pipe = child.stdin.take().unwrap();
        pipe.write_all(sent).unwrap();
        drop(pipe);
        let output = child.wait_with_output().unwrap();
        assert_orderly(&output, &[BAD]);
        assert!(stderr(&output).starts_with("error: standard input"));
        assert_eq!(fs::read_to_string(&json).unwrap(), "earlier");
    }
}

/// A MERL table of a few bins, whose channels are read one after the other.
fn table() -> Vec<u8> {
    let bins = [6_i32, 5, 8];
    let mut bytes: Vec<u8> = bins.iter().flat_map(|n| n.to_le_bytes()).collect();
    for i in 0..3 * 6 * 5 * 8 {
        bytes.extend((100.0 + f64::from(i % 37)).to_le_bytes());
    }
    bytes
}

#[test]
fn an_input_that_is_removed_or_cut_meanwhile_is_an_error_or_read_before() {
    let folder = tempfile::tempdir().unwrap();
    let mut generator = generator(3);
    let text = fs::read(in_workspace("data/measured/z307_on_aluminium.csv")).unwrap();
    let inputs = [("scan.csv", text), ("scan.binary", table())];
    let removed = |path: &Path| fs::remove_file(path).unwrap();
    let cut = |path: &Path| {
        let file = fs::OpenOptions::new().write(true).open(path).unwrap();
        file.set_len(3000).unwrap();
    };
    for (name, content) in &inputs {
        let path = folder.path().join(name);
        let other = in_workspace("data/measured/titanium_anodise.csv");
        let run = || {
            let mut command = fit_command();
            command
                .arg(&path)
                .arg(&other)
                .args(["--n", "1.5", "--params-only"]);
            command.stdout(Stdio::piped()).stderr(Stdio::piped());
            command.spawn().unwrap()
        };
        fs::write(&path, content).unwrap();
        let start = Instant::now();
        assert_orderly(&run().wait_with_output().unwrap(), &[0]);
        let whole = start.elapsed();
        for i in 0..10 {
            fs::write(&path, content).unwrap();
            let child = run();
            thread::sleep(whole.mul_f64(uniform(&mut generator, 0.0, 0.3)));
            if i % 2 == 0 {
                removed(&path);
            } else {
                cut(&path);
            }
            let output = child.wait_with_output().unwrap();
            assert_orderly(&output, &[0, BAD]);
            // The other file is fitted all the same.
            let text = String::from_utf8_lossy(&output.stdout);
            assert_eq!(text.matches("titanium_anodise.csv").count(), 2, "{text}");
        }
    }
}
