"""Other machines' libraries, run here: Windows under Wine, aarch64 under qemu."""
