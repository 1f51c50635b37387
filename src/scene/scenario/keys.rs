//! The tables of a file, a key a row: its sentence, its type, which gives the unit (`base::units`), and behind commas its bounds
//! and its default.

/// Declares tables and choices, as the structs and enums that a file is decoded into, with what schema, validator and `explain`
/// say of them.
///
/// - Words of any key: `above`, `below`, `from` and `to` a bound (SI), `likely` two of what is plausible; `least` and `most`
///   items of a list, `positive` items; `path` of a file; `title`, `written` as another name, `flat` where the keys of a table
///   are those of this one; `usually` what a key that is left out stands for. `serde` and `schemars` take attributes of these.
/// - A key that may be left out is an `Option`, or has the word `default`, for that of its type or that of a function, or
///   `or empty`, for a list. In a table `with defaults` every key may be left out, and is then what stands behind `else`, or the
///   default of its type.
/// - An enum is one `of words`, one `of forms` of a value that are told apart by their content, or one of keys of which a table has
///   one. The validator has reported mistakes before serde tries the forms.
macro_rules! keys {
    (@struct $with:tt $of:tt $name:ident $($rows:tt)*) => { keys!(@row [$with $of $name] [] [] $($rows)*); };
    (@enum [of words] [$($of:tt)*] $name:ident $($words:tt)*) => {
        #[derive(Clone, Copy, Debug, PartialEq, Eq, ::serde::Serialize, ::serde::Deserialize, ::schemars::JsonSchema)]
        #[serde(rename_all = "kebab-case")]
        $($of)* pub enum $name { $($words)* }
    };
    (@enum [of forms] [$($of:tt)*] $name:ident $($forms:tt)*) => {
        #[derive(Clone, Debug, ::serde::Serialize, ::serde::Deserialize, ::schemars::JsonSchema)]
        #[serde(untagged)]
        $($of)* pub enum $name { $($forms)* }
    };
    (@enum [] [$($of:tt)*] $name:ident $($keys:tt)*) => {
        #[derive(Clone, Debug, ::serde::Serialize, ::serde::Deserialize, ::schemars::JsonSchema)]
        #[serde(rename_all = "kebab-case")]
        $($of)* pub enum $name { $($keys)* }
    };
    // All rows are read.
    (@row [[] [$($of:tt)*] $name:ident] [$($rows:tt)*] $defaults:tt) => {
        #[derive(Clone, Debug, ::serde::Serialize, ::serde::Deserialize, ::schemars::JsonSchema)]
        $($of)* pub struct $name { $($rows)* }
    };
    (@row [[with defaults] [$($of:tt)*] $name:ident] [$($rows:tt)*] [$($defaults:tt)*]) => {
        #[derive(Clone, Debug, ::serde::Serialize, ::serde::Deserialize, ::schemars::JsonSchema)]
        #[serde(default)]
        $($of)* pub struct $name { $($rows)* }

        impl Default for $name {
            fn default() -> $name {
                $name { $($defaults)* }
            }
        }
    };
    // The next row, and then its words one by one: what is known so far, the default, the attributes, and what is not read yet.
    (@row $of:tt $rows:tt $defaults:tt $(#[$doc:meta])* $key:ident : $type:ty; $($r:tt)*) => {
        keys!(@word [$of $rows $defaults $key [$type]] [Default::default()] [$(#[$doc])*]; $($r)*);
    };
    (@row $of:tt $rows:tt $defaults:tt $(#[$doc:meta])* $key:ident : $type:ty, $($r:tt)*) => {
        keys!(@word [$of $rows $defaults $key [$type]] [Default::default()] [$(#[$doc])*], $($r)*);
    };
    (@word [$of:tt [$($rows:tt)*] [$($defaults:tt)*] $key:ident [$type:ty]] [$d:expr] [$($a:tt)*]; $($r:tt)*) => {
        keys!(@row $of [$($rows)* $($a)* pub $key: $type,] [$($defaults)* $key: $d,] $($r)*);
    };
    (@word [[[with defaults] $($s:tt)*] $($k:tt)*] $d:tt $a:tt, else $v:literal $($r:tt)*) => {
        keys!(@word [[[with defaults] $($s)*] $($k)*] [$v] $a $($r)*);
    };
    (@word [[[with defaults] $($s:tt)*] $($k:tt)*] $d:tt $a:tt, else $unit:ident($v:literal) $($r:tt)*) => {
        keys!(@word [[[with defaults] $($s)*] $($k)*] [$unit($v)] $a $($r)*);
    };
    (@word [[[with defaults] $($s:tt)*] $($k:tt)*] $d:tt $a:tt, else $v:block $($r:tt)*) => {
        keys!(@word [[[with defaults] $($s)*] $($k)*] [$v] $a $($r)*);
    };
    (@word $s:tt $d:tt $a:tt, default $path:literal $($r:tt)*) => { keys!(@add $s $d $a [serde(default = $path)] $($r)*); };
    (@word $s:tt $d:tt $a:tt, default $($r:tt)*) => { keys!(@add $s $d $a [serde(default)] $($r)*); };
    (@word $s:tt $d:tt $a:tt, or empty $($r:tt)*) => {
        keys!(@add $s $d $a [serde(default, skip_serializing_if = "Vec::is_empty")] $($r)*);
    };
    (@word $s:tt $d:tt $a:tt, written $name:literal $($r:tt)*) => { keys!(@add $s $d $a [serde(rename = $name)] $($r)*); };
    (@word $s:tt $d:tt $a:tt, flat $($r:tt)*) => { keys!(@add $s $d $a [serde(flatten)] $($r)*); };
    (@word $s:tt $d:tt $a:tt, above $x:literal $($r:tt)*) => { keys!(@add $s $d $a ["exclusiveMinimum" $x] $($r)*); };
    (@word $s:tt $d:tt $a:tt, below $x:literal $($r:tt)*) => { keys!(@add $s $d $a ["exclusiveMaximum" $x] $($r)*); };
    (@word $s:tt $d:tt $a:tt, from $x:literal $($r:tt)*) => { keys!(@add $s $d $a ["minimum" $x] $($r)*); };
    (@word $s:tt $d:tt $a:tt, to $x:literal $($r:tt)*) => { keys!(@add $s $d $a ["maximum" $x] $($r)*); };
    (@word $s:tt $d:tt $a:tt, likely $x:tt $($r:tt)*) => { keys!(@add $s $d $a ["x-likely" $x] $($r)*); };
    (@word $s:tt $d:tt $a:tt, least $x:literal $($r:tt)*) => { keys!(@add $s $d $a ["minItems" $x] $($r)*); };
    (@word $s:tt $d:tt $a:tt, most $x:literal $($r:tt)*) => { keys!(@add $s $d $a ["maxItems" $x] $($r)*); };
    (@word $s:tt $d:tt $a:tt, usually $x:literal $($r:tt)*) => { keys!(@add $s $d $a ["default" $x] $($r)*); };
    (@word $s:tt $d:tt $a:tt, path $($r:tt)*) => { keys!(@add $s $d $a ["x-path" true] $($r)*); };
    (@word $s:tt $d:tt $a:tt, positive $($r:tt)*) => { keys!(@add $s $d $a [schemars(transform = crate::scenario::schema::positive_items)] $($r)*); };
    (@word $s:tt $d:tt $a:tt, title $x:literal $($r:tt)*) => { keys!(@add $s $d $a [schemars(title = $x)] $($r)*); };
    (@word $s:tt $d:tt $a:tt, $of:ident($($x:tt)*) $($r:tt)*) => { keys!(@add $s $d $a [$of($($x)*)] $($r)*); };
    (@add $s:tt $d:tt [$($a:tt)*] [$keyword:literal $x:tt] $($r:tt)*) => {
        keys!(@word $s $d [$($a)* #[schemars(extend($keyword = $x))]] $($r)*);
    };
    (@add $s:tt $d:tt [$($a:tt)*] [$($attribute:tt)*] $($r:tt)*) => {
        keys!(@word $s $d [$($a)* #[$($attribute)*]] $($r)*);
    };
    ($($(#[$of:meta])* pub $kind:ident $name:ident $($form:ident)* { $($body:tt)* })+) => {
        $(keys!(@$kind [$($form)*] [$(#[$of])*] $name $($body)*);)+
    };
}
