/// One entry of the reference of script functions.
#[derive(Clone, Copy, Debug)]
pub struct Entry {
    /// The call, such as `signal.at(t)`.
    pub call: &'static str,
    /// The result, with its units.
    pub gives: &'static str,
    /// A script that ends in `true`; the tests run it.
    pub example: &'static str,
}

/// A chapter of the reference.
#[derive(Clone, Copy, Debug)]
pub struct Chapter {
    /// Its title.
    pub title: &'static str,
    /// Its entries.
    pub entries: &'static [Entry],
}
