//! Why a program cannot be written.

use std::fmt;

/// Why a program cannot be written.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum EmitError {
    /// A name cannot be used in a path or a template; the compiler never gives one like that.
    Name {
        /// The name.
        name: String,
    },
    /// The program lacks something that it refers to, or that is of another kind.
    Reference {
        /// Its name.
        name: String,
        /// The kind that it would have to be.
        wanted: &'static str,
    },
    /// A number is infinite, NaN, or a zero divisor.
    Number {
        /// The number.
        value: String,
    },
    /// The names of two files differ only by case.
    SameFile {
        /// The path of one.
        one: String,
        /// The path of the other.
        other: String,
    },
}

impl fmt::Display for EmitError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            EmitError::Name { name } => write!(f, "`{name}` cannot be the name of a file"),
            EmitError::Reference { name, wanted } => {
                write!(f, "`{name}` is not {wanted}")
            }
            EmitError::Number { value } => {
                write!(
                    f,
                    "the program computes with `{value}`, which is not a finite number"
                )
            }
            EmitError::SameFile { one, other } => write!(
                f,
                "`{one}` and `{other}` are the same file on systems that ignore letter case; rename one"
            ),
        }
    }
}

impl std::error::Error for EmitError {}

/// Accepts a name that is safe in a path and in a template: ASCII letters, digits and `_`, joined by dots.
pub(crate) fn plain_name(name: &str) -> Result<&str, EmitError> {
    let is_plain = name.split('.').all(|part| {
        !part.is_empty()
            && part
                .bytes()
                .all(|byte| byte.is_ascii_alphanumeric() || byte == b'_')
    });
    if is_plain {
        Ok(name)
    } else {
        Err(EmitError::Name {
            name: name.to_owned(),
        })
    }
}
