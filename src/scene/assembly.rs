//! From the pieces of a file to one mesh in scene axes: what all loaders share.
//!
//! Transforms are f64 throughout, so that a piece which a node puts a thousand kilometres away keeps its millimetres.

use super::{Mesh, Part, Texture, Triangle, Wrap, texels};
use crate::error::{Error, Result};
use crate::warning::Warning;
use glam::{DAffine3, DMat3, DVec2, DVec3, DVec4};

/// A piece of geometry in axes of its own. `normals`, `uvs` and `colors` are empty or as long as `positions`.
#[derive(Default, Clone)]
pub(super) struct Piece {
    pub positions: Vec<DVec3>,
    pub normals: Vec<DVec3>,
    pub uvs: Vec<DVec2>,
    pub colors: Vec<DVec4>,
    pub triangles: Vec<[u32; 3]>,
    pub material: u32,
}

/// A mesh in the making.
#[derive(Default)]
pub(super) struct Assembly {
    /// The most vertices or triangles, where instances could make more of a file than memory holds.
    most: Option<usize>,
    mesh: Mesh,
    parts: Vec<Part>,
    degenerate: usize,
    odd_attributes: usize,
}

/// Twice a triangle's area over its longest edge squared, below which rounding of f64 edges alone can make it.
const LEAST_ASPECT: f64 = 1e-14;

/// A scene may have this many vertices, and triangles ...
const MOST_VERTICES: usize = 1 << 22;
/// ... and as many more for each byte of its files: instances make much of little, but not everything of nothing.
const VERTICES_A_BYTE: usize = 64;

/// What normals are carried along by: they are covectors, and go with the cofactors, which exist where the inverse
/// transpose does not. A mirroring transform leaves them on the side that the winding shows.
pub(super) fn cofactors(linear: DMat3) -> DMat3 {
    let sign = if linear.determinant() < 0.0 {
        -1.0
    } else {
        1.0
    };
    DMat3::from_cols(
        linear.y_axis.cross(linear.z_axis) * sign,
        linear.z_axis.cross(linear.x_axis) * sign,
        linear.x_axis.cross(linear.y_axis) * sign,
    )
}

impl Assembly {
    /// For a file of so many bytes, with all that it names, whose memory is to stay below a multiple of that.
    pub fn of_file(bytes: usize) -> Self {
        let most = MOST_VERTICES.saturating_add(VERTICES_A_BYTE.saturating_mul(bytes));
        Assembly {
            most: Some(most),
            ..Assembly::default()
        }
    }

    /// Starts an object: what is added from now on belongs to it.
    pub fn begin_part(&mut self, names: Vec<String>) {
        let start = self.triangle_count();
        self.end_part();
        self.parts.push(Part {
            names,
            triangles: start..start,
        });
    }

    /// Ends the object that was begun last; one without triangles is none.
    fn end_part(&mut self) {
        let end = self.triangle_count();
        if let Some(part) = self.parts.last_mut() {
            part.triangles.end = end;
            if part.triangles.is_empty() {
                self.parts.pop();
            }
        }
    }

    fn triangle_count(&self) -> u32 {
        // Triangles have vertices, whose number is 32 bits wide; of more triangles than that the last have no names.
        u32::try_from(self.mesh.triangles.len()).unwrap_or(u32::MAX)
    }

    /// Counts attributes of vertices that were found invalid on the way.
    pub fn count_odd(&mut self, count: usize) {
        self.odd_attributes += count;
    }

    /// An error for more copies of `piece` than a file of this size may hold.
    pub fn check_room(
        &self,
        piece: &Piece,
        copies: usize,
        place: &dyn Fn() -> String,
    ) -> Result<()> {
        let most = self.most.unwrap_or(usize::MAX);
        let beyond = |present: usize, more: usize| {
            more.saturating_mul(copies).saturating_add(present) > most
        };
        if beyond(self.mesh.positions.len(), piece.positions.len())
            || beyond(self.mesh.triangles.len(), piece.triangles.len())
        {
            return Err(Error::input(
                place(),
                format!(
                    "with it the scene has more vertices or triangles than a file of its size may hold ({most})"
                ),
                "use fewer instances",
            ));
        }
        Ok(())
    }

    /// Adds `piece`, moved by `to_scene`. A mirroring transform turns the winding, so that front sides stay in front.
    ///
    /// `place` names the piece in errors: a position that is not finite, an index beyond the vertices.
    pub fn add(
        &mut self,
        piece: &Piece,
        to_scene: DAffine3,
        place: &dyn Fn() -> String,
    ) -> Result<()> {
        let linear = to_scene.matrix3;
        let mirrored = linear.determinant() < 0.0;
        let cofactors = cofactors(linear);

        let count = piece.positions.len();
        let base = u32::try_from(self.mesh.positions.len())
            .ok()
            .filter(|base| base.checked_add(count as u32).is_some() && count < u32::MAX as usize)
            .ok_or_else(|| {
                Error::input(
                    place(),
                    "the scene has more than 4 294 967 295 vertices",
                    "split it, or use fewer instances",
                )
            })?;

        self.check_room(piece, 1, place)?;
        // Memory that is not there is an error, not the end of the program.
        let mesh = &mut self.mesh;
        let colored = !piece.colors.is_empty() || !mesh.colors.is_empty();
        let room = [
            mesh.positions.try_reserve(count),
            mesh.normals.try_reserve(count),
            mesh.uvs.try_reserve(count),
            mesh.colors.try_reserve(if colored {
                base as usize + count - mesh.colors.len()
            } else {
                0
            }),
            mesh.triangles.try_reserve(piece.triangles.len()),
        ];
        if room.iter().any(Result::is_err) {
            return Err(Error::failed(
                format!("{}: there is no memory for its vertices", place()),
                "free memory, or use fewer instances",
            ));
        }

        for (i, p) in piece.positions.iter().enumerate() {
            let moved = to_scene.transform_point3(*p);
            if !moved.is_finite() {
                return Err(Error::input(
                    place(),
                    format!("the position of vertex {i} is not a finite number"),
                    "repair the vertex in the program that made the file and export again",
                ));
            }
            self.mesh.positions.push(moved);
        }
        for i in 0..count {
            let n = cofactors * piece.normals.get(i).copied().unwrap_or(DVec3::ZERO);
            if !n.is_finite() {
                self.odd_attributes += 1;
            }
            self.mesh.normals.push(n.normalize_or_zero());
            let uv = piece.uvs.get(i).copied().unwrap_or(DVec2::ZERO);
            self.odd_attributes += usize::from(!uv.is_finite());
            self.mesh
                .uvs
                .push(if uv.is_finite() { uv } else { DVec2::ZERO });
        }
        if colored {
            self.mesh.colors.resize(base as usize, DVec4::ONE);
            for i in 0..count {
                let c = piece.colors.get(i).copied().unwrap_or(DVec4::ONE);
                let valid =
                    c.is_finite() && c.cmpge(DVec4::ZERO).all() && c.cmple(DVec4::ONE).all();
                self.odd_attributes += usize::from(!valid);
                self.mesh.colors.push(if c.is_finite() {
                    c.clamp(DVec4::ZERO, DVec4::ONE)
                } else {
                    DVec4::ONE
                });
            }
        }

        for (i, &[a, b, c]) in piece.triangles.iter().enumerate() {
            if let Some(beyond) = [a, b, c].into_iter().find(|&v| v as usize >= count) {
                return Err(Error::input(
                    place(),
                    format!(
                        "triangle {i} names vertex {beyond}, but there are {count} (0 to {})",
                        count as i64 - 1
                    ),
                    "the file is damaged: export it again",
                ));
            }
            // Without the translation: whether a triangle has an area must not depend on where it stands.
            let edge = |u: u32, v: u32| {
                linear * (piece.positions[v as usize] - piece.positions[u as usize])
            };
            let (ab, ac, bc) = (edge(a, b), edge(a, c), edge(b, c));
            let longest = ab
                .length_squared()
                .max(ac.length_squared())
                .max(bc.length_squared());
            let doubled_area = ab.cross(ac).length();
            // An overflow to infinity or NaN leaves nothing to draw either.
            if !doubled_area.is_finite() || doubled_area <= LEAST_ASPECT * longest {
                self.degenerate += 1;
                continue;
            }
            let vertices = if mirrored { [a, c, b] } else { [a, b, c] };
            self.mesh.triangles.push(Triangle {
                vertices: vertices.map(|v| v + base),
                material: piece.material,
            });
        }
        Ok(())
    }

    /// The mesh with its objects, and its warnings. A mesh without a triangle that has an area is an error.
    pub fn finish(mut self, file: &str, warnings: &mut Vec<Warning>) -> Result<(Mesh, Vec<Part>)> {
        self.end_part();
        if self.mesh.triangles.is_empty() {
            let problem = match self.degenerate {
                0 => "there are no triangles".to_owned(),
                n => format!("none of the {n} triangles has an area"),
            };
            return Err(Error::input(
                file,
                problem,
                "export the surfaces as triangles (not points, lines, curves or compressed geometry)",
            ));
        }
        if self.degenerate > 0 {
            warnings.push(Warning::DegenerateTriangles {
                file: file.to_owned(),
                count: self.degenerate,
            });
        }
        if self.odd_attributes > 0 {
            warnings.push(Warning::InvalidVertexAttributes {
                file: file.to_owned(),
                count: self.odd_attributes,
            });
        }
        Ok((self.mesh, self.parts))
    }
}

/// Texels that a picture may have ...
const MOST_TEXELS: u64 = 1 << 26;
/// ... and as many more for each of its bytes: no more than a picture of one colour compresses to.
const TEXELS_A_BYTE: u64 = 256;

/// Texels that pictures of so many bytes may have.
pub(super) fn most_texels(bytes: usize) -> u64 {
    MOST_TEXELS.saturating_add(TEXELS_A_BYTE.saturating_mul(bytes as u64))
}

/// Decodes a PNG or JPEG; the error says what is wrong with it.
pub(super) fn decode_image(name: &str, bytes: &[u8], wrap: [Wrap; 2]) -> Result<Texture, String> {
    let texels = texels::decode(bytes, most_texels(bytes.len()))?;
    Ok(Texture {
        name: name.to_owned(),
        width: texels.width,
        height: texels.height,
        pixels: texels.pixels,
        wrap,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mirror_keeps_the_front_in_front() {
        let piece = Piece {
            positions: vec![DVec3::ZERO, DVec3::X, DVec3::Y],
            normals: vec![DVec3::Z; 3],
            triangles: vec![[0, 1, 2]],
            ..Piece::default()
        };
        for scale in [
            DVec3::ONE,
            DVec3::new(-2.0, 1.0, 1.0),
            DVec3::new(1.0, 3.0, -1.0),
            -DVec3::ONE,
        ] {
            let mut assembly = Assembly::default();
            assembly
                .add(&piece, DAffine3::from_scale(scale), &String::new)
                .unwrap();
            let (mesh, _) = assembly.finish("test", &mut Vec::new()).unwrap();
            let [a, b, c] = mesh.triangles[0]
                .vertices
                .map(|v| mesh.positions[v as usize]);
            let front = (b - a).cross(c - a).normalize();
            // The front side is carried along: +Z goes where the scale sends it.
            assert_eq!(front, (DVec3::Z * scale).normalize(), "{scale}");
            assert_eq!(mesh.normals[0], front, "{scale}");
        }
    }
}
