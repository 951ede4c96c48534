//! Schemas: the types of all messages, as ROS 2 writes them (`ros2msg`): a definition, then those of all types in it.

/// A message type.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Schema {
    /// `package/msg/Name`.
    pub name: &'static str,
    text: &'static str,
    /// Types of its fields, and of theirs.
    needs: &'static [&'static Schema],
}

/// Between two definitions.
const RULE: &str = "================================================================================";

impl Schema {
    const fn plain(name: &'static str, text: &'static str) -> Self {
        Self { name, text, needs: &[] }
    }

    const fn of(name: &'static str, text: &'static str, needs: &'static [&'static Self]) -> Self {
        Self { name, text, needs }
    }
}

/// The definition of a type, with all that it needs.
#[must_use]
pub fn definition(schema: &Schema) -> String {
    let part = |needed: &&Schema| {
        let short = needed.name.replace("/msg/", "/");
        format!("{RULE}\nMSG: {short}\n{}\n", needed.text.trim_end())
    };
    let parts: String = schema.needs.iter().map(part).collect();
    format!("{}\n{parts}", schema.text.trim_end())
}

const TIME: Schema = Schema::plain("builtin_interfaces/msg/Time", "int32 sec\nuint32 nanosec");
const DURATION: Schema = Schema::plain("builtin_interfaces/msg/Duration", "int32 sec\nuint32 nanosec");
const HEADER: Schema = Schema::plain("std_msgs/msg/Header", "builtin_interfaces/Time stamp\nstring frame_id");
const COLOR: Schema = Schema::plain("std_msgs/msg/ColorRGBA", "float32 r\nfloat32 g\nfloat32 b\nfloat32 a");
const POINT: Schema = Schema::plain("geometry_msgs/msg/Point", "float64 x\nfloat64 y\nfloat64 z");
const VECTOR: Schema = Schema::plain("geometry_msgs/msg/Vector3", "float64 x\nfloat64 y\nfloat64 z");
const QUATERNION: Schema =
    Schema::plain("geometry_msgs/msg/Quaternion", "float64 x 0\nfloat64 y 0\nfloat64 z 0\nfloat64 w 1");
const POSE: Schema = Schema::plain(
    "geometry_msgs/msg/Pose",
    "geometry_msgs/Point position\ngeometry_msgs/Quaternion orientation",
);
const TRANSFORM: Schema = Schema::plain(
    "geometry_msgs/msg/Transform",
    "geometry_msgs/Vector3 translation\ngeometry_msgs/Quaternion rotation",
);
const TRANSFORM_STAMPED: Schema = Schema::plain(
    "geometry_msgs/msg/TransformStamped",
    "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/Transform transform",
);
const POINT_FIELD: Schema = Schema::plain(
    "sensor_msgs/msg/PointField",
    "uint8 INT8=1\nuint8 UINT8=2\nuint8 INT16=3\nuint8 UINT16=4\nuint8 INT32=5\nuint8 UINT32=6\nuint8 FLOAT32=7\n\
     uint8 FLOAT64=8\nstring name\nuint32 offset\nuint8 datatype\nuint32 count",
);
const COMPRESSED_IMAGE: Schema =
    Schema::plain("sensor_msgs/msg/CompressedImage", "std_msgs/Header header\nstring format\nuint8[] data");
const UV: Schema = Schema::plain("visualization_msgs/msg/UVCoordinate", "float32 u\nfloat32 v");
const MESH_FILE: Schema = Schema::plain("visualization_msgs/msg/MeshFile", "string filename\nuint8[] data");
const MARKER: Schema = Schema::plain(
    "visualization_msgs/msg/Marker",
    "int32 ARROW=0\nint32 CUBE=1\nint32 SPHERE=2\nint32 CYLINDER=3\nint32 LINE_STRIP=4\nint32 LINE_LIST=5\n\
     int32 CUBE_LIST=6\nint32 SPHERE_LIST=7\nint32 POINTS=8\nint32 TEXT_VIEW_FACING=9\nint32 MESH_RESOURCE=10\n\
     int32 TRIANGLE_LIST=11\nint32 ARROW_STRIP=12\nint32 ADD=0\nint32 MODIFY=0\nint32 DELETE=2\n\
     int32 DELETEALL=3\n\
     std_msgs/Header header\nstring ns\nint32 id\nint32 type\nint32 action\ngeometry_msgs/Pose pose\n\
     geometry_msgs/Vector3 scale\nstd_msgs/ColorRGBA color\nbuiltin_interfaces/Duration lifetime\n\
     bool frame_locked\ngeometry_msgs/Point[] points\nstd_msgs/ColorRGBA[] colors\nstring texture_resource\n\
     sensor_msgs/CompressedImage texture\nvisualization_msgs/UVCoordinate[] uv_coordinates\nstring text\n\
     string mesh_resource\nvisualization_msgs/MeshFile mesh_file\nbool mesh_use_embedded_materials",
);
const KEY_VALUE: Schema = Schema::plain("diagnostic_msgs/msg/KeyValue", "string key\nstring value");
const DIAGNOSTIC_STATUS: Schema = Schema::plain(
    "diagnostic_msgs/msg/DiagnosticStatus",
    "byte OK=0\nbyte WARN=1\nbyte ERROR=2\nbyte STALE=3\nbyte level\nstring name\nstring message\n\
     string hardware_id\ndiagnostic_msgs/KeyValue[] values",
);
const WRENCH: Schema =
    Schema::plain("geometry_msgs/msg/Wrench", "geometry_msgs/Vector3 force\ngeometry_msgs/Vector3 torque");
const SKIN_CONTACT: Schema =
    Schema::plain("dermatome_msgs/msg/SkinContact", include_str!("../dermatome_msgs/msg/SkinContact.msg"));
const CONTACT: Schema =
    Schema::plain("dermatome_msgs/msg/Contact", include_str!("../dermatome_msgs/msg/Contact.msg"));

/// tf2_msgs/msg/TFMessage
pub const TF_MESSAGE: Schema = Schema::of(
    "tf2_msgs/msg/TFMessage",
    "geometry_msgs/TransformStamped[] transforms",
    &[&TRANSFORM_STAMPED, &HEADER, &TIME, &TRANSFORM, &VECTOR, &QUATERNION],
);
/// sensor_msgs/msg/PointCloud2
pub const POINT_CLOUD: Schema = Schema::of(
    "sensor_msgs/msg/PointCloud2",
    "std_msgs/Header header\nuint32 height\nuint32 width\nsensor_msgs/PointField[] fields\nbool is_bigendian\n\
     uint32 point_step\nuint32 row_step\nuint8[] data\nbool is_dense",
    &[&HEADER, &TIME, &POINT_FIELD],
);
/// visualization_msgs/msg/MarkerArray
pub const MARKER_ARRAY: Schema = Schema::of(
    "visualization_msgs/msg/MarkerArray",
    "visualization_msgs/Marker[] markers",
    &[
        &MARKER,
        &HEADER,
        &TIME,
        &POSE,
        &POINT,
        &QUATERNION,
        &VECTOR,
        &COLOR,
        &DURATION,
        &COMPRESSED_IMAGE,
        &UV,
        &MESH_FILE,
    ],
);
/// diagnostic_msgs/msg/DiagnosticArray
pub const DIAGNOSTIC_ARRAY: Schema = Schema::of(
    "diagnostic_msgs/msg/DiagnosticArray",
    "std_msgs/Header header\ndiagnostic_msgs/DiagnosticStatus[] status",
    &[&HEADER, &TIME, &DIAGNOSTIC_STATUS, &KEY_VALUE],
);
/// dermatome_msgs/msg/Skin
pub const SKIN: Schema =
    Schema::of("dermatome_msgs/msg/Skin", include_str!("../dermatome_msgs/msg/Skin.msg"), &[&HEADER, &TIME]);
/// dermatome_msgs/msg/Status
pub const STATUS: Schema = Schema::of(
    "dermatome_msgs/msg/Status",
    include_str!("../dermatome_msgs/msg/Status.msg"),
    &[&HEADER, &TIME],
);
/// dermatome_msgs/msg/Reference
pub const REFERENCE: Schema = Schema::of(
    "dermatome_msgs/msg/Reference",
    include_str!("../dermatome_msgs/msg/Reference.msg"),
    &[&HEADER, &TIME],
);
/// dermatome_msgs/msg/Measurements
pub const MEASUREMENTS: Schema = Schema::of(
    "dermatome_msgs/msg/Measurements",
    include_str!("../dermatome_msgs/msg/Measurements.msg"),
    &[&HEADER, &TIME],
);
/// dermatome_msgs/msg/Health
pub const HEALTH: Schema = Schema::of(
    "dermatome_msgs/msg/Health",
    include_str!("../dermatome_msgs/msg/Health.msg"),
    &[&HEADER, &TIME],
);
/// dermatome_msgs/msg/Image
pub const IMAGE: Schema = Schema::of(
    "dermatome_msgs/msg/Image",
    include_str!("../dermatome_msgs/msg/Image.msg"),
    &[&HEADER, &TIME],
);
/// dermatome_msgs/msg/ContactArray
pub const CONTACT_ARRAY: Schema = Schema::of(
    "dermatome_msgs/msg/ContactArray",
    include_str!("../dermatome_msgs/msg/ContactArray.msg"),
    &[&HEADER, &TIME, &CONTACT, &POINT, &VECTOR],
);
/// dermatome_msgs/msg/SkinContactArray
pub const SKIN_CONTACT_ARRAY: Schema = Schema::of(
    "dermatome_msgs/msg/SkinContactArray",
    include_str!("../dermatome_msgs/msg/SkinContactArray.msg"),
    &[&HEADER, &TIME, &SKIN_CONTACT, &CONTACT, &POINT, &VECTOR, &WRENCH],
);
/// geometry_msgs/msg/WrenchStamped
pub const WRENCH_STAMPED: Schema = Schema::of(
    "geometry_msgs/msg/WrenchStamped",
    "std_msgs/Header header\ngeometry_msgs/Wrench wrench",
    &[&HEADER, &TIME, &WRENCH, &VECTOR],
);
/// dermatome_msgs/msg/Scope
pub const SCOPE: Schema = Schema::of(
    "dermatome_msgs/msg/Scope",
    include_str!("../dermatome_msgs/msg/Scope.msg"),
    &[&HEADER, &TIME],
);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Topic;

    #[test]
    fn every_type_that_a_definition_names_is_in_it() {
        let others = [&SKIN_CONTACT_ARRAY, &WRENCH_STAMPED];
        for schema in Topic::ALL.iter().map(|topic| topic.schema()).chain(others) {
            let text = definition(schema);
            let fields = text.lines().filter(|line| !line.starts_with('#') && !line.starts_with("MSG: "));
            for line in fields {
                let kind = line.split_whitespace().next().unwrap_or_default().trim_end_matches("[]");
                assert!(
                    !kind.contains('/') || text.contains(&format!("MSG: {kind}\n")),
                    "{}: {line}",
                    schema.name
                );
            }
        }
    }
}
