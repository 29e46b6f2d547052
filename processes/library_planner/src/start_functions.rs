//! Functions that a library calls at the start of a run: parameters, refusal.

#![expect(unsafe_code, reason = "called by the library, with its pointers")]

use core::ffi::{CStr, c_char};
use std::cell::RefCell;
use std::collections::BTreeSet;
use std::ffi::CString;

use serde_json::{Map, Value as Json};

use crate::abi::{Start, StartFunctions};
use crate::error::{CallError, Unexpected};

/// The functions of all starts.
pub static FUNCTIONS: StartFunctions = StartFunctions {
    number,
    params,
    refuse,
};

/// The private part of a [`Start`].
#[derive(Debug)]
pub struct StartContext<'a> {
    params: &'a Map<String, Json>,
    text: CString,
    requests: RefCell<Requests>,
}

/// Requests of a library at its start.
#[derive(Debug, Default)]
struct Requests {
    /// Parameters that it has named.
    keys: BTreeSet<String>,
    /// `true` if it has taken the text of all parameters.
    has_all: bool,
    /// First fault of a parameter, or its refusal.
    refusal: Option<CallError>,
}

impl<'a> StartContext<'a> {
    /// Returns the context of a start with these parameters.
    pub fn new(params: &'a Map<String, Json>) -> Self {
        let text = serde_json::to_string(params).unwrap_or_default();
        Self {
            params,
            // JSON has no zero byte.
            text: CString::new(text).unwrap_or_default(),
            requests: RefCell::default(),
        }
    }

    /// Returns the reason why the planner cannot start, if there is one; `created` is `true` if the library returned a
    /// planner.
    pub fn refusal(&self, created: bool) -> Option<CallError> {
        let requests = self.requests.borrow();
        if requests.refusal.is_some() {
            return requests.refusal.clone();
        }
        if !created {
            let text = "create returned NULL without protean_refuse";
            return Some(CallError::Reported(text.to_owned()));
        }
        let unknown = |key: &&String| !requests.has_all && !requests.keys.contains(*key);
        let unknown = self.params.keys().find(unknown)?;
        let known: Vec<String> = requests.keys.iter().map(|key| format!("`{key}`")).collect();
        let known = if known.is_empty() {
            "none, as the planner has no parameters".to_owned()
        } else {
            format!("one of {}", known.join(", "))
        };
        Some(Unexpected::new(format!("unknown parameter `{unknown}`"), known).into())
    }

    fn number(&self, key: &str, absent: f64) -> f64 {
        let mut requests = self.requests.borrow_mut();
        requests.keys.insert(key.to_owned());
        let value = match self.params.get(key) {
            None => return absent,
            Some(Json::Bool(truth)) => Some(f64::from(u8::from(*truth))),
            Some(value) => value.as_f64(),
        };
        value.unwrap_or_else(|| {
            let value = self.params.get(key).unwrap_or(&Json::Null);
            let fault = Unexpected::new(format!("`{key}` is {value}"), "a number");
            requests.refusal.get_or_insert(fault.into());
            absent
        })
    }
}

/// Returns the context of a start.
///
/// # Safety
/// `start` is NULL or the pointer that `create` received, during that call.
unsafe fn context<'a>(start: *const Start) -> Option<&'a StartContext<'a>> {
    // SAFETY: the caller's; the context was made for the same call.
    unsafe { start.as_ref()?.context.cast::<StartContext<'a>>().as_ref() }
}

/// Returns the text at a pointer; empty for NULL.
///
/// # Safety
/// `text` is NULL or a string that ends with a zero byte.
pub unsafe fn text(text: *const c_char) -> String {
    if text.is_null() {
        return String::new();
    }
    // SAFETY: the caller's.
    let text = unsafe { CStr::from_ptr(text) };
    text.to_string_lossy().into_owned()
}

unsafe extern "C" fn number(start: *const Start, key: *const c_char, absent: f64) -> f64 {
    // SAFETY: duties of the library, stated in the header.
    let (context, key) = unsafe { (context(start), text(key)) };
    context.map_or(absent, |context| context.number(&key, absent))
}

unsafe extern "C" fn params(start: *const Start) -> *const c_char {
    // SAFETY: duty of the library, stated in the header.
    let Some(context) = (unsafe { context(start) }) else {
        return c"{}".as_ptr();
    };
    context.requests.borrow_mut().has_all = true;
    context.text.as_ptr()
}

unsafe extern "C" fn refuse(start: *const Start, reason: *const c_char) {
    // SAFETY: duties of the library, stated in the header.
    let (context, reason) = unsafe { (context(start), text(reason)) };
    if let Some(context) = context {
        let mut requests = context.requests.borrow_mut();
        requests.refusal.get_or_insert(CallError::Reported(reason));
    }
}
