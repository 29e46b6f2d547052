//! Pages and their pictures, as files.

use std::path::{Path, PathBuf};

use draw::figures::{Chart, draw};
use platform::atomic_file::{SaveError, save};

/// A page and its pictures.
#[derive(Debug, Clone, PartialEq)]
pub struct Page {
    /// The page, as Markdown.
    pub text: String,
    /// Its pictures, in the folder `images` beside it.
    pub images: Vec<Image>,
}

/// A picture of the page.
#[derive(Debug, Clone, PartialEq)]
pub struct Image {
    /// Name of its file, without the extension.
    pub name: &'static str,
    /// Its content.
    pub chart: Chart,
}

impl Page {
    /// Writes the page to this file, its pictures to the folder `images` beside it; returns the
    /// files.
    ///
    /// # Errors
    /// [`SaveError`] if a file cannot be written.
    pub fn write(&self, out: &Path) -> Result<Vec<PathBuf>, SaveError> {
        let images = out.with_file_name("images");
        let mut written = Vec::new();
        for image in &self.images {
            let path = images.join(format!("{}.svg", image.name));
            save(draw(&image.chart).svg().as_bytes(), &path)?;
            written.push(path);
        }
        save(self.text.as_bytes(), out)?;
        written.push(out.to_owned());
        Ok(written)
    }
}
