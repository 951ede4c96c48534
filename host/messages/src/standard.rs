//! Messages that ROS has: fields and their order are those of ROS 2's own packages.

use serde::{Deserialize, Serialize};

/// builtin_interfaces/msg/Time
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Time {
    /// Whole seconds since 1970.
    pub sec: i32,
    /// Nanoseconds of the second.
    pub nanosec: u32,
}

impl Time {
    /// Of nanoseconds since 1970.
    #[must_use]
    pub fn of_nanoseconds(nanoseconds: u64) -> Self {
        let second = 1_000_000_000;
        // Until 2038, as ROS has it.
        let sec = i32::try_from(nanoseconds / second).unwrap_or(i32::MAX);
        Self { sec, nanosec: (nanoseconds % second) as u32 }
    }
}

/// std_msgs/msg/Header
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Header {
    /// When.
    pub stamp: Time,
    /// In which frame places are given.
    pub frame_id: String,
}

/// geometry_msgs/msg/Point and geometry_msgs/msg/Vector3
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Point {
    /// m
    pub x: f64,
    /// m
    pub y: f64,
    /// m
    pub z: f64,
}

impl From<[f64; 3]> for Point {
    fn from([x, y, z]: [f64; 3]) -> Self {
        Self { x, y, z }
    }
}

impl From<[f32; 3]> for Point {
    fn from(values: [f32; 3]) -> Self {
        values.map(f64::from).into()
    }
}

impl Point {
    /// x, y, z as a board has them; exact for what came from one.
    #[must_use]
    pub fn narrow(self) -> [f32; 3] {
        [self.x, self.y, self.z].map(|value| value as f32)
    }
}

/// geometry_msgs/msg/Quaternion
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Quaternion {
    /// Vector part.
    pub x: f64,
    /// Vector part.
    pub y: f64,
    /// Vector part.
    pub z: f64,
    /// Scalar part.
    pub w: f64,
}

impl Default for Quaternion {
    fn default() -> Self {
        Self { x: 0.0, y: 0.0, z: 0.0, w: 1.0 }
    }
}

/// geometry_msgs/msg/Pose and geometry_msgs/msg/Transform
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Pose {
    /// m
    pub position: Point,
    /// A unit quaternion.
    pub orientation: Quaternion,
}

/// geometry_msgs/msg/Wrench
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Wrench {
    /// N
    pub force: Point,
    /// N m
    pub torque: Point,
}

/// geometry_msgs/msg/WrenchStamped
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct WrenchStamped {
    /// When and where: the torque is about the origin of this frame.
    pub header: Header,
    /// Force and torque.
    pub wrench: Wrench,
}

/// geometry_msgs/msg/TransformStamped
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TransformStamped {
    /// When, and the parent.
    pub header: Header,
    /// The child.
    pub child_frame_id: String,
    /// From the child's frame to the parent's.
    pub transform: Pose,
}

/// tf2_msgs/msg/TFMessage
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TfMessage {
    /// Each of a child.
    pub transforms: Vec<TransformStamped>,
}

/// sensor_msgs/msg/PointField
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct PointField {
    /// What.
    pub name: String,
    /// Where it begins in a point, bytes.
    pub offset: u32,
    /// 7: float32.
    pub datatype: u8,
    /// How many.
    pub count: u32,
}

/// sensor_msgs/msg/PointCloud2
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct PointCloud2 {
    /// When and where.
    pub header: Header,
    /// Rows.
    pub height: u32,
    /// Points of a row.
    pub width: u32,
    /// What a point holds.
    pub fields: Vec<PointField>,
    /// Of the data.
    pub is_bigendian: bool,
    /// Bytes of a point.
    pub point_step: u32,
    /// Bytes of a row.
    pub row_step: u32,
    /// The points.
    pub data: Vec<u8>,
    /// Whether each is known.
    pub is_dense: bool,
}

/// std_msgs/msg/ColorRGBA
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Color {
    /// 0 to 1.
    pub r: f32,
    /// 0 to 1.
    pub g: f32,
    /// 0 to 1.
    pub b: f32,
    /// 1: nothing shines through.
    pub a: f32,
}

/// builtin_interfaces/msg/Duration
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Duration {
    /// Whole seconds.
    pub sec: i32,
    /// Nanoseconds of the second.
    pub nanosec: u32,
}

/// sensor_msgs/msg/CompressedImage
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct CompressedImage {
    /// When and where.
    pub header: Header,
    /// jpeg or png.
    pub format: String,
    /// The picture.
    pub data: Vec<u8>,
}

/// visualization_msgs/msg/UVCoordinate
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct UvCoordinate {
    /// 0 to 1.
    pub u: f32,
    /// 0 to 1.
    pub v: f32,
}

/// visualization_msgs/msg/MeshFile
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct MeshFile {
    /// Its name.
    pub filename: String,
    /// What it holds.
    pub data: Vec<u8>,
}

/// visualization_msgs/msg/Marker
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Marker {
    /// When and where.
    pub header: Header,
    /// With `id`: which marker.
    pub ns: String,
    /// Which.
    pub id: i32,
    /// 0 arrow, 2 sphere, 9 text that faces the viewer, 11 triangles.
    pub kind: i32,
    /// 0 add, 2 delete, 3 delete all.
    pub action: i32,
    /// Where.
    pub pose: Pose,
    /// m
    pub scale: Point,
    /// Of all of it.
    pub color: Color,
    /// How long it stays; 0 for ever.
    pub lifetime: Duration,
    /// Whether it moves with its frame.
    pub frame_locked: bool,
    /// Of arrows and lists.
    pub points: Vec<Point>,
    /// Of each point.
    pub colors: Vec<Color>,
    /// Of meshes.
    pub texture_resource: String,
    /// Of meshes.
    pub texture: CompressedImage,
    /// Of meshes.
    pub uv_coordinates: Vec<UvCoordinate>,
    /// Of texts.
    pub text: String,
    /// Of meshes.
    pub mesh_resource: String,
    /// Of meshes.
    pub mesh_file: MeshFile,
    /// Of meshes.
    pub mesh_use_embedded_materials: bool,
}

/// visualization_msgs/msg/MarkerArray
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct MarkerArray {
    /// The markers.
    pub markers: Vec<Marker>,
}

/// diagnostic_msgs/msg/KeyValue
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct KeyValue {
    /// What.
    pub key: String,
    /// How much.
    pub value: String,
}

/// diagnostic_msgs/msg/DiagnosticStatus
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct DiagnosticStatus {
    /// 0 all is well, 1 a warning, 2 an error, 3 nothing comes.
    pub level: u8,
    /// Of what.
    pub name: String,
    /// In words.
    pub message: String,
    /// Which board.
    pub hardware_id: String,
    /// More.
    pub values: Vec<KeyValue>,
}

/// diagnostic_msgs/msg/DiagnosticArray
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct DiagnosticArray {
    /// When.
    pub header: Header,
    /// Each of something.
    pub status: Vec<DiagnosticStatus>,
}
