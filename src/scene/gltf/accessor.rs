//! Accessors: numbers in buffers, each range checked before it is read (glTF 2.0, 3.6.2).

use super::container::{DAMAGED, Gltf};
use super::notes::shown;
use crate::error::Result;
use glam::DVec3;
use serde_json::{Map, Value};

impl Gltf<'_> {
    /// An accessor's elements, row by row, and the number of components of each, which must be one of `widths`.
    ///
    /// Normalised integers become fractions (glTF 2.0, 3.6.2.2).
    pub fn numbers(&self, index: usize, widths: &[usize], by: &str) -> Result<(usize, Vec<f64>)> {
        let accessor = self.get(&self.json.accessors, "accessors", index, by)?;
        let place = format!("accessors[{index}]");
        let width = match accessor.r#type.as_str() {
            "SCALAR" => 1,
            "VEC2" => 2,
            "VEC3" => 3,
            "VEC4" => 4,
            "MAT4" => 16,
            _ => 0,
        };
        if !widths.contains(&width) {
            return Err(self.error(
                &place,
                format!("type `{}` does not fit {by}", shown(&accessor.r#type)),
                DAMAGED,
            ));
        }
        let component = Component::new(accessor.component_type).ok_or_else(|| {
            self.error(
                &place,
                format!("there is no componentType {}", accessor.component_type),
                DAMAGED,
            )
        })?;
        let mut numbers = match accessor.buffer_view {
            Some(view) => self.slice(
                view,
                accessor.byte_offset,
                accessor.count,
                width,
                component,
                &place,
            )?,
            // Zeros (glTF 2.0, 3.6.2.3). More than the file has bytes would fit nothing that it holds.
            None if accessor.count <= self.size().max(LEAST_IMPLIED) => {
                vec![0.0; accessor.count * width]
            }
            None => {
                return Err(self.error(
                    &place,
                    format!(
                        "{} elements without data are more than the file has bytes",
                        accessor.count
                    ),
                    DAMAGED,
                ));
            }
        };
        if let Some(sparse) = &accessor.sparse {
            let kind = Component::new(sparse.indices.component_type).ok_or_else(|| {
                self.error(
                    &place,
                    "the sparse indices have no valid componentType",
                    DAMAGED,
                )
            })?;
            let rows = self.slice(
                sparse.indices.buffer_view,
                sparse.indices.byte_offset,
                sparse.count,
                1,
                kind,
                &place,
            )?;
            let values = self.slice(
                sparse.values.buffer_view,
                sparse.values.byte_offset,
                sparse.count,
                width,
                component,
                &place,
            )?;
            for (row, value) in rows.into_iter().zip(values.chunks_exact(width)) {
                let at = row as usize * width;
                numbers
                    .get_mut(at..at + width)
                    .ok_or_else(|| {
                        self.error(
                            &place,
                            format!(
                                "sparse index {row} is beyond its {} elements",
                                accessor.count
                            ),
                            DAMAGED,
                        )
                    })?
                    .copy_from_slice(value);
            }
        }
        if accessor.normalized && component != Component::F32 {
            let most = component.most();
            numbers.iter_mut().for_each(|x| *x = (*x / most).max(-1.0));
        }
        Ok((width, numbers))
    }

    /// The accessor of an attribute, if it is there.
    pub fn attribute(
        &self,
        attributes: &Map<String, Value>,
        name: &str,
        widths: &[usize],
        by: &str,
    ) -> Result<Option<(usize, Vec<f64>)>> {
        let accessor = attributes.get(name).map(|index| {
            let index = index.as_u64().unwrap_or(u64::MAX) as usize;
            self.numbers(index, widths, &format!("{by}.{name}"))
        });
        accessor.transpose()
    }

    /// An attribute of three components, if it is there.
    pub fn triples(
        &self,
        attributes: &Map<String, Value>,
        name: &str,
        by: &str,
    ) -> Result<Option<Vec<DVec3>>> {
        let numbers = self.attribute(attributes, name, &[3], by)?;
        let rows = |(_, numbers): (usize, Vec<f64>)| {
            numbers.chunks_exact(3).map(DVec3::from_slice).collect()
        };
        Ok(numbers.map(rows))
    }

    /// An accessor's whole numbers, as indices.
    pub fn indices(&self, index: usize, by: &str) -> Result<Vec<u32>> {
        let kind = self
            .get(&self.json.accessors, "accessors", index, by)?
            .component_type;
        if !matches!(kind, 5121 | 5123 | 5125) {
            return Err(self.error(
                format_args!("accessors[{index}]"),
                format!("componentType {kind} cannot count {by}"),
                DAMAGED,
            ));
        }
        // Every u32 is an f64.
        Ok(self
            .numbers(index, &[1], by)?
            .1
            .into_iter()
            .map(|x| x as u32)
            .collect())
    }

    fn slice(
        &self,
        view: usize,
        offset: usize,
        count: usize,
        width: usize,
        component: Component,
        by: &str,
    ) -> Result<Vec<f64>> {
        let bytes = self.view(view, by)?;
        let size = width * component.size();
        let stride = self.json.buffer_views[view].byte_stride.unwrap_or(size);
        let end = count.checked_sub(1).and_then(|last| {
            last.checked_mul(stride)?
                .checked_add(size)?
                .checked_add(offset)
        });
        if stride < size || count > 0 && end.is_none_or(|end| end > bytes.len()) {
            return Err(self.error(
                by,
                format!("{count} elements of {size} bytes, {stride} apart from byte {offset} on, do not fit the {} bytes of bufferViews[{view}]", bytes.len()),
                DAMAGED,
            ));
        }
        let mut numbers = Vec::with_capacity(count * width);
        for row in 0..count {
            let row = &bytes[offset + row * stride..][..size];
            numbers.extend(
                row.chunks_exact(component.size())
                    .map(|c| component.read(c)),
            );
        }
        Ok(numbers)
    }
}

/// Elements of an accessor without data that are believed of the smallest file.
const LEAST_IMPLIED: usize = 1 << 12;

#[derive(Clone, Copy, PartialEq)]
enum Component {
    I8,
    U8,
    I16,
    U16,
    U32,
    F32,
}

impl Component {
    fn new(code: u32) -> Option<Self> {
        Some(match code {
            5120 => Component::I8,
            5121 => Component::U8,
            5122 => Component::I16,
            5123 => Component::U16,
            5125 => Component::U32,
            5126 => Component::F32,
            _ => return None,
        })
    }

    fn size(self) -> usize {
        match self {
            Component::I8 | Component::U8 => 1,
            Component::I16 | Component::U16 => 2,
            Component::U32 | Component::F32 => 4,
        }
    }

    /// What stands for 1 when normalised.
    fn most(self) -> f64 {
        match self {
            Component::I8 => 127.0,
            Component::U8 => 255.0,
            Component::I16 => 32_767.0,
            Component::U16 => 65_535.0,
            Component::U32 => 4_294_967_295.0,
            Component::F32 => 1.0,
        }
    }

    /// The number in `bytes`, which are as many as [`Component::size`].
    fn read(self, bytes: &[u8]) -> f64 {
        match (self, bytes) {
            (Component::I8, &[a]) => f64::from(a as i8),
            (Component::U8, &[a]) => f64::from(a),
            (Component::I16, &[a, b]) => f64::from(i16::from_le_bytes([a, b])),
            (Component::U16, &[a, b]) => f64::from(u16::from_le_bytes([a, b])),
            (Component::U32, &[a, b, c, d]) => f64::from(u32::from_le_bytes([a, b, c, d])),
            (Component::F32, &[a, b, c, d]) => f64::from(f32::from_le_bytes([a, b, c, d])),
            _ => f64::NAN,
        }
    }
}
