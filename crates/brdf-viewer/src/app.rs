//! The application: each frame takes events, applies intents, draws panels and starts jobs.

use std::cell::RefCell;
use std::path::PathBuf;
use std::sync::mpsc::{Receiver, channel};

use eframe::egui;

use crate::events::EventSender;
use crate::fonts::FallbackFonts;
use crate::intent::Intent;
use crate::job::Event;
use crate::panels;
use crate::platform::current::CurrentThreads;
use crate::platform::{Dialogs, Threads};
use crate::plot;
use crate::shortcuts;
use crate::state::built_in;
use crate::state::interface::Interface;
use crate::state::saved::{SMALLEST_WINDOW, Settings};
use crate::state::{Effect, State};
use crate::theme;

/// In windows narrower than this, in points, not all panels are open at first.
const NARROW_WINDOW: f32 = 1000.0;

/// The application.
pub struct Viewer {
    /// The samples, the settings and the fits.
    pub state: State,
    threads: CurrentThreads,
    events: EventSender,
    receiver: Receiver<Event>,
    dialogs: Box<dyn Dialogs>,
    settings: Settings,
    when_opened: Vec<Intent>,
    fonts: FallbackFonts,
    is_first_frame: bool,
}

impl Viewer {
    /// A viewer with the settings of the last session.
    pub fn new(ctx: &egui::Context, dialogs: Box<dyn Dialogs>, settings: Settings) -> Self {
        let mut state = State::new(&settings.saved);
        if let Some(note) = &settings.note {
            state.report_note(note.clone());
        }
        let ctx = ctx.clone();
        let (sender, receiver) = channel();
        let events = EventSender::new(sender, move || ctx.request_repaint());
        Self {
            state,
            threads: CurrentThreads::new(events.clone()),
            events,
            receiver,
            dialogs,
            settings,
            when_opened: Vec::new(),
            fonts: FallbackFonts::default(),
            is_first_frame: true,
        }
    }

    /// Opens files. Without files, opens those of the last session, or else the first built-in
    /// sample.
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

    /// Opens the files of the last session and an entry of the built-in menu, which a link asks for. It is
    /// active; if it was open, it is not opened again.
    pub fn open_linked(&mut self, entry: usize) {
        if !self.settings.saved.open.is_empty() {
            self.open_at_start(Vec::new());
        }
        let source = built_in::source_of(entry);
        let mut samples = self.state.samples.iter();
        let open = samples.find(|sample| Some(sample.source.as_str()) == source);
        let intent = match open.map(|sample| sample.id) {
            Some(id) => Intent::Activate(id),
            None => Intent::OpenBuiltIn(entry),
        };
        self.when_opened(vec![intent]);
    }

    /// Applies intents once all files that are being read are open.
    pub fn when_opened(&mut self, intents: Vec<Intent>) {
        self.when_opened = intents;
    }

    /// Whether jobs are running or intents are pending.
    pub fn is_busy(&self) -> bool {
        self.state.is_busy() || !self.when_opened.is_empty()
    }

    /// Runs and draws a frame.
    pub fn frame(&mut self, ui: &mut egui::Ui) {
        let ctx = ui.ctx().clone();
        if std::mem::take(&mut self.is_first_frame) {
            self.fold_panels(ctx.content_rect().width());
        }
        self.take_events();
        self.state.system_dark = theme::system_is_dark(&ctx);
        theme::set(&ctx, self.state.interface.dark);
        self.fonts.provide(&ctx, self.state.texts_of_files());
        let regained_focus = |event: &egui::Event| *event == egui::Event::WindowFocused(true);
        if ctx.input(|input| input.events.iter().any(regained_focus)) {
            self.state.check_files();
        }
        self.apply(self.keys_and_drops(&ctx));
        self.show_panels(ui);
        if !ctx.input(|input| input.pointer.any_down()) {
            self.state.commit();
        }
        self.carry_out_effects(&ctx);
        self.threads.end_cancelled();
        self.save_settings(&ctx);
    }

    /// In a narrow window, of which the user has not chosen the panels, the plot has more than half of
    /// the window: samples and results are folded to their buttons in the status line.
    fn fold_panels(&mut self, width: f32) {
        if width < NARROW_WINDOW && self.settings.saved.interface == Interface::default() {
            self.state.interface.samples = false;
            self.state.interface.results = false;
        }
    }

    fn take_events(&mut self) {
        while let Ok(event) = self.receiver.try_recv() {
            self.state.take_event(event);
        }
        if self.state.files_being_read == 0 {
            let intents = std::mem::take(&mut self.when_opened);
            self.apply(intents);
        }
    }

    fn keys_and_drops(&self, ctx: &egui::Context) -> Vec<Intent> {
        let mut intents = panels::drop::intents(ctx, self.events.clone());
        if self.state.dialog.is_none() {
            let pressed = shortcuts::pressed(ctx).into_iter();
            intents.extend(pressed.map(Intent::Command));
        }
        intents
    }

    fn show_panels(&mut self, ui: &mut egui::Ui) {
        let ctx = ui.ctx().clone();
        let mut intents = Vec::new();
        panels::menu::show(ui, &self.state, &mut intents);
        panels::status::show(ui, &self.state, &mut intents);
        self.apply(std::mem::take(&mut intents));
        if self.state.interface.results {
            panels::results::show(ui, &self.state, &mut intents);
        }
        if self.state.interface.parameters {
            self.show_parameters(ui);
        }
        // The following panels show values derived from the parameters of this frame.
        self.state.refresh();
        if self.state.interface.samples {
            panels::samples::show(ui, &self.state, &mut intents);
        }
        panels::messages::show(ui, &self.state, &mut intents);
        plot::show(ui, &self.state, &mut intents);
        panels::dialog::show(&ctx, &self.state, self.dialogs.available(), &mut intents);
        self.apply(intents);
    }

    /// Draws the panel of the parameters. Changed parameters are applied before the values derived
    /// from them are drawn below, so that both belong to the same frame.
    fn show_parameters(&mut self, ui: &mut egui::Ui) {
        let mut changed = false;
        let state = RefCell::new(&mut self.state);
        panels::parameters::show_panel(
            ui,
            |ui| {
                let mut state = state.borrow_mut();
                let mut intents = Vec::new();
                panels::result::show(ui, &state, &mut intents);
                state.apply_all(std::mem::take(&mut intents));
                panels::parameters::show(ui, &state, &mut intents);
                changed = !intents.is_empty();
                state.apply_all(intents);
                state.refresh();
                panels::parameters::show_reflectance(ui, &state);
            },
            |ui| {
                let mut state = state.borrow_mut();
                let mut intents = Vec::new();
                panels::fit::show(ui, &state, &mut intents);
                state.apply_all(intents);
            },
        );
        // Results and card were drawn before, from the old parameters: the frame is drawn again.
        if changed {
            ui.ctx().request_discard("parameters have changed");
        }
    }

    fn apply(&mut self, intents: Vec<Intent>) {
        self.state.apply_all(intents);
    }

    fn carry_out_effects(&mut self, ctx: &egui::Context) {
        let effects = self.state.take_effects();
        // The changes must become visible even if no event follows.
        if !effects.is_empty() {
            ctx.request_repaint();
        }
        for effect in effects {
            match effect {
                Effect::Job(job) => self.threads.start(job),
                Effect::Copy(text) => ctx.copy_text(text),
                Effect::CopyImage(image) => ctx.copy_image(image),
                Effect::AskOpen if self.dialogs.available() => {
                    self.dialogs.open(self.events.clone());
                }
                Effect::AskOpen => self.state.ask_path(),
                Effect::AskExport(kind, path) if self.dialogs.available() => {
                    self.dialogs.export(kind, &path, self.events.clone());
                }
                Effect::AskExport(kind, path) => self.state.ask_export(kind, &path),
                Effect::Quit => ctx.send_viewport_cmd(egui::ViewportCommand::Close),
            }
        }
    }

    /// Saves the settings if they have changed and nothing is being dragged or read.
    fn save_settings(&mut self, ctx: &egui::Context) {
        if self.settings.storage.is_none() {
            return;
        }
        let size = ctx.content_rect().size();
        let window = [
            size.x.max(SMALLEST_WINDOW[0]),
            size.y.max(SMALLEST_WINDOW[1]),
        ];
        let current = self.state.saved(window);
        let dragging = ctx.input(|input| input.pointer.any_down());
        if dragging || self.state.files_being_read > 0 || current == self.settings.saved {
            return;
        }
        self.settings.saved = current;
        let notes = match self.settings.write(&self.state.files_of_session()) {
            Ok(notes) => notes,
            Err(error) => {
                // Without a storage there is no second attempt, and no second message.
                self.settings.storage = None;
                vec![format!("the settings cannot be saved: {error}")]
            }
        };
        for note in notes {
            self.state.report_note(note);
        }
    }
}

impl eframe::App for Viewer {
    fn ui(&mut self, ui: &mut egui::Ui, _: &mut eframe::Frame) {
        self.frame(ui);
    }
}
