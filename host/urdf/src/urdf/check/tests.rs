use super::*;
use std::{fmt::Write, path::Path};

fn findings(text: &str) -> Vec<Finding> {
    check(text, &Places { folder: Path::new("."), packages: &[] }, &[]).unwrap().findings
}

const RIGHT: &str = "<limit effort='1' velocity='1'/>";

fn robot(shape: &str, joint: &str) -> String {
    format!(
        "<robot name='r'><link name='base'/><link name='arm'>{shape}<inertial/></link>\n<joint name='j' \
         type='revolute'><parent link='base'/><child link='arm'/>{joint}</joint></robot>"
    )
}

#[test]
fn what_urdfdom_refuses_is_an_error_and_what_only_looks_odd_is_a_warning() {
    use Level::{Error, Warning};
    let solid = |solid: &str| robot(&format!("<visual><geometry>{solid}</geometry></visual>"), RIGHT);
    let joint =
        |inner: &str| robot("", &format!("{inner}<limit lower='-1' upper='1' effort='1' velocity='1'/>"));
    for (text, level, line, expected) in [
        (robot("", RIGHT).replace(" name='r'", ""), Error, 1, "the robot has no `name`"),
        (robot("", RIGHT).replace("'r'", "''"), Warning, 1, "the `name` of the robot is empty"),
        (robot("<visual/>", RIGHT), Error, 1, "link \"arm\": a <visual> has no shape"),
        (robot("<collision><geometry/></collision>", RIGHT), Error, 1, "a <collision> has no shape"),
        (solid("<box/>"), Error, 1, "the <box> of a <visual> is not complete; allowed: size"),
        (solid("<box size='1 2'/>"), Error, 1, "is not complete"),
        (
            solid("<box size='0 1 1'/>"),
            Warning,
            1,
            "the <box> of a <visual> has the size 0 1 1; allowed: above 0",
        ),
        (solid("<sphere radius='-1'/>"), Warning, 1, "<sphere> of a <visual> has the size -1"),
        (solid("<sphere radius='a'/>"), Error, 1, "allowed: radius"),
        (solid("<cylinder radius='0' length='1'/>"), Warning, 1, "has the size 0 1"),
        (solid("<cylinder radius='1'/>"), Error, 1, "allowed: radius and length"),
        (solid("<mesh/>"), Error, 1, "allowed: filename"),
        (
            robot("", "<limit lower='1' upper='-1' effort='1' velocity='1'/>"),
            Warning,
            2,
            "has lower = 1 above upper = -1",
        ),
        (
            robot("", "<limit/>"),
            Warning,
            2,
            "the limit of joint \"j\" has no `effort` and `velocity`: urdfdom, and with it ROS, refuses",
        ),
        (robot("", "<limit effort='1'/>"), Warning, 2, "has no `velocity`: urdfdom"),
        (
            robot("", "<limit effort='1' velocity='1' upper='a'/>"),
            Error,
            2,
            "has upper = \"a\"; allowed: a number",
        ),
        (robot("", "<limit effort='' velocity='1'/>"), Error, 2, "has effort = \"\"; allowed: a number"),
        (joint("<axis xyz='0 0 0'/>"), Warning, 2, "the `axis` of joint \"j\" is 0 0 0"),
        (joint("<axis xyz='0 1'/>"), Error, 2, "joint \"j\": `xyz` of <axis> is \"0 1\""),
        (joint("<mimic joint='k'/>"), Warning, 2, "joint \"j\" mimics \"k\", which is no joint"),
        (joint("<mimic/>"), Error, 2, "the `mimic` of joint \"j\" names no joint"),
    ] {
        let found = findings(&text);
        assert!(
            matches!(&found[..], [it] if it.level == level && it.line == Some(line)),
            "{text}: {found:?}"
        );
        assert!(found[0].message.contains(expected), "{expected}: {found:?}");
    }
}

#[test]
fn what_is_right_finds_nothing() {
    for shape in
        ["<box size='1 1 1'/>", "<sphere radius='1'/>", "<cylinder radius='1' length='1'/>", "<capsule/>"]
    {
        let parts = format!("<visual><geometry>{shape}</geometry></visual>");
        let joint =
            "<axis xyz='0 0 1'/><limit lower='0' upper='0' effort='1' velocity='1'/><mimic joint='j'/>";
        assert_eq!(findings(&robot(&parts, joint)), []);
    }
    let fixed = robot("", "<axis xyz='0 0 0'/>").replace("revolute", "fixed");
    assert_eq!(findings(&fixed), []);
}

/// So many links, each held by the next in the file, so that the root is the last.
fn chain(links: usize, kind: &str) -> String {
    let mut text = "<robot name='chain'>\n".to_owned();
    for at in 0..links {
        let parent = at + 1;
        writeln!(text, "<link name='l{at}'/>").unwrap();
        if parent < links {
            writeln!(
                text,
                "<joint name='j{at}' type='{kind}'><parent link='l{parent}'/><child link='l{at}'/></joint>"
            )
            .unwrap();
        }
    }
    text + "</robot>"
}

#[test]
fn a_long_chain_is_checked_whatever_is_wrong_with_it() {
    const LINKS: usize = 20_000;
    let checked =
        check(&chain(LINKS, "fixed"), &Places { folder: Path::new("."), packages: &[] }, &[]).unwrap();
    assert_eq!((checked.links, checked.root, checked.findings), (LINKS, Some("l19999".to_owned()), vec![]));
    // Each joint has a finding, and each link that is held.
    let found = findings(&chain(LINKS, "hinge"));
    assert_eq!((found.len(), found[1].line), (2 * (LINKS - 1), Some(5)));
    let unheld = chain(LINKS, "fixed").replace("<parent link='l", "<parent link='none");
    assert_eq!(findings(&unheld).len(), LINKS - 1);
    let circle = chain(LINKS, "fixed").replace(
        "</robot>",
        "<joint name='c' type='fixed'><parent link='l0'/><child link='l19999'/></joint></robot>",
    );
    let found = findings(&circle);
    assert!(found.len() == 1 && found[0].message.starts_with("joints go in a circle at \"l0\""), "{found:?}");
}
