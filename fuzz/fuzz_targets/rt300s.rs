#![no_main]

use brdf_fit::Format;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| brdf_fuzz::read(bytes, Some(Format::Rt300s), "input"));
