//! Files that a task names: pictures and particle positions.

use super::context::Context;
use crate::diag::{Code, Diagnostic, Reported};
use crate::loader::{Listed, Wanted};
use crate::path;
use fab_grammar::ast::Text;
use fab_program::FileRef;

/// Returns the file that a text names. It must be in the entry's folder or below, and there if the caller can tell.
pub(crate) fn named(
    text: Text<'_>,
    what: &str,
    wanted: Wanted,
    context: &mut Context<'_, '_>,
) -> Result<FileRef, Reported> {
    let bad = |message: String| Diagnostic::new(Code::BadPath, text.span(), message);
    let Some(written) = text.plain() else {
        let diagnostic = bad(format!("the path of {what} has a placeholder"));
        return Err(context.error(diagnostic.help("write the path itself")));
    };
    if let Some(fault) = path::fault(&written) {
        return Err(context.error(bad(format!("the path `{written}` {fault}"))));
    }
    let here = context.loaded.portable_name(text.span().file);
    let path = path::within(here, &written).ok_or_else(|| {
        let message = format!("the path `{written}` leads out of the folder of the first file");
        context.error(bad(message).help("move it into the folder of the first file, or below"))
    })?;
    is_there(&path, text, wanted, context)?;
    Ok(FileRef { path })
}

/// Reports a file that is missing or is not a picture; warns of a picture of another size than the camera's.
fn is_there(
    path: &str,
    text: Text<'_>,
    wanted: Wanted,
    context: &mut Context<'_, '_>,
) -> Result<(), Reported> {
    let missing = |why: String| {
        let message = format!("`{path}` cannot be read: {why}");
        Diagnostic::new(Code::FileMissing, text.span(), message)
            .help("paths are relative to the file that contains them")
    };
    match context.loaded.loader.look(path, wanted) {
        Listed::Unknown => Ok(()),
        Listed::Nothing(why) => Err(context.error(missing(why))),
        Listed::Other if matches!(wanted, Wanted::CameraPicture | Wanted::Picture) => {
            Err(context.error(missing("it is not a picture".to_owned())))
        }
        Listed::Picture { width, height } if wanted == Wanted::CameraPicture => {
            let side = match &context.camera {
                Ok(Some(camera)) => camera.image_px,
                _ => return Ok(()),
            };
            if [width, height] != [side, side] {
                let message = format!(
                    "the picture `{path}` has {width} by {height} pixels, and the camera's has {side} by {side}"
                );
                let diagnostic = Diagnostic::new(Code::PictureOfAnotherSize, text.span(), message);
                context.remark(diagnostic.help("take the picture with the task's camera"));
            }
            Ok(())
        }
        Listed::Picture { .. } | Listed::Other => Ok(()),
    }
}
