//! Enumerations whose variants have names, in files and in messages alike.

/// Declares an enumeration and writes each name once. The enumeration must derive `Copy`, and `Serialize` or
/// `Deserialize`.
///
/// ```
/// fab_base::named! {
///     /// A side of a cloth.
///     #[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
///     pub enum Side {
///         /// The one that faces up.
///         Upper = "upper",
///         /// The other.
///         Under = "under",
///     }
/// }
///
/// assert_eq!(Side::ALL.map(Side::name), ["upper", "under"]);
/// assert_eq!(serde_json::to_value(Side::Upper)?, Side::Upper.name());
/// # Ok::<(), serde_json::Error>(())
/// ```
#[macro_export]
macro_rules! named {
    (
        $(#[$of_all:meta])*
        $visible:vis enum $Enum:ident { $($(#[$of_one:meta])* $Variant:ident = $name:literal),* $(,)? }
    ) => {
        $(#[$of_all])*
        $visible enum $Enum { $($(#[$of_one])* #[serde(rename = $name)] $Variant),* }

        impl $Enum {
            /// Lists all of them, in the order of their declaration.
            $visible const ALL: [$Enum; [$($name),*].len()] = [$($Enum::$Variant),*];

            /// Returns the name in files and messages.
            $visible const fn name(self) -> &'static str {
                match self { $($Enum::$Variant => $name),* }
            }
        }
    };
}
