//! Shaders, read, validated and translated by naga.

use naga::back::{glsl, hlsl, msl, spv, wgsl};
use naga::valid::{Capabilities, ModuleInfo, ValidationFlags, Validator};
use naga::{Module, ShaderStage, front};

/// A shader of WGSL that is valid.
pub(crate) fn from_wgsl(text: &str) -> Module {
    let module = front::wgsl::parse_str(text);
    let module = module.unwrap_or_else(|error| panic!("{}", error.emit_to_string(text)));
    translate(&module);
    module
}

/// A shader of GLSL that is valid.
pub(crate) fn from_glsl(text: &str) -> Module {
    let options = front::glsl::Options::from(ShaderStage::Fragment);
    let module = front::glsl::Frontend::default().parse(&options, text);
    let module = module.unwrap_or_else(|error| panic!("{}", error.emit_to_string(text)));
    translate(&module);
    module
}

/// Validates a module, and writes it in all languages that naga has.
fn translate(module: &Module) {
    let mut validator = Validator::new(ValidationFlags::all(), Capabilities::empty());
    let info = validator.validate(module).expect("a valid module");
    let spirv = spv::write_vec(module, &info, &spv::Options::default(), None);
    assert!(!spirv.expect("SPIR-V").is_empty());
    let metal = msl::write_string(
        module,
        &info,
        &msl::Options::default(),
        &msl::PipelineOptions::default(),
    );
    assert!(metal.expect("Metal").0.contains("main"));
    let wgsl = wgsl::write_string(module, &info, wgsl::WriterFlags::empty());
    assert!(wgsl.expect("WGSL").contains("fn main"));
    assert!(in_hlsl(module, &info).contains("main"));
    assert!(in_glsl(module, &info).contains("void main"));
}

fn in_hlsl(module: &Module, info: &ModuleInfo) -> String {
    let (mut text, options) = (String::new(), hlsl::Options::default());
    let entry = hlsl::PipelineOptions::default();
    let mut writer = hlsl::Writer::new(&mut text, &options, &entry);
    writer.write(module, info, None).expect("HLSL");
    text
}

fn in_glsl(module: &Module, info: &ModuleInfo) -> String {
    let (mut text, options) = (String::new(), glsl::Options::default());
    let entry = glsl::PipelineOptions {
        shader_stage: ShaderStage::Fragment,
        entry_point: "main".to_owned(),
        multiview: None,
    };
    let bounds = naga::proc::BoundsCheckPolicies::default();
    let writer = glsl::Writer::new(&mut text, module, info, &options, &entry, bounds);
    writer.expect("a writer").write().expect("GLSL");
    text
}
