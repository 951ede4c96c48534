//! Contact: rows of a NumPy array, with the fields of `dermatome_msgs/msg/Contact`.

use crate::array::{Records, record_type};
use dermatome_shared::{contact::Contact, protocol::FrameStamp};
use pyo3::{prelude::*, sync::PyOnceLock};

/// NumPy's type of a contact. What is not known is NaN, a number of a contact that there is not 0.
const FIELDS: [(&str, &str, Option<usize>); 17] = [
    ("sequence", "<u4", None),
    ("time", "<f8", None),
    ("id", "<u4", None),
    ("merged", "<u4", None),
    ("split_from", "<u4", None),
    ("position", "<f4", Some(3)),
    ("normal", "<f4", Some(3)),
    ("velocity", "<f4", Some(3)),
    ("area", "<f4", None),
    ("strength", "<f4", None),
    ("peak", "<f4", None),
    ("pressure", "<f4", None),
    ("force", "<f4", None),
    ("load_area", "<f4", None),
    ("significance", "<f4", None),
    ("position_deviation", "<f4", None),
    ("strength_deviation", "<f4", None),
];

/// NumPy's type of a contact, made once.
pub(crate) fn contact_type(py: Python<'_>) -> PyResult<&Bound<'_, PyAny>> {
    static TYPE: PyOnceLock<Py<PyAny>> = PyOnceLock::new();
    TYPE.get_or_try_init(py, || Ok(record_type(py, &FIELDS)?.unbind())).map(|kind| kind.bind(py))
}

/// Contacts, each with the frame that it is of.
pub(crate) fn contacts<'py>(
    py: Python<'py>,
    contacts: impl IntoIterator<Item = (FrameStamp, Contact)>,
) -> PyResult<Bound<'py, PyAny>> {
    let mut records = Records::new();
    contacts.into_iter().for_each(|(at, contact)| put(&mut records, at, &contact));
    records.array(contact_type(py)?)
}

fn put(records: &mut Records, at: FrameStamp, contact: &Contact) {
    let (identity, evidence) = (contact.identity, contact.evidence);
    let number = |number: Option<u32>| number.unwrap_or(0).to_le_bytes();
    let known = |value: Option<f32>| value.unwrap_or(f32::NAN);
    records
        .put(at.sequence.to_le_bytes())
        .put(seconds(at).to_le_bytes())
        .put(number(identity.map(|identity| identity.number)))
        .put(number(identity.and_then(|identity| identity.merged)))
        .put(number(identity.and_then(|identity| identity.split_from)))
        .put_all(contact.position)
        .put_all(contact.normal)
        .put_all(identity.map_or([0.0; 3], |identity| identity.velocity))
        .put_all([contact.area, contact.strength, contact.peak])
        .put_all([contact.pressure, contact.force(), contact.load_area].map(known))
        .put_all([
            known(evidence.map(|evidence| evidence.significance)),
            known(evidence.map(|evidence| evidence.position_deviation)),
            known(evidence.map(|evidence| evidence.strength_deviation)),
        ]);
}

/// When a scan ended, s of the board's clock.
pub(crate) fn seconds(at: FrameStamp) -> f64 {
    at.timestamp_us as f64 / 1e6
}
