//! Files that a task names: pictures and particle positions.

use super::context::{Context, Result};
use crate::diag::Code;
use crate::loader::{Listed, Wanted};
use crate::path;
use fab_grammar::ast::Text;
use fab_program::FileRef;

/// Returns the file that a text names. It must be in the entry's folder or below, and there if the caller can tell.
pub(crate) fn named(
    text: Text<'_>,
    what: &str,
    wanted: Wanted,
    context: &mut Context<'_>,
) -> Result<FileRef> {
    let span = text.span();
    let Some(written) = text.plain() else {
        let message = format!("the path of {what} has a placeholder");
        return Err(context.refuse(Code::BadPath, span, message, "write the path itself"));
    };
    if let Some(fault) = path::fault(&written) {
        return Err(context.fault(Code::BadPath, span, format!("the path `{written}` {fault}")));
    }
    let here = context.loaded.portable_name(text.span().file);
    let path = path::within(here, &written).ok_or_else(|| {
        let message = format!("the path `{written}` leads out of the folder of the first file");
        let help = "move it into the folder of the first file, or below";
        context.refuse(Code::BadPath, span, message, help)
    })?;
    look(&path, text, wanted, context);
    Ok(FileRef { path })
}

/// Reports a file that is missing or is not a picture; warns of a picture of another size than the camera's.
fn look(path: &str, text: Text<'_>, wanted: Wanted, context: &mut Context<'_>) {
    let is_picture = matches!(wanted, Wanted::CameraPicture | Wanted::Picture);
    let why = match context.loaded.loader.look(path, wanted) {
        Listed::Nothing(why) => why,
        Listed::Other if is_picture => "it is not a picture".to_owned(),
        Listed::Picture { width, height } if wanted == Wanted::CameraPicture => {
            if let Ok(Some(camera)) = &context.camera
                && [width, height] != [camera.image_px; 2]
            {
                let side = camera.image_px;
                let message = format!(
                    "the picture `{path}` has {width} by {height} pixels, and the camera's has {side} by {side}"
                );
                let help = "take the picture with the task's camera";
                context.warn(Code::PictureOfAnotherSize, text.span(), message, help);
            }
            return;
        }
        Listed::Unknown | Listed::Picture { .. } | Listed::Other => return,
    };
    let message = format!("`{path}` cannot be read: {why}");
    let help = "paths are relative to the file that contains them";
    context.refuse(Code::FileMissing, text.span(), message, help);
}
