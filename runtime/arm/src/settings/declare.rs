//! What a setting is: one declaration states its type, its default, the values accepted, and why.
//!
//! In: structs declared with `section!`, and the text of a settings file. Out: a document in which every key is known and
//! every value accepted, with the defaults filled in; else all faults. A test prints `docs/arm-settings.md` from the same
//! declarations. What one key requires of another is left to `check`.

use fab_program::nearest::nearest;
use std::fmt::Write as _;
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
                        [None $(, Some(stringify!($default)))?].last().copied().flatten(),
                        [$crate::settings::declare::ANY $(, $values)?].last().copied(),
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

/// How the name of a key ends, and the unit of its numbers; the first one that fits.
const UNITS: &[(&str, &str)] = &[
    ("_deg_s3", "deg/s³"),
    ("_deg_s2", "deg/s²"),
    ("_deg_s", "deg/s"),
    ("_m_s", "m/s"),
    ("_deg", "deg"),
    ("_px", "px"),
    ("_s", "s"),
    ("_m", "m"),
    ("fingers.open", "in the node's units"),
    ("fingers.closed", "in the node's units"),
    ("fingers.cloth", "in the node's units"),
    ("fingers.tolerance", "in the node's units"),
    ("ros2.gripper_effort", "in the gripper's units"),
];

/// A key of a section.
pub(crate) struct Key {
    name: &'static str,
    accepts: Accepts,
    absent: Absent,
    why: String,
}

/// The values that a key accepts.
pub(crate) enum Accepts {
    /// A text that begins like this, and is not blank.
    Text(&'static str),
    /// One of these words.
    OneOf(Vec<&'static str>),
    Number(Values),
    Whole(Values),
    /// So many of these, or any count.
    List(Option<usize>, Box<Accepts>),
    Section(Vec<Key>),
}

/// Values of a type that are accepted.
#[derive(Clone, Copy)]
pub(crate) struct Values {
    least: f64,
    most: f64,
    /// Whether the least is included; the largest is.
    is_closed: bool,
    /// How a text begins.
    begins: &'static str,
}

/// What applies if a key is absent.
enum Absent {
    Refused,
    Nothing,
    /// This value, as TOML.
    Is(&'static str),
}

/// Every value of a type.
pub(crate) const ANY: Values = from(f64::NEG_INFINITY, f64::INFINITY);

/// Degrees.
pub(crate) const ANGLE: Values = from(-360.0, 360.0);

/// The longest side of a picture, pixels.
pub(crate) const MAX_SIDE_PX: f64 = 16_384.0;

/// Numbers of a range, both ends included.
pub(crate) const fn from(least: f64, most: f64) -> Values {
    Values {
        least,
        most,
        is_closed: true,
        begins: "",
    }
}

/// Numbers above one, up to another.
pub(crate) const fn above(least: f64, most: f64) -> Values {
    Values {
        is_closed: false,
        ..from(least, most)
    }
}

/// Texts that begin like this.
pub(crate) const fn begins(begins: &'static str) -> Values {
    Values { begins, ..ANY }
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
    String: |values: Values| Accepts::Text(values.begins);
    PathBuf: |values: Values| Accepts::Text(values.begins);
}

/// Reads a section, and checks every key of it by its declaration; fails with all faults, one per line.
pub(crate) fn read<T: Setting + serde::de::DeserializeOwned>(text: &str) -> Result<T, String> {
    let mut document: Table = toml::from_str(text).map_err(|error| error.to_string())?;
    let Accepts::Section(keys) = T::accepts(ANY) else {
        return Err("a text is not a section".to_owned());
    };
    let mut check = Check {
        paths: paths(&keys, ""),
        faults: Vec::new(),
    };
    check.section(&mut document, &keys, "");
    if !check.faults.is_empty() {
        return Err(check.faults.join("\n"));
    }
    document
        .try_into()
        .map_err(|error: toml::de::Error| error.to_string())
}

/// Returns the whole names of keys and of those in them.
fn paths(keys: &[Key], prefix: &str) -> Vec<String> {
    let with_inner = |key: &Key| {
        let path = format!("{prefix}{}", key.name);
        let inner = key.accepts.keys();
        let inner = inner.map_or_else(Vec::new, |keys| paths(keys, &format!("{path}.")));
        [vec![path], inner].concat()
    };
    keys.iter().flat_map(with_inner).collect()
}

/// A check of a document.
struct Check {
    /// The names of all keys.
    paths: Vec<String>,
    faults: Vec<String>,
}

impl Check {
    /// Checks the keys of a section, and fills in defaults.
    ///
    /// - `prefix`: its name with a dot, or nothing.
    fn section(&mut self, table: &mut Table, keys: &[Key], prefix: &str) {
        let is_known = |name: &str| keys.iter().any(|key| key.name == name);
        for unknown in table.keys().filter(|name| !is_known(name)) {
            let fault = self.unknown_key(unknown, keys, prefix);
            self.faults.push(fault);
        }
        for key in keys {
            let full = format!("{prefix}{}", key.name);
            if let (Accepts::Section(_), Absent::Refused) = (&key.accepts, &key.absent) {
                // Its keys say whether they may be absent.
                table.entry(key.name).or_insert(Value::Table(Table::new()));
            }
            match (table.get_mut(key.name), &key.absent) {
                (Some(value), _) => self.value(value, key, &key.accepts, &full),
                (None, Absent::Refused) => {
                    let why = lowered(&key.why);
                    self.faults.push(format!("`{full}` is missing: {why}"));
                }
                (None, Absent::Nothing) => {}
                (None, Absent::Is(default)) => {
                    table.insert(key.name.to_owned(), value_of(default));
                }
            }
        }
    }

    /// Checks a value, and what is in it.
    fn value(&mut self, value: &mut Value, key: &Key, accepts: &Accepts, full: &str) {
        match (value, accepts) {
            (Value::Table(inner), Accepts::Section(keys)) => {
                self.section(inner, keys, &format!("{full}."));
            }
            (Value::Array(all), Accepts::List(None, one)) if one.keys().is_some() => {
                for (index, value) in all.iter_mut().enumerate() {
                    self.value(value, key, one, &format!("{full}[{index}]"));
                }
            }
            (value, accepts) if !accepts.takes(value) => {
                let expected = accepts.expected(unit(full));
                let why = lowered(&key.why);
                self.faults
                    .push(format!("`{full}` is `{value}`; expected {expected}: {why}"));
            }
            _ => {}
        }
    }

    /// Words the fault of an unknown key, with the name that was probably meant.
    fn unknown_key(&self, found: &str, keys: &[Key], prefix: &str) -> String {
        let here = || keys.iter().map(|key| key.name);
        let is_meant = |path: &&String| path.rsplit('.').next() == Some(found);
        let elsewhere = self.paths.iter().find(is_meant).cloned();
        let near = || nearest(found, here()).map(|name| format!("{prefix}{name}"));
        let mut text = format!("`{prefix}{found}` is not a setting");
        match elsewhere.or_else(near) {
            Some(meant) => _ = write!(text, "; did you mean `{meant}`?"),
            None => {
                _ = write!(
                    text,
                    "; here may stand {}",
                    fab_base::wording::quoted(here())
                )
            }
        }
        text
    }
}

fn value_of(default: &str) -> Value {
    let mut table: Table =
        toml::from_str(&format!("it = {default}")).expect("a test reads every default");
    table.remove("it").expect("it stands there")
}

/// Returns a sentence as a part of another.
fn lowered(sentence: &str) -> String {
    let mut letters = sentence.trim_end_matches('.').chars();
    let first = letters.next().into_iter().flat_map(char::to_lowercase);
    first.chain(letters.as_str().chars()).collect()
}

/// Returns the unit of a key's numbers, after a blank; empty for none.
fn unit(full: &str) -> String {
    let unit = UNITS.iter().find(|(end, _)| full.ends_with(end));
    unit.map_or_else(String::new, |(_, unit)| format!(" {unit}"))
}

impl Values {
    fn holds(self, number: f64) -> bool {
        // NaN must be refused.
        (self.least < number || self.is_closed && self.least == number) && number <= self.most
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
            (Accepts::Text(begins), Value::String(text)) => {
                text.starts_with(begins) && !text.trim().is_empty()
            }
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

    /// Words the values that are accepted.
    fn expected(&self, unit: String) -> String {
        let range = |values: &Values| {
            let Values { least, most, .. } = values;
            if values.is_closed {
                format!("{least} to {most}{unit}")
            } else {
                format!("above {least} and at most {most}{unit}")
            }
        };
        match self {
            Accepts::Text("") => "a text".to_owned(),
            Accepts::Text(begins) => format!("a text that begins with `{begins}`"),
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
    /// - `why`: the lines of its comment.
    pub(crate) fn of<T: Setting>(
        name: &'static str,
        default: Option<&'static str>,
        values: Option<Values>,
        why: &[&str],
    ) -> Key {
        let absent = match default {
            Some(default) => Absent::Is(default),
            None if T::IS_OPTIONAL => Absent::Nothing,
            None => Absent::Refused,
        };
        let why: Vec<&str> = why.iter().map(|line| line.trim()).collect();
        Key {
            name,
            accepts: T::accepts(values.unwrap_or(ANY)),
            absent,
            why: why.join(" "),
        }
    }
}

#[cfg(test)]
mod tests;
