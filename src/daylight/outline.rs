//! Areas in a plane: polygons with holes.
//!
//! Booleans are by `i_overlay`, whose coordinates are whole numbers of 64 bits: exact but for rounding to some 1e-12 of the extent.

use glam::DVec2;
use i_overlay::core::fill_rule::FillRule;
use i_overlay::core::overlay_rule::OverlayRule;
use i_overlay::float::simplify::SimplifyShape;
use i_overlay::float::single::SingleFloatOverlay;
use std::f64::consts::PI;

/// A polygon's corners [m], closed by themselves.
type Contour = Vec<[f64; 2]>;

/// A connected area: its outer contour counter-clockwise, then its holes clockwise.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Shape(Vec<Contour>);

/// Connected areas, none of which overlap.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Outline(Vec<Shape>);

/// What is smaller than this is no area but rounding [m2].
const LEAST: f64 = 1e-9;

/// Sides of a half circle.
const SIDES: u32 = 12;

fn area(contour: &[[f64; 2]]) -> f64 {
    let next = contour.iter().cycle().skip(1);
    let twice: f64 = (contour.iter().zip(next))
        .map(|(a, b)| a[0] * b[1] - b[0] * a[1])
        .sum();
    0.5 * twice
}

impl Shape {
    /// One contour, in either sense.
    pub fn of_contour(corners: Vec<DVec2>) -> Self {
        Shape(vec![corners.into_iter().map(DVec2::into).collect()])
    }

    /// Its contours: the outer one, then holes.
    pub fn contours(&self) -> impl Iterator<Item = &[[f64; 2]]> {
        self.0.iter().map(Vec::as_slice)
    }

    /// Its area [m2].
    pub fn area(&self) -> f64 {
        self.0.iter().map(|contour| area(contour)).sum()
    }
}

impl Outline {
    fn of(shapes: Vec<Vec<Contour>>) -> Self {
        let shapes = shapes.into_iter().map(Shape);
        Outline(shapes.filter(|shape| shape.area() > LEAST).collect())
    }

    /// What polygons cover together, whatever their sense.
    pub fn union(polygons: impl IntoIterator<Item = Vec<DVec2>>) -> Self {
        let contours = polygons.into_iter().map(|corners| {
            let mut contour: Contour = corners.into_iter().map(DVec2::into).collect();
            if area(&contour) < 0.0 {
                contour.reverse();
            }
            contour
        });
        let contours: Vec<Contour> = contours.collect();
        Outline::of(contours.simplify_shape_as::<i64>(FillRule::NonZero))
    }

    /// Its connected areas.
    pub fn shapes(&self) -> &[Shape] {
        &self.0
    }

    /// One of its connected areas alone.
    pub fn only(&self, shape: usize) -> Self {
        Outline(vec![self.0[shape].clone()])
    }

    /// Whether there is no area.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Its area [m2].
    pub fn area(&self) -> f64 {
        self.0.iter().map(Shape::area).sum()
    }

    /// All sides of all contours [m].
    pub fn sides(&self) -> impl Iterator<Item = [DVec2; 2]> {
        self.0.iter().flat_map(Shape::contours).flat_map(|contour| {
            let next = contour.iter().cycle().skip(1);
            contour
                .iter()
                .zip(next)
                .map(|(a, b)| [DVec2::from(*a), DVec2::from(*b)])
        })
    }

    /// The least box around it [m]; `None` without an area.
    pub fn bounds(&self) -> Option<[DVec2; 2]> {
        let mut corners = self.sides().map(|side| side[0]);
        let first = corners.next()?;
        Some(corners.fold([first; 2], |[low, high], p| [low.min(p), high.max(p)]))
    }

    /// Whether a place lies in it.
    pub fn contains(&self, place: DVec2) -> bool {
        let crosses = |[a, b]: [DVec2; 2]| {
            (a.y > place.y) != (b.y > place.y)
                && place.x < a.x + (b.x - a.x) * (place.y - a.y) / (b.y - a.y)
        };
        self.sides().filter(|side| crosses(*side)).count() % 2 == 1
    }

    /// The part of it that lies in a shape.
    pub fn within(&self, shape: &Shape) -> Self {
        self.with(std::slice::from_ref(shape), OverlayRule::Intersect)
    }

    /// What is left of it without another.
    pub fn without(&self, other: &Outline) -> Self {
        self.with(&other.0, OverlayRule::Difference)
    }

    fn with(&self, other: &[Shape], rule: OverlayRule) -> Self {
        let plain = |shapes: &[Shape]| -> Vec<Vec<Contour>> {
            shapes.iter().map(|shape| shape.0.clone()).collect()
        };
        let [own, other] = [&self.0, other].map(plain);
        Outline::of(own.overlay_as::<i64>(&other, rule, FillRule::EvenOdd))
    }

    /// What lies no farther from line segments than `reach` [m], above 0; ends are rounded.
    pub fn around(segments: impl IntoIterator<Item = [DVec2; 2]>, reach: f64) -> Self {
        let around = |[a, b]: [DVec2; 2]| {
            let along = (b - a).normalize_or(DVec2::X);
            let start = along.y.atan2(along.x) - 0.5 * PI;
            let half = |at: DVec2, from: f64| {
                (0..=SIDES).map(move |i| {
                    let angle = from + PI * f64::from(i) / f64::from(SIDES);
                    at + reach * DVec2::from_angle(angle)
                })
            };
            half(b, start)
                .chain(half(a, start + PI))
                .collect::<Vec<_>>()
        };
        Outline::union(segments.into_iter().map(around))
    }

    /// The same area in other coordinates, which are turned and moved against these but not mirrored.
    pub fn mapped(&self, to: impl Fn(DVec2) -> DVec2) -> Self {
        let contour = |contour: &Contour| contour.iter().map(|p| to((*p).into()).into()).collect();
        let shape = |shape: &Shape| Shape(shape.0.iter().map(contour).collect());
        Outline(self.0.iter().map(shape).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::dvec2;

    fn rectangle(low: [f64; 2], high: [f64; 2]) -> Vec<DVec2> {
        vec![
            dvec2(low[0], low[1]),
            dvec2(high[0], low[1]),
            dvec2(high[0], high[1]),
            dvec2(low[0], high[1]),
        ]
    }

    #[test]
    fn areas_add_up() {
        // An L of three overlapping parts, one of them the other way round.
        let mut turned = rectangle([0.0, 0.0], [2.0, 4.0]);
        turned.reverse();
        let parts = [
            rectangle([0.0, 0.0], [4.0, 2.0]),
            turned,
            rectangle([1.0, 1.0], [2.0, 2.0]),
        ];
        let l = Outline::union(parts);
        assert_eq!(l.shapes().len(), 1);
        assert!((l.area() - 12.0).abs() < 1e-9, "{}", l.area());
        assert!(l.contains(dvec2(0.5, 3.5)) && !l.contains(dvec2(3.0, 3.0)));
        let cell = Shape::of_contour(rectangle([1.0, 1.0], [3.0, 3.0]));
        assert!((l.within(&cell).area() - 3.0).abs() < 1e-9);
        // A band of half a metre along all walls: at the inner corner it is a quarter disc, of 12 sides a half.
        let band = Outline::around(l.sides(), 0.5);
        let left = l.without(&band);
        let disc = 0.25 * (PI - f64::from(2 * SIDES) * 0.5 * (PI / f64::from(SIDES)).sin()) * 0.25;
        let exact = 3.0 * 1.0 + 1.0 * 2.0 + 0.25 - 0.25 * 0.25 * PI + disc;
        assert!(
            (left.area() - exact).abs() < 1e-6,
            "{} {exact}",
            left.area()
        );
        assert!(left.without(&left).is_empty());
        // A hole is no part of it.
        let ring = Outline::union([rectangle([0.0, 0.0], [4.0, 4.0])])
            .without(&Outline::union([rectangle([1.0, 1.0], [2.0, 2.0])]));
        assert!((ring.area() - 15.0).abs() < 1e-9 && !ring.contains(dvec2(1.5, 1.5)));
        assert!((ring.mapped(|p| p + dvec2(9.0, 9.0)).area() - 15.0).abs() < 1e-9);
    }
}
