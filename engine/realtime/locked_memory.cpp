#include "engine/realtime/locked_memory.hpp"

#include <array>
#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <cstring>

#include <link.h>
#include <sys/mman.h>

namespace palpate::engine {
namespace {

constexpr std::uintptr_t kPage = 4096;

void lock(LockedParts& parts, std::uintptr_t begin, std::size_t bytes) noexcept {
    const std::uintptr_t first = begin & ~(kPage - 1);
    if (bytes == 0) {
        return;
    }
    if (mlock(reinterpret_cast<const void*>(first), begin + bytes - first) == 0) {  // NOLINT
        ++parts.locked;
    } else {
        parts.error = parts.refused == 0 ? errno : parts.error;
        ++parts.refused;
    }
}

/// The program itself has no name there.
bool ticks_in(const char* library) noexcept {
    for (const char* name : {"/libc.so", "/libm.so", "/libstdc++.so", "/libgcc_s.so"}) {
        if (std::strstr(library, name) != nullptr) {
            return true;
        }
    }
    return library[0] == '\0';
}

int lock_library(dl_phdr_info* library, std::size_t /*size*/, void* parts) {
    for (int i = 0; ticks_in(library->dlpi_name) && i < library->dlpi_phnum; ++i) {
        const auto& part = library->dlpi_phdr[i];
        if (part.p_type == PT_LOAD && (part.p_flags & PF_R) != 0) {
            lock(*static_cast<LockedParts*>(parts), library->dlpi_addr + part.p_vaddr,
                 part.p_memsz);
        }
    }
    return 0;
}

void lock_heap(LockedParts& parts) noexcept {
    std::FILE* maps = std::fopen("/proc/self/maps", "re");
    std::array<char, 512> line{};
    while (maps != nullptr && std::fgets(line.data(), line.size(), maps) != nullptr) {
        std::uintptr_t begin = 0;
        std::uintptr_t end = 0;
        if (std::strstr(line.data(), "[heap]") != nullptr &&
            std::sscanf(line.data(), "%zx-%zx", &begin, &end) == 2) {
            lock(parts, begin, end - begin);
        }
    }
    if (maps != nullptr) {
        std::fclose(maps);
    }
}

}  // namespace

LockedParts lock_what_ticks_touch(std::span<const MemoryPart> own) noexcept {
    LockedParts parts;
    for (const MemoryPart& part : own) {
        lock(parts, reinterpret_cast<std::uintptr_t>(part.begin), part.bytes);  // NOLINT
    }
    dl_iterate_phdr(lock_library, &parts);
    lock_heap(parts);
    return parts;
}

LockedParts lock_heap() noexcept {
    LockedParts parts;
    lock_heap(parts);
    return parts;
}

}  // namespace palpate::engine
