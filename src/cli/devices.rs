//! `quadmosaic devices`.

use super::output::print;
use quadmosaic::gpu::adapters;

pub fn run() -> anyhow::Result<()> {
    let adapters = adapters();
    if adapters.is_empty() {
        return print(
            "no GPU adapter; meshing runs on the CPU\n\
             (a software adapter for tests, on Debian and Ubuntu: apt-get install mesa-vulkan-drivers libvulkan1)\n",
        );
    }
    let width = adapters.iter().map(|adapter| adapter.name.chars().count()).max().unwrap_or_default();
    let lines = adapters.iter().map(|adapter| {
        let by = if adapter.hardware { "" } else { ", software" };
        format!("{:width$}  {}{by}, {} ({})\n", adapter.name, adapter.kind, adapter.backend, adapter.driver)
    });
    print(&lines.collect::<String>())
}
