//! Large arrays on huge pages.
//!
//! A kernel that walks a mesh of some hundred megabytes spends much of its time looking up pages of four kilobytes: with pages
//! of two megabytes a run on a million tetrahedra takes a sixth less, more when other programs use the machine. Linux gives
//! them where they are asked for (`madvise`), and the C library does not ask. Large arrays also begin on a page here, so that records
//! of a cache line lie in one, and zeroed room costs nothing until it is used.
//! Where there is no memory left the program ends ([`super::end`]).
use super::end::checked;
use std::alloc::{GlobalAlloc, Layout, System};
#[cfg(target_os = "linux")]
use std::ptr;

/// Arrays from this size on are mapped by themselves.
#[cfg(target_os = "linux")]
const LARGE: usize = 1 << 22;

/// The program's allocator: the system's, but for large arrays, which get mappings of their own on huge pages.
pub struct HugePages;

#[cfg(target_os = "linux")]
fn is_large(layout: Layout) -> bool {
    // A mapping begins on a page, of four kilobytes at least.
    layout.size() >= LARGE && layout.align() <= 4096
}

#[cfg(target_os = "linux")]
fn map(size: usize) -> *mut u8 {
    // SAFETY: a new private mapping without a file overlaps nothing; the advice is about that mapping, and may be refused at no harm.
    unsafe {
        let (access, kind) = (libc::PROT_READ | libc::PROT_WRITE, libc::MAP_PRIVATE | libc::MAP_ANONYMOUS);
        let start = libc::mmap(ptr::null_mut(), size, access, kind, -1, 0);
        if start == libc::MAP_FAILED {
            return ptr::null_mut();
        }
        libc::madvise(start, size, libc::MADV_HUGEPAGE);
        start.cast()
    }
}

// SAFETY: an array is mapped, remapped and unmapped by its layout alone, and the layout of an allocation is the same whenever it is
// named; all others are the system allocator's.
#[cfg(target_os = "linux")]
unsafe impl GlobalAlloc for HugePages {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        // SAFETY: the caller keeps the contract of `GlobalAlloc`.
        let start = if is_large(layout) { map(layout.size()) } else { unsafe { System.alloc(layout) } };
        checked(start, layout.size())
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        // SAFETY: as above; new mappings are zero.
        let start = if is_large(layout) { map(layout.size()) } else { unsafe { System.alloc_zeroed(layout) } };
        checked(start, layout.size())
    }

    unsafe fn dealloc(&self, start: *mut u8, layout: Layout) {
        // SAFETY: what is large by its layout was mapped with that size.
        unsafe {
            if is_large(layout) {
                libc::munmap(start.cast(), layout.size());
            } else {
                System.dealloc(start, layout);
            }
        }
    }

    unsafe fn realloc(&self, start: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        // SAFETY: the caller gives a size that makes a layout with this alignment; mappings are remapped as mappings, the system's
        // blocks by the system, and what changes from one to the other is copied.
        unsafe {
            let new = Layout::from_size_align_unchecked(size, layout.align());
            let moved = match (is_large(layout), is_large(new)) {
                (false, false) => System.realloc(start, layout, size),
                (true, true) => {
                    let moved = libc::mremap(start.cast(), layout.size(), size, libc::MREMAP_MAYMOVE);
                    if moved == libc::MAP_FAILED { ptr::null_mut() } else { moved.cast() }
                }
                _ => {
                    let moved = self.alloc(new);
                    if !moved.is_null() {
                        ptr::copy_nonoverlapping(start, moved, layout.size().min(size));
                        self.dealloc(start, layout);
                    }
                    moved
                }
            };
            checked(moved, size)
        }
    }
}

// SAFETY: the system's allocator under another name.
#[cfg(not(target_os = "linux"))]
unsafe impl GlobalAlloc for HugePages {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        // SAFETY: the caller keeps the contract of `GlobalAlloc`.
        checked(unsafe { System.alloc(layout) }, layout.size())
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        // SAFETY: as above.
        checked(unsafe { System.alloc_zeroed(layout) }, layout.size())
    }

    unsafe fn dealloc(&self, start: *mut u8, layout: Layout) {
        // SAFETY: as above.
        unsafe { System.dealloc(start, layout) }
    }

    unsafe fn realloc(&self, start: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        // SAFETY: as above.
        checked(unsafe { System.realloc(start, layout, size) }, size)
    }
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::*;

    fn layout(size: usize) -> Layout {
        Layout::from_size_align(size, 8).expect("a layout")
    }

    /// Writes a pattern into the first bytes, gives the block the new size, and reads it again.
    fn survives(size: usize, new: usize) {
        let kept = size.min(new);
        // SAFETY: each block is used within its size and freed with the layout it then has.
        unsafe {
            let block = HugePages.alloc_zeroed(layout(size));
            assert!(!block.is_null());
            let bytes = std::slice::from_raw_parts_mut(block, size);
            assert!(bytes.iter().all(|&byte| byte == 0));
            bytes.iter_mut().enumerate().for_each(|(i, byte)| *byte = (i % 251) as u8);
            let moved = HugePages.realloc(block, layout(size), new);
            assert!(!moved.is_null());
            let bytes = std::slice::from_raw_parts(moved, kept);
            assert!(bytes.iter().enumerate().all(|(i, &byte)| byte == (i % 251) as u8));
            HugePages.dealloc(moved, layout(new));
        }
    }

    #[test]
    fn blocks_keep_what_they_hold_as_they_grow_and_shrink() {
        for size in [100, LARGE - 1, LARGE, 3 * LARGE + 5] {
            for new in [64, LARGE - 7, LARGE, LARGE + 1, 7 * LARGE] {
                survives(size, new);
            }
        }
    }

    #[test]
    fn large_arrays_begin_on_a_page() {
        // SAFETY: freed with the layout it was made with.
        unsafe {
            let block = HugePages.alloc(layout(LARGE));
            assert_eq!(block as usize % 4096, 0);
            HugePages.dealloc(block, layout(LARGE));
        }
    }

    #[test]
    fn what_may_fail_is_null() {
        // SAFETY: nothing is made.
        super::super::end::may_fail(|| unsafe { assert!(HugePages.alloc(layout(1 << 62)).is_null()) });
    }
}
