//! What kind of file a text is. In: its tree. Out: the kind in words, by the key that has the version of its format.

use crate::yaml::Node;

/// The key of each kind that has the version of its format, and the kind in words.
const KINDS: [(&str, &str); 6] = [
    ("abbe", "a machine file"),
    ("calibration", "a calibration file"),
    ("recording", "a recording file"),
    ("path", "a path file"),
    ("setup", "a set-up file"),
    ("fleet", "a fleet file"),
];

/// The kind of a file that is not of the kind with the key `own`, where it is one of the others.
pub fn another_kind(root: &Node, own: &str) -> Option<&'static str> {
    // A recording names its calibration too, by a word; the version of a calibration file is a number.
    let version = |text: &str| !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit());
    let is = |key: &str| root.get(key).and_then(Node::text).is_some_and(version);
    if is(own) {
        return None;
    }
    KINDS.iter().find(|(key, _)| is(key)).map(|(_, kind)| *kind)
}
