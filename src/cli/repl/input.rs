//! Whether what was typed is complete.

/// The brackets, texts and comments that are open in a text, which is read in parts that end with lines.
#[derive(Default)]
pub(super) struct Open {
    marks: Vec<char>,
    /// Whether a text goes on in the next line.
    continues: bool,
}

/// Whether further lines belong to `text`.
pub(super) fn is_open(text: &str) -> bool {
    let mut open = Open::default();
    open.read(text);
    open.is_any()
}

impl Open {
    /// Reads a further part of the text.
    pub fn read(&mut self, text: &str) {
        let mut letters = text.chars().peekable();
        while let Some(letter) = letters.next() {
            match self.marks.last() {
                Some('*') => self.in_comment(letter, &mut letters),
                Some('`') => self.in_long_text(letter, &mut letters),
                Some(quote @ ('"' | '\'')) => self.in_text(letter, *quote, &mut letters),
                _ => self.outside(letter, &mut letters),
            }
        }
    }

    /// Whether further lines belong to it. A text ends with its line, where its end is a mistake.
    pub fn is_any(&self) -> bool {
        self.continues || self.marks.iter().any(|mark| !"\"'".contains(*mark))
    }

    fn outside(&mut self, letter: char, letters: &mut Letters<'_>) {
        match (letter, letters.peek()) {
            ('`' | '(' | '[' | '{' | '"' | '\'', _) => self.marks.push(letter),
            (')' | ']' | '}', _) => drop(self.marks.pop()),
            ('/', Some('/')) => while letters.next_if(|letter| *letter != '\n').is_some() {},
            ('/', Some('*')) => self.marks.extend(letters.next()),
            _ => {}
        }
    }

    /// A comment may hold others.
    fn in_comment(&mut self, letter: char, letters: &mut Letters<'_>) {
        match (letter, letters.peek()) {
            ('*', Some('/')) => drop((letters.next(), self.marks.pop())),
            ('/', Some('*')) => self.marks.extend(letters.next()),
            _ => {}
        }
    }

    /// A text may hold expressions: `${…}`.
    fn in_long_text(&mut self, letter: char, letters: &mut Letters<'_>) {
        match (letter, letters.peek()) {
            ('`', _) => drop(self.marks.pop()),
            ('$', Some('{')) => self.marks.extend(letters.next()),
            ('\\', _) => drop(letters.next()),
            _ => {}
        }
    }

    fn in_text(&mut self, letter: char, quote: char, letters: &mut Letters<'_>) {
        self.continues = false;
        match letter {
            '\\' => self.continues = letters.next().is_none_or(|letter| letter == '\n'),
            end if end == quote || end == '\n' => drop(self.marks.pop()),
            _ => {}
        }
    }
}

type Letters<'t> = std::iter::Peekable<std::str::Chars<'t>>;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn brackets_texts_and_comments_are_told_apart() {
        for text in [
            "f(",
            "let m = #{",
            "[1,\n2",
            "fn f(x) {\n  x",
            "`text",
            "`a ${f(",
            "/* a",
            "/* a /* b */",
            "(\")\"",
            "// (\n[",
            "\"a\\",
            "\"a\\\n",
        ] {
            assert!(is_open(text), "{text}");
        }
        for text in [
            "",
            "f(1)",
            "\"(\"",
            "'('",
            "// (",
            "/* ( */",
            "`a ( ${f(1)}`",
            "\"\\\"(\"",
            "\"open",
            "f(1))",
            "/* /* */ */ 1",
        ] {
            assert!(!is_open(text), "{text}");
        }
    }

    #[test]
    fn a_text_may_be_read_line_by_line() {
        let text = "f(`a ( ${[1,\n2]}\n`, /* { \n /* ( */\n*/ \"b ( \\\n (\", '(',\n// (\n\"open\n)\n";
        let mut open = Open::default();
        let mut read = String::new();
        for line in text.split_inclusive('\n') {
            open.read(line);
            read += line;
            assert_eq!((open.is_any(), is_open(&read)), (read != text, read != text), "{read}");
        }
    }
}
