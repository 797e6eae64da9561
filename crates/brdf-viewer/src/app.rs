//! One frame after the other: events in, intents applied, panels drawn, jobs out.

use std::path::PathBuf;

use eframe::egui;

use crate::dialogs::Dialogs;
use crate::intent::Intent;
use crate::panels;
use crate::plot;
use crate::shortcuts;
use crate::state::saved::{SMALLEST_WINDOW, Settings};
use crate::state::{Effect, State};
use crate::theme;
use crate::worker::Worker;

/// The application.
pub struct Viewer {
    /// What is loaded, chosen and fitted.
    pub state: State,
    worker: Worker,
    dialogs: Box<dyn Dialogs>,
    settings: Settings,
    when_read: Vec<Intent>,
}

impl Viewer {
    /// A window with what was kept of the last one.
    pub fn new(ctx: &egui::Context, dialogs: Box<dyn Dialogs>, settings: Settings) -> Self {
        let mut state = State::new(&settings.saved);
        if let Some(note) = &settings.note {
            state.note(note.clone());
        }
        let woken = ctx.clone();
        Self {
            state,
            worker: Worker::new(move || woken.request_repaint()),
            dialogs,
            settings,
            when_read: Vec::new(),
        }
    }

    /// Opens files; where there are none, what was open the last time, or the first of the built-in
    /// samples.
    pub fn open_at_start(&mut self, files: Vec<PathBuf>) {
        if !files.is_empty() {
            self.state.apply(Intent::Open(files));
        } else if self.settings.saved.open.is_empty() {
            self.state.apply(Intent::OpenBuiltIn(0));
        } else {
            for source in self.settings.saved.open.clone() {
                self.state.reopen(&source);
            }
        }
    }

    /// What shall be done when all files that are being opened have been read.
    pub fn when_read(&mut self, intents: Vec<Intent>) {
        self.when_read = intents;
    }

    /// Whether anything is still to be done.
    pub fn is_busy(&self) -> bool {
        self.state.is_busy() || !self.when_read.is_empty()
    }

    /// Draws a frame.
    pub fn frame(&mut self, ui: &mut egui::Ui) {
        for event in self.worker.take_events() {
            self.state.take(event);
        }
        if self.state.reading == 0 {
            let mut intents = std::mem::take(&mut self.when_read);
            self.apply(&mut intents);
        }
        let ctx = ui.ctx().clone();
        self.state.system_dark = theme::system_is_dark(&ctx);
        theme::set(&ctx, self.state.interface.dark);
        let mut intents = panels::drop::intents(&ctx);
        if self.state.dialog.is_none() {
            let pressed = shortcuts::pressed(&ctx).into_iter();
            intents.extend(pressed.map(Intent::Do));
        }
        self.apply(&mut intents);

        panels::menu::show(ui, &self.state, &mut intents);
        panels::status::show(ui, &self.state, &mut intents);
        self.apply(&mut intents);
        if self.state.interface.results {
            panels::results::show(ui, &self.state, &mut intents);
        }
        if self.state.interface.parameters {
            let turned = panels::parameters::show(ui, &mut self.state);
            // The results are drawn already, for the parameters before: they are drawn once more.
            if turned && self.state.interface.results && self.state.interface.tab.follows() {
                ctx.request_discard("parameters were turned");
            }
        }
        // From here on everything follows from what has just been turned.
        self.state.refresh();
        if self.state.interface.samples {
            panels::samples::show(ui, &self.state, &mut intents);
        }
        panels::messages::show(ui, &self.state, &mut intents);
        plot::show(ui, &mut self.state, &mut intents);
        panels::dialog::show(&ctx, &self.state, self.dialogs.available(), &mut intents);
        self.apply(&mut intents);
        if !ctx.input(|input| input.pointer.any_down()) {
            self.state.settle();
        }
        self.carry_out(&ctx);
        self.keep(&ctx);
    }

    fn apply(&mut self, intents: &mut Vec<Intent>) {
        for intent in intents.drain(..) {
            self.state.apply(intent);
        }
    }

    fn carry_out(&mut self, ctx: &egui::Context) {
        let effects = self.state.take_effects();
        // What was changed is to be seen at once, also where no event follows.
        if !effects.is_empty() {
            ctx.request_repaint();
        }
        for effect in effects {
            match effect {
                Effect::Job(job) => self.worker.start(job),
                Effect::Copy(text) => ctx.copy_text(text),
                Effect::AskOpen if self.dialogs.available() => {
                    self.dialogs.open(self.worker.events());
                }
                Effect::AskOpen => self.state.ask_path(),
                Effect::AskExport(what, path) if self.dialogs.available() => {
                    self.dialogs.export(what, &path, self.worker.events());
                }
                Effect::AskExport(what, path) => self.state.ask_export(what, &path),
                Effect::Quit => ctx.send_viewport_cmd(egui::ViewportCommand::Close),
            }
        }
    }

    /// Keeps the settings when they have changed and nothing is being dragged.
    fn keep(&mut self, ctx: &egui::Context) {
        let Some(path) = &self.settings.path else {
            return;
        };
        let size = ctx.content_rect().size();
        let window = [
            size.x.max(SMALLEST_WINDOW[0]),
            size.y.max(SMALLEST_WINDOW[1]),
        ];
        let now = self.state.saved(window);
        let dragging = ctx.input(|input| input.pointer.any_down());
        if dragging || self.state.reading > 0 || now == self.settings.saved {
            return;
        }
        if let Err(error) = now.write(path) {
            self.state
                .note(format!("the settings are not kept: {error}"));
            // Said once.
            self.settings.path = None;
        }
        self.settings.saved = now;
    }
}

impl eframe::App for Viewer {
    fn ui(&mut self, ui: &mut egui::Ui, _: &mut eframe::Frame) {
        self.frame(ui);
    }
}
