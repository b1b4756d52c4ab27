#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "engine/realtime/tick_record.hpp"

namespace palpate::engine {

/// The last ticks before a fault, whatever became of the ring. No allocation but in last().
class FlightRecorder {
public:
    static constexpr std::size_t kTicks = 100;

    void clear() noexcept { seen_ = 0; }
    void add(const TickRecord& tick) noexcept { slots_[seen_++ % kTicks] = tick; }

    /// Oldest first, at most kTicks. Only while no servo ticks.
    [[nodiscard]] std::vector<TickRecord> last() const {
        std::vector<TickRecord> ticks;
        for (std::size_t i = seen_ < kTicks ? 0 : seen_ - kTicks; i < seen_; ++i) {
            ticks.push_back(slots_[i % kTicks]);
        }
        return ticks;
    }

private:
    std::array<TickRecord, kTicks> slots_{};
    std::size_t seen_ = 0;
};

}  // namespace palpate::engine
