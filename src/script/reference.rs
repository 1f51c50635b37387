/// One line of the scripting reference.
#[derive(Clone, Copy, Debug)]
pub struct Entry {
    /// How it is written, e.g. `signal.at(t)`.
    pub call: &'static str,
    /// What it gives, with units.
    pub gives: &'static str,
    /// A script that ends in `true`; the tests run it.
    pub example: &'static str,
}

/// The lines of the reference that belong together.
#[derive(Clone, Copy, Debug)]
pub struct Chapter {
    pub title: &'static str,
    pub entries: &'static [Entry],
}
