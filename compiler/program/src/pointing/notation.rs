//! The points of one scene, as a model sees them.

use super::{CoordinateUnit, Frame, Order, Pointing};
use crate::data::actions::{ActionField, Value};
use crate::data::camera::{Camera, PixelPoint};
use crate::scene::SceneView;
use crate::space;

/// The most digits added to tell offered points apart; a picture has fewer than 10,000 pixels a side.
const MORE_DECIMALS: u32 = 5;

/// The most offered values that a message lists.
const MAX_LISTED: usize = 30;

/// How near two numbers must be to count as the same, in steps of the last written digit.
const SAME: f64 = 1e-3;

/// Writes and reads the points of one scene.
///
/// Every offered point reads back as itself, however coarse the frame is. If two would be written alike, all points
/// get more digits.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Notation {
    pointing: Pointing,
    /// The points that the action's fields offer, each once; empty if points are pixels of the camera's picture.
    offered: Vec<PixelPoint>,
    decimals: u32,
}

impl Notation {
    /// Makes the notation of a scene and numbers its offered points.
    pub fn of(pointing: Pointing, actions: &[ActionField], scene: &dyn SceneView) -> Notation {
        if pointing.is_native() {
            return Notation::pixels();
        }
        let values = actions
            .iter()
            .filter(|field| field.is_point())
            .flat_map(|field| space::choices(field, scene));
        Notation::offering(pointing, values)
    }

    /// Makes the notation of pixels in which tasks are written; it needs no scene.
    pub fn pixels() -> Notation {
        Notation {
            pointing: Pointing::pixels([1, 1]),
            offered: Vec::new(),
            decimals: 0,
        }
    }

    /// Returns the notation in pixels of a camera's picture.
    pub(crate) fn pixels_of(camera: &Camera) -> Notation {
        Notation {
            pointing: Pointing::pixels([camera.image_px; 2]),
            ..Notation::pixels()
        }
    }

    fn offering(pointing: Pointing, values: impl Iterator<Item = Value>) -> Notation {
        let mut offered: Vec<PixelPoint> = Vec::new();
        for value in values {
            if let Value::Point(point) = value
                && !offered.contains(&point)
            {
                offered.push(point);
            }
        }
        let frame = pointing.frame();
        let least = frame.unit.decimals();
        let tells_apart = |decimals: &u32| {
            let mut written: Vec<_> = offered
                .iter()
                .map(|point| frame.scaled(*point, *decimals))
                .collect();
            written.sort_unstable();
            written.windows(2).all(|pair| pair[0] != pair[1])
        };
        let decimals = (least..least + MORE_DECIMALS).find(tells_apart);
        Notation {
            pointing,
            decimals: decimals.unwrap_or(least + MORE_DECIMALS),
            offered,
        }
    }

    /// Returns how points are written.
    pub fn pointing(&self) -> &Pointing {
        &self.pointing
    }

    /// Returns the offered points in the order of their numbers, if points are numbered.
    pub fn marks(&self) -> &[PixelPoint] {
        match self.pointing {
            Pointing::Marks(_) => &self.offered,
            Pointing::Frame(_) => &[],
        }
    }

    /// Writes a point as prompts do: `(41, 167)`; `3 at (41, 167)` if it is numbered.
    pub fn written(&self, point: PixelPoint) -> String {
        let place = self.place(point);
        match self.number(point) {
            Some(number) => format!("{number} at {place}"),
            None => place,
        }
    }

    /// Writes a point as answers state it: `(41, 167)`, or `3` if it is numbered.
    pub fn stated(&self, point: PixelPoint) -> String {
        match self.number(point) {
            Some(number) => number.to_string(),
            None => self.place(point),
        }
    }

    /// Writes a field's value as prompts list it.
    pub fn value(&self, field: &ActionField, value: &Value) -> String {
        match value {
            Value::Point(point) => self.written(*point),
            _ => space::text(field, value),
        }
    }

    /// Writes a field's value as answers state it.
    pub fn stated_value(&self, field: &ActionField, value: &Value) -> String {
        match value {
            Value::Point(point) => self.stated(*point),
            _ => space::text(field, value),
        }
    }

    /// Lists values as prompts do.
    pub fn listed(&self, field: &ActionField, values: &[Value]) -> String {
        let texts: Vec<String> = values
            .iter()
            .map(|value| self.value(field, value))
            .collect();
        texts.join(", ")
    }

    /// Lists as many values as a message to a model can hold, and says how many more there are.
    pub fn shortened(&self, field: &ActionField, values: &[Value]) -> String {
        let mut text = self.listed(field, &values[..values.len().min(MAX_LISTED)]);
        if values.len() > MAX_LISTED {
            text.push_str(&format!(" and {} more", values.len() - MAX_LISTED));
        }
        text
    }

    /// Rewrites these points in a text from pixels to this notation.
    pub fn retold(&self, text: &str, points: &[PixelPoint]) -> String {
        let mut retold = String::with_capacity(text.len());
        let mut rest = text;
        while let Some(at) = rest.find('(') {
            retold.push_str(&rest[..at]);
            rest = &rest[at..];
            let known = points
                .iter()
                .find(|point| rest.starts_with(&point.to_string()));
            let (written, length) = match known {
                Some(point) => (self.written(*point), point.to_string().len()),
                None => ("(".to_owned(), 1),
            };
            retold.push_str(&written);
            rest = &rest[length..];
        }
        retold + rest
    }

    /// Returns the pixel that the coordinates x and y mean: an offered point that is written like this, otherwise the
    /// pixel that contains the position.
    pub(crate) fn pixel(&self, x: f64, y: f64) -> PixelPoint {
        let frame = self.frame();
        let scale = 10_f64.powi(self.decimals as i32);
        let is_written = |point: &&PixelPoint| {
            let [of_x, of_y] = frame.scaled(**point, self.decimals);
            (x * scale - of_x as f64).abs() < SAME && (y * scale - of_y as f64).abs() < SAME
        };
        match self.offered.iter().find(is_written) {
            Some(point) => *point,
            None => frame.pixel(x, y),
        }
    }

    /// Returns the point with that number, from 1.
    pub(crate) fn marked(&self, number: usize) -> Option<PixelPoint> {
        self.marks().get(number.checked_sub(1)?).copied()
    }

    pub(crate) fn is_native(&self) -> bool {
        self.pointing.is_native()
    }

    pub(crate) fn is_of_marks(&self) -> bool {
        matches!(self.pointing, Pointing::Marks(_))
    }

    pub(crate) fn unit(&self) -> CoordinateUnit {
        self.frame().unit
    }

    pub(crate) fn order(&self) -> Order {
        self.frame().order
    }

    fn frame(&self) -> &Frame {
        self.pointing.frame()
    }

    fn number(&self, point: PixelPoint) -> Option<usize> {
        let index = self.marks().iter().position(|known| *known == point)?;
        Some(index + 1)
    }

    fn place(&self, point: PixelPoint) -> String {
        self.frame().write_to(point, self.decimals)
    }
}
