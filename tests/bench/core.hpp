#pragma once

#include <cstdint>

namespace palpate::bench {

/// Keeps this thread, and what it starts, on `cores` cores: the last that it may use, since the
/// first serves most interrupts. @throws std::runtime_error if it may not use so many
void pin_to(int cores);

/// Whether the thread had its core to itself.
class Watch {
public:
    Watch();
    Watch(const Watch&) = delete;
    Watch& operator=(const Watch&) = delete;
    ~Watch();

    void begin() noexcept;
    /// Since begin: no involuntary switch, and no time of the clock that was not the thread's
    /// (another thread's, or the hypervisor's where the kernel knows of it).
    [[nodiscard]] bool ours() const noexcept;
    /// Since the last call: whether the hypervisor took time from this core (/proc/stat, in steps
    /// of 10 ms). Takes some 30 us.
    [[nodiscard]] bool stolen() noexcept;

private:
    struct Now {
        long switches = 0;
        std::int64_t elsewhere_ns = 0;
    };
    [[nodiscard]] static Now now() noexcept;
    [[nodiscard]] long steal() const noexcept;

    int stat_ = -1;
    long stolen_ = 0;
    Now begin_{};
};

}  // namespace palpate::bench
