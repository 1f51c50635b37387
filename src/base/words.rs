//! Enumerations of words: variants, their sentences and their words in one table.

/// Defines an enumeration each of whose variants is shown as its word.
///
/// ```
/// # use droptower_base as base;
/// base::words! {
///     /// How it went.
///     #[derive(Clone, Copy)]
///     pub enum Mood {
///         /// Well.
///         Good = "good",
///         /// Not so well.
///         Fair = "fair",
///     }
/// }
/// assert_eq!((Mood::Good.name(), Mood::Fair.to_string()), ("good", "fair".to_owned()));
/// ```
#[macro_export]
macro_rules! words {
    ($(#[$attribute:meta])* pub enum $name:ident { $($(#[$of_variant:meta])* $variant:ident = $word:literal,)+ }) => {
        $(#[$attribute])*
        pub enum $name {
            $($(#[$of_variant])* $variant,)+
        }

        impl $name {
            /// Its word.
            pub const fn name(self) -> &'static str {
                match self {
                    $($name::$variant => $word,)+
                }
            }
        }

        impl ::std::fmt::Display for $name {
            fn fmt(&self, f: &mut ::std::fmt::Formatter<'_>) -> ::std::fmt::Result {
                f.write_str(self.name())
            }
        }
    };
}
