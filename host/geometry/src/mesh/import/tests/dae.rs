//! COLLADA files: what is read of them, and what is refused by which words.

use super::*;

/// A file with a triangle, `asset` and what its scene shows.
fn file(asset: &str, scene: &str) -> String {
    format!(
        r##"<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset>{asset}</asset>
<library_geometries><geometry id="g"><mesh>
<source id="s"><float_array id="a" count="9">0 0 0 1 0 0 0 2 0</float_array>
<technique_common><accessor source="#a" count="3" stride="3"/></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#s"/></vertices>
<triangles count="1"><input semantic="VERTEX" source="#v" offset="1"/><input semantic="NORMAL" source="#s" offset="0"/>
<p>7 0 7 1 7 2</p></triangles>
</mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="w">{scene}</visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#w"/></scene>
</COLLADA>"##
    )
}

const SHOWN: &str = "<node><instance_geometry url=\"#g\"/></node>";
const Z_UP: &str = "<unit meter=\"0.001\"/><up_axis>Z_UP</up_axis>";

fn nodes(asset: &str, scene: &str) -> Vec<[f64; 3]> {
    let mesh = text(Format::Dae, &file(asset, scene)).unwrap();
    mesh.nodes.iter().map(|node| node.coords.map(|at| (at * 1e9).round() / 1e9).into()).collect()
}

#[test]
fn a_triangle_is_read_with_the_unit_and_turned_so_that_z_is_up() {
    let mesh = text(Format::Dae, &file(Z_UP, SHOWN)).unwrap();
    assert_eq!((mesh.unit, mesh.triangles), (Some(0.001), vec![[0, 1, 2]]));
    assert_eq!(nodes(Z_UP, SHOWN), [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 2.0, 0.0]]);
    assert_eq!(nodes("<up_axis> Y_UP </up_axis>", SHOWN)[2], [0.0, 0.0, 2.0]);
    assert_eq!(nodes("", SHOWN)[2], [0.0, 0.0, 2.0]);
    assert_eq!(nodes("<up_axis>X_UP</up_axis>", SHOWN)[1..], [[0.0, 0.0, 1.0], [-2.0, 0.0, 0.0]]);
    assert_eq!(text(Format::Dae, &file("", SHOWN)).unwrap().unit, Some(1.0));
}

#[test]
fn nodes_move_turn_and_scale_what_is_in_them_and_each_instance_is_a_part_of_the_mesh() {
    let turned = "<node><translate>5 0 0</translate><rotate>0 0 1 90</rotate><node><scale>2 2 2</scale>\
                  <instance_geometry url=\"#g\"/></node></node>";
    assert_eq!(nodes(Z_UP, turned), [[5.0, 0.0, 0.0], [5.0, 2.0, 0.0], [1.0, 0.0, 0.0]]);
    let matrix =
        "<node><matrix>0 -1 0 5 1 0 0 0 0 0 1 7 0 0 0 1</matrix><instance_geometry url=\"#g\"/></node>";
    assert_eq!(nodes(Z_UP, matrix), [[5.0, 0.0, 7.0], [5.0, 1.0, 7.0], [3.0, 0.0, 7.0]]);
    let twice = format!(
        "<node id=\"n\">{SHOWN}</node><node><translate>0 0 9</translate><instance_node url=\"#n\"/></node>"
    );
    let mesh = text(Format::Dae, &file(Z_UP, &twice)).unwrap();
    assert_eq!((mesh.nodes.len(), mesh.triangles), (6, vec![[0, 1, 2], [3, 4, 5]]));
}

#[test]
fn a_mirrored_part_is_turned_so_that_its_outside_stays_outside() {
    let mirrored = "<node><scale>-1 1 1</scale><instance_geometry url=\"#g\"/></node>";
    let mesh = text(Format::Dae, &file(Z_UP, mirrored)).unwrap();
    let [a, b, c] = mesh.triangles[0].map(|node| mesh.nodes[node]);
    assert_eq!((b - a).cross(&(c - a)).z, 2.0);
}

#[test]
fn polygons_lists_of_them_and_strips_become_triangles() {
    let with = |primitive: &str, four: &str| {
        let file = file(Z_UP, SHOWN)
            .replace("count=\"9\">0 0 0 1 0 0 0 2 0", four)
            .replace("count=\"3\" str", "count=\"4\" str");
        let (before, rest) = file.split_once("<triangles").unwrap();
        let (_, after) = rest.split_once("</triangles>").unwrap();
        text(Format::Dae, &format!("{before}{primitive}{after}"))
    };
    let square = "count=\"12\">0 0 0 1 0 0 1 1 0 0 1 0";
    let input = "<input semantic=\"VERTEX\" source=\"#v\" offset=\"0\"/>";
    for (primitive, expected) in [
        (
            format!("<polylist count=\"1\">{input}<vcount>4</vcount><p>0 1 2 3</p></polylist>"),
            vec![[0, 1, 2], [0, 2, 3]],
        ),
        (format!("<polygons count=\"1\">{input}<p>0 1 2 3</p></polygons>"), vec![[0, 1, 2], [0, 2, 3]]),
        (format!("<trifans count=\"1\">{input}<p>0 1 2 3</p></trifans>"), vec![[0, 1, 2], [0, 2, 3]]),
        (format!("<tristrips count=\"1\">{input}<p>0 1 3 2</p></tristrips>"), vec![[0, 1, 3], [3, 1, 2]]),
    ] {
        assert_eq!(with(&primitive, square).unwrap().triangles, expected, "{primitive}");
    }
    let long = format!("<polylist count=\"1\">{input}<vcount>5</vcount><p>0 1 2 3</p></polylist>");
    assert!(with(&long, square).unwrap_err().to_string().contains("holds at most 4"));
}

#[test]
fn what_is_wrong_is_said_with_its_line_and_what_is_allowed() {
    let sound = file(Z_UP, SHOWN);
    for (from, to, expected) in [
        ("0.001", "0", "`meter` of <unit> is `0`, allowed is 1e-9 to 1e9"),
        ("Z_UP", "UP", "line 3: <up_axis> is `UP`, allowed is X_UP, Y_UP or Z_UP"),
        ("7 0 7 1 7 2", "7 0 7 1 7 3", "line 9: a vertex of <p> is `3`, allowed is 0 to 2"),
        ("7 0 7 1 7 2", "7 0 7 1 7", "the numbers of <p> is `5 of them`, allowed is 2 for each corner"),
        ("7 0 7 1 7 2", "7 0 7 1", "the corners of <triangles> is `2`, allowed is three for each"),
        ("0 2 0<", "0 nan 0<", "line 5: a number of <float_array> is `nan`, allowed is a finite number"),
        ("0 2 0<", "0 2<", "line 6: <accessor> is `3 vertices of 3 numbers from 0 on`, allowed is 3 or more"),
        ("count=\"3\"", "count=\"18446744073709551615\"", "<accessor> is"),
        ("url=\"#g\"", "url=\"#v\"", "url is `#v`, allowed is # and the id of a <geometry> in this file"),
        ("url=\"#g\"", "url=\"other.dae#g\"", "url is `other.dae#g`, allowed"),
        ("url=\"#w\"", "url=\"#\"", "url is `#`, allowed is # and the id of a <visual_scene>"),
        (
            "<node>",
            "<node><skew>1</skew>",
            "a node's transform is `skew`, allowed is matrix, translate, rotate or scale",
        ),
        ("<node>", "<node><matrix>1 2</matrix>", "<matrix> is `2 numbers`, allowed is 16"),
        ("<node>", "<node><instance_controller url=\"#g\"/>", "a mesh without skeleton"),
        ("POSITION", "COLOR", "<vertices> is `no positions`, allowed is an input POSITION"),
        ("</COLLADA>", "", "no XML that can be read"),
        ("<?xml version=\"1.0\"?>", "<!DOCTYPE a [<!ENTITY b \"c\">]>", "no XML that can be read"),
        ("<instance_geometry url=\"#g\"/>", "", "it holds no triangles"),
    ] {
        assert!(sound.contains(from), "{from}");
        let message = refusal(Format::Dae, sound.replacen(from, to, 1));
        assert!(message.contains(expected), "{to}: {message}");
    }
    assert!(refusal(Format::Dae, "").contains("no XML"));
    assert!(refusal(Format::Dae, b"<a>\xff").contains("byte 3: no UTF-8"));
    assert!(refusal(Format::Dae, "<html/>").contains("the outermost element is `html`, allowed is COLLADA"));
}

#[test]
fn a_scene_that_shows_itself_or_grows_without_end_is_refused() {
    let circle = "<node id=\"n\"><instance_node url=\"#n\"/></node>";
    assert!(
        refusal(Format::Dae, file(Z_UP, circle))
            .contains("the depth of nodes in nodes is `65`, allowed is at most 64")
    );
    let doubled = |level: u32| {
        format!(
            "<node id=\"n{level}\"><instance_node url=\"#n{0}\"/><instance_node url=\"#n{0}\"/></node>",
            level + 1
        )
    };
    let bomb: String = (0..40).map(doubled).collect::<String>() + "<node id=\"n40\"/>";
    assert!(refusal(Format::Dae, file(Z_UP, &bomb)).contains("nodes in all"));
}
