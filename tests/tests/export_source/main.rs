//! The exported sources, each checked with an independent implementation of its language: naga for
//! GLSL and WGSL, a C compiler, NumPy, and the compiler of the Open Shading Language.

mod c;
mod cli;
mod interpreter;
mod materials;
mod numpy;
mod osl;
mod points;
mod reference;
mod shader;
mod shaders;
