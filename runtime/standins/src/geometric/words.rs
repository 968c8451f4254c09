//! One fold in words, written and read.
//!
//! In and out: an [`Instruction`] and its sentence. The sentence names places by the rectangle around the cloth: its
//! sides and ends by compass words (`left`, `upper right`), everything between by eighths. It holds no coordinates and
//! no lengths. `super::frame` locates the rectangle.

use std::fmt;

/// A direction in the picture, in steps of 45 degrees counter-clockwise from the right.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Compass(u8);

const COMPASS: [&str; 8] = [
    "right",
    "upper right",
    "top",
    "upper left",
    "left",
    "lower left",
    "bottom",
    "lower right",
];

impl Compass {
    /// Returns the direction nearest to an angle, radians counter-clockwise from the right.
    pub fn nearest(angle: f64) -> Compass {
        let steps = (angle / std::f64::consts::FRAC_PI_4).round();
        Compass(steps.rem_euclid(8.0) as u8 % 8)
    }

    /// Returns the direction's angle, radians counter-clockwise from the right.
    pub fn angle(self) -> f64 {
        f64::from(self.0) * std::f64::consts::FRAC_PI_4
    }

    fn turned(self, steps: u8) -> Compass {
        Compass((self.0 + steps) % 8)
    }

    /// Returns the opposite direction.
    pub fn opposite(self) -> Compass {
        self.turned(4)
    }

    /// Returns whether the direction points right or, failing that, straight up; its opposite then does not.
    pub fn is_in_reading_order(self) -> bool {
        matches!(self.0, 0..=2 | 7)
    }
}

impl fmt::Display for Compass {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(COMPASS[usize::from(self.0 % 8)])
    }
}

/// A place on the cloth, in the frame of the instruction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Spot {
    /// The middle of the whole cloth.
    Center,
    /// Eighths along the frame's heading and across it, each 0 to 8.
    At {
        /// From the end behind to the end ahead.
        along: u8,
        /// From the side to the right of the heading to the side to its left.
        across: u8,
    },
}

/// Whether the rectangle around the cloth has long sides.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sides {
    /// The heading runs along a long side.
    Long,
    /// All sides count as equal.
    Equal,
}

/// One fold: its pick, its place, and how to identify the sides of the cloth.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Instruction {
    /// The point to pick.
    pub pick: Spot,
    /// The point to place it on.
    pub place: Spot,
    /// The direction in the picture that counts as `along`.
    pub heading: Compass,
    /// Whether the heading is identified by the cloth's longer side.
    pub sides: Sides,
    /// Corners of the rectangle that the cloth does not reach, in the order of `super::frame::CORNERS`.
    pub bare: [bool; 4],
}

impl fmt::Display for Instruction {
    /// Writes one sentence without a full stop.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "Pick {} and place it on {}",
            self.spot(self.pick),
            self.spot(self.place)
        )?;
        let corners = [(0, 0), (8, 0), (8, 8), (0, 8)];
        let bare: Vec<String> = corners
            .into_iter()
            .zip(self.bare)
            .filter(|&(_, is_bare)| is_bare)
            .map(|((along, across), _)| self.spot(Spot::At { along, across }))
            .collect();
        if bare.is_empty() {
            return Ok(());
        }
        write!(f, "; the cloth does not reach {}", bare.join(", nor "))
    }
}

/// Counts of eighths that are neither a side nor the middle.
const EIGHTHS: [(u8, &str); 6] = [
    (1, "one eighth"),
    (2, "one quarter"),
    (3, "three eighths"),
    (5, "five eighths"),
    (6, "three quarters"),
    (7, "seven eighths"),
];

fn eighths_in_words(count: u8) -> &'static str {
    EIGHTHS
        .iter()
        .find(|&&(eighths, _)| eighths == count)
        .map_or("the whole", |&(_, words)| words)
}

impl Instruction {
    fn spot(&self, spot: Spot) -> String {
        let Spot::At { along, across } = spot else {
            return "the center of the cloth".to_owned();
        };
        let (ahead, behind) = (self.heading, self.heading.opposite());
        let (left, right) = (ahead.turned(2), behind.turned(2));
        let side = match self.sides {
            Sides::Long => "long side",
            Sides::Equal => "side",
        };
        let line = match across {
            0 => format!("the {right} {side}"),
            8.. => format!("the {left} {side}"),
            4 => format!("the middle line between the {right} and the {left} {side}"),
            n => format!(
                "the line {} from the {right} to the {left} {side}",
                eighths_in_words(n)
            ),
        };
        match along {
            0 => format!("the {behind} end of {line}"),
            8.. => format!("the {ahead} end of {line}"),
            4 => format!("the middle of {line}"),
            n => format!(
                "the point {} from the {behind} to the {ahead} end of {line}",
                eighths_in_words(n)
            ),
        }
    }

    /// Reads a sentence as [`Instruction`] writes it, and simpler ones such as `pick the top left corner and place it
    /// on the center`.
    ///
    /// `None` if it names no pick and place, or its directions contradict each other.
    pub fn read(sentence: &str) -> Option<Instruction> {
        let sentence = sentence.to_lowercase();
        let (fold, rest) = sentence.split_once(';').unwrap_or((&sentence, ""));
        let (_, picked) = fold.split_once("pick")?;
        let (picked, placed) = picked.split_once("place")?;
        let spots = [DescribedPlace::read(picked)?, DescribedPlace::read(placed)?];
        let bare: Vec<DescribedPlace> = match rest.split_once("does not reach") {
            Some((_, list)) => list.split("nor").filter_map(DescribedPlace::read).collect(),
            None => Vec::new(),
        };
        let heading = spots
            .iter()
            .chain(&bare)
            .find_map(DescribedPlace::heading)?;
        let mut is_bare = [false; 4];
        for told in &bare {
            let Spot::At { along, across } = told.spot(heading)? else {
                return None;
            };
            let corner = [(0, 0), (8, 0), (8, 8), (0, 8)]
                .iter()
                .position(|&c| c == (along, across))?;
            is_bare[corner] = true;
        }
        let is_long = fold.contains("long side") || fold.contains("longer side");
        Some(Instruction {
            pick: spots[0].spot(heading)?,
            place: spots[1].spot(heading)?,
            heading,
            sides: if is_long { Sides::Long } else { Sides::Equal },
            bare: is_bare,
        })
    }
}

/// A place as described by a phrase, before all directions of a sentence are known.
#[derive(Clone, Copy, Debug, PartialEq)]
enum DescribedPlace {
    Center,
    /// The corner in that direction from the middle.
    Corner(Compass),
    Crossing {
        along: AxisFraction,
        across: AxisFraction,
    },
}

/// A fraction of the distance from one side of the frame to the opposite one.
#[derive(Clone, Copy, Debug, PartialEq)]
struct AxisFraction {
    /// The target side, if the phrase names one.
    towards: Option<Compass>,
    eighths: u8,
}

impl DescribedPlace {
    fn read(phrase: &str) -> Option<DescribedPlace> {
        if let Some((point, line)) = phrase
            .split_once("end of")
            .or(phrase.split_once("middle of"))
        {
            let along = if phrase.contains("end of") {
                AxisFraction::read(point)?
            } else {
                AxisFraction::MIDDLE
            };
            return Some(DescribedPlace::Crossing {
                along,
                across: AxisFraction::read(line)?,
            });
        }
        if phrase.contains("corner") {
            return directions(phrase)
                .first()
                .map(|&corner| DescribedPlace::Corner(corner));
        }
        (phrase.contains("center") || phrase.contains("centre") || phrase.contains("middle"))
            .then_some(DescribedPlace::Center)
    }

    /// The heading that this phrase implies, oriented to point right or straight up.
    fn heading(&self) -> Option<Compass> {
        let heading = match *self {
            DescribedPlace::Center => return None,
            // Between two sides: one step back from the corner's direction.
            DescribedPlace::Corner(corner) => corner.turned(7),
            DescribedPlace::Crossing { along, across } => match (along.towards, across.towards) {
                (Some(ahead), _) => ahead,
                (None, Some(left)) => left.turned(6),
                (None, None) => return None,
            },
        };
        // A corner does not tell which of its two sides is meant; take the one that runs more to the right.
        let heading = match self {
            DescribedPlace::Corner(_) if matches!(heading.0, 2 | 3 | 6) => heading.turned(6),
            _ => heading,
        };
        Some(if heading.is_in_reading_order() {
            heading
        } else {
            heading.opposite()
        })
    }

    fn spot(&self, heading: Compass) -> Option<Spot> {
        match *self {
            DescribedPlace::Center => Some(Spot::Center),
            DescribedPlace::Corner(corner) => {
                let (along, across) = match (corner.0 + 8 - heading.0) % 8 {
                    1 => (8, 8),
                    3 => (0, 8),
                    5 => (0, 0),
                    7 => (8, 0),
                    _ => return None,
                };
                Some(Spot::At { along, across })
            }
            DescribedPlace::Crossing { along, across } => Some(Spot::At {
                along: along.seen_along(heading)?,
                across: across.seen_along(heading.turned(2))?,
            }),
        }
    }
}

impl AxisFraction {
    const MIDDLE: AxisFraction = AxisFraction {
        towards: None,
        eighths: 4,
    };

    /// Reads `the left`, `the top long side`, `the line one quarter from the left to the right side`.
    fn read(phrase: &str) -> Option<AxisFraction> {
        let named = directions(phrase);
        if phrase.contains("middle") {
            return Some(AxisFraction {
                towards: named.get(1).copied(),
                eighths: 4,
            });
        }
        let fraction = EIGHTHS.iter().find(|(_, words)| phrase.contains(words));
        match (fraction, named.as_slice()) {
            (Some(&(eighths, _)), [_, towards, ..]) => Some(AxisFraction {
                towards: Some(*towards),
                eighths,
            }),
            (None, [towards, ..]) => Some(AxisFraction {
                towards: Some(*towards),
                eighths: 8,
            }),
            _ => None,
        }
    }

    /// The same fraction counted in the direction `axis`; `None` if the phrase used another axis.
    fn seen_along(self, axis: Compass) -> Option<u8> {
        match self.towards {
            None => Some(self.eighths),
            Some(towards) if towards == axis => Some(self.eighths),
            Some(towards) if towards == axis.opposite() => Some(8 - self.eighths),
            Some(_) => None,
        }
    }
}

/// The compass words of a phrase in order; an adjacent vertical and horizontal word form one direction.
fn directions(phrase: &str) -> Vec<Compass> {
    let mut found = Vec::new();
    let mut upright: Option<Compass> = None;
    for word in phrase
        .split(|c: char| !c.is_alphanumeric())
        .filter(|word| !word.is_empty())
    {
        let level = match word {
            "top" | "upper" | "bottom" | "lower" => {
                found.extend(upright.take());
                upright = Some(Compass(if matches!(word, "top" | "upper") {
                    2
                } else {
                    6
                }));
                continue;
            }
            "right" => Some(Compass(0)),
            "left" => Some(Compass(4)),
            _ => None,
        };
        match (level, upright.take()) {
            (Some(level), Some(upright)) => found.push(between(upright, level)),
            (Some(level), None) => found.push(level),
            (None, pending) => found.extend(pending),
        }
    }
    found.extend(upright);
    found
}

fn between(upright: Compass, level: Compass) -> Compass {
    Compass(match (upright.0, level.0) {
        (2, 0) => 1,
        (2, _) => 3,
        (_, 4) => 5,
        _ => 7,
    })
}
