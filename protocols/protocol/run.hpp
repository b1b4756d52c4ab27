#pragma once

#include <cstddef>

#include "protocols/protocol/condition.hpp"

/// Private to protocols/design.
namespace palpate::protocols {

/// Length of the run of one factor while trials come one after another.
class Run {
public:
    /// @param limit  0: none
    Run(std::size_t Condition::*factor, std::size_t limit) : factor_(factor), limit_(limit) {}

    /// Whether the limit still holds with `next` after `last`.
    bool goes_on(const Condition& last, const Condition& next) noexcept {
        length_ = last.*factor_ == next.*factor_ ? length_ + 1 : 1;
        return limit_ == 0 || length_ <= limit_;
    }

private:
    std::size_t Condition::*factor_;
    std::size_t limit_;
    std::size_t length_ = 1;  ///< of the first trial alone, which any limit allows
};

}  // namespace palpate::protocols
