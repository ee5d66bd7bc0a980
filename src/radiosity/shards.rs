//! Values that are made when they are first asked for, by many threads at a time.

use std::collections::HashMap;
use std::hash::{BuildHasher, Hash, RandomState};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

/// As many threads may look something up at once without waiting for each other, most of the time.
const SHARDS: usize = 64;

type Shard<K, V> = Mutex<HashMap<K, Arc<OnceLock<V>>>>;

/// A map whose values are made once and stay.
pub struct Shards<K, V> {
    hasher: RandomState,
    shards: Vec<Shard<K, V>>,
}

impl<K: Hash + Eq, V> Shards<K, V> {
    pub fn new() -> Self {
        Shards {
            hasher: RandomState::new(),
            shards: std::iter::repeat_with(Mutex::default)
                .take(SHARDS)
                .collect(),
        }
    }

    /// The place of a value; whoever finds it empty fills it, and others who want the same wait for that one.
    pub fn place(&self, key: K) -> Arc<OnceLock<V>> {
        let shard = self.hasher.hash_one(&key) as usize % SHARDS;
        let mut shard = self.shards[shard]
            .lock()
            .unwrap_or_else(PoisonError::into_inner);
        shard.entry(key).or_default().clone()
    }
}
