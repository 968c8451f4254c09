//! The properties of a material: one row each.
//!
//! Ranges exclude typing errors and confused units: the lightest silks weigh about 15 g/m2, the heaviest canvas about
//! 1000. What the simulator can show of them depends on its grid; it says so when a cloth is laid.

use fab_program::data::material::Directions;
use fab_program::vocabulary::{Arg, Args, Call, Kind, Range, Signature};
use fab_program::{Face, Material};

/// A property of a material.
pub(crate) struct Property {
    /// Its line, and what stores its values.
    pub call: Call<fn(&mut Material, &Args)>,
    /// The face that it is the colour of, if it is one. A colour is followed by its red, green and blue, is optional,
    /// and needs no source.
    pub face: Option<Face>,
}

/// The three directions, each with a value of this kind.
macro_rules! directions {
    ($kind:expr) => {
        &[
            Arg::named(
                "warp",
                $kind,
                "along the cloth's first side, from left to right",
            ),
            Arg::named("weft", $kind, "along its second side, from back to front"),
            Arg::named("bias", $kind, "at 45 degrees to both"),
        ]
    };
}

/// The properties, in the order of the reference.
pub(crate) const PROPERTIES: &[Property] = &[
    measured(
        "weight",
        &[Arg::positional(
            "weight",
            Kind::Quantity(Range::new("a weight", (10.0, "g/m2"), (2000.0, "g/m2"))),
            "mass per area",
        )],
        "how heavy it is (ISO 3801)",
        |material, args| material.weight_kg_m2 = tidy(args.number("weight")),
    ),
    measured(
        "thickness",
        &[Arg::positional(
            "thickness",
            Kind::Quantity(Range::new("a thickness", (0.05, "mm"), (20.0, "mm"))),
            "of one layer",
        )],
        "how thick it is (ISO 5084)",
        |material, args| material.thickness_m = tidy(args.number("thickness")),
    ),
    measured(
        "bending",
        directions!(Kind::Quantity(Range::new(
            "a bending length",
            (5.0, "mm"),
            (100.0, "mm")
        ))),
        "its bending length: half of the overhang whose end lies 41.5 degrees below its edge (ASTM D1388)",
        |material, args| material.bending_length_m = along(args),
    ),
    measured(
        "recovery",
        &[Arg::positional(
            "angle",
            Kind::Quantity(Range::new("an angle", (0.0, "deg"), (180.0, "deg"))),
            "180deg lies flat again, 0deg stays folded",
        )],
        "the angle to which a pressed fold opens (ISO 2313)",
        |material, args| material.crease_recovery_deg = tidy(args.number("angle").to_degrees()),
    ),
    measured(
        "stretch",
        directions!(Kind::Quantity(Range::plain("a fraction", 0.0, 0.5))),
        "how much longer it gets, as a fraction: under 98.1 N per metre of width along its threads, under 4.9 on the bias (FAST, E100 and EB5)",
        |material, args| material.stretch = along(args),
    ),
    measured(
        "friction",
        &[
            Arg::named("table", FRICTION, "on the table"),
            Arg::named("itself", FRICTION, "of one layer on another"),
        ],
        "its coefficients of friction",
        |material, args| {
            material.table_friction = args.number("table");
            material.self_friction = args.number("itself");
        },
    ),
    colour(
        "upper",
        Face::Upper,
        "the face that is up when the cloth lies flat at the start; without it, that of `pyflex`",
        |material, args| material.upper.name = args.name("colour"),
    ),
    colour(
        "under",
        Face::Under,
        "the other face; without it, that of `pyflex`",
        |material, args| material.under.name = args.name("colour"),
    ),
];

const FRICTION: Kind = Kind::Quantity(Range::plain("a coefficient of friction", 0.0, 3.0));

fn along(args: &Args) -> Directions {
    let [warp, weft, bias] = ["warp", "weft", "bias"].map(|name| tidy(args.number(name)));
    Directions { warp, weft, bias }
}

/// Rounds to 12 digits: `21mm` is 0.021 m, however it was converted.
fn tidy(number: f64) -> f64 {
    (number * 1e12).round() / 1e12
}

const fn measured(
    name: &'static str,
    args: &'static [Arg],
    doc: &'static str,
    set: fn(&mut Material, &Args),
) -> Property {
    Property {
        call: Call::new(name, "a property", args, doc, set),
        face: None,
    }
}

const fn colour(
    name: &'static str,
    face: Face,
    doc: &'static str,
    set: fn(&mut Material, &Args),
) -> Property {
    const NAME: &[Arg] = &[Arg::positional(
        "colour",
        Kind::ColourName,
        "what prompts call it; behind it, in quotes, its red, green and blue",
    )];
    let property = measured(name, NAME, doc, set);
    Property {
        face: Some(face),
        ..property
    }
}

/// Writes how a property is written: `friction table: …, itself: … from "…"`.
pub(crate) fn form(signature: &Signature) -> String {
    let call = signature.form();
    let line = call.trim_end_matches(')').replacen('(', " ", 1);
    let is_colour = PROPERTIES
        .iter()
        .any(|row| row.call.signature.name == signature.name && row.face.is_some());
    if is_colour {
        format!("{line} \"#RRGGBB\"")
    } else {
        format!("{line} from \"…\"")
    }
}
