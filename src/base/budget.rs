//! The bytes that a script may hold, counted where its values are made.
//!
//! An interpreter bounds its own lists and strings. What the host hands it, a signal or a scenario, is one value to it, of
//! any size: such values carry a [`Claim`], which counts as long as they live.

use std::cell::RefCell;
use std::fmt;
use std::ops::Deref;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

thread_local! {
    /// The budget of the script that this thread interprets.
    static CURRENT: RefCell<Option<Budget>> = const { RefCell::new(None) };
}

/// The bytes that the values of one script hold. Cheap to clone; clones count together.
#[derive(Clone, Debug, Default)]
pub struct Budget(Arc<AtomicUsize>);

impl Budget {
    /// Bytes that are held now.
    pub fn held(&self) -> usize {
        self.0.load(Ordering::Relaxed)
    }

    /// A claim of `bytes`.
    pub fn claim(&self, bytes: usize) -> Claim {
        self.0.fetch_add(bytes, Ordering::Relaxed);
        Claim { budget: Some(self.clone()), bytes }
    }

    /// Does `work`; the values that this thread makes meanwhile count towards the budget.
    pub fn count<T>(&self, work: impl FnOnce() -> T) -> T {
        /// Restores the budget of before, after a panic too.
        struct Before(Option<Budget>);
        impl Drop for Before {
            fn drop(&mut self) {
                CURRENT.with_borrow_mut(|current| *current = self.0.take());
            }
        }
        let _before = Before(CURRENT.with_borrow_mut(|current| current.replace(self.clone())));
        work()
    }
}

/// Bytes that count towards a budget until the claim is dropped.
pub struct Claim {
    budget: Option<Budget>,
    bytes: usize,
}

impl Claim {
    /// A claim of `bytes` for the script of this thread.
    fn new(bytes: usize) -> Claim {
        match CURRENT.with_borrow(Clone::clone) {
            Some(budget) => budget.claim(bytes),
            None => Claim { budget: None, bytes },
        }
    }
}

impl Drop for Claim {
    fn drop(&mut self) {
        if let Some(Budget(held)) = &self.budget {
            held.fetch_sub(self.bytes, Ordering::Relaxed);
        }
    }
}

impl fmt::Debug for Claim {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} bytes", self.bytes)
    }
}

/// Numbers that any number of values share, and that count towards the budget of the script that made them. Cheap to clone.
#[derive(Clone)]
pub struct Numbers(Arc<Counted>);

struct Counted {
    values: Box<[f64]>,
    _claim: Claim,
}

impl From<Vec<f64>> for Numbers {
    fn from(values: Vec<f64>) -> Numbers {
        let values = values.into_boxed_slice();
        let _claim = Claim::new(size_of_val(&*values));
        Numbers(Arc::new(Counted { values, _claim }))
    }
}

impl From<&[f64]> for Numbers {
    fn from(values: &[f64]) -> Numbers {
        values.to_vec().into()
    }
}

impl<const COUNT: usize> From<[f64; COUNT]> for Numbers {
    fn from(values: [f64; COUNT]) -> Numbers {
        values.to_vec().into()
    }
}

impl FromIterator<f64> for Numbers {
    fn from_iter<I: IntoIterator<Item = f64>>(values: I) -> Numbers {
        values.into_iter().collect::<Vec<_>>().into()
    }
}

impl Deref for Numbers {
    type Target = [f64];

    fn deref(&self) -> &[f64] {
        &self.0.values
    }
}

impl fmt::Debug for Numbers {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        (**self).fmt(f)
    }
}

impl PartialEq for Numbers {
    fn eq(&self, other: &Numbers) -> bool {
        **self == **other
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_count_where_they_are_made_as_long_as_they_live() {
        let budget = Budget::default();
        let outside = Numbers::from(vec![0.0; 100]);
        let (kept, shared) = budget.count(|| {
            let kept = Numbers::from([1.0, 2.0]);
            drop(Numbers::from(vec![0.0; 1000]));
            (kept.clone(), kept)
        });
        assert_eq!(budget.held(), 16);
        drop((outside, kept));
        assert_eq!(budget.held(), 16);
        drop(shared);
        assert_eq!(budget.held(), 0);
    }

    #[test]
    fn budgets_are_nested() {
        let (outer, inner) = (Budget::default(), Budget::default());
        let claims = outer.count(|| {
            let first = inner.count(|| Claim::new(1));
            let panic = std::panic::catch_unwind(|| inner.count(|| std::panic::resume_unwind(Box::new(0))));
            assert!(panic.is_err());
            (first, Claim::new(10))
        });
        assert_eq!((outer.held(), inner.held()), (10, 1));
        drop(claims);
    }
}
