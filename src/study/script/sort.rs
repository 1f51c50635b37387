//! Sorting of lists: the interpreter's own panics where a number is NaN, which has no place in an order.

use std::cmp::Ordering;

use rhai::{Array, Dynamic, Engine};

use super::{HostResult, refuse};

/// Replaces the interpreter's `sort` and `sort_desc` of the list itself.
pub(super) fn register(engine: &mut Engine) {
    engine
        .register_fn("sort", |list: &mut Array| sort(list, |order| order))
        .register_fn("sort_desc", |list: &mut Array| sort(list, Ordering::reverse));
}

fn sort(list: &mut Array, direction: fn(Ordering) -> Ordering) -> HostResult<()> {
    if let Some(whole) = keys(list, |item| item.as_int().ok()) {
        return reorder(list, &whole, |a, b| direction(a.cmp(b)));
    }
    if let Some(numbers) = keys(list, |item| item.as_float().or_else(|_| item.as_int().map(|whole| whole as f64)).ok())
    {
        if numbers.iter().any(|number| number.is_nan()) {
            return Err(refuse("a list with NaN has no order"));
        }
        return reorder(list, &numbers, |a, b| direction(a.total_cmp(b)));
    }
    if let Some(texts) = keys(list, |item| item.clone().into_immutable_string().ok()) {
        return reorder(list, &texts, |a, b| direction(a.cmp(b)));
    }
    if let Some(letters) = keys(list, |item| item.as_char().ok()) {
        return reorder(list, &letters, |a, b| direction(a.cmp(b)));
    }
    if let Some(flags) = keys(list, |item| item.as_bool().ok()) {
        return reorder(list, &flags, |a, b| direction(a.cmp(b)));
    }
    Err(refuse("a list is sorted where all of it are numbers, texts or Booleans; give `sort` a function for others"))
}

fn keys<K>(list: &Array, key: impl Fn(&Dynamic) -> Option<K>) -> Option<Vec<K>> {
    list.iter().map(key).collect()
}

fn reorder<K>(list: &mut Array, keys: &[K], order: impl Fn(&K, &K) -> Ordering) -> HostResult<()> {
    let mut places: Vec<usize> = (0..keys.len()).collect();
    places.sort_by(|a, b| order(&keys[*a], &keys[*b]));
    *list = places.into_iter().map(|place| std::mem::take(&mut list[place])).collect();
    Ok(())
}
