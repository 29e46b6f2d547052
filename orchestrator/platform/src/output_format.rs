//! Formats of output files: the ending of a file's name tells its format.

use std::path::PathBuf;

/// The name of an output file has the ending of another format.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{format}: expected a name {expected}, for example {}", example.display())]
pub struct OutputNameError {
    /// Sentence that names the format.
    pub format: &'static str,
    /// Description of the ending.
    pub expected: String,
    /// The name with the expected ending.
    pub example: PathBuf,
}

/// Format of an output file, or a folder.
#[derive(Debug, Clone, Copy)]
pub struct OutputFormat {
    /// Sentence that names the format.
    text: &'static str,
    /// Endings of its files; the first one is usual. A folder has none.
    endings: &'static [&'static str],
}

impl OutputFormat {
    /// Logs.
    pub const LOG: Self = Self::new("logs are MCAP files", &["mcap"]);
    /// Pages.
    pub const PAGE: Self = Self::new("pages are HTML files", &["html", "htm"]);
    /// Pictures.
    pub const PICTURE: Self =
        Self::new("pictures are SVG, PNG or PDF files", &["svg", "png", "pdf"]);
    /// Curves.
    pub const SVG: Self = Self::new("curves are SVG files", &["svg"]);
    /// Tables of one file.
    pub const CSV: Self = Self::new("the table is a CSV file", &["csv"]);
    /// Pictures of a dataflow.
    pub const GRAPH: Self = Self::new("graphs are SVG or Mermaid files", &["svg", "mmd", "md"]);
    /// Results of measurements and plans, instances.
    pub const JSON: Self = Self::new("results are JSON files", &["json", "jsonl", "ndjson"]);
    /// Results of tests for servers of continuous integration.
    pub const JUNIT: Self = Self::new("results of tests are XML files", &["xml"]);
    /// Summaries.
    pub const MARKDOWN: Self = Self::new("summaries are Markdown files", &["md", "markdown"]);
    /// Tables, bags and results of experiments.
    pub const FOLDER: Self = Self::new("the output is a folder", &[]);

    const fn new(text: &'static str, endings: &'static [&'static str]) -> Self {
        Self { text, endings }
    }

    /// Returns the name of an output file if it has no ending or one of the format. An ending begins with a letter: the
    /// folder `run-0.5` has none.
    ///
    /// # Errors
    /// [`OutputNameError`] names the expected ending.
    pub fn check(self, file: PathBuf) -> Result<PathBuf, OutputNameError> {
        let ending = file.extension().and_then(|ending| ending.to_str());
        let ending = ending.filter(|ending| ending.starts_with(|c: char| c.is_alphabetic()));
        let is_own = |ending: &str| {
            self.endings
                .iter()
                .any(|own| ending.eq_ignore_ascii_case(own))
        };
        if ending.is_none_or(is_own) {
            return Ok(file);
        }
        let (expected, example) = match self.endings.first() {
            Some(own) => (format!("that ends in .{own}"), file.with_extension(own)),
            None => ("without an ending".to_owned(), file.with_extension("")),
        };
        Err(OutputNameError {
            format: self.text,
            expected,
            example,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_with_the_ending_of_another_format_is_refused() {
        use OutputFormat as Format;
        let check = |format: Format, name: &str| format.check(PathBuf::from(name));
        for (format, fits, other) in [
            (
                Format::LOG,
                ["a.mcap", "b/a.MCAP", "a", "run-0.5"],
                "a.html",
            ),
            (Format::PAGE, ["a.html", "a.htm", "a.d/a", "a"], "a.pdf"),
            (Format::PICTURE, ["a.svg", "a.PNG", "a.pdf", "a"], "a.gif"),
            (Format::JSON, ["a.json", "a.jsonl", "-", "a"], "a.csv"),
            (Format::FOLDER, ["a", "a.d/b", "v1.2", "."], "a.csv"),
        ] {
            for name in fits {
                assert_eq!(check(format, name), Ok(PathBuf::from(name)));
            }
            let refused = check(format, other).unwrap_err().to_string();
            assert!(refused.contains("for example a"), "{refused}");
        }
        let refused = check(Format::PICTURE, "d/x.gif").unwrap_err().to_string();
        let expected = "pictures are SVG, PNG or PDF files: expected a name that ends in .svg, for example d/x.svg";
        assert_eq!(refused, expected);
    }
}
