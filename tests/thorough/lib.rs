//! What the tests of all packages share: a switch for thorough runs, and cases that are tests of their own.

/// Whether `DROPTOWER_THOROUGH=1` asks for what repeats a proof: on more meshes, angles and scenes, with more seeds and kills.
pub fn thorough() -> bool {
    std::env::var_os("DROPTOWER_THOROUGH").is_some_and(|value| value == "1")
}

/// `usual`, or what a thorough run takes in its place.
pub fn choose<T>(usual: T, of_thorough: T) -> T {
    if thorough() { of_thorough } else { usual }
}

/// The first `few` of the cases of a test, or all of them.
pub fn first<T, const N: usize>(few: usize, cases: [T; N]) -> impl Iterator<Item = T> {
    cases.into_iter().take(if thorough() { N } else { few })
}

/// Makes a test of each case of a function `check`: `name: arguments;`. Those behind `thorough` run where [`thorough`] does.
///
/// ```ignore
/// thorough::cases!(tears_at_its_energy { squares: 0.005, 0.0; } thorough { turned: 0.005, 22.5; });
/// ```
#[macro_export]
macro_rules! cases {
    (
        $check:ident { $($name:ident: $($argument:expr),+ $(,)?;)* }
        $(thorough { $($more:ident: $($further:expr),+ $(,)?;)+ })?
    ) => {
        mod $check {
            #[allow(unused_imports)]
            use super::*;
            $(
                #[test]
                fn $name() {
                    super::$check($($argument),+);
                }
            )*
            $($(
                #[test]
                fn $more() {
                    if $crate::thorough() {
                        super::$check($($further),+);
                    }
                }
            )+)?
        }
    };
}
