//! Sessions of `tests/cmd/`: commands, what they print, and how they end where they fail (`? 2`). A page is run in the repository, or
//! in a copy of the folder beside it that ends in `.in`; what is left must be what is in `.out`.
//!
//! `TRYCMD=overwrite cargo test --release --test it -- cmd` writes into the pages what commands print now.

#[test]
fn commands_print_what_their_pages_say() {
    let droptower = std::path::PathBuf::from(env!("CARGO_BIN_EXE_droptower"));
    trycmd::TestCases::new().register_bin("droptower", droptower).case("tests/cmd/*.md").run();
}
