//! Why a program cannot be written.

/// Why a program cannot be written.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum EmitError {
    /// A name cannot be used in a path or a template; the compiler never gives one like that.
    #[error("`{name}` cannot be the name of a file")]
    Name {
        /// The name.
        name: String,
    },
    /// The program lacks something that it refers to, or that is of another kind.
    #[error("`{name}` is not {wanted}")]
    Reference {
        /// Its name.
        name: String,
        /// The kind that it would have to be.
        wanted: &'static str,
    },
    /// A number is infinite, NaN, or a zero divisor.
    #[error("the program computes with `{value}`, which is not a finite number")]
    Number {
        /// The number.
        value: String,
    },
    /// The names of two files differ only by case.
    #[error(
        "`{one}` and `{other}` are the same file on systems that ignore letter case; rename one"
    )]
    SameFile {
        /// The path of one.
        one: String,
        /// The path of the other.
        other: String,
    },
}

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
