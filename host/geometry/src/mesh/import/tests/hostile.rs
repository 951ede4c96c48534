//! Files that must be refused, and by which words.

use super::*;

const VERTICES: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";

#[test]
fn empty_files_are_refused() {
    let message = |format| refusal(format, "");
    assert_eq!(message(Format::Stl), "byte 0: the file ends where the header of 80 bytes should be");
    assert_eq!(message(Format::Obj), "it holds no triangles");
    assert_eq!(message(Format::Ply), "line 1: the file ends where ply should be");
    assert_eq!(message(Format::Msh), "line 1: the file ends where $MeshFormat should be");
}

#[test]
fn obj_says_line_field_value_and_what_is_allowed() {
    let cases = [
        ("v 0 0 nan\n", "line 4: z of a vertex is `NaN`, allowed is a finite number of at most 1e30"),
        ("v 0 1e31 0\n", "allowed is a finite number of at most 1e30"),
        ("v 0 -inf 0\n", "line 4: y of a vertex is `-inf`, allowed"),
        ("v 1,5 0 0\n", "line 4: x of a vertex is `1,5`, allowed is a number"),
        ("v 0 0\n", "line 4: z of a vertex is ``, allowed is a number"),
        ("f 1 2 4\n", "line 4: the vertex of a face's corner is `4`, allowed is 1 to 3 or -1 to -3"),
        ("f 1 2 -4\n", "is `-4`, allowed"),
        ("f 0 1 2\n", "is `0`, allowed"),
        ("f 1 2 /3\n", "is `/3`, allowed"),
        ("f 1 2 9223372036854775808\n", "is `9223372036854775808`, allowed"),
        ("f 1 2 -9223372036854775808\n", "is `-9223372036854775808`, allowed"),
        ("f 1 2\n", "line 4: the number of a face's corners is `2`, allowed is 3 or more"),
    ];
    for (line, expected) in cases {
        let message = refusal(Format::Obj, format!("{VERTICES}{line}"));
        assert!(message.contains(expected), "{line}: {message}");
    }
}

#[test]
fn a_continued_obj_line_is_named_by_where_it_begins() {
    let message = refusal(Format::Obj, format!("{VERTICES}f 1 \\\n 2 \\\n 7\n"));
    assert!(message.starts_with("line 4: the vertex of a face's corner is `7`"), "{message}");
}

fn binary_stl(count: u32, triangles: usize) -> Vec<u8> {
    let mut bytes = vec![0; 80];
    bytes.extend(count.to_le_bytes());
    bytes.resize(84 + 50 * triangles, 0);
    bytes
}

#[test]
fn binary_stl_whose_count_is_not_what_the_file_holds_is_refused() {
    let message = refusal(Format::Stl, binary_stl(u32::MAX, 1));
    assert_eq!(
        message,
        "byte 80: the number of triangles is 4294967295, but the rest of the file holds at most 1"
    );
    let message = refusal(Format::Stl, binary_stl(1, 2));
    assert_eq!(message, "byte 80: the number of triangles is `1`, allowed is 2, which the file holds");
    assert_eq!(refusal(Format::Stl, binary_stl(0, 0)), "it holds no triangles");
}

#[test]
fn binary_stl_with_a_vertex_that_is_not_a_number_is_refused() {
    let mut bytes = binary_stl(2, 2);
    bytes[84 + 50 + 12 + 8..][..4].copy_from_slice(&f32::NAN.to_le_bytes());
    let message = refusal(Format::Stl, bytes);
    assert_eq!(message, "byte 154: z of a vertex is `NaN`, allowed is a finite number of at most 1e30");
}

#[test]
fn text_stl_names_the_line_and_the_keyword_that_is_missing() {
    let facet = "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n";
    let cases = [
        (format!("solid\n{facet}vertex 1 1 0\n"), "line 7: a keyword is `vertex`, allowed is `endloop`"),
        (format!("solid\n{facet}endloop\nendfacet\n"), "line 9: the file ends where `endsolid` should be"),
        (format!("solid\n{facet}"), "line 7: the file ends where endloop should be"),
        (
            "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 zero\n".into(),
            "line 4: z of a vertex is `zero`",
        ),
        ("solid\nvolume".into(), "line 2: a keyword is `volume`, allowed is `facet` or `endsolid`"),
        ("solid nothing\nendsolid nothing\n".into(), "it holds no triangles"),
    ];
    for (content, expected) in cases {
        let message = refusal(Format::Stl, &content);
        assert!(message.starts_with(expected), "{content}: {message}");
    }
}

fn ply(format: &str, vertices: &str, face: &str, body: &str) -> String {
    format!(
        "ply\nformat {format} 1.0\nelement vertex {vertices}\nproperty float x\nproperty float y\n\
         property float z\nelement face 1\n{face}\nend_header\n{body}"
    )
}

const LIST: &str = "property list uchar int vertex_indices";
const POINTS: &str = "0 0 0\n1 0 0\n0 1 0\n";

#[test]
fn ply_headers_are_refused_by_what_is_wrong_with_them() {
    let cases = [
        ("PLY2".into(), "line 1: a keyword is `PLY2`, allowed is `ply`"),
        ("ply\nformat binary 1.0".into(), "line 2: the format is `binary`, allowed is `ascii`, "),
        ("ply\nformat ascii 2.0".into(), "line 2: a keyword is `2.0`, allowed is `1.0`"),
        ("ply\nproperty float x".into(), "line 2: a keyword is `property`, allowed is `element`"),
        (
            "ply\nelement vertex -1".into(),
            "line 2: the number of elements is `-1`, allowed is a whole number from 0",
        ),
        ("ply\nformat ascii 1.0\n".into(), "line 3: the file ends where `end_header` should be"),
        ("ply\nend_header\n".into(), "it holds no line `format`"),
        ("ply\nformat ascii 1.0\nend_header\n".into(), "it holds no element `vertex`"),
        (
            ply("ascii", "3\nproperty long w", LIST, ""),
            "line 4: a property's type is `long`, allowed is char",
        ),
        (
            ply("ascii", "3", "property list float int vertex_indices", POINTS),
            "line 8: the type of a list's length",
        ),
        (
            ply("ascii", "3", "property list uchar float vertex_indices", POINTS),
            "it holds no list `vertex_indices`",
        ),
        (ply("ascii", "3", "", POINTS), "it holds no properties of element `face`"),
        (
            ply("ascii", "3", LIST, POINTS).replace("float y", "list uchar float y"),
            "it holds no property `y` of",
        ),
    ];
    for (content, expected) in cases {
        let message = refusal(Format::Ply, &content);
        assert!(message.starts_with(expected), "{content}: {message}");
    }
}

#[test]
fn ply_values_are_refused_by_line_field_and_value() {
    let body = |face: &str| ply("ascii", "3", LIST, &format!("{POINTS}{face}\n"));
    let cases = [
        (
            body("3 0 1 3"),
            "line 13: the vertex of a face's corner is `3`, allowed is a number from 0 and below 3",
        ),
        (body("3 0 1 -1"), "line 13: the vertex of a face's corner is `-1`"),
        (body("3 0 1"), "line 14: the file ends where the vertex of a face's corner should be"),
        (body("2 0 1"), "line 13: the number of a face's corners is `2`, allowed is 3 or more"),
        (
            body("200 0 1 2"),
            "line 13: the number of a face's corners is 200, but the rest of the file holds at most 4",
        ),
        (body("3 0 1 x"), "line 13: the vertex of a face's corner is `x`, allowed is a whole number"),
        (
            ply("ascii", "3", LIST, "0 0 inf\n1 0 0\n0 1 0\n3 0 1 2"),
            "line 10: a vertex's coordinate is `inf`",
        ),
    ];
    for (content, expected) in cases {
        let message = refusal(Format::Ply, &content);
        assert!(message.starts_with(expected), "{content}: {message}");
    }
}

#[test]
fn ply_counts_that_no_file_holds_are_refused_before_memory_is_taken() {
    let huge = "9223372036854775807";
    let message = refusal(Format::Ply, ply("binary_little_endian", huge, LIST, "0123456789012"));
    assert!(message.contains("the number of elements is 9223372036854775807, but the rest"), "{message}");
    let empty = format!(
        "ply\nformat ascii 1.0\nelement nothing {huge}\nelement vertex 1\nelement face 1\nend_header\n"
    );
    assert_eq!(refusal(Format::Ply, empty), "it holds no properties of element `nothing`");
}

#[test]
fn truncated_binary_ply_is_refused_at_the_byte_where_it_ends() {
    let mut content = ply("binary_big_endian", "3", LIST, "").into_bytes();
    content.resize(content.len() + 36, 0);
    let end = content.len() + 9;
    content.extend([3, 0, 0, 0, 0, 0, 0, 0, 1]);
    // The list claims three corners of 4 bytes; 8 bytes are there.
    let message = refusal(Format::Ply, &content);
    assert_eq!(
        message,
        format!(
            "byte {}: the number of a face's corners is 3, but the rest of the file holds at most 2",
            end - 9
        )
    );
}

fn msh4(nodes: &str, elements: &str) -> String {
    format!(
        "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Nodes\n{nodes}\n$EndNodes\n$Elements\n{elements}\n$EndElements\n"
    )
}

const THREE: &str = "1 3 1 3\n2 1 0 3\n1\n2\n3\n0 0 0\n1 0 0\n0 1 0";

#[test]
fn msh_elements_that_are_no_first_order_triangles_are_named() {
    let cases = [
        (3, "3, quadrangle"),
        (4, "4, tetrahedron"),
        (5, "5, hexahedron"),
        (8, "8, line of second order"),
        (9, "9, triangle of second order"),
        (11, "11, tetrahedron of second order"),
        (21, "21, triangle of higher order"),
        (77, "77, unknown"),
    ];
    for (number, name) in cases {
        let expected = format!(
            "the type of an element is `{name}`, allowed is 15, point; 1, line of 2 nodes; 2, triangle"
        );
        let v4 = refusal(Format::Msh, msh4(THREE, &format!("1 1 1 1\n2 1 {number} 1\n1 1 2 3 1")));
        assert!(v4.starts_with(&format!("line 16: {expected}")), "{v4}");
        let v2 = format!(
            "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Elements\n1\n1 {number} 0 1 2 3 4\n$EndElements\n"
        );
        assert!(refusal(Format::Msh, v2).starts_with(&format!("line 6: {expected}")));
    }
}

#[test]
fn msh_4_1_is_refused_by_line_field_and_value() {
    let good = "1 1 1 1\n2 1 2 1\n1 1 2 3";
    assert!(text(Format::Msh, &msh4(THREE, good)).is_ok());
    let cases = [
        (
            msh4(THREE, "1 1 1 1\n2 1 2 1\n1 1 2 4"),
            "line 17: the node of an element is `4`, allowed is the number of",
        ),
        (
            msh4(THREE, "1 2 1 1\n2 1 2 1\n1 1 2 3"),
            "line 17: the number of elements in all blocks is `1`, allowed is 2",
        ),
        (
            msh4("1 4 1 3\n2 1 0 3\n1\n2\n3\n0 0 0\n1 0 0\n0 1 0", good),
            "line 12: the number of nodes in all blocks is `3`",
        ),
        (
            msh4("1 3 1 3\n2 1 0 3\n1\n2\n2\n0 0 0\n1 0 0\n0 1 0", good),
            "line 12: the number of a node is `2`, allowed is a number",
        ),
        (msh4("1 3 1 3\n5 1 0 3\n", good), "line 6: the dimension of an entity is `5`, allowed is 0 to 3"),
        (msh4("1 9999999 1 3\n", good), "line 5: the number of nodes or elements is 9999999, but the rest"),
        (msh4("1 3 1 3\n2 1 0 999\n", good), "line 6: the number of nodes in a block is 999, but the rest"),
        (msh4("1 3 1 3\n2 1 0 3\n1\n2\n3\n0 0 0\n1 0 0\n0 1 nan", good), "line 12: z of a vertex is `NaN`"),
        (msh4(THREE, &format!("{good}\n7")), "line 18: the end of a section is `7`, allowed is $EndElements"),
        (
            msh4(THREE, good).replace("$EndElements\n", ""),
            "line 18: the file ends where the end of a section should be",
        ),
        (msh4(THREE, good).replace("4.1", "4"), "line 2: the version is `4`, allowed is 2.2 or 4.1"),
        (
            msh4(THREE, good).replace("0 8", "2 8"),
            "line 2: the file type is `2`, allowed is 0 (text) or 1 (binary)",
        ),
        (
            msh4(THREE, good).replace("0 8", "0 4"),
            "line 2: the length of a number is `4`, allowed is 8 bytes",
        ),
        (
            format!("{}$PartitionedEntities\n", msh4(THREE, good)),
            "line 19: a section is `PartitionedEntities`",
        ),
        (format!("{}$NodeData\n1\n", msh4(THREE, good)), "line 21: the file ends where the end of a section"),
        (format!("{}rest", msh4(THREE, good)), "line 19: a section is `rest`, allowed is `$` and its name"),
        (msh4(THREE, "0 0 0 0"), "it holds no triangles"),
        ("$MeshFormat\n4.1 0 8\n$EndMeshFormat\n".into(), "it holds no triangles"),
    ];
    for (content, expected) in cases {
        let message = refusal(Format::Msh, &content);
        assert!(message.starts_with(expected), "{content}\n-> {message}\nbut: {expected}");
    }
}

#[test]
fn msh_physical_names_and_entities_are_refused_by_line_field_and_value() {
    let head = "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n";
    let many = "1 ".repeat(65);
    let cases = [
        (
            format!("{head}$PhysicalNames\n1\n0 1 electrode_1\n"),
            "line 6: the name of a physical group is `electrode_1`, allowed is text",
        ),
        (
            format!("{head}$PhysicalNames\n500\n0 1 \"a\"\n"),
            "line 5: the number of physical names is 500, but",
        ),
        (
            format!("{head}$Entities\n1 0 0 0\n1 0 0 0 65 {many}\n"),
            "line 6: the number of an entity's physical groups is `65`, allowed is 0 to 64",
        ),
        (
            format!("{head}$Entities\n1 0 0 0\n1 0 0 0 900 1\n"),
            "line 6: the number of an entity's physical groups is 900, but the rest",
        ),
    ];
    for (content, expected) in cases {
        let message = refusal(Format::Msh, &content);
        let start = message.replace(" of a number", "");
        assert!(start.starts_with(expected), "{content}\n-> {message}");
    }
}

#[test]
fn binary_msh_is_refused_by_byte() {
    let head = b"$MeshFormat\n4.1 1 8\n";
    let order = [&head[..], &[0, 1, 0, 0], b"\n$EndMeshFormat\n"].concat();
    assert_eq!(
        refusal(Format::Msh, order),
        "line 3: the integer 1 is `[0, 1, 0, 0]`, allowed is 1 in either byte order"
    );
    let counts = [u64::MAX.to_le_bytes(), [0; 8], [0; 8], [0; 8]].concat();
    let nodes = [&head[..], &[1, 0, 0, 0], b"\n$EndMeshFormat\n$Nodes\n", &counts].concat();
    assert_eq!(
        refusal(Format::Msh, nodes),
        "byte 47: the number of blocks is `-1`, allowed is a whole number from 0"
    );
}

#[test]
fn a_long_wrong_word_is_cut_and_its_control_characters_are_not_repeated() {
    let message = refusal(Format::Obj, format!("v \u{1b}[31m{} 0 0\n", "x".repeat(500)));
    assert!(
        message.contains("`\u{fffd}[31mxxx") && message.contains("xxx...`") && message.len() < 120,
        "{message}"
    );
}
