//! What is computed of two pictures: on a thread of its own, since it reads every pixel several times.

use super::color_image;
use super::difference::{Figures, How, figures, pixels};
use super::histogram::Histogram;
use crate::view::TracedPicture;
use bevy_egui::egui::ColorImage;
use std::sync::Arc;

/// How two pictures are shown as one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Look {
    pub how: How,
    /// How many times a difference is shown.
    pub gain: f32,
}

/// A picture that there is, or what makes it.
pub(super) enum Source {
    There(Arc<TracedPicture>),
    Later(Box<dyn FnOnce() -> TracedPicture + Send>),
}

impl Source {
    /// The picture; the known one, where another would be the same.
    fn picture(self, known: Option<&Arc<TracedPicture>>) -> Arc<TracedPicture> {
        match self {
            Self::There(picture) => picture,
            Self::Later(make) => {
                let picture = make();
                match known.filter(|known| ***known == picture) {
                    Some(known) => known.clone(),
                    None => Arc::new(picture),
                }
            }
        }
    }
}

/// What two pictures have in figures.
#[derive(Clone)]
pub(super) struct Pair {
    pub pictures: [Arc<TracedPicture>; 2],
    /// None where their sizes differ.
    pub figures: Option<Figures>,
    pub histograms: [Histogram; 2],
}

impl Pair {
    /// Of these two. What is known already of the same ones is not computed again.
    pub fn of([first, second]: [Source; 2], before: Option<Self>) -> Self {
        let known = |number: usize| before.as_ref().map(|before| &before.pictures[number]);
        let pictures = [first.picture(known(0)), second.picture(known(1))];
        let is_same = |before: &Self| {
            let mut pairs = before.pictures.iter().zip(&pictures);
            pairs.all(|(before, now)| Arc::ptr_eq(before, now))
        };
        if let Some(before) = before.filter(is_same) {
            return before;
        }
        let [first, second] = [&pictures[0].linear, &pictures[1].linear];
        Self {
            figures: figures(first, second),
            histograms: [first, second].map(Histogram::of),
            pictures,
        }
    }

    /// Both as one; `None` where that is their difference and their sizes differ.
    pub fn image(&self, look: Look) -> Option<ColorImage> {
        let [first, second] = &self.pictures;
        let difference = |is_relative| {
            let pixels = pixels(&first.linear, &second.linear, is_relative, look.gain)?;
            let size = first.linear.size();
            Some(ColorImage::new([size.x as usize, size.y as usize], pixels))
        };
        match look.how {
            How::First => Some(color_image(first)),
            How::Second => Some(color_image(second)),
            How::Signed => difference(false),
            How::Relative => difference(true),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::editor::panels::compare::even_picture as picture;

    #[test]
    fn a_picture_that_is_looked_at_again_and_is_the_same_is_not_computed_again() {
        let first = Arc::new(picture(1.0));
        let later = |level| Source::Later(Box::new(move || picture(level)));
        let pair = Pair::of([Source::There(first.clone()), later(2.0)], None);
        assert!((pair.figures.unwrap().rmse - 1.0).abs() < 1e-6);
        let again = Pair::of(
            [Source::There(first.clone()), later(2.0)],
            Some(pair.clone()),
        );
        assert!(Arc::ptr_eq(&again.pictures[1], &pair.pictures[1]));
        let other = Pair::of([Source::There(first), later(3.0)], Some(again));
        assert!((other.figures.unwrap().rmse - 2.0).abs() < 1e-6);
    }
}
