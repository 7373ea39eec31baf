//! glTF accessors as plain numbers: every component type, normalized, strided, sparse or without a view.
//!
//! glTF 2.0 specification, Khronos Group 2021, section 3.6. The gltf crate's readers panic or stay silent on broken
//! files, so we decode ourselves: every offset is checked before a byte is read, and every error has its JSON pointer.

mod fits;
mod rows;
mod store;

pub(super) use store::Store;

use crate::error::Result;
use gltf::json::accessor::{ComponentType, Type};
use rows::{integer, number};

impl Store<'_> {
    /// An accessor of vectors with N components, or of matrices with 16, as floats; integers are normalized where the accessor says so.
    pub(super) fn floats<const N: usize>(
        &self,
        accessor: usize,
        user: &str,
    ) -> Result<Vec<[f32; N]>> {
        let wanted = match N {
            1 => Type::Scalar,
            2 => Type::Vec2,
            3 => Type::Vec3,
            4 => Type::Vec4,
            _ => Type::Mat4,
        };
        let header = self.header(accessor, user, wanted)?;
        let (component, normalized) = (header.component, header.json.normalized);
        let read = |bytes: &[u8]| -> [f32; N] {
            let size = component.size();
            std::array::from_fn(|lane| {
                number(
                    &bytes[lane * size..(lane + 1) * size],
                    component,
                    normalized,
                )
            })
        };
        let values = self.elements(&header, N, [0.0; N], read)?;
        match values
            .iter()
            .position(|value| value.iter().any(|number| !number.is_finite()))
        {
            Some(element) => Err(self.broken(
                format!("/accessors/{accessor}"),
                "finite numbers",
                format!("{:?} as element {element}", values[element]),
                "export the file again; the mesh or animation holds numbers that are none",
            )),
            None => Ok(values),
        }
    }

    /// An accessor of vertex indices.
    pub(super) fn indices(&self, accessor: usize, user: &str) -> Result<Vec<u32>> {
        let header = self.header(accessor, user, Type::Scalar)?;
        if !matches!(
            header.component,
            ComponentType::U8 | ComponentType::U16 | ComponentType::U32
        ) {
            return Err(self.faulty(
                format!("/accessors/{accessor}/componentType"),
                "5121, 5123 or 5125 (unsigned integers) for indices",
                header.component.as_gl_enum(),
            ));
        }
        self.elements(&header, 1, 0, integer)
    }

    /// An accessor of four joints for each position.
    pub(super) fn joints(&self, accessor: usize, user: &str) -> Result<Vec<[u16; 4]>> {
        let header = self.header(accessor, user, Type::Vec4)?;
        if !matches!(header.component, ComponentType::U8 | ComponentType::U16) {
            return Err(self.faulty(
                format!("/accessors/{accessor}/componentType"),
                "5121 or 5123 (unsigned integers) for joints",
                header.component.as_gl_enum(),
            ));
        }
        let size = header.component.size();
        self.elements(&header, 4, [0; 4], |bytes| {
            std::array::from_fn(|lane| integer(&bytes[lane * size..(lane + 1) * size]) as u16)
        })
    }
}

#[cfg(test)]
mod tests;
