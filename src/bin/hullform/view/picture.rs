//! Pictures of what is shown: as it is seen, and as `render` makes it, with the command line that does.

use std::path::{Path, PathBuf};

use clap::Parser;
use hullform::gpu::Decides;
use hullform::mesh::Model;
use hullform::{Error, Result};

use super::context::{Context, under_scheme};
use super::draft::Draft;
use super::viewer::{Culling, Viewer};
use crate::options::{Global, Shape, Standpoint, Triangulate};
use crate::output::{self, Contents, png};
use crate::{Arguments, Command, render};
use clap::ValueEnum;

/// The command line that draws the first model as it is seen, into a file.
pub fn words(viewer: &Viewer, shape: &Shape, global: &Global, file: &Path) -> Vec<String> {
    let (look, cutting, area) = (viewer.look, viewer.cutting, viewer.area);
    let mut words: Vec<String> = ["hullform", "render"].map(String::from).into();
    let path = viewer.parts.first().and_then(|part| part.path());
    words.extend(path.map(|path| path.to_string_lossy().into_owned()));
    let scheme = cutting.scheme.map(|scheme| scheme.name().to_string());
    let shape = Shape {
        scheme: scheme.or(shape.scheme.clone()),
        ..shape.clone()
    };
    words.extend(shape.words());
    words.extend(cutting.method.map(|method| format!("--method={method}")));
    words.push(format!("--level={}", cutting.cut().level));
    words.push(format!("--spacing={}", cutting.spacing.name()));
    words.push(format!("--backend={}", cutting.backend.name()));
    words.push(format!("--residence={}", cutting.residence.name()));
    words.extend(cutting.adaptive.map(|by| format!("--adaptive={by}")));
    let culling = Culling {
        triangles: cutting.culling.triangles,
        ..viewer.wanted().culling
    };
    words.push(format!("--cull={culling}"));
    words.extend(cutting.amplify.then(|| "--amplify-cracks".into()));
    let shading = look.shading.to_possible_value();
    words.extend(shading.map(|shading| format!("--shading={}", shading.get_name())));
    words.extend(look.wireframe.then(|| "--wireframe".into()));
    words.push(format!("--displace={}", look.displace));
    words.extend(Standpoint::words(&viewer.orbit.eye()));
    words.push(format!(
        "--size={}x{}",
        area.width.max(1),
        area.height.max(1)
    ));
    words.push(format!("--output={}", file.to_string_lossy()));
    words.extend(
        global
            .device
            .iter()
            .map(|device| format!("--device={device}")),
    );
    words.extend(global.no_workarounds.then(|| "--no-workarounds".into()));
    words.extend((cutting.decides() == Decides::Host).then(|| "--slots=host".into()));
    words.push(format!("--ring-bytes={}", global.ring_bytes));
    words
}

/// What of that which is seen such a command line leaves out, in words.
pub fn left_out(viewer: &Viewer) -> Vec<&'static str> {
    let parts = &viewer.parts;
    let changed = parts.first().and_then(|part| part.history());
    let left_out = [
        (parts.len() > 1, "all models but the first"),
        (
            changed.is_some_and(|history| history.is_changed()),
            "changes that were not saved",
        ),
        (viewer.look.cage, "the cage"),
        (viewer.look.numbers, "numbers"),
        (viewer.compare.map.is_some(), "the map of errors"),
        (viewer.recipes().len() > 1, "the other method"),
        (
            viewer.frozen.is_some() && viewer.wanted().is_anything(),
            "the frozen camera",
        ),
        (viewer.deform.kind != super::deform::Kind::None, "motion"),
    ];
    let left_out = left_out.into_iter().filter(|(is_so, _)| *is_so);
    left_out.map(|(_, words)| words).collect()
}

/// The words as a shell takes them.
pub fn line(words: &[String]) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "-_=./,:+".contains(c);
    let quoted = words.iter().map(|word| match word.chars().all(plain) {
        true => word.clone(),
        false => format!("'{}'", word.replace('\'', r"'\''")),
    });
    quoted.collect::<Vec<String>>().join(" ")
}

/// Draws what a command line says, of a model as it is changed, and writes the file. Takes its time: for workers.
pub fn render(
    context: &Context,
    draft: &Draft,
    how: Triangulate,
    scheme: Option<hullform::mesh::Scheme>,
    words: &[String],
    file: &Path,
) -> Result<String> {
    let parsed = Arguments::try_parse_from(words).map_err(|error| Error::Option {
        option: "view",
        problem: format!("its own command line is refused: {error}"),
        remedy: "report it, with the command line that Ctrl+C copies".into(),
    })?;
    let Command::Render(arguments) = &parsed.command else {
        return Err(Error::Refused("a command line that does not render".into()));
    };
    let mesh = draft.mesh()?;
    let scheme = scheme.unwrap_or(mesh.options().scheme);
    let model = Model::new(under_scheme(mesh, scheme, how)?);
    let (pixels, _) = render::draw_picture(&context.gpu, &model, 0.0, arguments, &parsed.global)?;
    let size = arguments.size();
    save(file, [size.width, size.height], &pixels)
}

/// Writes a picture from RGBA bytes, and tells where it is.
pub fn save(file: &Path, [width, height]: [u32; 2], rgba: &[u8]) -> Result<String> {
    let files = output::create(&[], &[("screenshot", file)])?;
    let contents: [&Contents; 1] = [&|out| png::write(out, width, height, rgba)];
    output::write(files.into_iter().zip(contents))?;
    Ok(output::wrote(file))
}

/// Writes a model with its changes, and tells where it is.
pub fn save_model(file: &Path, draft: &Draft) -> Result<String> {
    let files = output::create(&[], &[("save", file)])?;
    let contents: [&Contents; 1] = [&|out| draft.write_obj(out)];
    output::write(files.into_iter().zip(contents))?;
    Ok(output::wrote(file))
}

/// The first name with a number that no file has yet, in the folder that we are in.
pub fn free_name(stem: &str, extension: &str) -> PathBuf {
    let names = (1..).map(|number| PathBuf::from(format!("{stem}-{number}.{extension}")));
    let mut free = names.filter(|name| std::fs::symlink_metadata(name).is_err());
    free.next().expect("there are more numbers than files")
}

/// Bytes of a format that has blue first, as RGBA.
pub fn swizzled(bytes: &[u8], format: hullform::ash::vk::Format) -> Vec<u8> {
    use hullform::ash::vk::Format;
    let blue_first = matches!(format, Format::B8G8R8A8_SRGB | Format::B8G8R8A8_UNORM);
    let pixels = bytes.chunks_exact(4);
    let turned = pixels.flat_map(|pixel| match blue_first {
        true => [pixel[2], pixel[1], pixel[0], 255],
        false => [pixel[0], pixel[1], pixel[2], 255],
    });
    turned.collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::adaptive::Adaptive;

    #[test]
    fn the_command_line_is_one_that_render_takes_and_shells_read() {
        let mut viewer = Viewer::default();
        viewer.open([Some(PathBuf::from("a b's.obj"))]);
        viewer.cutting.adaptive = Some(Adaptive::Screen(6.5));
        viewer.cutting.culling.frustum = true;
        viewer.look.wireframe = true;
        viewer.look.displace = -0.05;
        viewer.orbit.target = glam::DVec3::new(-1.0, 1e-7, 3.25);
        viewer.area.width = 640;
        viewer.area.height = 480;
        for orthographic in [false, true] {
            viewer.orbit.orthographic = orthographic;
            let parsed = Arguments::try_parse_from(["hullform", "devices"]);
            let global = parsed.map(|parsed| parsed.global).expect("it is taken");
            let shape = Shape {
                scheme: None,
                triangulate: Triangulate::Fan,
            };
            let words = words(&viewer, &shape, &global, Path::new("x.png"));
            let parsed = Arguments::try_parse_from(&words).map_err(|error| error.to_string());
            let Ok(Command::Render(arguments)) = parsed.map(|parsed| parsed.command) else {
                panic!("{words:?}");
            };
            let (read, shown) = (arguments.wanted(), viewer.wanted());
            assert_eq!(
                (read.adaptive, read.culling),
                (shown.adaptive, shown.culling)
            );
            assert_eq!(arguments.eye(), Some(viewer.orbit.eye()));
            assert!(line(&words).contains(r"'a b'\''s.obj'"));
        }
    }

    #[test]
    fn blue_and_red_change_places_where_blue_is_first() {
        use hullform::ash::vk::Format;
        assert_eq!(
            swizzled(&[1, 2, 3, 0], Format::B8G8R8A8_SRGB),
            [3, 2, 1, 255]
        );
        assert_eq!(
            swizzled(&[1, 2, 3, 0], Format::R8G8B8A8_UNORM),
            [1, 2, 3, 255]
        );
    }
}
