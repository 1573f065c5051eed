//! The manual, a chapter a module, in the order in which a mesh passes through. The texts are files beside this one.
//!
//! - [Control mesh](control_mesh): what a mesh is made of, how files are read, what is refused
//! - [Scheme](schemes): the schemes that refine it
//! - [Truth](truth): the limit at any point, in f64
//! - [Plans](plans): quadtrees and stencils, and what they cost
//! - [Drawing](drawing): methods, the scratch ring, positions
//! - [Triangles](triangles): methods for triangles, and points that are computed beforehand
//! - [Tables of basis functions](tables): tables of basis functions
//! - [Choosing a method](choosing): a paragraph a method, with what each gives and costs
//! - [Back-ends](back_ends): who cuts patches into triangles
//! - [Tess levels](levels): tess levels, and depth tags
//! - [Edges and corners](edges_and_corners): why there are no cracks
//! - [Devices](devices): what a device needs, and driver faults
//! - [Compare](compare): methods side by side
//! - [Benchmarks](benchmarks): what a frame costs
//! - [Figures](figures): the papers' tables and figures, made again
//! - [Verify](verify): the conformance suite
//! - [Command line](command_line): the program
//! - [Library](library): the crate, for engines
//! - [Shaders](shaders): GLSL and SPIR-V
//! - [Tests](tests): what is tested, and how

/// Declares the chapters: each is the text file of its name.
macro_rules! chapters {
    ($($chapter:ident)*) => {
        $(
            pub mod $chapter {
                #![doc = include_str!(concat!(stringify!($chapter), ".md"))]
            }
        )*
    };
}

chapters! {
    control_mesh
    schemes
    truth
    plans
    drawing
    triangles
    tables
    choosing
    back_ends
    levels
    edges_and_corners
    devices
    compare
    benchmarks
    figures
    verify
    command_line
    library
    shaders
    tests
}
