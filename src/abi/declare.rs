//! How what host and shaders share is declared: once in Rust, from which its GLSL is made.

/// A type that both languages have.
pub(super) trait Shared {
    /// The declaration of a member of this type.
    fn declare(name: &str) -> String;
}

impl Shared for u32 {
    fn declare(name: &str) -> String {
        format!("uint {name}")
    }
}

impl Shared for f32 {
    fn declare(name: &str) -> String {
        format!("float {name}")
    }
}

impl Shared for [f32; 2] {
    fn declare(name: &str) -> String {
        format!("vec2 {name}")
    }
}

impl Shared for [f32; 3] {
    fn declare(name: &str) -> String {
        format!("vec3 {name}")
    }
}

impl Shared for [f32; 4] {
    fn declare(name: &str) -> String {
        format!("vec4 {name}")
    }
}

impl Shared for [[f32; 4]; 4] {
    fn declare(name: &str) -> String {
        format!("mat4 {name}")
    }
}

impl<const N: usize> Shared for [u32; N] {
    fn declare(name: &str) -> String {
        format!("uint {name}[{N}]")
    }
}

impl<const N: usize, const M: usize> Shared for [[u32; N]; M] {
    fn declare(name: &str) -> String {
        format!("uint {name}[{M}][{N}]")
    }
}

/// Declares constants, and how they read in GLSL.
macro_rules! constants {
    ($($(#[doc = $doc:literal])* $name:ident = $value:expr;)*) => {
        $($(#[doc = $doc])* pub const $name: u32 = $value;)*

        pub(super) fn glsl_constants() -> String {
            let mut text = String::new();
            $(
                $(text += &format!("//{}\n", $doc);)*
                text += &constant(stringify!($name), $name);
            )*
            text
        }
    };
}

/// Numbers of sets begin with a macro that an engine's own shaders are compiled with.
pub(super) fn constant(name: &str, value: u32) -> String {
    let moved = if name.starts_with("SET_") {
        "HULLFORM_SET + "
    } else {
        ""
    };
    format!("const uint {name} = {moved}{value}u;\n")
}

/// Declares structs, how they read in GLSL, and where their members lie.
macro_rules! structs {
    ($($(#[doc = $doc:literal])* $name:ident { $($(#[doc = $member_doc:literal])* $member:ident: $kind:ty,)* })*) => {
        $(
            $(#[doc = $doc])*
            #[repr(C)]
            #[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
            pub struct $name { $($(#[doc = $member_doc])* pub $member: $kind,)* }
        )*

        fn glsl_structs() -> String {
            let mut text = String::new();
            $(
                text += "\n";
                $(text += &format!("//{}\n", $doc);)*
                text += &format!("struct {} {{\n", stringify!($name));
                $(
                    $(text += &format!("    //{}\n", $member_doc);)*
                    text += &format!("    {};\n", <$kind as Shared>::declare(stringify!($member)));
                )*
                text += "};\n";
            )*
            text
        }

        /// Name, size in bytes, and members with their offsets, of every shared struct.
        pub const LAYOUTS: &[(&str, usize, &[(&str, usize)])] = &[
            $((stringify!($name), size_of::<$name>(), &[
                $((stringify!($member), std::mem::offset_of!($name, $member)),)*
            ]),)*
        ];
    };
}
