#pragma once

#include <compare>
#include <cstddef>

namespace palpate::protocols {

/// A cell of the factorial design, by index into Protocol::objects and Protocol::frictions.
struct Condition {
    std::size_t object = 0;
    std::size_t friction = 0;

    friend auto operator<=>(const Condition&, const Condition&) = default;
};

// Private to protocols/design.

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
