//! What a field, a variant or a component does, taken from its documentation.

use bevy::reflect::Reflect;

/// Attribute: what it does, as `documented!` takes it from the documentation's first paragraph.
#[derive(Reflect, Clone, Copy, Debug, PartialEq, Eq)]
pub struct Says(pub &'static str);

impl Says {
    /// The first paragraph in one line, without the marks of code and links, and without its full stop.
    pub fn text(self) -> String {
        let lines = self.0.lines().map(str::trim);
        let paragraph: Vec<&str> = lines.take_while(|line| !line.is_empty()).collect();
        let text = paragraph.join(" ").replace(['`', '[', ']'], "");
        text.strip_suffix('.').unwrap_or(&text).to_owned()
    }
}

/// Gives each field and variant of a type, and the type itself, its documentation as the attribute [`Says`]: panels,
/// help and messages read what the source says.
///
/// Bevy's feature `reflect_documentation` does the same, and costs every user of Bevy a build of their own.
macro_rules! documented {
    (
        $(#[$($on:tt)*])*
        pub struct $name:ident {
            $( $(#[$($attribute:tt)*])* pub $field:ident : $kind:ty, )*
        }
    ) => {
        $(#[$($on)*])*
        #[reflect(@$crate::scene::schema::Says($crate::scene::schema::documentation!($([$($on)*])*)))]
        pub struct $name {
            $(
                $(#[$($attribute)*])*
                #[reflect(@$crate::scene::schema::Says(
                    $crate::scene::schema::documentation!($([$($attribute)*])*)
                ))]
                pub $field: $kind,
            )*
        }
    };
    (
        $(#[$($on:tt)*])*
        pub enum $name:ident {
            $(
                $(#[$($of_variant:tt)*])*
                $variant:ident
                $( ( $of:ty ) )?
                $( { $( $(#[$($attribute:tt)*])* $field:ident : $kind:ty, )* } )?
                ,
            )*
        }
    ) => {
        $(#[$($on)*])*
        #[reflect(@$crate::scene::schema::Says($crate::scene::schema::documentation!($([$($on)*])*)))]
        pub enum $name {
            $(
                $(#[$($of_variant)*])*
                #[reflect(@$crate::scene::schema::Says(
                    $crate::scene::schema::documentation!($([$($of_variant)*])*)
                ))]
                $variant
                $( ( $of ) )?
                $( { $(
                    $(#[$($attribute)*])*
                    #[reflect(@$crate::scene::schema::Says(
                        $crate::scene::schema::documentation!($([$($attribute)*])*)
                    ))]
                    $field: $kind,
                )* } )?
                ,
            )*
        }
    };
}

/// The texts of `doc` among attributes, a line each.
macro_rules! documentation {
    () => { "" };
    ([doc = $line:literal] $($rest:tt)*) => {
        concat!($line, "\n", $crate::scene::schema::documentation!($($rest)*))
    };
    ([$($other:tt)*] $($rest:tt)*) => { $crate::scene::schema::documentation!($($rest)*) };
}

pub(crate) use {documentation, documented};

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_paragraph_is_said_in_one_line() {
        let says = Says(" Radius of the [`Lens`]:\n larger blurs more.\n\n Metres.\n");
        assert_eq!(says.text(), "Radius of the Lens: larger blurs more");
    }
}
