//! Names: what a robot's, a skin's or a link's is called in topics.

/// A name as part of a topic of ROS 2: letters, digits and single underscores, no digit first.
#[must_use]
pub fn part(name: &str) -> String {
    let mut part = String::new();
    for c in name.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }) {
        if c.is_ascii_digit() && part.is_empty() {
            part.push('_');
        }
        if !(c == '_' && part.ends_with('_')) {
            part.push(c);
        }
    }
    part
}

/// The frame of a skin on a robot, whose parent is its link's.
#[must_use]
pub fn skin_frame(robot: &str, skin: &str) -> String {
    format!("{robot}/{skin}")
}

/// Two of these names that are one in topics, if there are such.
#[must_use]
pub fn same<'a>(names: &[&'a str]) -> Option<[&'a str; 2]> {
    let later = |at: usize, name: &str| {
        names[at + 1..].iter().find(|&&other| other != name && part(other) == part(name))
    };
    names.iter().enumerate().find_map(|(at, name)| Some([*name, *later(at, name)?]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_ros_does_not_take_becomes_one_underscore() {
        let cases = [
            ("palm", "palm"),
            ("arm/palm.left", "arm_palm_left"),
            ("a__b", "a_b"),
            ("7th", "_7th"),
            ("_1", "_1"),
        ];
        for (name, expected) in cases {
            assert_eq!(part(name), expected);
        }
    }

    #[test]
    fn names_that_would_share_a_topic_are_found() {
        assert_eq!(same(&["a.b", "c", "a-b"]), Some(["a.b", "a-b"]));
        assert_eq!(same(&["a", "b", "a"]), None);
    }
}
