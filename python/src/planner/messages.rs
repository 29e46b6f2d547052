//! Messages of any topic as structured arrays.

use ipc_types::message::{Descriptor, FieldKind};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict, PyList, PyTuple};
use runtime::raw_inputs::RawInputs;

/// Returns the messages of a tick: a list of (header, elements) for each topic.
pub fn messages(py: Python<'_>, inputs: &RawInputs) -> PyResult<Py<PyDict>> {
    let all = PyDict::new(py);
    let message = py.import("protean_robotics._process")?.getattr("Message")?;
    for input in inputs.topics() {
        let facts = input.topic().facts();
        let (header_type, element_type) = (dtype(py, &facts.header)?, dtype(py, &facts.element)?);
        let messages = PyList::empty(py);
        for raw in input.messages() {
            let header = view(py, &raw.header, &header_type)?.get_item(0)?;
            let elements = view(py, &raw.elements, &element_type)?;
            messages.append(message.call1((header, elements))?)?;
        }
        all.set_item(facts.name, messages)?;
    }
    Ok(all.unbind())
}

/// Returns the structured type of a message in NumPy.
pub fn dtype<'py>(py: Python<'py>, of: &Descriptor) -> PyResult<Bound<'py, PyAny>> {
    let number = |ros: &str| {
        let bits: usize = ros
            .trim_start_matches(|c: char| !c.is_ascii_digit())
            .parse()
            .unwrap_or(8);
        let kind = if ros.starts_with("float") {
            'f'
        } else if ros.starts_with('u') {
            'u'
        } else {
            'i'
        };
        format!("<{kind}{}", bits / 8)
    };
    let numpy = py.import("numpy")?;
    if of.fields.is_empty() {
        return numpy.call_method1("dtype", (number(of.name),));
    }
    let fields = PyList::empty(py);
    for field in of.fields {
        match field.kind {
            FieldKind::Number(ros) => fields.append((field.name, number(ros)))?,
            FieldKind::Array(ros, count) => {
                fields.append((field.name, number(ros), PyTuple::new(py, [count])?))?;
            }
            FieldKind::Nested(inner) => fields.append((field.name, dtype(py, inner)?))?,
        }
    }
    numpy.call_method1("dtype", (fields,))
}

/// Returns bytes as a read-only array of a type.
fn view<'py>(
    py: Python<'py>,
    bytes: &[u8],
    dtype: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyAny>> {
    let numpy = py.import("numpy")?;
    if bytes.is_empty() {
        return numpy.call_method1("empty", (0, dtype));
    }
    numpy.call_method1("frombuffer", (PyBytes::new(py, bytes), dtype))
}
