//! Text within HTML and SVG.

use super::diagnostic::steers;

/// The text with everything that HTML or XML would read as markup escaped, and without characters that steer what shows it:
/// names of files and scenarios are not trusted.
pub fn escape(text: &str) -> String {
    let mut safe = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            '&' => safe.push_str("&amp;"),
            '<' => safe.push_str("&lt;"),
            '>' => safe.push_str("&gt;"),
            '"' => safe.push_str("&quot;"),
            '\'' => safe.push_str("&#39;"),
            // Nor does a text turn the direction of what follows.
            other if steers(other) => safe.push('\u{fffd}'),
            other => safe.push(other),
        }
    }
    safe
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_text_is_no_markup_and_turns_nothing() {
        let found = escape("<a href=\"x\">'&\u{202e}\u{7}\n");
        assert_eq!(found, "&lt;a href=&quot;x&quot;&gt;&#39;&amp;\u{fffd}\u{fffd}\n");
    }
}
