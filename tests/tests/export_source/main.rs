//! The exported sources, each checked by what no one here wrote: naga for the languages of shaders,
//! a C compiler, NumPy, and the compiler of the Open Shading Language.

mod c;
mod cli;
mod coatings;
mod interpreter;
mod numpy;
mod osl;
mod points;
mod reference;
mod shader;
mod shaders;
