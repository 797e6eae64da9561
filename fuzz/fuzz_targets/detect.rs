#![no_main]

use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    for name in ["input", "input.bsdf", "input.astm", "input.binary"] {
        brdf_fuzz::read(bytes, None, name);
    }
});
