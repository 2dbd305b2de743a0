//! Maps of colours with an opacity map as their alpha; large ones are put together on threads of their own.

use super::ahead::Wanted;
use super::tree_building::Threads;
use crate::trace::Texture;
use bevy::asset::AssetId;
use bevy::image::Image;
use bevy::platform::collections::HashMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;

/// Texels that are put together within a frame: about a millisecond's.
pub(super) const AT_ONCE: u64 = 1 << 16;
/// A texel takes so much longer where the opacity map has another size, and is filtered.
const FILTERED: u64 = 4;

/// A map of colours, and the opacity map that cuts it out.
pub(super) type Pair = [AssetId<Image>; 2];

/// What was put together, and what is being.
#[derive(Default)]
pub(super) struct CutOuts {
    made: HashMap<Pair, CutOut>,
    threads: Threads<Finished>,
    others: Threads<()>,
    /// By the number of the work: what of the same pair was begun earlier counts no more.
    under_way: HashMap<Pair, u64>,
    begun: u64,
}

struct CutOut {
    /// The two that it was made of.
    of: [Arc<Texture>; 2],
    /// The map of colours itself where that is the alpha that it has.
    texture: Arc<Texture>,
}

struct Finished {
    pair: Pair,
    number: u64,
    cut_out: CutOut,
}

impl CutOut {
    fn make(of: [Arc<Texture>; 2], wanted: Wanted) -> Self {
        let texture = match of[0].cut_out_by(&of[1]) {
            Some(texture) => Arc::new(texture),
            None => of[0].clone(),
        };
        wanted.make_cut_out(&texture);
        Self { of, texture }
    }

    fn is_of(&self, of: &[Arc<Texture>; 2]) -> bool {
        (0..2).all(|i| Arc::ptr_eq(&self.of[i], &of[i]))
    }
}

impl CutOuts {
    /// The map of colours as it was put together last.
    pub fn get(&self, pair: Pair) -> Option<&Arc<Texture>> {
        Some(&self.made.get(&pair)?.texture)
    }

    /// Whether it is being put together for the first time.
    pub fn is_awaited(&self, pair: Pair) -> bool {
        self.under_way.contains_key(&pair) && !self.made.contains_key(&pair)
    }

    /// How many are under way.
    pub fn len(&self) -> usize {
        self.under_way.len()
    }

    /// How many are kept.
    #[cfg(test)]
    pub fn kept(&self) -> usize {
        self.made.len() + self.len()
    }

    /// Nobody wants it any more, or one of the two is missing.
    pub fn forget(&mut self, pair: Pair) {
        self.made.remove(&pair);
        self.under_way.remove(&pair);
    }

    /// Nothing is under way any more; what was.
    pub fn stop(&mut self) -> Vec<Pair> {
        self.under_way.drain().map(|(pair, _)| pair).collect()
    }

    /// Puts these two together where they are others than before: here where that takes no longer than what is `left` of the
    /// frame. One that is under way is not begun again: where one of the two is edited in every frame none would ever be done.
    pub fn make(&mut self, pair: Pair, of: [Arc<Texture>; 2], wanted: Wanted, left: &mut u64) {
        let is_known = self.made.get(&pair).is_some_and(|made| made.is_of(&of));
        if is_known || self.under_way.contains_key(&pair) {
            return;
        }
        let cost = cost(&of);
        if cost <= *left {
            *left -= cost;
            self.made.insert(pair, CutOut::make(of, wanted));
            return;
        }
        self.begun += 1;
        let number = self.begun;
        self.under_way.insert(pair, number);
        self.threads.run(move || {
            // A panic would be a bug; it must not take the app with it, nor keep it waiting.
            let made = catch_unwind(AssertUnwindSafe(|| CutOut::make(of.clone(), wanted)));
            let texture = of[0].clone();
            Finished {
                pair,
                number,
                cut_out: made.unwrap_or(CutOut { of, texture }),
            }
        });
    }

    /// Has made of all what is wanted now, on the threads: nobody waits for it.
    pub fn make_ahead(&mut self, wanted: Wanted) {
        let made: Vec<_> = self
            .made
            .values()
            .map(|made| made.texture.clone())
            .collect();
        if !made.is_empty() {
            self.others.run(move || {
                // A panic would be a bug; it must not take the app with it.
                let all = || made.iter().for_each(|texture| wanted.make_cut_out(texture));
                let _ = catch_unwind(AssertUnwindSafe(all));
            });
        }
    }

    /// Takes what was done since this was asked last, and says what.
    pub fn finished(&mut self) -> Vec<Pair> {
        let mut finished = Vec::new();
        for done in self.threads.finished() {
            if self.under_way.get(&done.pair) == Some(&done.number) {
                self.under_way.remove(&done.pair);
                self.made.insert(done.pair, done.cut_out);
                finished.push(done.pair);
            }
        }
        finished
    }
}

/// How long it takes, as the texels of a pair of the same size that take as long.
fn cost([colors, opacity]: &[Arc<Texture>; 2]) -> u64 {
    let size = |texture: &Texture| (texture.width(), texture.height());
    let texels = |texture: &Texture| u64::from(texture.width()) * u64::from(texture.height());
    if size(colors) == size(opacity) {
        return texels(colors);
    }
    // It may have no smaller levels yet.
    (FILTERED * texels(colors)).saturating_add(texels(opacity))
}
