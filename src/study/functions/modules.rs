//! The module of numbers and tables that is part of droptower.

use crate::script::{Entry, ShippedModule};

/// The module, which every script can import.
pub(super) const MODULES: &[ShippedModule] =
    &[ShippedModule { name: "droptower/tables", text: include_str!("../../../scripts/droptower/tables.rhai") }];

/// The reference of its functions.
pub const ENTRIES: &[Entry] = &[
    Entry {
        call: "tables::rounded(value, decimals)",
        gives: "the number to as many decimals",
        example: r#"import "droptower/tables" as tables; tables::rounded(16.4492, 2) == 16.45"#,
    },
    Entry {
        call: "tables::mean_value(values)",
        gives: "the arithmetic mean of a list of numbers",
        example: r#"import "droptower/tables" as tables; tables::mean_value([1, 2, 6]) == 3.0"#,
    },
    Entry {
        call: "tables::column(rows, name)",
        gives: "the values of one column of a list of maps",
        example: r#"import "droptower/tables" as tables; tables::column([#{ k1: 2.7 }, #{ k1: 3.1 }], "k1") == [2.7, 3.1]"#,
    },
    Entry {
        call: "tables::only_row(rows)",
        gives: "the only row of a list; where there are more or none, a mistake",
        example: r#"import "droptower/tables" as tables; tables::only_row([#{ test: 1008 }].filter(|row| row.test == 1008)).test == 1008"#,
    },
    Entry {
        call: "tables::cell_text(value, decimals)",
        gives: "a value as the text of a cell: numbers rounded, `-` for nothing",
        example: r#"import "droptower/tables" as tables; tables::cell_text(1.23456, 3) == "1.235" && tables::cell_text((), 3) == "-""#,
    },
    Entry {
        call: "tables::markdown_row(cells)",
        gives: "a row of a table in Markdown",
        example: r#"import "droptower/tables" as tables; tables::markdown_row(["test", "k1"]) == "| test | k1 |""#,
    },
];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::functions::check::assert_described;

    #[test]
    fn every_function_of_the_module_is_described() {
        assert_described(MODULES, ENTRIES);
    }
}
