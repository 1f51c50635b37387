//! Bounds on the depth of an indentation from geometry and break strains.

use std::f64::consts::PI;

use super::loading::Indent;
use super::{Checker, Face, Hold, Impactor, ImpactorShape, Loading, Model, Symmetry};
use crate::mesh::{Outline, Side};

const DEPTH: &str = "loading.indent.depth";

/// Depth over the span of the film above which its unit is probably wrong, where no break strain bounds it.
const SPANS: f64 = 3.0;

/// Refuses a depth at which the film would break even if it were strained uniformly, and one at which the impactor
/// would reach the frame; neither on springs, which give way, and the first not of film that may slip in its clamp.
pub(super) fn check(model: &Model, checker: &mut Checker<'_>) {
    let (Loading::Indent(Indent { depth, .. }), Some(impactor)) = (&model.loading, model.impactor()) else { return };
    // What follows is of an upright impactor.
    if impactor.orientation != [0.0; 3] {
        return;
    }
    let spans = Spans {
        shape: &model.specimen.shape,
        hold: &model.frame.hold,
        from: impactor.position,
        symmetry: model.specimen.symmetry,
    };
    if spans.is_beside() {
        let hint = "the position of its axis is measured from the centre of the specimen";
        checker.report_with("impactor.position", "the impactor passes beside the film", hint);
        return;
    }
    let (is_on_springs, is_clamped) = (model.frame.springs.is_some(), model.frame.clamp.is_some());
    if let Some(limit) = frame_depth(impactor, &spans).filter(|limit| depth > limit && !is_on_springs) {
        let hint = format!("it reaches the frame at {}", millimetres(limit));
        checker.report_with(DEPTH, "the impactor reaches the frame before this depth", hint);
    }
    for face in model.faces.iter().filter(|_| !is_on_springs && !is_clamped) {
        // The others lie below the first face.
        let before = model.faces[0].height - face.height;
        for (fibre, name) in ["MD", "TD"].into_iter().enumerate() {
            let Some(limit) = breaking_depth(face, fibre, &spans).filter(|limit| *depth > before + limit) else {
                continue;
            };
            let hint = format!("strained evenly from edge to edge, {name} breaks at {}", millimetres(before + limit));
            checker.report_with(DEPTH, "the film breaks before this depth", hint);
            return;
        }
    }
    if let Some(span) = spans.narrowest().filter(|span| *depth > SPANS * span) {
        let hint = format!("the film spans {}; a bare number is in m", millimetres(span));
        checker.report_with(DEPTH, format!("deeper than {SPANS} times the span of the film"), hint);
    }
}

/// A depth in mm, rounded down to four digits.
fn millimetres(length: f64) -> String {
    let millimetres = 1e3 * length.max(1e-9);
    let digits = 10.0_f64.powf(3.0 - millimetres.log10().floor());
    format!("{} mm", (millimetres * digits).floor() / digits)
}

/// Straight lines on the film from below the impactor to held edges.
struct Spans<'a> {
    shape: &'a Outline,
    hold: &'a Hold,
    from: [f64; 2],
    symmetry: Symmetry,
}

impl Spans<'_> {
    /// Whether there is no film below the axis of the impactor.
    fn is_beside(&self) -> bool {
        let [x, y] = self.from;
        match self.shape {
            Outline::Circle { radius } => x.hypot(y) >= *radius,
            // With symmetry the polygon is the computed part, on whose edge the axis is.
            Outline::Polygon(_) if self.symmetry != Symmetry::None => false,
            Outline::Polygon(polygon) => !polygon.covers(self.from),
            Outline::Rectangle { x: width, y: height } => x.abs() >= 0.5 * width || y.abs() >= 0.5 * height,
            Outline::Mesh { .. } => false,
        }
    }

    /// The shortest line from one held edge to another, m; sampled in steps of a degree.
    fn narrowest(&self) -> Option<f64> {
        let degrees = (0..180).map(|degree| f64::from(degree) * PI / 180.0);
        let ways = degrees.filter_map(|angle| Some(self.length(angle)? + self.length(angle + PI)?));
        ways.min_by(f64::total_cmp)
    }

    /// Length of the line at `angle` (rad), m; none where it ends at a free edge, or the outline is not known.
    fn length(&self, angle: f64) -> Option<f64> {
        let ([x, y], [dx, dy]) = (self.from, [angle.cos(), angle.sin()]);
        match self.shape {
            Outline::Circle { radius } => {
                let along = x * dx + y * dy;
                Some((along * along + radius * radius - x * x - y * y).sqrt() - along)
            }
            Outline::Rectangle { x: width, y: height } => {
                let to = |half: f64, from: f64, step: f64, sides: [Side; 2]| match step {
                    0.0 => (f64::INFINITY, sides[0]),
                    step if step > 0.0 => ((half - from) / step, sides[1]),
                    step => ((-half - from) / step, sides[0]),
                };
                let across = to(0.5 * width, x, dx, [Side::XMinus, Side::XPlus]);
                let along = to(0.5 * height, y, dy, [Side::YMinus, Side::YPlus]);
                let (length, side) = if across.0 < along.0 { across } else { along };
                self.hold.holds(side).then_some(length)
            }
            Outline::Polygon(_) | Outline::Mesh { .. } => None,
        }
        .filter(|length| *length > 0.0)
    }

    /// The shortest line to a held edge, m; sampled in steps of a degree.
    fn shortest(&self) -> Option<f64> {
        let lengths = (0..360).filter_map(|degree| self.length(f64::from(degree) * PI / 180.0));
        lengths.min_by(f64::total_cmp)
    }
}

/// Depth at which an impactor wider than the distance to the nearest held edge reaches it, m.
fn frame_depth(impactor: &Impactor, spans: &Spans<'_>) -> Option<f64> {
    let nearest = spans.shortest()?;
    match impactor.shape {
        ImpactorShape::Sphere { radius }
        | ImpactorShape::Hemisphere { radius, .. }
        | ImpactorShape::Capsule { radius, .. } => {
            (radius > nearest).then(|| radius - (radius * radius - nearest * nearest).sqrt())
        }
        ImpactorShape::Cylinder { radius, edge, .. } => {
            let beyond = nearest - (radius - edge);
            (radius >= nearest).then(|| edge - (edge * edge - beyond.max(0.0).powi(2)).sqrt())
        }
        ImpactorShape::Cone { .. }
        | ImpactorShape::Box { .. }
        | ImpactorShape::Mesh { .. }
        | ImpactorShape::Compound(_) => None,
    }
}

/// Depth at which a fibre set, straight from edge to edge over the impactor's lowest point and uniformly strained, is
/// at its break strain, m. In any other shape of the film, the largest strain is larger.
fn breaking_depth(face: &Face, fibre: usize, spans: &Spans<'_>) -> Option<f64> {
    let limit = face.material.largest_break_strains()[fibre];
    let angle = face.md_angle + [0.0, 0.5 * PI][fibre];
    let ways = [spans.length(angle)?, spans.length(angle + PI)?];
    let own = ways.iter().sum::<f64>() / (1.0 + face.prestrain[fibre]);
    let longest = own * (1.0 + limit);
    if longest.is_infinite() {
        return None;
    }
    // Bisection: the length of both lines grows with the depth.
    let length = |depth: f64| ways.iter().map(|way| way.hypot(depth)).sum::<f64>();
    let (mut low, mut high) = (0.0, longest);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if length(middle) < longest { low = middle } else { high = middle }
    }
    Some(low)
}
