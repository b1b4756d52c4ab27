#include "tests/support/allocations.hpp"

#include "tests/support/std.hpp"

namespace {

std::atomic<std::size_t> count{0};

}  // namespace

// The sanitizers bring an allocator of their own, which must stay: there the law is not checked.
#ifndef PALPATE_SANITIZED

namespace {

void* counted(std::size_t size) {
    count.fetch_add(1, std::memory_order_relaxed);
    void* memory = std::malloc(size == 0 ? 1 : size);
    if (memory == nullptr) {
        throw std::bad_alloc();
    }
    return memory;
}

}  // namespace

void* operator new(std::size_t size) {
    return counted(size);
}
void* operator new[](std::size_t size) {
    return counted(size);
}
void operator delete(void* memory) noexcept {
    std::free(memory);
}
void operator delete[](void* memory) noexcept {
    std::free(memory);
}
void operator delete(void* memory, std::size_t /*size*/) noexcept {
    std::free(memory);
}
void operator delete[](void* memory, std::size_t /*size*/) noexcept {
    std::free(memory);
}

#endif

namespace palpate::tests {

std::size_t allocations() noexcept {
    return count.load(std::memory_order_relaxed);
}

}  // namespace palpate::tests
