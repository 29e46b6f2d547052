//! The modules of a crate, from its sources: how long they are without tests, and which use which.

use std::collections::{BTreeMap, BTreeSet};
use std::iter::Peekable;
use std::path::{Path, PathBuf};

use proc_macro2::token_stream::IntoIter;
use proc_macro2::{Delimiter, Group, Spacing, TokenStream, TokenTree};

/// The sources of a library or program without its tests, from its root file on.
#[derive(Debug, Default)]
pub struct Sources {
    /// Lines, comments and blank ones included, without those of items and files that are compiled
    /// for tests only.
    pub lines: usize,
    /// Every path from one module to another one of the crate.
    pub uses: Vec<Use>,
    /// File and line, from 1, of every `Result` whose error is a `String`.
    pub text_errors: Vec<(PathBuf, usize)>,
    /// Paths from the root by which modules name what is elsewhere, with where that is.
    aliases: BTreeMap<Vec<String>, Vec<String>>,
    /// All modules, the root included.
    modules: BTreeSet<Vec<String>>,
}

/// A path from one module to another.
#[derive(Debug)]
pub struct Use {
    /// The module that it stands in, from the root.
    pub from: Vec<String>,
    /// The module that it goes to, from the root.
    pub to: Vec<String>,
    /// Its file.
    pub file: PathBuf,
    /// Its line, from 1.
    pub line: usize,
}

/// Reads a crate by the file of its root.
///
/// # Errors
/// The file that cannot be read or is not Rust.
pub fn read(root: &Path) -> Result<Sources, String> {
    let mut sources = Sources::default();
    let folder = root.parent().unwrap_or(Path::new("")).to_owned();
    sources.read_file(root, &folder, &[])?;
    let uses = std::mem::take(&mut sources.uses);
    sources.uses = uses
        .into_iter()
        .map(|used| Use {
            to: sources.module_of(&used.to),
            ..used
        })
        .collect();
    Ok(sources)
}

/// A file while it is read.
struct File<'a> {
    path: &'a Path,
    /// The folder of its child modules.
    children: &'a Path,
    /// Lines of items for tests.
    test_lines: usize,
}

impl Sources {
    fn read_file(&mut self, path: &Path, children: &Path, module: &[String]) -> Result<(), String> {
        let text = std::fs::read_to_string(path).map_err(|e| format!("{}: {e}", path.display()))?;
        let tokens: TokenStream = text
            .parse()
            .map_err(|e| format!("{}: {e}", path.display()))?;
        let mut file = File {
            path,
            children,
            test_lines: 0,
        };
        self.read_tokens(tokens, &mut file, module)?;
        self.lines += text.lines().count() - file.test_lines;
        Ok(())
    }

    fn read_tokens(
        &mut self,
        tokens: TokenStream,
        file: &mut File<'_>,
        module: &[String],
    ) -> Result<(), String> {
        self.modules.insert(module.to_vec());
        let mut tokens = tokens.into_iter().peekable();
        let mut other_path = None;
        // Since the last `;` or block.
        let (mut is_public, mut is_use) = (false, false);
        while let Some(token) = tokens.next() {
            match &token {
                TokenTree::Punct(punct) if punct.as_char() == '#' => {
                    let Some(TokenTree::Group(group)) = tokens.peek() else {
                        continue;
                    };
                    if is_test_only(group) {
                        let first = punct.span().start().line;
                        let last = skip_item(&mut tokens).unwrap_or(first);
                        file.test_lines += last + 1 - first;
                    } else if let Some(path) = path_attribute(group) {
                        other_path = Some(path);
                    }
                }
                TokenTree::Ident(ident) if ident == "mod" => {
                    let Some(TokenTree::Ident(name)) = tokens.next() else {
                        continue;
                    };
                    let mut child = module.to_vec();
                    child.push(name.to_string());
                    match tokens.next() {
                        Some(TokenTree::Group(body)) => {
                            self.read_tokens(body.stream(), file, &child)?;
                        }
                        _ => self.read_child(file, other_path.take(), &child)?,
                    }
                    is_public = false;
                }
                TokenTree::Ident(ident) if ident == "pub" => is_public = true,
                TokenTree::Ident(ident) if ident == "use" => is_use = true,
                TokenTree::Ident(ident) => {
                    let line = ident.span().start().line;
                    let first = ident.to_string();
                    let rest = if double_colon(&mut tokens) {
                        use_tree(&mut tokens)
                    } else {
                        Vec::new()
                    };
                    let last = rest.first().map_or(&first, |(_, name)| name);
                    if last == "Result" && has_text_error(tokens.clone()) {
                        self.text_errors.push((file.path.to_owned(), line));
                    }
                    for (path, name) in rest {
                        let Some(to) = absolute(module, &first, path) else {
                            continue;
                        };
                        if is_use {
                            let alias = module.iter().cloned().chain([name]).collect();
                            self.aliases.insert(alias, to.clone());
                        }
                        // A name that is only passed on is used elsewhere.
                        if !(is_use && is_public && to.starts_with(module)) {
                            self.uses.push(Use {
                                from: module.to_vec(),
                                to,
                                file: file.path.to_owned(),
                                line,
                            });
                        }
                    }
                }
                TokenTree::Group(group) => {
                    self.read_tokens(group.stream(), file, module)?;
                    if group.delimiter() == Delimiter::Brace {
                        (is_public, is_use) = (false, false);
                    }
                }
                TokenTree::Punct(punct) if punct.as_char() == ';' => {
                    (is_public, is_use) = (false, false);
                }
                _ => {}
            }
        }
        Ok(())
    }

    /// The module in which the item of a path from the root is declared.
    fn module_of(&self, path: &[String]) -> Vec<String> {
        let mut path = path.to_vec();
        let mut depth = 0;
        // An alias may go round in a circle with others: of external names that modules also have.
        let mut left = 20;
        while depth < path.len() {
            let next = &path[..=depth];
            if self.modules.contains(next) {
                depth += 1;
            } else if let Some(to) = self.aliases.get(next)
                && left > 0
            {
                path = [to.as_slice(), &path[depth + 1..]].concat();
                (depth, left) = (0, left - 1);
            } else {
                break;
            }
        }
        path.truncate(depth);
        path
    }

    /// Reads the file of a module that is declared in another one.
    fn read_child(
        &mut self,
        parent: &File<'_>,
        other_path: Option<String>,
        module: &[String],
    ) -> Result<(), String> {
        let name = module.last().map_or("", String::as_str);
        let children = parent.children.join(name);
        if let Some(path) = other_path {
            let beside = parent.path.parent().unwrap_or(Path::new(""));
            return self.read_file(&beside.join(path), &children, module);
        }
        let beside = parent.children.join(name).with_extension("rs");
        if beside.is_file() {
            self.read_file(&beside, &children, module)
        } else {
            self.read_file(&children.join("mod.rs"), &children, module)
        }
    }
}

/// Resolves a path from the root: a path that does not begin with `crate` is relative to the module or its
/// parents; `None` above the root.
fn absolute(module: &[String], first: &str, rest: Vec<String>) -> Option<Vec<String>> {
    let mut rest = rest.into_iter().peekable();
    let mut path = Vec::new();
    if first != "crate" {
        path.extend_from_slice(module);
    }
    match first {
        "crate" | "self" => {}
        "super" => {
            path.pop()?;
            while rest.next_if(|segment| segment == "super").is_some() {
                path.pop()?;
            }
        }
        _ => path.push(first.to_owned()),
    }
    path.extend(rest);
    Some(path)
}

type Tokens = Peekable<IntoIter>;

/// Takes `::`, if it is next.
fn double_colon(tokens: &mut Tokens) -> bool {
    let is_first = |token: &TokenTree| matches!(token, TokenTree::Punct(punct) if punct.as_char() == ':' && punct.spacing() == Spacing::Joint);
    tokens.next_if(is_first).is_some() && tokens.next().is_some()
}

/// Returns `true` if the arguments of a `Result` come next, and its error is a `String`.
fn has_text_error(tokens: Tokens) -> bool {
    let (mut depth, mut error, mut last) = (0, None, String::new());
    for token in tokens {
        let text = token.to_string();
        match text.as_str() {
            "<" => depth += 1,
            // Not that of `->`.
            ">" if last != "-" => depth -= 1,
            "," if depth == 1 && error.is_none() => error = Some(String::new()),
            _ => {}
        }
        if depth == 0 {
            break;
        }
        if let Some(error) = &mut error
            && text != ","
        {
            error.push_str(&text);
        }
        last = text;
    }
    error.is_some_and(|error| error.rsplit("::").next() == Some("String"))
}

/// Takes a path or a tree of them: each path, and the name that a `use` gives it.
fn use_tree(tokens: &mut Tokens) -> Vec<(Vec<String>, String)> {
    let mut path = Vec::new();
    loop {
        match tokens.peek() {
            Some(TokenTree::Ident(ident)) => {
                path.push(ident.to_string());
                tokens.next();
            }
            Some(TokenTree::Group(group)) if group.delimiter() == Delimiter::Brace => {
                let group = group.clone();
                tokens.next();
                return branches(&group, &path);
            }
            _ => break,
        }
        if !double_colon(tokens) {
            break;
        }
    }
    if path.last().is_some_and(|last| last == "self") {
        path.pop();
    }
    let mut name = path.last().cloned().unwrap_or_default();
    if tokens
        .next_if(|token| matches!(token, TokenTree::Ident(ident) if ident == "as"))
        .is_some()
        && let Some(TokenTree::Ident(ident)) = tokens.next()
    {
        name = ident.to_string();
    }
    vec![(path, name)]
}

/// The paths between the braces of a tree, each behind `path`.
fn branches(group: &Group, path: &[String]) -> Vec<(Vec<String>, String)> {
    let mut tokens = group.stream().into_iter().peekable();
    let mut found = Vec::new();
    while tokens.peek().is_some() {
        for (rest, name) in use_tree(&mut tokens) {
            let whole: Vec<String> = path.iter().cloned().chain(rest).collect();
            found.push((whole, name));
        }
        // The comma, or the star of a glob.
        tokens.next();
    }
    found
}

/// Returns `true` if an attribute is `#[cfg(test)]`, alone or within `all`.
fn is_test_only(attribute: &Group) -> bool {
    let text = attribute.stream().to_string().replace(' ', "");
    text == "cfg(test)" || text.starts_with("cfg(all(test,")
}

/// The file that `#[path = "…"]` names.
fn path_attribute(attribute: &Group) -> Option<String> {
    let text = attribute.stream().to_string();
    let path = text.strip_prefix("path = \"")?.strip_suffix('"')?;
    Some(path.to_owned())
}

/// Passes over an item with what is left of its attributes; its last line.
fn skip_item(tokens: &mut Tokens) -> Option<usize> {
    let mut last = None;
    while let Some(token) = tokens.next() {
        last = Some(token.span().end().line);
        let ends = match &token {
            TokenTree::Punct(punct) => punct.as_char() == ';',
            TokenTree::Group(group) => {
                // `use a::{b, c};` goes on behind its braces.
                group.delimiter() == Delimiter::Brace
                    && !matches!(tokens.peek(), Some(TokenTree::Punct(next)) if next.as_char() == ';')
            }
            _ => false,
        };
        if ends {
            break;
        }
    }
    last
}
