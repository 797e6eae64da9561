//! Prints the tables of coverage of `docs/validation.md`: how often the intervals of 95 % hold the truth
//! over simulated scans.
//!
//! The arguments are the number of scans of each cell, 300 without one, and what is studied, as in
//! `measure-coverage 300 three+n`: everything without one. With `cells` behind them, each cell is
//! printed instead of the tables. `measure-coverage 400 noise` prints how often the tests of the noise
//! reject.

use std::process::ExitCode;

use brdf_tests::coverage::{Cell, Design, Noise, Study, cells, table, table_of_tests};

fn main() -> ExitCode {
    let mut arguments: Vec<String> = std::env::args().skip(1).collect();
    let each = arguments.last().is_some_and(|last| last == "cells");
    arguments.truncate(arguments.len() - usize::from(each));
    let scans = arguments
        .first()
        .map_or(Ok(300), |count| count.parse::<u64>());
    let Ok(scans) = scans else {
        eprintln!("error: expected the number of scans of each cell");
        return ExitCode::from(2);
    };
    if arguments.get(1).is_some_and(|name| name == "noise") {
        print!("{}", table_of_tests(scans));
        return ExitCode::SUCCESS;
    }
    let in_plane = Design::IN_PLANE.as_slice();
    let studies = Study::ALL.into_iter().map(|study| (study, in_plane));
    let azimuthal = (Study::Three, [Design::Azimuthal].as_slice());
    for (study, designs) in std::iter::once(azimuthal).chain(studies) {
        if arguments.get(1).is_some_and(|name| name != study.name()) {
            continue;
        }
        let names: Vec<&str> = designs.iter().map(|design| design.name()).collect();
        println!("{}, designs {}:\n", study.name(), names.join(", "));
        if each {
            for cell in cells(study, designs, &Noise::ALL) {
                print_cell(&cell, scans);
            }
        } else {
            println!("{}", table(study, designs, &Noise::ALL, scans));
        }
    }
    ExitCode::SUCCESS
}

fn print_cell(cell: &Cell, scans: u64) {
    print!(
        "{:3} {:5} {:20}",
        cell.design.name(),
        cell.sample,
        cell.noise.name()
    );
    for found in cell.run(scans) {
        print!(
            "  {} {:3.0} % none {:3.0} % w {:5.2}",
            found.parameter, found.percent, found.without_percent, found.width
        );
    }
    println!();
}
