//! Words of the heads and the headers of exports, in English, German and Chinese.

/// What a word in a head is the name of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Key {
    /// Width of the specimen.
    Width,
    /// Its thickness.
    Thickness,
    /// Length between the jaws.
    Grips,
    /// Gauge length, which counts as the length between the jaws where that is not stated.
    Gauge,
    /// Speed of the jaws apart.
    Speed,
    /// Direction of the film.
    Direction,
    /// The specimen itself.
    Name,
}

/// Words of each key, in lower case and without what is in brackets, between commas.
const KEYS: [(Key, &str); 7] = [
    (
        Key::Width,
        "width, specimen width, sample width, b0, width b0, breite, breite b0, probenbreite, probenbreite b0, 宽度, \
         试样宽度",
    ),
    (
        Key::Thickness,
        "thickness, specimen thickness, sample thickness, a0, thickness a0, dicke, dicke a0, probendicke, \
         probendicke a0, foliendicke, 厚度, 试样厚度",
    ),
    (
        Key::Grips,
        "grip separation, grip to grip separation, grip to grip separation at the start position, jaw separation, \
         grip length, clamping length, le, einspannlänge, einspannlänge le, einspannlänge bei startposition, 夹具间距, \
         夹持距离",
    ),
    (
        Key::Gauge,
        "gauge length, gage length, gauge length l0, specimen gauge length, l0, messlänge, messlänge l0, \
         anfangsmesslänge, length, 标距, 原始标距",
    ),
    (
        Key::Speed,
        "test speed, testing speed, speed, crosshead speed, rate, rate 1, test rate, prüfgeschwindigkeit, \
         geschwindigkeit, traversengeschwindigkeit, velocity, 试验速度, 速度, 拉伸速度",
    ),
    (Key::Direction, "direction, film direction, specimen direction, richtung, probenrichtung, entnahmerichtung, 方向"),
    (
        Key::Name,
        "specimen label, specimen name, specimen identification, specimen id, specimen, sample name, sample id, \
         sample, name, probenname, probenbezeichnung, probe, probenkennung, prüfling, 试样, 试样编号, 试样名称, 样品",
    ),
];

/// Beginnings of names of specimens: `Probe 1`, `Specimen 2`, `试样3`.
const SPECIMENS: [&str; 9] = ["probe", "specimen", "sample", "prüfling", "versuch", "test", "试样", "样品", "试件"];

/// Names of columns of the force, between commas.
const FORCES: &str = "force, standard force, load, axial force, axial load, crosshead force, max force, kraft, standardkraft, \
     prüfkraft, zugkraft, 力, 试验力, 载荷, 负荷, 拉力";

/// Names of columns of the displacement of the jaws, between commas.
const DISPLACEMENTS: &str = "displacement, extension, crosshead, crosshead displacement, crosshead travel, stroke, travel, standard travel, \
     axial displacement, position, grip to grip separation, weg, standardweg, traversenweg, dehnweg, verlängerung, \
     längenänderung, 位移, 行程, 横梁位移, 伸长, 变形";

/// A word without brackets, colons and what may stand around it, in lower case.
pub fn plain(word: &str) -> String {
    let end = word.find(['[', '(']).filter(|end| *end > 0).unwrap_or(word.len());
    word[..end].trim().trim_end_matches([':', '=', '：']).trim().to_lowercase()
}

/// Whether a plain word is one of the names between commas.
fn holds(names: &str, word: &str) -> bool {
    names.split(", ").any(|name| name == word)
}

/// What a cell of a head names.
pub fn key(word: &str) -> Option<Key> {
    let word = plain(word);
    KEYS.iter().find(|(_, names)| holds(names, &word)).map(|(key, _)| *key)
}

/// Whether it is the name of a specimen, a word with a number.
pub fn is_specimen(word: &str) -> bool {
    let word = plain(word);
    let numbered = SPECIMENS.iter().any(|stem| {
        let rest = word.strip_prefix(stem).map(|rest| rest.trim_start_matches([' ', '_', '-', '#', '.']));
        rest.and_then(|rest| rest.chars().next()).is_some_and(|letter| letter.is_ascii_digit())
    });
    // Trapezium: batch and number.
    let counted = word.split_once(['-', '_']).is_some_and(|(batch, number)| {
        let digits = |text: &str| !text.trim().is_empty() && text.trim().bytes().all(|byte| byte.is_ascii_digit());
        digits(batch) && digits(number)
    });
    numbered || counted
}

/// Words for the directions of film, between commas.
const DIRECTIONS: [(&str, &str); 2] = [
    ("MD", "längs, längsrichtung, machine, machine direction, 纵向"),
    ("TD", "quer, querrichtung, transverse, transverse direction, cd, cross direction, 横向"),
];

/// The direction that a word of a head means, or the word.
pub fn direction(word: &str) -> &str {
    let plain = plain(word);
    DIRECTIONS.iter().find(|(_, words)| holds(words, &plain)).map_or(word, |(direction, _)| *direction)
}

/// Whether a column of this name is the force of the machine.
pub fn is_force(name: &str) -> bool {
    holds(FORCES, &plain(name))
}

/// Whether a column of this name is the displacement of the jaws.
pub fn is_displacement(name: &str) -> bool {
    holds(DISPLACEMENTS, &plain(name))
}
