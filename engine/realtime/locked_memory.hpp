#pragma once

#include <cstddef>
#include <span>

namespace palpate::engine {

/// A stretch of this program's memory.
struct MemoryPart {
    const void* begin = nullptr;
    std::size_t bytes = 0;
};

/// What came of locking memory.
struct LockedParts {
    int locked = 0;
    int refused = 0;
    int error = 0;  ///< errno of the first refusal
};

/// Keeps in memory what a tick may touch, and nothing else: `own` parts, the code and data of the
/// program and of the C, C++ and mathematical libraries, and the heap as large as it is now. A
/// window's libraries and pictures, hundreds of MB, are left out: they would be read in whole, take
/// longer to free than a guard may wait for the end of a program, and no tick needs them.
LockedParts lock_what_ticks_touch(std::span<const MemoryPart> own) noexcept;

/// The heap alone, which may have grown. Between trials: it reads /proc.
LockedParts lock_heap() noexcept;

}  // namespace palpate::engine
