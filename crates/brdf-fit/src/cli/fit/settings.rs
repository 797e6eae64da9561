//! What the options of `brdf fit` ask of the library.

use std::path::Path;

use super::arguments::Arguments;
use super::run::Job;
use super::values::{ModelArgument, ReadingWeights};
use crate::cli::failure::Failure;
use crate::cli::stream::{self, Named, StreamError};
use crate::fit::FitOptions;
use crate::model::Model;
use crate::objective::weights::{AssumedErrors, Weights};
use crate::output::{FilesInUse, check_writable};
use crate::plot::{PAGE, figure_files};
use crate::read::ReadOptions;
use crate::report::{ByFile, Depth, Document, DocumentError, ModelChoice};
use crate::scan::{Convention, Format};
use crate::solver::Method;

impl Arguments {
    pub(super) fn options(&self) -> FitOptions {
        let method = |name: &str| name.parse::<Method>().ok();
        FitOptions {
            model: match self.model {
                Some(ModelArgument::Given(model)) => model,
                _ => Model::Three,
            },
            refractive_index: self.n.clone(),
            weights: Weights {
                g1: self.g1.clone().unwrap_or_default(),
                g2: self.g2.clone().unwrap_or_default(),
                errors: match self.weights {
                    ReadingWeights::Sigma => AssumedErrors::Stated,
                    ReadingWeights::Relative => AssumedErrors::Relative,
                    ReadingWeights::None | ReadingWeights::SolidAngle => AssumedErrors::Constant,
                },
                by_solid_angle: matches!(self.weights, ReadingWeights::SolidAngle),
                mask_source: self.mask_source.to_radians(),
                mask_mirror: self.mask_mirror.to_radians(),
            },
            stage1: method(&self.stage1),
            stage1_limit: self.stage1_limit.to_radians(),
            stage2: method(&self.stage2),
            max_iterations: self.max_iterations,
            robust: self.robust,
            energy_limit: self.energy_conserving.map(f64::to_radians),
            fixed: self.fix.unwrap_or_default(),
            ..FitOptions::default()
        }
    }

    /// How much is computed beside the fits: only what is printed or written.
    pub(super) fn depth(&self) -> Depth {
        let only_parameters = self.params_only && self.json.is_none() && self.plot.is_none();
        match (only_parameters, self.compare) {
            (true, _) => Depth::Fit,
            (false, false) => Depth::Assessed,
            (false, true) => Depth::Compared,
        }
    }

    /// Whether each of the compared models gets a line of its own: with `--params-only --compare`.
    pub(super) fn fits_every_model(&self) -> bool {
        self.params_only && self.compare
    }

    /// The options for a scan, one for each of its models.
    pub(super) fn for_each_model(&self, options: FitOptions) -> Vec<FitOptions> {
        if !self.fits_every_model() {
            return vec![options];
        }
        let with = |&model: &Model| options.with_model(model);
        Model::WITH_REFERENCES.iter().map(with).collect()
    }

    pub(super) fn choice(&self) -> ModelChoice {
        if self.model == Some(ModelArgument::Auto) && !self.fits_every_model() {
            ModelChoice::Auto
        } else {
            ModelChoice::Given
        }
    }

    /// Checks that no output replaces an input or another output, that each can be written, and that
    /// each standard stream is used once.
    pub(super) fn check_files(&self) -> Result<FilesInUse, Failure> {
        let inputs = self.files.iter().map(|file| ("FILE", file.as_path()));
        let again = self.again.iter().map(|file| ("--again", file.as_path()));
        if let Some(folder) = &self.plot {
            stream::check_folder(("--plot", folder))?;
        }
        if let (true, Some((option, _))) = (self.params_only, self.on_standard_output()) {
            let (first, second) = ("--params-only", option);
            return Err(StreamError::OutputTwice { first, second }.into());
        }
        let page = self.plot.as_ref().map(|folder| folder.join(PAGE));
        let page = page.as_ref().map(|page| ("--plot", page.as_path()));
        Ok(stream::check(
            inputs.chain(again),
            self.data_files().chain(page),
            self.plot.as_deref(),
        )?)
    }

    /// Checks that no figure of the scans, whose names depend on their wavelengths, replaces one of
    /// the files in use, and that each can be written.
    pub(super) fn check_figures(
        &self,
        jobs: &[Job<'_>],
        in_use: &FilesInUse,
    ) -> Result<(), Failure> {
        let Some(folder) = &self.plot else {
            return Ok(());
        };
        let scans = jobs.iter().map(|job| job.scan);
        for name in figure_files(scans) {
            let path = folder.join(name);
            in_use.check(&path).map_err(StreamError::from)?;
            if path.symlink_metadata().is_ok() {
                check_writable(&path)?;
            }
        }
        Ok(())
    }

    /// The files of `--json` and `--curves`.
    fn data_files(&self) -> impl Iterator<Item = Named<'_>> {
        let files = [("--json", &self.json), ("--curves", &self.curves)];
        let files = files.into_iter();
        files.filter_map(|(option, path)| Some((option, path.as_deref()?)))
    }

    /// The output that is written to standard output in place of the tables.
    pub(super) fn on_standard_output(&self) -> Option<Named<'_>> {
        self.data_files().find(|(_, path)| stream::is_stream(path))
    }

    /// The document of `--again`.
    pub(super) fn document(&self) -> Result<Option<Document>, DocumentError> {
        self.again.as_ref().map(Document::read).transpose()
    }

    /// How a file is read: as the options say, next as the document states for this file, and next
    /// with the sides, columns and declarations that the options of the earlier run gave to its first
    /// file.
    pub(super) fn read_options(&self, file: &Path, document: Option<&ByFile<'_>>) -> ReadOptions {
        let known = document.and_then(|document| document.report_on(stream::shown(file)));
        let first = document.and_then(|document| document.reports().first());
        let with_sides = first.filter(|first| {
            matches!(first.format, Format::Csv | Format::Goniometer)
                && first.convention != Convention::default()
        });
        let sides = known.or(with_sides).map(|report| report.convention);
        let settings = known.or(first).map(|report| &report.read_settings);
        let given = &self.reading;
        let columns = given.columns();
        ReadOptions {
            format: given.format.or(known.map(|report| report.format)),
            theta_positive: given
                .theta_positive
                .or(sides.map(|sides| sides.theta_positive)),
            phi_zero: given.phi_zero.or(sides.map(|sides| sides.phi_zero)),
            sample: self.sample.and_then(|count| usize::try_from(count).ok()),
            columns: settings.map_or_else(
                || columns.to_vec(),
                |settings| with_precedence(columns, &settings.columns),
            ),
            declarations: settings.map_or_else(
                || given.declare.clone(),
                |settings| with_precedence(&given.declare, &settings.declarations),
            ),
        }
    }

    /// Whether the files are joined: by the option, or as the first of them was in the earlier run.
    pub(super) fn joins(&self, document: Option<&ByFile<'_>>) -> bool {
        let report = document.and_then(|document| {
            let file = self.files.first();
            let known = file.and_then(|file| document.report_on(stream::shown(file)));
            known.or_else(|| document.reports().first())
        });
        self.reading.join || report.is_some_and(|report| !report.read_settings.joined.is_empty())
    }
}

/// Pairs of which those that are given anew replace earlier ones of the same key.
fn with_precedence(
    given: &[(String, String)],
    earlier: &[(String, String)],
) -> Vec<(String, String)> {
    let replaced = |(key, _): &&(String, String)| !given.iter().any(|(other, _)| other == key);
    let kept = earlier.iter().filter(replaced);
    kept.chain(given).cloned().collect()
}
