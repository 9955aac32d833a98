#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| quadmosaic_fuzz::targets::pipeline(data));
