//! Edits: elements that are put into the text of a file of XML, or taken out; the rest of it stays byte for byte.

use crate::DescriptionError;
use roxmltree::{Document, Node};
use std::{borrow::Cow, ops::Range};

/// What an inner line is indented by where a file does not show it.
const STEP: &str = "  ";

/// The text as XML that can be read: prefixes that nothing declares (`<sensor:camera>`, which robots of Gazebo's first years
/// have, and ROS' readers do not mind) are part of the name instead. All else is where it was.
pub(crate) fn readable(text: &str) -> Cow<'_, str> {
    let mut readable = Cow::Borrowed(text);
    while let Err(roxmltree::Error::UnknownNamespace(prefix, _)) = Document::parse(&readable) {
        let places = ["<", "</", " ", "\t", "\n"]
            .map(|before| [":", "_"].map(|after| format!("{before}{prefix}{after}")));
        let plain = places.iter().fold(readable.to_string(), |text, [from, to]| text.replace(from, to));
        if plain == readable {
            break;
        }
        readable = Cow::Owned(plain);
    }
    readable
}

/// Reads XML.
pub(crate) fn parse(text: &str) -> Result<Document<'_>, DescriptionError> {
    Document::parse(text).map_err(|error| DescriptionError::Syntax { reason: error.to_string() })
}

/// The line of a node, from 1.
pub(crate) fn line(node: Node<'_, '_>) -> u32 {
    node.document().text_pos_at(node.range().start).row
}

/// Whether a node is an element of this name, in whatever namespace.
pub(crate) fn is(node: Node<'_, '_>, name: &str) -> bool {
    node.is_element() && node.tag_name().name() == name
}

/// Elements of a name inside another.
pub(crate) fn children<'a, 'input: 'a>(
    node: Node<'a, 'input>,
    name: &'a str,
) -> impl Iterator<Item = Node<'a, 'input>> + 'a {
    node.children().filter(move |child| is(*child, name))
}

/// A text as the value of an attribute.
pub(crate) fn escaped(text: &str) -> String {
    let escape = |c: char| match c {
        '&' => "&amp;".to_owned(),
        '<' => "&lt;".to_owned(),
        '>' => "&gt;".to_owned(),
        '"' => "&quot;".to_owned(),
        // Other white space would be read as a space.
        '\t' | '\n' | '\r' => format!("&#{};", u32::from(c)),
        _ => c.to_string(),
    };
    text.chars().map(escape).collect()
}

/// Changes of a text that are yet to be made.
#[derive(Debug)]
pub(crate) struct Edits<'a> {
    text: &'a str,
    changes: Vec<(Range<usize>, String)>,
}

impl<'a> Edits<'a> {
    pub(crate) fn new(text: &'a str) -> Self {
        Self { text, changes: Vec::new() }
    }

    /// Takes an element out, with the line that it began if nothing else was on it.
    pub(crate) fn remove(&mut self, node: Node<'_, '_>) {
        let Range { start, end } = node.range();
        let before = &self.text[..start];
        let blank = before.len() - before.trim_end_matches([' ', '\t']).len();
        let line = &before[..start - blank];
        let new_line = if line.ends_with("\r\n") { 2 } else { usize::from(line.ends_with('\n')) };
        let from = if new_line > 0 { start - blank - new_line } else { start };
        self.changes.push((from..end, String::new()));
    }

    /// Puts lines at the end of an element, each indented as what is in it; they hold their own further indentation.
    pub(crate) fn append(&mut self, node: Node<'_, '_>, lines: &[String]) {
        let new_line = if self.text.contains("\r\n") { "\r\n" } else { "\n" };
        let outer = self.indentation(node);
        let inner = node.children().filter(Node::is_element).map(|child| self.indentation(child)).next_back();
        let inner = match inner {
            Some(inner) if inner.len() > outer.len() => inner,
            _ => format!("{outer}{STEP}"),
        };
        let block: String = lines.iter().map(|line| format!("{inner}{line}{new_line}")).collect();
        let range = node.range();
        let own = &self.text[range.clone()];
        if let Some(open) = own.strip_suffix("/>") {
            let name = &own[1..own.find([' ', '\t', '\r', '\n', '/']).unwrap_or(own.len() - 2)];
            let from = range.start + open.trim_end().len();
            self.changes.push((from..range.end, format!(">{new_line}{block}{outer}</{name}>")));
            return;
        }
        // The end tag is the last of an element.
        let end = range.start + own.rfind("</").unwrap_or(own.len());
        let before = &self.text[..end];
        let line = before.trim_end_matches([' ', '\t']);
        if line.ends_with('\n') {
            self.changes.push((line.len()..line.len(), block));
        } else {
            self.changes.push((end..end, format!("{new_line}{block}{outer}")));
        }
    }

    /// The text with all changes made.
    pub(crate) fn made(mut self) -> String {
        self.changes.sort_by_key(|(range, _)| (range.start, range.end));
        let mut made = String::new();
        let mut at = 0;
        for (range, put) in self.changes {
            // What lies in something else that was taken out is gone with it.
            if range.start >= at {
                made += &self.text[at..range.start];
                made += &put;
                at = range.end;
            }
        }
        made + &self.text[at..]
    }

    /// White space before an element that begins its line.
    fn indentation(&self, node: Node<'_, '_>) -> String {
        let before = &self.text[..node.range().start];
        let line = &before[before.rfind('\n').map_or(0, |at| at + 1)..];
        let blank = line.trim_start_matches([' ', '\t']);
        line[..line.len() - blank.len()].to_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn appended(text: &str, name: &str) -> String {
        let document = parse(text).unwrap();
        let node = document.descendants().find(|node| is(*node, name)).unwrap();
        let mut edits = Edits::new(text);
        edits.append(node, &["<x>".into(), "  <y/>".into(), "</x>".into()]);
        let made = edits.made();
        assert!(parse(&made).is_ok(), "{made}");
        made
    }

    #[test]
    fn lines_are_put_at_the_end_and_the_rest_stays_as_it_was() {
        for (text, name, expected) in [
            ("<a>\n    <b/>\n</a>\n", "a", "<a>\n    <b/>\n    <x>\n      <y/>\n    </x>\n</a>\n"),
            ("<a>\r\n\t<b/>\r\n</a>", "a", "<a>\r\n\t<b/>\r\n\t<x>\r\n\t  <y/>\r\n\t</x>\r\n</a>"),
            ("<a><b/></a>", "a", "<a><b/>\n  <x>\n    <y/>\n  </x>\n</a>"),
            ("<a>\n  <b />\n</a>", "b", "<a>\n  <b>\n    <x>\n      <y/>\n    </x>\n  </b>\n</a>"),
            ("<a/>", "a", "<a>\n  <x>\n    <y/>\n  </x>\n</a>"),
            ("<p:a xmlns:p='u' q='/>'/>", "a", "<p:a xmlns:p='u' q='/>'>\n  <x>\n    <y/>\n  </x>\n</p:a>"),
            ("<a><!-- </a> --></a >", "a", "<a><!-- </a> -->\n  <x>\n    <y/>\n  </x>\n</a >"),
        ] {
            assert_eq!(appended(text, name), expected);
        }
    }

    #[test]
    fn what_is_taken_out_takes_its_line_along() {
        for (text, expected) in [
            ("<a>\n  <b/>\n  <c/>\n</a>", "<a>\n  <c/>\n</a>"),
            ("<a>\r\n  <b>\r\n </b>\r\n</a>", "<a>\r\n</a>"),
            ("<a><b/><c/></a>", "<a><c/></a>"),
            ("<a>\n<c/> <b/></a>", "<a>\n<c/> </a>"),
        ] {
            let document = parse(text).unwrap();
            let mut edits = Edits::new(text);
            edits.remove(document.descendants().find(|node| is(*node, "b")).unwrap());
            assert_eq!(edits.made(), expected);
        }
    }

    #[test]
    fn prefixes_that_nothing_declares_are_read_where_they_stand() {
        let text = "<a xmlns:c='u'>\n<b:x b:y='b:z'\tb:w='1'><c:d/></b:x><e:f/></a>";
        assert_eq!(readable(text), "<a xmlns:c='u'>\n<b_x b_y='b:z'\tb_w='1'><c:d/></b_x><e_f/></a>");
        assert!(parse(&readable(text)).is_ok());
        for other in ["<a/>", "<a", "<a b='c:d'/>", "<a><b:></a>"] {
            assert_eq!(readable(other), other);
        }
    }

    #[test]
    fn a_value_is_read_as_it_was_meant() {
        let value = "a\"b'<c>&amp;\t\n\r ]]> \u{e4}";
        let text = format!("<a b=\"{}\"/>", escaped(value));
        assert_eq!(parse(&text).unwrap().root_element().attribute("b"), Some(value));
    }
}
