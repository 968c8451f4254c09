//! Applies the edits that are certain.
//!
//! In: the name of a file, a loader, and which files may change. Out: the new texts, and the findings that remain.
//! Nothing is written. Whether an edit is certain stands where it is made; here the edited text may not have more
//! errors than before.

use crate::diag::{Diagnostic, Edit, Severity};
use crate::{Compiled, Listed, LoadError, Loader, Wanted, compile};
use std::collections::BTreeMap;

/// The most rounds. One finding may hide another of the same line, so few files need more than three.
const MAX_ROUNDS: usize = 16;

/// The result of [`fix`].
#[derive(Clone, Debug)]
pub struct Fixed {
    /// Each file that changes, by its name.
    pub files: BTreeMap<String, FixedFile>,
    /// The compilation of the new texts. Of its edits, those that are certain belong to files that may not change, or
    /// would add errors.
    pub compiled: Compiled,
}

/// The new text of a file.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct FixedFile {
    /// The whole text.
    pub text: String,
    /// The number of findings that were repaired.
    pub n_repaired: usize,
}

/// Applies every certain edit to the files that may change, as long as that adds no errors.
///
/// Fails only if the entry itself cannot be loaded. Fixing the new texts again changes nothing.
///
/// - `may_change`: told the name of a file, as the loader is.
pub fn fix(
    entry: &str,
    loader: &dyn Loader,
    may_change: &dyn Fn(&str) -> bool,
) -> Result<Fixed, LoadError> {
    let mut files = BTreeMap::new();
    let mut compiled = compile(entry, loader)?;
    for _ in 0..MAX_ROUNDS {
        let mut edited = files.clone();
        apply(&compiled, may_change, &mut edited);
        if edited == files {
            break;
        }
        let overlay = Overlay {
            files: &edited,
            loader,
        };
        let after = compile(entry, &overlay)?;
        if n_errors(&after) > n_errors(&compiled) {
            break;
        }
        (files, compiled) = (edited, after);
    }
    Ok(Fixed { files, compiled })
}

/// Applies the certain edits of a compilation; of two that touch, the first.
fn apply(
    compiled: &Compiled,
    may_change: &dyn Fn(&str) -> bool,
    files: &mut BTreeMap<String, FixedFile>,
) {
    let name = |edit: &Edit| &compiled.sources.get(edit.span.file).name;
    let certain = compiled.diagnostics.iter().filter(|it| it.is_certain());
    let mut chosen: Vec<&Edit> = Vec::new();
    for diagnostic in certain {
        let is_free = |edit: &Edit| {
            let touches = |other: &&Edit| {
                let (a, b) = (edit.span, other.span);
                a.file == b.file && a.start <= b.end && b.start <= a.end
            };
            may_change(name(edit)) && !chosen.iter().any(touches)
        };
        if diagnostic.edits.iter().all(is_free) {
            chosen.extend(&diagnostic.edits);
            let file = files.entry(name(&diagnostic.edits[0]).clone());
            file.or_default().n_repaired += 1;
        }
    }
    for source in compiled.sources.iter() {
        if let Some(file) = files.get_mut(&source.name) {
            file.text.clone_from(&source.text);
        }
    }
    // From the end, so earlier positions stay valid.
    chosen.sort_by_key(|edit| std::cmp::Reverse(edit.span));
    for edit in chosen {
        if let Some(file) = files.get_mut(name(edit)) {
            file.text
                .replace_range(edit.span.range(), &edit.replacement);
        }
    }
}

/// Returns how many errors of form there are, and how many others. Errors of form hide the others.
fn n_errors(compiled: &Compiled) -> (usize, usize) {
    let errors = { compiled.diagnostics.iter() }.filter(|it| it.severity == Severity::Error);
    let (form, other): (Vec<&Diagnostic>, Vec<_>) = errors.partition(|it| it.code.is_about_form());
    (form.len(), other.len())
}

/// The files of a loader, some of them edited.
struct Overlay<'a> {
    files: &'a BTreeMap<String, FixedFile>,
    loader: &'a dyn Loader,
}

impl Loader for Overlay<'_> {
    fn load(&self, name: &str) -> Result<String, LoadError> {
        match self.files.get(name) {
            Some(file) => Ok(file.text.clone()),
            None => self.loader.load(name),
        }
    }

    fn look(&self, path: &str, wanted: Wanted) -> Listed {
        self.loader.look(path, wanted)
    }

    fn trial(&self, title: &str) -> Option<fab_program::Trial> {
        self.loader.trial(title)
    }

    fn refuses_cloth(&self, material: &fab_program::Material, spacing_m: f64) -> Option<String> {
        self.loader.refuses_cloth(material, spacing_m)
    }
}
