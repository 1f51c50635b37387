//! Sessions of `tests/cmd/`: commands, what they print, and how they end where they fail (`? 2`). A page is run in the
//! repository, or in the folder beside it that ends in `.in`; where there is one that ends in `.out`, in a copy, which must then
//! hold its files.
//!
//! `TRYCMD=overwrite cargo test --release --test it -- cmd` writes into the pages what commands print now.

#[test]
fn commands_print_what_their_pages_say() {
    let droptower = std::path::PathBuf::from(env!("CARGO_BIN_EXE_droptower"));
    trycmd::TestCases::new().register_bin("droptower", droptower).case("tests/cmd/*.trycmd").run();
}
