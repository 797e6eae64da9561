//! The problems of a run, each of which is printed once.

use std::collections::HashMap;

use crate::format::{distinct, listed};
use crate::model::Model;
use crate::output::print_error;

use super::outcome::Outcome;

/// What a problem concerns: a wavelength of a file and, where several models are fitted to it, one
/// of them.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Place {
    pub(super) file: String,
    pub(super) wavelength_um: Option<f64>,
    pub(super) model: Option<Model>,
}

/// A file and its wavelength as messages name them.
pub(super) fn place(file: &str, wavelength_um: Option<f64>) -> String {
    let wavelength = wavelength_um.map_or_else(String::new, |w| format!(", {w} um"));
    format!("{file}{wavelength}")
}

/// One problem.
#[derive(Debug)]
enum Problem {
    /// A single fit or a single file: printed as it is.
    Single(String),
    /// An option, at every place that it concerns.
    Usage { message: String, places: Vec<Place> },
}

/// The problems of a run, in the order in which they were found.
///
/// An error in the options concerns every scan in the same way: it is collected, so that it is
/// printed once with all files and wavelengths.
#[derive(Debug, Default)]
pub(super) struct Problems {
    problems: Vec<Problem>,
    outcome: Option<Outcome>,
}

impl Problems {
    /// Adds a message that is printed as it is.
    pub(super) fn add(&mut self, message: &impl ToString, outcome: Outcome) {
        self.problems.push(Problem::Single(message.to_string()));
        self.outcome = self.outcome.max(Some(outcome));
    }

    /// Adds the failure of one fit.
    pub(super) fn add_fit(&mut self, place: &Place, message: &str) {
        let model = place
            .model
            .map_or_else(String::new, |model| format!(", {model}"));
        let scan = self::place(&place.file, place.wavelength_um);
        self.add(&format!("{scan}{model}: {message}"), Outcome::Incomplete);
    }

    /// Adds an error in the options that a fit met.
    pub(super) fn add_usage(&mut self, place: Place, message: String) {
        self.outcome = Some(Outcome::Failed);
        let known = self.problems.iter_mut().find_map(|problem| match problem {
            Problem::Usage {
                message: known,
                places,
            } if *known == message => Some(places),
            _ => None,
        });
        match known {
            Some(places) => places.push(place),
            None => self.problems.push(Problem::Usage {
                message,
                places: vec![place],
            }),
        }
    }

    /// Prints every problem; the exit status that the worst of them asks for.
    pub(super) fn print(&self) -> Outcome {
        for problem in &self.problems {
            print_error(&problem.text());
        }
        self.outcome.unwrap_or(Outcome::Complete)
    }
}

impl Problem {
    fn text(&self) -> String {
        match self {
            Self::Single(message) => message.clone(),
            Self::Usage { message, places } => format!("{}: {message}", listed_places(places)),
        }
    }
}

/// Files with their wavelengths, and the models unless all of them are concerned.
fn listed_places(places: &[Place]) -> String {
    let files = distinct(places.iter().map(|place| place.file.as_str()));
    let mut wavelengths: HashMap<&str, Vec<String>> = HashMap::new();
    for place in places {
        let of_file = wavelengths.entry(&place.file).or_default();
        of_file.extend(
            place
                .wavelength_um
                .map(|wavelength| format!("{wavelength} um")),
        );
    }
    let files = files.into_iter().map(|file| {
        let wavelengths = wavelengths.remove(file).unwrap_or_default();
        let names: Vec<String> = std::iter::once(file.to_owned())
            .chain(distinct(wavelengths))
            .collect();
        listed(&names, ", ")
    });
    let files = listed(&files.collect::<Vec<_>>(), "; ");
    let models = places.iter().filter_map(|place| place.model);
    let models = distinct(models.map(|model| model.to_string()));
    if models.is_empty() || models.len() == Model::WITH_REFERENCES.len() {
        files
    } else {
        format!("{files} (fitting {})", models.join(", "))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(file: &str, wavelength_um: Option<f64>, model: Option<Model>) -> Place {
        Place {
            file: file.to_owned(),
            wavelength_um,
            model,
        }
    }

    #[test]
    fn an_error_in_the_options_is_listed_once_with_all_its_places() {
        let mut problems = Problems::default();
        problems.add_usage(at("a.csv", Some(0.5), None), "no index".to_owned());
        problems.add(&"b.csv: cannot be read", Outcome::Failed);
        problems.add_usage(at("a.csv", Some(0.6), None), "no index".to_owned());
        problems.add_usage(at("c.csv", None, None), "no index".to_owned());
        let texts: Vec<String> = problems.problems.iter().map(Problem::text).collect();
        assert_eq!(
            texts,
            [
                "a.csv, 0.5 um, 0.6 um; c.csv: no index",
                "b.csv: cannot be read"
            ]
        );
    }

    #[test]
    fn of_many_places_the_first_are_listed_and_the_others_counted() {
        let wavelengths = (0..1000).map(|i| at("a.csv", Some(f64::from(i)), None));
        let text = listed_places(&wavelengths.collect::<Vec<_>>());
        assert!(text.starts_with("a.csv, 0 um, 1 um, "), "{text}");
        assert!(text.ends_with(", 18 um and 981 others"), "{text}");
        let files = (0..1000).map(|i| at(&format!("{i}.csv"), Some(0.5), None));
        let text = listed_places(&files.collect::<Vec<_>>());
        assert!(text.starts_with("0.csv, 0.5 um; 1.csv, 0.5 um; "), "{text}");
        assert!(text.ends_with("; 19.csv, 0.5 um and 980 others"), "{text}");
    }

    #[test]
    fn models_are_listed_unless_all_are_concerned() {
        let all = Model::WITH_REFERENCES.map(|model| at("a.csv", None, Some(model)));
        assert_eq!(listed_places(&all), "a.csv");
        assert_eq!(listed_places(&all[..2]), "a.csv (fitting three, three+n)");
    }
}
