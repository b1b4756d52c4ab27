#pragma once

#include <cstddef>
#include <optional>
#include <vector>

namespace palpate::figures {

/// Finds ticks of a run, each after the one before.
template <class Tick>
class TickFinder {
public:
    /// @param run  outlives the finder
    explicit TickFinder(const std::vector<Tick>& run) : run_(&run) {}

    /// The next tick for which test(tick before, tick, tick after) holds; none, and the place
    /// stays.
    template <class Test>
    std::optional<std::size_t> next(Test&& test) {
        for (std::size_t i = at_ + 1; i + 1 < run_->size(); ++i) {
            if (test((*run_)[i - 1], (*run_)[i], (*run_)[i + 1])) {
                at_ = i;
                return i;
            }
        }
        return std::nullopt;
    }

private:
    const std::vector<Tick>* run_;
    std::size_t at_ = 0;
};

}  // namespace palpate::figures
