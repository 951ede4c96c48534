//! Tables `[shape]` and `[mesh]`.

use super::Checker;
use crate::skin::{
    SkinError,
    file::{Corners, Exactly, MeshTable, ShapeTable},
    quantity::{self, Quantity},
};
use dermatome_geometry::{
    embedding::Embedding,
    outline::{Loop, Outline, PolygonError},
    sheet::EdgeLengths,
};
use nalgebra::Point2;
use std::f64::consts::TAU;

/// Kinds of shape, what they are called, and their fields.
const KINDS: [(&str, &str, &[&str]); 8] = [
    ("disc", "a disc", &["diameter"]),
    ("rectangle", "a rectangle", &["width", "height"]),
    ("ellipse", "an ellipse", &["width", "height"]),
    ("polygon", "a polygon", &["points", "holes"]),
    ("hemisphere", "a hemisphere", &["diameter"]),
    ("cylinder", "a cylinder", &["diameter", "radius", "height", "angle"]),
    ("cone", "a cone", &["diameter_bottom", "diameter_top", "height", "angle"]),
    ("mesh", "a mesh", &["file", "unit", "weld", "allow_cracks"]),
];

impl Checker<'_> {
    /// Outline and embedding of a sheet.
    pub(super) fn surface(&self, shape: &ShapeTable) -> Result<(Outline, Embedding), SkinError> {
        let flat = |outline| (outline, Embedding::Flat);
        match shape.kind.as_str() {
            "disc" => Ok(flat(Outline::disc(self.diameter(shape)? / 2.0))),
            "rectangle" => {
                self.size(shape, 100.0).map(|[width, height]| flat(Outline::rectangle(width, height)))
            }
            "ellipse" => self.size(shape, 10.0).map(|[width, height]| flat(Outline::ellipse(width, height))),
            "polygon" => self.polygon(shape).map(flat),
            "hemisphere" => {
                let radius = self.diameter(shape)? / 2.0;
                Ok((Outline::disc(radius), Embedding::Hemisphere { radius }))
            }
            "cylinder" => self.cylinder(shape),
            _ => self.cone(shape),
        }
    }

    pub(super) fn only_fields_of_kind(&self, shape: &ShapeTable) -> Result<(), SkinError> {
        let Some((_, name, fields)) = KINDS.iter().find(|(kind, ..)| *kind == shape.kind) else {
            let kinds: Vec<_> = KINDS.iter().map(|(kind, ..)| format!("{kind:?}")).collect();
            return self.refuse("shape.kind", format!("{:?}", shape.kind), &kinds.join(", "));
        };
        let text = |quantity: &Option<Quantity>| quantity.as_ref().map(ToString::to_string);
        let given = |is_given: bool| is_given.then(|| "given".to_owned());
        let written = [
            ("shape.diameter", text(&shape.diameter)),
            ("shape.radius", text(&shape.radius)),
            ("shape.diameter_bottom", text(&shape.diameter_bottom)),
            ("shape.diameter_top", text(&shape.diameter_top)),
            ("shape.width", text(&shape.width)),
            ("shape.height", text(&shape.height)),
            ("shape.angle", text(&shape.angle)),
            ("shape.points", given(shape.points.is_some())),
            ("shape.holes", given(shape.holes.is_some())),
            ("shape.file", given(shape.file.is_some())),
            ("shape.unit", given(shape.unit.is_some())),
            ("shape.weld", given(shape.weld.is_some())),
            ("shape.allow_cracks", given(shape.allow_cracks.is_some())),
        ];
        let is_own = |field: &str| fields.iter().any(|own| field.strip_prefix("shape.") == Some(own));
        match written.into_iter().find(|(field, value)| value.is_some() && !is_own(field)) {
            Some((field, value)) => {
                let own: Vec<_> = fields.iter().map(|field| format!("`{field}`")).collect();
                let allowed = format!("nothing ({name} has {})", own.join(", "));
                self.refuse(field, value.unwrap_or_default(), &allowed)
            }
            None => Ok(()),
        }
    }

    fn diameter(&self, shape: &ShapeTable) -> Result<f64, SkinError> {
        self.required("shape.diameter", shape.diameter.as_ref(), quantity::LENGTH)
    }

    fn height(&self, shape: &ShapeTable) -> Result<f64, SkinError> {
        self.required("shape.height", shape.height.as_ref(), quantity::LENGTH)
    }

    /// Width and height, one at most `most` times the other.
    fn size(&self, shape: &ShapeTable, most: f64) -> Result<[f64; 2], SkinError> {
        let width = self.required("shape.width", shape.width.as_ref(), quantity::LENGTH)?;
        let height = self.height(shape)?;
        if (1.0 / most..=most).contains(&(height / width)) {
            return Ok([width, height]);
        }
        let allowed = format!("1/{most} to {most} times `width`");
        self.refuse("shape.height", format!("{height} m"), &allowed)
    }

    fn polygon(&self, shape: &ShapeTable) -> Result<Outline, SkinError> {
        let Some(points) = &shape.points else {
            return self.refuse("shape.points", "missing".into(), "rows of x and y");
        };
        let rim = self.corners("shape.points", points)?;
        let holes = shape.holes.iter().flatten().map(|hole| self.corners("shape.holes", hole));
        let holes = holes.collect::<Result<Vec<_>, _>>()?;
        Outline::polygon(&rim, &holes).or_else(|error| self.refuse_polygon(error))
    }

    fn corners(&self, field: &'static str, written: &Corners) -> Result<Vec<Point2<f64>>, SkinError> {
        let read = |value| self.finite(field, value, quantity::LENGTH);
        written.iter().map(|Exactly([x, y])| Ok(Point2::new(read(x)?, read(y)?))).collect()
    }

    fn refuse_polygon<T>(&self, error: PolygonError) -> Result<T, SkinError> {
        let field = match error.which() {
            Loop::Rim => "shape.points",
            Loop::Hole(_) => "shape.holes",
        };
        let allowed = "sides that do not meet, and holes that lie apart on the sheet";
        self.refuse(field, format!("no polygon: {error}"), allowed)
    }

    fn cylinder(&self, shape: &ShapeTable) -> Result<(Outline, Embedding), SkinError> {
        let radius = match (&shape.radius, &shape.diameter) {
            (Some(_), Some(_)) => {
                return self.refuse("shape.radius", "given".into(), "nothing (`diameter` says the same)");
            }
            (Some(radius), None) => self.positive("shape.radius", radius, quantity::LENGTH)?,
            (None, _) => self.diameter(shape)? / 2.0,
        };
        let (height, angle) = (self.height(shape)?, self.angle(shape)?);
        Ok((Outline::rectangle(radius * angle, height), Embedding::Cylinder { radius }))
    }

    fn cone(&self, shape: &ShapeTable) -> Result<(Outline, Embedding), SkinError> {
        let bottom =
            self.required("shape.diameter_bottom", shape.diameter_bottom.as_ref(), quantity::LENGTH)?;
        let zero = Quantity::Number(0.0);
        let written = shape.diameter_top.as_ref().unwrap_or(&zero);
        let top = self.finite("shape.diameter_top", written, quantity::LENGTH)?;
        // Nearly a cylinder, a cone's apex is too far away to reckon with.
        if !(0.0..=0.999 * bottom).contains(&top) {
            let allowed = "0 to 0.999 times `diameter_bottom`; \"cylinder\" is a kind of its own";
            return self.refuse("shape.diameter_top", written.to_string(), allowed);
        }
        let (height, angle) = (self.height(shape)?, self.angle(shape)?);
        let half_angle = ((bottom - top) / 2.0).atan2(height);
        let [outer, inner] = [bottom, top].map(|diameter| diameter / 2.0 / half_angle.sin());
        let outline = Outline::sector(inner, outer, angle * half_angle.sin());
        Ok((outline, Embedding::Cone { half_angle, to_apex: (inner + outer) / 2.0 }))
    }

    fn angle(&self, shape: &ShapeTable) -> Result<f64, SkinError> {
        let Some(written) = &shape.angle else {
            return self.refuse("shape.angle", "missing".into(), "an angle above 0, below 360 deg");
        };
        let angle = self.positive("shape.angle", written, quantity::ANGLE)?;
        if angle < TAU * (1.0 - 1e-6) {
            return Ok(angle);
        }
        self.refuse("shape.angle", written.to_string(), "below 360 deg: the patch is open along one side")
    }

    pub(super) fn edges(
        &self,
        table: Option<&MeshTable>,
        outline: &Outline,
        embedding: &Embedding,
    ) -> Result<EdgeLengths, SkinError> {
        let Some(table) = table else {
            return self.refuse("mesh.edge_length", "missing".into(), "an edge length above zero");
        };
        let skin = self.positive("mesh.edge_length", &table.edge_length, quantity::LENGTH)?;
        self.edge_length_fits(outline, embedding, &table.edge_length, skin)?;
        let Some(written) = &table.electrode_edge_length else {
            return Ok(EdgeLengths { skin, electrodes: skin });
        };
        let electrodes = self.positive("mesh.electrode_edge_length", written, quantity::LENGTH)?;
        if (skin / 1000.0..=skin).contains(&electrodes) {
            return Ok(EdgeLengths { skin, electrodes });
        }
        let allowed = "a thousandth of `edge_length` to all of it";
        self.refuse("mesh.electrode_edge_length", written.to_string(), allowed)
    }

    /// Between a handful of elements and a million.
    fn edge_length_fits(
        &self,
        outline: &Outline,
        embedding: &Embedding,
        written: &Quantity,
        edge: f64,
    ) -> Result<(), SkinError> {
        let [x, y] = outline.half_size();
        let longest = x.min(y) / 2.0;
        let shortest = (embedding.area(outline) / 5e5).sqrt();
        if (shortest..=longest).contains(&edge) {
            return Ok(());
        }
        let allowed = format!("{:.3} mm to {:.3} mm for this shape", shortest * 1e3, longest * 1e3);
        self.refuse("mesh.edge_length", written.to_string(), &allowed)
    }
}
