//! Random clicks, drags, keys, drops and resizes must neither crash the window nor leak memory.
//!
//! `VIEWER_MONKEY_SECONDS` sets the duration (10 by default), `VIEWER_MONKEY_SEED` the sequence of
//! events (1 by default).

#[path = "window/common.rs"]
mod common;

use std::path::Path;
use std::rc::Rc;
use std::time::{Duration, Instant};

use brdf_viewer::intent::Intent;
use brdf_viewer::platform::current::SettingsFile;
use brdf_viewer::state::saved::Settings;
use common::{NoDialogs, Window, drop_file, drop_path, window_with, z307};
use egui::{Event, Key, Modifiers, PointerButton, Pos2, pos2, vec2};
use rand::rngs::StdRng;
use rand::{RngExt as _, SeedableRng as _};

const KEYS: [Key; 34] = [
    Key::Tab,
    Key::Enter,
    Key::Escape,
    Key::Space,
    Key::ArrowUp,
    Key::ArrowDown,
    Key::ArrowLeft,
    Key::ArrowRight,
    Key::Home,
    Key::End,
    Key::Backspace,
    Key::Delete,
    Key::F1,
    Key::F5,
    Key::F6,
    Key::F7,
    Key::F8,
    Key::F9,
    Key::Z,
    Key::Y,
    Key::L,
    Key::K,
    Key::D,
    Key::Num1,
    Key::Num2,
    Key::Num3,
    Key::C,
    Key::O,
    Key::A,
    Key::W,
    Key::S,
    Key::E,
    Key::R,
    Key::P,
];

/// Growth of memory after the first tenth of the test that counts as a leak, in bytes.
const MOST_GROWTH: u64 = 400 << 20;

/// Memory that is never exceeded unless a drawing grows without bound, in bytes.
const MOST_MEMORY: u64 = 2 << 30;

fn setting(name: &str, default: u64) -> u64 {
    let text = std::env::var(name).ok();
    text.map_or(default, |text| text.parse().expect("a whole number"))
}

#[test]
fn random_events_do_not_crash_the_window() {
    let limit = Duration::from_secs(setting("VIEWER_MONKEY_SECONDS", 10));
    let seed = setting("VIEWER_MONKEY_SEED", 1);
    let folder = tempfile::tempdir().unwrap();
    // Files that are written by chance must not end up in the project.
    std::env::set_current_dir(folder.path()).unwrap();
    let mut random = StdRng::seed_from_u64(seed);
    let settings = || {
        let path = folder.path().join("settings/state.json");
        Settings::load(Some(Rc::new(SettingsFile::new(path))))
    };
    let mut window = window_with([1280.0, 800.0], NoDialogs, settings());
    window.state_mut().state.fit_settings.on_opening = true;
    let scan = folder.path().join("scan.csv");
    std::fs::write(&scan, z307()).unwrap();
    let started = Instant::now();
    let mut first_memory = None;
    let mut events = 0_u64;
    while started.elapsed() < limit {
        disturb(&mut window, &mut random, &scan);
        events += 1;
        if random.random_bool(0.3) {
            std::thread::sleep(Duration::from_millis(1));
        }
        if events.is_multiple_of(200) {
            limit_samples(&mut window, &mut random);
            let now = memory().unwrap_or(0);
            assert!(now < MOST_MEMORY, "{} MiB after {events} events", now >> 20);
        }
        if first_memory.is_none() && started.elapsed() > limit / 10 {
            first_memory = memory();
        }
    }
    let grown = match (first_memory, memory()) {
        (Some(first), Some(last)) => last.saturating_sub(first),
        _ => 0,
    };
    let state = &window.state().state;
    println!(
        "seed {seed}: {events} events in {:?}, {} samples open, memory grown by {} MiB",
        started.elapsed(),
        state.samples.len(),
        grown >> 20
    );
    assert!(grown < MOST_GROWTH, "{} MiB", grown >> 20);
    assert!(events > 100);
    // The saved settings are valid.
    let again = window_with([1280.0, 800.0], NoDialogs, settings());
    assert!(again.state().state.errors().is_empty());
}

/// One random event, and a frame.
fn disturb(window: &mut Window, random: &mut StdRng, scan: &Path) {
    let size = window.ctx.content_rect().size();
    let mut anywhere = || {
        let x = random.random_range(0.0..size.x);
        let y = random.random_range(0.0..size.y);
        pos2(x, y)
    };
    let (from, to) = (anywhere(), anywhere());
    match random.random_range(0..100) {
        0..40 => press(window, from, from, PointerButton::Primary),
        40..62 => press(window, from, to, PointerButton::Primary),
        62..66 => press(window, from, to, PointerButton::Secondary),
        66..70 => {
            press(window, from, from, PointerButton::Primary);
            press(window, from, from, PointerButton::Primary);
        }
        70..82 => {
            let key = KEYS[random.random_range(0..KEYS.len())];
            let modifiers = match random.random_range(0..4) {
                0 => Modifiers::COMMAND,
                1 => Modifiers::SHIFT,
                2 => Modifiers::COMMAND.plus(Modifiers::SHIFT),
                _ => Modifiers::NONE,
            };
            window.key_press_modifiers(modifiers, key);
        }
        82..86 => window.event(Event::Text(random.random_range(-9..999).to_string())),
        86..90 => {
            window.hover_at(from);
            window.event(Event::Zoom(random.random_range(0.3..3.0)));
        }
        90..94 => {
            window.hover_at(from);
            window.event(Event::MouseWheel {
                unit: egui::MouseWheelUnit::Point,
                delta: vec2(to.x - from.x, to.y - from.y),
                phase: egui::TouchPhase::Move,
                source: egui::MouseWheelSource::Wheel,
                modifiers: Modifiers::NONE,
            });
        }
        94..96 => drop_something(window, random, scan),
        96..98 => {
            let width = random.random_range(400.0..2000.0);
            window.set_size(vec2(width, random.random_range(300.0..1200.0)));
        }
        98 => {
            window.set_pixels_per_point(random.random_range(0.5..3.0));
        }
        _ => window.event(Event::PointerGone),
    }
    window.step();
}

fn press(window: &mut Window, from: Pos2, to: Pos2, button: PointerButton) {
    let event = |pos: Pos2, pressed: bool| Event::PointerButton {
        pos,
        button,
        pressed,
        modifiers: Modifiers::NONE,
    };
    window.event(Event::PointerMoved(from));
    window.event(event(from, true));
    window.step();
    if to != from {
        for part in [0.3, 0.7, 1.0] {
            window.event(Event::PointerMoved(from + (to - from) * part));
            window.step();
        }
    }
    window.event(event(to, false));
}

fn drop_something(window: &mut Window, random: &mut StdRng, scan: &Path) {
    if random.random_bool(0.3) {
        drop_path(window, scan);
        return;
    }
    let mut text = z307();
    if random.random_bool(0.5) {
        // The content is damaged at a random position.
        let at = random.random_range(0..text.len());
        if text.is_char_boundary(at) {
            text.insert_str(
                at,
                ["x", ",", "\n", "-1e400", "\"", "NaN"][random.random_range(0..6)],
            );
        }
    }
    drop_file(window, "dropped.csv", &text);
}

/// Leaves between one and six samples, so that frames are short but not empty.
fn limit_samples(window: &mut Window, random: &mut StdRng) {
    let state = &mut window.state_mut().state;
    while state.samples.len() > 6 {
        let id = state.samples[random.random_range(0..state.samples.len())].id;
        state.apply(Intent::CloseUnsaved(vec![id]));
    }
    if state.samples.is_empty() {
        state.apply(Intent::OpenBuiltIn(random.random_range(0..4)));
    }
    state.apply(Intent::CloseDialog);
    window.set_size(vec2(1280.0, 800.0));
    window.set_pixels_per_point(1.0);
    window.step();
}

/// The memory of the process in bytes, if the system reports it.
fn memory() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmRSS:"))?;
    let kibibytes: u64 = line.split_whitespace().nth(1)?.parse().ok()?;
    Some(kibibytes << 10)
}
