//! Disjoint sets (union-find).

/// Sets of the items from 0 on; each begins as a set of its own. The least item of a set represents it.
pub(crate) struct Sets {
    parent: Vec<u32>,
    count: usize,
}

impl Sets {
    /// So many sets of one item each.
    pub(crate) fn new(count: usize) -> Self {
        Self { parent: (0..count as u32).collect(), count }
    }

    /// The number of sets.
    pub(crate) fn count(&self) -> usize {
        self.count
    }

    /// The least item of the set that holds an item.
    pub(crate) fn root(&mut self, mut item: u32) -> u32 {
        while self.parent[item as usize] != item {
            let above = self.parent[item as usize];
            self.parent[item as usize] = self.parent[above as usize];
            item = self.parent[item as usize];
        }
        item
    }

    /// Makes one set of those that hold two items.
    pub(crate) fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.root(a), self.root(b));
        if a != b {
            self.parent[a.max(b) as usize] = a.min(b);
            self.count -= 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn joined_items_have_the_least_as_their_root() {
        let mut sets = Sets::new(6);
        sets.join(5, 3);
        sets.join(3, 1);
        sets.join(1, 5);
        assert_eq!((0..6).map(|item| sets.root(item)).collect::<Vec<_>>(), [0, 1, 2, 1, 4, 1]);
        assert_eq!(sets.count(), 4);
    }
}
