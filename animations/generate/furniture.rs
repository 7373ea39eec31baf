//! Furniture, each piece about its own origin on the floor and its front towards +z.

use crate::GAP;
use crate::scene::Material;
use crate::solid::Solid;

/// A table of the given width and depth, 75 cm high.
pub(crate) fn table(width: f32, depth: f32, wood: Material) -> Vec<Solid> {
    const LEG: f32 = 0.055;
    let (x, z) = (width / 2.0 - 0.04, depth / 2.0 - 0.04);
    let mut parts = vec![Solid::cuboid(
        [-width / 2.0, 0.715, -depth / 2.0],
        [width / 2.0, 0.75, depth / 2.0],
        wood,
    )];
    for (right, front) in [(false, false), (true, false), (false, true), (true, true)] {
        let low = [
            if right { x - LEG } else { -x },
            0.0,
            if front { z - LEG } else { -z },
        ];
        parts.push(Solid::cuboid(
            low,
            [low[0] + LEG, 0.714, low[2] + LEG],
            wood,
        ));
    }
    let (inner_x, inner_z) = (x - LEG - GAP, z - LEG - GAP);
    for side in [-1.0, 1.0] {
        let (at_x, at_z) = (side * (x - LEG / 2.0), side * (z - LEG / 2.0));
        parts.push(Solid::cuboid(
            [-inner_x, 0.63, at_z - 0.01],
            [inner_x, 0.714, at_z + 0.01],
            wood,
        ));
        parts.push(Solid::cuboid(
            [at_x - 0.01, 0.63, -inner_z],
            [at_x + 0.01, 0.714, inner_z],
            wood,
        ));
    }
    parts
}

/// A chair whose back is at −z, its seat and slats of another paint.
pub(crate) fn chair(wood: Material, seat: Material) -> Vec<Solid> {
    const LEG: f32 = 0.036;
    let mut parts = vec![
        Solid::cuboid([-0.21, 0.43, -0.17], [0.21, 0.465, 0.23], seat),
        Solid::cuboid([-0.168, 0.56, -0.199], [0.168, 0.6, -0.181], wood),
        Solid::cuboid([-0.168, 0.67, -0.199], [0.168, 0.71, -0.181], wood),
        Solid::cuboid([-0.168, 0.78, -0.199], [0.168, 0.88, -0.181], wood),
    ];
    for x in [-0.205, 0.205 - LEG] {
        parts.push(Solid::cuboid(
            [x, 0.0, 0.18],
            [x + LEG, 0.429, 0.18 + LEG],
            wood,
        ));
        parts.push(Solid::cuboid(
            [x, 0.0, -0.171 - LEG],
            [x + LEG, 0.9, -0.171],
            wood,
        ));
    }
    parts
}

/// A sideboard with two drawers above two doors, on four feet; its top is at 85 cm.
pub(crate) fn sideboard(
    width: f32,
    depth: f32,
    wood: Material,
    front: Material,
    knob: Material,
) -> Vec<Solid> {
    let (x, z) = (width / 2.0, depth / 2.0);
    let mut parts = vec![
        Solid::cuboid(
            [-x + 0.01, 0.12, -z + 0.01],
            [x - 0.01, 0.82, z - 0.03],
            wood,
        ),
        Solid::cuboid([-x, 0.821, -z], [x, 0.85, z], wood),
    ];
    for (right, ahead) in [(false, false), (true, false), (false, true), (true, true)] {
        let low = [
            if right { x - 0.09 } else { -x + 0.04 },
            0.0,
            if ahead { z - 0.1 } else { -z + 0.04 },
        ];
        parts.push(Solid::cuboid(
            low,
            [low[0] + 0.05, 0.119, low[2] + 0.05],
            wood,
        ));
    }
    for (low, high) in [(-x + 0.02, -0.005), (0.005, x - 0.02)] {
        parts.push(Solid::cuboid(
            [low, 0.63, z - 0.029],
            [high, 0.81, z - 0.01],
            front,
        ));
        parts.push(Solid::cuboid(
            [low, 0.13, z - 0.029],
            [high, 0.62, z - 0.01],
            front,
        ));
        let middle = (low + high) / 2.0;
        parts.push(Solid::cuboid(
            [middle - 0.05, 0.71, z - 0.009],
            [middle + 0.05, 0.725, z + 0.008],
            knob,
        ));
        let handle = if low < -0.1 { high - 0.05 } else { low + 0.035 };
        parts.push(Solid::cuboid(
            [handle, 0.33, z - 0.009],
            [handle + 0.015, 0.45, z + 0.008],
            knob,
        ));
    }
    parts
}

/// Bookshelf boards: the back, two sides, and a shelf at each height; shelves are 2 cm thick.
pub(crate) fn shelf(width: f32, depth: f32, heights: &[f32], wood: Material) -> Vec<Solid> {
    let (x, z, top) = (width / 2.0, depth / 2.0, heights[heights.len() - 1] + 0.02);
    let mut parts = vec![Solid::cuboid([-x, 0.0, -z], [x, top, -z + 0.012], wood)];
    for (low, high) in [(-x, -x + 0.02), (x - 0.02, x)] {
        parts.push(Solid::cuboid([low, 0.0, -z + 0.013], [high, top, z], wood));
    }
    for &height in heights {
        let (low, high) = (
            [-x + 0.021, height, -z + 0.013],
            [x - 0.021, height + 0.02, z],
        );
        parts.push(Solid::cuboid(low, high, wood));
    }
    parts
}

/// A row of books from x = 0 to the right, their spines at z = 0; `pattern` tells one row from another.
pub(crate) fn books(width: f32, pattern: usize, covers: &[Material]) -> Vec<Solid> {
    /// Thickness, height and depth of the books that a row goes through, in metres.
    const BOOKS: [[f32; 3]; 7] = [
        [0.042, 0.24, 0.17],
        [0.03, 0.21, 0.15],
        [0.055, 0.27, 0.19],
        [0.026, 0.19, 0.14],
        [0.048, 0.25, 0.18],
        [0.035, 0.22, 0.16],
        [0.06, 0.26, 0.2],
    ];
    let (mut parts, mut x) = (Vec::new(), 0.0);
    for index in pattern.. {
        let [thick, high, deep] = BOOKS[index * 3 % BOOKS.len()];
        if x + thick > width {
            break;
        }
        parts.push(Solid::cuboid(
            [x, 0.0, -deep],
            [x + thick, high, 0.0],
            covers[index * 5 % covers.len()],
        ));
        x += thick + GAP;
    }
    parts
}

/// A picture about its centre, its back at z = 0: a frame of four bars, a mount, and three fields of colour.
pub(crate) fn picture(
    width: f32,
    height: f32,
    frame: Material,
    mount: Material,
    fields: [Material; 3],
) -> Vec<Solid> {
    const BAR: f32 = 0.035;
    let (x, y) = (width / 2.0, height / 2.0);
    let (in_x, in_y) = (x - BAR - GAP, y - BAR - GAP);
    let mut parts = vec![
        Solid::cuboid([-in_x, -in_y, 0.0], [in_x, in_y, 0.01], mount),
        Solid::cuboid([-x, -y, 0.0], [x, -y + BAR, 0.03], frame),
        Solid::cuboid([-x, y - BAR, 0.0], [x, y, 0.03], frame),
        Solid::cuboid([-x, -in_y, 0.0], [-x + BAR, in_y, 0.03], frame),
        Solid::cuboid([x - BAR, -in_y, 0.0], [x, in_y, 0.03], frame),
    ];
    // Landscape pictures are divided like a window, upright ones into stripes: left, bottom, right, top in halves.
    let divided = [
        [-0.75, -0.72, -0.21, 0.72],
        [-0.2, -0.1, 0.75, 0.72],
        [-0.2, -0.72, 0.75, -0.11],
    ];
    let striped = [
        [-0.75, -0.72, 0.75, -0.21],
        [-0.75, -0.2, 0.75, 0.34],
        [-0.75, 0.35, 0.75, 0.72],
    ];
    let layout = if width > height { divided } else { striped };
    for (field, [left, bottom, right, top]) in fields.into_iter().zip(layout) {
        parts.push(Solid::cuboid(
            [left * in_x, bottom * in_y, 0.011],
            [right * in_x, top * in_y, 0.014],
            field,
        ));
    }
    parts
}

/// A bellied vase, open at the top.
pub(crate) fn vase(height: f32, clay: Material) -> Solid {
    let outline = [
        (0.0, 0.0),
        (0.16, 0.0),
        (0.3, 0.3),
        (0.26, 0.55),
        (0.11, 0.8),
        (0.15, 1.0),
        (0.11, 0.99),
        (0.08, 0.8),
        (0.0, 0.5),
    ];
    Solid::lathe(
        &outline.map(|(radius, up)| (radius * height, up * height)),
        10,
        clay,
    )
}

/// A wide shallow bowl.
pub(crate) fn bowl(radius: f32, clay: Material) -> Solid {
    let outline = [
        (0.0, 0.0),
        (0.4, 0.0),
        (0.85, 0.28),
        (1.0, 0.5),
        (0.94, 0.5),
        (0.78, 0.3),
        (0.36, 0.08),
        (0.0, 0.08),
    ];
    Solid::lathe(
        &outline.map(|(across, up)| (across * radius, up * radius)),
        10,
        clay,
    )
}
