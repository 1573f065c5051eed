//! What a surface is seen with.

use glam::{DMat4, DVec3, Mat4};

use crate::abi;
use crate::method::Displacement;

/// What a surface is seen with. A frame has as many as it is drawn from, or its instances have places.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// From the local units of the model's [`Placement`](crate::mesh::Placement) to Vulkan's clip space; column by column.
    pub clip_from_model: [[f32; 4]; 4],
    /// The eye in local units.
    pub eye: [f32; 3],
    /// A displacement along the normal. Where the limit has several normals, on infinite creases and at cusps, points stay.
    pub displacement: Displacement,
}

impl View {
    /// As shaders see it.
    pub(super) fn record(&self) -> abi::View {
        let [right, back] = self.axes().map(|axis| axis.as_vec3().to_array());
        abi::View {
            clip_from_model: self.clip_from_model,
            eye: self.eye,
            right,
            back,
            displacement: [self.displacement.height, self.displacement.frequency],
        }
    }
    /// To the picture's right, and out of it towards who looks.
    ///
    /// Both are in the matrix: w, row 3, grows straight away from the eye, and x, row 0, to the right, if the picture's middle is elsewhere with a
    /// share of w. An orthographic w does not grow; the eye is far away then, and seen from the model's middle in the direction in which it is seen
    /// from everywhere.
    fn axes(&self) -> [DVec3; 2] {
        let rows: DMat4 = Mat4::from_cols_array_2d(&self.clip_from_model)
            .as_dmat4()
            .transpose();
        let away = rows.w_axis.truncate().normalize_or_zero();
        let eye = DVec3::from(self.eye.map(f64::from));
        let back = if away == DVec3::ZERO {
            eye.normalize_or_zero()
        } else {
            -away
        };
        let along_x = rows.x_axis.truncate().normalize_or_zero();
        let right = (along_x - along_x.dot(back) * back).normalize_or_zero();
        [right, back]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;
    use glam::camera::rh::proj::vulkan::{orthographic, perspective, perspective_infinite_reverse};
    use glam::camera::rh::view::look_at_mat4;

    fn view(clip_from_model: Mat4, eye: Vec3) -> View {
        View {
            clip_from_model: clip_from_model.to_cols_array_2d(),
            eye: eye.to_array(),
            displacement: Displacement::default(),
        }
    }

    #[test]
    fn axes_are_the_cameras_in_perspective_and_orthographic_pictures_of_any_size() {
        let eye = Vec3::new(3.0, -1.0, 2.0);
        let look = look_at_mat4(eye, Vec3::new(0.5, 0.5, 0.0), Vec3::Y);
        let camera = Mat4::transpose(&look);
        for size in [1e-12, 1.0, 1e12] {
            let scale = Mat4::from_scale(Vec3::splat(1.0 / size));
            for projection in [
                perspective(0.8, 1.5, 0.1, 50.0),
                perspective_infinite_reverse(0.8, 1.5, 0.1),
            ] {
                let [right, back] = view(projection * look * scale, eye * size).axes();
                assert!((right.as_vec3() - camera.x_axis.truncate()).length() < 1e-5);
                assert!((back.as_vec3() - camera.z_axis.truncate()).length() < 1e-5);
            }
        }
        let flat =
            orthographic(-1.0, 1.0, -1.0, 1.0, 0.0, 9.0) * look_at_mat4(eye, Vec3::ZERO, Vec3::Y);
        let [right, back] = view(flat, eye).axes();
        assert!((back.as_vec3() - eye.normalize()).length() < 1e-5);
        assert!(right.dot(back).abs() < 1e-12 && (right.length() - 1.0).abs() < 1e-12);
        assert_eq!(view(Mat4::ZERO, Vec3::ZERO).axes(), [DVec3::ZERO; 2]);
    }
}
