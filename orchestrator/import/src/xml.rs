//! XML documents whose parsing takes linear time.

use std::path::Path;

use roxmltree::Document;

use super::ImportError;

/// Maximum number of attributes of an element, and of namespace declarations of a file: the parser compares each with
/// all others.
const MAX_ATTRIBUTES: usize = 256;

/// Parses XML.
///
/// # Errors
/// The text is not XML, or an element or the file exceeds [`MAX_ATTRIBUTES`].
pub fn parse<'text>(path: &Path, text: &'text str) -> Result<Document<'text>, ImportError> {
    let mut line = 1;
    // No tag contains another `<`.
    for tag in text.split('<') {
        if has_too_many_attributes(tag) {
            let expected = format!("at most {MAX_ATTRIBUTES} attributes of an element");
            return Err(ImportError::line(path, line, tag, &expected));
        }
        line += tag.bytes().filter(|byte| *byte == b'\n').count();
    }
    if text.matches("xmlns").nth(MAX_ATTRIBUTES).is_some() {
        let found = format!("more than {MAX_ATTRIBUTES} declarations `xmlns`");
        return Err(ImportError::content(path, found, "fewer"));
    }
    Document::parse(text).map_err(|source| ImportError::Xml {
        path: path.to_owned(),
        source,
    })
}

/// Returns `true` if more than [`MAX_ATTRIBUTES`] quoted values precede the end of the tag.
fn has_too_many_attributes(tag: &str) -> bool {
    let mut rest = tag;
    for _ in 0..=MAX_ATTRIBUTES {
        let quote = rest.find(['"', '\'', '>']).map(|at| rest.split_at(at).1);
        let value = quote.filter(|quote| !quote.starts_with('>'));
        let Some((_, after)) = value.and_then(|value| {
            let (quote, text) = value.split_at(1);
            text.split_once(quote)
        }) else {
            return false;
        };
        rest = after;
    }
    // Comments, instructions and sections have no attributes.
    !tag.starts_with(['!', '?'])
}
