//! What a setting is: one declaration states its type, its default, the values accepted, and why.
//!
//! In: structs declared with `section!`, and the text of a settings file. Out: a document in which every key is known and
//! every value accepted, with the defaults filled in; else all faults. A test prints `docs/arm-settings.md` from the same
//! declarations. What one key requires of another is left to `check`.

use fab_base::wording::quoted;
use fab_program::nearest::nearest;
use std::path::PathBuf;
use toml::{Table, Value};

/// Declares sections of the settings: structs whose fields are keys.
///
/// A field's comment is its reason on the page and in messages. After the type may follow a default, in TOML, and the
/// values accepted. A key without a default must be given, unless its type is an `Option`. A struct may end with fields
/// that are no keys: `with { name: Type }`.
macro_rules! section {
    ($(
        $(#[$attribute:meta])*
        pub struct $Section:ident {
            $(
                $(#[doc = $why:literal])+
                $key:ident: $type:ty $(= $default:expr)? $(, $values:expr)?;
            )*
        }
        $(with { $(#[$found_attribute:meta])* $found:ident: $found_type:ty })?
    )+) => {$(
        $(#[$attribute])*
        #[derive(Clone, Debug, PartialEq, serde::Deserialize)]
        #[serde(deny_unknown_fields)]
        pub struct $Section {
            $($(#[doc = $why])+ pub $key: $type,)*
            $($(#[$found_attribute])* #[serde(skip)] $found: $found_type,)?
        }

        impl $crate::settings::declare::Setting for $Section {
            fn accepts(_: $crate::settings::declare::Values) -> $crate::settings::declare::Accepts {
                use $crate::settings::declare::{Accepts, Key};
                Accepts::Section(vec![$(
                    Key::of::<$type>(
                        stringify!($key),
                        &[$(stringify!($default))?],
                        &[$($values)?],
                        &[$($why),+],
                    )
                ),*])
            }
        }
    )+};
}
pub(crate) use section;

/// Declares that a setting is one of an enumeration's names.
macro_rules! named_settings {
    ($($Enum:ty),+) => {$(
        impl $crate::settings::declare::Setting for $Enum {
            fn accepts(_: $crate::settings::declare::Values) -> $crate::settings::declare::Accepts {
                let names = <$Enum>::ALL.map(<$Enum>::name);
                $crate::settings::declare::Accepts::OneOf(names.to_vec())
            }
        }
    )+};
}
pub(crate) use named_settings;

/// A key of a section.
pub(crate) struct Key {
    name: &'static str,
    accepts: Accepts,
    /// Its value if it is absent, as TOML.
    default: Option<&'static str>,
    /// Whether it may be absent without a default.
    is_optional: bool,
    why: String,
}

/// The values that a key accepts.
pub(crate) enum Accepts {
    /// A text that is not blank.
    Text,
    /// One of these words.
    OneOf(Vec<&'static str>),
    Number(Values),
    Whole(Values),
    /// So many of these, or any count.
    List(Option<usize>, Box<Accepts>),
    Section(Vec<Key>),
}

/// Numbers that are accepted.
#[derive(Clone, Copy)]
pub(crate) struct Values {
    least: f64,
    most: f64,
}

/// Every value of a type.
pub(crate) const ANY: Values = from(f64::NEG_INFINITY, f64::INFINITY);

/// Degrees.
pub(crate) const ANGLE: Values = from(-360.0, 360.0);

/// The longest side of a picture, pixels.
pub(crate) const MAX_SIDE_PX: f64 = 16_384.0;

/// Numbers of a range, both ends included.
pub(crate) const fn from(least: f64, most: f64) -> Values {
    Values { least, most }
}

/// A type of settings.
pub(crate) trait Setting {
    /// Whether a key of this type may be absent.
    const IS_OPTIONAL: bool = false;

    /// Returns what a key of this type accepts.
    fn accepts(values: Values) -> Accepts;
}

impl<T: Setting> Setting for Option<T> {
    const IS_OPTIONAL: bool = true;

    fn accepts(values: Values) -> Accepts {
        T::accepts(values)
    }
}

impl<T: Setting> Setting for Vec<T> {
    fn accepts(values: Values) -> Accepts {
        Accepts::List(None, Box::new(T::accepts(values)))
    }
}

impl<T: Setting, const N: usize> Setting for [T; N] {
    fn accepts(values: Values) -> Accepts {
        Accepts::List(Some(N), Box::new(T::accepts(values)))
    }
}

macro_rules! plain_settings {
    ($($type:ty: $accepts:expr;)+) => {$(
        impl Setting for $type {
            fn accepts(values: Values) -> Accepts {
                $accepts(values)
            }
        }
    )+};
}
plain_settings! {
    f64: Accepts::Number;
    u16: Accepts::Whole;
    u32: Accepts::Whole;
    usize: Accepts::Whole;
    String: |_| Accepts::Text;
    PathBuf: |_| Accepts::Text;
}

/// Reads a section, and checks every key of it by its declaration; fails with all faults, one per line.
pub(crate) fn read<T: Setting + serde::de::DeserializeOwned>(text: &str) -> Result<T, String> {
    let document: Table = toml::from_str(text).map_err(|error| error.to_string())?;
    let mut document = Value::Table(document);
    let mut faults = Vec::new();
    check(&mut document, &T::accepts(ANY), "", "", &mut faults);
    if !faults.is_empty() {
        return Err(faults.join("\n"));
    }
    document
        .try_into()
        .map_err(|error: toml::de::Error| error.to_string())
}

/// Checks a value and what is in it, and fills in defaults.
///
/// - `full`: the whole name of its key; `why`: the key's reason.
fn check(value: &mut Value, accepts: &Accepts, full: &str, why: &str, faults: &mut Vec<String>) {
    match (value, accepts) {
        (Value::Table(table), Accepts::Section(keys)) => {
            let of = |name: &str| format!("{full}.{name}").trim_matches('.').to_owned();
            let is_known = |name: &str| keys.iter().any(|key| key.name == name);
            for unknown in table.keys().filter(|name| !is_known(name)) {
                let names = || keys.iter().map(|key| key.name);
                let instead = nearest(unknown, names()).map_or_else(
                    || format!("here may stand {}", quoted(names())),
                    |near| format!("did you mean `{}`?", of(near)),
                );
                faults.push(format!("`{}` is not a setting; {instead}", of(unknown)));
            }
            for key in keys {
                let (full, why) = (of(key.name), &key.why);
                if !table.contains_key(key.name)
                    && let Some(default) = key.default_value()
                {
                    table.insert(key.name.to_owned(), default);
                    // A test accepts the defaults of keys without inner ones.
                    if key.accepts.keys().is_none() {
                        continue;
                    }
                }
                match table.get_mut(key.name) {
                    Some(value) => check(value, &key.accepts, &full, why, faults),
                    None if key.is_optional => {}
                    None => faults.push(format!("`{full}` is missing: {}", lowered(why))),
                }
            }
        }
        (Value::Array(all), Accepts::List(None, one)) if one.keys().is_some() => {
            for (index, value) in all.iter_mut().enumerate() {
                check(value, one, &format!("{full}[{index}]"), why, faults);
            }
        }
        (value, accepts) if !accepts.takes(value) => {
            let (expected, why) = (accepts.expected(), lowered(why));
            faults.push(format!("`{full}` is `{value}`; expected {expected}: {why}"));
        }
        _ => {}
    }
}

/// Returns a sentence as a part of another.
fn lowered(sentence: &str) -> String {
    let mut letters = sentence.trim_end_matches('.').chars();
    let first = letters.next().into_iter().flat_map(char::to_lowercase);
    first.chain(letters.as_str().chars()).collect()
}

impl Values {
    fn holds(self, number: f64) -> bool {
        (self.least..=self.most).contains(&number)
    }
}

impl Accepts {
    /// Returns the keys of a section, or of one in a list.
    fn keys(&self) -> Option<&[Key]> {
        match self {
            Accepts::Section(keys) => Some(keys),
            Accepts::List(_, one) => one.keys(),
            _ => None,
        }
    }

    fn takes(&self, value: &Value) -> bool {
        match (self, value) {
            (Accepts::Text, Value::String(text)) => !text.trim().is_empty(),
            (Accepts::OneOf(words), Value::String(word)) => words.contains(&word.as_str()),
            (Accepts::Number(values), Value::Float(number)) => values.holds(*number),
            (Accepts::Number(values) | Accepts::Whole(values), Value::Integer(number)) => {
                values.holds(*number as f64)
            }
            (Accepts::List(count, one), Value::Array(all)) => {
                count.is_none_or(|count| all.len() == count) && all.iter().all(|it| one.takes(it))
            }
            _ => false,
        }
    }

    /// Words the values that are accepted. The unit of a number is in its key's name.
    fn expected(&self) -> String {
        let range = |values: &Values| format!("{} to {}", values.least, values.most);
        match self {
            Accepts::Text => "a text".to_owned(),
            Accepts::OneOf(words) => format!("`{}`", words.join("`, `")),
            Accepts::Number(values) => range(values),
            Accepts::Whole(values) => format!("a whole number, {}", range(values)),
            Accepts::List(count, one) => {
                let count = count.map_or("a list of".to_owned(), |count| count.to_string());
                match one.as_ref() {
                    Accepts::Number(values) => format!("{count} numbers, {}", range(values)),
                    Accepts::Whole(values) => format!("{count} whole numbers, {}", range(values)),
                    Accepts::Section(_) => format!("{count} sections"),
                    _ => format!("{count} texts"),
                }
            }
            Accepts::Section(_) => "a section".to_owned(),
        }
    }
}

impl Key {
    /// Makes the key of a field.
    ///
    /// - `default`, `values`: one or none; `why`: the lines of its comment.
    pub(crate) fn of<T: Setting>(
        name: &'static str,
        default: &[&'static str],
        values: &[Values],
        why: &[&str],
    ) -> Key {
        Key {
            name,
            accepts: T::accepts(values.first().copied().unwrap_or(ANY)),
            default: default.first().copied(),
            is_optional: T::IS_OPTIONAL,
            why: why.concat().trim().to_owned(),
        }
    }

    /// Returns the value of an absent key. A section has one: its keys say whether they may be absent.
    fn default_value(&self) -> Option<Value> {
        let empty = match self.accepts {
            Accepts::Section(_) if !self.is_optional => Some("{}"),
            _ => self.default,
        };
        let mut table: Table = toml::from_str(&format!("it = {}", empty?)).ok()?;
        table.remove("it")
    }
}

#[cfg(test)]
mod tests;
