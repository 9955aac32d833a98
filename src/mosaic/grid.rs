use rustc_hash::FxHashMap;
pub struct Grid {
    cells: FxHashMap<[i32; 3], Vec<u32>>,
    cell: f32,
}
impl Grid {
    pub fn build(position: impl Fn(usize) -> [f32; 3] + Sync, count: usize, cell: f32) -> Self {
        let mut cells: FxHashMap<[i32; 3], Vec<u32>> = FxHashMap::default();
        for i in 0..count {
            cells.entry(position(i).map(|x| (x / cell).floor() as i32)).or_default().push(i as u32);
        }
        Self { cells, cell }
    }
    pub fn around(&self, p: [f32; 3], mut visit: impl FnMut(u32)) {
        let c = p.map(|x| (x / self.cell).floor() as i32);
        for z in -1..=1 {
            for y in -1..=1 {
                for x in -1..=1 {
                    if let Some(ids) = self.cells.get(&[c[0] + x, c[1] + y, c[2] + z]) {
                        ids.iter().for_each(|&i| visit(i));
                    }
                }
            }
        }
    }
}
