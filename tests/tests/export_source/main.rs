//! The exported sources, each checked by what no one here wrote: naga for the languages of shaders,
//! a C compiler, NumPy, and the compiler of the Open Shading Language.

mod coatings;
mod interpreter;
mod shader;
mod shaders;
